"""One call of a sweep: the selection of runs, their execution, and the final table."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from pound_solve.driver.overrides import overridden
from pound_solve.driver.reading import read as read_deck
from pound_solve.report.sweep import summary
from pound_solve.results.sweep_file import DONE, ENDS, FAILED, Sweep
from pound_solve.sweep import plan, table
from pound_solve.sweep.execution.conduct import Conductor, State
from pound_solve.sweep.execution.executors import Engine, engine
from pound_solve.sweep.execution.journal import Journal, JournalEntry
from pound_solve.sweep.execution.lock import locked
from pound_solve.sweep.execution.work import Analysis, Settings, analysed, options_of_auto
from pound_solve.sweep.plan import TrialRuns
from pound_solve.sweep.study.document import Document
from pound_solve.sweep.study.run import StudyRun
from pound_solve.sweep.study.study import Study, read, request_of


class Session:
    """One call of a sweep.

    Parameters
    ----------
    study : Study
    engine : Engine
    piece : tuple of int
        Number of the piece to run, from 1, and number of pieces.
    retry : bool
        Try runs again that stopped or failed.
    """

    def __init__(
        self, study: Study, engine: Engine, piece: tuple[int, int] = (1, 1), retry: bool = False
    ) -> None:
        self.study, self.engine, self.retry = study, engine, retry
        self.journal = Journal(study.out / "runs")
        self.entries = self.journal.entries()
        self.runs = plan.piece(study.runs, *piece)
        self.agenda = plan.Agenda.of(self.runs, self.entries, retry)
        self._before = set(self.entries) - {r.identity for r in self.agenda.ahead}

    def plan(self) -> Iterator[str]:
        """Lines of text of the plan."""
        return plan.lines(self.study, self.agenda, self.entries)

    def trial(self, report: Callable[[State], None]) -> TrialRuns:
        """Execute some runs, to estimate the time and the space of the others.

        These are the strongest shaking of the middle case, since collisions and yielding take time, and the
        first and the last run if all cost little.  If the others would take long, the strongest run is
        repeated with looser tolerances until one is fast enough.
        """
        ahead = self.agenda.ahead
        some = list(dict.fromkeys([_strongest(ahead), ahead[0], ahead[-1]])) if ahead else []
        trial = TrialRuns(len(ahead), self.engine.workers)
        with self.conductor(report) as conductor:
            for entry in self._one_by_one(conductor, some):
                trial.entries.append(entry)
                if trial.spent > plan.LITTLE:
                    break
            if trial.seconds > plan.LONG:
                looser = list(self._looser(some[0]))
                for run, entry in zip(looser, self._one_by_one(conductor, looser)):
                    trial.looser[run.case.tol or 0.0] = entry
                    if trial.seconds_with(entry) <= plan.LONG:
                        break
        return trial

    def _one_by_one(self, conductor: Conductor, runs: Sequence[StudyRun]) -> Iterator[JournalEntry]:
        """Execute runs lazily, one per yielded entry; end at an interruption."""
        for run in runs:
            interrupted = conductor.run([run]).ending
            self.entries = self.journal.entries()
            if run.identity in self.entries:
                yield self.entries[run.identity]
            if interrupted:
                return

    def _looser(self, run: StudyRun) -> Iterator[StudyRun]:
        """Yield the run with larger tolerances of AUTO, if AUTO ran it with an error estimate."""
        ((_, values),) = self.journal.values({run.identity: self.entries[run.identity]})
        request = request_of(run.case)
        model = read_deck(request).model
        if "error_estimate" in values and model is not None:
            options = options_of_auto(overridden(model, request, []))
            for tol in plan.LOOSER:
                if options and tol > options["TOL"]:
                    yield replace(run, case=replace(run.case, tol=tol))

    def conductor(self, report: Callable[[State], None]) -> Conductor:
        """Make the conductor that executes runs of the study, a context manager."""
        study = self.study
        folder = self.journal.folder if self.engine.notes else None
        settings = Settings(folder, study.seconds, study.memory, study.histories)
        return Conductor(self.engine, settings, self.journal, report)

    def carry_out(self, runs: Sequence[StudyRun], report: Callable[[State], None]) -> list[JournalEntry]:
        """Execute runs; return the journal's entries of those that have ended."""
        with self.conductor(report) as conductor:
            return self.carry_on(conductor, runs)

    def carry_on(
        self, conductor: Conductor, runs: Sequence[StudyRun], analysis: Analysis = analysed
    ) -> list[JournalEntry]:
        """Execute runs by a conductor that may have executed others before; see `carry_out`."""
        if runs:
            conductor.run(runs, analysis)
            self.entries = self.journal.entries()
        return [self.entries[r.identity] for r in runs if r.identity in self.entries]

    def estimate(self, trial: TrialRuns) -> Iterator[str]:
        """Lines of text: time and space of the remaining runs, estimated from a trial."""
        if trial.entries:
            size = sum(p.stat().st_size for p in self.journal.folder.iterdir()) / len(self.entries)
            yield from plan.estimate(trial, size)

    def extend(self, runs: Sequence[StudyRun]) -> None:
        """Replace the runs of the study by `runs`."""
        self.study = replace(self.study, runs=tuple(runs))
        self.runs = self.study.runs

    def write(
        self, title: str = "sweep", made: Callable[[Sweep], Iterable[str]] = lambda sweep: ()
    ) -> Path:
        """Write the table of the study and the report; raises as `sweep_file.write`.

        Parameters
        ----------
        title : str
            Of the report.
        made : callable
            Lines of the report on the evaluation of the runs.
        """
        path = table.write(self.study, self.journal, self.entries)
        sweep = Sweep.open(path)
        summary.write(path, sweep, title, made(sweep))
        return path

    @property
    def ends(self) -> list[str]:
        """Status of every run: one of `ENDS`, empty for a run that has not ended."""
        return [self.entries[r.identity].status if r.identity in self.entries else "" for r in self.runs]

    @property
    def whole(self) -> bool:
        """Whether every run has ended, and none failed."""
        return not set(self.ends) & {"", FAILED}

    def summary(self) -> Iterator[str]:
        """Lines of text: how many runs are done, stopped, failed or not run, and why some are not done."""
        ends = self.ends
        counts = [f"{ends.count(end)} {end}" for end in ENDS if end in ends]
        if "" in ends:
            counts.append(f"{ends.count('')} not run")
        before = sum(r.identity in self._before for r in self.runs)
        yield f"{len(ends)} runs: {', '.join(counts)}" + (f"; {before} of them before" if before else "")
        others = [r for r, end in zip(self.runs, ends) if end not in (DONE, "")]
        yield from plan.reasons(others, self.entries)


def _strongest(runs: Sequence[StudyRun]) -> StudyRun:
    """Run of the highest level among those that share the case of the middle run."""
    middle = runs[len(runs) // 2].case
    return max((r for r in runs if r.case == middle), key=lambda r: r.shaking.level if r.shaking else 0.0)


def run_study(path: str | Path, *, workers: int = 0, executor: str = "", retry: bool = False) -> Sweep:
    """Execute the remaining runs of a study, write its table and return it.

    Parameters
    ----------
    path : str or Path
        The study's file.
    workers : int
        Number of processes; 0 for that of the study, else one per processor.
    executor : str
        As ``--executor``, see `executors.engine`.
    retry : bool
        Try runs again that stopped or failed.

    Raises
    ------
    StudyError
        The study has mistakes; the text names the place of each.
    FolderBusyError, ExecutorError, ResultsError, OSError
        Another sweep writes the folder; the executor is not available; a file cannot be read or written.
    """
    document = Document.read(str(path))
    if workers:
        document.set_item(("workers",), workers, "workers", str(workers))
    study = read(document)
    with locked(study.out):
        session = Session(study, engine(executor, study.workers), retry=retry)
        session.carry_out(session.agenda.ahead, lambda state: None)
        return Sweep.open(session.write())
