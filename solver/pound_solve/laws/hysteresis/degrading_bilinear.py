r"""Degrading bilinear: kinematic hardening with an elastic stiffness that decreases with the largest
ductility.

The yield lines are those of `backbone`, extended to the other side:

.. math:: f \le (1 - r)\,\gamma\varphi F_y^+ + r k d, \qquad f \ge (1 - r)\,\gamma\varphi F_y^- + r k d

Between them the spring follows the line through the last reversal with the stiffness :math:`k_u` of
`backbone`, for the largest ductility of either side.  With ALFA=0 and no strength loss the rule is
BILINEAR.

Internal variables: those of `backbone`; the point is that of the last reversal.

References
----------
Nielsen NN, Imbeault FA (1970), Validity of various hysteretic systems, Proc. 3rd Japan Earthquake Engng
Symp.: 707-714, after Otani S (1981), J. Faculty of Engng, Univ. of Tokyo 36(2): 407-441; Ruaumoko's
rule 10.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Spec
from pound_solve.laws.automaton import FY, FY_MINUS, BranchKind, K, Law, Numbers, Rule, above, below, linear
from pound_solve.laws.hysteresis.backbone import (
    ALFA_FIELD,
    CHANGES,
    ELASTIC,
    LOSS,
    MU,
    MU_MINUS,
    PARAMETERS,
    R_FIELD,
    VARIABLES,
    VIRGIN,
    D,
    F,
    enter_backbone,
    meeting_ductility,
    next_branch,
    parameters,
    reversed_at,
    unloading,
    yield_branch,
    yield_force,
)
from pound_solve.laws.mirror import side


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state: elastic."""
    return ELASTIC, VIRGIN


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: elastic until a yield line is reached, or along it until the motion reverses."""
    if at != ELASTIC:
        return yield_branch(p, at, m)
    plus, minus, d, f = m[:CHANGES]
    k = unloading(p, max(plus, minus))
    mu, mu_minus = meeting_ductility(p, m, 1.0, k, d, f), meeting_ductility(p, m, -1.0, k, d, f)
    return linear(k, f - k * d, above(mu * p[FY] / p[K]), below(mu_minus * p[FY_MINUS] / p[K]))


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a yield or a reversal."""
    if at == ELASTIC:
        s = 1.0 if event == 0 else -1.0
        k = unloading(p, max(m[MU], m[MU_MINUS]))
        return enter_backbone(p, m, s, meeting_ductility(p, m, s, k, m[D], m[F]))
    if event == 1:
        return next_branch(p, at, m)
    return ELASTIC, reversed_at(p, at, m, d)


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy recovered along the unloading line."""
    s = side(at)
    x = 1.0 if at == ELASTIC else s * d * p[K] / yield_force(p, s)
    return 0.5 * f * f / unloading(p, max(x, m[MU], m[MU_MINUS]))


RULE = Rule(
    (
        *BranchKind.ELASTIC.named("elastic"),
        *BranchKind.YIELDING.named("yielding +", "yielding -", "yielding weaker +", "yielding weaker -"),
    ),
    start,
    branch,
    transition,
    recoverable,
    parameters=PARAMETERS,
    variables=VARIABLES,
)


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two yield forces."""
    return Law(RULE, parameters(values, k, fy_plus, fy_minus))


SPEC = Spec(
    "hysteresis",
    "DEGRADING_BILINEAR",
    "bilinear, elastic stiffness falls with ductility",
    (R_FIELD, ALFA_FIELD, *LOSS),
    code=10,
    reference="Nielsen & Imbeault 1970; Otani 1981; Ruaumoko rule 10",
    sample="R=0.1 ALFA=0.4",
    impl=build,
)
