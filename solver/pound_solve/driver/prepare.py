"""From the deck to the assembled structure, with all mistakes that are detectable before the analyses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from pound_deck.diagnostics import Diagnostic, has_errors, render, unsuppressed
from pound_deck.model import Model
from pound_solve.analyses import static
from pound_solve.analyses.tangent_solution import InstabilityError
from pound_solve.driver import loading
from pound_solve.driver.outputs import overwritten
from pound_solve.driver.overrides import overridden, with_motion
from pound_solve.driver.preflight import causes, preflight
from pound_solve.driver.reading import ReadDeck, read
from pound_solve.driver.request import Request
from pound_solve.loading.forces.base import Force
from pound_solve.loading.motions.base import GroundMotion
from pound_solve.numerics.types import Array
from pound_solve.structure.assembly import AssemblyError, assemble
from pound_solve.structure.damping.assembly import add_damping
from pound_solve.structure.reduction import moved_supports
from pound_solve.structure.structure import Structure
from pound_solve.user_error import UserError

LATER = "Records and the structure are checked when these mistakes are gone."


class DeckError(UserError):
    """Raised if the deck has mistakes: `diagnostics` lists them, `files` holds the texts that contain them,
    and `later` states which parts were not checked because of them.
    """

    has_places = True

    def __init__(
        self, diagnostics: Sequence[Diagnostic], files: Mapping[str, str], later: str = ""
    ) -> None:
        super().__init__("\n".join(filter(None, [render(diagnostics, files), later])))
        self.diagnostics, self.files, self.later = tuple(diagnostics), dict(files), later


@dataclass(frozen=True)
class Prepared:
    """A checked deck, its motions, its time-dependent forces and its assembled structure.

    `saved` is the state from which its history continues, or empty.
    """

    model: Model
    motions: tuple[GroundMotion, ...]
    forces: tuple[Force, ...]
    structure: Structure
    warnings: tuple[Diagnostic, ...]
    files: Mapping[str, str]
    saved: Mapping[str, Array] = field(default_factory=dict)


@dataclass(frozen=True)
class Ground:
    """Ground motions of a deck, without its structure, and the diagnostics."""

    model: Model
    motions: tuple[GroundMotion, ...]
    diagnostics: tuple[Diagnostic, ...]
    files: Mapping[str, str]


def ground(request: Request, deck: ReadDeck | None = None) -> Ground:
    """Return the motions of the EQUAKE cards of a deck; a wave gives one for each place.

    Parameters
    ----------
    request : Request
    deck : ReadDeck, optional
        Replaces the one that the request names.

    Raises
    ------
    DeckError
        The deck or a record has mistakes.
    OSError
        The deck cannot be read.
    """
    deck = deck or read(request)
    model, remarks = deck.model, list(deck.diagnostics)
    motions = [] if model is None else loading.motions(model, loading.context(model, request), remarks)
    remarks = deck.moved(remarks, request.deck)
    if model is None or has_errors(remarks):
        raise DeckError(remarks, deck.files)
    return Ground(model, tuple(motions), tuple(unsuppressed(remarks, model.meant)), deck.files)


def prepare(request: Request, at_rest: bool = False) -> Prepared:
    """Read a deck and its records, and assemble the structure; `at_rest` leaves out motions and histories,
    so that no record is needed.

    Raises
    ------
    DeckError
        The deck, a record or the structure has mistakes; the error contains all that are detectable.
    OSError
        The deck cannot be read.
    """
    deck = read(request)
    model = without_motions(deck.model) if deck.model and at_rest else deck.model
    try:
        ready = assembled(request, model, deck.diagnostics, deck.files)
    except DeckError as err:
        raise DeckError(deck.moved(err.diagnostics, request.deck), deck.files, err.later) from None
    return replace(ready, warnings=tuple(deck.moved(ready.warnings, request.deck)))


def without_motions(model: Model) -> Model:
    """Return the model without its motions, its time-dependent forces, its histories, and the performance
    points of its pushovers, which need a motion.
    """
    analyses = tuple(
        replace(card, values={**card.values, "TC": None}) if card.spec.name == "PUSHOVER" else card
        for card in model.analyses
        if card.spec.name != "HISTORY"
    )
    return replace(model, equake=(), forces=(), analyses=analyses)


def assembled(
    request: Request, model: Model | None, diagnostics: Sequence[Diagnostic], files: Mapping[str, str]
) -> Prepared:
    """Read the records of a deck and assemble the structure; see `prepare`."""
    if model is None or has_errors(diagnostics):
        raise DeckError(diagnostics, files, LATER)
    remarks = list(diagnostics)
    model = overridden(model, request, remarks)
    context = loading.context(model, request)
    motions = loading.motions(model, context, remarks)
    forces = loading.forces(model, context, remarks)
    structure = None
    try:
        structure = _assembled(model, motions)
        remarks += preflight(structure)
    except AssemblyError as err:
        remarks += [*err.diagnostics, *_causes(model)]
    remarks += overwritten(model, request, context)
    saved = loading.saved_state(model, request, motions, forces, remarks)
    remarks = unsuppressed(remarks, model.meant)
    if has_errors(remarks) or structure is None:
        raise DeckError(remarks, files)
    return Prepared(model, tuple(motions), tuple(forces), structure, tuple(remarks), files, saved)


def shaken(ready: Prepared, request: Request) -> Prepared:
    """Return the prepared deck with the motion of another request and an unchanged structure.

    Parameters
    ----------
    ready : Prepared
        Prepared from a request that differs only in its motion.
    request : Request
        With a motion.

    Raises
    ------
    DeckError
        The record has mistakes.
    """
    assert request.motion is not None
    remarks: list[Diagnostic] = []
    model = with_motion(ready.model, request.motion, remarks)
    motions = loading.motions(model, loading.context(model, request), remarks)
    if has_errors(remarks):
        raise DeckError(remarks, ready.files)
    return replace(
        ready, model=model, motions=tuple(motions), warnings=tuple(unsuppressed(remarks, model.meant))
    )


def _assembled(model: Model, motions: Sequence[GroundMotion]) -> Structure:
    """Assemble the structure with the loads that STATIC requests, and its damping."""
    fixed = [(n.id, d) for n in model.nodes.values() for d in range(3) if "XYR"[d] in n.fixed]
    statics = [c for c in model.analyses if c.spec.name == "STATIC"]
    if any(c["GRAVITY"] == "YES" for c in statics):
        model = _weighed(model)
    self_weight = all(c["SELF_WEIGHT"] == "YES" for c in statics)
    structure = assemble(model, moved_supports(motions, fixed), self_weight)
    if any(card.values.get("AFTER") == "STATIC" for card in model.damping):
        _damp_loaded(structure)
    return structure


def _causes(model: Model) -> list[Diagnostic]:
    """Further diagnostics, such as missing supports or masses, of a structure whose damping or contacts
    could not be built.
    """
    apart = {k: e for k, e in model.elements.items() if model.props[e.prop].spec.name != "CONTACT"}
    try:
        return causes(assemble(replace(model, elements=apart, damping=())))
    except AssemblyError:
        return []


def _damp_loaded(structure: Structure) -> None:
    """Add the damping that is computed from modes in the static state.

    Raises
    ------
    AssemblyError
        A card is at fault.
    """
    try:
        state = static.solve(structure)
        loaded = static.after(structure.stressed(state.axial).displaced(state.u), state)
    except (InstabilityError, np.linalg.LinAlgError, ArithmeticError):
        return  # the analysis reports it
    remarks = add_damping(structure, loaded)
    structure.remarks += remarks
    if has_errors(remarks):
        raise AssemblyError(remarks)


def _weighed(model: Model) -> Model:
    """Return the model with its nodal weights as additional loads (STATIC GRAVITY=YES)."""
    extra = []
    for card in model.weights:
        wy = card["WX"] if card["WY"] is None else card["WY"]
        load = {"NODES": card["NODES"], "FX": 0.0, "FY": -wy, "MZ": 0.0, "HELD": "YES"}
        extra.append(replace(card, values=load))
    return replace(model, loads=(*model.loads, *extra))
