r"""Reloading towards the peak, common to CLOUGH, Q_HYST and TAKEDA.

From the backbone (`backbone`) the spring unloads with :math:`k_u`.  When its force is zero, at :math:`d_z`,
it reloads the other side along the straight line from :math:`(d_z, 0)` to a target on the backbone of that
side, at the ductility

.. math:: x_t = \mu - \beta (\mu - 1)

where :math:`\mu` is the largest ductility of that side (1, the yield point, before it has yielded).  Beyond
the target it follows the backbone.  A spring that reverses before the target unloads with :math:`k_u`
again.  If it reverses once more before the force is zero, it returns along the same line and continues
towards the target.

A reloading line is never steeper than :math:`k_u` (our choice).  If the target lies steeply above the
point, or behind it, as for large :math:`\beta`, the line has the slope :math:`k_u` up to the backbone.

Internal variables: those of `backbone`; the point is the last reversal, or the point of zero force.
"""

from __future__ import annotations

from pound_solve.laws.automaton import FY, FY_MINUS, BranchKind, K, Numbers, Rule, above, below, linear
from pound_solve.laws.hysteresis.backbone import (
    CHANGES,
    ELASTIC,
    PARAMETERS,
    VARIABLES,
    VIRGIN,
    D,
    F,
    backbone,
    enter_backbone,
    largest_ductility,
    meeting_ductility,
    next_branch,
    reversed_at,
    unloading,
    yield_branch,
    yield_force,
)
from pound_solve.laws.mirror import inward, on_side, outward, side, turns_inward

UNLOADING, RELOADING = 5, 7

# parameters of a law after those of the backbone: beta; whether a peak counts for both sides
BETA, MIRRORED = PARAMETERS, PARAMETERS + 1


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state: elastic."""
    return ELASTIC, VIRGIN


def reloading(p: Numbers, m: Numbers, s: float) -> tuple[float, float]:
    """Return the slope of the reloading line of side `s`, and the ductility at which it meets the
    backbone.
    """
    mu, fy = largest_ductility(m, s), yield_force(p, s)
    target = mu - p[BETA] * (mu - 1.0)
    steepest = unloading(p, mu)
    run, rise = target * fy / p[K] - s * m[D], backbone(p, m, s, target) - s * m[F]
    if 0.0 < rise < steepest * run:
        return rise / run, target
    return steepest, meeting_ductility(p, m, s, steepest, m[D], m[F])


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: elastic, on the backbone, unloading, or reloading."""
    if at == ELASTIC:
        return linear(p[K], 0.0, above(p[FY] / p[K]), below(p[FY_MINUS] / p[K]))
    if at < UNLOADING:
        return yield_branch(p, at, m)
    s, d, f = side(at), m[D], m[F]
    if at < RELOADING:
        k = unloading(p, largest_ductility(m, s))
        return linear(k, f - k * d, outward(s, s * d), inward(s, s * (d - f / k)))
    k, end = reloading(p, m, s)
    return linear(k, f - k * d, turns_inward(s), outward(s, end * yield_force(p, s) / p[K]))


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a yield, a reversal, a return to it, zero force, or an arrival at the
    backbone.
    """
    if at == ELASTIC:
        return enter_backbone(p, m, 1.0 if event == 0 else -1.0, 1.0)
    s = side(at)
    if at < UNLOADING:
        if event == 1:
            return next_branch(p, at, m)
        plus, minus, d, f, changes = reversed_at(p, at, m, d)
        if p[MIRRORED] != 0.0:
            plus = minus = max(plus, minus)
        return on_side(UNLOADING, s), (plus, minus, d, f, changes)
    plus, minus, d0, f0 = m[:CHANGES]
    if at < RELOADING:
        if event == 1:
            d = d0 - f0 / unloading(p, largest_ductility(m, s))
            return on_side(RELOADING, -s), (plus, minus, d, 0.0, m[CHANGES])
        # also after a reversal on the backbone: the reloading line from there has no length
        return on_side(RELOADING, s), m
    k, end = reloading(p, m, s)
    if event == 1:
        return enter_backbone(p, m, s, end)
    return on_side(UNLOADING, s), (plus, minus, d, f0 + k * (d - d0), m[CHANGES])


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy recovered along the unloading line."""
    if at == ELASTIC:
        return 0.5 * f * f / p[K]
    s = side(at)
    x = s * d * p[K] / yield_force(p, s) if at < UNLOADING else 0.0
    return 0.5 * f * f / unloading(p, max(x, largest_ductility(m, s)))


RULE = Rule(
    (
        *BranchKind.ELASTIC.named("elastic"),
        *BranchKind.YIELDING.named("yielding +", "yielding -", "yielding weaker +", "yielding weaker -"),
        *BranchKind.ELASTIC.named("unloading +", "unloading -", "reloading +", "reloading -"),
    ),
    start,
    branch,
    transition,
    recoverable,
    parameters=PARAMETERS + 2,
    variables=VARIABLES,
)
