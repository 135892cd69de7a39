r"""Cells of a course whose neighbours give no bound: where a quantity may exceed its known extremes.

The samples around a cell tell how far a quantity may exceed it (`numerics.crests`) where the cells next to
it are as long as it and follow each other.  Around an event they are not: a step ends at it, and the next
one is longer or shorter; accelerations and forces may jump there, so that the sample at the start of the
next cell is not what the cell itself ends with.  The same holds at both ends of a course, and where the
motion between two of its cells is part of another one.

Such a cell is sampled at the `NODES`, of which its start is known.  Where it has no more than 2.5 radians
of an oscillation, their polynomial is right to some hundredths of this, and the last two of its
coefficients together are larger than that.
"""

from __future__ import annotations

import numpy as np

from pound_solve.numerics.crests import SAMPLES_BESIDE, Doubts
from pound_solve.numerics.types import Array, Flags, Index

#: places in a cell: short of its end, at which a quantity may jump
NODES = np.array([0.0, 1.0 / 3.0, 2.0 / 3.0, 0.99])
GRID = 8  #: parts of a cell, at whose ends its polynomial is looked at
EXCESS = 0.05  #: share of the range of a polynomial there, by which it may exceed what it is there
EQUAL = 1e-6  #: share of the length of a cell, by which those next to it may differ
AT_ONCE = 2**17  #: samples of several quantities that are looked at together

_FIT = np.linalg.inv(np.polynomial.chebyshev.chebvander(2.0 * NODES - 1.0, len(NODES) - 1))
_GRID = np.polynomial.chebyshev.chebvander(np.linspace(-1.0, 1.0, GRID + 1), len(NODES) - 1)
#: values on the grid, then the last two coefficients, from values at the nodes
_LOOKS = np.vstack([_GRID @ _FIT, _FIT[-2:]])
# Let the values be b + r w with w in (0, 1).  A row for the grid sums to one, since constants are met: it
# gives b + r times its sum of w, which is at most the sum of its positive parts, and at least one less that
# sum.  A row for a coefficient sums to zero, and gives as much to either side.
_UP = np.maximum(_LOOKS, 0.0).sum(axis=1)
_GRID_UP, _REST_UP = _UP[:-2].max(), _UP[-2:].sum()
#: of the range of the values, by which what a quantity may be is above the largest of them at most: the
#: polynomial, its last coefficients, and the share of its range
_MOST = (_GRID_UP - 1.0) + _REST_UP + EXCESS * (2.0 * _GRID_UP - 1.0)


def among_equals(t: Array, lengths: Array) -> Flags:
    """Which cells have `SAMPLES_BESIDE` cells of equal length before them and one more after them, no gap,
    shape (n,).

    Parameters
    ----------
    t, lengths : ndarray, shape (n,)
        Starts of the cells, rising, and times up to which the motion from there is smooth [T].
    """
    slack, width = EQUAL * lengths[:-1], 2 * SAMPLES_BESIDE + 1
    joined = (np.abs(np.diff(lengths)) <= slack) & (np.abs(np.diff(t) - lengths[:-1]) <= slack)
    equals = np.zeros(len(t), bool)
    if len(t) > width:  # the sample at the end of the last one tells, too
        runs: Flags = np.all(np.lib.stride_tricks.sliding_window_view(joined, width), axis=1)
        equals[SAMPLES_BESIDE : SAMPLES_BESIDE + len(runs)] = runs
    return equals


def may_exceed_alone(values: Array, cells: Index, low: Array, high: Array) -> Doubts:
    """Which quantities may exceed their known extremes in some cells, by values within these cells alone.

    Parameters
    ----------
    values : ndarray, shape (n_nodes, n, n_cells)
        At the `NODES` of the cells.
    cells : ndarray of int, shape (n_cells,)
        Their numbers.
    low, high : ndarray, shape (n,)
        Smallest and largest values so far.
    """
    top, bottom = values.max(axis=0), values.min(axis=0)
    margin = _MOST * (top - bottom)
    row, at = np.nonzero((top + margin > high[:, None]) | (bottom - margin < low[:, None]))
    looks = _LOOKS @ values[:, row, at]
    top, bottom = looks[:-2].max(axis=0), looks[:-2].min(axis=0)
    rest = np.abs(looks[-2:]).sum(axis=0) + EXCESS * (top - bottom)
    doubts = []
    for sign, most, best in ((1.0, top + rest, high[row]), (-1.0, rest - bottom, -low[row])):
        more = most > best
        doubts.append(Doubts(np.full(more.sum(), sign), row[more], cells[at[more]], most[more]))
    return Doubts(*map(np.concatenate, zip(*doubts)))
