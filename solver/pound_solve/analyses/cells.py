r"""Search for possible extremes in cells whose adjacent cells give no bound.

If adjacent cells are contiguous and of equal length, the samples around a cell bound a quantity within it
(`numerics.crests`).  Around an event they do not: a step ends there, the next step has a different length,
and accelerations and forces may jump.  The sample at the start of the next cell is then not the value at
the end of this one.  The same applies at both ends of a course, and at gaps that belong to another course.

Such a cell is sampled at the `NODES`, the first of which is already known.  If it spans at most 2.5 radians
of an oscillation, the interpolating polynomial has an error of a few hundredths of the amplitude, and its
last two coefficients together exceed that error.
"""

from __future__ import annotations

import numpy as np

from pound_solve.numerics.crests import SAMPLES_BESIDE, Doubts
from pound_solve.numerics.types import Array, Flags, Index

#: positions in a cell; the last one is just before the end, where a quantity may jump
NODES = np.array([0.0, 1.0 / 3.0, 2.0 / 3.0, 0.99])
GRID = 8  #: subdivisions of a cell at which its polynomial is evaluated
EXCESS = 0.05  #: margin for values between these points, as a fraction of the range of the polynomial
EQUAL = 1e-6  #: relative tolerance for equal lengths of adjacent cells
AT_ONCE = 2**17  #: samples of several quantities that are examined together

_FIT = np.linalg.inv(np.polynomial.chebyshev.chebvander(2.0 * NODES - 1.0, len(NODES) - 1))
_GRID = np.polynomial.chebyshev.chebvander(np.linspace(-1.0, 1.0, GRID + 1), len(NODES) - 1)
#: values on the grid, then the last two coefficients, from values at the nodes
_LOOKS = np.vstack([_GRID @ _FIT, _FIT[-2:]])
# Let the values be b + r w with w in (0, 1). A row for the grid sums to one, since the polynomial
# reproduces constants: it gives b + r times its sum of w, which is at most the sum of its positive parts,
# and at least one less that sum. A row for a coefficient sums to zero, and gives as much to either side.
_UP = np.maximum(_LOOKS, 0.0).sum(axis=1)
_GRID_UP, _REST_UP = _UP[:-2].max(), _UP[-2:].sum()
#: largest excess of a possible value over the largest sample, as a fraction of the range of the samples:
#: from the polynomial, its last coefficients and the margin
_MOST = (_GRID_UP - 1.0) + _REST_UP + EXCESS * (2.0 * _GRID_UP - 1.0)


def among_equals(t: Array, lengths: Array) -> Flags:
    """Return which cells follow `SAMPLES_BESIDE` cells of equal length and precede another one, without a
    gap, shape (n,).

    Parameters
    ----------
    t, lengths : ndarray, shape (n,)
        Starts of the cells, ascending, and lengths over which the motion from there is smooth [T].
    """
    tolerance, width = EQUAL * lengths[:-1], 2 * SAMPLES_BESIDE + 1
    joined = (np.abs(np.diff(lengths)) <= tolerance) & (np.abs(np.diff(t) - lengths[:-1]) <= tolerance)
    equals = np.zeros(len(t), bool)
    if len(t) > width:  # the sample at the end of the last cell counts too
        runs: Flags = np.all(np.lib.stride_tricks.sliding_window_view(joined, width), axis=1)
        equals[SAMPLES_BESIDE : SAMPLES_BESIDE + len(runs)] = runs
    return equals


def may_exceed_alone(values: Array, cells: Index, low: Array, high: Array) -> Doubts:
    """Return which quantities may exceed their known extremes in some cells, judged only by values within
    these cells.

    Parameters
    ----------
    values : ndarray, shape (n_nodes, n, n_cells)
        At the `NODES` of the cells.
    cells : ndarray of int, shape (n_cells,)
        Numbers of the cells.
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
