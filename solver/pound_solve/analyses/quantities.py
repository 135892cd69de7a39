"""Quantities of the envelopes as rows on motion and inputs: node motions, member forces, sums of forces.

Most rows involve few unknowns: one sparse matrix evaluates all of them, and the search for extremes
evaluates rows individually.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pound_solve.integrate.protocol import Course, Motion, MotionRows, RowPeaks
from pound_solve.numerics.matrices import Matrix, entries, gathered, used_rows
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.elements.base import Output
from pound_solve.structure.equations import LinearSums
from pound_solve.structure.reduction import ReducedSystem

FEW = 64  #: largest dense matrix has FEW rows and columns, or as many numbers in another shape
MOTION = "uva"  #: names of displacements, velocities and accelerations


class Quantities:
    """Quantities as rows, except constant ones.

    Parameters
    ----------
    system : ReducedSystem
    nodes : sequence of int
    outputs : sequence of Output
    sums : mapping of str to LinearSums
        Sums of forces or displacements, by name.
    enveloped_laws : ndarray of int, shape (n_enveloped,)
        Laws whose forces are part of the motion.

    Attributes
    ----------
    parts : dict of slice
        Numbers of the displacements "u", velocities "v" (both relative to the ground if all supports move
        alike) and total accelerations "a" of the nodes, of the "output" of members, and of the sums by
        name.
    count : int
    place : ndarray of int, shape (n_rows,)
        Numbers of the rows' quantities.
    """

    def __init__(
        self,
        system: ReducedSystem,
        nodes: Sequence[int],
        outputs: Sequence[Output],
        sums: Mapping[str, LinearSums],
        enveloped_laws: Index,
    ) -> None:
        self.system, self.sums, self._width = system, sums, len(enveloped_laws)
        self.parts: dict[str, slice] = {}
        self.count, self.place = 0, np.zeros(0, np.int64)
        self._inputs = np.zeros((0, 3 * system.inputs.shape[1] + 1))  # the last column is of ones
        self._rows = MotionRows(np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0))
        self._add_nodes(nodes)
        self._add_outputs(outputs)
        for name, x in sums.items():
            motion = {**dict(enumerate(x.motion)), 3: x.of_laws[:, enveloped_laws]}
            self._add(name, motion, dict(enumerate(x.inputs)), x.constant)
        order = np.lexsort((self._rows.columns, self._rows.row))
        self._rows = self._rows.some(order)
        self._driven = np.flatnonzero(self._inputs.any(axis=1))
        self._pointers = np.searchsorted(self._rows.row, np.arange(len(self.place) + 1))
        used, column = np.unique(self._rows.columns, return_inverse=True)
        parts = np.split(used, np.searchsorted(used, system.size * np.arange(1, 4)))
        self._used = [part - k * system.size for k, part in enumerate(parts)]
        self._column = np.zeros(3 * system.size + self._width, np.int64)
        self._column[used] = np.arange(len(used))
        shape = len(self.place), len(used)
        most = max(shape) if shape[0] * shape[1] <= FEW**2 else 0
        self._matrix = gathered(shape, self._rows.row, column, self._rows.factors, most_dense=most)

    def _add(
        self, name: str, motion: Mapping[int, Matrix], inputs: Mapping[int, Array], constant: Array,
        moves: Index | None = None, size: int = 0,
    ) -> None:  # fmt: skip
        """Add a part given by matrices on u, v, a and forces of laws (by number), on the inputs and their
        rates, and by constants.  If only some of its `size` quantities vary, `moves` lists their numbers.
        """
        n, m, first = self.system.size, self.system.inputs.shape[1], len(self.place)
        moves, size = (np.arange(len(constant)), len(constant)) if moves is None else (moves, size)
        self.parts[name] = slice(self.count, self.count + size)
        self.place = np.concatenate([self.place, self.count + moves])
        self.count += size
        on_inputs = np.zeros((len(constant), 3 * m + 1))
        for order, x in inputs.items():
            on_inputs[:, order * m : (order + 1) * m] += x
        on_inputs[:, -1] = constant
        self._inputs = np.concatenate([self._inputs, on_inputs])
        for k, matrix in motion.items():
            row, column, factor = entries(matrix)
            number, columns, factors = self._rows
            self._rows = MotionRows(
                np.concatenate([number, first + row]),
                np.concatenate([columns, k * n + column]),
                np.concatenate([factors, factor]),
            )

    def _add_nodes(self, nodes: Sequence[int]) -> None:
        """Add the motion of nodes."""
        system = self.system
        dofs, place = system.structure.dofs, system.structure.model.nodes
        of_u, on_inputs, at_rest = system.reduce_rows(
            dofs.matrix([(n, d) for n in nodes for d in range(3)])
        )
        # motion of the nodes with the ground: x, y, and rotation about the origin
        x, y = (np.array([getattr(place[n], c) for n in nodes]) for c in "xy")
        ridden = np.zeros((len(nodes), 3, 3))
        ridden[:, 0, 0] = ridden[:, 1, 1] = ridden[:, 2, 2] = 1.0
        ridden[:, 0, 2], ridden[:, 1, 2] = -y, x
        ground = ridden.reshape(-1, 3) @ system.acceleration_inputs
        moving = used_rows(of_u) | np.any(np.column_stack([on_inputs, at_rest, ground]), axis=1)
        at = np.flatnonzero(moving)
        for order, q in enumerate(MOTION):
            inputs = {order: on_inputs[at]}
            if q == "a":
                inputs[0] = ground[at]  # total accelerations
            constant = at_rest[at] if q == "u" else np.zeros(len(at))
            self._add(q, {order: of_u[at]}, inputs, constant, at, len(moving))

    def _add_outputs(self, outputs: Sequence[Output]) -> None:
        """Add the forces of members."""
        system, dofs = self.system, self.system.structure.dofs
        of_u, on_inputs, constant = system.reduce_rows(
            dofs.rows([(o.dofs, o.u_row.tolist()) for o in outputs])
        )
        rows = [(o.dofs, () if o.v_row is None else o.v_row.tolist()) for o in outputs]
        of_v, on_rates, _ = system.reduce_rows(dofs.rows(rows))
        constant = np.array([o.constant for o in outputs]) + constant
        self._add("output", {0: of_u, 1: of_v}, {0: on_inputs, 1: on_rates}, constant)
        self._shares = system.corotational.shares([(o.element, o.quantity) for o in outputs])

    @property
    def entries(self) -> Index:
        """Return the number of entries of every row, shape (n_rows,)."""
        return np.diff(self._pointers)

    def inputs(self, t: Array) -> list[Array]:
        """Return the inputs and their first two derivatives just after the times, shape (n_inputs, n_times)
        each.
        """
        return [self.system.excitation.values_after(t, order).T for order in range(3)]

    def values(self, motion: Motion, s: Sequence[Array]) -> Array:
        """Return the values of all rows, shape (n_rows, n_times), from the motion and from the inputs and
        their first two derivatives, shape (n_inputs, n_times) each.
        """
        values = self._matrix @ self._stacked(motion)
        values[self._driven] += self._inputs[self._driven] @ np.concatenate(
            [*s, np.ones((1, len(motion.t)))]
        )
        if self.system.corotational:
            at, share = self._shares
            seen = self.system.corotational.actions(self.system.quantities(motion.u.T, s[0].T))
            values[self._of("output")] += (share * seen[:, at, 1:]).sum(axis=2).T
            for name, x in self.sums.items():
                if len(x.members):
                    values[self._of(name)] += x.turned(motion.u, s[0])
        return np.asarray(values)

    def within(self, course: Course, cells: Index, shares: Array) -> Array:
        """Return the values of all rows at fractions of some cells, shape (n_rows, n_cells, n_shares)."""
        assert course.within is not None
        motion = course.within(cells, shares)
        return self.values(motion, self.inputs(motion.t)).reshape(-1, len(cells), len(shares))

    def extremes(self, course: Course, low: Array, high: Array) -> RowPeaks | None:
        """Return the extremes of all rows over a course, starting from the smallest and largest values so
        far, shape (n_rows,), with the times of new extremes and NaN for the others; None if the course does
        not compute them.
        """
        if course.extremes is None or self.system.corotational:
            return None
        t_high, t_low = np.full((2, len(high)), np.nan)
        peaks = RowPeaks(self._rows, self._inputs, high.copy(), t_high, low.copy(), t_low)
        course.extremes(peaks)
        return peaks

    def along(self, course: Course, row: Index, cell: Index, shares: Array) -> Array:
        """Return the values of rows, each within its own cell at fractions of that cell, shape (n,
        n_shares).
        """
        cells, at = np.unique(cell, return_inverse=True)
        t = (course.motion.t[cells, None] + shares * course.lengths[cells, None]).ravel()
        s = self.inputs(t)
        rows, values = self._some(row), np.zeros((len(row), len(shares)))
        if course.within is not None:
            motion = course.within(cells, shares)
            if self.system.corotational:
                return np.asarray(self.values(motion, s).reshape(-1, len(cells), len(shares))[row, at])
            stacked = self._stacked(motion)
            stacked = stacked.reshape(len(stacked), len(cells), len(shares))
            which, sums = rows.summed(stacked[self._column[rows.columns], at[rows.row]])
            values[which] += sums
        inputs = np.concatenate([*s, np.ones((1, len(t)))]).reshape(-1, len(cells), len(shares))
        for factors, x in zip(self._inputs.T, inputs):
            values += factors[row, None] * x[at]
        return values

    def _of(self, name: str) -> slice:
        """Return the rows of a part whose quantities all vary."""
        part = self.parts[name]
        return slice(*np.searchsorted(self.place, [part.start, part.stop]).tolist())

    def _stacked(self, motion: Motion) -> Array:
        """Return the values of a motion on which the rows depend, shape (n_used, n_times)."""
        return np.concatenate([part[used] for part, used in zip(motion[1:], self._used)])

    def _some(self, row: Index) -> MotionRows:
        """Return the entries of some of the rows."""
        counts = self.entries[row]
        number = np.repeat(np.arange(len(row)), counts)
        at = np.arange(len(number)) + np.repeat(self._pointers[row] - np.cumsum(counts) + counts, counts)
        return self._rows.some(at)._replace(row=number)

    @property
    def enveloped_unknowns(self) -> Flags:
        """Which unknowns the rows involve, shape (n,)."""
        enveloped_unknowns = np.zeros(self.system.size, bool)
        for used in self._used[:3]:
            enveloped_unknowns[used] = True
        return enveloped_unknowns
