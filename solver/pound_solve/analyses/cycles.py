r"""Loops of a pushover that turns, and the backbone of its cycles.

A leg from :math:`(d_1, V_1)` to :math:`(d_2, V_2)` encloses with its chord the area

.. math:: A = \int_{d_1}^{d_2}\Bigl(V - V_1 - \frac{\Delta V}{\Delta d}\,(d - d_1)\Bigr)\,\mathrm{d}d .

Two legs to and fro are a cycle, whose loop is the sum of their areas.  On a path that is elastic but not
linear, such as one on which a contact closes, these cancel.  The equivalent damping is the loop over
:math:`4\pi` times the elastic work of the amplitude (Jacobsen 1930; Chopra 2017):

.. math:: \xi_{eq} = \frac{A_{n-1} + A_n}{4\pi\,\tfrac12\,\frac{\Delta V}{2}\,\frac{\Delta d}{2}}
                   = \frac{2\,(A_{n-1} + A_n)}{\pi\,\Delta V\,\Delta d} .

The first leg starts from the static state: it does not belong to a loop.

The backbone joins, on each side of the static state, the ends of the legs that went further than all before
them: the first cycle of each amplitude, as in ASCE/SEI 41.

References
----------
ASCE/SEI 41-17 (2017), Seismic evaluation and retrofit of existing buildings, ASCE.
Chopra AK (2017), Dynamics of Structures, 5th edn, Pearson.
Jacobsen LS (1930), Steady forced vibration as influenced by damping, Transactions ASME 52(15): 169-181.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from pound_solve.analyses.pushover import CapacityPoint, PushoverResult, targets

CLOSED: Final = 1e-9  #: relative error of ends that meet, and of the area of a loop that is none


class Leg(NamedTuple):
    """Part of a path between two turns of the control displacement.

    Attributes
    ----------
    end : CapacityPoint
    largest : CapacityPoint
        The largest base shear in the sense of the leg.
    stiffness : float
        Slope of the chord [F/L].
    loop : float
        Area of the loop of this leg and the one before [F L]; NaN unless this leg ends where
        that one began.
    damping : float
        Equivalent damping ratio of that loop; NaN also where the base shear falls from one
        end to the other.
    """

    end: CapacityPoint
    largest: CapacityPoint
    stiffness: float
    loop: float
    damping: float


class BackbonePoint(NamedTuple):
    """End of a leg that went further to its side than all before it.

    Attributes
    ----------
    first : CapacityPoint
    last : CapacityPoint
        The end of the last leg to the same target.
    cycles : int
        Number of legs to it.
    """

    first: CapacityPoint
    last: CapacityPoint
    cycles: int


def legs(pushed: PushoverResult) -> list[Leg]:
    """Return the legs of a pushover; one that stopped before its target is the last."""
    paths = pushed.points_of_legs()
    answer = list[Leg]()
    for n, points in enumerate(paths):
        start, end = points[0], points[-1]
        along, across = end.displacement - start.displacement, end.shear - start.shear
        sense = math.copysign(1.0, along)
        largest = max(points, key=lambda p: sense * p.shear)
        loop = damping = math.nan
        if n > 1 and abs(paths[n - 1][0].displacement - end.displacement) <= CLOSED * abs(along):
            loop = _area(paths[n - 1]) + _area(points)
            loop = loop if abs(loop) > CLOSED * abs(along * across) else 0.0
            damping = 2.0 * loop / (math.pi * across * along) if across * along > 0.0 else math.nan
        stiffness = across / along if along else math.nan  # it may stop where it began
        answer.append(Leg(end, largest, stiffness, loop, damping))
    return answer


def _area(points: Sequence[CapacityPoint]) -> float:
    """Return the area between a leg and its chord [F L]."""
    d = np.array([p.displacement for p in points]) - points[0].displacement
    v = np.array([p.shear for p in points]) - points[0].shear
    return float(0.5 * np.diff(d) @ (v[1:] + v[:-1]) - 0.5 * v[-1] * d[-1])


def backbone(pushed: PushoverResult) -> list[BackbonePoint]:
    """Return the backbone from the furthest point on the negative side to that on the positive side."""
    origin = pushed.curve[0].displacement
    complete = pushed.points_of_legs()[: -1 if pushed.failed else None]
    ends = list(zip(targets(pushed.card), (points[-1] for points in complete)))
    reached = {1.0: 0.0, -1.0: 0.0}
    outer = list[BackbonePoint]()
    for target, end in ends:
        assert target is not None  # a load factor does not turn
        away = target - origin
        side = math.copysign(1.0, away)
        if abs(away) > reached[side]:
            reached[side] = abs(away)
            alike = [p for t, p in ends if t == target]
            outer.append(BackbonePoint(end, alike[-1], len(alike)))
    return sorted(outer, key=lambda point: point.first.displacement)
