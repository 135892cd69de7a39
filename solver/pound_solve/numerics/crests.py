r"""Extremes of sampled quantities between their samples.

A quantity y is known at instants, and is smooth over the *cell* between two of them.  The search has two
stages.  First, the samples alone show in which cells y may exceed its known extremes: in a cell of at most
2.5 radians of an oscillation, y exceeds the larger of its two end samples by no more than the largest
change of y over the adjacent cells.  Second, only in those cells y is sampled at the Chebyshev `NODES`.
The error of the interpolating polynomial is about :math:`J_{13}(1.25) \approx 4\cdot 10^{-13}` of the
fastest part; the extreme is found on a fine grid and by Newton's method.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from pound_solve.numerics.types import Array, Flags, Index

DEGREE = 12  #: of the polynomial over a cell
GROUP = 16  #: cells that share one bound
AT_ONCE = 2**16  #: number of samples that are examined at once, few enough for a cache
GRID_CELLS = 48  #: cells of the grid on which the extreme of a polynomial is searched
NEWTON_ITERATIONS = 3  #: iterations from the grid to the extreme
SAMPLES_BESIDE = 2  #: additional samples on either side, which show the curvature
MARGIN = 1.5  #: factor on the change over a cell, for the amount by which a quantity may exceed its samples
#: fraction of a quantity's changes from node to node, by which it may exceed the largest there
EXCESS = 0.5
CURVATURE_MARGIN = 1.5  #: factor on the range of the second differences, for the largest curvature

_AROUND = np.arange(-SAMPLES_BESIDE, GROUP + SAMPLES_BESIDE + 1)

_TURN = np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1)
#: positions of the nodes in (0, 1), without the ends, where a quantity may jump
NODES = 0.5 * (1.0 - np.cos(_TURN))
#: matrix from values at the nodes to coefficients of Chebyshev polynomials
_FIT = 2.0 / (DEGREE + 1) * np.cos(np.arange(DEGREE + 1)[:, None] * (np.pi - _TURN))
_FIT[0] *= 0.5
_GRID = np.linspace(-1.0, 1.0, GRID_CELLS + 1)
_ON_GRID = np.polynomial.chebyshev.chebvander(_GRID, DEGREE) @ _FIT


def on_nodes(places: Array) -> Array:
    """Return the matrix from values at the `NODES` to values at `places` in [0, 1], shape (...,
    n_nodes).
    """
    return np.asarray(np.polynomial.chebyshev.chebvander(2.0 * places - 1.0, DEGREE) @ _FIT)


def some_rows(values: Array) -> Iterator[slice]:
    """Yield the rows of an array in batches."""
    count = max(AT_ONCE // max(values.shape[1], 1), 1)
    for first in range(0, len(values), count):
        yield slice(first, first + count)


class Doubts(NamedTuple):
    """Cells in which quantities may exceed their known extremes, shape (n,) each.

    Attributes
    ----------
    sign : ndarray
        Sign by which the quantity is multiplied: 1 for its largest value, -1 for its smallest.
    row, cell : ndarray of int
        Numbers of the quantity and of the cell.
    most : ndarray
        Bound of the quantity there, times the sign.
    """

    sign: Array
    row: Index
    cell: Index
    most: Array

    def some(self, chosen: Index | Flags | slice) -> Doubts:
        """Return the entries with the given numbers."""
        return Doubts(self.sign[chosen], self.row[chosen], self.cell[chosen], self.most[chosen])

    def first(self) -> Index:
        """Return the numbers of the entries with the largest bound for their quantity and sign."""
        order = np.lexsort((-self.most, self.row, self.sign))
        new = np.ones(len(order), bool)
        for part in (self.sign[order], self.row[order]):
            new[1:] &= part[1:] == part[:-1]
        new[1:] = ~new[1:]
        return order[new]


def may_exceed(values: Array, low: Array, high: Array) -> Doubts:
    """Return which quantities may exceed their known extremes, and in which cells.

    Parameters
    ----------
    values : ndarray, shape (n, n_times)
        At the starts of the cells; the end of a cell is the start of the next.
    low, high : ndarray, shape (n,)
        Smallest and largest values so far, including these.
    """
    doubts = [Doubts(np.zeros(0), np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0))]
    for some in some_rows(values):
        chunk, known = values[some], (high[some], -low[some])
        change = np.zeros(chunk.shape)
        np.subtract(chunk[:, 1:], chunk[:, :-1], out=change[:, :-1])
        np.abs(change, out=change)
        most = chunk.max(axis=1) - known[0], -chunk.min(axis=1) - known[1]
        rows = np.flatnonzero(np.maximum(*most) + MARGIN * change.max(axis=1) > 0.0)
        best = known[0][rows], known[1][rows]
        doubts += _doubts(chunk[rows], change[rows], best, some.start + rows)
    return Doubts(*map(np.concatenate, zip(*doubts)))


def _doubts(values: Array, change: Array, best: tuple[Array, Array], numbers: Index) -> Iterator[Doubts]:
    """Yield entries for quantities, with their `numbers`, that may exceed the `best` values on
    either side.
    """
    count = values.shape[1]
    starts = np.arange(0, count, GROUP)
    reach = MARGIN * _beside(np.maximum.reduceat(change, starts, axis=1))
    for sign, reduced, known in zip((1.0, -1.0), (np.maximum, np.minimum), best):
        most = sign * reduced.reduceat(values, starts, axis=1)
        row, group = np.nonzero(most + reach > known[:, None])
        at = starts[group][:, None] + _AROUND
        bounds = _bounds(sign * values[row[:, None], np.clip(at, 0, count - 1)])
        within = at[:, SAMPLES_BESIDE : SAMPLES_BESIDE + GROUP] < count
        which, cell = np.nonzero((bounds > known[row][:, None]) & within)
        doubtful = numbers[row[which]], starts[group[which]] + cell, bounds[which, cell]
        yield Doubts(np.full(len(which), sign), *doubtful)


def near(values: Array, best: Array) -> Flags:
    """Return which quantities may exceed `best` within a cell, judged by `values` at the `NODES`, shape (n,
    n_nodes).
    """
    change = np.abs(np.diff(values, axis=1))
    number, at = np.arange(len(values)), np.argmax(values, axis=1)
    most = values[number, at]
    for side in (np.maximum(at - 1, 0), np.minimum(at, change.shape[1] - 1)):
        most = most + EXCESS * change[number, side]
    return np.asarray(most > best)


def _bounds(values: Array) -> Array:
    """Return bounds of quantities over `GROUP` cells, shape (n, GROUP), from their values at the starts and
    ends of the cells and at `SAMPLES_BESIDE` additional samples on either side.
    """
    slope = values[:, 1:] - values[:, :-1]
    bend = slope[:, 1:] - slope[:, :-1]  # at all samples but the first and the last
    least = np.lib.stride_tricks.sliding_window_view(bend, 4, axis=1).min(axis=2)
    most = np.lib.stride_tricks.sliding_window_view(bend, 4, axis=1).max(axis=2)
    bent = np.maximum(-least, 0.0) + CURVATURE_MARGIN * (most - least)
    cells = slice(SAMPLES_BESIDE, SAMPLES_BESIDE + GROUP)
    begin, change = values[:, cells], slope[:, cells]
    # the top of a parabola through both ends
    at = np.clip(0.5 + np.divide(change, bent, out=np.sign(change), where=bent > 0.0), 0.0, 1.0)
    return np.asarray(begin + at * change + 0.5 * bent * at * (1.0 - at))


def _beside(x: Array) -> Array:
    """Return the largest value of every column and its two neighbours."""
    largest = x.copy()
    np.maximum(largest[:, 1:], x[:, :-1], out=largest[:, 1:])
    np.maximum(largest[:, :-1], x[:, 1:], out=largest[:, :-1])
    return largest


def crests(values: Array) -> tuple[Array, Array]:
    """Return the largest values over some cells, and their positions in [0, 1], shape (n,) each.

    Parameters
    ----------
    values : ndarray, shape (n, DEGREE + 1)
        At the `NODES`.
    """
    sampled = values @ _ON_GRID.T
    at = np.argmax(sampled, axis=1)
    top, x = sampled[np.arange(len(at)), at], _GRID[at]
    c = _FIT @ values.T
    slope = np.polynomial.chebyshev.chebder(c)
    bend = np.polynomial.chebyshev.chebder(slope)
    y = x.copy()
    for _ in range(NEWTON_ITERATIONS):
        s, b = (np.polynomial.chebyshev.chebval(y, p, tensor=False) for p in (slope, bend))
        y = np.clip(
            y - np.divide(s, b, out=np.zeros_like(s), where=b < 0.0), x - 2 / GRID_CELLS, x + 2 / GRID_CELLS
        )
    y = np.clip(y, -1.0, 1.0)
    best = np.polynomial.chebyshev.chebval(y, c, tensor=False)
    better = best > top
    return np.where(better, best, top), 0.5 * (1.0 + np.where(better, y, x))
