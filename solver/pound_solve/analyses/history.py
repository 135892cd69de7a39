"""HISTORY: the response to ground motions, starting from the static state.

The analysis prepares the start of the reduced system, passes it to the method in one or two parts (up to
the saved state, and after it), and collects the results of the method and the recorder.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import NamedTuple, Protocol

import numpy as np

from pound_deck.model import Card, Model
from pound_deck.schema import Field, Kind, Spec
from pound_solve.analyses import restart, static
from pound_solve.analyses.damage import overall
from pound_solve.analyses.history_start import begin, initial
from pound_solve.analyses.recorder import HistoryRecorder, RecordedItems, SampleBlock
from pound_solve.analyses.spring_response import SpringResponse, spring_responses
from pound_solve.check import Bound, Check, Subject, at_least, at_most, beyond
from pound_solve.integrate.protocol import INTERRUPTED, MonitoredOutputs, Outcome, Problem, Start, Stop
from pound_solve.interruption import undisturbed
from pound_solve.loading.forces.base import Force
from pound_solve.loading.motions.base import GroundMotion
from pound_solve.numerics.types import Array
from pound_solve.structure import reduction
from pound_solve.structure.buildings import BEARING, marked_bearings
from pound_solve.structure.reduction import ReducedSystem
from pound_solve.structure.storeys import storeys
from pound_solve.structure.structure import Structure

RESIDUAL = "largest energy residual over the largest energy"  #: name of this check
BALANCE = "base shear and overturning moment less inertia and loads, over the largest"
CLOSEUPS = "time up to which close-ups have the peaks of collisions"
HINGES = "peak moment of a hinge beyond that of its member, over the latter"
BEYOND = 0.05  #: allowed height of a crest between two steps, at ten steps per period
DISPLACEMENT_ROUNDING = 1e-13  #: fraction of the size of a structure below which displacements are zero
ROWS = 1000  #: approximate rows of stored histories, if OUTPUT gives no interval

SPEC = Spec(
    "analysis",
    "HISTORY",
    "time history",
    (
        Field("T", Kind.REAL, "T", doc="length of the history", above=0, positional=True),
        Field("METHOD", Kind.FAMILY, default="AUTO", family="method", doc="integrator"),
        Field(
            "FROM",
            Kind.WORD,
            default="STATIC",
            words=("STATIC", "REST"),
            doc="start from the static state under the loads, or unloaded at rest with loads applied at "
            "t = 0",
        ),
        Field(
            "SAVE",
            Kind.REAL,
            "T",
            default=None,
            above=0,
            doc="time whose state is saved in the results file for a RESTART; omitted: the end",
        ),
        Field(
            "RESTART",
            Kind.TEXT,
            default="",
            doc="results file (.h5) whose saved state this history continues",
        ),
        Field(
            "NEW",
            Kind.WORD,
            default="NOTHING",
            words=("NOTHING", "MOTION"),
            doc="what can differ from the run that saved the state; with a new MOTION, time begins at zero",
        ),
    ),
)


class Loading(NamedTuple):
    """The excitation of a structure, and the state from which a history with RESTART continues (otherwise
    empty).
    """

    motions: Sequence[GroundMotion]
    forces: Sequence[Force]
    saved: Mapping[str, Array]


class HistoryOutput(Protocol):
    """Receiver of the samples of a history while it runs."""

    def start(self, items: RecordedItems) -> None:
        """Prepare for the recorded items."""

    def append(self, block: SampleBlock) -> None:
        """Take some samples."""

    def closeups(self, blocks: Iterable[SampleBlock]) -> None:
        """Receive the close-ups of collisions, when the history is over."""

    def extremes(self, bounds: Array, blocks: Sequence[SampleBlock]) -> None:
        """Receive the smallest and largest values between the `bounds`, when the history is over."""

    def save(self, state: Mapping[str, Array]) -> None:
        """Receive the state from which a later run can continue."""

    def progress(self, t: float, end: float, doing: str) -> None:
        """Receive the time reached, the end time, and the reason for a pause in progress, if any."""


class StoreyDrift(NamedTuple):
    """Largest absolute drift ratio of a storey of a building, and its time [T]."""

    building: str
    storey: int
    ratio: float
    t: float


@dataclass(frozen=True)
class HistoryResult:
    """Results of a history.

    Attributes
    ----------
    recorder : HistoryRecorder
        Envelopes, energies and the last sample.
    outcome : Outcome or None
        Result of the method; None if it stopped before the end.
    springs : list of SpringResponse
        Of all springs and hinges; empty without an outcome.
    stop : Stop or None
        Reason for an early end, if any.
    every : float
        Interval of the stored histories [T].
    seconds, cpu_seconds : float
        Run time of the method [s].
    """

    recorder: HistoryRecorder
    outcome: Outcome | None
    springs: list[SpringResponse]
    stop: Stop | None
    every: float
    seconds: float
    cpu_seconds: float

    @property
    def returned(self) -> Outcome:
        """The outcome, if the method returned one."""
        assert self.outcome is not None
        return self.outcome

    @property
    def overall_damage(self) -> float:
        """Damage index of the structure; NaN if no component has one."""
        damaged = [(r.damage.total, r.loss) for r in self.springs if r.damage is not None]
        return overall([index for index, _ in damaged], [loss for _, loss in damaged])

    @property
    def checks(self) -> list[Check]:
        """Return the self-checks: energy balance, equilibrium of the buildings, hinge peaks, memory of the
        close-ups, and the checks of the method.
        """
        checks = [self._energy(), *self._balance(), *self._hinges(), *self._closeups()]
        return checks + self.returned.checks

    @property
    def figures(self) -> dict[str, object]:
        """Return the figures of the method, and the thinning factor of the close-ups."""
        every = self.recorder.envelopes.closeups.every
        thinned = {"close-ups": f"peaks, and one instant of {every}"} if every > 1 else {}
        return {**self.returned.figures, **thinned}

    def _rounding(self) -> float:
        """Return the energy below which motion is rounding error [F L]: the largest force of a spring or
        contact times the fraction `DISPLACEMENT_ROUNDING` of the size of the structure.
        """
        nodes = self.system.structure.model.nodes.values()
        size = float(np.ptp([(n.x, n.y) for n in nodes], axis=0).max())
        forces = (max(abs(f.high), abs(f.low)) for f in self.returned.peaks.force)
        return DISPLACEMENT_ROUNDING * size * max((f for f in forces if math.isfinite(f)), default=0.0)

    @property
    def _allowed(self) -> float:
        """Return the allowed residual as a fraction of the largest value: for rounding, or for the errors
        of steps.
        """
        return 1e-9 if self.returned.exact else 1e-2

    def _energy(self) -> Check:
        """Compare the energy input with the stored and dissipated energy."""
        energy = self.recorder.energy
        # not relative to the final input, which a free body may have given back
        if energy.largest <= self._rounding():
            remark = "nothing moves: there is no energy to compare"
            return Check(Subject.ENERGY, RESIDUAL, 0.0, Bound.MOST, self._allowed, remark=remark)
        ratio = energy.largest_residual / energy.largest
        if energy.samples < 2:
            remark = "the run ended before there was anything to compare"
            return beyond(Subject.ENERGY, RESIDUAL, ratio, self._allowed, remark)
        return at_most(Subject.ENERGY, RESIDUAL, ratio, self._allowed, "energy is lost or made")

    def _closeups(self) -> Iterator[Check]:
        """Report close-ups that had insufficient memory for their peaks."""
        full, end = self.recorder.envelopes.closeups.full, self.recorder.reached
        if full < math.inf:
            unit = self.system.structure.model.units.time
            yield at_least(Subject.STORAGE, CLOSEUPS, full, end, "a larger OUTPUT CLOSEUPS keeps all", unit)

    def _balance(self) -> Iterator[Check]:
        """Compare the base shear with inertia and loads, if there are buildings."""
        if self.items.buildings:
            balance = self.recorder.envelopes.imbalance(self.items.buildings)
            remedy = "forces are out of balance; where a method takes time steps, shorter ones help"
            yield at_most(Subject.EQUILIBRIUM, BALANCE, balance, self._allowed, remedy)

    def _hinges(self) -> Iterator[Check]:
        """Compare the peaks of hinges, which the method also tracks between steps, with the envelopes of
        their members, which follow from the motion of the nodes.
        """
        largest = self.recorder.envelopes.output.largest()
        members = {(o.element, o.quantity): peak for o, (peak, _) in zip(self.items.outputs, largest)}
        both = [
            (max(peak.high, -peak.low), members[end])
            for law, peak in zip(self.system.structure.laws, self.returned.peaks.force)
            if (end := (law.element, law.component.replace("hinge", "moment"))) in members
        ]
        least = 1e-3 * max((moment for _, moment in both), default=0.0)  # smaller ones are rounding
        if least > 0.0:
            above = max(max(0.0, hinge - moment) / max(moment, least) for hinge, moment in both)
            yield at_most(
                Subject.PEAKS, HINGES, above, BEYOND, "no force of the member goes with that peak"
            )

    def drift_ratios(self) -> list[tuple[str, float]]:
        """Return the name and the largest absolute ratio of every drift; NaN if it has no height, or is
        that of a bearing.
        """
        model, least = self.system.structure.model, self._lowest_storey
        bearings = {frozenset(ends) for ends in marked_bearings(model)}
        ratios = []
        for card, h, e in zip(model.drifts, drift_heights(model), self.returned.peaks.monitored):
            is_storey = h >= least and frozenset((card["I"], card["J"])) not in bearings
            ratios.append((card["NAME"], max(abs(e.high), abs(e.low)) / h if is_storey else math.nan))
        return ratios

    def storey_drifts(self) -> list[StoreyDrift]:
        """Return the largest drift ratio of every storey of the buildings, without layers of bearings."""
        largest = self.recorder.envelopes.sums["drift"].largest()
        return [
            StoreyDrift(b.name, n, ratio, t)
            for (b, n), (ratio, t) in zip(storeys(self.items.buildings), largest)
            if n not in b.bearings
        ]

    @property
    def _lowest_storey(self) -> float:
        """Least height of a storey [L].  Bearings are much lower and may move by more than their height."""
        heights = list(drift_heights(self.system.structure.model))
        heights += [float(h) for b in self.items.buildings for h in np.diff(b.levels)]
        return BEARING * max((h for h in heights if h == h), default=0.0)

    @property
    def items(self) -> RecordedItems:
        """The recorded quantities."""
        return self.recorder.items

    @property
    def system(self) -> ReducedSystem:
        """The reduced system."""
        return self.recorder.items.system


def drift_heights(model: Model) -> Iterator[float]:
    """Yield the storey height of every drift [L]; NaN if the deck does not determine it."""
    for c in model.drifts:
        i, j = model.nodes[c["I"]], model.nodes[c["J"]]
        across = abs(j.y - i.y) if c["DIRECTION"] == "X" else abs(j.x - i.x)
        yield c["HEIGHT"] if c["HEIGHT"] is not None else (across or math.nan)


def monitored(structure: Structure, system: ReducedSystem) -> MonitoredOutputs:
    """Return the rows of the DRIFT cards over the unknowns of the reduced system."""
    cards = structure.model.drifts
    ways = ["XY".index(c["DIRECTION"]) for c in cards]
    rows = structure.dofs.rows(
        [(((c["J"], way), (c["I"], way)), (1.0, -1.0)) for c, way in zip(cards, ways)]
    )
    return MonitoredOutputs([c["NAME"] for c in cards], *system.reduce_rows(rows))


def output_interval(model: Model, loading: Loading, end: float) -> float:
    """Return the interval of the stored histories [T]: EVERY of OUTPUT, or a multiple of the shortest step
    of the records that gives about `ROWS` rows.
    """
    every: float | None = model.output["EVERY"]
    if every is None:
        infos = [m.info for m in loading.motions] + [f.info for f in loading.forces]
        steps = [dt for info in infos if (dt := info.get("dt"))]
        every = float(min(steps, default=end / ROWS))
        every *= max(1, round(end / every / ROWS))
    return every


def output_times(every: float, end: float) -> Array:
    """Return the instants of the stored histories from 0 to `end`, which is always included [T]."""
    count = int(np.floor(end / every * (1 + 1e-12)))
    times = every * np.arange(count + 1)
    return np.append(times, end) if end - times[-1] > 1e-9 * end else np.append(times[:-1], end)


def run(
    structure: Structure,
    state: static.StaticState,
    card: Card,
    loading: Loading,
    output: HistoryOutput,
    like: RecordedItems | None = None,
) -> HistoryResult:
    """Integrate the motion of a structure.

    Parameters
    ----------
    structure : Structure
        With the geometric stiffness of the static state.
    state : StaticState
    card : Card
        Of `SPEC`.
    loading : Loading
    output : HistoryOutput
    like : RecordedItems, optional
        Recorded items of an earlier history of the same model, possibly under another motion.

    Raises
    ------
    ReductionError, RestartError
        There is nothing to integrate, or the history ends before the saved state begins.
    """
    end = float(card["T"])
    if card["FROM"] == "REST":
        state = static.at_rest(structure)
    every = output_interval(structure.model, loading, end)
    times = output_times(every, end)
    start, items, first_energy = _prepared(structure, state, loading, times, like)

    with suppress(KeyboardInterrupt), undisturbed() as answer_now:

        def tell(t: float, doing: str) -> None:
            answer_now()  # a signal ends the run here, where the record is complete
            output.progress(t, end, doing)

        recorder = HistoryRecorder(items, output.append, tell, start.times, first_energy)
        output.start(items)
        began, used = time.perf_counter(), time.process_time()
        stop: Stop | None = None
        parts: list[Outcome] = []
        try:
            _integrate(card, start, recorder, output.save, parts)
        except Stop as err:
            stop = err
            parts += [err.outcome] if err.outcome is not None else []
        except KeyboardInterrupt:  # before the first step of a method, or between two methods
            stop = Stop("A506", max(recorder.reached, 0.0), INTERRUPTED)
        seconds, cpu_seconds = time.perf_counter() - began, time.process_time() - used
        recorder.flush()
        output.closeups(recorder.closeups())
        output.extremes(*recorder.extremes())
        outcome = restart.join(parts) if parts and recorder.started else None
        springs = [] if outcome is None else spring_responses(structure, recorder, outcome, stop is None)
        result = HistoryResult(recorder, outcome, springs, stop, every, seconds, cpu_seconds)
    return result


def _prepared(
    structure: Structure,
    state: static.StaticState,
    loading: Loading,
    times: Array,
    like: RecordedItems | None,
) -> tuple[Start, RecordedItems, Array | None]:
    """Return the start of a history, its recorded items, and the energies at its original start if it
    resumes.
    """
    end = float(times[-1])
    u0, v = initial(structure)
    u = state.u + u0
    saved = restart.load(loading.saved, structure) if loading.saved else None
    if saved is not None:
        u, v = saved.u, saved.v
        times = np.concatenate([[saved.t], times[times > saved.t]])
        if len(times) < 2:
            raise restart.RestartError(
                f"the saved state is of t = {saved.t:g}, the history ends at {end:g}"
            )
    system = reduction.build(structure, loading.motions, end, u, v, loading.forces)
    items = like.again(system) if like and like.holds_for(system) else None
    items = items or RecordedItems.of(system, monitored(structure, system))
    if saved is not None:
        return restart.resume(saved, system, times), items, saved.first
    return begin(structure, system, u, v, state.states, state.u, times), items, None


def _integrate(
    card: Card,
    start: Start,
    recorder: HistoryRecorder,
    save: Callable[[Mapping[str, Array]], None],
    parts: list[Outcome],
) -> None:
    """Integrate in parts up to the save time and on to the end; outcomes go into `parts`, so that those
    before a `Stop` survive.
    """
    system, times = recorder.items.system, start.times
    end = float(times[-1])
    saved = card["SAVE"] if card["SAVE"] is not None and times[0] < card["SAVE"] < end else end
    spec = card.laws["METHOD"][0]
    options = {f.name: card[f.name] for f in spec.fields}
    while start.times[0] < end:
        part = replace(start, times=_until(start.times, saved if start.times[0] < saved else end))
        parts.append(spec.impl(Problem(system, part, recorder.items.drifts, recorder), options))
        recorder.flush()
        here = _state(recorder, parts[-1])
        if recorder.reached == saved:
            save(here.arrays())
        start = restart.resume(here, system, np.append(here.t, times[times > here.t]))


def _state(recorder: HistoryRecorder, part: Outcome) -> restart.Saved:
    """Return the state at the end of a part of a history."""
    t, (u, v, works) = recorder.reached, recorder.last
    system = recorder.items.system
    n = system.structure.n_free
    whole_u, whole_v = (system.all_dofs(x, t, order)[:n] for order, x in enumerate((u, v)))
    return restart.Saved(t, whole_u, whole_v, part.states, works, recorder.energy.first)


def _until(times: Array, end: float) -> Array:
    """Return the times up to `end`, inclusive."""
    return np.append(times[times < end * (1 - 1e-12)], end)
