"""Ground motions and time-dependent forces of a deck, and the state from which a history continues."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Card, Model
from pound_solve.driver.identity import MOTION, differences, identity
from pound_solve.driver.request import Request
from pound_solve.loading.forces.base import Force
from pound_solve.loading.intensity import share
from pound_solve.loading.motions.base import METRE, GroundMotion, LoadingContext
from pound_solve.loading.motions.wave import fronts
from pound_solve.loading.records.base import RecordError
from pound_solve.numerics.types import Array
from pound_solve.results import Results, ResultsError
from pound_solve.version import __version__

#: motions to be checked; pulses and sines are textbook motions, which may be truncated
EARTHQUAKES: Final = ("RECORD", "SYNTHETIC", "MATCHED")
LEAST_ACTED: Final = 0.2  #: least fraction of an earthquake's Arias intensity before the end of a history
MAX_DIFFERENCES: Final = 6  #: differences from a saved run in a message


def context(model: Model, request: Request) -> LoadingContext:
    """Make the context of motions and forces: gravity, unit of length, search path, duration."""
    folders = [Path(request.deck).parent, *request.records]
    folders += [Path(p) for p in os.environ.get("POUND_RECORDS", "").split(os.pathsep) if p]
    duration = max((c["T"] for c in model.analyses if c.spec.name == "HISTORY"), default=0.0)
    return LoadingContext(
        model.gravity, METRE.get(model.units.length.lower(), 1.0), tuple(folders), duration
    )


def motions(
    model: Model, surroundings: LoadingContext, diagnostics: list[Diagnostic]
) -> list[GroundMotion]:
    """Return the ground motions of all EQUAKE cards; a wave gives one for each place."""
    motions: list[GroundMotion] = []
    place = {node.id: node.x for node in model.nodes.values()}
    apart = [card for card in model.equake if card["SUPPORTS"] is not None]
    whole = [card for card in model.equake if card["SUPPORTS"] is None]
    if apart and whole:
        message = "some motions have SUPPORTS and this one has not: give SUPPORTS to all or to none"
        diagnostics.append(Diagnostic("R405", message, whole[0].span))
    for card in model.equake:
        motion: GroundMotion | None = _built(card, surroundings, diagnostics)
        if motion is None:
            continue
        diagnostics += [
            Diagnostic("R404", w, card.span, severity="warning") for w in motion.info.get("warnings", ())
        ]
        _tell(card, motion.info, diagnostics)
        ways = {"XYR"[d] for d in motion.directions}
        for node in motion.supports or ():
            if not ways & set(model.nodes[node].fixed):
                message = f"node {node} is not fixed along {motion.direction}: a support that moves must be"
                diagnostics.append(Diagnostic("R405", message, card.place("SUPPORTS")))
        diagnostics += _cut_short(model, card, motion)
        motions += fronts(motion, place)
    return motions


def _cut_short(model: Model, card: Card, motion: GroundMotion) -> Iterator[Diagnostic]:
    """Yield a warning if a history ends before the share `LEAST_ACTED` of the Arias intensity has acted."""
    histories = [c for c in model.analyses if c.spec.name == "HISTORY" and not c["RESTART"]]
    for history in histories if card.spec.name in EARTHQUAKES else ():
        unit, end = model.units.time, motion.acceleration.end
        acted = share(motion.acceleration, history["T"])
        if acted < LEAST_ACTED:
            message = (
                f"the history ends at {history['T']:g} {unit}, when {100.0 * acted:.0f} % of the Arias "
                f"intensity of the motion has acted, which lasts {end:.4g} {unit}"
            )
            hint = "give HISTORY a later end, or the motion a DURATION"
            yield Diagnostic("R412", message, history.span, hint, "warning")


def forces(model: Model, surroundings: LoadingContext, diagnostics: list[Diagnostic]) -> list[Force]:
    """Return the time-dependent forces of all FORCES cards."""
    forces: list[Force] = []
    for card in model.forces:
        force: Force | None = _built(card, surroundings, diagnostics)
        if force is not None:
            _tell(card, force.info, diagnostics)
            forces.append(force)
    return forces


def _tell(card: Card, info: Mapping[str, Any], diagnostics: list[Diagnostic]) -> None:
    """Add a warning if a card truncates its motion, and if its record contradicts its header."""
    notes = info.get("notes", ())
    cuts = info.get("cuts", ())
    diagnostics += [
        Diagnostic("R412", what, card.place(item), remedy, "warning") for what, item, remedy in cuts
    ]
    diagnostics += [Diagnostic("R409", n, card.place("FILE"), severity="warning") for n in notes]


def _built(card: Card, surroundings: LoadingContext, diagnostics: list[Diagnostic]) -> Any:
    """Return the motion or force of a card of EQUAKE or FORCES; None, with a diagnostic, if it has a
    mistake.
    """
    try:
        return card.spec.impl(card.values, surroundings)
    except RecordError as err:
        diagnostics.append(Diagnostic(err.code, err.message, card.place(err.item), hint=err.hint))
        return None


def saved_state(
    model: Model,
    request: Request,
    motions: Sequence[GroundMotion],
    forces: Sequence[Force],
    diagnostics: list[Diagnostic],
) -> dict[str, Array]:
    """Return the state in a results file from which a history with RESTART continues; empty without
    RESTART.

    Parameters
    ----------
    motions, forces : sequence
        Those of this deck.
    diagnostics : list of Diagnostic
        Receives the reasons why the state cannot be used.
    """
    for card in model.analyses:
        if card.spec.name == "HISTORY" and card["RESTART"]:
            signature = identity(model, motions, forces)
            return _taken_up(card, Path(request.deck).parent / card["RESTART"], signature, diagnostics)
        if card.spec.name == "HISTORY" and card["NEW"] != "NOTHING":
            diagnostics.append(Diagnostic("R406", "NEW stands beside RESTART only", card.place("NEW")))
    return {}


def _taken_up(
    card: Card, path: Path, signature: Mapping[str, str], diagnostics: list[Diagnostic]
) -> dict[str, Array]:
    """Return the state of a results file, set to time zero for NEW=MOTION; add diagnostics if it does not
    fit.
    """
    place, message, hint = card.place("RESTART"), "", ""
    try:
        with Results.open(path) as results:
            state, saved, version = results.restart(), results.identity(), results.program_version
    except ResultsError as err:
        diagnostics.append(Diagnostic("R406", str(err), place))
        return {}
    if not state:
        message = f"{path} holds no state to go on from"
    elif version.split(".")[:2] != __version__.split(".")[:2]:  # the variables of laws may differ
        message = f"{path} was written by version {version}, this is {__version__}: run its deck again"
    if message:
        diagnostics.append(Diagnostic("R406", message, place))
        return {}
    differ = dict(differences(signature, saved))
    if card["NEW"] == "MOTION":
        state["time"] = np.zeros(1)
        differ = {name: what for name, what in differ.items() if not name.startswith(MOTION)}
    elif differ and all(name.startswith(MOTION) for name in differ):
        hint = "write NEW=MOTION beside RESTART if another earthquake follows the first"
    for name, what in list(differ.items())[:MAX_DIFFERENCES]:
        diagnostics.append(Diagnostic("R408", f"{name} is not that of {path}: {what}", place, hint))
    if len(differ) > MAX_DIFFERENCES:
        diagnostics.append(
            Diagnostic("R408", f"and {len(differ) - MAX_DIFFERENCES} other parts", place, hint)
        )
    return state
