"""TAYLOR with fluid dampers: closed forms, an ODE solver's answers, and NEWMARK that converges to it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pound_solve.catalog import catalog
from pound_solve.laws.automaton import consistent
from pound_solve.numerics.types import Array
from tiers import at_night, each_once
from unit.test_damper_contract import law_of
from verification.cases import Ran, run_text

DECK = """UNITS kN m s
GRAVITY 10
NODES
 1 0 0 FIX=YR
{nodes}
ELEMENTS
 1 BACK 1
{elements}
PROPS
 BACK SPRING KX={k}
{props}
WEIGHTS
 1 10 0
{load}
ANALYSIS
 HISTORY {end} FROM=REST METHOD=TAYLOR
OUTPUT
 EVERY=0.05
"""
K, C, LINK, AMPLITUDE, OMEGA = 40.0, 2.0, 60.0, 6.0, 5.0
SINE = f"FORCES\n SINE 1 FX={AMPLITUDE} OMEGA={OMEGA}"
LOADS = {"thrown": "INITIAL\n 1 VX=1", "shaken": f"INITIAL\n 1 VX=1\n{SINE}"}
#: instant from which the reference goes on after an event, behind it by this much
BEHIND = 1e-10

Case = tuple[float, float, float]  #: exponent, limit of the force, end of the play


Event = Callable[[float, Array], Any]
Rates = Callable[[float, Array], list[float]]


def pushed(t: float, shaken: bool) -> float:
    return AMPLITUDE * math.sin(OMEGA * t) if shaken else 0.0


def rising(function: Event) -> Event:
    """An event function whose rise ends a stretch."""
    function.terminal, function.direction = True, 1.0  # type: ignore[attr-defined]
    return function


def histories(
    rates: Rates,
    corners: Callable[[Array], list[Event]],
    after: Callable[[int, Array], None],
    y: Array,
    end: float,
) -> Array:
    """Displacements of the mass every 0.05, by DOP853 from one of the `corners` to the next."""
    times, t = np.linspace(0.0, end, round(end / 0.05) + 1), 0.0
    out = np.zeros(len(times))
    while True:
        y = y + BEHIND * np.array(rates(t, y))
        options = {"rtol": 1e-12, "atol": 1e-15, "max_step": 0.02}
        s = solve_ivp(
            rates, (t + BEHIND, end), y, "DOP853", dense_output=True, events=corners(y), **options
        )
        seen = (times >= t) & (times <= s.t[-1] + 1e-12)
        if seen.any():
            out[seen] = s.sol(times[seen])[0]
        if s.status == 0:
            return out
        which = next(i for i, x in enumerate(s.t_events) if len(x))
        t, y = float(s.t_events[which][0]), s.y_events[which][0].copy()
        after(which, y)


def deck(items: str, load: str, link: float, end: float) -> str:
    """A mass of 1 with a spring and a damper, which a spring may hold."""
    if link == np.inf:
        parts = {"nodes": "", "elements": " 2 DAMP 1", "props": f" DAMP DASHPOT CX={C} {items}"}
    else:
        parts = {
            "nodes": " 2 1 0 FIX=YR",
            "elements": " 2 LINK 1 2\n 3 DAMP 2",
            "props": f" LINK SPRING KX={link}\n DAMP DASHPOT CX={C} {items}",
        }
    return DECK.format(k=K, end=end, load=LOADS[load], **parts)


def told(alpha: float, limit: float, play: float, shaken: bool, end: float) -> Array:
    """Displacements of the mass on a damper, by DOP853 between the corners of the law."""
    side, inside, fast = 1.0, play > 0.0, (limit / C) ** (1.0 / alpha)
    limited = fast < 1.0

    def rates(t: float, y: Array) -> list[float]:
        """One smooth law until the next corner, so that the step across a corner is exact below it."""
        force = 0.0 if inside else side * (limit if limited else C * max(side * y[1], 0.0) ** alpha)
        return [y[1], pushed(t, shaken) - K * y[0] - force]

    def corners(y: Array) -> list[Event]:
        return [
            rising(lambda t, y: -side * y[1]),
            rising(lambda t, y: (abs(y[0]) - play) * (1 if inside else -1) if play else -1.0),
            rising(lambda t, y: (side * y[1] - fast) * (-1 if limited else 1)),
        ]

    def after(which: int, y: Array) -> None:
        nonlocal side, inside, limited
        if which == 0:
            side = -side
        elif which == 1:
            inside, side = not inside, math.copysign(1.0, y[1])
        else:
            limited = not limited

    return histories(rates, corners, after, np.array([0.0, 1.0]), end)


def told_behind(alpha: float, limit: float, shaken: bool, end: float) -> Array:
    """The same with a spring between them: the third unknown is the displacement of the damper."""
    fast, held = (limit / C) ** (1.0 / alpha), False

    def free(y: Array) -> float:
        """Rate of a damper below its limit."""
        force = LINK * (y[0] - y[2])
        return math.copysign((abs(force) / C) ** (1.0 / alpha), force)

    def rates(t: float, y: Array) -> list[float]:
        return [y[1], pushed(t, shaken) - K * y[0] - LINK * (y[0] - y[2]), y[1] if held else free(y)]

    def corners(y: Array) -> list[Event]:
        side = math.copysign(1.0, y[0] - y[2])
        full = (lambda t, y: fast - side * y[1]) if held else (lambda t, y: side * free(y) - fast)
        return [rising(lambda t, y: -side * (y[0] - y[2])), rising(full)]

    def after(which: int, y: Array) -> None:
        nonlocal held
        held = which == 1 and not held

    return histories(rates, corners, after, np.array([0.0, 1.0, 0.0]), end)


def run_taylor(text: str) -> Ran:
    r = run_text(text)
    assert r.status == "done", r.message
    return r


@pytest.mark.full
@each_once(
    ("alpha", [0.3, 0.5, 1.5, 2.0]),
    ("load", ["thrown", "shaken"]),
    ("link", [np.inf, LINK]),
    ("limit", [np.inf, 1.2]),
)
def test_one_mass(alpha: float, load: str, link: float, limit: float) -> None:
    """On a damper with and without a relief valve, or on one behind a spring: a node without mass."""
    items = f"ALPHA={alpha}" + (f" FX={limit}" if limit < np.inf else "")
    r = run_taylor(deck(items, load, link, 2.0))
    shaken = load == "shaken"
    if link == np.inf:
        expected = told(alpha, limit, 0.0, shaken, 2.0)
    else:
        expected = told_behind(alpha, limit, shaken, 2.0)
    assert np.abs(r.u[:, 0, 0] - expected).max() < 1e-10 * np.abs(expected).max()
    assert r.check() < 1e-11


@pytest.mark.full
@pytest.mark.parametrize("alpha", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("limit", [np.inf, 1.2])
def test_a_play(alpha: float, limit: float) -> None:
    items = f"ALPHA={alpha} GAPX=0.06" + (f" FX={limit}" if limit < np.inf else "")
    r = run_taylor(deck(items, "shaken", np.inf, 2.0))
    expected = told(alpha, limit, 0.06, True, 2.0)
    assert np.abs(r.u[:, 0, 0] - expected).max() < 1e-10 * np.abs(expected).max()
    assert r.check() < 1e-11


def told_with_play_behind(alpha: float, play: float, shaken: bool, end: float) -> Array:
    """The same with a play and a spring between them, which slackens at once where the play begins."""
    inside = True

    def rates(t: float, y: Array) -> list[float]:
        if inside:
            return [y[1], pushed(t, shaken) - K * y[0], y[1]]
        force = LINK * (y[0] - y[2])
        return [
            y[1],
            pushed(t, shaken) - K * y[0] - force,
            math.copysign((abs(force) / C) ** (1.0 / alpha), force),
        ]

    def corners(y: Array) -> list[Event]:
        if inside:
            return [rising(lambda t, y: abs(y[2]) - play)]
        side = math.copysign(1.0, y[0] - y[2])
        return [rising(lambda t, y: play - abs(y[2])), rising(lambda t, y: -side * (y[0] - y[2]))]

    def after(which: int, y: Array) -> None:
        nonlocal inside
        if which == 0:
            inside = not inside
            y[2] = y[0] if inside else y[2]

    return histories(rates, corners, after, np.array([0.0, 1.0, 0.0]), end)


@each_once(("alpha", [0.5, 1.0, 2.0]), ("load", ["thrown", "shaken"]))
def test_a_play_at_a_node_without_mass(alpha: float, load: str) -> None:
    """The force of the spring is lost in no time where the damper comes back into its play."""
    r = run_taylor(deck(f"ALPHA={alpha} GAPX=0.06", load, LINK, 2.0))
    expected = told_with_play_behind(alpha, 0.06, load == "shaken", 2.0)
    assert np.abs(r.u[:, 0, 0] - expected).max() < 1e-10 * np.abs(expected).max()
    assert r.check() < 1e-11


@pytest.mark.parametrize("alpha", [0.5, 2.0])
def test_a_mass_that_is_braked(alpha: float) -> None:
    """m v' = -C v^alpha from 1, for 0.5 to a standstill."""
    r = run_taylor(deck(f"ALPHA={alpha}", "thrown", np.inf, 1.2).replace(" 1 BACK 1\n", ""))
    t = np.arange(25) * 0.05
    v = np.maximum(1.0 - (1.0 - alpha) * C * t, 0.0) ** (1.0 / (1.0 - alpha))
    assert r.v[:, 0, 0] == pytest.approx(v, abs=1e-10)
    (row,) = r.tables["spring_envelope"]
    assert row["force_max"] == pytest.approx(C, rel=1e-13)
    assert row["plastic_work"] == pytest.approx(0.5 - 0.5 * v[-1] ** 2, rel=1e-12)


def bounced(alpha: float, e: float, behind: bool, end: float) -> Array:
    """Displacements of the mass, thrown against a rigid wall at 0.05; its damper may be behind a spring."""
    side = 1.0

    def rates(t: float, y: Array) -> list[float]:
        if not behind:
            return [y[1], -K * y[0] - side * C * max(side * y[1], 0.0) ** alpha]
        force = LINK * (y[0] - y[2])
        return [y[1], -K * y[0] - force, math.copysign((abs(force) / C) ** (1.0 / alpha), force)]

    def corners(y: Array) -> list[Event]:
        turn = (lambda t, y: -side * (y[0] - y[2])) if behind else (lambda t, y: -side * y[1])
        return [rising(turn), rising(lambda t, y: y[0] - 0.05)]

    def after(which: int, y: Array) -> None:
        nonlocal side
        y[1] *= -e if which else 1.0
        side = -side if which == 0 or not behind else side

    return histories(
        rates, corners, after, np.array([0.0, 1.0, 0.0]) if behind else np.array([0.0, 1.0]), end
    )


@each_once(("alpha", [0.5, 1.5]), ("law", ["STEREOMECHANICS E=0.6", "LAGRANGE"]), ("link", [np.inf, LINK]))
def test_beside_a_rigid_wall(alpha: float, law: str, link: float) -> None:
    text = deck(f"ALPHA={alpha}", "thrown", link, 1.0).replace("PROPS\n", " 9 WALL 1\nPROPS\n")
    text = text.replace("PROPS\n", f"PROPS\n WALL CONTACT GAP=0.05 ANGLE=0 LAW={law}\n")
    r = run_taylor(text)
    expected = bounced(alpha, 0.6 if "E=" in law else 0.0, link < np.inf, 1.0)
    assert np.abs(r.u[:, 0, 0] - expected).max() < 1e-10 * np.abs(expected).max()
    assert r.check() < 1e-11 and len(r.tables["collisions"]) > 0


FRAME = """UNITS kN m s
GRAVITY 9.81
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
 3 0 6 FIX=YR
 4 0 0.5 FIX=YR
 5 0 3.5 FIX=YR
ELEMENTS
 1 STOREY 1 2
 2 STOREY 2 3
 3 BRACE 4 2
 4 BRACE 5 3
 5 DAMP 1 4
 6 DAMP 2 5
PROPS
 STOREY SPRING KX=40000 FX=500 RULE=BILINEAR R=0.05
 BRACE SPRING KX=30000
 DAMP DASHPOT CX=300 ALPHA={alpha} {items}
WEIGHTS
 2 1000
 3 1000
DAMPING
 RAYLEIGH XI=0.02 OMEGA=10,30
EQUAKE
 TABLE POINTS=0,0.4,0.3,3,0.6,-4,0.9,3,1.2,-3,1.5,2
OUTPUT
 EVERY=0.05
ANALYSIS
 HISTORY 1.5 FROM=REST
"""


@pytest.mark.full
@pytest.mark.parametrize(
    ("alpha", "items"),
    [(0.5, ""), (0.3, "FX=40"), *at_night((0.3, ""), *((a, x) for a in (0.7, 1.5) for x in ("", "FX=40")))],
)
def test_newmark_converges_to_braced_frames(alpha: float, items: str) -> None:
    """Dampers in a row behind braces, beside storeys that yield."""
    text = FRAME.format(alpha=alpha, items=items)
    r = run_text(text, None, "TAYLOR")
    assert r.status == "done" and r.check() < 1e-11, r.message
    far, near = (np.abs(run_text(text, None, "NEWMARK", dt).u - r.u).max() for dt in (2e-3, 5e-4))
    assert near < 1e-3 * np.abs(r.u).max() and far > 6.0 * near


@pytest.mark.full
def test_newmark_converges_to_braced_frames_with_play() -> None:
    """With the first order at least: the braces lose their forces at once."""
    text = FRAME.format(alpha=1.5, items="GAPX=0.001")
    r = run_text(text, None, "TAYLOR")
    assert r.status == "done" and r.check() < 1e-11, r.message
    far, near = (np.abs(run_text(text, None, "NEWMARK", dt).u - r.u).max() for dt in (2e-3, 2.5e-4))
    assert near < 1e-4 * np.abs(r.u).max() and far > 8.0 * near


def test_supports_that_move_apart() -> None:
    """What they put in through a damper that ends at one of them."""
    text = deck("ALPHA=0.5 FX=1.2", "thrown", np.inf, 1.0).replace(" 2 DAMP 1", " 2 DAMP 2 1")
    text = text.replace(" 1 BACK 1\n", " 1 BACK 3 1\n").replace(
        " 1 0 0 FIX=YR\n", " 1 0 0 FIX=YR\n 2 1 0 FIX=XYR\n 3 2 0 FIX=XYR\n"
    )
    text = text.replace(
        "INITIAL",
        "EQUAKE\n SINE AMPLITUDE=4 PERIOD=0.5 SUPPORTS=2\n SINE AMPLITUDE=3 PERIOD=0.7 SUPPORTS=3\nINITIAL",
    )
    assert run_taylor(text).check() < 1e-11


@pytest.mark.parametrize("name", list(catalog().family("damper")))
def test_powers_are_the_curve(name: str) -> None:
    """On all branches on which a damper with a curve moves, at random rates."""
    law = law_of(catalog().family("damper")[name])
    powers = law.rule.power_law
    if powers is None:
        pytest.skip("linear on each branch")
    for v in np.random.default_rng(3).normal(size=20) * 10.0 ** np.arange(-10, 10):
        state = consistent(law, law.start(), 0.0, float(v))
        k, n, *_ = powers(law.p, state[0], state[3])
        assert k * abs(v) ** n == pytest.approx(law.force(state, 0.0, float(v))[0], rel=1e-13)
