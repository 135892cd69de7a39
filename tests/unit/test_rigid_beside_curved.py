"""Rigid contacts beside curved laws and friction, by TAYLOR: closed forms, and SciPy between events."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pound_solve.numerics.types import Array
from verification.cases import run_text

BOUC_WEN = """UNITS N m s
GRAVITY 1
NODES
 1 0 0 FIX=YR
ELEMENTS
 1 S 1
 2 C 1
PROPS
 S SPRING KX=100 FX=5 RULE=BOUC_WEN N=2 R=0.1
 C CONTACT GAP=0.05 ANGLE=0 LAW={law}
WEIGHTS
 1 1
INITIAL
 1 VX=1
FORCES
 TABLE 1 {push} POINTS=0,1,9,1
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 0.8 FROM=REST METHOD={method}
"""


def until(rates: Callable[..., Any], y: Array, t: float, end: float, event: Callable[..., float]) -> Any:
    """Integrate up to an event that rises through zero, or the end."""
    event.terminal, event.direction = True, 1.0  # type: ignore[attr-defined]
    return solve_ivp(rates, (t, end), y, "DOP853", None, True, event, rtol=1e-13, atol=1e-15)


def against_a_wall(e: float, push: float, times: Array) -> tuple[Array, Array]:
    """Displacements of the mass, and forces of the wall, where the contact strikes and holds."""

    def force(y: Array) -> float:
        return float(100.0 * (0.1 * y[0] + 0.9 * y[2]))

    def rates(t: float, y: Array) -> list[float]:
        w = y[2] / 0.05
        slope = 1.0 - w * w * (0.5 + 0.5 * np.sign(y[2] * y[1]))
        return [y[1], push - force(y), slope * y[1]]

    y, t, out, wall = np.array([0.0, 1.0, 0.0]), 0.0, np.zeros(len(times)), np.zeros(len(times))
    while t < times[-1]:
        part = until(rates, y, t, times[-1], lambda _, y: y[0] - 0.05)
        own = (times >= t) & (times <= part.t[-1])
        out[own] = part.sol(times[own])[0]
        y, t = part.y[:, -1], float(part.t[-1])
        y[1] *= -e
        if t < times[-1] and y[1] == 0.0 and push - force(y) > 0.0:  # it is held for good
            out[times > t], wall[times > t] = 0.05, push - force(y)
            break
    return out, wall


@pytest.mark.full
@pytest.mark.parametrize("method", ["TAYLOR", "AUTO"])
@pytest.mark.parametrize(
    ("law", "e", "push"),
    [("STEREOMECHANICS E=0.5", 0.5, 0.0), ("LAGRANGE", 0.0, 0.0), ("LAGRANGE", 0.0, 9.0)],
)
def test_a_smooth_spring_throws_a_mass_against_a_wall(law: str, e: float, push: float, method: str) -> None:
    r = run_text(BOUC_WEN.format(law=law, push=push, method=method))
    assert r.status == "done", r.message
    u, wall = against_a_wall(e, push, r.time)
    assert r.u[:, 0, 0] == pytest.approx(u, abs=1e-11)
    assert r.force[:, 0] == pytest.approx(wall, abs=1e-9)
    assert len(r.tables["collisions"]) > 0 and r.check() < 1e-12


def test_a_ball_strikes_a_body_that_lies_at_a_wall() -> None:
    """The wall's force is that of the load and of Hertz's contact, whose largest is known."""
    m, v, k, load = 2.0, 0.7, 4e4, 30.0
    r = run_text(f"""UNITS N m s
GRAVITY 1
NODES
 1 0 0 FIX=YR
 2 1 0 FIX=YR
ELEMENTS
 1 HIT 1 2
 2 WALL 2
PROPS
 HIT CONTACT GAP=0.01 LAW=HERTZ K={k!r}
 WALL CONTACT GAP=0 ANGLE=0 LAW=LAGRANGE
WEIGHTS
 1 {m!r}
 2 5
LOADS
 2 {load!r} 0
INITIAL
 1 VX={v!r}
OUTPUT
 EVERY=0.002
ANALYSIS
 HISTORY 0.1 METHOD=TAYLOR
""")
    assert r.status == "done", r.message
    assert r.force[:, 1] == pytest.approx(load + r.force[:, 0], rel=1e-12)
    largest = k**0.4 * (1.25 * m * v * v) ** 0.6
    assert r.column("contact_summary", "peak_force") == pytest.approx([largest, load + largest], rel=1e-12)
    assert r.v[-1, :, 0] == pytest.approx([-v, 0.0], abs=1e-12)


def test_a_block_that_slides_on_the_floor_rebounds_from_a_wall() -> None:
    """Stick on a spring, slip, impact, stick and slip the other way, and rest: each part in closed form."""
    m, g, mu, kt, e, v0, gap = 2.0, 10.0, 0.3, 5000.0, 0.6, 1.0, 0.1
    limit, w = mu * m * g, np.sqrt(kt / m)
    r = run_text(f"""UNITS N m s
GRAVITY {g!r}
NODES
 1 0 0 FIX=R
ELEMENTS
 1 FLOOR 1
 2 WALL 1
PROPS
 FLOOR CONTACT GAP=0 ANGLE=-90 LAW=LINEAR K=1E5 MU={mu!r} KT={kt!r}
 WALL CONTACT GAP={gap!r} ANGLE=0 LAW=STEREOMECHANICS E={e!r}
WEIGHTS
 1 {m * g!r}
LOADS
 1 0 {-m * g!r}
INITIAL
 1 VX={v0!r}
OUTPUT
 EVERY=0.002
ANALYSIS
 HISTORY 0.15 METHOD=TAYLOR
""")
    assert r.status == "done", r.message
    out, t = np.zeros(len(r.time)), r.time
    t1 = np.arcsin(limit / kt * w / v0) / w  # it sticks
    out[t <= t1] = v0 / w * np.sin(w * t[t <= t1])
    u, v, a = limit / kt, v0 * np.cos(w * t1), mu * g
    t2 = t1 + (v - np.sqrt(v * v - 2.0 * a * (gap - u))) / a  # it slips up to the wall
    own = (t > t1) & (t <= t2)
    out[own] = u + v * (t[own] - t1) - 0.5 * a * (t[own] - t1) ** 2
    v = -e * (v - a * (t2 - t1))
    far = gap - limit / kt  # the spring unloads, to the limit on the other side
    size, lag = np.hypot(limit / kt, v / w), np.arctan2(-v / w, limit / kt)
    t3 = t2 + (np.arccos(-limit / kt / size) - lag) / w
    own = (t > t2) & (t <= t3)
    out[own] = far + size * np.cos(w * (t[own] - t2) + lag)
    v, u = -size * w * np.sin(w * (t3 - t2) + lag), far - limit / kt
    own = t > t3
    assert v + a * (t[-1] - t3) < 0.0  # it slips to the end
    out[own] = u + v * (t[own] - t3) + 0.5 * a * (t[own] - t3) ** 2
    assert r.u[:, 0, 0] == pytest.approx(out, abs=1e-13)
    assert r.check() < 1e-12


def test_friction_across_a_rigid_contact_is_refused_in_words() -> None:
    text = BOUC_WEN.format(law="LAGRANGE MU=0.3 KT=100", push=0.0, method="AUTO")
    for method in ("TAYLOR", "EXACT", "AUTO"):
        r = run_text(text.replace("FX=5 RULE=BOUC_WEN N=2 R=0.1", ""), method=method)
        assert r.status == "stopped" and "rubs where a rigid contact presses" in r.message, r.message
