"""What no engineer would believe stands on the first page, and nothing calls it good."""

import pytest

import pound_solve
from pound_solve.report.text import render
from pound_solve.results.contents import SECTIONS

DECK = """UNITS {units}
GRAVITY {g}
NODES
 1 0 0 FIX=XYR
 2 0 {h} FIX=YR
 3 {x} {h} FIX=YR
ELEMENTS
 1 COL 1 2
 2 SLAB 2 3
 9 WALL 3
PROPS
 COL SPRING KX=4000 FX=60 RULE=BILINEAR R=0.05 DUCTU=4
 SLAB FRAME E=2E7 A=1
 WALL CONTACT GAP=0.004 LAW=LINEAR K={k}
WEIGHTS
 2,3 100
DRIFT
 "storey" 1 2
EQUAKE
 SINE AMPLITUDE={a} PERIOD=0.7 DURATION=3
ANALYSIS
 HISTORY 4
"""


def run(folder, units="kN m s", g=9.81, h=3.0, x=5.0, k=1e5, a=1.0):
    deck = folder / "model.inp"
    deck.write_text(DECK.format(units=units, g=g, h=h, x=x, k=k, a=a))
    return pound_solve.run(deck)


def looks(results):
    """Checks that are to be looked at."""
    return [check for check, _, verdict in results.table("checks").tolist() if verdict.startswith("look")]


def first_page(results):
    return render(results, only=SECTIONS[0][1])


def test_an_ordinary_run_has_nothing_to_look_at(tmp_path):
    results = run(tmp_path, a=0.3)
    assert not looks(results) and "warnings" not in results.tables
    assert max(abs(results.table("drift_envelope")["ratio_max"])) < 0.1


def test_a_drift_above_a_tenth_of_its_height_is_told(tmp_path):
    results = run(tmp_path, h=0.03)
    assert results.table("drift_envelope")["ratio_max"][0] > 0.1
    assert "drift ratio of storey" in looks(results) and "above 10 %" in first_page(results)


def test_failed_components_are_told(tmp_path):
    results = run(tmp_path, a=8.0)
    assert results.table("damage")["index"][0] >= 1.0
    assert "damage index of 1 springs and hinges" in looks(results)
    assert results.table("worst_hinges")["state"][0] == "failed"


def test_a_contact_pressed_into_its_building_is_told(tmp_path):
    soft = run(tmp_path, k=100.0, a=5.0)
    share = soft.table("contact_summary")["peak_penetration"][0] / 3.0
    assert share > 0.02 and "overlap of contact 9" in looks(soft)
    assert "overlap of contact 9" not in looks(run(tmp_path, k=1e6, a=3.0))


@pytest.mark.parametrize(("units", "g", "told"), [("kN mm s", 9.81, "m"), ("kN m s", 981, "cm")])
def test_gravity_of_another_unit_is_told_on_the_first_page(tmp_path, units, g, told):
    page = " ".join(first_page(run(tmp_path, units=units, g=g)).split())
    assert f"GRAVITY is {g:g}, that of {told}, but" in page


def test_a_motion_beyond_any_earthquake_is_told_on_the_first_page(tmp_path):
    assert "R404" in first_page(run(tmp_path, a=32.0))


def test_the_overview_names_the_largest_of_all(tmp_path):
    results = run(tmp_path)
    told = dict(results.table("overview").tolist())
    best = results.table("contact_summary")["peak_force"].max()
    assert told["collisions"].endswith("contact 9") and f"{best:.5g} kN" in told["collisions"]
    assert (
        told["largest drift ratio"]
        == f"{100 * results.table('drift_envelope')['ratio_max'][0]:.3g} %, storey"
    )
