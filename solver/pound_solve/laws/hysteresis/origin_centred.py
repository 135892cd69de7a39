r"""Origin-centred: below its peak each side is elastic along the line through the origin.

.. math:: f = \frac{F_m}{d_m}\, d

with the largest deformation :math:`d_m` of that side and the force :math:`F_m` of the `backbone` there.
Energy is dissipated only while a peak grows.

Internal variables: those of `backbone`.

References
----------
Ruaumoko's rule 7; the origin-oriented rule of Japanese practice.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Spec
from pound_solve.laws.automaton import FY, FY_MINUS, BranchKind, K, Law, Numbers, Rule, above, below, linear
from pound_solve.laws.hysteresis.backbone import (
    ELASTIC,
    LOSS,
    PARAMETERS,
    R_FIELD,
    VARIABLES,
    VIRGIN,
    backbone,
    enter_backbone,
    largest_ductility,
    next_branch,
    parameters,
    reversed_at,
    yield_branch,
    yield_force,
)
from pound_solve.laws.mirror import inward, on_side, outward, side

SECANT = 5


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state: elastic."""
    return ELASTIC, VIRGIN


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: elastic, on the backbone, or on the line between the origin and the peak of a
    side.
    """
    if at == ELASTIC:
        return linear(p[K], 0.0, above(p[FY] / p[K]), below(p[FY_MINUS] / p[K]))
    if at < SECANT:
        return yield_branch(p, at, m)
    s = side(at)
    mu = largest_ductility(m, s)
    peak = mu * yield_force(p, s) / p[K]
    return linear(backbone(p, m, s, mu) / peak, 0.0, outward(s, peak), inward(s, 0.0))


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a yield, a reversal, an arrival at the peak, or a passage through the
    origin.
    """
    if at == ELASTIC:
        return enter_backbone(p, m, 1.0 if event == 0 else -1.0, 1.0)
    s = side(at)
    if at < SECANT:
        return next_branch(p, at, m) if event == 1 else (on_side(SECANT, s), reversed_at(p, at, m, d))
    return enter_backbone(p, m, s, largest_ductility(m, s)) if event == 0 else (on_side(SECANT, -s), m)


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy recovered down to the origin."""
    return 0.5 * f * d


RULE = Rule(
    (
        *BranchKind.ELASTIC.named("elastic"),
        *BranchKind.YIELDING.named("yielding +", "yielding -", "yielding weaker +", "yielding weaker -"),
        *BranchKind.ELASTIC.named("secant +", "secant -"),
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
    "ORIGIN_CENTRED",
    "unloads to the origin",
    (R_FIELD, *LOSS),
    code=7,
    reference="Ruaumoko rule 7",
    sample="R=0.1",
    impl=build,
)
