"""MASONRY_STRUT: envelope, curves and energies by hand, and OpenSees beside it."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from paths import Walk, turning_points
from pound_solve.catalog import catalog
from pound_solve.laws.automaton import Law, State, drive
from pound_solve.laws.hysteresis import masonry_strut
from pound_solve.laws.refusal import ItemError
from verification.cases import run_text

pytestmark = pytest.mark.full

K, STRENGTH = 10.0, 20.0
SPEC = catalog().family("hysteresis")["MASONRY_STRUT"]


def strut(dm: float = 4.0, du: float = 12.0, **values: float) -> Law:
    """Law of the deck's defaults except for `values`."""
    base: dict[str, Any] = {f.name: f.default for f in SPEC.fields}
    return masonry_strut.build(base | {"DM": dm, "DU": du} | values, K, STRENGTH, -STRENGTH)


def test_the_envelope_begins_with_k_and_has_its_peak_at_dm() -> None:
    for dm, du in ((3.0, 6.0), (4.0, 12.0), (20.0, 22.0), (40.0, 400.0)):
        law = strut(dm, du)
        start = drive(law, law.start(), 0.0, -1e-9)
        assert law.force(start, -1e-9)[1] == pytest.approx(K, rel=1e-8)
        at_peak = drive(law, law.start(), 0.0, -dm)
        assert law.force(at_peak, -dm)[:2] == pytest.approx((-STRENGTH, 0.0), abs=1e-12)
        half = 0.5 * (dm + du)
        assert Walk(law).move(-half).force == pytest.approx(-0.75 * STRENGTH, rel=1e-14)
        walk = Walk(law).move(-du - 1e-9)
        assert walk.names >= {"on the envelope", "crushing", "failed"} and walk.force == 0.0
        assert walk.move(1.0, -0.5 * du).force == 0.0


def test_an_envelope_above_the_initial_tangent_is_refused() -> None:
    strut(1.5 * 2.0, 6.0)  # 2 - DM/DU = 1.5, F/K = 2
    with pytest.raises(ItemError, match="DM must be at least") as told:
        strut(2.999, 5.999)
    assert told.value.item == "DM"
    with pytest.raises(ItemError, match="DU is above DM"):
        strut(4.0, 4.0)
    with pytest.raises(ValueError, match="negative yield force"):
        masonry_strut.build({}, K, STRENGTH, 0.0)


def test_there_is_no_tension() -> None:
    walk = Walk(strut()).move(-2.0, 5.0, -3.0, 1.0, 8.0)
    assert max(walk.law.force(s, d)[0] for s, a, b in walk.visits for d in (a, b)) == 0.0


@pytest.mark.parametrize(("dcl", "closes"), [(0.0, 0.0), (0.5, -0.5), (-0.3, 0.3), (-4.0, None)])
def test_a_strut_closes_at_dcl_or_at_its_plastic_shortening(dcl: float, closes: float | None) -> None:
    """From the strength, 20 at 4: the focus is (-3.5, -35), the plastic shortening 4 - 20 * 7.5 / 55."""
    law, plastic = strut(DCL=dcl), 4.0 - 20.0 * 7.5 / 55.0
    walk = Walk(law).move(-4.0, 2.0, -3.0)
    (begins,) = (-a for s, a, b in walk.visits if law.branch(s).name == "closing" and a != b)
    assert begins == pytest.approx(plastic if closes is None else closes, abs=1e-14)


def test_a_strut_fails_where_its_return_would_be_beyond_the_ultimate_shortening() -> None:
    walk = Walk(strut(4.0, 6.0, ARE=1.0)).move(-5.0, 0.5, -1.0)
    assert walk.law.branch(walk.state).name == "failed" and walk.force == 0.0


@pytest.mark.parametrize("r1", [0.3, 1.0, 1.5, 2.0, 3.0, 20.0, 400.0, 2e3])
@pytest.mark.parametrize("r2", [0.0, 0.25, 0.5, 1.0])
def test_the_area_of_a_curve(r1: float, r2: float) -> None:
    """Against quadrature in parts, which shrink towards the pole near 0."""
    q = 2.0 - r2 * (1.0 + r1)
    numbers = (r1, 1.0, r1 - q, q)
    for x0, x in ((0.0, 1.0), (0.2, 0.7), (-0.3, 1.4)):
        parts = [x0, *(y for y in (0.0, *np.geomspace(1e-7, 1.0, 22)) if x0 < y < x), x]
        expected = math.fsum(quad(height, *ends, args=numbers, epsabs=0.0)[0] for ends in pairwise(parts))
        assert masonry_strut.integral(*numbers, x0, x) == pytest.approx(expected, rel=1e-10)
        assert masonry_strut.integral(*numbers, x, x0) == pytest.approx(-expected, rel=1e-10)


def height(x: float, *numbers: float) -> float:
    return masonry_strut.quotient(*numbers, x)[0]


@pytest.mark.parametrize("c", [0.5, 3.0, 40.0, 400.0, 1e4])
def test_the_area_of_a_curve_whose_denominator_is_linear(c: float) -> None:
    a = c + 1.5
    closed = 1.0 / (2.0 * c) + (a - 1.0 / c) * (1.0 / c - math.log1p(c) / c**2)
    assert masonry_strut.integral(a, 1.0, c, 0.0, 0.0, 1.0) == pytest.approx(closed, rel=1e-11)


def test_no_loop_gives_energy_at_any_time() -> None:
    """When unloading, no less is lost than when the last unloading ended, on loops that stay in compression
    too; without the limit the last set of values would give back more than it took.
    """
    rng = np.random.default_rng(3)
    for _ in range(60):
        dm = rng.uniform(4.0, 12.0)
        du = dm * rng.uniform(1.1, 5.0)
        law = strut(
            dm,
            du,
            DCL=rng.uniform(-dm, dm),
            ACH=rng.uniform(0.0, 0.95),
            ARE=rng.uniform(0.0, 1.0),
            BA=rng.uniform(0.3, 4.0),
            BCH=rng.uniform(0.5, 0.95),
            GUN=rng.uniform(1.5, 5.0),
            GPLU=rng.uniform(0.0, 1.0),
            EX1=rng.uniform(0.0, 3.0),
        )
        lost_never_decreases(law, [-abs(x) for x in turning_points(int(rng.integers(1000)), 0.9 * du, 40)])
    law = strut(4.3, 5.08, DCL=1.14, ACH=0.8623, ARE=0.0676, BA=0.3955, GUN=4.7088, GPLU=0.1691, EX1=0.3964)
    lost_never_decreases(law, [-2.0, *10 * (0.0, -3.08), 0.0])


def lost_never_decreases(law: Law, path: list[float]) -> None:
    state, d, lost = law.start(), 0.0, 0.0
    for goal in path:
        state = drive(law, state, d, goal)
        d, now = goal, law.work(state, goal) - law.stored(state, goal)
        assert now >= lost - 1e-11 * K * law.p[3] ** 2
        if law.branch(state).name in ("unloading", "opening", "open"):
            lost = now


def test_a_curve_of_unloading_is_steepened_to_the_energy_that_is_there() -> None:
    for r1, r2 in ((1.5, 0.5), (3.0, 0.25), (20.0, 0.0)):
        most = masonry_strut.share_left(r1, r2)
        for share in (0.999 * most, 0.5 * most, 0.01 * most):
            s = masonry_strut.steepened(r1, r2, share)
            assert s > 1.0 and masonry_strut.share_left(r1 * s, r2 / s) == pytest.approx(share, rel=1e-9)


@pytest.mark.parametrize("tiny", [0.0, 1e-200, 1e-30, 1e-17, 1e-15, 1e-13, 1e-12, 1e-10, 1e-8])
def test_a_tiny_motion_changes_nothing_else(tiny: float) -> None:
    """Where the strut begins to carry, turns to unloading or returns."""
    for dcl in (0.0, -4.0):
        law = strut(DCL=dcl)
        closes = masonry_strut.closing(law.p, Walk(law).move(-3.0, 1.0).state[3])
        for place in (0.0, -closes, -2.0):
            around = (place - tiny, place, place - tiny, place + tiny)
            state = driven(law, -tiny, 0.0, -3.0, 1.0, *around, 1.0, -3.5)
            plain = driven(law, -3.0, 1.0, place, 1.0, -3.5)
            assert law.force(state, -3.5)[0] == pytest.approx(law.force(plain, -3.5)[0], rel=0.05)
            assert 0.0 <= law.stored(state, -3.5) < law.work(state, -3.5)


def driven(law: Law, *path: float) -> State:
    state = law.start()
    for d, goal in pairwise((0.0, *path)):
        state = drive(law, state, d, goal)
    return state


# uniaxialMaterial Masonry of OpenSees 3.7.1 (openseespy): Fm -20, Ft 0, Um -4, Uult -12, Ucl, Emo 10,
# length and areas 1, Ach 0.45, Are 0.3, Ba 1.75, Bch 0.65, Gun 2, Gplu 0.6, Gplr 1.3 * 0.6 / 2, Exp1 1.75,
# Exp2 1.25, in steps of 1e-3 or 2e-5; a strut closes one step early there: Ucl, path, forces, tolerance
OPENSEES = {
    "0": (
        0.0,
        "-1 -0.6 -1.2 -0.5 -2.1 -1.3 -2.2 -0.9 -1.5 -1.1 -3 -2.2 -3.1 -1.4 -2.9 -2.5 -5 -4.2",
        "-8.97959184 -3.30723174 -10.48543689 -1.94817213 -15.86720092 -4.90262287 -16.23148057 "
        "-1.89440114 -7.82580298 -3.09730475 -18.94736842 -7.49258315 -19.07909505 -1.89133137 "
        "-17.10350047 -10.52634793 -19.6875 -8.88364296",
        1e-8,
    ),
    "0, opened": (
        0.0,
        "-1.5 0.5 -1.2 -0.4 -2.4 -0.8 -2 1 -2.6 -1.1 -1.6 -0.9 -3 0.2 -0.7 0.1 -1.3 -0.6 -2.8 -2 0 -3.4 "
        "0.5 -5.5 -3.2",
        "-12.53731343 0 -8.79536906 -0.87358105 -17.14285714 -1.0801229 -12.55468175 0 -17.47302958 "
        "-1.76920226 -5.79525729 -0.92306696 -18.91008093 0 -0.74161328 0 -3.07789696 -0.34867941 "
        "-16.7982676 -6.76464763 0 -19.47428033 0 -19.296875 -1.64153852",
        2e-4,
    ),
    "0.7": (
        0.7,
        "-1.5 -0.2 -2.5 0.5 -3 -0.3 -1.9 1 -3.2 -1 -2.5 0.3 -1",
        "-12.53731343 -0.06498109 -17.51152074 0 -18.93325407 0 -6.88738006 0 -18.86368468 -0.33654195 "
        "-11.22987388 0 -1.60483062",
        1e-8,
    ),
}


@pytest.mark.parametrize("case", OPENSEES)
def test_as_opensees(case: str) -> None:
    ucl, path, forces, tolerance = OPENSEES[case]
    walk = Walk(strut(DCL=ucl))
    for d, force in zip(path.split(), forces.split(), strict=True):
        assert walk.move(float(d)).force == pytest.approx(float(force), abs=tolerance), d


DECK = """
NODES
 1 0 0 FIX=YR
ELEMENTS
 1 FRAME 1
 2 STRUT 1
PROPS
 FRAME SPRING KX=200 FX=12 RULE=BILINEAR R=0.05
 STRUT SPRING KX=800 FX=8 RULE=MASONRY_STRUT DM=0.02 DU={du}
WEIGHTS
 1 60
GRAVITY 9.81
DAMPING
 MODAL XI=0.05
EQUAKE
 SINE PERIOD=0.5 AMPLITUDE=3
ANALYSIS
 HISTORY 3 METHOD={method}
"""


@pytest.mark.parametrize(("du", "fails"), [(0.06, False), (0.03, True)])
def test_auto_follows_a_frame_with_a_strut(du: float, fails: bool) -> None:
    auto = run_text(DECK.format(du=du, method="AUTO"))
    steps = run_text(DECK.format(du=du, method="NEWMARK DT=0.0002"))
    for run in (auto, steps):
        strut = run.tables["spring_envelope"][1]
        assert strut["force_max"] == pytest.approx(0.0, abs=1e-9) and strut["force_min"] >= -8.0 * (
            1.0 + 1e-12
        )
        assert (strut["deformation_min"] < -du) == fails
        # elongation does not count in the ductility: F/k is 0.01
        assert strut["ductility"] == pytest.approx(-strut["deformation_min"] / 0.01, rel=1e-12)
    ends = [run.tables["spring_envelope"][1]["deformation_min"] for run in (auto, steps)]
    assert ends[0] == pytest.approx(ends[1], rel=1e-3)
