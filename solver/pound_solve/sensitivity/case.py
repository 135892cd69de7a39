"""A deck up to the start of its history: what EXACT would integrate."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

from pound_deck.model import Card
from pound_solve.analyses.recorder import HistoryRecorder, RecordedItems
from pound_solve.driver.prepare import Prepared, prepare
from pound_solve.driver.request import Request
from pound_solve.driver.sequence import AnalysisSequence, Progress
from pound_solve.integrate.protocol import Outcome, Problem, Stop
from pound_solve.results.record import RunRecord
from pound_solve.sensitivity.refusal import NoDerivativeError
from pound_solve.structure.structure import Structure
from pound_solve.sweep.execution.work import Kept, output_of
from pound_solve.sweep.study.quantities import Fields

Method = Callable[[Problem[HistoryRecorder]], Outcome]
KEPT_ANALYSES = ("STATIC", "MODAL", "HISTORY")  #: what a run for derivatives executes


class Case(NamedTuple):
    """A history before its integration.

    Attributes
    ----------
    problem : Problem
    items : RecordedItems
    periods : list of float
        Of MODAL [T].
    """

    problem: Problem[HistoryRecorder]
    items: RecordedItems
    periods: list[float]


def ready_for(request: Request) -> Prepared:
    """Return the prepared deck of a request, if its history has exact derivatives.

    Raises
    ------
    NoDerivativeError
        It has none; the message says why.
    DeckError, OSError
        See `driver.prepare`.
    """
    ready = prepare(request)
    cards = [card for card in ready.model.analyses if card.spec.name == "HISTORY"]
    if not cards:
        raise NoDerivativeError("derivatives follow a HISTORY, and the deck has none")
    refuse(cards[0], ready.structure)
    analyses = tuple(card for card in ready.model.analyses if card.spec.name in KEPT_ANALYSES)
    output = output_of(ready.model, ready.structure, ())
    model = replace(ready.model, output=output, analyses=analyses)
    return replace(ready, model=model, structure=replace(ready.structure, model=model))


def refuse(card: Card, structure: Structure) -> None:
    """Raise NoDerivativeError if a history has no exact derivatives here."""
    method = card.laws["METHOD"][0].name
    if method not in ("EXACT", "AUTO"):
        raise NoDerivativeError(f"derivatives follow METHOD=EXACT or AUTO, and the deck asks for {method}")
    if card["RESTART"]:
        raise NoDerivativeError(
            "a history with RESTART begins with a state whose derivatives are not saved"
        )
    if structure.corotational:
        geometry = structure.model.geometry
        raise NoDerivativeError(
            f"EXACT needs members of constant stiffness, and GEOMETRY {geometry} changes it as they move"
        )
    for spring in structure.laws:
        if spring.law.curved:
            raise NoDerivativeError(
                f"EXACT needs straight branches, and {spring.rule} of element {spring.element} is curved"
            )
        if spring.law.rigid:
            raise NoDerivativeError(
                f"the impacts of a rigid contact, which {spring.rule} of element {spring.element} is, have "
                "no derivative here: give it a LAW with a stiffness"
            )


def run(
    ready: Prepared, request: Request, method: Method, progress: Progress | None = None
) -> tuple[RunRecord, dict[str, list[Fields]], str]:
    """Run the analyses of a prepared deck, its history by `method`; return the record, the rows of tables
    from which quantities are taken, and the reason of a stop, if any.
    """

    def with_method(card: Card) -> Card:
        if card.spec.name != "HISTORY":
            return card
        spec = replace(card.laws["METHOD"][0], impl=lambda problem, options: method(problem))
        return replace(card, laws={**card.laws, "METHOD": (spec,)}, values={**card.values, "SAVE": None})

    model = replace(ready.model, analyses=tuple(map(with_method, ready.model.analyses)))
    kept = Kept()
    sequence = AnalysisSequence(replace(ready, model=model), request, kept, progress, time.perf_counter())
    message = sequence.run()
    return sequence.record, kept.rows, message


def case_of(request: Request) -> Case:
    """Return the history of a request before its integration.

    Raises
    ------
    NoDerivativeError
        It is not reached.
    """
    problems: list[Problem[HistoryRecorder]] = []

    def stop(problem: Problem[HistoryRecorder]) -> Outcome:
        problems.append(problem)
        raise Stop("A506", problem.begin, "the start is all that is needed")

    record, _, message = run(ready_for(request), request, stop)
    if not problems:
        raise NoDerivativeError(message)
    return Case(problems[0], problems[0].recorder.items, periods_of(record))


def periods_of(record: Any) -> list[float]:
    """Return the periods of MODAL; none without it [T]."""
    modal = getattr(record, "modal", None)
    return [] if modal is None else [mode.period for mode in modal.modes]
