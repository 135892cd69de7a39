"""Checks of an assembled structure before the analyses: one function for each."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, floor, log10
from typing import Final

from pound_deck.diagnostics import Diagnostic
from pound_solve.analyses import pushover_checks
from pound_solve.structure.buildings import misnamed_buildings
from pound_solve.structure.checks.contacts import (
    duplicate_contacts,
    idle_contacts,
    misplaced_contacts,
    wide_gaps,
)
from pound_solve.structure.checks.drifts import doubtful_drifts
from pound_solve.structure.checks.ends import loose_ends
from pound_solve.structure.checks.first_modes import (
    contact_stiffnesses,
    frequencies_in_hertz,
    misdamped_buildings,
)
from pound_solve.structure.checks.frames import framing_mistakes
from pound_solve.structure.checks.hinges import facing_hinges
from pound_solve.structure.checks.loads import misloaded_buildings, unloaded_buildings
from pound_solve.structure.checks.masses import immovable_weights, massless_buildings, massless_roof
from pound_solve.structure.checks.materials import impossible_materials
from pound_solve.structure.checks.mechanisms import (
    coarse_steps,
    find_mechanisms,
    implausible_periods,
    supported_parts,
)
from pound_solve.structure.checks.members import doubled_members, implausible_hinges, misshapen_members
from pound_solve.structure.checks.supports import unmoved_feet, unsupported_buildings
from pound_solve.structure.checks.weights import (
    far_yielding_springs,
    implausible_base_strengths,
    misweighed_buildings,
    outsized_buildings,
)
from pound_solve.structure.damping.by_building import unevenly_damped_buildings
from pound_solve.structure.structure import Structure

MOST_STEPS: Final = 10**8  #: steps of a history: hours for a small structure
MOST_ROWS: Final = 5 * 10**6  #: rows of stored histories


def pressed_contacts(structure: Structure) -> list[Diagnostic]:
    """Warn of contacts that are closed at rest: some programs write the gap with a minus sign."""
    elements, props = structure.model.elements, structure.model.props
    used = dict.fromkeys(elements[s.element].prop for s in structure.laws if s.role.collides)
    hint = "a distance is positive; keep it if the bodies are pressed on purpose"
    return [
        Diagnostic(
            "P336",
            f"contacts of {label} are pressed at rest: GAP is {props[label]['GAP']:g}",
            props[label].place("GAP"),
            hint,
            "warning",
        )
        for label in used
        if props[label]["GAP"] < 0.0
    ]


def too_many_steps(structure: Structure) -> list[Diagnostic]:
    """Report histories of more than `MOST_STEPS` steps, or of more than `MOST_ROWS` stored rows."""
    model = structure.model
    diagnostics = []
    for card in model.analyses:
        if card.spec.name == "HISTORY":
            end = card["T"]
            asked = ("DT", "steps", card.values.get("DT"), MOST_STEPS, card.place("DT"))
            stored = ("EVERY", "rows", model.output["EVERY"], MOST_ROWS, model.output.place("EVERY"))
            for item, what, length, most, place in (asked, stored):
                if length is not None and end / length > most:
                    message = f"{item}={length:g} requires {end / length:.3g} {what}, more than {most:g}"
                    hint = f"over {end:g} {model.units.time} it is at least {rounded_up(end / most):g}"
                    diagnostics.append(Diagnostic("P345", message, place, hint))
    return diagnostics


def unsteady_buildings(structure: Structure) -> list[Diagnostic]:
    """Report buildings that are mechanisms; if there are none, those that could move as a rigid body."""
    return find_mechanisms(structure, supported_parts(structure)) or unsupported_buildings(structure)


def implausible_buildings(structure: Structure) -> list[Diagnostic]:
    """Report `unsteady_buildings`, the first implausible one of height, period and weight of each building,
    and values inconsistent with the periods.
    """
    parts, first = supported_parts(structure), dict[str, Diagnostic]()
    periods = implausible_periods(structure, parts)
    for name, diagnostic in (*outsized_buildings(structure), *periods, *misweighed_buildings(structure)):
        first.setdefault(name, diagnostic)
    mechanisms = find_mechanisms(structure, parts) or unsupported_buildings(structure)
    diagnostics = [*mechanisms, *first.values()]
    for check in (coarse_steps, misdamped_buildings, frequencies_in_hertz, contact_stiffnesses):
        diagnostics += check(structure, parts)
    return diagnostics


def rounded_up(x: float) -> float:
    """Round up to one significant digit."""
    unit = 10.0 ** floor(log10(x))
    return ceil(x / unit * (1.0 - 1e-12)) * unit


#: checks that need neither contacts nor damping: they may explain why these could not be built
FRAME_CHECKS: Final[tuple[Callable[[Structure], list[Diagnostic]], ...]] = (
    massless_buildings,
    immovable_weights,
    massless_roof,
    unloaded_buildings,
    misloaded_buildings,
    misshapen_members,
    doubled_members,
    implausible_hinges,
    facing_hinges,
    unmoved_feet,
    framing_mistakes,
)
CHECKS: Final[tuple[Callable[[Structure], list[Diagnostic]], ...]] = (
    pressed_contacts,
    wide_gaps,
    misplaced_contacts,
    duplicate_contacts,
    idle_contacts,
    impossible_materials,
    loose_ends,
    implausible_buildings,
    implausible_base_strengths,
    far_yielding_springs,
    *FRAME_CHECKS,
    pushover_checks.mistaken_cards,
    pushover_checks.distant_targets,
    too_many_steps,
    misnamed_buildings,
    unevenly_damped_buildings,
    doubtful_drifts,
)


def causes(structure: Structure) -> list[Diagnostic]:
    """Report why the damping and contacts of a structure could not be assembled."""
    return [diagnostic for check in (unsteady_buildings, *FRAME_CHECKS) for diagnostic in check(structure)]


def preflight(structure: Structure) -> list[Diagnostic]:
    """Return the diagnostics of the assembly and of all checks: mistakes and warnings."""
    return [*structure.remarks, *(diagnostic for check in CHECKS for diagnostic in check(structure))]
