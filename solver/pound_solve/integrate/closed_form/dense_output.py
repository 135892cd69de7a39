"""The motion of all blocks over a window of time: intervals within each of which the excitation is
one polynomial, and arcs of them that are looked at on a grid.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_solve.integrate.closed_form.propagator import TERMS, on_stacked, stacked
from pound_solve.integrate.closed_form.subsystems import Subsystem, Subsystems
from pound_solve.laws.automaton import Branch
from pound_solve.numerics import polynomial
from pound_solve.numerics.types import Array, Flags, Index


class DenseOutput:
    """The motion over a few intervals.

    Parameters
    ----------
    subsystems : Partition
    branches : sequence of Branch
    coefs : ndarray, shape (n, degree + 1, n_inputs)
        Inputs in each interval, about its start.
    lengths : ndarray, shape (n,)
        Of the intervals [T]; all but the first are equal.
    """

    def __init__(
        self, subsystems: Subsystems, branches: Sequence[Branch], coefs: Array, lengths: Array
    ) -> None:
        self.subsystems, self.branches, self.coefs, self.lengths = subsystems, branches, coefs, lengths
        self.edges = np.concatenate([[0.0], np.cumsum(lengths)])
        system = subsystems.system
        for subsystem in subsystems.active:
            propagator = subsystem.decomposition.propagator
            if not system.total and propagator.u_p is None:
                subsystem.gs = propagator.forcing(coefs, subsystem.constant)
            else:
                ps = coefs @ propagator.inputs.T
                n = len(subsystem.constant)
                ps[:, 0, :n] += subsystem.constant
                ps[..., :n] += self._supports(subsystem)
                reactions = subsystem.decomposition.reactions
                subsystem.ps = ps if reactions is None else reactions.extended(ps, coefs)
                subsystem.gs = propagator.push(subsystem.ps)
            subsystem.qs = propagator.march(subsystem.q, subsystem.gs, lengths)

    def _supports(self, subsystem: Subsystem) -> Array:
        """Forces of laws that reach to moved supports, whose deformation has a known part,
        (n, degree + 1, n_unknowns).
        """
        system, laws = self.subsystems.system, subsystem.decomposition.laws
        e = self.coefs @ system.law_inputs[laws].T
        rate = np.zeros_like(e)
        rate[:, :-1] = e[:, 1:] * np.arange(1, e.shape[1])[:, None]
        k = np.array([self.branches[i].stiffness for i in laws])
        c = np.array([self.branches[i].damping for i in laws])
        return -(e * k + rate * c) @ system.law_rows[np.ix_(laws, subsystem.decomposition.index)]

    @property
    def intervals(self) -> int:
        """Number of intervals."""
        return len(self.coefs)

    @property
    def length(self) -> float:
        """Of the whole window [T]."""
        return float(self.edges[-1])

    def place(self, tau: float) -> tuple[int, float]:
        """Interval that holds local time `tau`, and the time since it began."""
        i = min(max(int(np.searchsorted(self.edges, tau, "right")) - 1, 0), self.intervals - 1)
        return i, tau - float(self.edges[i])

    def bends(self) -> Array:
        """Bounds of the second derivatives of the values and of the rates of all rows in each interval,
        shape (2, n_rows, n): no mode can do more than it does at its start, but for what pushes it.
        """
        part = self.subsystems
        out = np.zeros((2, len(part.rows), self.intervals))
        if part.known:
            e = np.abs(self.coefs @ part.row_inputs.T)
            for order in (0, 1):
                out[order] += polynomial.values(e, self.lengths, order + 2).T
        for subsystem in part.active:
            r = subsystem.decomposition
            bends = r.propagator.bends(subsystem.qs[:, :-1], subsystem.gs, self.lengths)
            if r.reactions is not None:
                out[:, r.reactions.place] = np.inf  # as the forces of rigid contacts
            if not np.isfinite(bends).all():  # nothing is known
                out[:, r.watched] = np.inf
                continue
            for order in (0, 1):
                out[order, r.watched] += r.size @ bends[order]
                if subsystem.ps is not None and r.propagator.u_p is not None:
                    p = polynomial.values(np.abs(subsystem.ps), self.lengths, order + 2)
                    out[order, r.watched] += np.abs(r.rows @ r.propagator.u_p) @ p.T
        return out

    def all(self, h: float, bending: bool) -> GridSamples:
        """All intervals, each an arc seen at steps of `h`."""
        interval = np.arange(self.intervals)
        ends = [(subsystem.qs[:, :-1], subsystem.qs[:, 1:]) for subsystem in self.subsystems.active]
        count = int(np.ceil(self.lengths.max() / h * (1 - 1e-12)))
        return GridSamples(self, interval, np.zeros(len(interval)), self.lengths, ends, (h, count), bending)

    def all_at(self, tau: float) -> tuple[Array, Array, Array]:
        """Value, rate and second rate of all rows at local time `tau`, shape (n_rows,) each."""
        interval, within = self.place(tau)
        ends = [(self.state(b, interval, within)[:, None],) * 2 for b in self.subsystems.active]
        at = np.array([interval]), np.array([within]), np.zeros(1)
        point = GridSamples(self, *at, ends, (0.0, 0), True)
        return point.value[:, 0, 0], point.rate[:, 0, 0], point.second[:, 0, 0]

    def motion(self, interval: int, tau: float) -> tuple[Array, Array, Array]:
        """Displacement, velocity and acceleration of the unknowns at `tau` within an interval."""
        u, v, a = self.path(interval, np.array([tau]))
        return u[:, 0], v[:, 0], a[:, 0]

    def path(self, interval: int, times: Array, shown: bool = False) -> tuple[Array, Array, Array]:
        """`motion` at several times of an interval, shape (n, n_times) each; `shown` as in `_motions`."""

        def states(subsystem: Subsystem) -> NDArray[Any]:
            if len(times) == 1:  # the ends of intervals are known, other times recur
                return self.state(subsystem, interval, float(times[0]))[:, None, None]
            return subsystem.decomposition.propagator.path(
                subsystem.qs[:, interval], subsystem.gs[interval], times
            )[:, None]

        return self._motions(np.array([interval]), times[None], states, shown)

    def at(self, times: Array) -> tuple[Array, Array, Array]:
        """`between` at several local times, shape (n, n_times) each."""
        interval = np.clip(np.searchsorted(self.edges, times, "right") - 1, 0, self.intervals - 1)
        out = np.zeros((3, self.subsystems.system.size, len(times)))
        for i in np.unique(interval).tolist():
            here = interval == i
            out[:, :, here] = self.path(i, times[here] - self.edges[i], shown=True)
        u, v, a = out
        return u, v, a

    def ends(self, chosen: Index) -> tuple[Array, Array, Array]:
        """`motion` at the ends of some intervals, shape (n, n_chosen) each."""
        t = self.lengths[chosen, None]
        return self._motions(chosen, t, lambda subsystem: subsystem.qs[:, chosen + 1, None])

    def between(self, h: float, end: float) -> tuple[Array, Array, Array, Array]:
        """Local times from step to step of `h` in each interval up to `end`, and `motion` then of what
        the envelopes look at, zero elsewhere; shape (n_times,) and (n, n_times).
        """
        last = self.place(end)[0]
        count = int(np.ceil(self.lengths[: last + 1].max() / h * (1 - 1e-12)))
        t = np.tile(h * np.arange(count), (last + 1, 1))
        chosen = np.arange(last + 1)

        def states(subsystem: Subsystem) -> NDArray[Any]:
            return subsystem.decomposition.propagator.samples(
                subsystem.qs[:, chosen], subsystem.gs[chosen], h, count
            )

        motion = self._motions(chosen, t, states, shown=True)
        seen = ((t < self.lengths[chosen, None]) & (self.edges[chosen, None] + t <= end)).ravel()
        u, v, a = (x[:, seen] for x in motion)
        return (self.edges[chosen, None] + t).ravel()[seen], u, v, a

    def _motions(
        self,
        intervals: Index,
        t: Array,
        states: Callable[[Subsystem], NDArray[Any]],
        shown: bool = False,
    ) -> tuple[Array, Array, Array]:
        """`motion` at times `t`, shape (n_intervals, n_times), within some intervals each; shape
        (n, n_intervals * n_times) each. With `shown` that of what the envelopes look at.

        `states` gives a block's q there, shape (n_q, n_intervals, n_times).
        """
        out = np.zeros((3, self.subsystems.system.size, t.size))
        for subsystem in self.subsystems.active:
            r = subsystem.decomposition
            index, motion = (r.index[r.shown], r.motion_shown) if shown else (r.index, r.motion)
            if not len(index):
                continue
            q, n, propagator = states(subsystem), len(index), r.propagator
            own = (motion @ stacked(q.reshape(len(q), t.size))).reshape(3, n, *t.shape)
            own[2] += polynomial.on(stacked(subsystem.gs[intervals], -1) @ motion[n : 2 * n].T, t)
            u_p, v_p = propagator.u_p, propagator.v_p
            if subsystem.ps is not None and u_p is not None and v_p is not None:
                if shown:
                    u_p, v_p = u_p[r.shown], v_p[r.shown]
                own += directly(u_p, v_p, subsystem.ps[intervals], t)
            out[:, index] = own.reshape(3, n, t.size)
        u, v, a = out
        return u, v, a

    def state(self, subsystem: Subsystem, interval: int, tau: float) -> NDArray[Any]:
        """State q of a block at `tau` within an interval."""
        if tau == self.lengths[interval]:
            return subsystem.qs[:, interval + 1]
        return subsystem.decomposition.propagator.at(subsystem.qs[:, interval], subsystem.gs[interval], tau)

    def accept(self, interval: int, tau: float) -> None:
        """Let the blocks go on from `tau` within an interval."""
        for subsystem in self.subsystems.active:
            subsystem.q = self.state(subsystem, interval, tau)

    def impulse(self, law: int, interval: int, tau: float) -> float:
        """Integral of a law's force over the first `tau` of an interval [F T]."""
        b, system = self.branches[law], self.subsystems.system
        if b.held:
            return self._held_impulse(law, interval, tau)
        e = self.coefs[interval] @ system.law_inputs[law]
        area = sum(e[k] * tau ** (k + 1) / (k + 1) for k in range(len(e)))
        change = sum(e[k] * tau**k for k in range(1, len(e)))
        for subsystem in self.subsystems.active:
            row = system.law_rows[law, subsystem.decomposition.index]
            if not np.any(row):
                continue
            propagator, q, g = (
                subsystem.decomposition.propagator,
                subsystem.qs[:, interval],
                subsystem.gs[interval],
            )
            area += float((row @ (propagator.u_q @ propagator.integral(q, g, tau))).real)
            change += float((row @ (propagator.u_q @ (self.state(subsystem, interval, tau) - q))).real)
            if subsystem.ps is not None and propagator.u_p is not None:
                p = subsystem.ps[interval]
                area += float(
                    row @ propagator.u_p @ sum(p[k] * tau ** (k + 1) / (k + 1) for k in range(len(p)))
                )
                change += float(row @ propagator.u_p @ (polynomial.value(p, tau) - p[0]))
        return float(b.force0 * tau + b.stiffness * area + b.damping * change)

    def _held_impulse(self, law: int, interval: int, tau: float) -> float:
        """`impulse` of a closed rigid contact."""
        for subsystem in self.subsystems.active:
            r = subsystem.decomposition.reactions
            if r is None or law not in r.laws:
                continue
            assert subsystem.ps is not None
            p, propagator = subsystem.ps[interval], subsystem.decomposition.propagator
            area = (
                r.on_q @ propagator.integral(subsystem.qs[:, interval], subsystem.gs[interval], tau)
            ).real
            area = area + r.on_p @ sum(p[k] * tau ** (k + 1) / (k + 1) for k in range(len(p)))
            area += r.on_rate @ (polynomial.value(p, tau) - p[0])
            return float(area[r.laws == law][0])
        return 0.0


def directly(u_p: Array, v_p: Array, ps: Array, t: Array) -> Array:
    """What forces on massless DOFs move directly: value, rate and second rate of rows,
    shape (3, n_rows, *t.shape), with force polynomials of some intervals at times `t` of each.
    """
    force, slope, bend = (polynomial.on(ps, t, order) for order in range(3))
    u, v = (lambda x, rows=rows: np.tensordot(rows, x, 1) for rows in (u_p, v_p))
    return np.stack([u(force), v(force) + u(slope), v(slope) + u(bend)])


class GridSamples:
    """Arcs of a window on a grid: each is seen at its start, at steps of `h` and at its end.

    Parameters
    ----------
    window : Window
    interval : ndarray of int, shape (n,)
        That the arcs lie in.
    since, width : ndarray, shape (n,)
        Times from the intervals' starts to theirs, and their lengths, `count` steps of h at most;
        points beyond are the end once more.
    ends : list of pairs of ndarray, shape (n_q, n)
        States of every block at the arcs' starts and ends.
    grid : (h, count)
    bending : bool
        Whether second rates are asked for; else they are zero.

    Attributes
    ----------
    t : ndarray, shape (n, count + 1)
        Local times of the window.
    value, rate, second : ndarray, shape (n_rows, n, count + 1)
    """

    def __init__(
        self,
        window: DenseOutput,
        interval: Index,
        since: Array,
        width: Array,
        ends: Sequence[tuple[NDArray[Any], NDArray[Any]]],
        grid: tuple[float, int],
        bending: bool,
    ) -> None:
        self.window, self.interval, self.since, self.h = window, interval, since, grid[0]
        h, count = grid
        self.width = width
        self.within = np.minimum(h * np.arange(count + 1), width[:, None])
        self.within[:, -1] = width
        self.t = (window.edges[interval] + since)[:, None] + self.within
        self._series: dict[tuple[int, int, int], list[float]] = {}
        part, m = window.subsystems, len(window.subsystems.rows)
        shape = m, len(interval), count + 1
        self.value = np.zeros(shape) + part.row_constants[:, None, None]
        self.rate, self.second = np.zeros(shape), np.zeros(shape)
        self.samples: list[NDArray[Any]] = []
        self.pushed: list[NDArray[Any]] = []
        self.coefs = self._about(window.coefs)
        if part.known:
            for order, out in enumerate((self.value, self.rate, self.second)):
                out += polynomial.on(self.coefs @ part.row_inputs.T, self.within, order)
        over = self.within[:, :-1] >= width[:, None]
        for subsystem, (first, last) in zip(part.active, ends):
            gs = self._about(subsystem.gs)
            seen = (
                subsystem.decomposition.propagator.samples(first, gs, h, count)
                if count
                else last[:, :, None][:, :, :0]
            )
            if over.any():
                seen = np.where(over, last[:, :, None], seen)
            seen = np.concatenate([seen, last[:, :, None]], axis=2)
            self.samples.append(seen)
            self.pushed.append(gs)
            self._add(subsystem, seen, gs, bending)

    def _about(self, coefs: NDArray[Any]) -> NDArray[Any]:
        """Polynomials of the intervals about the arcs' starts."""
        own = coefs[self.interval]
        if not self.since.any():
            return own
        return polynomial.shift(own.swapaxes(0, 1), self.since[:, None]).swapaxes(0, 1)

    def _add(self, subsystem: Subsystem, seen: NDArray[Any], gs: NDArray[Any], bending: bool) -> None:
        """Add what a block moves."""
        r = subsystem.decomposition
        w, m, propagator = r.watched, len(r.watched), r.propagator
        if not m and r.reactions is None:
            return
        shape = seen.shape[1:]
        states = stacked(seen.reshape(len(seen), shape[0] * shape[1]))
        ps = None if subsystem.ps is None else self._about(subsystem.ps)
        if r.reactions is not None:
            assert ps is not None
            x = r.reactions
            force, slope, bend = (polynomial.on(ps, self.within, order) for order in range(3))
            by, by_rate = (lambda p, rows=rows: np.tensordot(rows, p, 1) for rows in (x.on_p, x.on_rate))
            self.value[x.place] = (
                (on_stacked(x.on_q) @ states).reshape(-1, *shape) + by(force) + by_rate(slope)
            )
            self.rate[x.place] = (
                (on_stacked(propagator.onward(x.on_q)) @ states).reshape(-1, *shape)
                + polynomial.on((gs @ x.on_q.T).real, self.within)
                + by(slope)
                + by_rate(bend)
            )
        orders = 3 if bending else 2
        moved = (r.on_q[: orders * m] @ states).reshape(orders, m, *shape)
        self.value[w] += moved[0]
        self.rate[w] += moved[1]
        if bending:
            push = stacked(gs, -1) @ r.on_q[m : 2 * m].T
            self.second[w] += moved[2] + polynomial.on(push, self.within)
        if ps is not None and propagator.u_p is not None and propagator.v_p is not None:
            more = directly(r.rows @ propagator.u_p, r.rows @ propagator.v_p, ps, self.within)
            for out, x in zip((self.value, self.rate, self.second), more):
                out[w] += x

    @property
    def widths(self) -> Array:
        """Lengths of the cells from point to point, shape (n, count)."""
        return np.diff(self.within)

    def closer(self, cells: Flags, h: float, bending: bool) -> GridSamples:
        """Some cells from point to point, shape (n, count), as arcs of their own, seen at steps of `h`."""
        arc, cell = np.nonzero(cells)
        ends = [(seen[:, arc, cell], seen[:, arc, cell + 1]) for seen in self.samples]
        since, width = self.since[arc] + self.within[arc, cell], self.widths[arc, cell]
        count = max(1, round(self.h / h))
        return GridSamples(self.window, self.interval[arc], since, width, ends, (h, count), bending)

    def cut(self, arc: int, cell: int, tau: float, now: tuple[Array, Array, Array]) -> None:
        """End the last of the arcs, `arc`, within a cell at local time `tau`, where the rows are `now`."""
        self.t[arc, cell + 1 :] = tau
        self.t[arc + 1 :] = tau
        for x, own in zip((self.value, self.rate, self.second), now):
            x[:, arc, cell + 1 :] = own[:, None]
            x[:, arc + 1 :] = own[:, None, None]

    def at(self, row: int, arc: int, cell: int, tau: float) -> tuple[float, float, float]:
        """Value, rate and second rate of one row at local time `tau` in a cell, by its Taylor series
        about the point before: what polishing asks for again and again.
        """
        series = self._series.get((row, arc, cell))
        if series is None:
            series = self._series[row, arc, cell] = self._expand(row, arc, cell).tolist()
        x = (tau - float(self.t[arc, cell])) / self.h
        value = rate = second = 0.0
        for c in series:  # from the highest power: Horner's scheme for the value and both derivatives
            second = second * x + rate
            rate = rate * x + value
            value = value * x + c
        return value, rate / self.h, 2.0 * second / self.h**2

    def _expand(self, row: int, arc: int, cell: int) -> Array:
        """Taylor series of one row about a point, in powers of h, the highest power first."""
        part, h, t = self.window.subsystems, self.h, float(self.within[arc, cell])
        out = np.zeros(TERMS)
        out[0] = part.row_constants[row]
        known = self.coefs[arc] @ part.row_inputs[row]
        for subsystem, seen, pushed in zip(part.active, self.samples, self.pushed):
            r, own = subsystem.decomposition, subsystem.decomposition.place[row]
            if r.reactions is not None and row in r.reactions.place:
                assert subsystem.ps is not None
                n = int(np.argmax(r.reactions.place == row))
                on_q, p = r.reactions.on_q[n], self._about(subsystem.ps)[arc]
                known = p @ r.reactions.on_p[n]
                known[:-1] += (p[1:] @ r.reactions.on_rate[n]) * np.arange(1, len(p))
            elif own >= 0:
                on_q = r.on_u[own]
                if subsystem.ps is not None and r.propagator.u_p is not None:
                    known = known + self._about(subsystem.ps)[arc] @ (r.rows[own] @ r.propagator.u_p)
            else:
                continue
            g = polynomial.shift(pushed[arc], t)
            out += r.propagator.taylor(on_q, seen[:, arc, cell], g, h)
        out[: len(known)] += polynomial.shift(known, t) * h ** np.arange(len(known))
        return out[::-1]
