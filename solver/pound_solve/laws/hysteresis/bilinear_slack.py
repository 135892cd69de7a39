r"""Bilinear with slackness: no force inside a gap, bilinear outside it.

The spring engages at :math:`d = g^+` (and at :math:`g^- \le 0`).  With GROW=YES (braces) the slack grows
by the plastic deformation of each side, see `slack_growing`.  With GROW=NO the whole slack zone moves by
a common plastic deformation :math:`p`, and the hardening is kinematic: on the positive side

.. math:: f = k (d - g^+ - p), \qquad f \le F_y^+ + H p, \qquad H = \frac{k r}{1 - r}

After a large :math:`p` the yield force of the other side, :math:`F_y^- + H p`, is above zero, and the
spring yields back before it becomes slack.

References
----------
Ruaumoko's rule 5 (the shape; written for slender cross braces).  Two choices are ours: the value of H,
which gives the yield line the slope :math:`r k` through the first yield point, and the two forms of growth.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import (
    FY,
    FY_MINUS,
    REVERSAL_DOWN,
    REVERSAL_UP,
    BranchKind,
    K,
    Law,
    Numbers,
    Rule,
    above,
    below,
    linear,
)
from pound_solve.laws.hysteresis.backbone import LOSS_OF_SIDE, R_FIELD, loses_strength, loss
from pound_solve.laws.hysteresis.slack_growing import growing_slack
from pound_solve.laws.mirror import need_both_sides
from pound_solve.laws.refusal import ItemError

SLACK, ELASTIC_PLUS, ELASTIC_MINUS, YIELDING_PLUS, YIELDING_MINUS, BACK_PLUS, BACK_MINUS = range(7)
GAP_PLUS, GAP_MINUS, R = range(3, 6)  #: parameters of a law after K, FY, FY_MINUS
PLASTIC = 0  #: internal variable: plastic deformation


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state: slack, or on a side without slack (or with a prestress, a negative
    slack).
    """
    if p[GAP_PLUS] <= 0.0:
        return ELASTIC_PLUS, (0.0,)
    return (ELASTIC_MINUS if p[GAP_MINUS] >= 0.0 else SLACK), (0.0,)


def first_yield(p: Numbers) -> tuple[float, float]:
    """Return the deformations at yield, beyond the slack."""
    return p[GAP_PLUS] + p[FY] / p[K], p[GAP_MINUS] + p[FY_MINUS] / p[K]


def yield_line(p: Numbers, at: int) -> tuple[float, float, float]:
    """Return gap, yield force and side (+1, -1) of a yield line; yielding back stays on the
    engaged side.
    """
    plus, minus, gap_plus, gap_minus = p[FY:R]
    if at == YIELDING_PLUS:
        return gap_plus, plus, 1.0
    if at == YIELDING_MINUS:
        return gap_minus, minus, -1.0
    return (gap_plus, minus, 1.0) if at == BACK_PLUS else (gap_minus, plus, -1.0)


def force_at_yield_back(p: Numbers, at: int, m: Numbers) -> float:
    """Return the force at which an elastic spring yields in the opposite direction unless it becomes slack
    first.
    """
    k, plus, minus, r = p[K], p[FY], p[FY_MINUS], p[R]
    shift = k * r / (1.0 - r) * m[PLASTIC]
    return minus + shift if at == ELASTIC_PLUS else plus + shift


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: slack, elastic on one side, or along a yield line."""
    k, plus, minus, gap_plus, gap_minus, r = p
    h = k * r / (1.0 - r)
    start_plus, start_minus = gap_plus + m[PLASTIC], gap_minus + m[PLASTIC]
    if at == SLACK:
        return linear(0.0, 0.0, above(start_plus), below(start_minus))
    if at == ELASTIC_PLUS:
        goes_slack = (-k, 0.0, k * start_plus + max(force_at_yield_back(p, at, m), 0.0))
        return linear(k, -k * start_plus, (k, 0.0, -k * start_plus - plus - h * m[PLASTIC]), goes_slack)
    if at == ELASTIC_MINUS:
        goes_slack = (k, 0.0, -k * start_minus - min(force_at_yield_back(p, at, m), 0.0))
        return linear(k, -k * start_minus, (-k, 0.0, k * start_minus + minus + h * m[PLASTIC]), goes_slack)
    gap, fy, side = yield_line(p, at)
    slope = r * k
    f0 = (1.0 - r) * fy - slope * gap
    if at == YIELDING_PLUS:
        return linear(slope, f0, REVERSAL_DOWN)
    if at == YIELDING_MINUS:
        return linear(slope, f0, REVERSAL_UP)
    reversal = REVERSAL_UP if side > 0.0 else REVERSAL_DOWN
    return linear(slope, f0, reversal, (-side * slope, 0.0, -side * f0))


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after an engagement, a yield, a reversal, or becoming slack."""
    k, r = p[K], p[R]
    if at == SLACK:
        return (ELASTIC_PLUS if event == 0 else ELASTIC_MINUS), m
    if at == ELASTIC_PLUS:
        if event == 0:
            return YIELDING_PLUS, m
        return (BACK_PLUS if force_at_yield_back(p, at, m) > 0.0 else SLACK), m
    if at == ELASTIC_MINUS:
        if event == 0:
            return YIELDING_MINUS, m
        return (BACK_MINUS if force_at_yield_back(p, at, m) < 0.0 else SLACK), m
    gap, fy, side = yield_line(p, at)
    slope = r * k
    m = (d - gap - ((1.0 - r) * fy + slope * (d - gap)) / k,)
    if event == 1:
        return SLACK, m
    return (ELASTIC_PLUS if side > 0.0 else ELASTIC_MINUS), m


RULE = Rule(
    (
        *BranchKind.OPEN.named("slack"),
        *BranchKind.ELASTIC.named("elastic +", "elastic -"),
        *BranchKind.YIELDING.named("yielding +", "yielding -", "yielding back +", "yielding back -"),
    ),
    start,
    branch,
    transition,
    first_yield=first_yield,
    parameters=6,
    variables=1,
)


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two yield forces."""
    gap = values["SLACK"]
    gap_minus = gap[1] if len(gap) == 2 else -gap[0]
    if gap[0] < 0 or gap_minus > 0:
        raise ItemError("SLACK needs a positive value, then a negative one", "SLACK")
    weakens = loses_strength(values)
    if weakens:
        need_both_sides(fy_plus, fy_minus)
    if values["GROW"] == "YES":
        return growing_slack(k, (fy_plus, fy_minus), (gap[0], gap_minus), values["R"], loss(values))
    if weakens:
        raise ItemError("a strength loss needs a slack that grows: GROW=YES", "ILOS")
    return Law(RULE, (k, fy_plus, fy_minus, gap[0], gap_minus, values["R"]))


SPEC = Spec(
    "hysteresis",
    "BILINEAR_SLACK",
    "bilinear with slack",
    (
        R_FIELD,
        Field(
            "SLACK",
            Kind.REAL,
            "L",
            default=(0.0,),
            count=(1, 2),
            doc="deformation at which the spring engages, positive and (signed) negative; one value: "
            "both sides",
        ),
        Field(
            "GROW",
            Kind.WORD,
            default="YES",
            words=("YES", "NO"),
            codes={"YES": 0, "NO": 1},
            doc="slack grows with yield",
        ),
        *LOSS_OF_SIDE,
    ),
    code=5,
    reference="Ruaumoko rule 5",
    sample="R=0.1 SLACK=0.5",
    impl=build,
)
