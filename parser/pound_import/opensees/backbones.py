"""Stress of fibres under strain that grows from zero: the first loading of uniaxial materials.

Adding a material is one function and one entry of `BACKBONES`.

References
----------
OpenSees documentation, commands uniaxialMaterial; Concrete01, Concrete02: Kent DC, Park R (1971), Flexural
members with confined concrete, J. Struct. Div. ASCE 97(7): 1969-1990; Concrete04: Popovics S (1973), A
numerical approach to the complete stress-strain curve of concrete, Cem. Concr. Res. 3(5): 583-599; Steel02:
Menegotto M, Pinto PE (1973), IABSE symposium, Lisbon.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Final

from pound_import.opensees.commands import Command, options
from pound_import.opensees.materials import positive, values
from pound_import.opensees.model import ScriptModel

Stress = Callable[[float], float]  #: stress of a strain


def backbone(model: ScriptModel, tag: int, user: Command) -> Stress:
    """Stress of the first loading of a material.

    Raises
    ------
    Mistake
        There is no such material, or its first loading is not known here.
    """
    command = model.item("the material", model.materials, tag, user)
    name = command.word(1, "the type")
    if name == "MinMax":
        return _limited(model, command)
    if name == "Fatigue":
        return backbone(model, command.whole(3, "the tag"), command)
    if name not in BACKBONES:
        hint = "fibres may be of " + ", ".join(sorted(BACKBONES))
        raise command.mistake(f"uniaxialMaterial {name[:40]} in fibres has no counterpart here", hint)
    return BACKBONES[name](command)


def is_concrete(model: ScriptModel, tag: int) -> bool:
    """Whether a material carries little or no tension."""
    return tag in model.materials and model.materials[tag].words[1].startswith("Concrete")


def _elastic(command: Command) -> Stress:
    e = values(command, 1, 3)[0]
    return lambda strain: e * strain


def _bilinear(e: float, strength: float, b: float) -> Stress:
    def stress(strain: float) -> float:
        elastic = e * strain
        if abs(elastic) <= strength:
            return elastic
        return math.copysign(strength + b * (abs(elastic) - strength), strain)

    return stress


def _steel01(command: Command) -> Stress:
    strength, e, b = values(command, 3, 7)[:3]
    positive(command, "Fy E", [strength, e])
    return _bilinear(e, strength, b)


def _hardening(command: Command) -> Stress:
    e, strength, isotropic, kinematic = values(command, 4, 5)[:4]
    positive(command, "E Fy", [e, strength])
    slope = isotropic + kinematic
    return _bilinear(e, strength, slope / (e + slope))


def _elastic_plastic(command: Command) -> Stress:
    e, plus, *rest = values(command, 2, 4)
    positive(command, "E epsyP", [e, plus])
    minus = rest[0] if rest else -plus
    return lambda strain: e * min(max(strain, minus), plus)


def _steel02(command: Command) -> Stress:
    strength, e, b, *shape = values(command, 3, 11)
    positive(command, "Fy E", [strength, e])
    sharp = shape[0] if shape else 20.0

    def stress(strain: float) -> float:
        x = abs(strain) * e / strength
        y = b * x + (1.0 - b) * x / (1.0 + x**sharp) ** (1.0 / sharp) if x < 1e6 else b * x + 1.0 - b
        return math.copysign(strength * y, strain)

    return stress


def _parabola(peak: float, at: float, last: float, end: float) -> Stress:
    """Concrete in compression: a parabola to the peak, a line to the crushing strain, and level."""

    def stress(strain: float) -> float:
        if strain >= 0.0:
            return 0.0
        if strain > at:
            return peak * (2.0 - strain / at) * strain / at
        if strain > end:
            return peak + (last - peak) * (strain - at) / (end - at)
        return last

    return stress


def _concrete01(command: Command) -> Stress:
    peak, at, last, end = (-abs(x) for x in values(command, 4, 4))
    positive(command, "-fpc -epsc0 epsc0-epsU", [-peak, -at, at - end])
    return _parabola(peak, at, last, end)


def _concrete02(command: Command) -> Stress:
    given = values(command, 7, 7)
    peak, at, last, end = (-abs(x) for x in given[:4])
    positive(command, "-fpc -epsc0 epsc0-epsU", [-peak, -at, at - end])
    tensile, falls = given[5], abs(given[6])
    compressive, e = _parabola(peak, at, last, end), 2.0 * peak / at

    def stress(strain: float) -> float:
        if strain < 0.0:
            return compressive(strain)
        return min(e * strain, max(tensile - falls * (strain - tensile / e), 0.0))

    return stress


def _concrete04(command: Command) -> Stress:
    given = values(command, 4, 7)
    peak, at, end = (-abs(x) for x in given[:3])
    e = given[3]
    positive(command, "-fc -ec Ec Ec-fc/ec", [-peak, -at, e, e - peak / at])
    r = e / (e - peak / at)
    tensile, last = (given[4], given[5]) if len(given) > 5 else (0.0, 0.0)

    def stress(strain: float) -> float:
        if end <= strain < 0.0:
            x = strain / at
            return peak * x * r / (r - 1.0 + math.pow(x, r))
        if strain >= 0.0 and tensile > 0.0 and e * strain <= tensile:
            return e * strain
        if 0.0 <= strain < last:
            beta = given[6] if len(given) > 6 else 0.1
            cracked = tensile / e
            return (
                float(tensile * beta ** ((strain - cracked) / (last - cracked))) if last > cracked else 0.0
            )
        return 0.0

    return stress


def _hysteretic(command: Command) -> Stress:
    given = values(command, 12, 17)
    points = given[:8] if len(given) < 16 else given[:12]
    half = len(points) // 2
    sides = [list(zip(side[1::2], side[::2])) for side in (points[:half], points[half:])]
    positive(command, "e1p s1p -e1n -s1n", [*sides[0][0], *(-x for x in sides[1][0])])
    for sign, side in zip((1.0, -1.0), sides):
        for (before, _), (after, _) in pairwise(side):
            positive(command, "the growth of strain", [sign * (after - before)])

    def stress(strain: float) -> float:
        side = sides[0] if strain >= 0.0 else sides[1]
        x0, y0 = 0.0, 0.0
        for x, y in side:
            if abs(strain) <= abs(x):
                break
            x0, y0 = x, y
        else:
            return y0
        return y0 + (y - y0) * (strain - x0) / (x - x0)

    return stress


def _limited(model: ScriptModel, command: Command) -> Stress:
    inner = backbone(model, command.whole(3, "the tag"), command)
    choice = options(command, 4)
    least, most = choice.real("-min", -math.inf), choice.real("-max", math.inf)
    return lambda strain: inner(strain) if least < strain < most else 0.0


BACKBONES: Final[Mapping[str, Callable[[Command], Stress]]] = {
    "Elastic": _elastic,
    "ElasticPP": _elastic_plastic,
    "Steel01": _steel01,
    "Steel02": _steel02,
    "Hardening": _hardening,
    "Hysteretic": _hysteretic,
    "Concrete01": _concrete01,
    "Concrete02": _concrete02,
    "Concrete04": _concrete04,
}
