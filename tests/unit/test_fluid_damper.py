"""Fluid dampers against closed forms and an independent integration."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import gamma

from decks import results_of, structure_of
from kernels import FAST
from pound_solve.laws.damper import fluid
from pound_solve.structure.assembly import AssemblyError
from pound_solve.structure.elements.base import Role

pytestmark = pytest.mark.full

MASS = """UNITS kN m s
GRAVITY 10
NODES
 1 0 0 FIX=YR
ELEMENTS
 1 DAMP 1
 {spring}2 BACK 1
PROPS
 DAMP DASHPOT CX={c} {items}
 {spring}BACK SPRING KX={k}
WEIGHTS
 1 {weight} 0
INITIAL
 1 VX=1
{load}ANALYSIS
 HISTORY {end} FROM=REST METHOD={method}
OUTPUT
 EVERY={every}
"""


def run(folder, items, c=2.0, k=0.0, weight=10.0, end=1.0, every=0.05, method="NEWMARK DT=1E-3", load=""):
    deck = folder / "damper.inp"
    spring = "" if k else "! "
    deck.write_text(
        MASS.format(
            items=items,
            c=c,
            k=k,
            weight=weight,
            end=end,
            every=every,
            method=method,
            load=load,
            spring=spring,
        )
    )
    return results_of(deck)


def moved(results):
    """Displacements and velocities of the mass."""
    assert results.status == "done", results.message
    return results.history("node/u")[:, 0, 0], results.history("node/v")[:, 0, 0]


def residual(results):
    return float(results.table("checks")["value"][0])


# ---------------------------------------------------------------------- without a spring


@pytest.mark.parametrize("alpha", [0.5, 1.0, 2.0])
def test_a_mass_that_is_braked(tmp_path, alpha):
    """m v' = -C v^alpha from 1: v^(1 - alpha) = 1 - (1 - alpha) C t / m; for 0.5 to a standstill."""
    results = run(tmp_path, f"ALPHA={alpha} FX=1E6", end=1.2)
    t = np.arange(25) * 0.05
    if alpha == 1.0:
        expected = np.exp(-2.0 * t)
    else:
        expected = np.maximum(1.0 - (1.0 - alpha) * 2.0 * t, 0.0) ** (1.0 / (1.0 - alpha))
    v = moved(results)[1]
    assert v == pytest.approx(expected, abs=1e-6)
    (row,) = results.table("spring_envelope")
    assert (row["component"], row["rule"], row["unit"]) == ("X", "FLUID", "kN")
    assert row["force_max"] == pytest.approx(2.0, rel=1e-12)
    assert row["plastic_work"] == pytest.approx(0.5 - 0.5 * v[-1] ** 2, rel=1e-5)
    assert residual(results) < 1e-5


def test_a_linear_one_is_a_matrix(tmp_path):
    """And gives the same motion as the law, with EXACT too."""
    as_law = moved(run(tmp_path, "FX=1E6", k=40.0, method="NEWMARK DT=1E-4"))
    as_matrix = moved(run(tmp_path, "", k=40.0, method="EXACT"))
    assert as_law[0] == pytest.approx(as_matrix[0], abs=2e-8)
    assert structure_of(MASS.format(**PLAIN)).laws == ()


PLAIN = {
    "items": "",
    "c": 2,
    "k": 40,
    "weight": 10,
    "end": 1,
    "every": 1,
    "method": "EXACT",
    "load": "",
    "spring": "",
}


def test_a_force_limit(tmp_path):
    """Braked at the limit 1.5 from the rate 1 to 0.75, which takes 1/6, then exponentially."""
    v = moved(run(tmp_path, "FX=1.5"))[1]
    t, until = np.arange(21) * 0.05, 1.0 / 6.0
    expected = np.where(t < until, 1.0 - 1.5 * t, 0.75 * np.exp(-2.0 * (t - until)))
    assert v == pytest.approx(expected, abs=1e-6)


def test_a_play(tmp_path):
    """Free for 0.2, braked from there on; a mass that starts beyond it the other way is braked at once."""
    t = np.arange(21) * 0.05
    v = moved(run(tmp_path, "GAPX=0.2,-0.1"))[1]
    assert v == pytest.approx(np.where(t < 0.2, 1.0, np.exp(-2.0 * (t - 0.2))), abs=1e-6)
    v = moved(run(tmp_path, "GAPX=0.9,-0.1", load="INITIAL\n 1 UX=-0.3\n", c=1.0))[1]
    # beyond the play it resists the way back: x = 1 - exp(-t) is 0.2 at its end
    slow = 0.8
    assert v == pytest.approx(np.where(t < math.log(1.25), np.exp(-t), slow), abs=1e-6)


# ---------------------------------------------------------------------- with a spring


def independent(alpha, c, k, end, every, force=0.0, omega=0.0, play=0.0, limit=math.inf):
    """Motion from the rate 1, by DOP853 between the instants at which the law has a corner."""

    def drag(side, rate, inside):
        return 0.0 if inside else side * min(c * abs(rate) ** alpha, limit)

    times = np.linspace(0.0, end, round(end / every) + 1)
    out, t, y, side, inside = np.empty((2, len(times))), 0.0, np.array([0.0, 1.0]), 1.0, play > 0.0
    while True:

        def slope(t, y, side=side, inside=inside):
            return [y[1], force * math.sin(omega * t) - k * y[0] - drag(side, y[1], inside)]

        def turn(t, y):
            return y[1]

        def edge(t, y):
            return abs(y[0]) - play

        def full(t, y):
            return c * abs(y[1]) ** alpha - limit if limit < math.inf else 1.0

        turn.direction, edge.direction = -side, 1.0 if inside else -1.0
        watched = [turn, *([edge] if play else []), full]
        for event in watched:
            event.terminal = True
        at = np.flatnonzero(times >= t)
        found = solve_ivp(
            slope, (t, end), y, "DOP853", times[at], events=watched, rtol=1e-12, atol=1e-14, max_step=0.05
        )
        out[:, at[: len(found.t)]] = found.y
        if found.status == 0:
            return out
        n = next(i for i, x in enumerate(found.t_events) if len(x))
        t, y = float(found.t_events[n][0]), found.y_events[n][0].copy()
        if watched[n] is turn:
            side, y[1] = -side, 0.0
            push = force * math.sin(omega * t) - k * y[0]
            t, y = t + 1e-13, y + 1e-13 * np.array([0.0, push])
        elif watched[n] is edge:
            inside = not inside
            y[0] += math.copysign(1e-15, y[1])
        else:
            t, y = t + 1e-13, y + 1e-13 * np.array(slope(t, y))


@FAST
@pytest.mark.parametrize(("alpha", "step"), [(0.3, 2e-6), (0.5, 4e-6), (1.5, 1.25e-5), (2.0, 1.25e-5)])
def test_free_vibration(tmp_path, alpha, step):
    results = run(tmp_path, f"ALPHA={alpha}", k=40.0, end=2.0, method=f"NEWMARK DT={step}")
    u, v = moved(results)
    expected = independent(alpha, 2.0, 40.0, 2.0, 0.05)
    assert np.abs(u - expected[0]).max() < 1e-8 * np.abs(expected[0]).max()
    assert np.abs(v - expected[1]).max() < 1e-8
    assert residual(results) < 1e-8


@FAST
@pytest.mark.parametrize(("alpha", "step"), [(0.5, 4e-6), (2.0, 1.25e-5)])
def test_vibration_under_a_sine(tmp_path, alpha, step):
    sine = "FORCES\n SINE 1 FX=6 OMEGA=5\n"
    results = run(tmp_path, f"ALPHA={alpha}", k=40.0, end=2.0, method=f"NEWMARK DT={step}", load=sine)
    u, v = moved(results)
    expected = independent(alpha, 2.0, 40.0, 2.0, 0.05, force=6.0, omega=5.0)
    assert np.abs(u - expected[0]).max() < 1e-8 * np.abs(expected[0]).max()
    assert np.abs(v - expected[1]).max() < 1e-8 * np.abs(expected[1]).max()
    assert residual(results) < 1e-6


@FAST
@pytest.mark.parametrize("alpha", [0.2, 0.5, 1.0, 2.0])
def test_energy_of_a_cycle(tmp_path, alpha):
    """Of a motion A sin(omega t) that the damper does not change, of a mass of 1E10:
    4 C A^(1 + alpha) omega^alpha 2^alpha Gamma(1 + alpha/2)^2 / Gamma(2 + alpha).
    """
    omega, c = 5.0, 2.0
    end = 2.0 * math.pi / omega
    results = run(
        tmp_path,
        f"ALPHA={alpha} FX=1E9",
        k=25e10,
        weight=1e11,
        end=end,
        every=end,
        method="NEWMARK DT=1E-5",
    )
    moved(results)
    (row,) = results.table("spring_envelope")
    expected = 4.0 * c / omega * 2.0**alpha * gamma(1.0 + 0.5 * alpha) ** 2 / gamma(2.0 + alpha)
    assert row["plastic_work"] == pytest.approx(expected, rel=2e-7)


@FAST
@pytest.mark.parametrize("items", ["GAPX=0.06", "GAPX=0.06 ALPHA=0.5"])
def test_vibration_through_a_play(tmp_path, items):
    alpha = 0.5 if "ALPHA" in items else 1.0
    results = run(tmp_path, items, k=40.0, end=2.0, method="NEWMARK DT=1E-5")
    expected = independent(alpha, 2.0, 40.0, 2.0, 0.05, play=0.06)
    assert np.abs(moved(results)[0] - expected[0]).max() < 1e-7
    assert residual(results) < 1e-6


# ---------------------------------------------------------------------- the law itself


def test_the_law_walked_by_hand():
    law = fluid.damper(2.0, 0.5, (4.0, -3.0), (0.2, -0.1))
    inside = law.start()
    assert law.branch(inside).name == "in the play" and law.force(inside, 0.1, 9.0)[0] == 0.0
    assert [e.constant for e in law.branch(inside).events] == [-0.2, -0.1]
    out = law.transition(inside, 0, 0.2, 1.0)
    assert law.force(out, 0.3, 1.0) == (2.0, 0.0, 1.0) and law.dissipated_power(out, 0.3, 4.0) == 16.0
    back = law.transition(out, 0, 0.3, -1e-12)
    assert law.branch(back).name == "shortening" and law.force(back, 0.3, -1.0)[0] == -2.0
    # the limits of 4 and 3 are reached at the rates 4 and 2.25
    assert law.branch(law.transition(inside, 0, 0.2, 4.1)).name == "extending at the limit"
    held = law.transition(back, 1, 0.25, -2.25)
    assert law.force(held, 0.25, -9.0)[0] == -3.0
    assert law.branch(law.transition(held, 0, 0.22, -2.25)).name == "shortening"
    assert law.branch(law.transition(held, 1, 0.2, -2.5)) == law.branch(inside)
    assert law.stored(held, 0.25) == law.work(held, 0.25) == 0.0


@pytest.mark.parametrize("alpha", [0.2, 0.5, 1.0, 1.7, 3.0])
def test_the_force_is_odd_and_its_slope_is_its_own(alpha):
    law = fluid.damper(2.0, alpha)
    out = law.start()
    back = law.transition(out, 0, 0.0, -1e-12)
    for v in (1e-13, 1e-6, 0.3, 5.0):
        f, k, c = law.force(out, 0.0, v)
        assert law.force(back, 0.0, -v) == (-f, k, c)
        h = 1e-6 * v
        slope = (law.force(out, 0.0, v + h)[0] - law.force(out, 0.0, v - h)[0]) / (2.0 * h)
        assert c == pytest.approx(slope, rel=1e-7)
    assert law.force(out, 0.0, 0.3)[0] == pytest.approx(2.0 * 0.3**alpha, rel=1e-14)


# ---------------------------------------------------------------------- decks


def test_components_and_their_role():
    text = MASS.format(**{**PLAIN, "items": "CR=3 ALPHA=0.5 MR=2,-1 GAPR=0.1"}).replace(
        "1 0 0 FIX=YR", "1 0 0 FIX=Y"
    )
    x, r = structure_of(text).laws
    assert (x.component, x.unit, r.component, r.unit) == ("X", "F", "R", "F*L")
    assert x.role is r.role is Role.DAMPER and x.k0 == 0.0
    assert r.law.p[3:5] == (2.0, 1.0) and r.law.p[7:] == (0.1, -0.1)


@pytest.mark.parametrize(
    ("items", "words"),
    [
        ("FX=0", "FX, the largest force, is not 0"),
        ("FX=-1", "FX needs a positive value, then a negative one"),
        ("GAPX=0.1,0.2", "GAPX needs a positive value, then a negative one"),
        ("FY=1", "FY has no effect without CY"),
        ("GAPR=1", "GAPR has no effect without CR"),
    ],
)
def test_half_said(items, words):
    with pytest.raises(AssemblyError, match=words):
        structure_of(MASS.format(**{**PLAIN, "items": items}))


@pytest.mark.parametrize(
    ("method", "words"),
    [
        ("EXACT", "the law FLUID of element 1 is curved"),
        ("LAPLACE DT=1E-3", "the law FLUID of element 1 is curved"),
        ("NEWMARK DT=1E-3 EVENTS=STEPPED", "the damper FLUID (element 1) needs steps with EVENTS=LOCATED"),
    ],
)
def test_methods_that_do_not_take_it(tmp_path, method, words):
    results = run(tmp_path, "ALPHA=0.5", k=40.0, method=method)
    assert results.status != "done" and words in results.message


@FAST
def test_auto_takes_series(tmp_path):
    results = run(tmp_path, "ALPHA=0.5", k=40.0, method="AUTO")
    expected = independent(0.5, 2.0, 40.0, 1.0, 0.05)
    assert moved(results)[0] == pytest.approx(expected[0], abs=1e-10)


@FAST
def test_auto_takes_steps_where_a_damper_hardly_moves(tmp_path):
    """One that brakes at once and then resists like dry friction a load that grows from nothing."""
    load = "FORCES\n TABLE 1 FX=1 POINTS=0,0,1,6\n"
    results = run(tmp_path, "ALPHA=0.15", c=20.0, k=40.0, method="AUTO", load=load)
    assert results.status == "done", results.message
    methods = [row["value"] for row in results.table("run") if row["item"] == "method"]
    assert methods[0].startswith("NEWMARK")
