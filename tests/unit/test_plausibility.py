"""What no engineer would believe stands on the first page, and nothing calls it good."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import pound_solve
from decks import results_of, structure_of
from pound_solve.analyses.plausibility import LARGEST_DRIFT, drifts, lengths
from pound_solve.check import looked
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
    return results_of(deck)


def looks(results):
    """Checks that are to be looked at."""
    return [check.name for check in looked(results.checks)]


def first_page(results):
    return render(results, only=SECTIONS[0][1])


def test_an_ordinary_run_has_nothing_to_look_at(tmp_path):
    results = run(tmp_path, a=0.3)
    assert not looks(results) and "warnings" not in results.tables
    assert max(abs(results.table("drift_envelope")["ratio_max"])) < 0.1


def test_a_drift_above_a_tenth_of_its_height_is_told(tmp_path):
    results = run(tmp_path, h=0.03)
    (row,) = results.table("drift_envelope")
    assert row["ratio_max"] > 0.1
    (found,) = [check for check in looked(results.checks) if check.name == "drift ratio of storey"]
    assert found.value == pytest.approx(100.0 * max(row["max"], -row["min"]) / 0.03, rel=1e-12)
    assert (found.allowed, found.unit) == (10.0, "%")
    assert re.search(r"drift ratio of storey .* % +at most +10.0 +look", first_page(results))


def test_a_drift_of_just_a_tenth_is_not_beyond_it():
    ratios = [("below", 0.05), ("at", LARGEST_DRIFT), ("above", 0.2)]
    history = SimpleNamespace(drift_ratios=lambda: ratios)
    assert [(c.name, c.value) for c in drifts(None, history, None)] == [("drift ratio of above", 20.0)]


def test_failed_components_are_told(tmp_path):
    results = run(tmp_path, a=8.0)
    assert results.table("damage")["index"][0] >= 1.0
    assert "damage index of 1 springs and hinges" in looks(results)
    assert "largest over ultimate deformation of 1 springs and hinges" in looks(results)
    assert results.table("worst_hinges")["state"][0] == "failed"


def test_a_gap_far_above_the_motion_is_told(tmp_path):
    """As one in mm among metres; below a hundredth of it the structure closes, or hardly."""
    for factor, told in ((30.0, False), (300.0, True)):
        first = run(tmp_path, a=0.3)
        closed = 0.004 - first.table("contact_summary")["min_gap"][0]
        gap = factor * closed
        deck = tmp_path / "far.inp"
        text = DECK.replace("GAP=0.004", f"GAP={gap}")
        deck.write_text(text.format(units="kN m s", g=9.81, h=3.0, x=5.0, k=1e5, a=0.3))
        results = results_of(deck)
        found = [c for c in looked(results.checks) if "largest share of a gap" in c.name]
        left = results.table("contact_summary")["min_gap"][0] / gap
        assert len(found) == told
        for check in found:
            assert check.name.endswith("contact 9") and (check.allowed, check.unit) == (1.0, "%")
            assert check.value == pytest.approx(100.0 * (1.0 - left), rel=1e-9)
            assert check.value == pytest.approx(100.0 / factor, rel=0.05)


def test_a_contact_pressed_into_its_building_is_told(tmp_path):
    soft = run(tmp_path, k=100.0, a=5.0)
    share = soft.table("contact_summary")["peak_penetration"][0] / 3.0
    assert share > 0.02 and "overlap of contact 9 over the shortest member there" in looks(soft)
    assert "overlap of contact 9 over the shortest member there" not in looks(run(tmp_path, k=1e6, a=3.0))


def test_a_force_of_many_weights_is_told(tmp_path):
    told = "force of contact 9 over the weight of the lighter building"
    stiff = run(tmp_path, k=1e9, a=6.0)
    (check,) = (c for c in looked(stiff.checks) if c.name == told)
    force = stiff.table("contact_summary")["peak_force"][0]
    assert check.value == pytest.approx(abs(force) / 200.0) and check.value > check.allowed == 100.0
    assert told not in looks(run(tmp_path, k=1e6, a=6.0))


@pytest.mark.full
def test_a_hinge_that_its_rule_fails_is_told(tmp_path):
    """IMK loses all strength at DU; the deck asks for no damage index."""
    rule = "RULE=IMK_BILINEAR R=0.02 DP=0.02 DPC=0.05 DU=0.04"
    text = DECK.replace("RULE=BILINEAR R=0.05 DUCTU=4", rule)
    for a, failed in ((8.0, True), (1.0, False)):
        deck = tmp_path / f"{a:g}.inp"
        deck.write_text(text.format(units="kN m s", g=9.81, h=3.0, x=5.0, k=1e5, a=a))
        results = results_of(deck)
        told = "springs and hinges without strength, first 1 X"
        assert (told in looks(results)) == failed
        worst = results.table("worst_hinges")["state"].tolist() if "worst_hinges" in results.tables else []
        assert (worst == ["failed"]) == failed


FRAME = """UNITS kN m s
GRAVITY 9.81
NODES
 1 TO 2  0 TO 5  0   FIX=XYR
 11 TO 12  0 TO 5  3
ELEMENTS
 1 TO 2  COL  1 TO 2  11 TO 12
 3 BEAM 11 12
PROPS
 COL FRAME E=27E6 A=0.2 I=1E-3 LP=0.3 MI=100 MJ=200 RULE=BILINEAR R=0.02 {items}
 BEAM FRAME E=27E6 A=0.2 I=1E-2
WEIGHTS
 11 TO 12 200
EQUAKE
 SINE AMPLITUDE={a} PERIOD=0.5 DURATION=1
ANALYSIS
 HISTORY 1
"""


@pytest.mark.full
@pytest.mark.parametrize(
    ("items", "a", "told"), [("", 6.0, True), ("DUCTU=30", 6.0, False), ("", 2.0, False)]
)
def test_a_hinge_turned_beyond_ordinary_members_is_told(tmp_path, items, a, told):
    """Where the deck does not say how far hinges go; a row holds both ends of a member."""
    deck = tmp_path / "model.inp"
    deck.write_text(FRAME.format(items=items, a=a))
    results = results_of(deck)
    springs = {(r["element"], r["component"]): r for r in results.table("spring_envelope")}
    worst = results.table("worst_hinges")
    assert sorted(worst["element"]) == [1, 2]
    for row in worst:
        ends = [springs[row["element"], f"hinge {end}"] for end in "IJ"]
        weak, strong = sorted(ends, key=lambda r: -r["ductility"])
        assert row["component"] == weak["component"]
        assert (row["ductility"], row["ductility_other"]) == (weak["ductility"], strong["ductility"])
        at_yield = 100 * 0.3 / 27e3
        turned = max(weak["deformation_max"], -weak["deformation_min"])
        assert row["rotation"] == pytest.approx(turned - at_yield, rel=1e-12)
        assert (row["rotation"] > 0.02) == (a == 6.0)
        assert (row["state"] == "look: beyond ordinary rotations") == told
    found = [c for c in looks(results) if c.startswith("plastic rotation of 2 hinges, largest hinge I")]
    assert bool(found) == told and ("FEMA 356" in first_page(results)) == told


@pytest.mark.full
def test_an_overlap_beyond_what_the_law_means_is_told(tmp_path):
    """Points of a table that end at 2 mm."""
    for a, told in ((6.0, True), (0.05, False)):
        deck = tmp_path / f"{a:g}.inp"
        text = DECK.replace("LAW=LINEAR K={k}", "LAW=TABLE DEPTHS=0.001,0.002 FORCES=100,300")
        deck.write_text(text.format(units="kN m s", g=9.81, h=3.0, x=5.0, a=a))
        results = results_of(deck)
        assert ("overlap of contact 9 beyond its law" in looks(results)) == told
        allowed = [(c.allowed, c.unit) for c in looked(results.checks) if "beyond its law" in c.name]
        assert allowed == [(0.002, "m")] * told


@pytest.mark.parametrize(
    ("law", "limit"),
    [
        ("TABLE DEPTHS=0.001,0.002 FORCES=100,300", 0.002),
        ("RUBBER_BUMPER K=1E6 E=0.6 THICKNESS=0.003 KU=1E8", 0.003),
        ("RUBBER_BUMPER K=1E6 E=0.6", np.inf),
        ("KELVIN_VOIGT K=1E6 E=0.6", np.inf),
    ],
)
def test_laws_tell_what_overlap_they_are_meant_for(law, limit):
    bumper = f"PROPS\n W CONTACT GAP=0.01 LAW={law}\n"
    deck = "NODES\n 1 0 0 FIX=YR\nELEMENTS\n 9 W 1\nWEIGHTS\n 1 10\n" + bumper
    assert structure_of(deck).laws[0].facts["limit"] == limit


@pytest.mark.parametrize(("units", "g", "told"), [("kN mm s", 9.81, "m"), ("kN m s", 981, "cm")])
def test_gravity_of_another_unit_is_told_on_the_first_page(tmp_path, units, g, told):
    page = " ".join(first_page(run(tmp_path, units=units, g=g)).split())
    assert f"GRAVITY is {g:g}, that of {told}, but" in page


def test_a_motion_beyond_any_earthquake_is_told_on_the_first_page(tmp_path):
    assert "R404" in first_page(run(tmp_path, a=32.0))


RECORD_OF = {
    "gal without its unit": (818.0, "DT=0.01", "is 818 g; it would be 0.834 g if"),
    "multiplied by g twice": (0.28, "DT=0.01 SCALE=9.81", "SCALE=9.81 is gravity"),
    "m/s^2 read as g": (2.75, "DT=0.01", "is 2.75 g; it would be 0.28 g if"),
}


@pytest.mark.full
@pytest.mark.parametrize("case", RECORD_OF)
def test_a_record_in_another_unit_is_told_on_the_first_page(tmp_path, case):
    peak, items, told = RECORD_OF[case]
    t = np.arange(300) * 0.01
    samples = peak * np.sin(2 * np.pi * t / 0.5) * np.sin(np.pi * t / 3.0)
    samples *= peak / np.abs(samples).max()
    (tmp_path / "a.txt").write_text("".join(f"{x:.6f}\n" for x in samples))
    text = DECK.replace("SINE AMPLITUDE={a} PERIOD=0.7 DURATION=3", f'RECORD "a.txt" {items}')
    deck = tmp_path / "model.inp"
    deck.write_text(text.format(units="kN m s", g=9.81, h=3.0, x=5.0, k=1e5))
    results = pound_solve.run(deck)
    page = " ".join(first_page(results).split())
    assert "R404" in page and told in page
    assert ("R404" in results.table("warnings")["number"].tolist()) and "R404" in deck.with_suffix(
        ".rpt"
    ).read_text()


def test_the_overview_names_the_largest_of_all(tmp_path):
    results = run(tmp_path)
    told = dict(results.table("overview").tolist())
    best = results.table("contact_summary")["peak_force"].max()
    assert told["collisions"].endswith("contact 9") and f"{best:.5g} kN" in told["collisions"]
    ratio = results.table("storey_envelope")["drift"][0]
    # the floor's mean drift, with the node beyond the stiff bar
    assert ratio == pytest.approx(results.table("drift_envelope")["ratio_max"][0], rel=1e-3)
    assert told["largest storey drift ratio"] == f"{100 * ratio:.3g} %, building 1 storey 1"
    (summary,) = results.table("building_summary")
    assert (summary["drift"], summary["drift_storey"]) == (100 * ratio, 1)


def on_a_bearing(drift: str, item: str = "") -> str:
    """The deck with a bearing below, from the level {base} up to the foot, whose drift has that name."""
    label = drift.upper()
    return (
        DECK.replace("1 0 0 FIX", "5 0 {base} FIX=XYR\n 1 0 0 FIX")
        .replace("1 0 0 FIX=XYR", "1 0 0 FIX=YR")
        .replace("1 COL 1 2", f"1 COL 1 2\n 3 {label} 5 1")
        .replace("PROPS", f"PROPS\n {label} SPRING KX=300 FX=20 RULE=BILINEAR R=0.1 {item}")
        .replace("2,3 100", "1,2,3 100")
        .replace('"storey" 1 2', f'"storey" 1 2\n "{drift}" 5 1')
    )


def test_a_bearing_is_no_storey(tmp_path):
    """It moves further than it is high, and may stay there; drift ratios are those of the storey above."""
    text = on_a_bearing("bearing")
    for base, name, storey in ((-0.2, "storey", 2), (-2.0, "bearing", 1)):
        deck = tmp_path / "model.inp"
        deck.write_text(text.format(units="kN m s", g=9.81, h=3.0, x=5.0, k=1e5, a=3.0, base=base))
        results = results_of(deck)
        ratio = dict(zip(*(results.table("drift_envelope")[c] for c in ("name", "ratio_max"))))
        assert ratio["storey"] < 0.02 and (np.isnan(ratio["bearing"]) or ratio["bearing"] > 0.02)
        assert np.isnan(ratio["bearing"]) == (storey == 2) == results.holds("bearings")
        told = dict(results.table("overview").tolist())["largest storey drift ratio"]
        assert told.endswith(f", building 1 storey {storey}")
        assert results.table("building_summary")["drift_storey"][0] == storey
        leans = "drift of building 1 storey 1 at the end" in looks(results)
        assert leans == (name == "bearing") and abs(results.history("storey/drift")[-1, 0]) > 0.005


def test_a_bearing_that_is_marked_has_its_displacement_in_lengths(tmp_path):
    """However high the layer, its drift is no ratio of a storey."""
    text = on_a_bearing("isolator", "BEARING=YES")
    deck = tmp_path / "model.inp"
    deck.write_text(text.format(units="kN m s", g=9.81, h=3.0, x=5.0, k=1e5, a=3.0, base=-2.0))
    results = results_of(deck)
    (row,) = results.table("bearings")
    (layer, storey) = results.table("storey_envelope")
    ratios = results.history("storey/drift")[:, 0]
    assert row["displacement"] == pytest.approx(2.0 * np.abs(ratios).max(), rel=1e-3)
    assert row["residual"] == pytest.approx(2.0 * ratios[-1]) and row["shear"] == layer["shear"]
    assert np.isnan(layer["drift"]) and storey["drift"] > 0.0
    assert results.table("building_summary")["drift_storey"][0] == 2
    by_name = {r["name"]: r for r in results.table("drift_envelope")}
    assert np.isnan(by_name["isolator"]["ratio_max"]) and by_name["storey"]["ratio_max"] > 0.0
    assert "layer of bearings" in first_page(results)
    assert "drift of building 1 storey 1 at the end" not in looks(results)


def test_a_low_storey_that_is_no_bearing_is_a_storey(tmp_path):
    text = DECK.replace("1 COL 1 2", "1 COL 1 2\n 3 TALL 2 4").replace(
        " 3 {x} {h} FIX=YR", " 3 {x} {h} FIX=YR\n 4 0 {h}+6 FIX=YR"
    )
    text = text.replace("PROPS", "PROPS\n TALL SPRING KX=4000").replace("2,3 100", "2 TO 4 100")
    deck = tmp_path / "model.inp"
    for word, count in (("", 1), ("BEARING=NO", 0)):
        marked = text.replace(" COL SPRING", f" COL SPRING {word}")
        deck.write_text(marked.format(units="kN m s", g=9.81, h=1.0, x=5.0, k=1e5, a=1.0))
        results = results_of(deck)
        assert len(results.table("bearings")) == count
        assert np.isnan(results.table("storey_envelope")["drift"][0]) == bool(count)


def test_a_slider_alone_is_no_storey(tmp_path):
    """The storey above it has no line under DRIFT, but a height."""
    text = (
        DECK.replace("1 COL 1 2", "1 SLIDER 1 2\n 3 COL 2 4")
        .replace(" 3 {x} {h} FIX=YR", " 3 {x} {h} FIX=YR\n 4 0 {h}+3 FIX=YR")
        .replace("PROPS", "PROPS\n SLIDER SPRING KX=4E4 FX=4 RULE=ELASTO_PLASTIC")
        .replace("2,3 100", "2 TO 4 100")
    )
    deck = tmp_path / "model.inp"
    deck.write_text(text.format(units="kN m s", g=9.81, h=0.2, x=5.0, k=1e6, a=-3.0))
    results = results_of(deck)
    (drift,) = results.table("drift_envelope")
    assert np.isnan(drift["ratio_max"]) and max(drift["max"], -drift["min"]) > LARGEST_DRIFT * 0.2
    assert not looks(results)


def test_overlaps_are_those_of_members_or_storeys_and_not_of_bearings(tmp_path):
    """A bearing is as long as the joint it bridges."""
    bearing = DECK.replace("9 WALL 3", "9 WALL 3\n 4 BEARING 3 4").replace(
        "ELEMENTS", " 4 {x}+0.05 {h} FIX=XYR\nELEMENTS"
    )
    model = structure_of(
        bearing.replace("PROPS", "PROPS\n BEARING SPRING KX=100").format(
            units="kN m s", g=9.81, h=3.0, x=5.0, k=1e5, a=1.0
        )
    ).model
    members, others = lengths(model)
    assert members == {2: 5.0, 3: 5.0}
    assert others == pytest.approx({1: 3.0, 2: 3.0, 3: 0.05, 4: 0.05})


def test_the_report_names_the_warnings_that_are_not_told(tmp_path):
    deck = tmp_path / "model.inp"
    text = DECK.format(units="kN m s", g=9.81, h=3.0, x=5.0, k=1e5, a=1.0)
    deck.write_text(f"MEANT P359,P334\n{text}".replace("HISTORY 4", "HISTORY 0.1"))
    values = {row["item"]: row["value"] for row in results_of(deck).table("options")}
    assert values["MEANT"] == "P334, P359"


def test_the_moments_of_what_has_no_height_balance(tmp_path):
    """A girder that lies on two bearings: a moment counts beside the forces times its length."""
    text = (Path(__file__).parent / "sound" / "girder_on_bearings.inp").read_text("utf-8")
    deck = tmp_path / "model.inp"
    deck.write_text(text.replace("LAW=LINEAR", "LAW=HUNT_CROSSLEY E=0.5").replace("HISTORY 8", "HISTORY 3"))
    assert not looks(results_of(deck))


def test_a_building_that_leans_after_the_motion_is_told(tmp_path):
    """A spring that yields to one side keeps a drift; one that yields less, or not, has nothing to tell."""
    for a, h, told in ((6.0, 3.0, True), (0.3, 3.0, False)):
        results = run(tmp_path, a=a, h=h)
        residual = abs(results.history("storey/drift")[-1, 0])
        assert (residual > 0.005) == told
        assert ("drift of building 1 storey 1 at the end" in looks(results)) == told
        assert ("it leans: check strengths" in " ".join(first_page(results).split())) == told


def test_the_overview_tells_what_the_response_rests_on(tmp_path):
    """Periods of each building, damping and the law of the contacts, before the response itself."""
    deck = tmp_path / "model.inp"
    text = DECK.format(units="kN m s", g=9.81, h=3.0, x=5.0, k=1e5, a=0.3)
    text = text.replace("LAW=LINEAR", "LAW=KELVIN_VOIGT E=0.6")
    deck.write_text(text.replace("ANALYSIS", "DAMPING\n MODAL XI=0.05\nANALYSIS\n MODAL"))
    results = results_of(deck)
    told = dict(results.table("overview").tolist())
    summary = results.table("building_summary")[0]
    assert summary["period"] == pytest.approx(2 * np.pi * np.sqrt(200 / 9.81 / 4000), rel=1e-3)
    assert summary["weight"] == pytest.approx(200.0) and summary["modal_mass"] == pytest.approx(100.0)
    assert told["damping"].startswith("MODAL: XI 0.05")
    assert told["contact law"] == "KELVIN_VOIGT, 1e+05 kN/m, restitution 0.6, gap 0.004 m"


def test_the_overview_has_the_largest_storey_drift_where_no_drift_is_asked_for(tmp_path):
    deck = tmp_path / "model.inp"
    text = DECK.replace('DRIFT\n "storey" 1 2\n', "")
    deck.write_text(text.format(units="kN m s", g=9.81, h=3.0, x=5.0, k=1e5, a=1.0))
    results = results_of(deck)
    extremes = results.table("storey_extremes")[0]
    assert extremes["unit"] == "-"
    ratio = max(extremes["max"], -extremes["min"])
    told = dict(results.table("overview").tolist())
    assert told["largest storey drift ratio"].startswith(f"{100 * ratio:.3g} %, building 1 storey 1")
