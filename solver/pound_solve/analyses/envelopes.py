"""Largest and smallest values of node motions and member forces, and their times."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence

import numpy as np

from pound_solve.analyses.cells import AT_ONCE, among_equals, may_exceed_alone
from pound_solve.analyses.cells import NODES as OWN_NODES
from pound_solve.analyses.closeups import Closeups
from pound_solve.analyses.extremes import IntervalExtremes, intervals
from pound_solve.analyses.quantities import MOTION, Quantities
from pound_solve.integrate.protocol import Course, Motion
from pound_solve.numerics.crests import NODES, Doubts, crests, may_exceed, near, some_rows
from pound_solve.numerics.matrices import used_columns
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.buildings import Building
from pound_solve.structure.elements.base import Output
from pound_solve.structure.equations import LinearSums
from pound_solve.structure.reduction import ReducedSystem

ENTRIES = 2**15  #: approximate number of row entries searched for extremes at once


class Envelope:
    """Largest and smallest values of n quantities, and their times, shape (n,) each."""

    def __init__(self, n: int) -> None:
        self.high, self.low = np.full(n, -np.inf), np.full(n, np.inf)
        self.t_high, self.t_low = np.zeros(n), np.zeros(n)

    def take(self, values: Array, t: Array, which: Index | None = None) -> None:
        """Include values of all quantities, or of the quantities `which`, shape (n, n_times)."""
        which = np.arange(len(values)) if which is None else which
        for some in some_rows(values):
            part, number = values[some], which[some]
            for new, value, time, place in (
                (part.max(axis=1) > self.high[number], self.high, self.t_high, np.argmax),
                (part.min(axis=1) < self.low[number], self.low, self.t_low, np.argmin),
            ):
                higher, at = number[new], place(part[new], axis=1)
                value[higher], time[higher] = part[new, at], t[at]

    def part(self, which: slice) -> Envelope:
        """Return the envelope of some of the quantities; it shares the arrays of this one."""
        shared = copy.copy(self)
        for name, values in vars(self).items():
            setattr(shared, name, values[which])
        return shared

    def best(self, which: Index, sign: Array) -> Array:
        """Return the known extremes of some quantities, multiplied by `sign`: the largest value for a
        positive sign, the smallest for a negative sign, shape (n,).
        """
        return np.where(sign > 0.0, self.high[which], -self.low[which])

    def take_tops(self, which: Index, sign: Array, top: Array, t: Array) -> None:
        """Include extremes of some quantities, multiplied by `sign`, and their times."""
        for side, best, time in ((1.0, self.high, self.t_high), (-1.0, self.low, self.t_low)):
            order = np.flatnonzero((sign == side) & (top > side * best[which]))
            order = order[np.argsort(top[order], kind="stable")]  # the largest value of each comes last
            best[which[order]], time[which[order]] = side * top[order], t[order]

    def widen(self, other: Envelope) -> None:
        """Include the extremes of another envelope of the same quantities."""
        higher, lower = other.high > self.high, other.low < self.low
        self.high[higher], self.t_high[higher] = other.high[higher], other.t_high[higher]
        self.low[lower], self.t_low[lower] = other.low[lower], other.t_low[lower]

    def rows(self) -> list[tuple[float, float, float, float]]:
        """Return the largest value and its time, and the smallest value and its time, of each quantity."""
        return list(zip(self.high.tolist(), self.t_high.tolist(), self.low.tolist(), self.t_low.tolist()))

    def largest(self) -> list[tuple[float, float]]:
        """Return the largest absolute value of each quantity, and its time."""
        rows = self.rows()
        return [max((high, t_high), (-low, t_low), key=lambda x: x[0]) for high, t_high, low, t_low in rows]


class ResponseEnvelopes:
    """Envelopes of the motion of some nodes, of the forces of some members and of sums of forces.

    Parameters
    ----------
    system : ReducedSystem
    nodes : sequence of int
    outputs : sequence of Output
    sums : mapping of str to LinearSums
        Keyed by the name of the quantity.
    followed : ndarray of bool, shape (n,)
        Unknowns that close-ups need in addition to those of nodes, members and sums.
    room : int
        Largest number of instants that the close-ups keep.
    times : ndarray, shape (n_times,)
        Of the samples [T].
    bytes_of_extremes : float
        Memory limit; 0 keeps no extremes.

    Attributes
    ----------
    closeups : Closeups
    extremes : IntervalExtremes
        Within the intervals of the samples.
    node : dict of Envelope
        Of displacements "u", velocities "v" (both relative to the ground if all supports move alike) and
        accelerations "a" (total).
    output : Envelope
    sums : dict of Envelope
        Of the sums, by name.
    enveloped_unknowns : ndarray of bool, shape (n,)
        Unknowns that the envelopes depend on.
    enveloped_laws : ndarray of int, shape (n_enveloped,)
        Laws whose forces the envelopes depend on.
    seen, apart : int, float
        Number of instants between the samples, and the longest interval between two instants [T].
    searched : bool
        Whether extremes between these instants were found.
    """

    def __init__(
        self,
        system: ReducedSystem,
        nodes: Sequence[int],
        outputs: Sequence[Output],
        sums: Mapping[str, LinearSums],
        followed: Flags,
        room: int,
        times: Array,
        bytes_of_extremes: float,
    ) -> None:
        self.units, laws = [o.unit for o in outputs], system.structure.laws
        acting = np.any([np.zeros(len(laws), bool), *(x.acting for x in sums.values())], axis=0)
        contacts = np.array([s.role.collides and room > 0 for s in laws], bool)
        self.enveloped_laws = np.flatnonzero(acting | contacts)
        self.closeups = Closeups(np.flatnonzero(contacts[self.enveloped_laws]), room)
        self.quantities = Quantities(system, nodes, outputs, sums, self.enveloped_laws)
        count = self.quantities.count
        self.extremes = IntervalExtremes(intervals(times, count, bytes_of_extremes), count)
        held_by_laws = used_columns(system.law_rows[self.enveloped_laws])
        self.enveloped_unknowns = self.quantities.enveloped_unknowns | held_by_laws
        if contacts.any():
            self.enveloped_unknowns |= followed
        # corotational members and closed rigid contacts depend on all unknowns
        self.enveloped_unknowns |= bool(system.corotational) or any(
            laws[i].law.rigid for i in self.enveloped_laws
        )
        self._clear()

    def _clear(self) -> None:
        self._all = Envelope(self.quantities.count)
        parts = {name: self._all.part(part) for name, part in self.quantities.parts.items()}
        self.node = {q: parts.pop(q) for q in MOTION}
        self.output = parts.pop("output")
        self.sums = parts
        self.seen, self.apart, self.searched = 0, 0.0, False

    def blank(self) -> ResponseEnvelopes:
        """Return empty envelopes of the same quantities."""
        other = copy.copy(self)
        other.closeups, other.extremes = self.closeups.blank(), self.extremes.blank()
        other._clear()
        return other

    def peaks(self) -> tuple[Array, list[str]]:
        """Return the largest and smallest translational accelerations of nodes and forces of members, and
        the kind of each; all values of one kind have the same unit.
        """
        motion = self.node["a"]
        whole = np.arange(len(motion.high)) % 3 < 2
        values = [motion.high[whole], motion.low[whole], self.output.high, self.output.low]
        kinds = ["acceleration"] * int(whole.sum()) * 2 + self.units * 2
        return np.concatenate(values), kinds

    def imbalance(self, buildings: Sequence[Building]) -> float:
        """Return the largest difference between two ways to compute the forces of a building on the ground,
        divided by the largest of these forces, its inertia and its driving forces.  A moment is also
        compared with the force times the extent of the building.
        """
        off, base = (np.array([x for x, _ in self.sums[name].largest()]) for name in ("imbalance", "base"))
        off, *others = off.reshape(3, -1, 3)
        worst = 0.0
        for b, x, force in zip(buildings, off, np.maximum(base.reshape(-1, 3), np.max(others, axis=0))):
            shear = float(force[:2].max())
            moment = max(float(force[2]), shear * b.reach)
            worst = max(worst, float(x[:2].max()) / (shear or 1.0), float(x[2]) / (moment or 1.0))
        return worst

    def widen(self, other: ResponseEnvelopes) -> None:
        """Include the extremes of another envelope of the same quantities."""
        self._all.widen(other._all)
        self.seen, self.apart = self.seen + other.seen, max(self.apart, other.apart)
        self.searched |= other.searched
        self.closeups.widen(other.closeups)
        self.extremes.widen(other.extremes)

    def between(self, course: Course) -> None:
        """Include the motion between samples (see `integrate.protocol.Recorder`), with its extremes."""
        quantities, t = self.quantities, course.motion.t
        self.seen += len(t)
        self.apart = max(self.apart, float(course.lengths.max(initial=0.0)))
        self.closeups.take(course)
        proved = quantities.extremes(
            course, self._all.low[quantities.place], self._all.high[quantities.place]
        )
        if proved is None or self.extremes.low.size:
            values = quantities.values(course.motion, quantities.inputs(t))
            self.extremes.take(values, t, quantities.place)
        if proved is not None:
            self.searched = True
            for sign, top, at in ((1.0, proved.high, proved.t_high), (-1.0, -proved.low, proved.t_low)):
                self._count(quantities.place, np.full(len(top), sign), top, at)
            return
        self._all.take(values, t, quantities.place)
        if course.within is None or not len(t):
            return
        self.searched = True
        likely = self._doubts(course, values)
        rest = np.ones(len(likely.row), bool)
        rest[first := likely.first()] = False
        for doubts in (likely.some(first), likely.some(rest)):  # the rest seldom exceed the first
            self._search(course, doubts)

    def _doubts(self, course: Course, values: Array) -> Doubts:
        """Return which quantities may exceed their known extremes, and in which cells.  The test uses
        values at the starts of cells or, if adjacent cells give no bound, values within the cell.
        """
        quantities, lone = self.quantities, ~among_equals(course.motion.t, course.lengths)
        low, high = self._all.low[quantities.place], self._all.high[quantities.place]
        doubts = may_exceed(values, low, high)
        parts = [doubts.some(~lone[doubts.cell])]
        at_once = max(AT_ONCE // (len(OWN_NODES) * max(len(values), 1)), 1)
        cells = np.flatnonzero(lone)
        for first in range(0, len(cells), at_once):
            some = cells[first : first + at_once]
            within = np.moveaxis(quantities.within(course, some, OWN_NODES[1:]), 2, 0)
            parts.append(may_exceed_alone(np.stack([values[:, some], *within]), some, low, high))
        return Doubts(*map(np.concatenate, zip(*parts)))

    def _search(self, course: Course, doubts: Doubts) -> None:
        """Search the cells in which quantities may still exceed their known extremes, and include the
        results.
        """
        place = self.quantities.place
        doubts = doubts.some(doubts.most > self._all.best(place[doubts.row], doubts.sign))
        part = np.cumsum(self.quantities.entries[doubts.row]) // ENTRIES
        for some in np.split(np.arange(len(part)), np.flatnonzero(np.diff(part)) + 1):
            if len(some):
                self._refine(course, doubts.some(some))

    def _refine(self, course: Course, doubts: Doubts) -> None:
        """Find and include extremes of quantities within cells."""
        sign, row, cell, _ = doubts
        values = sign[:, None] * self.quantities.along(course, row, cell, NODES)
        place = self.quantities.place[row]
        close = np.flatnonzero(near(values, self._all.best(place, sign)))
        top, at = crests(values[close])
        t = course.motion.t[cell[close]] + at * course.lengths[cell[close]]
        self._count(place[close], sign[close], top, t)

    def _count(self, which: Index, sign: Array, top: Array, t: Array) -> None:
        """Include extremes of some quantities, multiplied by `sign`, and their times; NaN for none."""
        new = ~np.isnan(t)
        for extremes in (self._all, self.extremes):
            extremes.take_tops(which[new], sign[new], top[new], t[new])

    def take(self, motion: Motion, s: Sequence[Array]) -> tuple[dict[str, Array], Array, dict[str, Array]]:
        """Include some samples; return the motion of the nodes, shape (3 n_nodes, nt) each, the members'
        forces, shape (n_outputs, nt), and the sums, (n_sums, nt) each, from the motion and the inputs,
        shape (n_inputs, nt) each.
        """
        whole = self._whole(motion, s)
        self._all.take(whole, motion.t)
        self.extremes.take(whole, motion.t)
        return self.split_by_kind(whole)

    def values(self, motion: Motion) -> tuple[dict[str, Array], Array, dict[str, Array]]:
        """Return the motion of nodes, forces of members and sums as `take` does, at instants between
        samples.
        """
        return self.split_by_kind(self._whole(motion, self.quantities.inputs(motion.t)))

    def _whole(self, motion: Motion, s: Sequence[Array]) -> Array:
        """Return the values of all quantities, including constant ones, shape (n, nt)."""
        values = np.zeros((self.quantities.count, len(motion.t)))
        values[self.quantities.place] = self.quantities.values(motion, s)
        return values

    def split_by_kind(self, whole: Array) -> tuple[dict[str, Array], Array, dict[str, Array]]:
        """Split the values of all quantities into those of nodes, members and sums."""
        parts = {name: whole[part] for name, part in self.quantities.parts.items()}
        return {q: parts.pop(q) for q in MOTION}, parts.pop("output"), parts
