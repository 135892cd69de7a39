r"""Stereomechanics: rigid bodies that collide change their velocities instantaneously.

Two masses that approach each other at :math:`v_1 - v_2 > 0` separate with

.. math:: v_1' = v_1 - (1+e)\frac{m_2}{m_1+m_2}(v_1-v_2), \qquad
          v_2' = v_2 - (1+e)\frac{m_1}{m_1+m_2}(v_2-v_1)

(Goldsmith W (1960), Impact, Arnold; Cole et al. (2011), Earthquake Engng Struct. Dyn. 40: 641-659,
Eqs 1-2).
For a contact with the row b in a structure with the mass matrix M, this is the impulse

.. math:: J = (1+e)\,\frac{b^T v}{b^T M^{-1} b}, \qquad v' = v - M^{-1} b\,J

An impact without rebound closes the contact.  The contact then holds its deformation with the required
force, and opens when that force would become tensile (:mod:`~pound_solve.integrate.rigid.contacts`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import GAP, BranchKind, Law, Numbers, Rule, above, below, linear
from pound_solve.laws.contact.kelvin_voigt import Built
from pound_solve.laws.refusal import ItemError

OPEN, PRESSED = 0, 1
FORCE = 0  #: internal variable: force in a static state; a time history computes the force itself


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the open state."""
    return OPEN, (0.0,)


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: open up to the gap; pressed until the force falls below zero."""
    return linear(0.0, m[FORCE], above(p[GAP]) if at == OPEN else below(0.0))


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a touch or a separation."""
    return (PRESSED if at == OPEN else OPEN), (0.0,)


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return zero: the contact does not deform."""
    return 0.0


RULE = Rule(
    (*BranchKind.OPEN.named("open"), *BranchKind.HELD.named("pressed")),
    start,
    branch,
    transition,
    recoverable,
    parameters=3,
    variables=1,
)


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Build the law from a card's values (GAP, E).

    Raises
    ------
    ValueError
        There is an initial overlap, which rigid bodies cannot have; or a node has no mass.
    """
    if values["GAP"] < 0.0:
        raise ItemError(
            "rigid bodies do not overlap: GAP must be 0 or more, or LAW one with a stiffness", "GAP"
        )
    if reduced_mass == 0.0:
        raise ValueError("a rigid contact needs masses that meet: give its nodes weight")
    e = values["E"]
    return Built(Law(RULE, (0.0, e, values["GAP"])), math.inf, 0.0, math.nan, e, e, "rigid")


SPEC = Spec(
    "contact",
    "STEREOMECHANICS",
    "rigid: velocities jump",
    (Field("E", Kind.REAL, "-", lo=0, hi=1, doc="coefficient of restitution"),),
    reference="Goldsmith 1960; Cole et al. 2011, Eqs 1-2",
    sample="E=0.65",
    impl=build,
)
