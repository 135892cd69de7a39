"""The scene in blocks: parts that move on their own between events, and their motion over
a window of time.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_solve import polynomial
from pound_solve.integrate import work
from pound_solve.integrate.flow import TERMS, Flow, Mechanism, make_flow, on_stacked, stacked
from pound_solve.integrate.rigid import Rigid
from pound_solve.laws import Branch
from pound_solve.scene import Scene

Array = NDArray[np.float64]
Key = tuple[Any, ...]

#: cost of a regime, as `exact.WINDOW`; of its tables for each unknown; of its modes over the unknowns' cube
REGIME, TABLE, MODES = 2e-3, 2e-4, 3e-8


@dataclass(frozen=True)
class Reactions:
    """Forces of the rigid contacts that a block holds closed: ``on_q q + on_p p + on_rate p'``.

    Attributes
    ----------
    laws : ndarray of int, shape (n_held,)
    place : ndarray of int, shape (n_held,)
        Their rows among those of the run.
    gaps : ndarray, shape (n_held,)
    inputs : ndarray, shape (n_held, n_inputs)
        The deformations that the unknowns are held to are ``gaps - inputs s``.
    on_q : ndarray, shape (n_held, n_q)
    on_p, on_rate : ndarray, shape (n_held, n + 3 n_held)
        On the forces, extended as in `flow.held_space`.
    """

    laws: NDArray[np.intp]
    place: NDArray[np.intp]
    gaps: Array
    inputs: Array
    on_q: NDArray[Any]
    on_p: Array
    on_rate: Array

    def extended(self, ps: Array, coefs: Array) -> Array:
        """Force polynomials (n_intervals, degree + 1, n + 3 n_held) with what is held in their last
        columns, from inputs' coefficients.
        """
        m, orders = len(self.laws), np.arange(1, coefs.shape[1])[:, None]
        ps = ps.copy()
        x, first, second = (ps[..., k * m - 3 * m : (k * m - 2 * m) or None] for k in range(3))
        x[:] = -coefs @ self.inputs.T
        x[:, 0] += self.gaps
        first[:, :-1] = x[:, 1:] * orders
        second[:, :-1] = first[:, 1:] * orders
        return ps


@dataclass(frozen=True)
class Regime:
    """A block's exact motion for one set of stiffnesses; kept for when they return.

    Attributes
    ----------
    index : ndarray of int
        The block's unknowns.
    laws : ndarray of int
        Laws that act within it.
    watched : ndarray of int, place : list of int
        Which rows of the run touch it; the place of every row among them, or -1.
    rows : ndarray, shape (n_watched, n)
    on_u : ndarray, shape (n_watched, n_q)
        What the rows' values take from q.
    on_q : ndarray, shape (3 n_watched, n_q or 2 n_q)
        What their values, rates and second rates take from `flow.stacked` q.
    motion : ndarray, shape (3 n, n_q or 2 n_q)
        What displacements, velocities and accelerations take from it.
    reactions : Reactions or None
    """

    index: NDArray[np.intp]
    laws: NDArray[np.intp]
    flow: Flow
    watched: NDArray[np.intp]
    place: list[int]
    rows: Array
    on_u: NDArray[Any]
    on_q: Array
    motion: Array
    meter: work.Meter
    reactions: Reactions | None


@dataclass
class Block:
    """A regime at work: its state `q` and its motion over the present window.

    Attributes
    ----------
    constant : ndarray, shape (n,)
        Constant forces: loads and constants of the laws.
    qs : ndarray, shape (n_q, n_intervals + 1)
    gs : ndarray, shape (n_intervals, degree + 1, n_q)
        States at the starts of the window's intervals and forcing within them.
    ps : ndarray, shape (n_intervals, degree + 1, n) or None
        Force polynomials, where massless freedoms or moved supports need them.
    samples : ndarray, shape (n_q, n_intervals, n_times)
        States on the grid of `Window.functionals`.
    """

    key: Key
    regime: Regime
    constant: Array
    q: NDArray[Any]
    qs: NDArray[Any] = field(default_factory=lambda: np.zeros((0, 0)))
    gs: NDArray[Any] = field(default_factory=lambda: np.zeros((0, 0, 0)))
    ps: Array | None = None
    samples: NDArray[Any] = field(default_factory=lambda: np.zeros((0, 0, 0)))


class Partition:
    """Keeps the scene divided into blocks as contacts close and springs yield.

    Parameters
    ----------
    scene : Scene
    rows : ndarray, shape (n_rows, n)
        Functionals that the run watches; the first are the laws' deformations.
        The forces of the rigid contacts come after them.
    row_inputs : ndarray, shape (n_rows, n_inputs)
    row_constants : ndarray, shape (n_rows,)
    """

    def __init__(self, scene: Scene, rows: Array, row_inputs: Array, row_constants: Array) -> None:
        self.scene, self.rigid, more = scene, Rigid(scene), len(rows)
        count = len(self.rigid.laws)
        self.force_row = {law: more + i for i, law in enumerate(self.rigid.laws)}
        self.rows = np.pad(rows, ((0, count), (0, 0)))
        self.row_inputs = np.pad(row_inputs, ((0, count), (0, 0)))
        self.row_constants = np.pad(row_constants, (0, count))
        self.known = bool(np.any(row_inputs))
        self.blocks: list[Block] = []
        self.regimes: dict[Key, Regime] = {}
        self._base = self._parts_with_contacts_open()

    @property
    def parts(self) -> int:
        """Number of parts with all contacts open."""
        return len(np.unique(self._base))

    @property
    def fastest(self) -> float:
        """Largest |eigenvalue| of the present blocks [1/T]."""
        return max((b.regime.flow.fastest for b in self.blocks), default=0.0)

    def _parts_with_contacts_open(self) -> NDArray[np.intp]:
        """Label the unknowns by what hangs together, shape (n,)."""
        scene, n = self.scene, self.scene.size
        linked = (scene.stiffness != 0) | (scene.damping != 0) | (scene.mass != 0)
        for s, row in zip(scene.structure.laws, scene.law_rows):
            if not s.is_contact:
                at = np.flatnonzero(row)
                linked[np.ix_(at, at)] = True
        labels = np.arange(n)
        while True:
            # every unknown takes the lowest label among its neighbours until nothing changes
            lowest = np.minimum(np.where(linked, labels[None, :], n).min(axis=1, initial=n), labels)
            if (lowest == labels).all():
                return labels
            labels = lowest

    def form(self, branches: Sequence[Branch], u: Array, v: Array, spend: Callable[[float], None]) -> None:
        """Form the blocks that the branches ask for at displacement `u`, velocity `v`;
        keep those that go on, and tell `spend` what a new one costs before it is made.

        Raises
        ------
        Mechanism
            Massless freedoms that nothing holds; its shape is over all unknowns.
        """
        scene = self.scene
        labels = self._base.copy()
        for i, (s, b) in enumerate(zip(scene.structure.laws, branches)):
            if s.is_contact and (b.stiffness or b.damping or b.held):
                parts = np.unique(labels[scene.law_rows[i] != 0])
                if len(parts):
                    labels[np.isin(labels, parts)] = parts[0]
        old = {b.key: b for b in self.blocks}
        acting = [i for i, b in enumerate(branches) if b.stiffness or b.damping or b.force0 or b.held]
        blocks = []
        for label in np.unique(labels):
            index = np.flatnonzero(labels == label)
            laws = np.array([i for i in acting if np.any(scene.law_rows[i, index])], np.intp)
            key = (
                int(label),
                len(index),
                *((int(i), branches[i].stiffness, branches[i].damping, branches[i].held) for i in laws),
            )
            constant = scene.constant[index] - scene.law_rows[np.ix_(laws, index)].T @ [
                branches[i].force0 for i in laws
            ]
            if key in old:
                old[key].constant = constant
                blocks.append(old[key])
                continue
            if key not in self.regimes:
                spend(REGIME + TABLE * len(index) + MODES * len(index) ** 3)
                self.regimes[key] = self._regime(index, laws, branches)
            regime = self.regimes[key]
            blocks.append(Block(key, regime, constant, regime.flow.enter(u[index], v[index])))
        self.blocks = blocks

    def _regime(
        self, index: NDArray[np.intp], laws: NDArray[np.intp], branches: Sequence[Branch]
    ) -> Regime:
        scene = self.scene
        grid = np.ix_(index, index)
        b = scene.law_rows[np.ix_(laws, index)]
        k = scene.stiffness[grid] + (b.T * [branches[i].stiffness for i in laws]) @ b
        c = scene.damping[grid] + (b.T * [branches[i].damping for i in laws]) @ b
        held = np.array([i for i in laws if branches[i].held], np.intp)
        held_rows = scene.law_rows[np.ix_(held, index)] if len(held) else None
        try:
            flow = make_flow(scene.mass[grid], c, k, scene.inputs[index], held_rows)
        except Mechanism as err:
            whole = np.zeros(scene.size)
            whole[index] = err.shape
            raise Mechanism(whole) from None
        watched = np.flatnonzero(np.any(self.rows[:, index] != 0, axis=1))
        place = [-1] * len(self.rows)
        for i, row in enumerate(watched.tolist()):
            place[row] = i
        rows = self.rows[np.ix_(watched, index)]
        dashpots = [
            (int(i), branches[i].damping, scene.law_rows[i, index]) for i in laws if branches[i].damping
        ]
        meter = work.Meter(flow, scene.damping[grid], scene.inputs[index], dashpots)
        motion = on_stacked(np.vstack([flow.u_q, flow.v_q, flow.onward(flow.v_q)]))
        return Regime(
            index,
            laws,
            flow,
            watched,
            place,
            rows,
            rows @ flow.u_q,
            np.concatenate([rows @ x for x in np.split(motion, 3)]),
            motion,
            meter,
            self._reactions(held, index, flow, c, k) if len(held) else None,
        )

    def _reactions(
        self, held: NDArray[np.intp], index: NDArray[np.intp], flow: Flow, c: Array, k: Array
    ) -> Reactions:
        """From ``G f = B M^-1 (p - C v - K u) - x''``, see `rigid` and `flow.held_space`."""
        assert flow.u_p is not None and flow.space.v_p is not None  # of all that is held
        at = np.array([self.rigid.laws.index(i) for i in held], np.intp)
        inverse = np.linalg.pinv(self.rigid.compliance[np.ix_(at, at)], rcond=1e-12)
        x = inverse @ self.rigid.yielding[np.ix_(index, at)].T
        on_p = -x @ (k @ flow.u_p + c @ flow.space.v_p)
        on_p[:, : len(index)] += x
        on_p[:, on_p.shape[1] - len(held) :] -= inverse
        return Reactions(
            held,
            np.array([self.force_row[i] for i in held], np.intp),
            self.rigid.gap[at],
            self.rigid.inputs[at],
            -x @ (k @ flow.u_q + c @ flow.v_q),
            on_p,
            -x @ c @ flow.u_p,
        )


class Window:
    """The motion over a few intervals of equal length, within each of which
    the excitation is one polynomial.

    Parameters
    ----------
    partition : Partition
    branches : sequence of Branch
    coefs : ndarray, shape (n, degree + 1, n_inputs)
        Inputs in each interval, about its start.
    length : float
        Of each interval [T].
    """

    def __init__(
        self, partition: Partition, branches: Sequence[Branch], coefs: Array, length: float
    ) -> None:
        self.partition, self.branches, self.coefs, self.length = partition, branches, coefs, length
        self.h, self.count = length, 1  # of the grid that `functionals` is asked on
        self._arcs: dict[tuple[int, int, int], list[float]] = {}
        scene = partition.scene
        for block in partition.blocks:
            flow = block.regime.flow
            if not scene.total and flow.u_p is None:
                block.gs = flow.forcing(coefs, block.constant)
            else:
                ps = coefs @ flow.inputs.T
                n = len(block.constant)
                ps[:, 0, :n] += block.constant
                ps[..., :n] += self._supports(block)
                reactions = block.regime.reactions
                block.ps = ps if reactions is None else reactions.extended(ps, coefs)
                block.gs = flow.push(block.ps)
            block.qs = flow.march(block.q, block.gs, length)

    def _supports(self, block: Block) -> Array:
        """Forces of laws that reach to moved supports, whose deformation has a known part,
        (n, degree + 1, n_unknowns).
        """
        scene, laws = self.partition.scene, block.regime.laws
        e = self.coefs @ scene.law_inputs[laws].T
        rate = np.zeros_like(e)
        rate[:, :-1] = e[:, 1:] * np.arange(1, e.shape[1])[:, None]
        k = np.array([self.branches[i].stiffness for i in laws])
        c = np.array([self.branches[i].damping for i in laws])
        return -(e * k + rate * c) @ scene.law_rows[np.ix_(laws, block.regime.index)]

    @property
    def intervals(self) -> int:
        """Number of intervals."""
        return len(self.coefs)

    def place(self, tau: float) -> tuple[int, float]:
        """Interval that holds local time `tau`, and the time since it began."""
        i = min(int(tau / self.length), self.intervals - 1)
        return i, tau - i * self.length

    def grid(self, h: float) -> Array:
        """Local times: every interval's start and steps of `h` within it, and the end of the window."""
        count = int(np.ceil(self.length / h * (1 - 1e-12)))
        within = h * np.arange(count)
        return np.append(
            (self.length * np.arange(self.intervals)[:, None] + within).ravel(),
            self.length * self.intervals,
        )

    def functionals(self, h: float, bending: bool) -> tuple[Array, Array, Array]:
        """Value, rate and (with `bending`, else zero) second rate of all rows on `grid`,
        shape (n_rows, n_times).
        """
        part, n = self.partition, self.intervals
        count = int(np.ceil(self.length / h * (1 - 1e-12)))
        self.h, self.count = h, count
        t = h * np.arange(count)
        value = np.repeat(part.row_constants[:, None], n * count + 1, axis=1)
        rate, second = np.zeros_like(value), np.zeros_like(value)
        if part.known:
            for order, out in enumerate((value, rate, second)):
                out += self._along(self.coefs @ part.row_inputs.T, t, order)
        for block in part.blocks:
            flow, w, m = block.regime.flow, block.regime.watched, len(block.regime.watched)
            block.samples = samples = flow.samples(block.qs[:, :-1], block.gs, h, count)
            if not m:
                continue
            flat = samples.reshape(len(samples), n * count)
            states = stacked(np.concatenate([flat, block.qs[:, -1:]], axis=1))
            if block.regime.reactions is not None:
                self._react(block, states, t, value, rate)
            on_q = block.regime.on_q
            both = on_q[: 2 * m] @ states
            value[w] += both[:m]
            rate[w] += both[m:]
            if bending:
                bend = on_q[2 * m :] @ states
                second[w] += bend + self._along(stacked(block.gs, -1) @ on_q[m : 2 * m].T, t, 0)
            if block.ps is not None and flow.u_p is not None:
                self._direct(block, t, value, rate, second)
        return value, rate, second

    def _along(self, coefs: Array, t: NDArray[Any], order: int) -> Array:
        """Polynomials (n_intervals, degree + 1, n) at times `t` of each interval and at the end of
        the window, shape (n, n_intervals * n_times + 1).
        """
        end = polynomial.value(coefs[-1], self.length, order)
        return np.concatenate([polynomial.along(coefs, t, order), end[:, None]], axis=1)

    def _direct(self, block: Block, t: NDArray[Any], value: Array, rate: Array, second: Array) -> None:
        """Add what forces on massless freedoms move directly."""
        flow, w = block.regime.flow, block.regime.watched
        assert block.ps is not None and flow.u_p is not None and flow.space.v_p is not None
        u_p, v_p = block.regime.rows @ flow.u_p, block.regime.rows @ flow.space.v_p
        force, slope, bend = (self._along(block.ps, t, order) for order in range(3))
        value[w] += u_p @ force
        rate[w] += v_p @ force + u_p @ slope
        second[w] += v_p @ slope + u_p @ bend

    def _react(self, block: Block, states: Array, t: NDArray[Any], value: Array, rate: Array) -> None:
        """Put in the forces of closed rigid contacts."""
        flow, r = block.regime.flow, block.regime.reactions
        assert block.ps is not None and r is not None
        force, slope, bend = (self._along(block.ps, t, order) for order in range(3))
        value[r.place] = on_stacked(r.on_q) @ states + r.on_p @ force + r.on_rate @ slope
        rate[r.place] = (
            on_stacked(flow.onward(r.on_q)) @ states
            + self._along((block.gs @ r.on_q.T).real, t, 0)
            + r.on_p @ slope
            + r.on_rate @ bend
        )

    def at(self, row: int, tau: float) -> tuple[float, float, float]:
        """Value, rate and second rate of one row at local time `tau`, by its Taylor series about the grid
        point before: what polishing asks for again and again.
        """
        i, tau = self.place(tau)
        cell = min(int(tau / self.h), self.count - 1)
        arc = self._arcs.get((row, i, cell))
        if arc is None:
            arc = self._arcs[row, i, cell] = self._arc(row, i, cell).tolist()
        x = tau / self.h - cell
        value = rate = second = 0.0
        for c in arc:  # from the highest power: Horner's scheme for the value and both derivatives
            second = second * x + rate
            rate = rate * x + value
            value = value * x + c
        return value, rate / self.h, 2.0 * second / self.h**2

    def _arc(self, row: int, interval: int, cell: int) -> Array:
        """Taylor series of one row about a grid point, in powers of grid steps, the highest power first."""
        part, h, t = self.partition, self.h, self.h * cell
        out = np.zeros(TERMS)
        out[0] = part.row_constants[row]
        known = self.coefs[interval] @ part.row_inputs[row]
        for block in part.blocks:
            r, own = block.regime, block.regime.place[row]
            if r.reactions is not None and row in r.reactions.place:
                assert block.ps is not None
                n = int(np.argmax(r.reactions.place == row))
                on_q, p = r.reactions.on_q[n], block.ps[interval]
                known = p @ r.reactions.on_p[n]
                known[:-1] += (p[1:] @ r.reactions.on_rate[n]) * np.arange(1, len(p))
            elif own >= 0:
                on_q = r.on_u[own]
                if block.ps is not None and r.flow.u_p is not None:
                    known = known + block.ps[interval] @ (r.rows[own] @ r.flow.u_p)
            else:
                continue
            g = polynomial.shift(block.gs[interval], t)
            out += r.flow.taylor(on_q, block.samples[:, interval, cell], g, h)
        out[: len(known)] += polynomial.shift(known, t) * h ** np.arange(len(known))
        return out[::-1]

    def all_at(self, tau: float) -> tuple[Array, Array, Array]:
        """Value, rate and second rate of all rows at local time `tau`, shape (n_rows,) each."""
        part = self.partition
        i, tau = self.place(tau)
        value = part.row_constants.copy()
        rate, second = np.zeros_like(value), np.zeros_like(value)
        if part.known:
            offset = self.coefs[i] @ part.row_inputs.T
            for order, out in enumerate((value, rate, second)):
                out += polynomial.value(offset, tau, order)
        for block in part.blocks:
            r, g = block.regime, block.gs[i]
            w, m = r.watched, len(r.watched)
            if r.reactions is not None:
                value[r.reactions.place], rate[r.reactions.place] = self._reaction(block, i, tau)
            q = self.state(block, i, tau)
            d, v, x = (r.on_q @ stacked(q)).reshape(3, m)
            value[w] += d
            rate[w] += v
            second[w] += x + polynomial.value(stacked(g, -1) @ r.on_q[m : 2 * m].T, tau)
            if block.ps is not None and r.flow.u_p is not None:
                force, slope, bend = (polynomial.value(block.ps[i], tau, order) for order in (0, 1, 2))
                assert r.flow.space.v_p is not None  # stands where u_p does
                u_p, v_p = r.rows @ r.flow.u_p, r.rows @ r.flow.space.v_p
                value[w] += u_p @ force
                rate[w] += v_p @ force + u_p @ slope
                second[w] += v_p @ slope + u_p @ bend
        return value, rate, second

    def _reaction(self, block: Block, interval: int, tau: float) -> tuple[Array, Array]:
        """Forces of a block's closed rigid contacts and their rates."""
        flow, r = block.regime.flow, block.regime.reactions
        assert block.ps is not None and r is not None
        q, g = self.state(block, interval, tau), block.gs[interval]
        p, slope, bend = (polynomial.value(block.ps[interval], tau, order) for order in (0, 1, 2))
        return (
            (r.on_q @ q).real + r.on_p @ p + r.on_rate @ slope,
            (r.on_q @ flow.rate(q, g, tau)).real + r.on_p @ slope + r.on_rate @ bend,
        )

    def motion(self, interval: int, tau: float) -> tuple[Array, Array, Array]:
        """Displacement, velocity and acceleration of the unknowns at `tau` within an interval."""
        u, v, a = self.path(interval, np.array([tau]))
        return u[:, 0], v[:, 0], a[:, 0]

    def path(self, interval: int, times: Array) -> tuple[Array, Array, Array]:
        """`motion` at several times within an interval, shape (n, n_times) each."""
        one = slice(interval, interval + 1)

        def states(block: Block) -> NDArray[Any]:
            if len(times) == 1:  # the ends of intervals are known, other times recur
                return self.state(block, interval, float(times[0]))[:, None, None]
            return block.regime.flow.path(block.qs[:, interval], block.gs[interval], times)[:, None]

        return self._motions(one, times, states)

    def ends(self, count: int) -> tuple[Array, Array, Array]:
        """`motion` at the ends of the first `count` intervals, shape (n, count) each."""
        t = np.array([self.length])
        return self._motions(slice(count), t, lambda block: block.qs[:, 1 : count + 1, None])

    def between(self, each: int, end: float) -> tuple[Array, Array, Array, Array]:
        """Local times and `motion` at every `each`-th point of an interval's grid, up to `end`;
        shape (n_times,) and (n, n_times).

        `functionals` was asked on this grid.
        """
        chosen, within = slice(self.place(end)[0] + 1), self.h * np.arange(0, self.count, each)
        starts = self.length * np.arange(self.intervals)[chosen]
        t = (starts[:, None] + within).ravel()
        motion = self._motions(chosen, within, lambda block: block.samples[:, chosen, ::each])
        u, v, a = (x[:, t <= end] for x in motion)
        return t[t <= end], u, v, a

    def _motions(
        self, intervals: slice, t: NDArray[Any], states: Callable[[Block], NDArray[Any]]
    ) -> tuple[Array, Array, Array]:
        """`motion` at local times `t` within each of some intervals, shape (n, n_intervals * n_times) each.

        `states` gives a block's q there, shape (n_q, n_intervals, n_times).
        """
        count = len(range(*intervals.indices(self.intervals))) * len(t)
        out = np.zeros((3, self.partition.scene.size, count))
        for block in self.partition.blocks:
            flow, index, q = block.regime.flow, block.regime.index, states(block)
            motion, n = block.regime.motion, len(index)
            own = (motion @ stacked(q.reshape(len(q), count))).reshape(3, n, count)
            own[2] += polynomial.along(stacked(block.gs[intervals], -1) @ motion[n : 2 * n].T, t)
            u_p, v_p = flow.u_p, flow.space.v_p
            if block.ps is not None and u_p is not None and v_p is not None:
                force, slope, bend = (polynomial.along(block.ps[intervals], t, k) for k in range(3))
                own[0] += u_p @ force
                own[1] += v_p @ force + u_p @ slope
                own[2] += v_p @ slope + u_p @ bend
            out[:, index] = own
        u, v, a = out
        return u, v, a

    def state(self, block: Block, interval: int, tau: float) -> NDArray[Any]:
        """State q of a block at `tau` within an interval."""
        if tau == self.length:
            return block.qs[:, interval + 1]
        return block.regime.flow.at(block.qs[:, interval], block.gs[interval], tau)

    def accept(self, interval: int, tau: float) -> None:
        """Let the blocks go on from `tau` within an interval."""
        for block in self.partition.blocks:
            block.q = self.state(block, interval, tau)

    def works(self, intervals: slice, length: float) -> tuple[Array, Array, dict[int, Array]]:
        """Work in the structure's dashpots, input, and losses in the laws' dashpots by law,
        over `length` of some intervals each.
        """
        scene = self.partition.scene
        count = len(range(*intervals.indices(self.intervals)))
        damping, input_ = np.zeros(count), np.zeros(count)
        laws: dict[int, Array] = {}
        for block in self.partition.blocks:
            r = block.regime
            ps = None if block.ps is None else block.ps[intervals]
            done = r.meter.measures(
                block.qs[:, :-1][:, intervals],
                block.gs[intervals],
                length,
                self.coefs[intervals],
                scene.constant[r.index],
                ps,
            )
            damping, input_ = damping + done.damping, input_ + done.input
            laws.update(done.laws)
        return damping, input_, laws

    def impulse(self, law: int, interval: int, tau: float) -> float:
        """Integral of a law's force over the first `tau` of an interval [F T]."""
        b, scene = self.branches[law], self.partition.scene
        if b.held:
            return self._held_impulse(law, interval, tau)
        e = self.coefs[interval] @ scene.law_inputs[law]
        area = sum(e[k] * tau ** (k + 1) / (k + 1) for k in range(len(e)))
        change = sum(e[k] * tau**k for k in range(1, len(e)))
        for block in self.partition.blocks:
            row = scene.law_rows[law, block.regime.index]
            if not np.any(row):
                continue
            flow, q, g = block.regime.flow, block.qs[:, interval], block.gs[interval]
            area += float((row @ (flow.u_q @ flow.integral(q, g, tau))).real)
            change += float((row @ (flow.u_q @ (self.state(block, interval, tau) - q))).real)
            if block.ps is not None and flow.u_p is not None:
                p = block.ps[interval]
                area += float(row @ flow.u_p @ sum(p[k] * tau ** (k + 1) / (k + 1) for k in range(len(p))))
                change += float(row @ flow.u_p @ (polynomial.value(p, tau) - p[0]))
        return float(b.force0 * tau + b.stiffness * area + b.damping * change)

    def _held_impulse(self, law: int, interval: int, tau: float) -> float:
        """`impulse` of a closed rigid contact."""
        for block in self.partition.blocks:
            r = block.regime.reactions
            if r is None or law not in r.laws:
                continue
            assert block.ps is not None
            p, flow = block.ps[interval], block.regime.flow
            area = (r.on_q @ flow.integral(block.qs[:, interval], block.gs[interval], tau)).real
            area = area + r.on_p @ sum(p[k] * tau ** (k + 1) / (k + 1) for k in range(len(p)))
            area += r.on_rate @ (polynomial.value(p, tau) - p[0])
            return float(area[r.laws == law][0])
        return 0.0
