"""Largest and smallest motion of nodes and forces of members, and when they occur."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from pound_solve.analyses.closeups import Closeups
from pound_solve.integrate.protocol import Course, Motion
from pound_solve.numerics.crests import NODES, crests, may_exceed
from pound_solve.numerics.matrices import layers, used_columns, used_rows
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.buildings import Building
from pound_solve.structure.elements.base import Output
from pound_solve.structure.equations import LinearSums
from pound_solve.structure.reduction import ReducedSystem

EXCESS = (
    0.5  #: share of a quantity's changes from node to node, by which it may exceed the largest of these
)
CELLS = 256  #: that are searched at once


class Envelope:
    """Largest and smallest values of n quantities, and their times, shape (n,) each."""

    def __init__(self, n: int) -> None:
        self.high, self.low = np.full(n, -np.inf), np.full(n, np.inf)
        self.t_high, self.t_low = np.zeros(n), np.zeros(n)

    def take(self, values: Array, t: Array, which: Index | None = None) -> None:
        """Count in values of all quantities, or of those with some numbers, shape (n, n_times)."""
        which = np.arange(len(values)) if which is None else which
        for new, best in (
            (values.max(axis=1) > self.high[which], (self.high, self.t_high, np.argmax)),
            (values.min(axis=1) < self.low[which], (self.low, self.t_low, np.argmin)),
        ):
            value, time, place = best
            own = values[new]
            at = place(own, axis=1)
            value[which[new]], time[which[new]] = own[np.arange(len(own)), at], t[at]

    def may_exceed(self, values: Array, which: Index) -> Flags:
        """Which cells may hold more than was counted in (see `crests`), shape (n_times,)."""
        return may_exceed(values, self.low[which], self.high[which])

    def near(self, values: Array, which: Index) -> Iterator[tuple[float, Index, Index, Array]]:
        """What may exceed the largest and the smallest values within some cells, by values at the `NODES`
        of each, shape (n, n_cells, n_nodes): a sign, numbers of quantities and of cells, and their values
        times that sign, shape (n_near, n_nodes).
        """
        change = np.abs(np.diff(values, axis=2))
        for sign, best in ((1.0, self.high), (-1.0, self.low)):
            x = sign * values
            at = np.argmax(x, axis=2)[..., None]
            most = np.take_along_axis(x, at, 2)[..., 0]
            for side in (np.maximum(at - 1, 0), np.minimum(at, change.shape[2] - 1)):
                most = most + EXCESS * np.take_along_axis(change, side, 2)[..., 0]
            row, cell = np.nonzero(most > (sign * best[which])[:, None])
            yield sign, which[row], cell, x[row, cell]

    def take_tops(self, sign: float, own: Index, top: Array, t: Array) -> None:
        """Count in extremes of quantities with some numbers, times a sign, and their times."""
        best, time = (self.high, self.t_high) if sign > 0.0 else (self.low, self.t_low)
        order = np.flatnonzero(top > sign * best[own])
        order = order[np.argsort(top[order], kind="stable")]  # the largest of each comes last
        best[own[order]], time[own[order]] = sign * top[order], t[order]

    def widen(self, other: Envelope) -> None:
        """Count in what another one of the same quantities has seen."""
        higher, lower = other.high > self.high, other.low < self.low
        self.high[higher], self.t_high[higher] = other.high[higher], other.t_high[higher]
        self.low[lower], self.t_low[lower] = other.low[lower], other.t_low[lower]

    def rows(self) -> list[tuple[float, float, float, float]]:
        """Largest value and its time, smallest value and its time, of each quantity."""
        return list(zip(self.high.tolist(), self.t_high.tolist(), self.low.tolist(), self.t_low.tolist()))

    def largest(self) -> list[tuple[float, float]]:
        """Largest absolute value of each quantity, and its time."""
        rows = self.rows()
        return [max((high, t_high), (-low, t_low), key=lambda x: x[0]) for high, t_high, low, t_low in rows]


class Envelopes:
    """Envelopes of the motion of some nodes, of the forces of some members and of sums of forces.

    Parameters
    ----------
    system : ReducedSystem
    nodes : sequence of int
    outputs : sequence of Output
    sums : mapping of str to LinearSums
        By the name of what they are.
    followed : ndarray of bool, shape (n,)
        Unknowns that close-ups need beside those of nodes, members and sums.
    room : int
        Instants that the close-ups keep, at most.

    Attributes
    ----------
    closeups : Closeups
    node : dict of Envelope
        Of displacements "u", velocities "v" (relative to the ground, where it moves as one) and
        accelerations "a" (total).
    output : Envelope
    total : dict of Envelope
        Of the sums, by their names.
    shown : ndarray of bool, shape (n,)
        Unknowns that it looks at.
    acting : ndarray of int, shape (n_acting,)
        Laws whose forces it looks at.
    seen, apart : int, float
        Number of instants between the samples that were counted in, longest time from one to the next [T].
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
        room: int = 0,
    ) -> None:
        dofs, place = system.structure.dofs, system.structure.model.nodes
        self.system, self.n_nodes = system, len(nodes)
        of_u, on_inputs, at_rest = system.over(dofs.matrix([(n, d) for n in nodes for d in range(3)]))
        # motion of the nodes when they ride on the ground: x, y, and a turn about the origin
        x, y = (np.array([getattr(place[n], c) for n in nodes]) for c in "xy")
        ridden = np.zeros((len(nodes), 3, 3))
        ridden[:, 0, 0] = ridden[:, 1, 1] = ridden[:, 2, 2] = 1.0
        ridden[:, 0, 2], ridden[:, 1, 2] = -y, x
        ground = ridden.reshape(-1, 3) @ system.acceleration_inputs
        # what never moves needs no products
        moves = used_rows(of_u) | np.any(np.column_stack([on_inputs, at_rest, ground]), axis=1)
        self.still, self.moving = np.flatnonzero(~moves), np.flatnonzero(moves)
        at = self.moving
        self.layers = layers(of_u[at])  # next to always one: a node has unknowns of its own
        self.on_inputs, self.at_rest, self.ground = on_inputs[at], at_rest[at, None], ground[at]
        self.of_u, self.out_s, constants = system.over(
            dofs.rows([(o.dofs, o.u_row.tolist()) for o in outputs])
        )
        self.of_v, self.out_rate, _ = system.over(
            dofs.rows([(o.dofs, () if o.v_row is None else o.v_row.tolist()) for o in outputs])
        )
        self.units = [o.unit for o in outputs]
        self.damped = bool(used_rows(self.of_v).any() or self.out_rate.any())
        self.constants = np.array([o.constant for o in outputs]) + constants
        self.shares = system.corotational.shares([(o.element, o.quantity) for o in outputs])
        self.shown = used_columns(of_u) | used_columns(self.of_u) | used_columns(self.of_v)
        self.sums, laws = sums, system.structure.laws
        acting = np.any([np.zeros(len(laws), bool), *(x.acting for x in sums.values())], axis=0)
        contacts = np.array([s.role.collides and room > 0 for s in laws], bool)
        self.acting = np.flatnonzero(acting | contacts)
        self.closeups = Closeups(np.flatnonzero(contacts[self.acting]), room)
        self.of_laws = {name: x.of_laws[:, self.acting] for name, x in sums.items()}
        self.shown |= np.any([x.shown for x in sums.values()], axis=0)
        self.shown |= used_columns(system.law_rows[self.acting])
        if contacts.any():
            self.shown |= followed
        # corotational members look at all, and so does the force of a closed rigid contact
        self.shown |= bool(system.corotational) or any(laws[i].law.rigid for i in self.acting)
        self._clear()

    def _clear(self) -> None:
        self.node = {q: Envelope(3 * self.n_nodes) for q in "uva"}
        self.output = Envelope(len(self.constants))
        self.total = {name: Envelope(len(x.constant)) for name, x in self.sums.items()}
        self.seen, self.apart, self.searched = 0, 0.0, False

    def blank(self) -> Envelopes:
        """Return one of the same quantities that has seen nothing."""
        other = copy.copy(self)
        other.closeups = self.closeups.blank()
        other._clear()
        return other

    def peaks(self) -> tuple[Array, list[str]]:
        """Largest and smallest accelerations of the nodes, rotations apart, and forces of the members, and
        the kind of each: those of a kind have one unit.
        """
        motion = self.node["a"]
        whole = np.arange(3 * self.n_nodes) % 3 < 2
        values = [motion.high[whole], motion.low[whole], self.output.high, self.output.low]
        kinds = ["acceleration"] * int(whole.sum()) * 2 + self.units * 2
        return np.concatenate(values), kinds

    def imbalance(self, buildings: Sequence[Building]) -> float:
        """Largest difference of both ways to the forces of a building on the ground, over the largest of
        these forces and of its inertia; a moment counts beside the force at the top of the building too.
        """
        off, base = (np.array([x for x, _ in self.total[name].largest()]) for name in ("imbalance", "base"))
        off, inertia = off.reshape(2, -1, 3)
        worst = 0.0
        for b, x, force in zip(buildings, off, np.maximum(base.reshape(-1, 3), inertia)):
            shear = float(force[:2].max())
            moment = max(float(force[2]), shear * (b.levels[-1] - b.base))
            worst = max(worst, float(x[:2].max()) / (shear or 1.0), float(x[2]) / (moment or 1.0))
        return worst

    def widen(self, other: Envelopes) -> None:
        """Count in what another one of the same quantities has seen."""
        for q, envelope in self.node.items():
            envelope.widen(other.node[q])
        self.output.widen(other.output)
        for name, total in self.total.items():
            total.widen(other.total[name])
        self.seen, self.apart = self.seen + other.seen, max(self.apart, other.apart)
        self.searched |= other.searched
        self.closeups.widen(other.closeups)

    def between(self, course: Course) -> None:
        """Count in the motion between samples (see `integrate.protocol.Recorder`), with its extremes."""
        parts = self._parts(*self._values(course.motion, self._inputs(course.motion.t)))
        for envelope, values, which in parts:
            envelope.take(values, course.motion.t, which)
        self.seen += len(course.motion.t)
        self.apart = max(self.apart, float(course.lengths.max(initial=0.0)))
        self.closeups.take(course)
        if course.within is None:
            return
        self.searched = True
        may = [envelope.may_exceed(values, which) for envelope, values, which in parts if len(values)]
        cells = np.flatnonzero(np.any(may, axis=0)) if may else np.zeros(0, np.int64)
        for some in np.split(cells, range(CELLS, len(cells), CELLS)):
            if len(some):
                self._refine(course, some, course.within(some, NODES))

    def _refine(self, course: Course, cells: Index, motion: Motion) -> None:
        """Count in the extremes over some cells, whose motion at the nodes is known."""
        parts = self._parts(*self._values(motion, self._inputs(motion.t)))
        near = [
            (envelope, *found)
            for envelope, values, which in parts
            if len(values)
            for found in envelope.near(values.reshape(len(values), len(cells), -1), which)
        ]
        tops, places = crests(np.concatenate([x for *_, x in near]))
        end = 0
        for envelope, sign, own, cell, _ in near:
            mine = slice(end, end := end + len(own))
            at = cells[cell]
            t = course.motion.t[at] + places[mine] * course.lengths[at]
            envelope.take_tops(sign, own, tops[mine], t)

    def _inputs(self, t: Array) -> list[Array]:
        """Inputs and their first two derivatives after the times, shape (n_inputs, n_times) each."""
        return [self.system.excitation.values_after(t, order).T for order in range(3)]

    def _parts(
        self, node: Mapping[str, Array], out: Array, totals: Mapping[str, Array]
    ) -> list[tuple[Envelope, Array, Index]]:
        """Envelopes, values for them, and numbers of these in them."""
        parts = [(self.node[q], values, self.moving) for q, values in node.items()]
        parts.append((self.output, out, np.arange(len(out))))
        return parts + [(self.total[name], x, np.arange(len(x))) for name, x in totals.items()]

    def take(self, motion: Motion, s: Sequence[Array]) -> tuple[dict[str, Array], Array, dict[str, Array]]:
        """Count in some samples; return the motion of the nodes, shape (3 n_nodes, nt) each,
        the members' forces, shape (n_outputs, nt), and the sums, (n_sums, nt) each, from the motion and the
        inputs, shape (n_inputs, nt) each.
        """
        moving, out, totals = self._values(motion, s)
        for envelope, values, which in self._parts(moving, out, totals):
            envelope.take(values, motion.t, which)
        node = self._whole(moving, len(motion.t))
        for q, values in node.items():
            self.node[q].take(values[self.still], motion.t, self.still)
        return node, out, totals

    def values(self, motion: Motion) -> tuple[dict[str, Array], Array, dict[str, Array]]:
        """Motion of the nodes, forces of the members and sums, as `take`, of instants between samples."""
        moving, out, totals = self._values(motion, self._inputs(motion.t))
        return self._whole(moving, len(motion.t)), out, totals

    def _whole(self, moving: Mapping[str, Array], count: int) -> dict[str, Array]:
        """Motion of the nodes, shape (3 n_nodes, count) each, with what never moves."""
        node = {q: np.zeros((3 * self.n_nodes, count)) for q in moving}
        for q, values in moving.items():
            node[q][self.moving] = values
        return node

    def _values(
        self, motion: Motion, s: Sequence[Array]
    ) -> tuple[dict[str, Array], Array, dict[str, Array]]:
        """Motion of the nodes, but for what never moves, shape (n_moving, nt) each, the members' forces,
        and the sums.
        """
        _, u, v, a, law_forces = motion
        node = {q: self._on_nodes(x, y, q) for q, x, y in zip("uva", (u, v, a), s)}
        node["a"] += self.ground @ s[0]  # they are total
        out = self.of_u @ u + self.out_s @ s[0] + self.constants[:, None]
        if self.damped:
            out += self.of_v @ v + self.out_rate @ s[1]
        if self.system.corotational:
            at, share = self.shares
            seen = self.system.corotational.actions(self.system.quantities(u.T, s[0].T))[:, at, 1:]
            out += (share * seen).sum(axis=2).T
        totals = {
            name: x.values((u, v, a), self.of_laws[name] @ law_forces, s) for name, x in self.sums.items()
        }
        return node, out, totals

    def _on_nodes(self, x: Array, s: Array, quantity: str) -> Array:
        """Displacements "u", velocities "v" or accelerations "a" of the nodes, but for what never moves,
        from those of the unknowns and the inputs.
        """
        out: Array = self.on_inputs @ s
        if quantity == "u":
            out += self.at_rest
        for columns, factors in self.layers:
            out += x[columns] * factors[:, None]
        return out
