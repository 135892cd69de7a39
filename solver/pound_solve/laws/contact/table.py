r"""A force given by points: a bumper or a stop with any force curve, which may crush permanently.

The force is linear between (0, 0) and the points, and continues beyond the last point with the last slope.
Without KU it unloads along the same lines.  With KU the contact is crushed: from the largest overlap
:math:`\delta_m` the force falls along the unloading stiffness,

.. math:: f = K_u(\delta - \delta_r), \qquad \delta_r = \delta_m - F(\delta_m)/K_u

and the bodies separate at the residual depth :math:`\delta_r`.  The gap has grown by this depth, so the
next touch occurs there.  On reloading the force follows the same line up to :math:`\delta_m`, then the
table.  :math:`K_u` is at least the steepest slope of the table, so the residual depth never decreases.

References
----------
None.  DIS_CHOC_ENDO of code_aster (validation cases SDND102 model G, SDND105) is a similar law.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import (
    GAP,
    NEVER,
    REVERSAL_DOWN,
    BranchKind,
    Law,
    Numbers,
    Rule,
    above,
    below,
    linear,
)
from pound_solve.laws.contact.kelvin_voigt import Built
from pound_solve.laws.refusal import ItemError

OPEN, MAX_SEGMENTS = 0, 8  #: segments of the table are branches 1 to MAX_SEGMENTS
UNLOADING = MAX_SEGMENTS + 1
# parameters of a law: the first slope, KU (0: it does not crush), GAP, number of the points, the points
KU, COUNT, POINTS = 1, 3, 4
RESIDUAL, LARGEST, SEGMENT = range(3)  #: internal variables: residual depth; largest overlap; segment at it


def point(p: Numbers, i: int) -> tuple[float, float]:
    """Return the overlap and the force of a point; the point before the first is (0, 0)."""
    return (p[POINTS + 2 * i - 2], p[POINTS + 2 * i - 1]) if i > 0 else (0.0, 0.0)


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the initial state: open, or pressed if the gap is negative (an initial overlap)."""
    return (1 if p[GAP] < 0.0 else OPEN), (0.0, 0.0, 0.0)


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: open, along the unloading line, or along a segment of the table."""
    ku, gap, count = p[KU], p[GAP], int(p[COUNT])
    if at == OPEN:
        return linear(0.0, 0.0, above(gap + m[RESIDUAL]))
    if at == UNLOADING:
        return linear(ku, -ku * (gap + m[RESIDUAL]), above(gap + m[LARGEST]), below(gap + m[RESIDUAL]))
    (d0, f0), (d1, f1) = point(p, at - 1), point(p, at)
    k = (f1 - f0) / (d1 - d0)
    further = above(gap + d1) if at < count else NEVER
    return linear(k, f0 - k * (gap + d0), further, below(gap + d0) if ku == 0.0 else REVERSAL_DOWN)


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a touch, a change of segment, an unloading or a separation."""
    ku, gap = p[KU], p[GAP]
    if at == OPEN:
        return (1 if m[LARGEST] == 0.0 else UNLOADING), m
    if at == UNLOADING:
        return (int(m[SEGMENT]) if event == 0 else OPEN), m
    if event == 0:
        return at + 1, m
    if ku == 0.0:
        return at - 1, m
    d0, f0 = point(p, at - 1)
    d1, f1 = point(p, at)
    force = f0 + (f1 - f0) / (d1 - d0) * (d - gap - d0)
    return UNLOADING, (max(d - gap - force / ku, m[RESIDUAL]), d - gap, float(at))


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the area below the table, or below the unloading line."""
    if at == OPEN:
        return 0.0
    if p[KU] != 0.0:
        return 0.5 * f * f / p[KU]
    area = 0.0
    for i in range(1, at):
        (d0, f0), (d1, f1) = point(p, i - 1), point(p, i)
        area += 0.5 * (f0 + f1) * (d1 - d0)
    d0, f0 = point(p, at - 1)
    return area + 0.5 * (f0 + f) * (d - p[GAP] - d0)


def steepest(p: Numbers) -> float:
    """Return KU, which is not below any slope of the table, or without KU the steepest slope."""
    ends = [point(p, i) for i in range(int(p[COUNT]) + 1)]
    return max(p[KU], *((f1 - f0) / (d1 - d0) for (d0, f0), (d1, f1) in pairwise(ends)))


SEGMENTS = tuple(f"pressed, segment {i}" for i in range(1, MAX_SEGMENTS + 1))
RULE = Rule(
    (*BranchKind.OPEN.named("open"), *BranchKind.PRESSED.named(*SEGMENTS, "pressed, unloading")),
    start,
    branch,
    transition,
    recoverable,
    steepest=steepest,
    parameters=POINTS + 2 * MAX_SEGMENTS,
    variables=3,
)


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Build the law from a card's values.

    Parameters
    ----------
    values : mapping
        GAP, DEPTHS, FORCES, KU.
    reduced_mass : float
        Of the colliding masses [F T^2/L], for the note alone; may be zero.

    Raises
    ------
    ValueError
        The points do not form a valid table, or KU is below its steepest slope.
    """
    depths, forces, ku = values["DEPTHS"], values["FORCES"], values["KU"]
    if len(depths) != len(forces):
        raise ItemError(
            f"DEPTHS has {len(depths)} values and FORCES {len(forces)}: they go in pairs", "DEPTHS"
        )
    path = [(0.0, 0.0), *zip(depths, forces)]
    slopes = []
    for (d0, f0), (d1, f1) in pairwise(path):
        if d1 <= d0:
            raise ItemError(f"DEPTHS must ascend from above 0: {d1:g} follows {d0:g}", "DEPTHS")
        slopes.append((f1 - f0) / (d1 - d0))
    if slopes[-1] < 0.0:
        raise ItemError(
            f"the last segment falls, and beyond its end the force would pull: end FORCES level, with a "
            f"further point of {forces[-1]:g}",
            "FORCES",
        )
    law = Law(
        RULE, (slopes[0], ku or 0.0, values["GAP"], len(depths), *(x for pair in path[1:] for x in pair))
    )
    if ku is None:
        resulting, note = 1.0, "elastic: back along the table"
    else:
        if ku < max(slopes):
            raise ItemError(f"KU {ku:g} is below the steepest slope of the table, {max(slopes):g}", "KU")
        resulting = math.nan
        energy_in = sum(0.5 * (f0 + f1) * (d1 - d0) for (d0, f0), (d1, f1) in pairwise(path))
        energy_back = 0.5 * forces[-1] ** 2 / ku
        at = math.sqrt(2.0 * energy_in / reduced_mass) if reduced_mass else math.inf
        note = (
            f"e depends on the speed: {math.sqrt(energy_back / energy_in):.4g} at {at:.4g}, which reaches "
            "the last of DEPTHS for the first time"
        )
    return Built(law, steepest(law.p), 0.0, 0.0, math.nan, resulting, note, limit=depths[-1])


SPEC = Spec(
    "contact",
    "TABLE",
    "tabulated force, elastic or crushing",
    (
        Field(
            "DEPTHS",
            Kind.REAL,
            "L",
            count=(1, MAX_SEGMENTS),
            above=0,
            doc="overlaps of the points, ascending",
        ),
        Field("FORCES", Kind.REAL, "F", count=(1, MAX_SEGMENTS), above=0, doc="their forces"),
        Field(
            "KU",
            Kind.REAL,
            "F/L",
            default=None,
            above=0,
            doc="unloading stiffness if crushing; omitted: back along the table",
        ),
    ),
    sample="DEPTHS=0.5,1.5,3 FORCES=1,1.4,3 KU=2.5",
    impl=build,
)
