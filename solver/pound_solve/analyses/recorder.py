"""The recorder of a history: it receives the samples of a method, passes them on in blocks, and keeps
envelopes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Self

import numpy as np

from pound_solve.analyses.closeups import MEGABYTE
from pound_solve.analyses.envelopes import ResponseEnvelopes
from pound_solve.integrate.energy import ENERGIES, energies
from pound_solve.integrate.protocol import Course, LawValues, MonitoredOutputs, Motion, Stop
from pound_solve.numerics.matrices import used_columns
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.buildings import Building, buildings
from pound_solve.structure.elements.base import Output
from pound_solve.structure.equations import Equations, LinearSums, reactions
from pound_solve.structure.reduction import ReducedSystem
from pound_solve.structure.storeys import (
    acceleration_sums,
    base_sums,
    drift_sums,
    imbalance_sums,
    storey_sums,
)

#: attributes of a reduced system that describe the effect of inputs and loads
_ACTING: Final = (
    "constant",
    "inputs",
    "law_inputs",
    "support_inputs",
    "acceleration_inputs",
    "force_inputs",
)
LARGEST = 1e100  #: largest magnitude of a sample; energies, which are products of samples, remain finite
BLOCK, HELD = 256, 2**20  #: largest number of buffered samples, and of numbers of one kind in them


def recorded_sums(
    system: ReducedSystem, supports: Sequence[int], tracked: Sequence[Building]
) -> dict[str, LinearSums]:
    """Return the sums of a history: forces of each support and of each building on the ground (X, Y,
    moment), their imbalance; drifts, shears and moments of the storeys, accelerations of the floors.
    """
    equations = Equations(system)
    return {
        "reaction": reactions(equations, supports),
        "base": base_sums(equations, tracked),
        "imbalance": imbalance_sums(equations, tracked),
        "drift": drift_sums(system, tracked),
        "storey": storey_sums(equations, tracked),
        "acceleration": acceleration_sums(system, tracked),
    }


@dataclass(frozen=True)
class RecordedItems:
    """Items that a history records, selected by OUTPUT.

    Attributes
    ----------
    system : ReducedSystem
    drifts : MonitoredOutputs
    nodes : tuple of int
        Numbers of the nodes.
    outputs : tuple of Output
        Forces of the members.
    springs, contacts : tuple of int
        Positions among the laws of the structure.
    supports : tuple of int
        Numbers of the supported nodes.
    buildings : tuple of Building
    sums : mapping of str to LinearSums
        See `recorded_sums`.
    """

    system: ReducedSystem
    drifts: MonitoredOutputs
    nodes: tuple[int, ...]
    outputs: tuple[Output, ...]
    springs: tuple[int, ...]
    contacts: tuple[int, ...]
    supports: tuple[int, ...]
    buildings: tuple[Building, ...]
    sums: Mapping[str, LinearSums]

    @classmethod
    def of(cls, system: ReducedSystem, drifts: MonitoredOutputs) -> Self:
        """Select the items that the deck requests."""
        structure = system.structure
        nodes, elements = (structure.model.output[item] for item in ("NODES", "MEMBERS"))
        recorded = tuple(structure.model.nodes) if nodes is None else tuple(dict.fromkeys(nodes))
        supports = tuple(n for n in recorded if structure.model.nodes[n].fixed)
        return cls(
            system,
            drifts,
            recorded,
            tuple(o for o in structure.outputs if elements is None or o.element in elements),
            tuple(i for i, s in enumerate(structure.laws) if not s.role.collides),
            tuple(i for i, s in enumerate(structure.laws) if s.role.collides),
            supports,
            tracked := tuple(buildings(structure)) if structure.model.output["STOREYS"] == "YES" else (),
            recorded_sums(system, supports, tracked),
        )

    def holds_for(self, system: ReducedSystem) -> bool:
        """Return whether another history of the same model records the same items: it has the same
        unknowns, and its inputs act in the same way.
        """
        recorded = self.system
        return recorded.dofs == system.dofs and all(
            np.array_equal(getattr(recorded, name), getattr(system, name)) for name in _ACTING
        )

    def again(self, system: ReducedSystem) -> RecordedItems:
        """Return the same items for another history, for which `holds_for` is true."""
        return replace(self, system=system)

    @property
    def room(self) -> int:
        """Number of close-up instants that fit into the deck's memory limit."""
        widths = 9 * len(self.nodes), len(self.outputs), *(len(x.constant) for x in self.sums.values())
        others = 1 + len(self.springs) + 2 * len(self.contacts) + len(self.drifts.names)
        return int(self._budget("CLOSEUPS") / (8 * (sum(widths) + others)))

    @property
    def bytes_of_extremes(self) -> float:
        """Memory limit of the extremes [bytes]."""
        return self._budget("EXTREMES")

    def _budget(self, item: str) -> float:
        """Return the memory limit from an item of OUTPUT [bytes]."""
        output = self.system.structure.model.output
        return 0.0 if output["HISTORIES"] == "NO" else float(output[item] * MEGABYTE)

    @property
    def followed(self) -> Flags:
        """Unknowns of the drifts and the deformations of the springs and contacts, shape (n,)."""
        return used_columns(self.drifts.rows) | used_columns(self.system.law_rows)

    @property
    def widest(self) -> int:
        """Largest number of values of one kind of quantity at an instant."""
        structure = self.system.structure
        return max(structure.dofs.size, 3 * len(self.nodes), len(self.outputs), len(structure.laws), 1)


@dataclass(frozen=True)
class SampleBlock:
    """Some samples of a history.

    Attributes
    ----------
    items : RecordedItems
    t : ndarray, shape (n_times,)
        [T]
    u : ndarray, shape (n, n_times)
        Displacements of the unknowns of the reduced system [L], [rad].
    inputs : ndarray, shape (n_inputs, n_times)
        Inputs of the reduced system: motions of the ground and histories of forces.
    force, deformation : ndarray, shape (n_laws, n_times)
        Of all springs and contacts [F], [F L]; [L], [rad].
    nodes : mapping of str to ndarray, shape (3 n_nodes, n_times)
        Displacements "u", velocities "v" and accelerations "a" of the recorded nodes.
    members : ndarray, shape (n_outputs, n_times)
        Forces of the recorded members [F], [F L].
    sums : mapping of str to ndarray, shape (n_sums, n_times)
        Sums of forces by their names [F], [F L].
    energy : ndarray, shape (n_times, 7)
        `ENERGIES` and the residual [F L].
    """

    items: RecordedItems
    t: Array
    u: Array
    inputs: Array
    force: Array
    deformation: Array
    nodes: Mapping[str, Array]
    members: Array
    sums: Mapping[str, Array]
    energy: Array


def inputs_before(system: ReducedSystem, t: Array) -> list[Array]:
    """Return the inputs and their first two derivatives, shape (n_inputs, n_times) each, just before a
    jump, consistent with the accelerations of samples.
    """
    return [system.excitation.values(t, order, before=True).T for order in range(3)]


class EnergyBalance:
    """Energies of a history relative to its start, and their imbalance.

    Parameters
    ----------
    first : ndarray, shape (6,), or None
        `ENERGIES` at the start; None: those of the first sample [F L].

    Attributes
    ----------
    first, last : ndarray, shape (6,)
        At the start, and at the last sample.
    residual : float
        Input minus stored and dissipated energy, at the last sample.
    largest, largest_residual : float
        Largest absolute energy and residual of all samples.
    samples : int
        Number of samples included.
    """

    def __init__(self, first: Array | None = None) -> None:
        self._fresh = first is None
        self.first = np.zeros(len(ENERGIES)) if first is None else first
        self.last = np.zeros(len(ENERGIES))
        self.residual = self.largest = self.largest_residual = 0.0
        self.samples = 0

    def take(self, energy: Array) -> Array:
        """Include energies, shape (n_times, 6); return the residuals, shape (n_times,)."""
        if self._fresh:
            self.first, self._fresh = energy[0], False
        change = energy - self.first
        residual: Array = 2.0 * change[:, 0] - change.sum(axis=1)
        self.samples += len(energy)
        self.last, self.residual = energy[-1], float(residual[-1])
        self.largest = max(self.largest, float(np.abs(energy).max()))
        self.largest_residual = max(self.largest_residual, float(np.abs(residual).max()))
        return residual

    @property
    def changes(self) -> list[float]:
        """Return the changes of `ENERGIES` and of the residual since the start; the input counts from zero
        [F L].
        """
        stored = self.first * (np.arange(len(ENERGIES)) > 0)
        return [*(self.last - stored).tolist(), self.residual]


class HistoryRecorder:
    """Receives the samples of a method, passes them on in blocks and keeps envelopes.

    It implements `integrate.protocol.EnvelopeRecorder`.

    Parameters
    ----------
    items : RecordedItems
    append : callable
        Takes a `SampleBlock`.
    progress : callable
        Receives the time of every sample, or the reason for a pause.
    times : ndarray, shape (n_times,)
        Of the samples [T].
    first_energy : ndarray, shape (6,), or None
        Energies at the start of the history, if this run resumes it; None: those of the first sample.

    Attributes
    ----------
    energy : EnergyBalance
    losses : list of float
        Energy lost by slip and release in every law, excluding dashpots [F L].
    deformations : list of float
        Of every law at the last sample [L], [rad].
    reached : float
        Time of the last sample; negative before the first [T].
    last : tuple of ndarray
        Displacements, velocities and work integrals at the last sample.
    """

    def __init__(
        self,
        items: RecordedItems,
        append: Callable[[SampleBlock], None],
        progress: Callable[[float, str], None],
        times: Array,
        first_energy: Array | None = None,
    ) -> None:
        self.items, self._append, self._progress = items, append, progress
        self.envelopes = ResponseEnvelopes(
            items.system,
            items.nodes,
            items.outputs,
            items.sums,
            items.followed,
            items.room,
            times,
            items.bytes_of_extremes,
        )
        self.energy = EnergyBalance(first_energy)
        self.losses = [0.0] * len(items.system.structure.laws)
        self.deformations = [0.0] * len(items.system.structure.laws)
        self.reached = -1.0
        self.last: tuple[Array, Array, Array] = (np.zeros(0), np.zeros(0), np.zeros(3))
        self._blocks: list[tuple[Any, ...]] = []
        self._most = min(BLOCK, max(HELD // items.widest, 1))

    def sample(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take some samples (see `integrate.protocol.Recorder`)."""
        self.keep(t, u, v, a, laws, works)
        self._progress(self.reached, "")

    def keep(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take some samples whose progress has been reported before (see
        `integrate.protocol.EnvelopeRecorder`).
        """
        new = t > self.reached  # excludes the start of a part, which is the end of another
        if not new.any():
            return
        block = (t, u, v, a, *laws, works)
        if not all((np.abs(x) <= LARGEST).all() for x in block):
            raise self._beyond(t, u, v, a, laws, works)
        self._blocks.append(block if new.all() else tuple(x[..., new] for x in block))
        self.last = u[:, -1], v[:, -1], works[:, -1]
        self.reached = float(t[-1])
        if sum(len(x[0]) for x in self._blocks) >= self._most:
            self.flush()

    def _beyond(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> Stop:
        """Take the samples before the first that is not finite or beyond `LARGEST`; return the `Stop` for
        that sample.
        """
        system = self.items.system
        names = [system.name(i) for i in range(len(u))]
        springs = [f"the spring of element {s.element}" for s in system.structure.laws]
        checked = (
            [(x, names) for x in (u, v, a)] + [(x, springs) for x in laws] + [(works, ["the work"] * 3)]
        )
        good = np.array([(np.abs(x) <= LARGEST).all(axis=0) for x, _ in checked]).all(axis=0)
        first = int(np.argmin(good))
        if first:
            parts = LawValues(*(x[:, :first] for x in laws))
            self.keep(t[:first], u[:, :first], v[:, :first], a[:, :first], parts, works[:, :first])
        at = ((x[:, first], labels) for x, labels in checked)
        where = next(n for x, labels in at for n, y in zip(labels, x) if not abs(y) <= LARGEST)
        return Stop("A504", float(t[first]), f"the response overflowed, first at {where}")

    def between(self, course: Course) -> None:
        """Widen the envelopes only (see `integrate.protocol.Recorder`)."""
        self.envelopes.between(course)

    @property
    def enveloped_unknowns(self) -> Flags:
        """Which unknowns `between` needs (see `integrate.protocol.Recorder`)."""
        return self.envelopes.enveloped_unknowns

    @property
    def enveloped_laws(self) -> Index:
        """Laws whose forces `between` needs (see `integrate.protocol.Recorder`)."""
        return self.envelopes.enveloped_laws

    def report_progress(self, t: float, doing: str = "") -> None:
        """Report the progress of a run whose samples may be discarded (see
        `integrate.protocol.Recorder`).
        """
        self._progress(t, doing)

    @property
    def started(self) -> bool:
        """Whether there was a sample; a method may reject the reduced system immediately."""
        return self.reached >= 0.0

    def flush(self) -> None:
        """Pass on the buffered samples."""
        if not self._blocks:
            return
        system = self.items.system
        t, u, v, a, force, stored, lost, dashpot, works = (
            np.concatenate(parts, axis=-1) for parts in zip(*self._blocks)
        )
        self._blocks = []
        inputs = [system.excitation.values(t, order).T for order in range(3)]
        d = system.law_rows @ u + system.law_inputs @ inputs[0]
        energy = energies(system, t, u.T, v.T, stored.T, lost.T, works.T)
        residual = self.energy.take(energy)
        self.losses, self.deformations = lost[:, -1].tolist(), d[:, -1].tolist()
        law_forces = (force + dashpot)[self.enveloped_laws]
        before = inputs_before(system, t)
        nodes, members, sums = self.envelopes.take(Motion(t, u, v, a, law_forces), before)
        whole = np.column_stack([energy, residual])
        self._append(SampleBlock(self.items, t, u, inputs[0], force, d, nodes, members, sums, whole))

    def closeups(self) -> Iterator[SampleBlock]:
        """Yield the close-ups of collisions, in order of time, without energies and with forces of contacts
        only.
        """
        return map(self._sampled, self.envelopes.closeups.blocks())

    def closeup_at(self, t: float) -> SampleBlock | None:
        """Return the instant of the close-ups that is nearest to a time; None without close-ups."""
        nearest = self.envelopes.closeups.nearest(t)
        return None if nearest is None else self._sampled(nearest)

    def _sampled(self, motion: Motion) -> SampleBlock:
        """Return the values at the instants of a motion, without energies and with forces of contacts
        only.
        """
        system = self.items.system
        s = system.excitation.values(motion.t).T
        d = system.law_rows @ motion.u + system.law_inputs @ s
        force = np.zeros((len(d), len(motion.t)))
        force[self.enveloped_laws] = motion.law_forces
        values = self.envelopes.values(motion)
        return SampleBlock(self.items, motion.t, motion.u, s, force, d, *values, np.zeros((0, 7)))

    def extremes(self) -> tuple[Array, list[SampleBlock]]:
        """Return the bounds of the intervals reached completely or partly, shape (n + 1,), and the smallest
        and largest values within them, for nodes, members and sums only.
        """
        extremes, none = self.envelopes.extremes, np.zeros((0, 0))
        count = int(np.isfinite(extremes.low).all(axis=0).sum())
        blocks = []
        for values in (extremes.low, extremes.high):
            by_kind = self.envelopes.split_by_kind(values[:, :count])
            t = extremes.bounds[:count]
            blocks.append(SampleBlock(self.items, t, none, none, none, none, *by_kind, np.zeros((0, 7))))
        return np.minimum(extremes.bounds[: count + 1], self.reached) if count else np.zeros(0), blocks
