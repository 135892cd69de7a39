"""Chatter that ends in rest, grazing, and contacts at rest: no endless loops, nothing from nothing."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pound_solve.analyses.history import RESIDUAL
from tiers import each_once
from verification.cases import kelvin_voigt_xi, run_text

pytestmark = pytest.mark.full

BALL = """TITLE  Ball dropped on a floor
UNITS  N m s
PARAM  k = 1e5   e = 0.5   drop = 0.5   g = 10   t = 12
GRAVITY g
NODES
   1   0   0   FIX=XR
ELEMENTS
   1   FLOOR   1
PROPS
   FLOOR   CONTACT   GAP=drop  ANGLE=-90  LAW=KELVIN_VOIGT  K=k  E=e
WEIGHTS
   1   g
LOADS
   1   0   -g
OUTPUT
   EVERY=0.1
ANALYSIS
   HISTORY  t  FROM=REST  METHOD=EXACT
"""


@each_once(("k", [1e9, 1e7, 1e5, 1e3]), ("e", [0.8, 0.5, 0.05]))
def test_ball_comes_to_rest(k: float, e: float) -> None:
    """After a finite number of bounces the ball lies in the static overlap m g/k, and the run goes on to
    its end.

    An impact gives back e of its speed only while the weight does not matter, so the time until rest is
    less than that of the ideal bounces, sqrt(2 h/g) (1 + e)/(1 - e), plus the swings in the floor.
    """
    g, drop, t = 10.0, 0.5, 12.0
    r = run_text(BALL, {"k": k, "e": e})
    assert r.status == "done" and r.time[-1] == t
    assert r.u[-1, 0, 1] == pytest.approx(-drop - g / k, abs=1e-9 * drop)
    assert abs(r.v[-1, 0, 1]) < 1e-6
    assert r.force[-1, 0] == pytest.approx(g, rel=1e-4)  # a stiff floor: 1e-16 m is a force too
    c = r.tables["collisions"]
    assert np.isnan(c["t_end"][-1]) and np.isfinite(c["t_end"][:-1]).all()
    assert c["t_start"][0] == pytest.approx(math.sqrt(2 * drop / g), rel=1e-12)
    ideal = math.sqrt(2 * drop / g) * (1 + e) / (1 - e)
    xi, w = kelvin_voigt_xi(e, False), math.sqrt(k)
    assert c["t_start"][-1] < ideal + 20 / w * max(xi, 1 / xi)
    lost = float(r.column("contact_summary", "energy_lost")[0])
    assert lost == pytest.approx(g * (drop + g / k) - 0.5 * g * g / k, rel=1e-8)
    assert r.check() < 1e-9


def test_first_bounces_give_back_what_was_asked() -> None:
    """On a stiff floor e is off by no more than the weight's share of the impulse, g times the duration
    over the speed."""
    c = run_text(BALL, {"k": 1e9, "e": 0.5}).tables["collisions"][:3]
    share = 10.0 * (c["t_end"] - c["t_start"]) / c["approach_velocity"]
    assert np.all(np.abs(c["restitution"] - 0.5) < share)
    assert np.all(share < 2e-3)


def test_elastic_ball_bounces_for_ever() -> None:
    """e = 1: all bounces alike to the last, none lost."""
    c = run_text(BALL, {"k": 1e5, "e": 1, "t": 20}).tables["collisions"]
    cycle = np.diff(c["t_start"])
    assert len(c) == 31
    assert cycle == pytest.approx([cycle[0]] * len(cycle), rel=1e-10)
    assert c["approach_velocity"] == pytest.approx([math.sqrt(10.0)] * len(c), rel=1e-11)


GRAZE = """TITLE  Oscillator that just reaches a wall
UNITS  N m s
PARAM  off = 0   xi = 0   every = 0.05
GRAVITY 1
NODES
   1   0   0   FIX=XYR
   2   1   0   FIX=YR
ELEMENTS
   1   SPRING1   1   2
   2   WALL      2
PROPS
   SPRING1   SPRING    KX=4
   WALL      CONTACT   GAP=0.1+off  LAW=KELVIN_VOIGT  K=400  XI=xi
WEIGHTS
   2   1
INITIAL
   2   UX=-0.1
OUTPUT
   EVERY=every
ANALYSIS
   HISTORY  20
"""


@each_once(
    ("off", [0.0, 1e-17, -1e-17, 1e-15, -1e-15, 1e-13, -1e-13]),
    ("xi", [0.0, 0.3]),
    ("stepped", [("EXACT", None), ("NEWMARK", 0.01)]),
)
def test_grazing(off: float, xi: float, stepped: tuple[str, float | None]) -> None:
    """An amplitude equal to the gap, to rounding: the run ends, and the motion stays the free one."""
    method, dt = stepped
    r = run_text(GRAZE, {"off": off, "xi": xi}, method, dt)
    assert r.status == "done"
    if method == "EXACT":
        # what a graze may change: k c off at most
        assert np.abs(r.u[:, 1, 0] + 0.1 * np.cos(2 * r.time)).max() < 1e-8
    assert len(r.tables["collisions"]) <= 6  # the wall is reached at 2 t = pi (2 i + 1)


def test_shallow_touches_are_found() -> None:
    """1e-9 beyond the wall, 1e-8 of the amplitude, is a touch in each of the six cycles that reach it (t
    = pi/2 + i pi)."""
    c = run_text(GRAZE, {"off": -1e-9}).tables["collisions"]
    assert len(c) == 6
    assert 0.5 * (c["t_start"] + c["t_end"]) == pytest.approx(
        math.pi / 2 + math.pi * np.arange(6), abs=1e-6
    )
    assert c["peak_force"] == pytest.approx([400e-9] * 6, rel=0.02)


REST = """TITLE  Two nodes at rest that touch
UNITS  N m s
PARAM  f = 0   u = 0
GRAVITY 1
NODES
   1   0   0   FIX=YR
   2   1   0   FIX=YR
   3   2   0   FIX=XYR
ELEMENTS
   1   HIT       1   2
   2   SPRING1   2   3
PROPS
   HIT       CONTACT   GAP=0  LAW=KELVIN_VOIGT  K=100  E=0.5
   SPRING1   SPRING    KX=10
WEIGHTS
   1,2   1
LOADS
   2   f
INITIAL
   2   UX=u
OUTPUT
   EVERY=0.1
ANALYSIS
   HISTORY  2  FROM=REST
"""


@pytest.mark.parametrize(("method", "dt"), [("EXACT", None), ("NEWMARK", 0.01), ("CENTRAL", 0.01)])
def test_touching_at_rest_stays_at_rest(method: str, dt: float | None) -> None:
    r = run_text(REST, None, method, dt)
    assert r.status == "done"
    assert len(r.tables["collisions"]) == 0
    assert not r.u.any() and not r.v.any()


@pytest.mark.parametrize(("method", "dt"), [("EXACT", None), ("NEWMARK", 0.01), ("CENTRAL", 0.01)])
def test_touching_nodes_that_part(method: str, dt: float | None) -> None:
    """A load draws the second node away: no contact until it comes back, and it comes back to exactly
    where it was, at rest."""
    r = run_text(REST, {"f": 1}, method, dt)
    assert r.status == "done"
    assert r.u[:, 0, 0] == pytest.approx(np.zeros(len(r.time)), abs=1e-6)


def test_touching_nodes_pressed_together() -> None:
    """A load presses from the start: one closure at once, with no approach velocity."""
    c = run_text(REST, {"f": -1}).tables["collisions"]
    assert len(c) >= 1
    assert c["t_start"][0] == pytest.approx(0.0, abs=1e-12)
    assert c["approach_velocity"][0] == pytest.approx(0.0, abs=1e-12)


PRESSED = """UNITS kN m s
GRAVITY 10
NODES
 1 1 0 FIX=YR
 2 2 0 FIX=YR
 3 3 0 FIX=YR
 90 0 0 FIX=XYR
ELEMENTS
 1 C 1 2
 2 C 2 3
 3 C 3
 4 S 90 1
PROPS
 C CONTACT GAP=0 LAW=LAGRANGE E=0
 S SPRING KX=1E3
WEIGHTS
 1 TO 3 100
EQUAKE
 SINE AMPLITUDE=6 PERIOD=0.3
LOADS
 1 FX=300
ANALYSIS
 STATIC
 HISTORY 0.6 METHOD=TAYLOR
"""


def test_the_energy_of_rounding_is_not_judged() -> None:
    """A load presses three masses against a wall, and the ground does not part them: nothing moves."""
    r = run_text(PRESSED)
    assert np.abs(r.u).max() < 1e-12 and r.status == "done"
    ((verdict, remark),) = (c[["verdict", "remark"]] for c in r.tables["checks"] if c["check"] == RESIDUAL)
    assert verdict == "good" and remark.startswith("nothing moves")
