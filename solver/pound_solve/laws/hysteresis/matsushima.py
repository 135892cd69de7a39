r"""Matsushima's rule: stiffness and strength fall with each inelastic half cycle.

A half cycle leads from zero force to zero force on one side.  After :math:`n` half cycles with a yield the
spring has the stiffness :math:`\alpha^n k` and the yield force :math:`\beta^n F_y`.

With hardening the rule holds for the part :math:`g` of the force beside that of the hardening spring:

.. math:: f = r k d + g, \qquad g = (1 - r) \alpha^n k (d - d_0), \qquad
          (1 - r) \beta^n F_y^- \le g \le (1 - r) \beta^n F_y^+

With :math:`\alpha = \beta = 1` the rule is BILINEAR.

Three choices are ours, since the source was not read.  The half cycles are those of :math:`g`, which is
the force if :math:`r = 0`.  The spring unloads with the stiffness of its half cycle, and the reduced values
apply from zero force on, so that no loop generates energy.  Neither factor falls below 0.01.

Internal variables: the deformation :math:`d_0` where :math:`g` is zero; :math:`n`; and whether the spring
has yielded in this half cycle.

References
----------
Matsushima (1969), as Ruaumoko's rule 28 is described; the source was not read.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import (
    FY,
    FY_MINUS,
    BranchKind,
    K,
    Law,
    Numbers,
    Rule,
    above,
    below,
    linear,
    passes,
)
from pound_solve.laws.hysteresis.backbone import R_FIELD, REMAINING_STRENGTH
from pound_solve.laws.mirror import (
    both_sides,
    inward,
    need_both_sides,
    on_side,
    outward,
    side,
    turns_inward,
)

# branches of the positive side, after the elastic one; add one for the negative side
ELASTIC, YIELDING, UNLOADING = 0, 1, 3
R, ALPHA, BETA = range(3, 6)  #: parameters of a law after K, FY, FY_MINUS
ZERO, COUNT, YIELDED = range(3)  #: internal variables


def stiffness(p: Numbers, n: float) -> float:
    """Return the stiffness of `g` after `n` half cycles."""
    factor: float = max(p[ALPHA] ** n, REMAINING_STRENGTH)
    return (1.0 - p[R]) * factor * p[K]


def strength(p: Numbers, n: float, s: float) -> float:
    """Return the limit of `g` on a side after `n` half cycles, positive."""
    fy = p[FY] if s > 0.0 else -p[FY_MINUS]
    factor: float = max(p[BETA] ** n, REMAINING_STRENGTH)
    return (1.0 - p[R]) * factor * fy


def limit(p: Numbers, m: Numbers, s: float) -> float:
    """Return the deformation from zero `g` to the yield of a side, positive."""
    return strength(p, m[COUNT], s) / stiffness(p, m[COUNT])


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state: elastic."""
    return ELASTIC, (0.0, 0.0, 0.0)


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: elastic, along a yield line, or back from it until `g` is zero."""
    hardening, zero = p[R] * p[K], m[ZERO]
    if at == ELASTIC:
        k = stiffness(p, m[COUNT])
        ends = above(zero + limit(p, m, 1.0)), below(zero - limit(p, m, -1.0))
        return linear(hardening + k, -k * zero, *ends)
    s = side(at)
    if at < UNLOADING:
        return linear(hardening, s * strength(p, m[COUNT], s), turns_inward(s))
    k, x = stiffness(p, m[COUNT]), s * zero
    return linear(hardening + k, -k * zero, outward(s, x + limit(p, m, s)), inward(s, x))


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a yield, a reversal, or the end of an inelastic half cycle."""
    if at == ELASTIC:
        return on_side(YIELDING, 1.0 if event == 0 else -1.0), m
    s = side(at)
    if at >= UNLOADING:
        return (on_side(YIELDING, s), m) if event == 0 else (ELASTIC, (m[ZERO], m[COUNT] + 1.0, 0.0))
    x, run = s * d, limit(p, m, s)
    if not passes(x, s * m[ZERO] + run, max(abs(d), run)):
        return (on_side(UNLOADING, s) if m[YIELDED] > 0.0 else ELASTIC), m
    return on_side(UNLOADING, s), (s * (x - run), m[COUNT], 1.0)


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy recovered on the way to zero force, partly in the next half cycle."""
    hardening, k = p[R] * p[K], stiffness(p, m[COUNT])
    if at != ELASTIC:
        g = f - hardening * d
        at_end = f - g * (hardening + k) / k  # force where g becomes zero
        if at_end * f > 0.0 and g * f > 0.0:
            later = hardening + stiffness(p, m[COUNT] + 1.0)
            return 0.5 * (f * f - at_end * at_end) / (hardening + k) + 0.5 * at_end * at_end / later
    return 0.5 * f * f / (hardening + k)


RULE = Rule(
    (
        *BranchKind.ELASTIC.named("elastic"),
        *BranchKind.YIELDING.named(*both_sides("yielding")),
        *BranchKind.ELASTIC.named(*both_sides("unloading")),
    ),
    start,
    branch,
    transition,
    recoverable,
    parameters=6,
    variables=3,
)


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two yield forces."""
    need_both_sides(fy_plus, fy_minus)
    return Law(RULE, (k, fy_plus, fy_minus, values["R"], values["ALFA"], values["BETA"]))


SPEC = Spec(
    "hysteresis",
    "MATSUSHIMA",
    "bilinear, stiffness and strength fall with half cycles",
    (
        R_FIELD,
        Field(
            "ALFA",
            Kind.REAL,
            "-",
            default=1.0,
            above=0.0,
            hi=1.0,
            doc="factor of the stiffness after each inelastic half cycle",
        ),
        Field(
            "BETA",
            Kind.REAL,
            "-",
            default=1.0,
            above=0.0,
            hi=1.0,
            doc="factor of the yield force after each inelastic half cycle",
        ),
    ),
    code=28,
    reference="Matsushima 1969; Ruaumoko rule 28",
    sample="R=0.05 ALFA=0.95 BETA=0.9",
    impl=build,
)
