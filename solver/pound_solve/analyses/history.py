"""HISTORY: the motion under the ground motions, from the static state.

Chooses nothing and integrates nothing itself: it prepares the reduced system's start, hands it to the
method, and turns the samples that come back into histories, envelopes and tables.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from pound_deck.model import Model
from pound_deck.schema import Field, Kind, Spec
from pound_solve.integrate.protocol import ENERGIES, LawValues, MonitoredOutputs, Start, energies
from pound_solve.laws.automaton import State, consistent, drive
from pound_solve.numerics.matrices import layers, least_squares, used_columns, used_rows, weighted
from pound_solve.numerics.modes import massless
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.assembly import Structure
from pound_solve.structure.elements.base import Output
from pound_solve.structure.reduction import ReducedSystem

Append = Callable[[Mapping[str, Array]], None]

BLOCK, HELD = 256, 2**20  #: samples kept before they are written, and numbers of one kind in them, at most

SPEC = Spec(
    "analysis",
    "HISTORY",
    "motion in time",
    (
        Field("T", Kind.REAL, "T", doc="length of the history", above=0, positional=True),
        Field("METHOD", Kind.FAMILY, default="AUTO", family="method", doc="integrator"),
        Field(
            "FROM",
            Kind.WORD,
            default="STATIC",
            words=("STATIC", "REST"),
            doc="start from the static state under the loads, "
            "or unloaded at rest with the loads put on at t = 0",
        ),
        Field(
            "SAVE",
            Kind.REAL,
            "T",
            default=None,
            above=0,
            doc="time whose state is kept in the results file for a RESTART; left out: the end",
        ),
        Field(
            "RESTART",
            Kind.TEXT,
            default="",
            doc="results file (.h5) whose saved state this history goes on from",
        ),
    ),
)


def initial(structure: Structure) -> tuple[Array, Array]:
    """Displacement and velocity of the unknowns from the INITIAL cards, shape (n_free,) each."""
    n = structure.n_free
    column = {f: i for i, f in enumerate(structure.dofs.free)}
    u, v = np.zeros(n), np.zeros(n)
    for card in structure.model.initial:
        for node in card["NODES"]:
            for d, letter in enumerate("XYR"):
                i = column.get((node, d))
                if i is not None:
                    u[i] += card["U" + letter]
                    v[i] += card["V" + letter]
    return u, v


def begin(
    structure: Structure,
    system: ReducedSystem,
    u: Array,
    v: Array,
    states: Sequence[State],
    u_static: Array,
    times: Array,
) -> Start:
    """State at t = 0: the static one, plus INITIAL, the laws led along from the one to the other."""
    keep = system.columns
    u0, v0 = u[keep], v[keep]
    _lead_massless(system, u0, u0 - u_static[keep])
    before = structure.law_rows[:, : structure.n_free] @ u_static
    after = system.law_rows @ u0 + system.law_inputs @ system.excitation.value(0.0)
    rates = system.law_rows @ v0 + system.law_inputs @ system.excitation.value(0.0, 1)
    led = tuple(
        consistent(s.law, drive(s.law, x, d0, d1) if d0 != d1 else x, d1, rate)
        for s, x, d0, d1, rate in zip(
            structure.laws, states, before.tolist(), after.tolist(), rates.tolist()
        )
    )
    return Start(u0, v0, led, times)


def _lead_massless(system: ReducedSystem, u: Array, pushed: Array) -> None:
    """Let massless undamped unknowns that INITIAL leaves alone follow those that it pushes,
    on the stiffness at rest: nothing could hold them back.
    """
    laws = system.structure.laws
    idle = massless(system.mass) & (pushed == 0.0) & ~used_rows(system.damping)
    damped = [i for i, s in enumerate(laws) if s.beta != 0.0 or s.role.viscous]
    idle &= ~used_columns(system.law_rows[damped])
    if idle.any() and pushed.any():
        k = system.stiffness + weighted(system.law_rows, [s.k0 for s in laws])
        own, others = np.flatnonzero(idle), np.flatnonzero(~idle)
        away = k[np.ix_(own, others)] @ pushed[others]
        u[own] -= least_squares(k[np.ix_(own, own)], away)


def monitored(structure: Structure, system: ReducedSystem) -> MonitoredOutputs:
    """Rows of the DRIFT cards over the reduced system's unknowns."""
    cards = structure.model.drifts
    ways = ["XY".index(c["DIRECTION"]) for c in cards]
    rows = structure.dofs.rows(
        [(((c["J"], way), (c["I"], way)), (1.0, -1.0)) for c, way in zip(cards, ways)]
    )
    return MonitoredOutputs([c["NAME"] for c in cards], *system.over(rows))


def heights(model: Model) -> list[float]:
    """Storey height of every drift; NaN where none follows from the deck."""
    out = []
    for c in model.drifts:
        i, j = model.nodes[c["I"]], model.nodes[c["J"]]
        across = abs(j.y - i.y) if c["DIRECTION"] == "X" else abs(j.x - i.x)
        out.append(c["HEIGHT"] if c["HEIGHT"] is not None else (across or float("nan")))
    return out


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


class Envelopes:
    """Envelopes of the motion of some nodes and of the forces of some members.

    Attributes
    ----------
    node : dict of Envelope
        Of displacements "u", velocities "v" (relative to the ground, where it moves as one) and
        accelerations "a" (total).
    output : Envelope
    shown : ndarray of bool, shape (n,)
        Unknowns that it looks at.
    seen, apart : int, float
        Number of instants between the samples that were counted in, longest time from one to the next [T].
    """

    def __init__(self, system: ReducedSystem, nodes: Sequence[int], outputs: Sequence[Output]) -> None:
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
        self.damped = bool(used_rows(self.of_v).any() or self.out_rate.any())
        self.constants = np.array([o.constant for o in outputs]) + constants
        self.shares = system.corotational.shares([(o.element, o.quantity) for o in outputs])
        self.shown = used_columns(of_u) | used_columns(self.of_u) | used_columns(self.of_v)
        self.shown |= bool(system.corotational)  # they look at all
        self._clear()

    def _clear(self) -> None:
        self.node = {q: Envelope(3 * self.n_nodes) for q in "uva"}
        self.output = Envelope(len(self.constants))
        self.seen, self.apart = 0, 0.0

    def blank(self) -> Envelopes:
        """Return one of the same quantities that has seen nothing."""
        other = copy.copy(self)
        other._clear()
        return other

    def widen(self, other: Envelopes) -> None:
        """Count in what another one of the same quantities has seen."""
        for q, envelope in self.node.items():
            envelope.widen(other.node[q])
        self.output.widen(other.output)
        self.seen, self.apart = self.seen + other.seen, max(self.apart, other.apart)

    def between(self, t: Array, u: Array, v: Array, a: Array, apart: float) -> None:
        """Count in instants between the samples (see `integrate.base.HistoryRecorder`)."""
        self._count(t, u, v, a, [self.system.excitation.values(t, order).T for order in range(3)])
        self.seen, self.apart = self.seen + len(t), max(self.apart, apart)

    def stationary(self, t: Array, u: Array) -> None:
        """Count in displacements that turn between those instants (see
        `integrate.base.HistoryRecorder`).
        """
        self.node["u"].take(self._on_nodes(u, self.system.excitation.values(t).T, "u"), t, self.moving)

    def take(
        self, t: Array, u: Array, v: Array, a: Array, s: Sequence[Array]
    ) -> tuple[dict[str, Array], Array]:
        """Count in some samples; return the motion of the nodes, shape (3 n_nodes, nt) each,
        and the members' forces, shape (n_outputs, nt), from unknowns and inputs, shape (n, nt) each.
        """
        moving, out = self._count(t, u, v, a, s)
        node = {q: np.zeros((3 * self.n_nodes, len(t))) for q in moving}
        for q, values in moving.items():
            node[q][self.moving] = values
            self.node[q].take(node[q][self.still], t, self.still)
        return node, out

    def _count(
        self, t: Array, u: Array, v: Array, a: Array, s: Sequence[Array]
    ) -> tuple[dict[str, Array], Array]:
        """Count in some instants, but for what never moves; return the motion of the rest,
        shape (n_moving, nt) each, and the members' forces.
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
        return node, out

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


class HistoryRecorder:
    """Takes the method's samples, writes histories in blocks and keeps envelopes.

    Parameters
    ----------
    system : ReducedSystem
    drifts : MonitoredOutputs
    append : callable
        Takes a block of histories, see `results.Writer.append`.
    progress : callable
        Told the time of every sample, or what keeps the run waiting there.
    first_energy : ndarray, shape (6,), or None
        Energies at the start of the history, if this run takes it up later; None: of the first sample.
    """

    def __init__(
        self,
        system: ReducedSystem,
        drifts: MonitoredOutputs,
        append: Append,
        progress: Callable[[float, str], None],
        first_energy: Array | None = None,
    ) -> None:
        structure = system.structure
        model = structure.model
        self.system, self.drifts, self._append, self._progress = system, drifts, append, progress
        chosen = model.output["NODES"]
        self.nodes = tuple(model.nodes) if chosen is None else tuple(dict.fromkeys(chosen))
        elements = model.output["MEMBERS"]
        self.outputs = [o for o in structure.outputs if elements is None or o.element in elements]
        self.envelopes = Envelopes(system, self.nodes, self.outputs)
        self.springs = [i for i, s in enumerate(structure.laws) if not s.role.collides]
        self.contacts = [i for i, s in enumerate(structure.laws) if s.role.collides]
        self.first_energy = np.zeros(len(ENERGIES)) if first_energy is None else first_energy
        self.last_energy = np.zeros(len(ENERGIES))
        self._fresh = first_energy is None
        self.last_residual = self.residual_peak = self.energy_peak = 0.0
        self.losses = [0.0] * len(structure.laws)  # by slip and release, dashpots apart [F L]
        self.deformations = [0.0] * len(structure.laws)  # at the last sample
        self.reached = -1.0
        self.last: tuple[Array, Array, Array] = (np.zeros(0), np.zeros(0), np.zeros(3))  # u, v, works
        self._blocks: list[tuple[Any, ...]] = []
        widest = max(structure.dofs.size, 3 * len(self.nodes), len(self.outputs), len(structure.laws), 1)
        self._most = min(BLOCK, max(HELD // widest, 1))

    def layout(self) -> dict[str, tuple[tuple[int, ...], dict[str, Any]]]:
        """What `results.Writer.start_history` needs."""
        laws = self.system.structure.laws
        model = self.system.structure.model
        three = {"nodes": self.nodes, "labels": ["X", "Y", "R"]}

        springs = [laws[i] for i in self.springs]
        components = [f"{s.element} {s.component}" for s in springs]

        names = [contact_name(model, laws[i].element) for i in self.contacts]
        return {
            "node/u": ((len(self.nodes), 3), {**three, "unit": ["L", "L", "rad"]}),
            "node/v": ((len(self.nodes), 3), {**three, "unit": ["L/T", "L/T", "rad/T"]}),
            "node/a": ((len(self.nodes), 3), {**three, "unit": ["L/T^2", "L/T^2", "rad/T^2"]}),
            "member/force": (
                (len(self.outputs),),
                {
                    "element": [o.element for o in self.outputs],
                    "quantity": [o.quantity for o in self.outputs],
                    "unit": [o.unit for o in self.outputs],
                },
            ),
            "contact/gap": ((len(names),), {"labels": names, "unit": "L"}),
            "contact/force": ((len(names),), {"labels": names, "unit": "F"}),
            "spring/force": (
                (len(springs),),
                {"labels": components, "unit": [s.unit for s in springs]},
            ),
            "spring/deformation": (
                (len(springs),),
                {"labels": components, "unit": ["rad" if s.unit == "F*L" else "L" for s in springs]},
            ),
            "drift": ((len(self.drifts.names),), {"labels": list(self.drifts.names), "unit": "L"}),
            "ground": (
                (len(self.system.motions),),
                {
                    "labels": [f"{i + 1} {m.direction}" for i, m in enumerate(self.system.motions)],
                    "unit": ["rad/T^2" if m.direction == "R" else "L/T^2" for m in self.system.motions],
                },
            ),
            "force": (
                (len(self.system.forces),),
                {"labels": [f"{i + 1} {f.info['kind']}" for i, f in enumerate(self.system.forces)]},
            ),
            "energy": ((7,), {"labels": [*ENERGIES, "residual"], "unit": "F*L"}),
        }

    def sample(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take some samples (see `integrate.base.HistoryRecorder`)."""
        self.keep(t, u, v, a, laws, works)
        self._progress(self.reached, "")

    def keep(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take some samples whose progress was told before (see `integrate.base.EnvelopeRecorder`)."""
        new = t > self.reached  # but not the start of a part, where another ended
        if not new.any():
            return
        block = (t, u, v, a, *laws, works)
        self._blocks.append(block if new.all() else tuple(x[..., new] for x in block))
        self.last = u[:, -1], v[:, -1], works[:, -1]
        self.reached = float(t[-1])
        if sum(len(x[0]) for x in self._blocks) >= self._most:
            self.flush()

    def between(self, t: Array, u: Array, v: Array, a: Array, apart: float) -> None:
        """Widen the envelopes only (see `integrate.base.HistoryRecorder`)."""
        self.envelopes.between(t, u, v, a, apart)

    def stationary(self, t: Array, u: Array) -> None:
        """Widen the envelopes of displacements only (see `integrate.base.HistoryRecorder`)."""
        self.envelopes.stationary(t, u)

    @property
    def shown(self) -> Flags:
        """Which unknowns `between` looks at (see `integrate.base.HistoryRecorder`)."""
        return self.envelopes.shown

    def trial(self, t: float, doing: str = "") -> None:
        """Tell the progress of a run whose samples may not count (see `integrate.base.HistoryRecorder`)."""
        self._progress(t, doing)

    @property
    def started(self) -> bool:
        """Whether there was a sample: a method may refuse the reduced system at once."""
        return self.reached >= 0.0

    def _residuals(self, energy: Array) -> Array:
        """Input less what it became, against the start [F L], for rows of energies."""
        change = energy - self.first_energy
        return 2.0 * change[:, 0] - change.sum(axis=1)

    def flush(self) -> None:
        """Write the samples that are held."""
        if not self._blocks:
            return
        system, laws = self.system, self.system.structure.laws
        t, u, v, a, force, stored, lost, works = (
            np.concatenate(parts, axis=-1) for parts in zip(*self._blocks)
        )
        self._blocks = []
        inputs = [system.excitation.values(t, order).T for order in range(3)]
        s = inputs[0]
        d = system.law_rows @ u + system.law_inputs @ s
        energy = energies(system, t, u.T, v.T, stored.T, lost.T, works.T)
        if self._fresh:
            self.first_energy, self._fresh = energy[0], False
        residual = self._residuals(energy)
        self.last_energy, self.last_residual = energy[-1], float(residual[-1])
        self.energy_peak = max(self.energy_peak, float(np.abs(energy).max()))
        self.residual_peak = max(self.residual_peak, float(np.abs(residual).max()))
        self.losses, self.deformations = lost[:, -1].tolist(), d[:, -1].tolist()
        node, out = self.envelopes.take(t, u, v, a, inputs)
        gaps = np.array([laws[i].facts["gap"] for i in self.contacts])
        self._append(
            {
                "time": t,
                **{f"node/{q}": values.T.reshape(len(t), len(self.nodes), 3) for q, values in node.items()},
                "member/force": out.T,
                "contact/gap": gaps - d[self.contacts].T,
                "contact/force": force[self.contacts].T,
                "spring/force": force[self.springs].T,
                "spring/deformation": d[self.springs].T,
                "drift": (
                    self.drifts.rows @ u + self.drifts.input_rows @ s + self.drifts.constants[:, None]
                ).T,
                "ground": np.array(
                    [[float(m.acceleration.value(x)) for m in system.motions] for x in t]
                ).reshape(len(t), -1),
                "force": s[len(s) - len(system.forces) :].T,
                "energy": np.column_stack([energy, residual]),
            }
        )


def contact_name(model: Model, element: int) -> str:
    """Name of a contact in the report: its own, or its number."""
    return model.elements[element].name or str(element)
