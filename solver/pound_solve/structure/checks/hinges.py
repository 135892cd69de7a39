"""Check of hinges in series whose rotations equilibrium does not determine."""

from __future__ import annotations

import math
from collections import defaultdict
from typing import Final

from pound_deck.diagnostics import Diagnostic
from pound_solve.laws.automaton import K, drive
from pound_solve.numerics.matrices import entries, used_rows
from pound_solve.structure.dofs import label
from pound_solve.structure.elements.base import LawSpring
from pound_solve.structure.structure import Structure

EQUAL_STRENGTHS: Final = 1e-6  #: relative difference up to which two strengths count as equal
#: deformation over that at yield at which the hardening of a rule is examined
EXAMINED_DUCTILITY: Final = 1.01
#: stiffness that counts as no hardening, as a fraction of the initial one
MIN_HARDENING_RATIO: Final = 1e-9


def facing_hinges(structure: Structure) -> list[Diagnostic]:
    """Report hinges of equal strength without hardening on both sides of a joint that nothing else
    restrains.

    Both carry the same moment, so at their common strength only the sum of their rotations is determined.
    Dashpots across the hinges divide the sum, except in a PUSHOVER, which has no rates.
    """
    n, problems = structure.n_free, list[Diagnostic]()
    held = used_rows(structure.stiffness) | used_rows(structure.mass)
    if all(card.spec.name != "PUSHOVER" for card in structure.model.analyses):
        held |= used_rows(structure.damping)
    at = defaultdict[int, list[tuple[LawSpring, float]]](list)
    for law, column, factor in zip(*entries(structure.law_rows)):
        if column < n and not held[column] and factor:
            at[int(column)].append((structure.laws[law], float(factor)))
    for column, joined in sorted(at.items()):
        if len(joined) != 2 or any(not s.component.startswith("hinge") for s, _ in joined):
            continue
        (one, a), (other, b) = joined
        moment = _common(one, other, -a / b)
        if moment and one.element != other.element:
            problems.append(_warning(structure, column, one, other, moment))
    return problems


def _common(one: LawSpring, other: LawSpring, ratio: float) -> float:
    """Common strength of two hinges that both yield without hardening, where the moment in the other is
    `ratio` times that in the one; 0 for none.
    """
    for side in (0, 1):
        facing_side = side if ratio > 0.0 else 1 - side
        mine, theirs = _flat_strength(one, side), _flat_strength(other, facing_side)
        if mine and math.isclose(abs(ratio) * mine, theirs, rel_tol=EQUAL_STRENGTHS):
            return mine
    return 0.0


def _flat_strength(spring: LawSpring, side: int) -> float:
    """Strength of a hinge on a side where it yields without hardening; 0 where it hardens or does not
    yield.
    """
    law = spring.law
    if law.curved or spring.strengths is None or spring.yields is None:
        return 0.0
    strength = spring.strengths[side]
    at_yield = spring.yields[side] - spring.beside * strength
    if not math.isfinite(at_yield):
        return 0.0
    stiffness = law.branch(drive(law, law.start(), 0.0, EXAMINED_DUCTILITY * at_yield)).stiffness
    return abs(strength) if stiffness <= MIN_HARDENING_RATIO * law.p[K] else 0.0


def _warning(
    structure: Structure, column: int, one: LawSpring, other: LawSpring, moment: float
) -> Diagnostic:
    """Return the warning for two hinges.

    The remedy names a rule with R, since ELASTO_PLASTIC has none.  A member without hinges may have no
    rule.
    """
    model, end = structure.model, other.component.rpartition(" ")[2]
    joint = label(structure.dofs.free[column]).removesuffix(" rz")
    message = (
        f"{one.component} of member {one.element} and {other.component} of member {other.element} face "
        f"each other at {joint} and yield at the same moment, {moment:g} {model.units.text('F*L')}, "
        "without hardening: which of them turns is open"
    )
    lonely = sum(law.element == other.element for law in structure.laws) == 1
    without = "hinges" if lonely else f"M{end}"
    hint = (
        f"give member {other.element} a property set without {without}, or both a rule that hardens, "
        "such as BILINEAR with R above zero"
    )
    return Diagnostic("P366", message, model.elements[other.element].span, hint, "warning")
