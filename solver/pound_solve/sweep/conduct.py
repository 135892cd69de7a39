"""The conduct of a study: hands runs out, takes what they have come to, survives what dies."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from dataclasses import dataclass, field
from typing import Final

from pound_solve.sweep.entry import FAILED, Entry, Journal
from pound_solve.sweep.executors import Engine
from pound_solve.sweep.run import Run
from pound_solve.sweep.work import Settings, carry_out

INTERVAL: Final = 0.1  #: between two looks at the time [s]
DEATHS: Final = 2  #: of processes that a run may cause when it is alone
DIED: Final = "its process died: the system or the limit of time ended it, perhaps it took too much memory"


@dataclass
class State:
    """How far a sweep is.

    Attributes
    ----------
    total, done, failed : int
        Runs that are to be done; those that have ended; those of them that failed.
    began : float
        Reading of `time.monotonic`.
    ending : bool
        The user has interrupted: runs that have begun are waited for.
    """

    total: int
    done: int = 0
    failed: int = 0
    began: float = field(default_factory=time.monotonic)
    ending: bool = False

    @property
    def text(self) -> str:
        """One line."""
        passed = time.monotonic() - self.began
        rate = self.done / passed if passed > 0.0 else 0.0
        failed = f"   {self.failed} failed" if self.failed else ""
        if self.ending:
            return f"{self.done} of {self.total} runs{failed}   waits for runs that have begun"
        ahead = (
            f"   {rate:.3g} a second   {(self.total - self.done) / rate:.0f} s to go" if self.done else ""
        )
        return f"{self.done} of {self.total} runs{failed}{ahead}"


class Conductor:
    """Carries runs out.

    The first run goes alone: what it compiles, the others load.  Runs whose processes die are tried again
    one by one, so that it shows which of them is to blame.

    Parameters
    ----------
    engine : Engine
    settings : Settings
    journal : Journal
    report : callable
        Told the `State` now and then; it may raise `KeyboardInterrupt`.
    """

    def __init__(
        self, engine: Engine, settings: Settings, journal: Journal, report: Callable[[State], None]
    ) -> None:
        self.engine, self.settings, self.journal, self.report = engine, settings, journal, report
        self._waiting = deque[Run]()
        self._flying = dict[Future[Entry], Run]()
        self._suspects = deque[Run]()
        self._deaths = dict[str, int]()

    def run(self, runs: Iterable[Run]) -> State:
        """Carry runs out; after an interruption, end those that have begun.

        Raises
        ------
        OSError
            The journal cannot be written.
        """
        self._waiting.extend(runs)
        state = State(len(self._waiting))
        executor = self.engine.start()
        try:
            while self._waiting or self._suspects or self._flying:
                try:
                    executor = self._round(executor, state)
                except KeyboardInterrupt:
                    state.ending = True
                    self._waiting.clear()
                    self._suspects.clear()
                    for future in self._flying:
                        future.cancel()
        finally:
            executor.shutdown(wait=not self._flying, cancel_futures=True)
        return state

    def _round(self, executor: Executor, state: State) -> Executor:
        """Hand runs out, wait for some, take them; return the executor, or a new one for one that broke."""
        alone = bool(self._suspects) or not state.done
        most = 1 if alone else self.engine.ahead
        broken = False
        while len(self._flying) < most and (self._suspects or self._waiting):
            run = (self._suspects or self._waiting).popleft()
            try:
                self._flying[executor.submit(carry_out, run, self.settings)] = run
            except BrokenExecutor:
                self._suspects.appendleft(run)
                broken = True
                break
        self.report(state)
        ended, _ = wait(self._flying, timeout=INTERVAL, return_when=FIRST_COMPLETED)
        lone = len(self._flying) == 1
        for future in ended:
            broken |= not self._take(future, self._flying.pop(future), lone, state)
        if not broken:
            return executor
        for future in wait(self._flying).done:  # the others of an executor that broke
            self._take(future, self._flying.pop(future), False, state)
        executor.shutdown(wait=False, cancel_futures=True)
        return self.engine.start()

    def _take(self, future: Future[Entry], run: Run, lone: bool, state: State) -> bool:
        """Take what a run has come to; False where its process died."""
        try:
            entry = future.result()
        except CancelledError:  # by an interruption, or by a scheduler that has gone
            if not state.ending:
                self._waiting.appendleft(run)
            return state.ending
        except BrokenExecutor:
            deaths = self._deaths.get(run.identity, 0) + lone
            self._deaths[run.identity] = deaths
            if state.ending:
                return False
            if deaths < DEATHS:
                self._suspects.append(run)
            else:
                self._note(Entry(run.identity, FAILED, DIED), state)
            return False
        except OSError:  # the journal of the process cannot be written
            raise
        except Exception as err:  # what the executor says of a worker that died
            self._note(Entry(run.identity, FAILED, f"{type(err).__name__}: {err}"), state)
            return True
        if not self.engine.notes:
            self.journal.add(entry)
        state.done += 1
        state.failed += entry.status == FAILED
        return True

    def _note(self, entry: Entry, state: State) -> None:
        """Note a failure that no process could note."""
        self.journal.add(entry)
        state.done += 1
        state.failed += 1
