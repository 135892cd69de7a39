r"""Flag-shaped, self-centring: post-tensioned rocking joints with energy dissipators.

On the positive side, with :math:`d_y = F_y / k`, the force stays between two parallel lines,

.. math:: f_{up} = F_y + r k (d - d_y), \qquad
          f_{low} = (1 - \beta) F_y + r k \bigl(d - (1 - \beta) d_y\bigr)

The spring loads along the upper line, unloads with :math:`k` by the force :math:`\beta F_y`, returns along
the lower line and meets the elastic line :math:`f = k d` at :math:`(1 - \beta) d_y`.  The negative side is
the mirror image with a separate yield force.  With :math:`\beta \le 1` no residual deformation remains at
zero force.  A loop out to :math:`d` on one side dissipates :math:`\beta (1 - r) F_y (d - d_y)`.

Internal variables: the foot :math:`d - f/k` of the elastic line between the two lines, mirrored to the
positive side.

References
----------
Christopoulos C, Filiatrault A, Folz B (2002), Seismic response of self-centring hysteretic SDOF systems,
Earthquake Engng Struct. Dyn. 31(5): 1131-1150 (:math:`\alpha` there is our R).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import FY, FY_MINUS, BranchKind, K, Law, Numbers, Rule, above, below, linear
from pound_solve.laws.hysteresis.backbone import R_FIELD
from pound_solve.laws.mirror import inward, need_both_sides, outward, side, turns_inward, turns_outward

ELASTIC, YIELDING_PLUS, YIELDING_MINUS, INSIDE_PLUS, INSIDE_MINUS, BACK_PLUS, BACK_MINUS = range(7)
#: parameters of a law after K, FY, FY_MINUS: slope of the upper line; of the lower line, its slope and the
#: force at which it meets the elastic line, a fraction of the yield force; slopes are multiples of K
R, R_LOW, LOW = range(3, 6)
FOOT = 0  #: internal variable: foot of the elastic line, mirrored


def ends(p: Numbers, s: float) -> tuple[float, float]:
    """Return the forces at which the elastic line meets the two lines of a side, positive."""
    fy = p[FY] if s > 0.0 else -p[FY_MINUS]
    return fy, p[LOW] * fy


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state: elastic."""
    return ELASTIC, (0.0,)


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: elastic through the origin, along one of the two lines, or between them."""
    k, r, r_low = p[K], p[R], p[R_LOW]
    if at == ELASTIC:
        return linear(k, 0.0, above(p[FY] / k), below(p[FY_MINUS] / k))
    s = side(at)
    fy, low = ends(p, s)
    if at <= YIELDING_MINUS:
        return linear(r * k, s * (1.0 - r) * fy, turns_inward(s))
    if at <= INSIDE_MINUS:
        outer, inner = m[FOOT] / (1.0 - r) + fy / k, m[FOOT] / (1.0 - r_low) + low / k
        return linear(k, -s * k * m[FOOT], outward(s, outer), inward(s, inner))
    return linear(r_low * k, s * (1.0 - r_low) * low, turns_outward(s), inward(s, low / k))


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a yield, a reversal, reaching a line, or returning to the elastic line."""
    if at == ELASTIC:
        return (YIELDING_PLUS if event == 0 else YIELDING_MINUS), (0.0,)
    s = side(at)
    fy, low = ends(p, s)
    if at <= YIELDING_MINUS:
        return at + 2, ((1.0 - p[R]) * (s * d - fy / p[K]),)
    if at <= INSIDE_MINUS:
        return (at - 2 if event == 0 else at + 2), m
    if event == 1:
        return ELASTIC, (0.0,)
    return at - 2, ((1.0 - p[R_LOW]) * (s * d - low / p[K]),)


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy recovered along the elastic line, the lower line and the elastic line to the
    origin.
    """
    k, r_low = p[K], p[R_LOW]
    s = 1.0 if d >= 0.0 else -1.0
    foot = s * d - s * f / k
    if at == ELASTIC or foot <= 0.0:
        return 0.5 * f * f / k
    _, end = ends(p, s)
    run = foot / (1.0 - r_low)
    low = end + r_low * k * run
    return 0.5 * (f * f - low * low + end * end) / k + 0.5 * (low + end) * run


RULE = Rule(
    (
        *BranchKind.ELASTIC.named("elastic"),
        *BranchKind.YIELDING.named("yielding +", "yielding -"),
        *BranchKind.ELASTIC.named("inside +", "inside -"),
        *BranchKind.YIELDING.named("yielding back +", "yielding back -"),
    ),
    start,
    branch,
    transition,
    recoverable,
    parameters=6,
    variables=1,
)


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two yield forces."""
    need_both_sides(fy_plus, fy_minus)
    r = values["R"]
    return Law(RULE, (k, fy_plus, fy_minus, r, r, 1.0 - values["BETA"]))


SPEC = Spec(
    "hysteresis",
    "FLAG_SHAPED",
    "flag-shaped, self-centring",
    (
        R_FIELD,
        Field(
            "BETA",
            Kind.REAL,
            "-",
            above=0.0,
            hi=1.0,
            doc="ratio of flag height to yield force; for zero height use BILINEAR_ELASTIC",
        ),
    ),
    reference="Christopoulos, Filiatrault & Folz 2002",
    sample="R=0.05 BETA=0.7",
    impl=build,
)
