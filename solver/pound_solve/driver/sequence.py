"""The analyses of a deck, one after the other; their results go into the record and its tables."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, TypeAlias

import numpy as np

from pound_deck.model import Card
from pound_solve.analyses import capacity_line, history, modal, plausibility, pushover, restart, static
from pound_solve.analyses.recorder import RecordedItems, SampleBlock
from pound_solve.analyses.static_response import StaticResponse, static_response
from pound_solve.analyses.tangent_solution import InstabilityError
from pound_solve.driver.identity import identity
from pound_solve.driver.prepare import Prepared
from pound_solve.driver.request import Request
from pound_solve.integrate.protocol import INTERRUPTED, Stop
from pound_solve.interruption import undisturbed
from pound_solve.numerics.types import Array
from pound_solve.results.contents import HISTORIES, closeups_of, extremes_of, layout_of, values_of
from pound_solve.results.record import RunRecord
from pound_solve.results.safe_file import NoRoomError
from pound_solve.results.schema import Layout, Stage
from pound_solve.results.words import text_of
from pound_solve.structure.diaphragms import diaphragm_collisions
from pound_solve.structure.reduction_checks import ReductionError
from pound_solve.structure.structure import Structure

NO_ROOM = "A508 no room on the disk; what was written before is kept"
EXTREME = "of the deck that is far too large or too small"
#: receives the time reached, the final time, and the cause of a wait there, if any
Progress: TypeAlias = Callable[[float, float, str], None]


class RunOutput(Protocol):
    """Receiver of the results of a run; see `results.Writer` for the calls."""

    def text(self, name: str, text: str) -> None:
        """Store a text of the input."""

    def tables(self, stage: Stage, record: RunRecord) -> None:
        """Store the tables of a stage."""

    def start_history(self, layout: Layout, packed: bool = False) -> None:
        """Prepare for histories."""

    def append(self, block: Mapping[str, Array]) -> None:
        """Store the rows of all histories at some instants."""

    def stored(self, name: str) -> Array:
        """Rows of a history so far."""

    def closeups(self, layout: Layout, blocks: Sequence[Mapping[str, Array]]) -> None:
        """Store the close-ups of collisions."""

    def extremes(
        self, layout: Layout, bounds: Array, low: Mapping[str, Array], high: Mapping[str, Array]
    ) -> None:
        """Store the extremes of histories within intervals."""

    def restart(self, state: Mapping[str, Array], identity: Mapping[str, str]) -> None:
        """Store the state from which a later run can continue, and its identity."""


@dataclass
class Settled:
    """Results of the first run of a structure that later runs, with other motions, reuse.

    Attributes
    ----------
    static : StaticState or None
        None before the first run.
    structure : Structure or None
        With the geometric stiffness of this state's axial forces.
    response : StaticResponse or None
        Response of STATIC.
    modal : ModalResult or None
        Result of MODAL.
    items : RecordedItems or None
        Recorded items of HISTORY, with its sums of forces.
    """

    static: static.StaticState | None = None
    structure: Structure | None = None
    response: StaticResponse | None = None
    modal: modal.ModalResult | None = None
    items: RecordedItems | None = None


class AnalysisSequence:
    """The analyses of one deck.

    Parameters
    ----------
    ready : Prepared
    request : Request
        Gives the PARAMs that are not from the deck, and whether to explain.
    writer : RunOutput
    progress : callable or None
    began : float
        Reading of `time.perf_counter` at the start of the run.
    settled : Settled, optional
        Results of earlier runs whose models differ only in their motions.
    """

    def __init__(
        self,
        ready: Prepared,
        request: Request,
        writer: RunOutput,
        progress: Progress | None,
        began: float,
        settled: Settled | None = None,
    ) -> None:
        self.explain, self.writer = request.explain, writer
        self.settled = settled or Settled()
        self.loading = history.Loading(ready.motions, ready.forces, ready.saved)
        self.record = RunRecord(
            ready.model,
            ready.motions,
            ready.forces,
            ready.structure,
            frozenset(name.lower() for name in request.params),
            began,
            diaphragm_collisions(ready.structure),
        )
        self.record.warnings = ready.warnings
        self.output = HistoryWriter(self.record, writer, progress)

    def run(self) -> str:
        """Run all analyses of the deck; return the reason of a stop, or an empty text."""
        try:
            try:
                return self._analyses()
            finally:
                with suppress(KeyboardInterrupt), undisturbed():  # the analyses have ended
                    self._write(Stage.END)
                    if self.explain:
                        self._write(Stage.EXPLAIN)
        except NoRoomError:
            return NO_ROOM

    def _analyses(self) -> str:
        """Run one analysis after the other; return the reasons of stops, or an empty text."""
        stops = list[str]()
        last = self._one_after_the_other(stops)
        return "; ".join([*stops, last] if last else stops)

    def _one_after_the_other(self, stops: list[str]) -> str:
        """Run the analyses; return the reason of a stop that ends the run, or an empty text, and add those
        that do not.
        """
        doing = "static analysis"
        try:
            self.store_input()
            state = self._static()
            for name, analysis in (
                ("MODAL", self._modal),
                ("PUSHOVER", self._pushover),
                ("HISTORY", self._history),
            ):
                for n, card in enumerate(cards := self._cards(name), 1):
                    doing = f"{name.lower()} {n}" if len(cards) > 1 else name.lower()
                    if failed := analysis(card, state):  # later analyses do not depend on it
                        stops.append(f"{failed.code} {doing}: {failed}")
        except InstabilityError as err:
            return f"{err.code} {doing}: {err}"
        except np.linalg.LinAlgError as err:
            return f"A501 the structure is a mechanism ({err})"
        except ArithmeticError as err:
            return f"A504 {doing}: numbers beyond computing ({err}): look for a value {EXTREME}"
        except (ReductionError, restart.RestartError) as err:
            return f"A505 {err}"
        except Stop as err:
            return f"{err.code} at t = {err.t:.9g} {self.record.model.units.time}: {err}"
        except KeyboardInterrupt:
            return f"A506 {doing}: {INTERRUPTED}"
        return ""

    def _cards(self, name: str) -> list[Card]:
        """Cards of one analysis."""
        return [card for card in self.record.model.analyses if card.spec.name == name]

    def _write(self, stage: Stage) -> None:
        self.writer.tables(stage, self.record)

    def store_input(self) -> None:
        """Store the texts of the deck and the tables of its structure."""
        model = self.record.model
        for name, text in model.files.items():
            self.writer.text(Path(name).name, text)
        params = "\n".join(f"{k} = {text_of(v)}" for k, v in model.params.items())
        self.writer.text("parameters", params)
        self._write(Stage.INPUT)

    def _static(self) -> static.StaticState:
        """Static state, solved if needed; from then on the structure has the geometric stiffness of
        the axial forces of that state.
        """
        structure, settled = self.record.structure, self.settled
        asked = bool(self._cards("STATIC"))
        needed = bool(self._cards("PUSHOVER")) or any(
            "STATIC" in (c.values.get("FROM"), c.values.get("AFTER")) for c in self.record.model.analyses
        )
        if settled.static is not None:
            state = settled.static
        elif not (asked or needed or structure.geometric):
            state = static.at_rest(structure)
        else:
            state = static.solve(structure)
        settled.static = state
        if asked:
            self.record.static = settled.response = settled.response or static_response(structure, state)
            self.record.checks.append(self.record.static.check)
            self._write(Stage.STATIC)
        settled.structure = settled.structure or structure.stressed(state.axial).displaced(state.u)
        self.record.structure = settled.structure
        return state

    def _modal(self, card: Card, state: static.StaticState) -> None:
        self.settled.modal = self.settled.modal or modal.run(self.record.structure, state, card)
        self.record.modal = self.settled.modal
        self._write(Stage.MODAL)

    def _pushover(self, card: Card, state: static.StaticState) -> InstabilityError | None:
        number = next(n for n, one in enumerate(self._cards("PUSHOVER"), 1) if one is card)
        try:
            pushed = pushover.push(self.record.structure, state, card, number)
        except InstabilityError as err:  # it has no first step
            return err
        except np.linalg.LinAlgError as err:
            return InstabilityError(f"the structure is a mechanism ({err})")
        self.record.pushovers.append(pushed)
        self.record.performance[number] = capacity_line.performance_points(pushed, self.record.motions)
        self.record.checks.append(pushed.check)
        self._write(Stage.PUSHOVER)
        return pushed.failed

    def _history(self, card: Card, state: static.StaticState) -> None:
        record = self.record
        result = history.run(record.structure, state, card, self.loading, self.output, self.settled.items)
        with suppress(KeyboardInterrupt), undisturbed():  # the motion has ended
            record.history, self.settled.items = result, result.items
            record.solve_seconds += result.seconds
            record.cpu_seconds += result.cpu_seconds
            self._write(Stage.HISTORY)
            if result.recorder.started:
                self._write(Stage.SAMPLES)
            if result.outcome is not None:
                record.checks += [*result.checks, *plausibility.of_history(record.structure, result)]
                if result.stop is None and any(b.floors for b in result.items.buildings):
                    residual = record.stored("storey/drift")[-1].tolist()
                    record.checks += plausibility.leaning(record.structure, result, residual)
                self._write(Stage.PEAKS)
        if result.stop is not None:
            raise result.stop


class HistoryWriter:
    """Output of a history (`history.HistoryOutput`) that writes the samples to the results file.

    With OUTPUT HISTORIES=NO the file gets only their times; the samples stay in memory until the tables
    that need them are made.

    Parameters
    ----------
    record : RunRecord
    writer : RunOutput
    progress : callable or None
    """

    def __init__(self, record: RunRecord, writer: RunOutput, progress: Progress | None) -> None:
        self.record, self.writer, self._progress = record, writer, progress
        self._kept: list[SampleBlock] | None = [] if record.model.output["HISTORIES"] == "NO" else None
        self.record.stored = writer.stored if self._kept is None else self._rows

    def start(self, items: RecordedItems) -> None:
        """Create the histories."""
        self.record.recorded = items
        self.record.layout = layout_of(items) if self._kept is None else {}
        self.writer.start_history(self.record.layout, self.record.model.output["HISTORIES"] == "PACKED")

    def append(self, block: SampleBlock) -> None:
        """Append some samples to all histories."""
        if self._kept is not None:
            self._kept.append(block)
        self.writer.append(values_of(block) if self._kept is None else {"time": block.t})

    def _rows(self, name: str) -> Array:
        """Rows of a history that is not stored, shape (n_times, \\*row)."""
        return np.concatenate([HISTORIES[name].values(block) for block in self._kept or ()])

    def closeups(self, blocks: Iterable[SampleBlock]) -> None:
        """Store the close-ups of collisions."""
        if self._kept is None:
            self.writer.closeups(self.record.layout, [closeups_of(block) for block in blocks])

    def extremes(self, bounds: Array, blocks: Sequence[SampleBlock]) -> None:
        """Store the extremes within intervals, if any."""
        if self._kept is None and len(bounds):
            self.writer.extremes(self.record.layout, bounds, *map(extremes_of, blocks))

    def save(self, state: Mapping[str, Array]) -> None:
        """Store the state from which a later run can continue."""
        run = self.record
        self.writer.restart(state, identity(run.model, run.motions, run.forces))

    def progress(self, t: float, end: float, doing: str) -> None:
        """Show the progress to the user."""
        if self._progress is not None:
            self._progress(t, end, doing)
