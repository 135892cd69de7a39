"""Rows of a run sampled on a grid: values, rates and second rates on segments of a window, with Taylor
series between the points.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_solve.integrate.closed_form.dense_output import DenseOutput, direct_response
from pound_solve.integrate.closed_form.subsystems import Subsystem
from pound_solve.integrate.propagators.base import TAYLOR_TERMS, real_parts, real_rows
from pound_solve.integrate.tolerances import COUNT_ROUNDING
from pound_solve.numerics import polynomial
from pound_solve.numerics.types import Array, Flags, Index

#: states of every subsystem at the starts and ends of the segments
Ends = Sequence[tuple[NDArray[Any], NDArray[Any]]]


class GridSamples:
    """Rows on segments of a window, each sampled at its start, at steps of `h` and at its end.

    Parameters
    ----------
    dense : DenseOutput
    interval : ndarray of int, shape (n,)
        Interval of each segment.
    offset, span : ndarray, shape (n,)
        Times from the starts of the intervals to those of the segments, and lengths of the segments, at
        most `count` steps of h; points beyond the end repeat it.
    ends : sequence of pairs of ndarray, shape (n_q, n)
        States of every subsystem at the starts and ends of the segments.
    grid : (h, count)
    second_rates : bool
        Whether second rates are computed; otherwise they are zero.

    Attributes
    ----------
    t : ndarray, shape (n, count + 1)
        Local times in the window.
    value, rate, second : ndarray, shape (n_rows, n, count + 1)
    """

    def __init__(
        self,
        dense: DenseOutput,
        interval: Index,
        offset: Array,
        span: Array,
        ends: Ends,
        grid: tuple[float, int],
        second_rates: bool,
    ) -> None:
        self.dense, self.interval, self.offset, self.h = dense, interval, offset, grid[0]
        h, count = grid
        self.span = span
        self.local = np.minimum(h * np.arange(count + 1), span[:, None])
        self.local[:, -1] = span
        self.t = (dense.edges[interval] + offset)[:, None] + self.local
        self._series: dict[tuple[int, int, int], list[float]] = {}
        subsystems, rows = dense.subsystems, dense.subsystems.rows
        shape = len(rows.rows), len(interval), count + 1
        self.value = np.zeros(shape) + rows.constants[:, None, None]
        self.rate, self.second = np.zeros(shape), np.zeros(shape)
        self.states: list[NDArray[Any]] = []
        self.forcing: list[NDArray[Any]] = []
        self.input_coefs = self._about_starts(dense.input_coefs)
        if subsystems.rows_have_inputs:
            for order, samples in enumerate((self.value, self.rate, self.second)):
                samples += polynomial.on(self.input_coefs @ rows.inputs.T, self.local, order)
        beyond = self.local[:, :-1] >= span[:, None]
        for subsystem, (first, last) in zip(subsystems.present, ends):
            forcing, end = self._about_starts(subsystem.forcing), last[:, :, None]
            states = (
                subsystem.decomposition.propagator.samples(first, forcing, h, count)
                if count
                else end[:, :, :0]
            )
            if beyond.any():
                states = np.where(beyond, end, states)
            states = np.concatenate([states, end], axis=2)
            self.states.append(states)
            self.forcing.append(forcing)
            self._add(subsystem, states, forcing, second_rates)

    @classmethod
    def of_window(cls, dense: DenseOutput, h: float, second_rates: bool) -> GridSamples:
        """Return all intervals of a window, each as a segment sampled at steps of `h`."""
        interval = np.arange(dense.intervals)
        ends = [(x.states[:, :-1], x.states[:, 1:]) for x in dense.subsystems.present]
        count = int(np.ceil(dense.lengths.max() / h * (1 - COUNT_ROUNDING)))
        offset = np.zeros(len(interval))
        return cls(dense, interval, offset, dense.lengths, ends, (h, count), second_rates)

    @classmethod
    def at_time(cls, dense: DenseOutput, tau: float) -> GridSamples:
        """Return a single point at local time `tau`, shape (n_rows, 1, 1), with second rates."""
        interval, local = dense.locate(tau)
        ends = [(dense.state(x, interval, local)[:, None],) * 2 for x in dense.subsystems.present]
        at = np.array([interval]), np.array([local]), np.zeros(1)
        return cls(dense, *at, ends, (0.0, 0), True)

    def refined(self, cells: Flags, h: float, second_rates: bool) -> GridSamples:
        """Return some cells from point to point, shape (n, count), as segments sampled at steps of `h`."""
        segment, cell = np.nonzero(cells)
        ends = [(x[:, segment, cell], x[:, segment, cell + 1]) for x in self.states]
        offset, span = self.offset[segment] + self.local[segment, cell], self.widths[segment, cell]
        count = max(1, round(self.h / h))
        return GridSamples(self.dense, self.interval[segment], offset, span, ends, (h, count), second_rates)

    def _about_starts(self, coefs: NDArray[Any]) -> NDArray[Any]:
        """Return the polynomials of the intervals about the starts of the segments."""
        pieces = coefs[self.interval]
        if not self.offset.any():
            return pieces
        return polynomial.shift(pieces.swapaxes(0, 1), self.offset[:, None]).swapaxes(0, 1)

    def _add(
        self, subsystem: Subsystem, states: NDArray[Any], forcing: NDArray[Any], second_rates: bool
    ) -> None:
        """Add the motion of a subsystem to the rows."""
        x = subsystem.decomposition
        n_rows, propagator = len(x.monitored), x.propagator
        if not n_rows and x.reactions is None:
            return
        shape = states.shape[1:]
        reals = real_parts(states.reshape(len(states), shape[0] * shape[1]))
        loads = None if subsystem.loads is None else self._about_starts(subsystem.loads)
        if x.reactions is not None:
            assert loads is not None
            self._add_reactions(subsystem, reals, forcing, loads)
        orders = 3 if second_rates else 2
        moved = (x.sampled_q[: orders * n_rows] @ reals).reshape(orders, n_rows, *shape)
        self.value[x.monitored] += moved[0]
        self.rate[x.monitored] += moved[1]
        if second_rates:
            forced = real_parts(forcing, -1) @ x.sampled_q[n_rows : 2 * n_rows].T
            self.second[x.monitored] += moved[2] + polynomial.on(forced, self.local)
        if loads is not None and propagator.u_p is not None and propagator.v_p is not None:
            direct = direct_response(x.rows @ propagator.u_p, x.rows @ propagator.v_p, loads, self.local)
            for samples, response in zip((self.value, self.rate, self.second), direct):
                samples[x.monitored] += response

    def _add_reactions(
        self, subsystem: Subsystem, reals: Array, forcing: NDArray[Any], loads: Array
    ) -> None:
        """Set the forces of the closed rigid contacts of a subsystem, and their rates."""
        x, propagator = subsystem.decomposition.reactions, subsystem.decomposition.propagator
        assert x is not None
        force, slope, curvature = (polynomial.on(loads, self.local, order) for order in range(3))
        by, by_rate = (partial(np.tensordot, rows, axes=1) for rows in (x.on_p, x.on_rate))
        shape = self.local.shape
        self.value[x.rows] = (real_rows(x.on_q) @ reals).reshape(-1, *shape) + by(force) + by_rate(slope)
        self.rate[x.rows] = (
            (real_rows(propagator.rate_rows(x.on_q)) @ reals).reshape(-1, *shape)
            + polynomial.on((forcing @ x.on_q.T).real, self.local)
            + by(slope)
            + by_rate(curvature)
        )

    @property
    def widths(self) -> Array:
        """Lengths of the cells from point to point, shape (n, count)."""
        return np.diff(self.local)

    def cut(self, segment: int, cell: int, tau: float, end: GridSamples) -> None:
        """End the samples at local time `tau` within a cell of a segment, with the single point `end`."""
        self.t[segment, cell + 1 :] = tau
        self.t[segment + 1 :] = tau
        for x, point in zip((self.value, self.rate, self.second), (end.value, end.rate, end.second)):
            x[:, segment, cell + 1 :] = point[:, 0]
            x[:, segment + 1 :] = point

    def at(self, row: int, segment: int, cell: int, tau: float) -> tuple[float, float, float]:
        """Return value, rate and second rate of one row at local time `tau` in a cell, by its Taylor series
        about the previous point, which Newton's iteration evaluates many times.
        """
        series = self._series.get((row, segment, cell))
        if series is None:
            series = self._series[row, segment, cell] = self._expand(row, segment, cell).tolist()
        x = (tau - float(self.t[segment, cell])) / self.h
        value = rate = second = 0.0
        for c in series:  # Horner's scheme for the value and both derivatives
            second = second * x + rate
            rate = rate * x + value
            value = value * x + c
        return value, rate / self.h, 2.0 * second / self.h**2

    def _expand(self, row: int, segment: int, cell: int) -> Array:
        """Return the Taylor series of one row about a point, in powers of h, the highest power first."""
        subsystems, h, t = self.dense.subsystems, self.h, float(self.local[segment, cell])
        series = np.zeros(TAYLOR_TERMS)
        series[0] = subsystems.rows.constants[row]
        known = self.input_coefs[segment] @ subsystems.rows.inputs[row]
        for subsystem, states, forcing in zip(subsystems.present, self.states, self.forcing):
            x = subsystem.decomposition
            index, reactions = x.index_of[row], x.reactions
            if reactions is not None and row in reactions.rows:
                assert subsystem.loads is not None
                n = int(np.argmax(reactions.rows == row))
                row_q, p = reactions.on_q[n], self._about_starts(subsystem.loads)[segment]
                known = p @ reactions.on_p[n]
                known[:-1] += (p[1:] @ reactions.on_rate[n]) * np.arange(1, len(p))
            elif index >= 0:
                row_q = x.rows_q[index]
                if subsystem.loads is not None and x.propagator.u_p is not None:
                    p = self._about_starts(subsystem.loads)[segment]
                    known = known + p @ (x.rows[index] @ x.propagator.u_p)
            else:
                continue
            g = polynomial.shift(forcing[segment], t)
            series += x.propagator.taylor(row_q, states[:, segment, cell], g, h)
        series[: len(known)] += polynomial.shift(known, t) * h ** np.arange(len(known))
        return series[::-1]
