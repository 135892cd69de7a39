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
from pound_solve.integrate.flow import Flow, Mechanism, make_flow
from pound_solve.laws import Branch
from pound_solve.scene import Scene

Array = NDArray[np.float64]
Key = tuple[Any, ...]


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
    uv_rows : ndarray, shape (2 n_watched, n_q)
        The rows on u_q above those on v_q.
    """

    index: NDArray[np.intp]
    laws: NDArray[np.intp]
    flow: Flow
    watched: NDArray[np.intp]
    place: list[int]
    rows: Array
    uv_rows: NDArray[Any]
    meter: work.Meter


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
    row_inputs : ndarray, shape (n_rows, n_inputs)
    row_constants : ndarray, shape (n_rows,)
    """

    def __init__(self, scene: Scene, rows: Array, row_inputs: Array, row_constants: Array) -> None:
        self.scene, self.rows, self.row_inputs, self.row_constants = scene, rows, row_inputs, row_constants
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

    def form(self, branches: Sequence[Branch], u: Array, v: Array) -> None:
        """Form the blocks that the branches ask for at displacement `u`, velocity `v`;
        keep those that go on.

        Raises
        ------
        Mechanism
            Massless freedoms that nothing holds; its shape is over all unknowns.
        """
        scene = self.scene
        labels = self._base.copy()
        for i, (s, b) in enumerate(zip(scene.structure.laws, branches)):
            if s.is_contact and (b.stiffness or b.damping):
                parts = np.unique(labels[scene.law_rows[i] != 0])
                if len(parts):
                    labels[np.isin(labels, parts)] = parts[0]
        old = {b.key: b for b in self.blocks}
        acting = [i for i, b in enumerate(branches) if b.stiffness or b.damping or b.force0]
        blocks = []
        for label in np.unique(labels):
            index = np.flatnonzero(labels == label)
            laws = np.array([i for i in acting if np.any(scene.law_rows[i, index])], np.intp)
            key = (
                int(label),
                len(index),
                *((int(i), branches[i].stiffness, branches[i].damping) for i in laws),
            )
            constant = scene.constant[index] - scene.law_rows[np.ix_(laws, index)].T @ [
                branches[i].force0 for i in laws
            ]
            if key in old:
                old[key].constant = constant
                blocks.append(old[key])
                continue
            if key not in self.regimes:
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
        try:
            flow = make_flow(scene.mass[grid], c, k, scene.inputs[index])
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
        return Regime(
            index, laws, flow, watched, place, rows, np.vstack([rows @ flow.u_q, rows @ flow.v_q]), meter
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
        scene = partition.scene
        for block in partition.blocks:
            flow = block.regime.flow
            if not scene.total and flow.u_p is None:
                block.gs = flow.forcing(coefs, block.constant)
            else:
                ps = coefs @ flow.inputs.T
                ps[:, 0] += block.constant
                block.ps = ps + self._supports(block)
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
        part = self.partition
        n = self.intervals
        count = int(np.ceil(self.length / h * (1 - 1e-12)))
        t = h * np.arange(count)
        value = np.repeat(part.row_constants[:, None], n * count + 1, axis=1)
        rate, second = np.zeros_like(value), np.zeros_like(value)
        if part.known:
            offset = (
                self.coefs @ part.row_inputs.T
            )  # polynomials of what the inputs add, (n, degree + 1, n_rows)
            for out, order in ((value, 0), (rate, 1), (second, 2)):
                for i in range(n):
                    out[:, i * count : (i + 1) * count] += np.array(
                        [polynomial.value(offset[i], x, order) for x in t]
                    ).T
                out[:, -1] += polynomial.value(offset[-1], self.length, order)
        for block in part.blocks:
            flow, w, m = block.regime.flow, block.regime.watched, len(block.regime.watched)
            block.samples = samples = flow.samples(block.qs[:, :-1], block.gs, h, count)
            if not m:
                continue
            flat = samples.reshape(len(samples), n * count)
            last = block.qs[:, -1]
            both = (block.regime.uv_rows @ np.concatenate([flat, last[:, None]], axis=1)).real
            value[w] += both[:m]
            rate[w] += both[m:]
            if bending:
                bend = flow.rates(samples, block.gs, t).reshape(len(samples), n * count)
                end = flow.rate(last, block.gs[-1], self.length)
                second[w] += (block.regime.uv_rows[m:] @ np.concatenate([bend, end[:, None]], axis=1)).real
            if block.ps is not None and flow.u_p is not None:
                self._direct(block, t, value, rate, second)
        return value, rate, second

    def _direct(self, block: Block, t: NDArray[Any], value: Array, rate: Array, second: Array) -> None:
        """Add what forces on massless freedoms move directly."""
        flow, w = block.regime.flow, block.regime.watched
        assert block.ps is not None and flow.u_p is not None and flow.space.v_p is not None
        u_p, v_p = block.regime.rows @ flow.u_p, block.regime.rows @ flow.space.v_p
        times = [(i, x) for i in range(self.intervals) for x in t] + [(self.intervals - 1, self.length)]
        force, slope, bend = (
            np.array([polynomial.value(block.ps[i], x, order) for i, x in times]).T for order in (0, 1, 2)
        )
        value[w] += u_p @ force
        rate[w] += v_p @ force + u_p @ slope
        second[w] += v_p @ slope + u_p @ bend

    def at(self, row: int, tau: float) -> tuple[float, float, float]:
        """Value, rate and second rate of one row at local time `tau`:
        what polishing asks for again and again.
        """
        value, rate, second = self._evaluate(tau, row)
        return float(value[0]), float(rate[0]), float(second[0])

    def all_at(self, tau: float) -> tuple[Array, Array, Array]:
        """Value, rate and second rate of all rows at local time `tau`, shape (n_rows,) each."""
        return self._evaluate(tau, None)

    def _evaluate(self, tau: float, row: int | None) -> tuple[Array, Array, Array]:
        part = self.partition
        i, tau = self.place(tau)
        chosen = slice(None) if row is None else slice(row, row + 1)
        value = part.row_constants[chosen].copy()
        rate, second = np.zeros_like(value), np.zeros_like(value)
        if part.known:
            offset = self.coefs[i] @ part.row_inputs[chosen].T
            for out, order in ((value, 0), (rate, 1), (second, 2)):
                out += polynomial.value(offset, tau, order)
        for block in part.blocks:
            r = block.regime
            n = len(r.watched)
            if row is None:
                to: Any = r.watched
                own = slice(0, n)
            elif r.place[row] >= 0:
                to = slice(0, 1)
                own = slice(r.place[row], r.place[row] + 1)
            else:
                continue
            q = r.flow.at(block.qs[:, i], block.gs[i], tau)
            on_u, on_v = r.uv_rows[:n][own], r.uv_rows[n:][own]
            value[to] += (on_u @ q).real
            rate[to] += (on_v @ q).real
            second[to] += (on_v @ r.flow.rate(q, block.gs[i], tau)).real
            if block.ps is not None and r.flow.u_p is not None:
                force, slope, bend = (polynomial.value(block.ps[i], tau, order) for order in (0, 1, 2))
                assert r.flow.space.v_p is not None  # stands where u_p does
                u_p, v_p = r.rows[own] @ r.flow.u_p, r.rows[own] @ r.flow.space.v_p
                value[to] += u_p @ force
                rate[to] += v_p @ force + u_p @ slope
                second[to] += v_p @ slope + u_p @ bend
        return value, rate, second

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

    def between(self, h: float, each: int, end: float) -> tuple[Array, Array, Array, Array]:
        """Local times and `motion` at every `each`-th point of an interval's grid, up to `end`;
        shape (n_times,) and (n, n_times).

        `functionals` was asked on this grid.
        """
        count = int(np.ceil(self.length / h * (1 - 1e-12)))
        chosen, within = slice(self.place(end)[0] + 1), h * np.arange(0, count, each)
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
        n = len(range(*intervals.indices(self.intervals)))
        u, v, a = (np.zeros((self.partition.scene.size, n * len(t))) for _ in range(3))
        for block in self.partition.blocks:
            flow, index, q = block.regime.flow, block.regime.index, states(block)
            rate = flow.rates(q, block.gs[intervals], t)
            u[index], v[index], a[index] = (
                (x @ y.reshape(len(y), n * len(t))).real
                for x, y in ((flow.u_q, q), (flow.v_q, q), (flow.v_q, rate))
            )
            if block.ps is not None and flow.u_p is not None:
                u_p, v_p = flow.u_p, flow.space.v_p
                force, slope, bend = (
                    np.array([polynomial.value(p, float(x), k) for p in block.ps[intervals] for x in t]).T
                    for k in range(3)
                )
                u[index] += u_p @ force
                v[index] += v_p @ force + u_p @ slope
                a[index] += v_p @ slope + u_p @ bend
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
