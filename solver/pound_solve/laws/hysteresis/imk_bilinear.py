r"""Ibarra-Medina-Krawinkler, bilinear: kinematic hardening within a deteriorating backbone.

The backbone :math:`B`, the excursions and the deterioration are those of `imk`.  The force of each side is
bounded by

.. math:: U(d) = \max\bigl(\lambda F_{y0},\ \min(F_y + \alpha_s k\,(d - F_y/k),\ F_{lim},\
          F_{ref} + k_c d)\bigr)

at all deformations of either sign; within the bounds the spring is elastic with :math:`k_u`.  The *strength
limit* :math:`F_{lim}` is the smallest force so far at which the spring left the softening or residual
branch (initially the capping force).  Without it, lost strength would be regained at smaller deformations.

Internal variables of each side in addition to those of `imk`: the strength limit, and where the elastic
line meets the bound (the deformation, and the line of the bound).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Spec
from pound_solve.laws.automaton import NEVER, BranchKind, K, Law, Numbers, Rule, linear
from pound_solve.laws.hysteresis.imk import (
    BRANCHES,
    DONE,
    FAILED,
    FOOT,
    KU,
    KU_BEFORE,
    PARAMETERS,
    add_work,
    end_excursion,
    falling,
    fields,
    hardening,
    parameters,
    recoverable_energy,
    replace_side,
    residual,
    softened,
    ultimate,
    variables_of_side,
    virgin,
)
from pound_solve.laws.mirror import both_sides, inward, on_side, outward, side, turns_inward

ELASTIC, LEAST, HARDENING, LIMITED, FALLING, RESIDUAL = 1, 3, 5, 7, 9, 11
LIMIT, MEETS, ONTO = 2, 3, 4  #: variables of a side: strength limit; deformation and line at the bound
FAR = 1e300


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state: elastic."""
    sides = []
    for s in (1.0, -1.0):
        fy, cap, ref, _ = virgin(p, s)
        sides += [fy, ref, cap, fy / p[K], float(HARDENING)]
    return ELASTIC, (*sides, p[K], p[K], 0.0, 0.0, 0.0, 0.0)


def line(p: Numbers, s: float, m: Numbers, kind: int) -> tuple[float, float]:
    """Return the slope and the (mirrored) force at zero deformation of a line of the bound."""
    if kind == HARDENING:
        return hardening(p, s, m)
    if kind == LIMITED:
        return 0.0, variables_of_side(m, s)[LIMIT]
    if kind == FALLING:
        return falling(p, s, m)
    return 0.0, residual(p, s)


def next_line(p: Numbers, s: float, m: Numbers, kind: int) -> tuple[int, float]:
    """Return the line of the bound after `kind`, and the (mirrored) deformation where it begins."""
    least, limit = residual(p, s), variables_of_side(m, s)[LIMIT]
    (k1, f1), (k2, f2) = hardening(p, s, m), falling(p, s, m)
    d_residual = (least - f2) / k2
    d_falling = max((f2 - f1) / (k1 - k2), (limit - f2) / k2)
    if kind == LEAST:
        d_hardening = (least - f1) / k1 if k1 > 0.0 else -FAR
        return (HARDENING, d_hardening) if d_hardening < d_residual else (RESIDUAL, d_residual)
    if kind == HARDENING:
        if k1 > 0.0:
            d_limited = (limit - f1) / k1
        else:
            d_limited = FAR if f1 <= limit else -FAR
        return (LIMITED, d_limited) if d_limited < d_falling else (FALLING, d_falling)
    if kind == LIMITED and limit > least:
        return FALLING, d_falling
    return RESIDUAL, (FAR if kind == RESIDUAL else d_residual)


def bound_met(p: Numbers, s: float, m: Numbers) -> tuple[int, float]:
    """Return the line of the bound that the elastic line meets, and the (mirrored) deformation there."""
    ku, foot, least, limit = m[KU], s * m[FOOT], residual(p, s), variables_of_side(m, s)[LIMIT]
    (k1, f1), (k2, f2) = hardening(p, s, m), falling(p, s, m)
    d_least = foot + least / ku
    if k2 * d_least + f2 <= least:
        return RESIDUAL, d_least
    if limit <= least:
        return LIMITED, d_least
    if k1 * d_least + f1 < least:
        return LEAST, d_least
    d_hardening = (f1 + ku * foot) / (ku - k1) if ku > k1 else FAR
    d_limited = foot + limit / ku
    d_falling = (f2 + ku * foot) / (ku - k2)
    d_met = min(d_hardening, min(d_limited, d_falling))
    return (HARDENING if d_met == d_hardening else LIMITED if d_met == d_limited else FALLING), d_met


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: elastic between the bounds, or along a line of a bound."""
    if at == FAILED:
        return linear(0.0, 0.0)
    s = side(at)
    last = ultimate(p, s) if ultimate(p, s) > 0.0 else FAR
    if at < LEAST:
        ku, foot = m[KU], m[FOOT]
        return linear(
            ku, -ku * foot, outward(s, min(variables_of_side(m, s)[MEETS], last)), inward(s, s * foot)
        )
    kind = at if s > 0.0 else at - 1
    k, f0 = line(p, s, m, kind)
    _, end = next_line(p, s, m, kind)
    end = min(end, last)
    return linear(k, s * f0, turns_inward(s), outward(s, end) if end < FAR else NEVER)


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a yield, the end of a line, a failure, a reversal, or the end of an
    excursion.
    """
    s = side(at)
    kind = at if s > 0.0 else at - 1
    present = branch(p, at, m)
    m = add_work(present, m, d)
    of_side = variables_of_side(m, s)
    if kind == ELASTIC and event == 1:
        m, _, fails = end_excursion(p, m, -s, d)
        onto, d_met = bound_met(p, -s, m)
        m = replace_side(m, -s, (*variables_of_side(m, -s)[:MEETS], d_met, float(onto)))
        return (FAILED if fails else on_side(ELASTIC, -s)), m
    if kind == ELASTIC:
        following, d_next = int(of_side[ONTO]), of_side[MEETS]
    elif event == 1:
        following, d_next = next_line(p, s, m, kind)
    else:
        k, _, f0 = present[:3]
        f = s * (k * d + f0)
        ku = softened(p, m, f)
        limit = min(of_side[LIMIT], f) if kind >= FALLING else of_side[LIMIT]
        m = replace_side(m, s, (*of_side[:LIMIT], limit, s * d, float(kind)))
        return on_side(ELASTIC, s), (*m[:KU], ku, m[KU_BEFORE], d - s * f / ku, *m[DONE:])
    no_strength = following == RESIDUAL and residual(p, s) == 0.0
    if no_strength or 0.0 < ultimate(p, s) < d_next:
        return FAILED, m
    return on_side(following, s), m


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy recovered along the unloading line."""
    if at == FAILED:
        return 0.0
    return recoverable_energy(p, m, branch(p, at, m), at >= LEAST, d, f)


RULE = Rule(
    (
        *BRANCHES,
        *BranchKind.ELASTIC.named(*both_sides("elastic")),
        *BranchKind.YIELDING.named(
            *both_sides(
                "yielding at the residual strength",
                "yielding",
                "yielding at the strength limit",
                "yielding beyond the cap",
                "yielding at the residual strength",
            )
        ),
    ),
    start,
    branch,
    transition,
    recoverable,
    parameters=PARAMETERS,
    variables=16,
)


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two yield forces."""
    return Law(RULE, parameters(values, k, fy_plus, fy_minus))


SPEC = Spec(
    "hysteresis",
    "IMK_BILINEAR",
    "bilinear with capping and cyclic deterioration",
    fields("basic strength, post-capping strength, unloading stiffness", 3),
    reference="Ibarra, Medina & Krawinkler 2005; Lignos & Krawinkler 2011",
    sample="R=0.05 DP=3 DPC=8 RESIDUAL=0.2 LAMBDA=80",
    impl=build,
)
