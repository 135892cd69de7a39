"""Execution of a study: submits runs, collects results, and survives the death of processes."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from dataclasses import dataclass, field
from functools import partial
from typing import Final, Self

from pound_solve.results.sweep_file import FAILED
from pound_solve.sweep.execution.executors import Engine
from pound_solve.sweep.execution.journal import Journal, JournalEntry
from pound_solve.sweep.execution.work import Analysis, Settings, analysed, carry_out
from pound_solve.sweep.study.run import ParameterCase, StudyRun

INTERVAL: Final = 0.1  #: between two looks at the time [s]
DEATHS: Final = 2  #: process deaths after which a run executed alone counts as failed
DIED: Final = "its process died: the system or the limit of time ended it, perhaps it took too much memory"


@dataclass
class State:
    """Progress of a sweep.

    Attributes
    ----------
    total, done, failed : int
        Numbers of runs to execute, ended and failed.
    began : float
        Reading of `time.monotonic`.
    ending : bool
        Whether the user has interrupted the sweep, so that only runs in progress are completed.
    """

    total: int
    done: int = 0
    failed: int = 0
    began: float = field(default_factory=time.monotonic)
    ending: bool = False

    @property
    def text(self) -> str:
        """Progress as one line of text."""
        passed = time.monotonic() - self.began
        rate = self.done / passed if passed > 0.0 else 0.0
        failed = f"   {self.failed} failed" if self.failed else ""
        if self.ending:
            return f"{self.done} of {self.total} runs{failed}   waits for runs that have begun"
        ahead = (
            f"   {rate:.3g} a second   {(self.total - self.done) / rate:.0f} s to go" if self.done else ""
        )
        return f"{self.done} of {self.total} runs{failed}{ahead}"


@dataclass
class Lane:
    """One executor and the runs submitted to it.

    Attributes
    ----------
    executor : Executor
    flying : dict of Future to StudyRun
    case : ParameterCase or None
        Case of its latest run, whose structure its process keeps.
    """

    executor: Executor
    flying: dict[Future[JournalEntry], StudyRun] = field(default_factory=dict)
    case: ParameterCase | None = None


class Conductor:
    """Executes runs; a context manager that ends its processes on exit.

    The first run is executed alone, because it compiles what the others load.  A process executes the runs
    of one case in sequence, so that it prepares few structures.  Runs whose processes die are repeated one
    by one, to identify the cause.

    Parameters
    ----------
    engine : Engine
    settings : Settings
    journal : Journal
    report : callable
        Called with the `State` at intervals; it may raise `KeyboardInterrupt`.
    """

    def __init__(
        self, engine: Engine, settings: Settings, journal: Journal, report: Callable[[State], None]
    ) -> None:
        self.engine, self.settings, self.journal, self.report = engine, settings, journal, report
        self._waiting: dict[ParameterCase, deque[StudyRun]] = {}
        self._lanes = list[Lane]()
        self._suspects = deque[StudyRun]()
        self._deaths = dict[str, int]()
        self._begun = False  # whether a run has ended, and kernels are compiled
        self._since = time.time()
        self._work = partial(carry_out, analysis=analysed)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        for lane in self._lanes:
            lane.executor.shutdown(wait=not lane.flying, cancel_futures=True)
        self._lanes.clear()

    def run(self, runs: Iterable[StudyRun], analysis: Analysis = analysed) -> State:
        """Execute runs; after an interruption, complete those in progress.

        Parameters
        ----------
        runs : iterable of StudyRun
        analysis : callable
            What is done with each, see `carry_out`.

        Raises
        ------
        OSError
            The journal cannot be written.
        """
        self._work = partial(carry_out, analysis=analysis)
        state = State(0)
        for run in runs:
            self._waiting.setdefault(run.case, deque()).append(run)
            state.total += 1
        while self._waiting or self._suspects or self._flying:
            try:
                self._round(state)
            except KeyboardInterrupt:
                state.ending = True
                self._waiting.clear()
                self._suspects.clear()
                for future in self._flying:
                    future.cancel()
        return state

    @property
    def _flying(self) -> dict[Future[JournalEntry], Lane]:
        """Submitted runs without a result yet: the lane of each future."""
        return {future: lane for lane in self._lanes for future in lane.flying}

    def _round(self, state: State) -> None:
        """Submit runs, wait for some, collect their results, and replace broken executors."""
        for lane in self._open():
            self._fill(lane)
        self.report(state)
        flying = self._flying
        ended, _ = wait(flying, timeout=INTERVAL, return_when=FIRST_COMPLETED)
        lone, broken = len(flying) == 1, list[Lane]()
        for future in ended:
            lane = flying[future]
            if not self._take(future, lane.flying.pop(future), lone, state) and lane not in broken:
                broken.append(lane)
        for lane in broken:
            for future in wait(lane.flying).done:  # the others of an executor that broke
                self._take(future, lane.flying.pop(future), False, state)
            self._renew(lane)

    def _open(self) -> list[Lane]:
        """Lanes that may take runs: one where the next run must go alone, else all of the engine."""
        alone = bool(self._suspects) or not self._begun
        wanted = 1 if alone else min(self.engine.lanes, max(len(self._lanes), self._ahead()))
        while len(self._lanes) < wanted:
            self._lanes.append(Lane(self.engine.start()))
        if not alone:
            return self._lanes
        return [] if self._flying else self._lanes[:1]

    def _ahead(self) -> int:
        """Number of runs not yet submitted."""
        return sum(map(len, self._waiting.values()))

    def _fill(self, lane: Lane) -> None:
        """Submit runs to a lane."""
        most = 1 if self._suspects or not self._begun else self.engine.ahead
        while len(lane.flying) < most and (self._suspects or self._waiting):
            run = self._suspects.popleft() if self._suspects else self._next(lane)
            try:
                future = lane.executor.submit(self._work, run, self.settings)
            except BrokenExecutor:
                self._suspects.appendleft(run)
                self._renew(lane)
                return
            lane.flying[future], lane.case = run, run.case

    def _renew(self, lane: Lane) -> None:
        """Replace the broken executor of a lane."""
        lane.executor.shutdown(wait=False, cancel_futures=True)
        lane.executor = self.engine.start()

    def _next(self, lane: Lane) -> StudyRun:
        """Next run of the lane's case, else of one that no other lane has, else of that with most runs."""
        held = {other.case for other in self._lanes if other is not lane}
        case = lane.case
        if case is None or case not in self._waiting:
            free = (c for c in self._waiting if c not in held)
            case = next(free, None) or max(self._waiting, key=lambda c: len(self._waiting[c]))
        runs = self._waiting[case]
        run = runs.popleft()
        if not runs:
            del self._waiting[case]
        return run

    def _take(self, future: Future[JournalEntry], run: StudyRun, lone: bool, state: State) -> bool:
        """Collect the result of a run; return False if its process died."""
        try:
            entry = future.result()
        except CancelledError:  # by an interruption, or by a scheduler that has gone
            if not state.ending:
                self._waiting.setdefault(run.case, deque()).appendleft(run)
            return state.ending
        except BrokenExecutor:
            noted = self.journal.entries().get(run.identity) if self.engine.notes else None
            if noted is not None and noted.at >= self._since:  # its process died when it had ended
                self._count(noted, state)
                return False
            deaths = self._deaths.get(run.identity, 0) + lone
            self._deaths[run.identity] = deaths
            if state.ending:
                return False
            if deaths < DEATHS:
                self._suspects.append(run)
            else:
                self._note(JournalEntry(run.identity, FAILED, DIED), state)
            return False
        except OSError:  # the journal of the process cannot be written
            raise
        except Exception as err:  # what the executor says of a worker that died
            self._note(JournalEntry(run.identity, FAILED, f"{type(err).__name__}: {err}"), state)
            return True
        if not self.engine.notes:
            self.journal.add(entry)
        self._count(entry, state)
        return True

    def _note(self, entry: JournalEntry, state: State) -> None:
        """Record a failure in the journal on behalf of a process that could not."""
        self.journal.add(entry)
        self._count(entry, state)

    def _count(self, entry: JournalEntry, state: State) -> None:
        """Count a run that has ended."""
        self._begun = True
        state.done += 1
        state.failed += entry.status == FAILED
