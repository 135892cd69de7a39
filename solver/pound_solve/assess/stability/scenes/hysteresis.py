"""Stress scenes with one hysteresis rule."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Final

from pound_deck.schema import Spec
from pound_solve.assess.stability.scenes.case import (
    JUMP,
    SPIKE,
    STEP,
    STOREY,
    ZEROS,
    StabilityCase,
    damped,
    every,
    items,
)
from pound_solve.numerics.types import Array

STOREYS: Final = """UNITS kN {length} s
GRAVITY {g!r}
NODES
 1 0 0 FIX=XYR
 2 0 1 FIX=YR
 3 0 2 FIX=YR
ELEMENTS
 1 SPR 1 2
 2 SPR 2 3
PROPS
 SPR SPRING KX={k!r} FX={fy!r} RULE={rule}
WEIGHTS
 2 {middle!r}
 3 1
{damping}EQUAKE
 {motion}
ANALYSIS
 HISTORY {end!r} METHOD=@METHOD
OUTPUT
 EVERY={every!r} NODES=2,3
"""


def storeys(rule: str, **given: object) -> str:
    """Deck of two storeys on springs of one rule, shaken by a sine close to their period."""
    plain: dict[str, object] = {
        "length": "m", "g": 1.0, "k": 2.6 * STOREY, "fy": 4.0, "middle": 1.0, "damping": "", "end": 2.0,
        "every": 0.05, "motion": "SINE AMPLITUDE=4 PERIOD=1 DURATION=30",
    }  # fmt: skip
    return STOREYS.format(rule=rule, **{**plain, **given})


def top(t: Array, u: Array) -> Array:
    """Displacements of the last node only: of two springs in line that yield without hardening, with hardly
    any mass between, the plastic deformation may be in either.
    """
    return u[:, -1:]


def hysteresis_scenes(spec: Spec) -> Iterator[StabilityCase]:
    """Yield all scenes with one hysteresis rule."""
    scenes = _Springs(spec)
    yield from scenes.strength_and_stiffness()
    yield from scenes.masses_and_motions()
    yield from scenes.steps_and_units()


class _Springs:
    """The scenes of one hysteresis rule."""

    def __init__(self, spec: Spec) -> None:
        self.spec = spec
        self.plain = self.rule()

    def rule(self, fy: float = 4.0, k: float = 2.6 * STOREY, **given: float) -> str:
        """Text of the rule, the lengths and forces of its sample items scaled by those at yield."""
        return items(self.spec, fy / k, fy, **given)

    def case(self, scene: str, variant: str, deck: str, **given: Any) -> StabilityCase:
        """Make a case of this rule."""
        return StabilityCase("hysteresis", scene, variant, self.spec.name, deck, **given)

    def strength_and_stiffness(self) -> Iterator[StabilityCase]:
        """Springs without strength, without yield, soft and rigid."""
        for force in (0.0, 1e-9, 1e12):
            elastic = storeys("ELASTIC").replace("FX=4.0 RULE=ELASTIC", "") if force > 1.0 else ""
            if "SLACK=" in self.plain:  # as wide as the yield deformation: nothing holds
                elastic = ""
            deck = storeys(self.rule(force) if force else self.plain, fy=force)
            yield self.case("yield force", f"{force:g}", deck, like=(elastic, 1.0))
        for ratio in (1e-6, 1e-3, 1e3, 1e6, 1e12):
            k = 2.6 * STOREY * ratio
            deck = storeys(self.rule(k=k), k=k)
            step = STEP / 32 if ratio == 1e3 else STEP  # resolves the stiffer springs, or does not
            yield self.case("stiffness of the springs", f"{ratio:g}", deck, step=step, heavy=ratio > 1e5)

    def masses_and_motions(self) -> Iterator[StabilityCase]:
        """Unequal masses, softening branches, resonance, damping, extreme records."""
        for ratio in (0.0, 1e-8, 1e8):
            yield self.case(
                "mass of the middle over the top's", f"{ratio:g}", storeys(self.plain, middle=ratio),
                compared=top if ratio < 1.0 else every,
            )  # fmt: skip
        if self.spec.field("R") is not None:
            for r in (-0.05, -0.5):
                deck = storeys(self.rule(R=r), motion="TABLE POINTS=0,6,1,6", end=3.0)
                yield self.case("softening branch to collapse", f"R {r:g}", deck)
        if self.spec.field("DPC") is not None:
            deck = storeys(self.plain, motion="TABLE POINTS=0,6,1,6", end=3.0)
            yield self.case("softening branch to collapse", "capped", deck)
        deck = storeys(self.plain, end=20.0, every=0.5)
        yield self.case("resonance", "20 periods", deck, step=STEP / 8)  # the errors of the periods add up
        for xi in (1.0, 10.0):
            yield self.case("damping over critical", f"{xi:g}", storeys(self.plain, damping=damped(xi)))
        for name, motion in (("a spike", SPIKE), ("a step", JUMP), ("zeros", ZEROS)):
            yield self.case("records", name, storeys(self.plain, motion=motion.split("\n")[1]))

    def steps_and_units(self) -> Iterator[StabilityCase]:
        """Steps far too short and far too long; other units of length."""
        for step in (1e-9, 1e-5, 0.1, 1.0):
            end = 200 * step if step < 1e-4 else max(2.0, 2 * step)
            deck, within = storeys(self.plain, end=end, every=end / 10), 0.02
            if step == 0.1:  # ten steps a period make it longer by (omega h)^2/12 = 3 %
                within = 0.05
            yield self.case("steps", f"{step:g}", deck, step=step, within=within)
        for length, scale in (("mm", 1e3), ("km", 1e-3)):
            k = 2.6 * STOREY / scale
            deck = storeys(self.rule(k=k), length=length, g=scale, k=k,
                           motion=f"SINE AMPLITUDE={4 * scale!r} PERIOD=1 DURATION=30")  # fmt: skip
            yield self.case("units", length, deck, like=(storeys(self.plain), scale))
