r"""Bilinear elastic: softer beyond a limit; it unloads along the same line, without energy loss.

.. math:: f = k d \quad (F^- \le k d \le F^+), \qquad f = F^\pm + r k (d - F^\pm / k) \quad \text{beyond}

It models a rocking wall or a post-tensioned joint; in parallel with a BILINEAR spring it gives a
flag-shaped loop.  It has no internal variables.

References
----------
Elementary.  Ruaumoko has a rule of this name, but its number is not certain, so no number is accepted.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import BranchKind, Law, Numbers, Rule, above, below, linear

STIFF, SOFT_PLUS, SOFT_MINUS = 0, 1, 2


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state: stiff."""
    return STIFF, ()


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: stiff between the limits, soft beyond."""
    k, plus, minus, r = p[:4]
    if at == STIFF:
        return linear(k, 0.0, above(plus / k), below(minus / k))
    if at == SOFT_PLUS:
        return linear(r * k, (1.0 - r) * plus, below(plus / k))
    return linear(r * k, (1.0 - r) * minus, above(minus / k))


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a limit is passed outwards or inwards."""
    if at == STIFF:
        return (SOFT_PLUS if event == 0 else SOFT_MINUS), m
    return STIFF, m


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return all the work: the area below the line."""
    k, plus, minus = p[:3]
    if at == STIFF:
        return 0.5 * k * d * d
    limit = plus if at == SOFT_PLUS else minus
    return 0.5 * limit * limit / k + 0.5 * (limit + f) * (d - limit / k)


RULE = Rule(
    BranchKind.ELASTIC.named("stiff", "soft +", "soft -"),
    start,
    branch,
    transition,
    recoverable,
    parameters=4,
    variables=0,
)


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two limits."""
    return Law(RULE, (k, fy_plus, fy_minus, values["R"]))


SPEC = Spec(
    "hysteresis",
    "BILINEAR_ELASTIC",
    "bilinear, elastic",
    (
        Field(
            "R",
            Kind.REAL,
            "-",
            default=0.0,
            lo=0.0,
            below=1.0,
            doc="stiffness beyond the limit / initial stiffness",
        ),
    ),
    reference="elementary",
    sample="R=0.1",
    impl=build,
)
