"""The record of a run: all results so far, the source of the tables."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from pound_solve.check import Check
from pound_solve.results.schema import Layout

if TYPE_CHECKING:
    from pound_deck.diagnostics import Diagnostic
    from pound_deck.model import Model
    from pound_solve.analyses.capacity_line import PerformancePoint
    from pound_solve.analyses.history import HistoryResult
    from pound_solve.analyses.modal import ModalResult
    from pound_solve.analyses.pushover import PushoverResult
    from pound_solve.analyses.recorder import RecordedItems
    from pound_solve.analyses.static_response import StaticResponse
    from pound_solve.loading.forces.base import Force
    from pound_solve.loading.motions.base import GroundMotion
    from pound_solve.numerics.types import Array
    from pound_solve.structure.diaphragms import DiaphragmCollision
    from pound_solve.structure.structure import Structure


@dataclass
class RunRecord:
    """Data of a run so far.

    Attributes
    ----------
    model : Model
    motions : sequence of GroundMotion
    forces : sequence of Force
    structure : Structure
        After the static analysis, with the geometric stiffness of its axial forces.
    overridden : frozenset of str
        Lower-case names of PARAMs that the command line set.
    began : float
        Reading of `time.perf_counter` when the run began.
    diaphragm_collisions : mapping
        The two diaphragms of every contact, keyed by the number of its law.
    static, modal, history
        Results of the analyses; each is set when its analysis is over.
    pushovers : list of PushoverResult
        Of the PUSHOVER cards so far.
    performance : dict
        Performance points of the pushovers by number, one for each motion, with its name; None where the
        curve has none.
    recorded, layout
        Recorded items of the history and its layout in the file; set when it starts.
    stored : callable
        Rows of a history so far, by its name (``time`` among them), shape (n_times, \\*row): for tables of
        values that no method tracks.  They exclude peaks between output times.
    warnings : sequence of Diagnostic
        About the deck.
    checks : list of Check
        Of all analyses.
    solve_seconds, cpu_seconds : float
        Run time of the methods in all histories [s].
    """

    model: Model
    motions: Sequence[GroundMotion]
    forces: Sequence[Force]
    structure: Structure
    overridden: frozenset[str]
    began: float
    diaphragm_collisions: Mapping[int, DiaphragmCollision]
    static: StaticResponse = field(init=False)
    modal: ModalResult = field(init=False)
    history: HistoryResult = field(init=False)
    pushovers: list[PushoverResult] = field(default_factory=list)
    performance: dict[int, list[tuple[str, PerformancePoint | None]]] = field(default_factory=dict)
    recorded: RecordedItems | None = None
    layout: Layout = field(default_factory=dict)
    stored: Callable[[str], Array] = field(init=False)
    warnings: Sequence[Diagnostic] = ()
    checks: list[Check] = field(default_factory=list)
    solve_seconds: float = 0.0
    cpu_seconds: float = 0.0

    @property
    def responded(self) -> bool:
        """Whether the history's method returned its peaks."""
        return hasattr(self, "history") and self.history.outcome is not None
