r"""Bilinear with kinematic hardening.

With stiffness :math:`k`, yield forces :math:`F_y^+ > 0 > F_y^-` and post-yield ratio :math:`r`, the rule is
a spring :math:`r k` in parallel with an elastic, perfectly plastic spring :math:`(1-r) k` that yields at
:math:`(1-r) F_y^\pm`:

.. math:: f = r k d + (1-r) k (d - d_p), \qquad (1-r) F_y^- \le (1-r) k (d - d_p) \le (1-r) F_y^+

With a strength loss (ILOS), the rule is that of `degrading_bilinear` with ALFA=0.

Internal variables: the plastic deformation :math:`d_p`.

References
----------
Iwan WD (1966), A distributed-element model for hysteresis and its steady-state dynamic response, J. Appl.
Mech. 33(4): 893-900 (the parallel form); Ruaumoko's rule 2.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import REVERSAL_DOWN, REVERSAL_UP, BranchKind, Law, Numbers, Rule, linear
from pound_solve.laws.hysteresis import degrading_bilinear
from pound_solve.laws.hysteresis.backbone import LOSS, loses_strength

ELASTIC, YIELDING_PLUS, YIELDING_MINUS = 0, 1, 2
PLASTIC = 0  #: internal variable: plastic deformation


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state: elastic."""
    return ELASTIC, (0.0,)


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: elastic until the slider slips, or yielding until the motion reverses."""
    k, plus, minus, r = p[:4]
    ke = (1.0 - r) * k
    if at == ELASTIC:
        pull = ke * m[PLASTIC]
        return linear(k, -pull, (ke, 0.0, -pull - (1.0 - r) * plus), (-ke, 0.0, pull + (1.0 - r) * minus))
    if at == YIELDING_PLUS:
        return linear(r * k, (1.0 - r) * plus, REVERSAL_DOWN)
    return linear(r * k, (1.0 - r) * minus, REVERSAL_UP)


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a yield or a reversal."""
    k, plus, minus = p[:3]
    if at == ELASTIC:
        return (YIELDING_PLUS if event == 0 else YIELDING_MINUS), m
    return ELASTIC, (d - (plus if at == YIELDING_PLUS else minus) / k,)


RULE = Rule(
    (*BranchKind.ELASTIC.named("elastic"), *BranchKind.YIELDING.named("yielding +", "yielding -")),
    start,
    branch,
    transition,
    parameters=4,
    variables=1,
)


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two yield forces."""
    if loses_strength(values):
        return degrading_bilinear.build(values, k, fy_plus, fy_minus)
    return Law(RULE, (k, fy_plus, fy_minus, values["R"]))


SPEC = Spec(
    "hysteresis",
    "BILINEAR",
    "bilinear, kinematic hardening",
    (
        Field("R", Kind.REAL, "-", default=0.0, below=1.0, doc="ratio of post-yield to initial stiffness"),
        *LOSS,
    ),
    code=2,
    reference="Iwan 1966; Ruaumoko rule 2",
    sample="R=0.1",
    impl=build,
)
