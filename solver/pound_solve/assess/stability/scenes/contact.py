"""Stress scenes with one contact law."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Any, Final

import numpy as np

from pound_deck.schema import Spec
from pound_solve.assess.stability.scenes.case import (
    JUMP,
    OMEGA,
    SPIKE,
    STEP,
    STOREY,
    ZEROS,
    StabilityCase,
    damped,
    items,
)
from pound_solve.numerics.types import Array


def contact(spec: Spec, k: float, mass: float = 1.0, bodies: int = 2, **given: float) -> str:
    """A contact law with the items given, as stiff as a spring `k` for a unit `mass` at unit speed.

    Its overlap there is the unit of length of the sample items.  EQUIVALENT has its stiffness from its
    diaphragms: two alike collide without loss, as long as a spring of pi^2/8 of theirs does.
    """
    overlap = math.sqrt(mass / k)
    law = items(spec, overlap, k * overlap, **given)
    if spec.name == "EQUIVALENT":
        law += " DIAPHRAGMS=" + ",".join([repr(8.0 / math.pi**2 * k)] * bodies)
    return law


PAIR: Final = """UNITS kN {length} s
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 0 1 FIX=YR
 3 1 0 FIX=XYR
 4 1 1 FIX=YR
ELEMENTS
 1 LEFT 1 2
 2 RIGHT 3 4
 3 MEET 2 4
PROPS
 LEFT SPRING KX={k1!r}
 RIGHT SPRING KX={k2!r}
 MEET CONTACT GAP={gap!r} ANGLE=0 LAW={law}
WEIGHTS
 2 1
 4 {mass!r}
{damping}INITIAL
 2 VX={speed!r}
{motion}ANALYSIS
 HISTORY {end!r} METHOD=@METHOD
OUTPUT
 EVERY={every!r} NODES=2,4
"""


def pair(law: str, **given: object) -> str:
    """Deck of two storeys of which the left one collides with the right one."""
    plain: dict[str, object] = {
        "length": "m", "k1": STOREY, "k2": STOREY, "gap": 0.05, "mass": 1.0, "damping": "", "speed": 1.0,
        "motion": "", "end": 0.6, "every": 0.02,
    }  # fmt: skip
    return PAIR.format(law=law, **{**plain, **given})


TWICE: Final = """GRAVITY 1
NODES
 1 0 0 FIX=YR
 2 1 0 FIX=YR
 3 2 0 FIX=YR
ELEMENTS
 1 MEET 1 2
 2 MEET 2 3
PROPS
 MEET CONTACT GAP=0.05 ANGLE=0 LAW={law}
WEIGHTS
 1,2,3 1
INITIAL
 1 VX=1
 3 VX=-1
ANALYSIS
 HISTORY 0.3 METHOD=@METHOD
OUTPUT
 EVERY=0.01
"""
BALL: Final = """GRAVITY 1
NODES
 1 0 0 FIX=YR
ELEMENTS
 1 FLOOR 1
PROPS
 FLOOR CONTACT GAP={gap} ANGLE=0 LAW={law}
WEIGHTS
 1 1
LOADS
 1 FX=9.81
ANALYSIS
 HISTORY {end} METHOD=@METHOD FROM=REST
OUTPUT
 EVERY=0.01
"""
FREE: Final = """GRAVITY 1
NODES
 1 0 0 FIX=YR
 2 1 0 FIX=YR
ELEMENTS
 1 MEET 1 2
PROPS
 MEET CONTACT GAP=0.05 ANGLE=0 LAW={law}
WEIGHTS
 1,2 1
INITIAL
 1 VX=1
ANALYSIS
 HISTORY 1 METHOD=@METHOD
OUTPUT
 EVERY=0.1
"""
OBLIQUE: Final = """GRAVITY 1
NODES
 1 0 0 FIX=R
ELEMENTS
 1 FLOOR 1
PROPS
 FLOOR CONTACT GAP=0.05 ANGLE=90 LAW={law} MU=0.2 KT=1E6
WEIGHTS
 1 1
INITIAL
 1 VX=1 VY=1
ANALYSIS
 HISTORY 0.5 METHOD=@METHOD
OUTPUT
 EVERY=0.02
"""
CROWD: Final = """GRAVITY 1
NODES
 1 TO {n} 0 TO {n}-1 0 FIX=YR
ELEMENTS
 1 TO {n} STOREY 1 TO {n}
 {n}+1 TO 2*{n} WALL 1 TO {n}
PROPS
 STOREY SPRING KX={k!r}
 WALL CONTACT GAP=0.05 ANGLE=0 LAW={law}
WEIGHTS
 1 TO {n} 1
INITIAL
 1 TO {n} VX=1
ANALYSIS
 HISTORY {end} METHOD=@METHOD
OUTPUT
 EVERY={end} NODES=1,{n}
"""
OWN_LOSS: Final = ("TABLE", "BILINEAR_IMPACT")  #: laws whose loss depends on the depth of the impact


def last_speed(t: Array, u: Array) -> Array:
    """Mean velocities between the last two samples, shape (n_nodes,)."""
    return np.asarray((u[-1] - u[-2]) / (t[-1] - t[-2]))


def contact_scenes(spec: Spec) -> Iterator[StabilityCase]:
    """Yield all scenes with one contact law."""
    scenes = _Contacts(spec)
    yield from scenes.stiffness()
    yield from scenes.masses_and_gaps()
    yield from scenes.restitution()
    yield from scenes.damping_and_symmetry()
    yield from scenes.grazing()
    yield from scenes.friction()
    yield from scenes.bouncing()
    yield from scenes.crowds()
    yield from scenes.steps()
    yield from scenes.units_and_records()


class _Contacts:
    """The scenes of one contact law."""

    def __init__(self, spec: Spec) -> None:
        self.spec, self.plain = spec, contact(spec, 1e3 * STOREY)

    def law(self, ratio: float = 1e3, bodies: int = 2, **given: float) -> str:
        """Text of the law with a stiffness of `ratio` times that of the storey."""
        return contact(self.spec, ratio * STOREY, 1.0, bodies, **given)

    def case(self, scene: str, variant: str, deck: str, **given: Any) -> StabilityCase:
        """Make a case of this law."""
        return StabilityCase("contact", scene, variant, self.spec.name, deck, **given)

    def stiffness(self) -> Iterator[StabilityCase]:
        """Contacts from soft to rigid."""
        for ratio in (1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9, 1e12):
            yield self.case("contact stiffness over the storey's", f"{ratio:g}", pair(self.law(ratio)))
            span = 8.0 / math.sqrt(max(ratio, 1.0) * STOREY)  # of the impact, which the step resolves
            deck = pair(self.law(ratio), gap=0.1 * span, end=span, every=span / 20)
            yield self.case("the same, steps that resolve the impact", f"{ratio:g}", deck, step=span / 800)

    def masses_and_gaps(self) -> Iterator[StabilityCase]:
        """Unequal masses, massless nodes, gaps of zero."""
        for mass in (1e-8, 1e-4, 1e4, 1e8):
            deck = pair(self.plain, mass=mass, k2=STOREY * mass)
            yield self.case("one mass over the other", f"{mass:g}", deck)
        yield self.case("massless node that is met", "no weight", pair(self.plain, mass=0.0))
        yield self.case("massless node that is met", "MASSES", pair(self.plain + " MASSES=1,1", mass=0.0))
        for gap in (0.0, 1e-12, -0.002):
            yield self.case("gap", f"{gap:g}", pair(self.plain, gap=gap))

    def restitution(self) -> Iterator[StabilityCase]:
        """Speeds after a free impact, and dashpots of any strength."""
        for e in (1.0, 0.5, 0.05) if self.spec.field("E") is not None else (1.0,):
            rebound = None if self.spec.name in OWN_LOSS else np.array([0.5 - 0.5 * e, 0.5 + 0.5 * e])
            right = None if rebound is None else lambda t, v=rebound: v
            deck = FREE.format(law=self.law(E=e))
            yield self.case(
                "free impact, speeds after it",
                f"e {e:g}",
                deck,
                step=1e-4,
                right=right,
                compared=last_speed,
            )
        for name, values in (("E", (1.0, 1e-3, 0.0)), ("XI", (0.0, 1.0, 10.0)), ("C", (0.0, 1e6))):
            if self.spec.field(name) is not None and (self.spec.sample == "E=0.5" or name == "E"):
                for value in values:
                    text = contact(self.spec, 1e3 * STOREY, 1.0, 2, **{name: value})
                    if name != "E":
                        text = text.replace("E=0.5 ", "")
                    # a strong dashpot's force rises and falls within a share of the impact
                    yield self.case(
                        "restitution and dashpot of the contact", f"{name} {value:g}", pair(text),
                        step=STEP / (32 if name == "E" and value < 0.01 else 8),
                    )  # fmt: skip

    def damping_and_symmetry(self) -> Iterator[StabilityCase]:
        """Damped storeys, and two contacts that close at one instant."""
        for xi in (0.0, 1.0, 10.0):
            deck = pair(self.plain, damping=damped(xi))
            yield self.case("damping of the storeys over critical", f"{xi:g}", deck)
        deck = TWICE.format(law=self.plain)
        yield self.case("two contacts at the same instant", "symmetric", deck, step=STEP / 2)

    def grazing(self) -> Iterator[StabilityCase]:
        """Contacts that just close, or just stay open."""
        swing = 1.0 / OMEGA
        for gap in (1.0 - 1e-3, 1.0 - 1e-9, 1.0, 1.0 + 1e-9):
            yield self.case(
                "a contact that grazes", f"{gap:.9f} of the swing", pair(self.plain, gap=gap * swing)
            )

    def friction(self) -> Iterator[StabilityCase]:
        """An oblique impact with friction."""
        restitution = re.search(r"\bE=(\S+)", self.plain)
        lost, wall = 0.2 * (1.0 + (float(restitution[1]) if restitution else 1.0)), self.law(bodies=1)
        text = OBLIQUE.format(law=wall)
        right = None if self.spec.name in OWN_LOSS else lambda t, v=1.0 - lost: np.array([v])
        # the tangential spring, of limited stiffness, takes a little of the impulse
        yield self.case(
            "friction", "oblique impact", text, step=1e-4, right=right, inexact=2e-3, compared=last_speed
        )

    def bouncing(self) -> Iterator[StabilityCase]:
        """A bouncing ball until it is at rest, and a ball at rest."""
        for ratio, end in ((250.0, 6.0), (1e6, 3.0)):
            deck = BALL.format(gap=0.05, law=self.law(ratio, bodies=1), end=end)
            step = STEP / 16 if ratio < 1e3 else STEP  # the errors of twenty bounces add up
            yield self.case("a ball that comes to rest", f"stiffness {ratio:g}", deck, step=step)
        deck = BALL.format(gap=0, law=self.law(25.0, bodies=1), end=1.0)
        yield self.case("a ball that lies there", "gap 0", deck, step=STEP / 2)

    def crowds(self) -> Iterator[StabilityCase]:
        """Many contacts at once."""
        crowd = {"law": self.law(bodies=1), "k": STOREY}
        yield self.case("many contacts at once", "30", CROWD.format(n=30, end=0.3, **crowd))
        if (
            self.spec.name == "KELVIN_VOIGT"
        ):  # the number tries the program, not the law; all do as two of them do
            decks = [CROWD.format(n=n, end=0.1, **crowd) for n in (10_000, 2)]
            yield self.case("many contacts at once", "10000", decks[0], like=(decks[1], 1.0), heavy=True)

    def steps(self) -> Iterator[StabilityCase]:
        """Steps far too short and far too long."""
        for step in (1e-9, 1e-5, 0.05, 1.0):
            end = min(0.6, 200 * step) if step < 1e-4 else max(0.6, 2 * step)
            deck = pair(self.plain, gap=min(0.05, 0.1 * end), end=end, every=end / 10)
            yield self.case("steps", f"{step:g}", deck, step=step)

    def units_and_records(self) -> Iterator[StabilityCase]:
        """Other units of length; records that are a spike, a step, or zero."""
        for length, scale in (("mm", 1e3), ("km", 1e-3)):
            law = contact(self.spec, 1e3 * STOREY / scale, mass=scale)
            deck = pair(law, length=length, k1=STOREY / scale, k2=STOREY / scale, gap=0.05 * scale,
                        mass=1.0, speed=scale)  # fmt: skip
            deck = deck.replace("GRAVITY 1", f"GRAVITY {scale!r}")
            yield self.case("units", length, deck, like=(pair(self.plain), scale))
        for name, motion in (("a spike", SPIKE), ("a step", JUMP), ("zeros", ZEROS)):
            deck = pair(
                self.plain, motion=motion, speed=0.0 if name != "zeros" else 1.0, k2=2 * STOREY, gap=0.01
            )
            yield self.case("records", name, deck)
