"""Plan of a sweep: number of runs, skipped runs, and estimate of time and space."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from pound_solve.results.sweep_file import DONE
from pound_solve.sweep.execution.journal import JournalEntry
from pound_solve.sweep.study.run import StudyRun
from pound_solve.sweep.study.study import Study

SHOWN: Final = 20  #: most runs listed of one kind
LITTLE: Final = 5.0  #: CPU time of a trial after which no further run is tried [s]
LONG: Final = 600.0  #: estimated time of the remaining runs above which looser tolerances are tried [s]
LOOSER: Final = (1e-3, 1e-2)  #: tolerances that are tried then
_WIDEST: Final = 100  #: most characters of a reason


@dataclass(frozen=True)
class Agenda:
    """Runs of a study, or of a piece of it, sorted by what remains to be done.

    Attributes
    ----------
    ahead : tuple of StudyRun
        To be executed.
    done : tuple of StudyRun
        Completed.
    ended : tuple of StudyRun
        Stopped or failed, and not to be repeated.
    """

    ahead: tuple[StudyRun, ...]
    done: tuple[StudyRun, ...]
    ended: tuple[StudyRun, ...]

    @classmethod
    def of(cls, runs: Sequence[StudyRun], entries: Mapping[str, JournalEntry], retry: bool) -> Agenda:
        """Sort runs by their results; with `retry`, stopped and failed runs are to be executed again."""
        ends = [entries[r.identity].status if r.identity in entries else "" for r in runs]
        return cls(
            tuple(r for r, end in zip(runs, ends) if not end or (retry and end != DONE)),
            tuple(r for r, end in zip(runs, ends) if end == DONE),
            tuple(r for r, end in zip(runs, ends) if end and end != DONE and not retry),
        )


def piece(runs: Sequence[StudyRun], k: int, count: int) -> tuple[StudyRun, ...]:
    """The k-th of `count` pieces of nearly equal length, k from 1."""
    return tuple(r for r in runs if (r.number - 1) % count == k - 1)


def lines(study: Study, agenda: Agenda, entries: Mapping[str, JournalEntry]) -> Iterator[str]:
    """Lines of text of the plan."""
    decks = {r.case.deck for r in study.runs}
    cases = {r.case for r in study.runs}
    counts = _many(len(decks), "deck"), f"{_many(len(cases), 'case')} of PARAMs", _shakings(study)
    yield f"{len(study.runs)} runs: {', '.join(counts)}"
    for run in (study.runs[0], *study.runs[1:2], study.runs[-1]):
        yield f"  {run.number:6}  {run.title}"
    yield f"done before, skipped: {len(agenda.done)}"
    if agenda.ended:
        yield f"ended before without all, skipped (--retry tries them again): {len(agenda.ended)}"
        yield from reasons(agenda.ended, entries)
    yield f"to be run: {len(agenda.ahead)}"


def _many(count: int, word: str) -> str:
    return f"{count} {word}{'s' if count != 1 else ''}"


def _shakings(study: Study) -> str:
    if not study.measure:
        return "motions of the decks"
    shakings = [r.shaking for r in study.runs if r.shaking is not None]
    what = {"scale": "factor", "pga": "PGA", "sa": "Sa"}[study.measure]
    records, levels = len({s.record for s in shakings}), len({s.level for s in shakings})
    return f"{_many(records, 'record')}, {_many(levels, what)}"


def reasons(runs: Sequence[StudyRun], entries: Mapping[str, JournalEntry]) -> Iterator[str]:
    """Lines that state for the first of some runs that are not done the reason of each."""
    for run in runs[:SHOWN]:
        entry = entries[run.identity]
        reason = (entry.message.splitlines() or [""])[0].replace(f"{Path(run.case.deck).parent}/", "")
        yield f"  run {run.number} {run.title}: {entry.status}: {reason[:_WIDEST]}"
    if len(runs) > SHOWN:
        yield f"  and {len(runs) - SHOWN} more"


@dataclass
class TrialRuns:
    """Trial runs, to estimate the time and the space of the others.

    Attributes
    ----------
    ahead : int
        Number of runs to execute before the trial.
    workers : int
    entries : list of JournalEntry
        Runs with the tolerance of the study; the first was also run with others.
    looser : dict of float to JournalEntry
        Runs with tolerances above that of the study, by tolerance.
    """

    ahead: int
    workers: int
    entries: list[JournalEntry] = field(default_factory=list)
    looser: dict[float, JournalEntry] = field(default_factory=dict)

    @property
    def spent(self) -> float:
        """CPU time of the trial [s]."""
        return sum(e.cpu for e in self.entries)

    @property
    def left(self) -> int:
        """Number of remaining runs."""
        return self.ahead - len(self.entries)

    @property
    def seconds(self) -> float:
        """Estimated time of the remaining runs [s]."""
        return self.spent / max(len(self.entries), 1) * self.left / self.workers

    def seconds_with(self, looser: JournalEntry) -> float:
        """Estimated time of all runs with the looser tolerance of a trial run [s]."""
        mean = self.spent / len(self.entries) * looser.cpu / self.entries[0].cpu
        return mean * self.ahead / self.workers


def estimate(trial: TrialRuns, size: float) -> Iterator[str]:
    """Lines of text: time and disk space for the runs left; `size` is that of one run [bytes]."""
    count, left = len(trial.entries), trial.left
    beyond = 1000.0 * sum(e.cpu - e.solve for e in trial.entries) / count
    each = f"{trial.spent / count:.3g} s of CPU time each, {beyond:.0f} ms beyond the integration"
    yield f"trial: {_many(count, 'run')}, {each}"
    disk = size * left / 1e6
    yield f"the other {left}: about {_time(trial.seconds)} with {trial.workers} at a time, {disk:.2g} MB"
    for tol, entry in trial.looser.items():
        yield f"  all {trial.ahead} with --tol {tol:g}: about {_time(trial.seconds_with(entry))}"


def _time(seconds: float) -> str:
    """Time as text in seconds, minutes or hours."""
    if seconds < 120.0:
        return f"{seconds:.3g} s"
    return f"{seconds / 60.0:.3g} min" if seconds < 7200.0 else f"{seconds / 3600.0:.3g} h"
