r"""Slack that grows: outside its slack a spring is bilinear, and each side keeps its plastic deformation.

The formulas are for one side (`mirror`) with the slack :math:`g`.  At the deformation :math:`e = d - g`
beyond it, the force is at most

.. math:: F(e) = F_y \left[(1 - r)\,\varphi(x) + r x\right], \qquad x = e / d_y, \quad d_y = F_y / k

with the factor :math:`\varphi` of a strength loss (`backbone`).  The spring unloads with :math:`k` from the
largest deformation of the side, and lets go at zero force.

Internal variables: the largest deformations :math:`e` of both sides, initially those at yield, and their
plastic parts.

References
----------
See `bilinear_slack`.
"""

from __future__ import annotations

from pound_solve.laws.automaton import FY, FY_MINUS, BranchKind, K, Law, Numbers, Rule, above, below, linear
from pound_solve.laws.hysteresis import backbone
from pound_solve.laws.hysteresis.backbone import LINES, NO_LOSS, line_at, line_of_side
from pound_solve.laws.mirror import both_sides, inward, on_side, outward, side, turns_inward

SLACK, ELASTIC, YIELDING = 0, 1, 3  #: branches; of pairs that of the positive side, four lines of yielding
#: parameters of a law after those of `backbone`
GAP_PLUS, GAP_MINUS = backbone.PARAMETERS, backbone.PARAMETERS + 1
MOST, MOST_MINUS, PLASTIC, PLASTIC_MINUS = range(4)  #: internal variables, mirrored


def at_yield(p: Numbers, s: float) -> tuple[float, float]:
    """Return the yield force of a side and the deformation beyond its slack at yield, positive."""
    fy = p[FY] if s > 0.0 else -p[FY_MINUS]
    return fy, fy / p[K]


def gap(p: Numbers, s: float) -> float:
    """Return the deformation of a side at which the virgin spring engages, mirrored."""
    return p[GAP_PLUS] if s > 0.0 else -p[GAP_MINUS]


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state: slack, or on a side without slack (or with a prestress, a negative
    slack).
    """
    at = on_side(ELASTIC, 1.0) if p[GAP_PLUS] <= 0.0 else on_side(ELASTIC, -1.0)
    m = at_yield(p, 1.0)[1], at_yield(p, -1.0)[1], 0.0, 0.0
    return (SLACK if p[GAP_PLUS] > 0.0 > p[GAP_MINUS] else at), m


def first_yield(p: Numbers) -> tuple[float, float]:
    """Return the deformations at yield, beyond the slack."""
    return gap(p, 1.0) + at_yield(p, 1.0)[1], -gap(p, -1.0) - at_yield(p, -1.0)[1]


def most(m: Numbers, s: float) -> float:
    """Return the largest deformation of a side beyond its slack."""
    return m[MOST] if s > 0.0 else m[MOST_MINUS]


def edge(p: Numbers, m: Numbers, s: float) -> float:
    """Return the deformation at which a side engages, mirrored."""
    return gap(p, s) + (m[PLASTIC] if s > 0.0 else m[PLASTIC_MINUS])


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: slack, elastic on one side, or along a line of the backbone."""
    if at == SLACK:
        return linear(0.0, 0.0, above(edge(p, m, 1.0)), below(-edge(p, m, -1.0)))
    s = side(at)
    if at < YIELDING:
        x = edge(p, m, s)
        return linear(p[K], -s * p[K] * x, outward(s, gap(p, s) + most(m, s)), inward(s, x))
    slope, f0, end = line_of_side(p, (at - YIELDING) // 2, at_yield(p, s)[0], p[K])
    f0 -= slope * gap(p, s)
    if end == 0.0:
        return linear(slope, s * f0, turns_inward(s))
    return linear(slope, s * f0, turns_inward(s), outward(s, gap(p, s) + end))


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after an engagement, a yield, a reversal, the end of a line, or letting go."""
    if at == SLACK:
        return on_side(ELASTIC, 1.0 if event == 0 else -1.0), m
    s = side(at)
    if at < YIELDING:
        if event == 1:
            return SLACK, m
        return on_side(YIELDING + 2 * line_at(p, most(m, s), at_yield(p, s)[1]), s), m
    if event == 1:
        return at + 2, m
    x = max(s * d - gap(p, s), most(m, s))
    slope, f0, _ = line_of_side(p, (at - YIELDING) // 2, at_yield(p, s)[0], p[K])
    plastic = x - (f0 + slope * x) / p[K]
    m = (x, m[MOST_MINUS], plastic, m[PLASTIC_MINUS]) if s > 0.0 else (m[MOST], x, m[PLASTIC], plastic)
    return on_side(ELASTIC, s), m


RULE = Rule(
    (
        *BranchKind.OPEN.named("slack"),
        *BranchKind.ELASTIC.named(*both_sides("elastic")),
        *BranchKind.YIELDING.named(*both_sides(*LINES)),
    ),
    start,
    branch,
    transition,
    first_yield=first_yield,
    parameters=backbone.PARAMETERS + 2,
    variables=4,
)


def growing_slack(
    k: float,
    strengths: tuple[float, float],
    slack: tuple[float, float],
    r: float = 0.0,
    loss: Numbers = NO_LOSS,
) -> Law:
    """Return the law of a spring whose slack grows.

    Parameters
    ----------
    k : float
        Stiffness [F/L].
    strengths, slack : tuple of float
        Yield forces [F] and deformations at which the spring engages [L]; those of the negative side have
        their sign.
    r : float
        Ratio of post-yield to initial stiffness.
    loss : tuple of float
        Strength loss: D1, D2, residual fraction, form, D3 and the loss per cycle, see `backbone`.
    """
    return Law(RULE, (k, *strengths, r, 0.0, *loss, *slack))
