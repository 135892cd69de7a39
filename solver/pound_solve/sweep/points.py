"""Runs of a study at points of its variables: each point is run under all records of the study.

The verbs that choose their points themselves (`sensitivity`, ...) are deterministic: a later point follows
from the results of earlier ones.  A repeated call therefore asks for the same points, finds their runs in
the journal, and continues where an interrupted call stopped.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TypeAlias

from pound_solve.results.sweep_file import DONE
from pound_solve.sweep.execution.conduct import Conductor, State
from pound_solve.sweep.execution.journal import JournalEntry
from pound_solve.sweep.execution.work import Analysis, analysed
from pound_solve.sweep.session import Session
from pound_solve.sweep.study.quantities import Values
from pound_solve.sweep.study.run import StudyRun
from pound_solve.sweep.study.variables import MOTION

Point: TypeAlias = tuple[float, ...]  #: values of the variables, in the order of the study


class Interrupted(Exception):
    """Raised if the runs of a point have not all ended, after Ctrl-C."""


@dataclass(frozen=True)
class PointResult:
    """Results of the runs at one point, one of each record in the order of the study.

    Attributes
    ----------
    runs : tuple of StudyRun
    entries : tuple of JournalEntry
        How each run ended.
    values : tuple of mapping
        Quantities of each run, see `quantities`; empty for a run that failed.
    """

    runs: tuple[StudyRun, ...]
    entries: tuple[JournalEntry, ...]
    values: tuple[Values, ...]

    @property
    def done(self) -> bool:
        """Whether all runs are done."""
        return all(entry.status == DONE for entry in self.entries)


class Points:
    """Runs of a study at points of its variables.

    Parameters
    ----------
    session : Session
        Of the study, whose runs are those at the values of its variables.
    """

    def __init__(self, session: Session) -> None:
        self.session, self.variables = session, session.study.variables
        self._base = session.study.runs
        self._asked: dict[str, StudyRun] = {
            r.identity: r for r in self._base
        }  # in the order of their points
        self._results: dict[str, tuple[JournalEntry, Values]] = {}
        self._stored: dict[str, Values] | None = None  # values in the journal before the first run
        self._tried = set[str]()  # runs without all results, which are repeated once at most
        self._conductor: Conductor | None = None

    @contextmanager
    def conducted(self, report: Callable[[State], None]) -> Iterator[None]:
        """Context in which `results` executes runs; when it ends, the study has all runs asked for."""
        try:
            with self.session.conductor(report) as self._conductor:
                yield
        finally:
            self._conductor = None
            self.session.extend(tuple(replace(r, number=n) for n, r in enumerate(self._asked.values(), 1)))

    @property
    def nominal(self) -> Point:
        """The point of the study: the values of its variables."""
        return tuple(v.value for v in self.variables)

    def runs(self, point: Sequence[float]) -> tuple[StudyRun, ...]:
        """Runs at a point, one for each record."""
        values = {v.name: float(x) for v, x in zip(self.variables, point, strict=True)}
        return tuple(_moved(run, values) for run in self._base)

    def results(self, points: Iterable[Sequence[float]]) -> list[PointResult]:
        """Results at some points, in their order; those that the journal has not are executed.

        Raises
        ------
        Interrupted
            Ctrl-C has ended the execution before all had ended.
        """
        at = [self.runs(point) for point in points]
        for run in (run for runs in at for run in runs):
            self._asked.setdefault(run.identity, run)
        self._execute([run for runs in at for run in runs])
        return [self._result(runs) for runs in at]

    def derived(self, point: Sequence[float], analysis: Analysis) -> PointResult:
        """Results of another analysis of the runs at a point, which takes derivatives by the variables; see
        `results`.  They are not runs of the study.
        """
        names = tuple(v.name for v in self.variables)
        runs = tuple(replace(run, variables=names) for run in self.runs(point))
        self._execute(runs, analysis)
        return self._result(runs)

    def _result(self, runs: tuple[StudyRun, ...]) -> PointResult:
        """Results of the runs at a point, which have ended."""
        entries, values = zip(*(self._results[run.identity] for run in runs))
        return PointResult(runs, entries, values)

    def _execute(self, runs: Sequence[StudyRun], analysis: Analysis = analysed) -> None:
        """Execute the runs that the journal has not, and read the results of all."""
        assert self._conductor is not None, "runs are executed within the context `conducted`"
        session = self.session
        missing = {r.identity: r for r in runs if r.identity not in self._results}
        ahead = [r for r in missing.values() if self._is_ahead(r)]
        self._tried |= {r.identity for r in ahead}
        if self._stored is None:
            self._stored = dict(session.journal.values(session.entries))
        before = {i: self._stored[i] for i in missing if i in self._stored}
        session.carry_on(self._conductor, ahead, analysis)
        ended = {r.identity: session.entries[r.identity] for r in ahead if r.identity in session.entries}
        now = dict(session.journal.values(ended)) if ended else {}
        for identity, values in (before | now).items():
            self._results[identity] = session.entries[identity], values
        if any(r.identity not in self._results for r in missing.values()):
            raise Interrupted

    def _is_ahead(self, run: StudyRun) -> bool:
        """Whether a run is to be executed: it has not ended, or is to be tried again."""
        entry = self.session.entries.get(run.identity)
        if entry is None:
            return True
        return self.session.retry and entry.status != DONE and run.identity not in self._tried


def _moved(run: StudyRun, values: Mapping[str, float]) -> StudyRun:
    """A run with other values of the variables."""
    case = run.case
    params = tuple((name, repr(values[name])) for name, _ in case.params)
    shaking = run.shaking
    if shaking is not None and MOTION in values and MOTION not in dict(case.params):
        shaking = replace(
            shaking, scale=shaking.scale * values[MOTION], level=shaking.level * values[MOTION]
        )
    return replace(run, case=replace(case, params=params), shaking=shaking)
