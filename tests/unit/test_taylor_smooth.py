"""TAYLOR with smooth hysteresis: an ODE solver's answers, NEWMARK that converges to it, and the law as its
own differential equation.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from kernels import FAST
from pound_deck.schema import Spec
from pound_solve.assess.law_test import specimen
from pound_solve.catalog import catalog
from pound_solve.laws.automaton import drive
from pound_solve.numerics.types import Array
from samples import has_loop
from tiers import at_night, each_once
from unit.test_taylor import LOADS
from unit.test_taylor_massless import hinged
from verification.cases import Ran, run_text

MASS = """UNITS N m s
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
ELEMENTS
 1 K 1 2
PROPS
 K SPRING KX=25 FX={fx} RULE={rule}
WEIGHTS
 2 1
DAMPING
 RAYLEIGH ALPHA=0.1
INITIAL
 2 VX={v}
{load}
OUTPUT
 EVERY=0.1
ANALYSIS
 HISTORY 3 METHOD=TAYLOR
"""


def is_smooth(spec: Spec) -> bool:
    return has_loop(spec) and specimen(spec)[0].law.rule.smooth_curve is not None


K, ALPHA = 25.0, 0.1
KNOTS = np.array([[0.0, -3.0], [0.5, 6.0], [1.1, -5.0], [1.6, 4.0], [2.2, -6.0], [3.0, 5.0]])
SHAKEN = "EQUAKE\n TABLE POINTS=" + ",".join(f"{x:g}" for x in KNOTS.ravel())
TIMES = np.linspace(0.0, 3.0, 31)

YIELD = 2.0, 1.5  #: yield forces of both sides; RAMBERG_OSGOOD has the first on both
SMOOTH = [name for name, spec in catalog().family("hysteresis").items() if is_smooth(spec)]

State = Array
Event = Callable[[float, State], Any]
Rates = Callable[[float], Event]
Turning = Callable[[float], Event]
After = Callable[[int, State], None]


def stretch(rate: Event, t: float, y: State, events: list[Event]) -> Any:
    """Solve up to the first fall of an event function to zero, or the next corner of the excitation."""
    for e in events:
        e.terminal, e.direction = True, -1.0  # type: ignore[attr-defined]
    goal = KNOTS[KNOTS[:, 0] > t + 1e-12, 0][0]
    options = {"rtol": 1e-12, "atol": 1e-15, "max_step": 0.02, "dense_output": True}
    return solve_ivp(rate, (t, goal), y, "DOP853", events=events, **options)


def pushed(t: float, shaken: bool) -> float:
    return -float(np.interp(t, *KNOTS.T)) if shaken else 0.0


def histories(rate: Rates, after: After, y: State, turning: Turning) -> State:
    """Displacements at `TIMES`, by DOP853 from event to event.

    ``rate(moving)`` are the equations of a motion in one direction, ``turning(moving)`` an event function
    beside the reversal, ``after(which, y)`` takes an event in.
    """
    out, t, moving = np.zeros(len(TIMES)), 0.0, float(np.sign(y[1] or pushed(1e-6, True)))
    while t < TIMES[-1]:
        begin, sign = t, moving

        def reversal(t: float, y: State, begin: float = begin, sign: float = sign) -> float:
            return sign * float(y[1]) if t > begin + 1e-9 else 1.0

        s = stretch(rate(moving), t, y, [reversal, turning(moving)])
        seen = (t < TIMES) & (s.t[-1] + 1e-12 >= TIMES)
        if seen.any():
            out[seen] = s.sol(TIMES[seen])[0]
        t, y = s.t[-1], s.y[:, -1]
        for which in range(2):
            if len(s.t_events[which]):
                after(which, y)
                moving *= -1.0 if which == 0 else 1.0
    return out


def bouc_wen(n: float, beta: float, v: float, shaken: bool, behind: float) -> State:
    """Displacements with z as an unknown: u'' = p - alpha u' - f, f = r k d + (1 - r) k z, where a spring
    of stiffness `behind` leaves d the part b / (b + df/dd) of u.
    """
    r, side = 0.1, [float(np.sign(v or pushed(1e-6, shaken)))]

    def rate(moving: float) -> Event:
        def rates(t: float, y: State) -> list[float]:
            _, v, d, z = y
            share = min(abs(z * K / YIELD[0 if side[0] > 0 else 1]), 1.1) ** n  # trials overflow
            share *= 1 - beta + beta * side[0] * moving
            moved = v / (1 + (r * K + (1 - r) * K * (1 - share)) / behind)
            force = r * K * d + (1 - r) * K * z
            return [v, pushed(t, shaken) - ALPHA * v - force, moved, moved * (1 - share)]

        return rates

    def crossing(moving: float) -> Event:
        now = side[0]
        return lambda t, y: now * y[3] if now * moving < 0 else 1.0

    def after(which: int, y: State) -> None:
        side[0] *= -1.0 if which == 1 else 1.0

    return histories(rate, after, np.array([0.0, v, 0.0, 0.0]), crossing)


def ramberg_osgood(n: float, alpha: float, v: float, shaken: bool, behind: float) -> State:
    """Displacements with the force f as an unknown, df/dd = k / (1 + alpha n |w|^(n-1)); reversals are put
    on a list until their loops close.
    """
    turns: list[tuple[float, float]] = []
    fy = YIELD[0]

    def rate(moving: float) -> Event:
        scale, f0 = (2.0, turns[-1][1]) if turns else (1.0, 0.0)

        def rates(t: float, y: State) -> list[float]:
            _, v, _, f = y
            tangent = K / (1 + alpha * n * abs((f - f0) / (scale * fy)) ** (n - 1))
            moved = v / (1 + tangent / behind)
            return [v, pushed(t, shaken) - ALPHA * v - f, moved, tangent * moved]

        return rates

    def closing(moving: float) -> Event:
        closes = -turns[0][0] if len(turns) == 1 else turns[-2][0] if turns else np.inf * moving
        return lambda t, y: moving * (closes - y[2])

    def after(which: int, y: State) -> None:
        if which == 0:
            turns.append((float(y[2]), float(y[3])))
        else:
            del turns[-2:]

    return histories(rate, after, np.array([0.0, v, 0.0, 0.0]), closing)


def ran(rule: str, v: float, shaken: bool, behind: float) -> tuple[Ran, int]:
    """A run, and its number of series."""
    fx = "2,-1.5" if "BOUC" in rule else "2"
    deck = MASS.format(rule=rule, v=v, load=SHAKEN if shaken else "", fx=fx)
    if behind < np.inf:
        deck = deck.replace(" 1 K 1 2", " 1 K 1 3\n 2 BEHIND 3 2").replace(
            "ELEMENTS", " 3 2 0 FIX=YR\nELEMENTS"
        )
        deck = deck.replace("WEIGHTS", f" BEHIND SPRING KX={behind}\nWEIGHTS")
    r = run_text(deck)
    assert r.status == "done", r.message
    assert r.check() < 1e-13
    return r, int(next(x["value"] for x in r.tables["run"] if x["item"] == "series"))


@pytest.mark.full
@each_once(
    ("v, shaken", [(-3.0, False), (1.0, True), (0.0, True)]),
    ("behind", [np.inf, 40.0]),  # a spring in series with the law: the node between has no mass
    ("n, beta, most", [(1, 0.8, 200), (2, 0.5, 200), (3, 0.9, 200), (40, 0.5, 250), (1.5, 0.7, 600)]),
)
def test_one_mass_on_bouc_wen(
    n: float, beta: float, most: int, v: float, shaken: bool, behind: float
) -> None:
    """The sides differ; a power that is not whole takes more series where it begins."""
    r, series = ran(f"BOUC_WEN N={n} BETA={beta} R=0.1", v, shaken, behind)
    told = bouc_wen(n, beta, v, shaken, behind)
    assert np.abs(r.u[:, r.nodes.index(2), 0] - told).max() < 1e-11 * np.abs(told).max()
    assert series < most


@pytest.mark.full
@each_once(
    ("v, shaken", [(-3.0, False), (1.0, True), (0.0, True)]),
    ("behind", [np.inf, 40.0]),
    ("n, alpha, most", [(2, 1, 150), (5, 0.5, 150), (200, 1, 300), (1.7, 0.4, 400)]),
)
def test_one_mass_on_ramberg_osgood(
    n: float, alpha: float, most: int, v: float, shaken: bool, behind: float
) -> None:
    """Loops close on the way."""
    r, series = ran(f"RAMBERG_OSGOOD N={n} ALPHA={alpha}", v, shaken, behind)
    told = ramberg_osgood(n, alpha, v, shaken, behind)
    assert np.abs(r.u[:, r.nodes.index(2), 0] - told).max() < 1e-11 * np.abs(told).max()
    assert series < most


TANGENT = "RAYLEIGH ALPHA=0.4 BETA=0.001 STIFFNESS=TANGENT"
BOUC = "BOUC_WEN N=2 R=0.05"


@pytest.mark.parametrize(
    ("rule", "damping", "load"),
    [
        ("RAMBERG_OSGOOD N=5", "RAYLEIGH ALPHA=0.4", "let go"),
        *(
            pytest.param(BOUC, TANGENT, load, marks=pytest.mark.full)
            for load in ("let go", "supports apart")
        ),
        *at_night(*((BOUC, TANGENT, load) for load in LOADS if load not in ("let go", "supports apart"))),
        *at_night(*(("BOUC_WEN N=1.4 R=0.05 BETA=0.7", TANGENT, load) for load in LOADS)),
    ],
)
def test_newmark_converges_to_hinges_without_mass(rule: str, damping: str, load: str) -> None:
    """With the square of its step, over reversals that follow one from another."""
    deck = hinged(damping, load=LOADS[load]).replace("RULE=BILINEAR R=0.05", f"RULE={rule}")
    deck = deck.replace("GAP=0.02", "GAP=9").replace("HISTORY 2", "HISTORY 0.5")
    r = run_text(deck, None, "TAYLOR")
    assert r.status == "done" and r.check() < 1e-11, r.message
    far, near = (np.abs(run_text(deck, None, "NEWMARK", dt).u - r.u).max() for dt in (2e-3, 5e-4))
    assert near < 1e-3 * np.abs(r.u).max() and far > 9.0 * near


def test_a_frame_at_rest_stays_there() -> None:
    """Under its loads, where rounding leaves rates that change their signs."""
    deck = hinged(TANGENT, load="").replace("RULE=BILINEAR R=0.05", "RULE=RAMBERG_OSGOOD N=5")
    r = run_text(deck.replace("HISTORY 2", "HISTORY 0.2"), None, "TAYLOR")
    assert r.status == "done", r.message
    assert next(x["value"] for x in r.tables["run"] if x["item"] == "events") == "0"
    assert np.abs(r.v).max() < 1e-12


@pytest.mark.parametrize("name", SMOOTH)
def test_the_differential_equation_is_that_of_the_curve(name: str) -> None:
    """Its tangent, and what is left of it a little further on, along a path with reversals."""
    law = specimen(catalog().family("hysteresis")[name])[0].law
    state, d, rng = law.start(), 0.0, np.random.default_rng(5)
    for goal in law.p[1] / law.p[0] * rng.uniform(-4.0, 4.0, 40):
        state = drive(law, state, d, 0.5 * (d + goal))
        d = 0.5 * (d + goal)
        at, _, _, m = state
        f, tangent, _ = law.force(state, d)
        w, y, n, a, b, k, q = law.rule.smooth_curve(law.p, at, m, d, f)
        assert w / y >= 0.0
        slope = (1.0 + a * (w / y) ** n) / (1.0 + b * (w / y) ** n)
        assert k + q * slope == pytest.approx(tangent, rel=1e-12)
        ahead = d + 1e-5 * (goal - d)
        after = law.force(state, ahead)[0]
        further = law.rule.smooth_curve(law.p, at, m, ahead, after)[0]
        assert after - f == pytest.approx(k * (ahead - d) + q * (further - w), rel=1e-9)
        state, d = drive(law, state, d, goal), goal


@FAST
@pytest.mark.full
def test_auto_takes_it() -> None:
    deck = hinged("RAYLEIGH ALPHA=0.4").replace("RULE=BILINEAR R=0.05", "RULE=RAMBERG_OSGOOD N=5")
    r = run_text(deck)
    method = next(x["value"] for x in r.tables["run"] if x["item"] == "method")
    assert method.startswith("TAYLOR"), method
