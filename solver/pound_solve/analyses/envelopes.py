"""Largest and smallest motion of nodes and forces of members, and when they occur."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence

import numpy as np

from pound_solve.numerics.matrices import layers, used_columns, used_rows
from pound_solve.numerics.types import Array, Index
from pound_solve.structure.buildings import Building
from pound_solve.structure.elements.base import Output
from pound_solve.structure.equations import LinearSums
from pound_solve.structure.reduction import ReducedSystem


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

    Attributes
    ----------
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
    """

    def __init__(
        self,
        system: ReducedSystem,
        nodes: Sequence[int],
        outputs: Sequence[Output],
        sums: Mapping[str, LinearSums],
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
        self.acting = np.flatnonzero(acting)
        self.of_laws = {name: x.of_laws[:, self.acting] for name, x in sums.items()}
        self.shown |= np.any([x.shown for x in sums.values()], axis=0)
        self.shown |= used_columns(system.law_rows[self.acting])
        # corotational members look at all, and so does the force of a closed rigid contact
        self.shown |= bool(system.corotational) or any(laws[i].law.rigid for i in self.acting)
        self._clear()

    def _clear(self) -> None:
        self.node = {q: Envelope(3 * self.n_nodes) for q in "uva"}
        self.output = Envelope(len(self.constants))
        self.total = {name: Envelope(len(x.constant)) for name, x in self.sums.items()}
        self.seen, self.apart = 0, 0.0

    def blank(self) -> Envelopes:
        """Return one of the same quantities that has seen nothing."""
        other = copy.copy(self)
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

    def between(self, t: Array, u: Array, v: Array, a: Array, law_forces: Array, apart: float) -> None:
        """Count in instants between the samples (see `integrate.protocol.Recorder`)."""
        after = [self.system.excitation.values_after(t, order).T for order in range(3)]
        self._count(t, u, v, a, law_forces, after)
        self.seen, self.apart = self.seen + len(t), max(self.apart, apart)

    def stationary(self, t: Array, u: Array) -> None:
        """Count in displacements that turn between those instants (see
        `integrate.protocol.Recorder`).
        """
        after = self.system.excitation.values_after(t).T
        self.node["u"].take(self._on_nodes(u, after, "u"), t, self.moving)

    def take(
        self, t: Array, u: Array, v: Array, a: Array, law_forces: Array, s: Sequence[Array]
    ) -> tuple[dict[str, Array], Array, dict[str, Array]]:
        """Count in some samples; return the motion of the nodes, shape (3 n_nodes, nt) each,
        the members' forces, shape (n_outputs, nt), and the sums, (n_sums, nt) each, from unknowns and
        inputs, shape (n, nt) each, and the forces of the laws in `acting`.
        """
        moving, out, totals = self._count(t, u, v, a, law_forces, s)
        node = {q: np.zeros((3 * self.n_nodes, len(t))) for q in moving}
        for q, values in moving.items():
            node[q][self.moving] = values
            self.node[q].take(node[q][self.still], t, self.still)
        return node, out, totals

    def _count(
        self, t: Array, u: Array, v: Array, a: Array, law_forces: Array, s: Sequence[Array]
    ) -> tuple[dict[str, Array], Array, dict[str, Array]]:
        """Count in some instants, but for what never moves; return the motion of the rest,
        shape (n_moving, nt) each, the members' forces, and the sums.
        """
        node = {q: self._on_nodes(x, y, q) for q, x, y in zip("uva", (u, v, a), s)}
        node["a"] += self.ground @ s[0]  # they are total
        out = self.of_u @ u + self.out_s @ s[0] + self.constants[:, None]
        if self.damped:
            out += self.of_v @ v + self.out_rate @ s[1]
        if self.system.corotational:
            at, share = self.shares
            seen = self.system.corotational.actions(self.system.quantities(u.T, s[0].T))[:, at, 1:]
            out += (share * seen).sum(axis=2).T
        for q, values in node.items():
            self.node[q].take(values, t, self.moving)
        self.output.take(out, t)
        totals = {
            name: x.values((u, v, a), self.of_laws[name] @ law_forces, s) for name, x in self.sums.items()
        }
        for name, values in totals.items():
            self.total[name].take(values, t)
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
