r"""Trilinear with kinematic hardening: two yield points on each side.

The rule is a spring :math:`r_2 k` in parallel with two elastic, perfectly plastic springs: one with the
stiffness :math:`(1 - r) k` that yields at the deformation :math:`d_1 = F_y / k`, and one with
:math:`(r - r_2) k` that yields at

.. math:: d_2 = d_1 \left(1 + \frac{f_2 - 1}{r}\right), \qquad
          f = r_2 k d + (1 - r) k (d - p_1) + (r - r_2) k (d - p_2)

so that the slopes are k, then r k beyond :math:`F_y`, and :math:`r_2 k` beyond :math:`f_2 F_y`.  The
elastic range of the first spring lies within that of the second, so the first spring always slips first; a
reversal releases both.  Cycles obey Masing's rule.

Internal variables: the slips :math:`p_1, p_2`.

References
----------
Iwan WD (1966), A distributed-element model for hysteresis and its steady-state dynamic response, J. Appl.
Mech. 33(4): 893-900.  Ruaumoko has a rule of this name, but its number is not certain, so no number is
accepted.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import (
    REVERSAL_DOWN,
    REVERSAL_UP,
    BranchKind,
    Law,
    Numbers,
    Rule,
    above,
    below,
    linear,
)
from pound_solve.laws.refusal import ItemError

ELASTIC, FIRST_PLUS, FIRST_MINUS, SECOND_PLUS, SECOND_MINUS = range(5)
D1_PLUS = 3  #: index of the parameters d_1 and d_2, each for both sides, after k, r and r_2
P1, P2 = 0, 1  #: internal variables: slips of both springs


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state: elastic."""
    return ELASTIC, (0.0, 0.0)


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: elastic, the first spring slips, or both slip."""
    k, r, r2, d1_plus, d1_minus, d2_plus, d2_minus = p[:7]
    first, second = (1.0 - r) * k, (r - r2) * k
    if at == ELASTIC:
        return linear(k, -first * m[P1] - second * m[P2], above(m[P1] + d1_plus), below(m[P1] + d1_minus))
    if at == FIRST_PLUS:
        return linear(r * k, first * d1_plus - second * m[P2], REVERSAL_DOWN, above(m[P2] + d2_plus))
    if at == FIRST_MINUS:
        return linear(r * k, first * d1_minus - second * m[P2], REVERSAL_UP, below(m[P2] + d2_minus))
    if at == SECOND_PLUS:
        return linear(r2 * k, first * d1_plus + second * d2_plus, REVERSAL_DOWN)
    return linear(r2 * k, first * d1_minus + second * d2_minus, REVERSAL_UP)


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a slip of the first or second spring, or a reversal."""
    d1_plus, d1_minus, d2_plus, d2_minus = p[D1_PLUS:]
    if at == ELASTIC:
        return (FIRST_PLUS if event == 0 else FIRST_MINUS), m
    if at == FIRST_PLUS:
        return (ELASTIC, (d - d1_plus, m[P2])) if event == 0 else (SECOND_PLUS, m)
    if at == FIRST_MINUS:
        return (ELASTIC, (d - d1_minus, m[P2])) if event == 0 else (SECOND_MINUS, m)
    if at == SECOND_PLUS:
        return ELASTIC, (d - d1_plus, d - d2_plus)
    return ELASTIC, (d - d1_minus, d - d2_minus)


RULE = Rule(
    (
        *BranchKind.ELASTIC.named("elastic"),
        *BranchKind.YIELDING.named("yielding +", "yielding -", "yielding + again", "yielding - again"),
    ),
    start,
    branch,
    transition,
    parameters=7,
    variables=2,
)


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two first yield forces.

    Raises
    ------
    ValueError
        The slopes do not decrease: 1 > R > 0 and R > R2 are required.
    """
    r, r2, f2 = values["R"], values["R2"], values["F2"]
    if not 0.0 < r < 1.0 or r2 >= r:
        raise ItemError("slopes must fall: R between 0 and 1, and R2 below R", "R2")
    plus, minus = (1.0 + (f - 1.0) / r for f in (f2[0], f2[-1]))
    d1_plus, d1_minus = fy_plus / k, fy_minus / k
    return Law(RULE, (k, r, r2, d1_plus, d1_minus, d1_plus * plus, d1_minus * minus))


SPEC = Spec(
    "hysteresis",
    "TRILINEAR",
    "trilinear, kinematic hardening",
    (
        Field(
            "R",
            Kind.REAL,
            "-",
            above=0.0,
            below=1.0,
            doc="stiffness after the first yield / initial stiffness",
        ),
        Field(
            "R2",
            Kind.REAL,
            "-",
            default=0.0,
            below=1.0,
            doc="stiffness after the second yield / initial stiffness",
        ),
        Field(
            "F2",
            Kind.REAL,
            "-",
            above=1.0,
            count=(1, 2),
            doc="second yield force as a multiple of the first; two values: positive and negative side",
        ),
    ),
    reference="Iwan 1966",
    sample="R=0.4 R2=0.05 F2=1.6",
    impl=build,
)
