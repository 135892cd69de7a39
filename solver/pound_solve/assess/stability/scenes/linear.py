"""Linear stress scenes, whose motion is known in closed form."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any, Final

import numpy as np

from pound_solve.assess.stability.scenes.case import (
    JUMP,
    OMEGA,
    SPIKE,
    STOREY,
    ZEROS,
    StabilityCase,
    damped,
)
from pound_solve.numerics.types import Array

ONE: Final = """UNITS kN m s
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 0 1 FIX=YR
ELEMENTS
 1 SPR 1 2
PROPS
 SPR SPRING KX={k!r}
WEIGHTS
 2 {mass!r}
{more}ANALYSIS
 HISTORY {end!r} METHOD=@METHOD
OUTPUT
 EVERY={every!r} NODES=2
"""


def one(
    more: str, end: float = 3.0, every: float = 0.0437123456789, k: float = STOREY, mass: float = 1.0
) -> str:
    """Deck of one storey."""
    return ONE.format(more=more, end=end, every=every, k=k, mass=mass)


def swing(xi: float, omega: float = OMEGA) -> Callable[[Array], Array]:
    """Closed form of the free vibration after a unit velocity with a damping ratio `xi` [-]."""

    def motion(t: Array) -> Array:
        decay, w = xi * omega, omega * math.sqrt(abs(1.0 - xi * xi))
        if xi < 1.0:
            return np.asarray(np.exp(-decay * t) * np.sin(w * t) / w)[:, None]
        if xi == 1.0:
            return np.asarray(np.exp(-decay * t) * t)[:, None]
        slow = -omega * omega / (decay + w)
        return np.asarray(np.exp(slow * t) * -np.expm1(-2 * w * t) / (2 * w))[:, None]

    return motion


KICK: Final = "INITIAL\n 2 VX=1\n"
TWO: Final = """GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 0 1 FIX=YR
 3 0 2 FIX=YR
ELEMENTS
 1 LOW 1 2
 2 HIGH 2 3
PROPS
 LOW SPRING KX={low!r}
 HIGH SPRING KX={high!r}
WEIGHTS
 2 {middle!r}
 3 {top!r}
INITIAL
 3 VX=1
ANALYSIS
 HISTORY {end!r} METHOD=@METHOD
OUTPUT
 EVERY={every!r} NODES=3
"""
LEANING: Final = """GEOMETRY {form}
NODES
 1 0 0 FIX=XYR
 2 0 1
ELEMENTS
 1 POST 1 2
PROPS
 POST FRAME E=1E6 A=1 I=1E-4
WEIGHTS
 2 9.81 9.81 0.001
LOADS
 2 FY={push!r} FX=0.001
ANALYSIS
 STATIC
 HISTORY 0.5 METHOD=@METHOD
OUTPUT
 NODES=2
"""


def linear_scenes() -> Iterator[StabilityCase]:
    """Yield all linear scenes."""
    yield from _one_storey()
    yield from _several_masses()
    yield from _motions()
    yield from _axial_loads()


def _case(scene: str, variant: str, deck: str, **given: Any) -> StabilityCase:
    return StabilityCase("linear", scene, variant, "", deck, **given)


def _one_storey() -> Iterator[StabilityCase]:
    """One storey: damping, steps, stiffness, units."""
    for xi in (0.0, 0.05, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 10.0, 1e3, 1e6):
        deck = one(damped(xi) + KICK)
        ratio = f"{xi:.9g}"
        yield _case("damping over critical", ratio, deck, right=swing(xi), heavy=xi > 1e5)
    for step in (1e-9, 1e-6, 1e-4, 0.01, 0.2, 1.0):
        end = 500 * step if step < 1e-5 else max(3.0, 3 * step)
        within = min(2.0 * (OMEGA * step) ** 2 * OMEGA * end / 12 + 1e-9, 0.05)
        deck = one(KICK, end=end, every=max(end / 20.3, min(step, 0.937)))
        yield _case("steps", f"{step:g}", deck, step=step, within=within, right=swing(0.0))
    for k in (1e-6, 1e6, 1e12):
        w = OMEGA * math.sqrt(k)
        deck = one(KICK, k=STOREY * k, end=3 / math.sqrt(k), every=0.0437 / math.sqrt(k))
        yield _case("stiffness", f"{k:g}", deck, step=1e-3 / math.sqrt(k), right=swing(0.0, w))
        deck = one(KICK, k=STOREY * k, end=3.0)
        yield _case(
            "stiffness, step of the plain storey", f"{k:g}", deck, right=swing(0.0, w), heavy=k > 1e9
        )
    for length, scale in (("mm", 1e3), ("km", 1e-3)):
        deck = one(KICK.replace("1", repr(scale)), k=STOREY / scale).replace("kN m s", f"kN {length} s")
        deck = deck.replace("GRAVITY 1", f"GRAVITY {scale!r}")
        yield _case("units", length, deck, right=lambda t, x=scale: x * swing(0.0)(t))


def _several_masses() -> Iterator[StabilityCase]:
    """Two masses: unequal, massless, free, with repeated eigenvalues."""
    for ratio in (1e-8, 1e-4, 1e4, 1e8):
        deck = TWO.format(low=STOREY, high=STOREY, middle=ratio, top=1.0, end=1.0, every=0.05)
        yield _case("one mass over the other", f"{ratio:g}", deck)
    for ratio in (1e-8, 1.0, 1e6, 1e12):
        deck = TWO.format(low=STOREY * ratio, high=STOREY, middle=0.0, top=1.0, end=1.0, every=0.05)
        w = OMEGA * math.sqrt(ratio / (1.0 + ratio))
        yield _case("massless node", f"stiffness {ratio:g}", deck, right=swing(0.0, w))
    free = TWO.format(low=STOREY, high=STOREY, middle=1.0, top=1.0, end=3.0, every=0.1)
    free = free.replace(" 1 LOW 1 2\n", "").replace(" 3 VX", " 2,3 VX")
    yield _case("rigid-body modes", "moving on", free, right=lambda t: t[:, None])
    pushed = free.replace("ANALYSIS", "LOADS\n 2,3 FX=2\nANALYSIS").replace("METHOD=", "FROM=REST METHOD=")
    yield _case("rigid-body modes", "pushed", pushed, right=lambda t: (t + t * t)[:, None])
    for xi in (0.0, 1.0):
        deck = one(damped(xi) + "INITIAL\n 2,3 VX=1\n").replace(
            "ELEMENTS", " 3 1 1 FIX=YR\nELEMENTS\n 2 SPR 1 3"
        )
        deck = deck.replace(" 2 1.0\n", " 2,3 1.0\n").replace("NODES=2\n", "NODES=2,3\n")
        yield _case(
            "repeated eigenvalues", "defective" if xi else "undamped", deck,
            right=lambda t, s=xi: np.tile(swing(s)(t), 2),
        )  # fmt: skip


def _motions() -> Iterator[StabilityCase]:
    """Resonance and extreme records."""
    sine = f"EQUAKE\n SINE AMPLITUDE=1 OMEGA={OMEGA!r} DURATION=1000\n"
    yield _case(
        "resonance", "50 periods", one(sine, end=50.0, every=0.125), within=5e-3,
        right=lambda t: (-(np.sin(OMEGA * t) - OMEGA * t * np.cos(OMEGA * t)) / (2 * STOREY))[:, None],
    )  # fmt: skip
    yield _case("records", "zeros", one(ZEROS), right=lambda t: 0.0 * t[:, None])
    area = 1.0  # of the spike
    yield _case(
        "records", "a spike", one(SPIKE, every=0.1), within=0.03,
        right=lambda t: -area * np.where(t > 0.01, np.sin(OMEGA * (t - 0.010001)) / OMEGA, 0.0)[:, None],
    )  # fmt: skip
    yield _case(
        "records", "a step", one(JUMP, every=0.1, end=2.5), within=1e-3,
        right=lambda t: np.where(t > 0.1, -5 * (1 - np.cos(OMEGA * (t - 0.1))) / STOREY, 0.0)[:, None],
    )  # fmt: skip
    point = 'EQUAKE\n RECORD FILE="point.txt" FORMAT=COLUMNS DT=0.01 UNIT=DECK\n'
    yield _case("records", "one point", one(point), files={"point.txt": "1.0\n"})
    n = 1_000_000
    long = 'EQUAKE\n RECORD FILE="long.txt" FORMAT=COLUMNS DT=0.00001 UNIT=DECK\n'
    text = "\n".join(f"{math.sin(3 * OMEGA * i * 1e-5):.17g}" for i in range(n + 1))
    r = 3 * OMEGA
    yield _case(
        "records", "a million points", one(long, end=10.0, every=0.437),
        heavy=True, files={"long.txt": text},
        right=lambda t: (-(np.sin(r * t) - 3 * np.sin(OMEGA * t)) / (STOREY - r * r))[:, None],
    )  # fmt: skip


def _axial_loads() -> Iterator[StabilityCase]:
    """Columns below and beyond Euler's load."""
    for form in ("PDELTA", "PDELTA_MEMBER", "PDELTA_VARYING", "LARGE"):
        for load_ratio in (0.999, 1.001, 50.0):
            euler = math.pi**2 / 4 * 100
            yield _case(
                "axial load over Euler's",
                f"{form} {load_ratio:g}",
                LEANING.format(form=form, push=-load_ratio * euler),
            )
