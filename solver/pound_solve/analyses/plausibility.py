"""Values that no engineer would believe, or that end what the model means: one function for each.

They are no errors of the computation, which may be exact: units, strengths and the model are in doubt.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Final

from pound_solve.analyses.history import HistoryResult, drift_heights
from pound_solve.integrate.protocol import Outcome
from pound_solve.structure.structure import Structure

Check = tuple[str, str, str]

LARGEST_DRIFT: Final = 0.1  #: drift over height; frames have lost their vertical loads before
LARGEST_OVERLAP: Final = 0.02  #: of the shortest member that meets a contact


def drifts(structure: Structure, history: HistoryResult, outcome: Outcome) -> Iterator[Check]:
    """Drifts beyond a tenth of their height."""
    names = history.items.drifts.names
    for name, e, height in zip(names, outcome.peaks.monitored, drift_heights(structure.model)):
        ratio = max(abs(e.high), abs(e.low)) / height
        if ratio > LARGEST_DRIFT:
            verdict = "look: above 10 %; check units, masses and strengths"
            yield f"drift ratio of {name}", f"{100 * ratio:.3g} %", verdict


def failures(structure: Structure, history: HistoryResult, outcome: Outcome) -> Iterator[Check]:
    """Components at the end of their damage index or of their ultimate deformation."""
    failed = [r.damage.total for r in history.springs if r.damage is not None and r.damage.total >= 1.0]
    if failed:
        text = "look: 1 is failure; the model goes on as if they held"
        yield f"damage index of {len(failed)} springs and hinges", f"{max(failed):.3g}", text


def overlaps(structure: Structure, history: HistoryResult, outcome: Outcome) -> Iterator[Check]:
    """Contacts pressed together by more than an elastic contact means."""
    model = structure.model
    for i in history.items.contacts:
        law = structure.laws[i]
        overlap = max(outcome.peaks.deformation[i].high - law.facts["gap"], 0.0)
        ends = {model.elements[law.element].i, model.elements[law.element].j} - {None}
        lengths = [
            (
                (model.nodes[e.i].x - model.nodes[e.j].x) ** 2
                + (model.nodes[e.i].y - model.nodes[e.j].y) ** 2
            )
            ** 0.5
            for e in model.elements.values()
            if e.j is not None and e.id != law.element and {e.i, e.j} & ends
        ]
        shortest = min((x for x in lengths if x > 0.0), default=0.0)
        if shortest and overlap > LARGEST_OVERLAP * shortest:
            name = model.elements[law.element].name or str(law.element)
            share = f"{100 * overlap / shortest:.3g} % of the shortest member there"
            yield f"overlap of contact {name}", share, "look: above 2 %; check the stiffness of the contact"


RULES: Final[Sequence[Callable[[Structure, HistoryResult, Outcome], Iterator[Check]]]] = (
    drifts,
    failures,
    overlaps,
)


def of_history(structure: Structure, history: HistoryResult) -> list[Check]:
    """All that is to be looked at in a history."""
    return [check for rule in RULES for check in rule(structure, history, history.returned)]
