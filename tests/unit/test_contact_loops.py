"""Contact laws that lose energy by hysteresis: BILINEAR_IMPACT and TABLE."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from decks import results_of
from paths import Walk
from pound_solve.catalog import catalog
from pound_solve.laws.automaton import GAP, drive
from pound_solve.laws.contact import bilinear_impact, table

BILINEAR = {
    "GAP": 0.02, "K1": None, "K2": None, "DY": None, "KH": 3000.0, "N": 1.5, "E": 0.6, "DM": 0.04, "A": 0.1,
    "RELATION": "EXACT",
}  # fmt: skip
CRUSH = {"GAP": 0.01, "DEPTHS": (0.1, 0.3, 0.5), "FORCES": (10.0, 6.0, 18.0), "KU": 200.0}
IMPACT = """UNITS N m s
GRAVITY 1
NODES
 1 0 0 FIX=YR
 2 1 0 FIX=YR
ELEMENTS
 1 HIT 1 2
PROPS
 HIT CONTACT GAP={gap} LAW={law}
WEIGHTS
 1 2
 2 6
INITIAL
 1 VX={v}
OUTPUT
 EVERY=0.5
ANALYSIS
 HISTORY {t} FROM=REST METHOD={method}
"""
MASS = 1.5  # reduced, of 2 and 6


def bilinear(mass=MASS, **values):
    return catalog().family("contact")["BILINEAR_IMPACT"].impl(BILINEAR | values, mass)


def crush(mass=MASS, **values):
    return catalog().family("contact")["TABLE"].impl(CRUSH | values, mass)


def impact(folder, law, v, gap=0.02, method="EXACT", t=2.0):
    deck = folder / "impact.inp"
    deck.write_text(IMPACT.format(law=law, v=v, gap=gap, method=method, t=t))
    return results_of(deck)


# ---------------------------------------------------------------------- BILINEAR_IMPACT


def test_published_constants():
    """k_h 25 000 kip/in^1.5, 1 in, e 0.8, a 0.1: the numbers that OpenSees' documentation gives."""
    built = bilinear(KH=25000.0, DM=1.0, E=0.8, RELATION="PUBLISHED")
    assert built.law.p[:4] == pytest.approx((61000.0, 21000.0, 0.02, 0.1), rel=1e-14)
    # the loop loses E = 3600 exactly, but brings 14300 and not the 10000 of a Hertz contact
    assert built.e_given == pytest.approx(math.sqrt(1.0 - 3600.0 / 14300.0), rel=1e-14)
    assert round(built.e_given, 3) == 0.865 and built.e_asked == 0.8


def areas(built, overlap):
    """Work brought up to an overlap and given back, walked exit by exit."""
    gap = built.law.p[GAP]
    walk = Walk(built.law).move(gap + overlap)
    brought = walk.work
    return brought, brought - walk.move(gap - 0.01).work


@given(e=st.floats(0.05, 1.0), n=st.floats(1.0, 3.0), kh=st.floats(1.0, 1e9), dm=st.floats(1e-3, 1e2))
def test_asked_restitution_comes_back_at_the_overlap_expected(e, n, kh, dm):
    a = min(0.1, 0.9 * 2.0 * e * e / (1.0 + e * e))
    built = bilinear(E=e, N=n, KH=kh, DM=dm, A=a, GAP=0.0)
    brought, back = areas(built, dm)
    assert math.sqrt(back / brought) == pytest.approx(e, rel=1e-9)
    assert built.e_given == pytest.approx(e, rel=1e-9)
    # the force there is Hertz'
    assert built.law.force(drive(built.law, built.law.start(), 0.0, dm), dm)[0] == pytest.approx(kh * dm**n)


@pytest.mark.full
@pytest.mark.parametrize("e", [0.05, 0.1, 0.3, 0.65, 0.9, 1.0])
def test_a_free_impact_gives_back_what_was_asked(tmp_path, e):
    a = 0.004 if e < 0.3 else 0.1
    built = bilinear(E=e, A=a)
    k1, k2, _, dy = built.law.p
    v = bilinear_impact.speed(k1, k2, dy, 0.04, MASS)
    results = impact(tmp_path, f"BILINEAR_IMPACT KH=3000 E={e} DM=0.04 A={a}", v)
    (hit,) = results.table("collisions")
    assert hit["separation_velocity"] / hit["approach_velocity"] == pytest.approx(e, rel=1e-9)
    assert hit["peak_force"] == pytest.approx(3000.0 * 0.04**1.5, rel=1e-9)
    assert hit["impulse"] == pytest.approx(MASS * v * (1.0 + e), rel=1e-9)
    lost = results.table("contact_summary")["energy_lost"][0]
    assert lost == pytest.approx(0.5 * MASS * v * v * (1.0 - e * e), rel=1e-9, abs=1e-12)
    assert float(results.table("checks")["value"][0]) < 1e-12
    (law,) = results.table("contact_laws")
    assert law["e_asked"] == e and law["e_given"] == pytest.approx(e, rel=1e-12)


@pytest.mark.full
def test_restitution_of_other_speeds(tmp_path):
    """1 below the first corner, least at the overlap DY (1 + sqrt(K1/K2)), rising again beyond."""
    k1, k2, dy = 900.0, 100.0, 0.01
    worst = dy * (1.0 + math.sqrt(k1 / k2))
    found = {}
    for overlap in (0.9 * dy, 0.5 * worst, worst, 4.0 * worst):
        brought = 0.5 * k1 * min(overlap, dy) ** 2
        if overlap > dy:
            brought += k1 * dy * (overlap - dy) + 0.5 * k2 * (overlap - dy) ** 2
        v = math.sqrt(2.0 * brought / MASS)
        results = impact(tmp_path, f"BILINEAR_IMPACT K1={k1} K2={k2} DY={dy}", v, gap=0.0)
        (hit,) = results.table("collisions")
        found[overlap] = hit["separation_velocity"] / v
        assert found[overlap] == pytest.approx(bilinear_impact.restitution(k1, k2, dy, overlap), rel=1e-9)
    assert found[0.9 * dy] == pytest.approx(1.0, rel=1e-12)
    assert found[worst] == pytest.approx((k2 / k1) ** 0.25, rel=1e-9) == min(found.values())
    (law,) = results.table("contact_laws")
    assert np.isnan(law["e_asked"]) and np.isnan(law["e_given"])
    slow, least = dy * math.sqrt(k1 / MASS), bilinear_impact.speed(k1, k2, dy, worst, MASS)
    assert law["note"] == f"e depends on the speed: 1 up to {slow:.4g}, least, 0.5774, at {least:.4g}"


def test_a_way_through_the_loop_walked_by_hand():
    """K1 100, K2 20, DY 0.1, gap 0: down, up within the loop, down again, part."""
    law = bilinear(K1=100.0, K2=20.0, DY=0.1, KH=None, E=None, DM=None, GAP=0.0).law
    state, d, seen = law.start(), 0.0, []
    for goal in (0.05, 0.02, 0.3, 0.25, 0.28, 0.1, 0.15, 0.3, 0.35, 0.0, -1.0):
        state = drive(law, state, d, goal)
        d = goal
        seen.append((law.branch(state).name, law.force(state, d)[0]))
    assert [name for name, _ in seen] == [
        "pressed", "pressed", "pressed, soft", "pressed", "pressed", "pressed, back", "pressed",
        "pressed, soft", "pressed, soft", "pressed, back", "open",
    ]  # fmt: skip
    # 10 at the corner; 14 at 0.3; K1 down to 9 and up to 12; the lower line 20 d; up from it; soft again
    assert [f for _, f in seen] == pytest.approx([5, 2, 14, 9, 12, 2, 7, 14, 15, 0, 0], abs=1e-13)
    # lost: 8 for each unit of the slider's way, (0.3 - 0.1) - 0.1 from 0.2 back, and so on; by the area
    walk = Walk(law).move(0.05, 0.02, 0.3, 0.25, 0.28, 0.1, 0.15, 0.3, 0.35, -1.0)
    assert law.dissipated(walk.state, -1.0) == pytest.approx(walk.work, rel=1e-13)
    # the slider, force 8 at most, went 0.2, and from 0.1 to 0.25
    assert walk.work == pytest.approx(8.0 * (0.2 + 0.15), rel=1e-13)


LAWS = {
    "bilinear": bilinear(K1=100.0, K2=20.0, DY=0.1, KH=None, E=None, DM=None).law,
    "crushing": crush().law,
    "elastic table": crush(KU=None).law,
    "soft first": crush(DEPTHS=(0.1, 0.2), FORCES=(1.0, 9.0), KU=80.0).law,
}


@pytest.mark.full
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
@given(path=st.lists(st.floats(-0.2, 0.7), min_size=2, max_size=12))
def test_any_path_is_continuous_never_pulls_and_loses_what_it_keeps(law, path):
    walk = Walk(law)
    for goal in path:
        if goal == walk.d:
            continue
        lost = law.dissipated(walk.state, walk.d)
        walk.move(goal)
        assert law.force(walk.state, goal)[0] >= -1e-11
        assert law.dissipated(walk.state, goal) >= lost - 1e-11
        assert law.stored(walk.state, goal) >= -1e-12
        assert law.work(walk.state, goal) == pytest.approx(walk.work, abs=1e-10)
    for (before, _, d), (after, _, _) in itertools.pairwise(walk.visits):
        assert law.force(after, d)[0] == pytest.approx(law.force(before, d)[0], abs=1e-11)
    # what is stored comes back
    stored, at = law.stored(walk.state, walk.d), walk.work
    assert at - walk.move(-1.0).work == pytest.approx(stored, abs=1e-10) if walk.d > -1.0 else True
    assert law.branch(walk.state).name == "open"


# ---------------------------------------------------------------------- TABLE


def test_a_table_that_crushes_walked_by_hand():
    """Points (0.1, 10), (0.3, 6), (0.5, 18), KU 200, gap 0.01."""
    law, gap = crush().law, 0.01
    state, d, seen = law.start(), 0.0, []
    for overlap in (0.05, 0.02, 0.2, 0.1, 0.18, 0.4, 0.6, 0.0, 0.51, 0.55):
        state = drive(law, state, d, gap + overlap)
        d = gap + overlap
        seen.append((law.branch(state).name, law.force(state, d)[0]))
    # 5 at 0.05, residual 0.025; 8 at 0.2, residual 0.16, touched again there; 12; beyond the table 24
    assert [f for _, f in seen] == pytest.approx([5, 0, 8, 0, 4, 12, 24, 0, 6, 14], abs=1e-12)
    names = [
        "segment 1",
        "open",
        "segment 2",
        "open",
        "unloading",
        "segment 3",
        "segment 3",
        "open",
        "unloading",
    ]
    assert [n.removeprefix("pressed, ") for n, _ in seen] == [*names, "unloading"]
    assert state[3][:3] == pytest.approx((0.48, 0.6, 3.0))  # crushed to 0.48 of the 0.6 that was reached


def test_an_elastic_table_gives_all_back(tmp_path):
    results = impact(tmp_path, "TABLE DEPTHS=0.1,0.3,0.5 FORCES=10,6,18", v=2.4, gap=0.0)
    (hit,) = results.table("collisions")
    assert hit["separation_velocity"] == pytest.approx(2.4, rel=1e-10)
    # 1/2 m v^2 = 4.32 = 0.5 + 1.6 + (6 + f)/2 (f - 6)/60
    assert hit["peak_force"] == pytest.approx(math.sqrt(36.0 + 2.0 * 60.0 * 2.22), rel=1e-10)
    (law,) = results.table("contact_laws")
    assert (law["e_given"], law["note"]) == (1.0, "elastic: back along the table")


def test_what_crushes_is_touched_later_the_next_time(tmp_path):
    """A mass thrown twice against a crushing stop by a spring: the second touch is at the crushed depth."""
    deck = tmp_path / "stop.inp"
    deck.write_text("""UNITS N m s
GRAVITY 1
NODES
 1 0 0 FIX=YR
 2 -1 0 FIX=XYR
ELEMENTS
 1 SPRING 2 1
 2 STOP 1
PROPS
 SPRING SPRING KX=1
 STOP CONTACT GAP=0 LAW=TABLE DEPTHS=0.01 FORCES=1 KU=1000
WEIGHTS
 1 1
INITIAL
 1 VX=1
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 4 FROM=REST METHOD=EXACT
""")
    results = results_of(deck)
    first, second = results.table("collisions")[:2]
    # f = 100 d: with the spring 1/2 (1 + 100) d^2 = 1/2; back along 1000 (d - r), r = 0.9 d
    most = 1.0 / math.sqrt(101.0)
    assert first["peak_force"] == pytest.approx(100.0 * most, rel=1e-9)
    residual = 0.9 * most
    # parted at r with v^2 = 1000 (d - r)^2 + d^2 - r^2; back there with the same speed
    v = math.sqrt(1000.0 * (most - residual) ** 2 + most**2 - residual**2)
    assert first["separation_velocity"] == pytest.approx(v, rel=1e-9)
    assert second["approach_velocity"] == pytest.approx(v, rel=1e-9)
    assert second["peak_force"] == pytest.approx(100.0 * most, rel=1e-9)  # the energy that was given back
    (law,) = results.table("contact_laws")
    # to the last point: brought 0.005, back 1/2000
    start = "e depends on the speed: 0.3162 at 0.1, which reaches the last of DEPTHS"
    assert np.isnan(law["e_given"]) and law["note"].startswith(start)


@pytest.mark.full
@pytest.mark.parametrize(
    "law", ["BILINEAR_IMPACT KH=3000 E=0.5 DM=0.2", "TABLE DEPTHS=0.02,0.2 FORCES=40,80 KU=4000"]
)
def test_steps_go_to_the_exact_impact(tmp_path, law):
    exact = impact(tmp_path, law, 2.0).table("collisions")
    errors = []
    for h in (2e-3, 1e-3):
        steps = impact(tmp_path, law, 2.0, method=f"NEWMARK DT={h}").table("collisions")
        assert len(steps) == len(exact) == 1
        # the trapezoidal rule keeps the energy of every linear piece: speeds have no error at all
        assert steps["separation_velocity"] == pytest.approx(exact["separation_velocity"], rel=1e-9)
        assert steps["peak_force"] == pytest.approx(exact["peak_force"], rel=1e-3)
        errors.append(abs((steps["t_end"] - exact["t_end"])[0]))
    assert 3.0 < errors[0] / errors[1] < 5.5 and errors[1] < 1e-4, errors


def test_an_overlap_from_the_start_presses():
    built = bilinear(K1=100.0, K2=20.0, DY=0.1, KH=None, E=None, DM=None, GAP=-0.05)
    start = built.law.start()
    assert built.law.branch(start).name == "pressed" and built.law.force(start, 0.0)[0] == pytest.approx(
        5.0
    )
    crushed = crush(GAP=-0.05).law
    assert crushed.force(crushed.start(), 0.0)[0] == pytest.approx(5.0)


# ---------------------------------------------------------------------- mistakes


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"E": 0.2}, "above 0.2294"),
        ({"E": 0.1, "N": 1.0, "A": 0.6, "RELATION": "PUBLISHED"}, "above 0.4472"),
        ({"K1": 2.0}, "either K1, K2 and DY, or KH, E and DM, not K1, KH, E, DM"),
        ({"KH": None}, "either K1, K2 and DY, or KH, E and DM, not E, DM"),
        ({"KH": None, "E": None, "DM": None}, "either K1, K2 and DY, or KH, E and DM$"),
        ({"KH": None, "E": None, "DM": None, "K1": 1.0, "K2": 2.0, "DY": 1.0}, "K2 2 is above K1 1"),
    ],
)
def test_constants_that_no_loop_has(values, words):
    with pytest.raises(ValueError, match=words):
        bilinear(**values)


def test_least_restitution_is_where_it_says():
    for relation, a in (("EXACT", 0.1), ("PUBLISHED", 0.7)):
        least = 0.2294157 if relation == "EXACT" else 0.5
        bilinear(E=least + 1e-4, A=a, RELATION=relation)
        with pytest.raises(ValueError, match="out of reach"):
            bilinear(E=least - 1e-4, A=a, RELATION=relation)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"DEPTHS": (0.1, 0.2)}, "DEPTHS has 2 values and FORCES 3"),
        ({"DEPTHS": (0.1, 0.3, 0.3)}, "ascend from above 0: 0.3 follows 0.3"),
        ({"FORCES": (10.0, 6.0, 5.0)}, "further point of 5"),
        ({"KU": 99.0}, "KU 99 is below the steepest slope of the table, 100"),
    ],
)
def test_points_that_make_no_table(values, words):
    with pytest.raises(ValueError, match=words):
        crush(**values)


def test_a_table_takes_as_many_points_as_its_parameters_hold():
    n = table.MAX_SEGMENTS
    law = crush(DEPTHS=tuple(range(1, n + 1)), FORCES=tuple(range(1, n + 1)), KU=2.0, GAP=0.0).law
    assert law.force(drive(law, law.start(), 0.0, n + 1.5), n + 1.5)[0] == pytest.approx(n + 1.5)
