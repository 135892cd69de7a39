"""One run within a process: prepare, analyse, extract the quantities; within limits.

Runs of one case, a deck with its PARAMs, share the parsed deck, the assembled structure, the static state,
the modes and the recorded sums of forces, which the first run of a process computes.
"""

from __future__ import annotations

import gc
import threading
import time
import warnings
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from itertools import count
from pathlib import Path
from typing import Any, Final

import numpy as np

from pound_deck.model import Card, Model
from pound_solve.driver.prepare import Prepared, prepare, shaken
from pound_solve.driver.sequence import AnalysisSequence, Settled
from pound_solve.integrate.convergence.compared import ACCELERATIONS, FORCES, tolerances
from pound_solve.numerics.providers import resident
from pound_solve.numerics.types import Array
from pound_solve.results.contents import HISTORIES
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Layout, Stage
from pound_solve.results.sweep_file import DONE, FAILED, STOPPED
from pound_solve.structure.structure import Structure
from pound_solve.sweep.execution.events import events_of
from pound_solve.sweep.execution.journal import Journal, JournalEntry
from pound_solve.sweep.execution.limits import Clock, TooLongError, within
from pound_solve.sweep.study import pairs
from pound_solve.sweep.study.quantities import Fields, doubts, rows_at, taken
from pound_solve.sweep.study.records import UnreadableError, scaled
from pound_solve.sweep.study.run import ParameterCase, RecordFile, Shaking, StudyRun, digest_of
from pound_solve.sweep.study.study import request_of
from pound_solve.user_error import UserError

#: runs of a process from one collection of garbage to the next: the histories of a run lie in cycles of
#: references, and Python by itself waits for hundreds of them; one collection takes some 50 ms
COLLECT: Final = 8


@dataclass(frozen=True)
class Settings:
    """Settings that all runs of a study have in common.

    Attributes
    ----------
    journal : Path or None
        Journal to which the process writes the result; None: the calling process writes it.
    seconds, memory : float or None
        CPU time [s] and memory [MB] that a run may take.
    histories : tuple of str
        Histories that are kept.
    """

    journal: Path | None
    seconds: float | None = None
    memory: float | None = None
    histories: tuple[str, ...] = ()


Analysis = Callable[[StudyRun, Settings, Clock], JournalEntry]


class ChangedError(Exception):
    """Raised if a file has changed since the study was read."""


class Kept:
    """Output of a run (`sequence.RunOutput`) that keeps only the table rows that quantities need."""

    def __init__(self) -> None:
        self.rows = dict[str, list[Fields]]()

    def text(self, name: str, text: str) -> None:
        """Do nothing: the study holds the texts of the input."""

    def tables(self, stage: Stage, record: RunRecord) -> None:
        """Keep the table rows of a stage from which quantities are extracted."""
        self.rows |= rows_at(stage, record)

    def start_history(self, layout: Layout, packed: bool = False) -> None:
        """Do nothing: histories stay in memory, see `sequence.HistoryWriter`."""

    def append(self, block: Mapping[str, Array]) -> None:
        """Do nothing, see `start_history`."""

    def stored(self, name: str) -> Array:
        """Raise KeyError: no history is stored here."""
        raise KeyError(name)

    def closeups(self, layout: Layout, blocks: Sequence[Mapping[str, Array]]) -> None:
        """Do nothing: a sweep keeps no close-ups."""

    def extremes(
        self, layout: Layout, bounds: Array, low: Mapping[str, Array], high: Mapping[str, Array]
    ) -> None:
        """Do nothing: a sweep keeps no extremes."""

    def restart(self, state: Mapping[str, Array], identity: Mapping[str, str]) -> None:
        """Do nothing: no run is restarted from a run of a sweep."""


def analysed(run: StudyRun, settings: Settings, clock: Clock) -> JournalEntry:
    """Run the analyses of the deck, and take the quantities."""
    motion = scaled(run.shaking) if run.shaking else None
    request = request_of(run.case, motion)
    ready, settled = prepared(run.case, run.first, settings.histories)
    if run.shaking is not None:
        ready = shaken(ready, request)
        if any(m.info["sha256"] != run.shaking.record.sha256 for m in ready.motions):
            raise ChangedError(f"{run.shaking.record.name} was changed while the sweep ran")
    kept = Kept()
    sequence = AnalysisSequence(ready, request, kept, clock, time.perf_counter(), settled)
    message = sequence.run()
    record = sequence.record
    history = getattr(record, "history", None)
    started = history is not None and history.recorder.started
    events = events_of(record)
    return JournalEntry(
        run.identity,
        STOPPED if message else DONE,
        message,
        doubts(kept.rows),
        history.recorder.reached if history and started else float("nan"),
        solve=record.cpu_seconds,
        values=taken(kept.rows),
        sequence=events.sequence,
        gentlest=events.gentlest,
        exact=events.exact,
        histories=histories_of(record, settings.histories) if started else {},
    )


def carry_out(run: StudyRun, settings: Settings, analysis: Analysis = analysed) -> JournalEntry:
    """Execute a run, write its result to the journal, and return it.

    Parameters
    ----------
    run : StudyRun
    settings : Settings
    analysis : callable
        What is done with the run; it can be pickled.

    Raises
    ------
    OSError
        The journal cannot be written.
    """
    with one_at_a_time(), resident():
        entry = _carried_out(run, settings, analysis)
        if next(numbers()) % COLLECT == 0:
            gc.collect()
        return entry


@cache
def one_at_a_time() -> threading.Lock:
    """Lock of this process: a worker of Dask may have several threads, but CPU time, limits, and what runs
    share belong to the process.
    """
    return threading.Lock()


@cache
def numbers() -> count[int]:
    """Counter of the runs of this process, from 1."""
    return count(1)


def _carried_out(run: StudyRun, settings: Settings, analysis: Analysis) -> JournalEntry:
    """Execute a run within its limits; any failure becomes part of the entry, see `carry_out`."""
    began = time.process_time()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            with within(settings.seconds, settings.memory) as clock:
                entry = analysis(run, settings, clock)
        except (UserError, UnreadableError, ChangedError) as err:
            entry = JournalEntry(run.identity, FAILED, str(err))
        except TooLongError:
            entry = JournalEntry(
                run.identity, FAILED, f"it takes more than {settings.seconds:g} s of CPU time"
            )
        except MemoryError:
            most = f"{settings.memory:g} MB" if settings.memory else "the machine has"
            entry = JournalEntry(run.identity, FAILED, f"it takes more memory than {most}")
        except Exception as err:
            text = f"a fault of the program, not of the deck: {type(err).__name__}: {err}"
            entry = JournalEntry(run.identity, FAILED, text)
    if caught:
        text = f"arithmetic at the limits of floating point ({caught[0].message})"
        entry = replace(entry, doubt="; ".join(filter(None, [entry.doubt, text])))
    entry = replace(entry, cpu=time.process_time() - began)
    if settings.journal is not None:
        Journal(settings.journal).add(entry)
        entry = replace(entry, histories={})
    return entry


@lru_cache(maxsize=2)
def prepared(
    case: ParameterCase, first: RecordFile | None, histories: tuple[str, ...]
) -> tuple[Prepared, Settled]:
    """Prepare a case under the study's first record; also return the store of what its runs share."""
    motion = scaled(Shaking(first, 1.0, 1.0)) if first else None
    ready = prepare(request_of(case, motion))
    if case.texts != digest_of(ready.model.files):
        raise ChangedError(f"{case.deck} was changed while the sweep ran")
    output = output_of(ready.model, ready.structure, histories)
    whole, structure = ready.model, ready.structure
    structure = replace(structure, model=replace(structure.model, output=output))
    return replace(ready, model=replace(whole, output=output), structure=structure), Settled()


def output_of(model: Model, structure: Structure, histories: Sequence[str]) -> Card:
    """OUTPUT card of the runs of a sweep: of the nodes and members that the deck names, it keeps those that
    a quantity, a history to be kept or a tolerance of AUTO needs.
    """
    items = {**model.output.values, "HISTORIES": "NO"}
    groups, compared = {name.partition("/")[0] for name in histories}, compared_peaks(model)
    if not groups & {"node", "reaction"} and ACCELERATIONS not in compared:
        touching = pairs.nodes(structure)
        items["NODES"] = [n for n in items["NODES"] or model.nodes if n in touching]
    if "member" not in groups and FORCES not in compared:
        items["MEMBERS"] = []
    return replace(model.output, values=items)


def compared_peaks(model: Model) -> Collection[int]:
    """Peaks that AUTO compares between its runs, see `compared.tolerances`; none with another method."""
    options = options_of_auto(model)
    return tolerances(options) if options else ()


def options_of_auto(model: Model) -> dict[str, Any]:
    """Items of AUTO on the HISTORY card; none with another method."""
    for card in model.analyses:
        spec = card.laws["METHOD"][0] if card.spec.name == "HISTORY" else None
        if spec is not None and spec.name == "AUTO":
            return {field.name: card[field.name] for field in spec.fields}
    return {}


def histories_of(record: RunRecord, names: tuple[str, ...]) -> dict[str, Array]:
    """Some histories of a run with their times, labels and units, by ``name``, ``name|labels``, ..."""
    histories: dict[str, Array] = {}
    if record.recorded is None or not names:
        return histories
    for name in ("time", *names):
        shape, attributes = HISTORIES[name].layout(record.recorded)
        if 0 in shape:
            continue
        histories[name] = record.stored(name)
        for key in ("labels", "nodes", "element", "quantity"):
            if key in attributes:
                histories[f"{name}|{key}"] = np.array([str(x) for x in np.atleast_1d(attributes[key])])
        units = np.atleast_1d(attributes.get("unit", ""))
        histories[f"{name}|unit"] = np.array([record.model.units.text(str(u)) for u in units])
    return histories
