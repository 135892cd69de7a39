"""Incremental dynamic analysis as rounds of runs, each with the next level of every record.

The levels of the study are the first ones.  The next levels follow from the runs in the journal, so that an
interrupted analysis resumes.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from pound_deck.diagnostics import suggest
from pound_solve.statistics.curves import COLLAPSE, Asked, CurveError, IdaCurve, demand
from pound_solve.statistics.incremental import Rules, next_level
from pound_solve.sweep.execution.conduct import State
from pound_solve.sweep.session import Session
from pound_solve.sweep.study.document import Document
from pound_solve.sweep.study.quantities import QUANTITIES
from pound_solve.sweep.study.run import StudyRun

TABLE: Final = "ida"  #: of a study
DEMAND: Final = "storey_drift"
LIMIT: Final = 0.1  #: default limit of the default demand
ITEMS: Final = ("demand", "label", "step", "growth", "top", "runs", "close", "limit", "slope")


@dataclass(frozen=True)
class Aim:
    """Demand of an incremental analysis, and the rules that select its levels.

    Attributes
    ----------
    asked : Asked
    rules : Rules
    """

    asked: Asked
    rules: Rules


def aim(document: Document) -> Aim:
    """Read the table ``[ida]`` of a study; mistakes are added to the document."""
    document.take((TABLE,), dict, {})
    document.known((TABLE,), ITEMS)
    quantity = document.take((TABLE, "demand"), str, DEMAND)
    names = [COLLAPSE, *(q.name for q in QUANTITIES)]
    if quantity not in names:
        hint = suggest(quantity, names) or f"there are {', '.join(names)}"
        document.mistake("S602", f"there is no quantity {quantity}", (TABLE, "demand"), hint)
    label = document.take((TABLE, "label"), str, "")
    numbers = {name: document.take((TABLE, name), float, math.nan) for name in ITEMS[2:] if name != "runs"}
    runs = document.take((TABLE, "runs"), int, 12)
    for name in ("step", "top", "close", "limit"):
        if numbers[name] <= 0.0:
            document.mistake("S603", f"{name} is above zero", (TABLE, name))
    for name in ("growth", "slope"):
        if numbers[name] < 0.0:
            document.mistake("S603", f"{name} is zero or above", (TABLE, name))
    if runs < 2:
        document.mistake("S603", "runs is two or more", (TABLE, "runs"))
    if math.isnan(numbers["step"]):
        numbers["step"] = 1.0
        message = "the study needs a table [ida] with step, the first step of its levels"
        document.mistake("S604", message, (TABLE,), "[ida] step = 0.1")
    if math.isnan(numbers["limit"]) and quantity == DEMAND:
        numbers["limit"] = LIMIT
    return Aim(
        Asked(quantity, label), Rules(runs=runs, **{k: v for k, v in numbers.items() if not math.isnan(v)})
    )


class IncrementalAnalysis:
    """Incremental dynamic analysis as rounds of runs, in each the next level of every record.

    Parameters
    ----------
    session : Session
        Of the study, whose levels are the first.
    aim : Aim

    Raises
    ------
    CurveError
        The study has no [[motions]].
    """

    def __init__(self, session: Session, aim: Aim) -> None:
        if not session.study.measure:
            raise CurveError(
                "an incremental analysis needs records: give [[motions]] with scale, pga or sa"
            )
        self.session, self.aim = session, aim
        self.runs = list(session.study.runs)
        self._demands: dict[str, float] = {}  # by identity

    def carry_out(self, report: Callable[[State], None]) -> None:
        """Execute rounds until every record is done, or until an interruption."""
        ahead: Sequence[StudyRun] = self.session.agenda.ahead
        with self.session.conductor(report) as conductor:
            while True:
                done = self.session.carry_on(conductor, ahead)
                if len(done) < len(ahead):
                    break  # interrupted
                fresh = list(self._next())
                if not fresh:
                    break
                self.runs += fresh
                ahead = [r for r in fresh if r.identity not in self.session.entries]
        self._settle()

    def _groups(self) -> Iterator[list[StudyRun]]:
        """Runs of every record of every case, in the order of their levels."""

        def level(run: StudyRun) -> float:
            return run.shaking.level if run.shaking else 0.0

        groups: dict[object, list[StudyRun]] = {}
        for run in self.runs:
            groups.setdefault((run.case, run.shaking and run.shaking.record), []).append(run)
        return (sorted(group, key=level) for group in groups.values())

    def _settle(self) -> None:
        """Number the runs in the order of cases, records and levels."""
        runs = itertools.chain.from_iterable(self._groups())
        self.session.extend(tuple(replace(run, number=n) for n, run in enumerate(runs, 1)))

    def _next(self) -> Iterator[StudyRun]:
        """The next level of every record that is not done."""
        self._learn()
        for group in self._groups():
            curve = self._curve(group)
            if curve.left_out or not curve.points:
                continue  # a run failed: its demand, which determines the next level, is unknown
            level = next_level(curve.points, self.aim.rules)
            if level is not None:
                yield group[0].at(level)

    def _curve(self, runs: Sequence[StudyRun]) -> IdaCurve:
        """Curve of one record: the levels of its runs and their demands."""
        levels = [run.shaking.level if run.shaking else 0.0 for run in runs]
        return IdaCurve.of("", "", levels, [self._demands[run.identity] for run in runs])

    def _learn(self) -> None:
        """Read the demands of the runs that have ended since the last call from the journal."""
        asked, ended = self.aim.asked, self.session.entries
        fresh = {r.identity: ended[r.identity] for r in self.runs if r.identity not in self._demands}
        for identity, values in self.session.journal.values(fresh):
            entry = fresh[identity]
            by_label = values.get(asked.quantity, {})
            self._demands[identity] = demand(entry.status, entry.reached, by_label, asked)
