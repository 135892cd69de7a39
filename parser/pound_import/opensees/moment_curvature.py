r"""Moment and curvature of a section of fibres under an axial force, and the two lines that replace them.

Plane sections stay plane: $\varepsilon = \varepsilon_0 - y\,\kappa$; the strain $\varepsilon_0$ of the axis
is found for each curvature so that the fibres carry the axial force.

The curve ends where the moment has fallen to 80 % of its largest value, or at 15 times the curvature of
yield.  Two lines replace it as ASCE 41 asks for pushed buildings: the first is the secant at 60 % of the
yield moment, and the areas below line and curve are equal.

Reference
---------
ASCE 41-17, section 7.4.3.2.4.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, NamedTuple

from pound_import.opensees.fibres import Fibre

_STEPS: Final = 60  #: points of a curve
_DUCTILITY: Final = 15.0  #: curvature of the end over that of yield
_FALL: Final = 0.8  #: moment of the end over the largest
_SECANT: Final = 0.6  #: moment whose secant is the first line, over that of yield


class Stiffness(NamedTuple):
    """Initial stiffness of a section: EA [F], and EI about its own centre [F*L^2]."""

    axial: float
    bending: float


@dataclass(frozen=True, slots=True)
class TwoLines:
    """Two lines from the origin: stiffness [F*L^2], yield moment [F*L], ratio of the second slope."""

    stiffness: float
    strength: float
    ratio: float


def initial(fibres: Sequence[Fibre]) -> Stiffness:
    """Stiffness of the uncracked section."""
    depth = max(abs(fibre.y) for fibre in fibres) or 1.0
    tiny = 1e-7
    axial = first = second = 0.0
    for fibre in fibres:
        slope = max(fibre.stress(tiny), -fibre.stress(-tiny)) / tiny
        axial += slope * fibre.area
        first += slope * fibre.area * fibre.y / depth
        second += slope * fibre.area * (fibre.y / depth) ** 2
    return Stiffness(axial, (second - first * first / axial) * depth * depth if axial > 0.0 else 0.0)


def two_lines(fibres: Sequence[Fibre], axial: float, sign: float) -> TwoLines | None:
    """Two lines of bending in the direction of `sign`, under an axial force, tension positive.

    Returns
    -------
    TwoLines or None
        None if the section cannot carry the axial force, or has no moment.
    """
    curve = _curve(fibres, axial, sign)
    if len(curve) < 4:
        return None
    strength = 0.9 * max(moment for _, moment in curve)
    for _ in range(50):
        yielding = _at_moment(curve, _SECANT * strength)
        if yielding is None or yielding <= 0.0:
            return None
        stiffness = _SECANT * strength / yielding
        end, last, area = _end(curve, _DUCTILITY * strength / stiffness)
        # area of two lines through (0, 0), (strength / k, strength) and (end, last)
        k = stiffness
        better = (2.0 * area - end * last) / (end - last / k) if end > last / k else last
        better = min(max(better, 0.05 * last), max(moment for _, moment in curve))
        if math.isclose(better, strength, rel_tol=1e-10):
            break
        strength = better
    bends = strength / stiffness
    slope = (last - strength) / (end - bends) if end > bends else 0.0
    return TwoLines(stiffness, strength, slope / stiffness)


def _curve(fibres: Sequence[Fibre], axial: float, sign: float) -> list[tuple[float, float]]:
    """Curvatures and moments, from zero to the end of the section."""
    depth = max(fibre.y for fibre in fibres) - min(fibre.y for fibre in fibres)
    if depth <= 0.0:
        return []
    start = _moment(fibres, axial, 0.0)
    if start is None:
        return []
    curve = [(0.0, 0.0)]
    largest = 0.0
    for k in range(_STEPS + 1):
        curvature = 10.0 ** (-4.0 + 3.0 * k / _STEPS) / depth  # strains across the depth from 1e-4 to 0.1
        moment = _moment(fibres, axial, sign * curvature)
        if moment is None:
            break
        curve.append((curvature, sign * (moment - start)))
        largest = max(largest, curve[-1][1])
        if curve[-1][1] < _FALL * largest:
            break
    return curve if largest > 0.0 else []


def _moment(fibres: Sequence[Fibre], axial: float, curvature: float) -> float | None:
    """Moment at a curvature; None if no strain of the axis carries the axial force."""

    def excess(strain: float) -> float:
        return sum(f.area * f.stress(strain - f.y * curvature) for f in fibres) - axial

    spread = max(abs(f.y) for f in fibres) * abs(curvature) + 1e-6
    low, high = -spread, spread
    for _ in range(40):
        below, above = excess(low), excess(high)
        if below <= 0.0 <= above:
            break
        low, high = (2.0 * low, high) if below > 0.0 else (low, 2.0 * high)
        if max(-low, high) > 1.0:
            return None
    else:
        return None
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if excess(middle) <= 0.0 else (low, middle)
    strain = 0.5 * (low + high)
    return -sum(f.area * f.y * f.stress(strain - f.y * curvature) for f in fibres)


def _at_moment(curve: Sequence[tuple[float, float]], moment: float) -> float | None:
    """Curvature at which a moment is first reached."""
    for (k0, m0), (k1, m1) in pairwise(curve):
        if m1 >= moment > m0:
            return k0 + (k1 - k0) * (moment - m0) / (m1 - m0)
    return None


def _end(curve: Sequence[tuple[float, float]], limit: float) -> tuple[float, float, float]:
    """Curvature and moment of the end, and the area below the curve up to it."""
    area = 0.0
    for (k0, m0), (k1, m1) in pairwise(curve):
        if k1 > limit:
            m1 = m0 + (m1 - m0) * (limit - k0) / (k1 - k0)
            return limit, m1, area + 0.5 * (m0 + m1) * (limit - k0)
        area += 0.5 * (m0 + m1) * (k1 - k0)
    return *curve[-1], area
