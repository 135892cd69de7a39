r"""Cells of a course that their neighbours tell nothing of: where a quantity may exceed what is known.

The samples around a cell tell how far a quantity may exceed it (`numerics.crests`) where the cells next to
it are as long as it and follow each other.  Around an event they are not: a step ends at it, and the next
one is longer or shorter; accelerations and forces may jump there, so that the sample at the start of the
next cell is not what the cell itself ends with.  The same holds at both ends of a course, and where the
motion between two of its cells is part of another one.

Such a cell is sampled at `COUNT` nodes of Chebyshev of its own.  Where it has no more than 2.5 radians of
an oscillation, their polynomial is right to about :math:`2 J_5(1.25) \approx 0.002` of this, and the last
two of its coefficients together are larger than that.
"""

from __future__ import annotations

import numpy as np

from pound_solve.numerics.crests import BEFORE, Doubts
from pound_solve.numerics.types import Array, Flags, Index

COUNT = 5  #: nodes of a cell
GRID = 8  #: parts of a cell, at whose ends its polynomial is looked at
EXCESS = 0.05  #: share of the range of a polynomial there, by which it may exceed what it is there
EQUAL = 1e-6  #: share of the length of a cell, by which those next to it may differ
AT_ONCE = 2**20  #: samples of several quantities that are looked at together

_TURN = np.pi * (np.arange(COUNT) + 0.5) / COUNT
#: places of the nodes in (0, 1): without the ends, at which a quantity may jump
NODES = 0.5 * (1.0 - np.cos(_TURN))
_FIT = 2.0 / COUNT * np.cos(np.arange(COUNT)[:, None] * (np.pi - _TURN))
_FIT[0] *= 0.5
#: values on the grid, then the last two coefficients, from values at the nodes
_LOOKS = np.vstack(
    [np.polynomial.chebyshev.chebvander(np.linspace(-1.0, 1.0, GRID + 1), COUNT - 1) @ _FIT, _FIT[-2:]]
)


def among_equals(t: Array, lengths: Array) -> Flags:
    """Which cells have `BEFORE` others as long as they before and one more after them, without a gap,
    shape (n,).

    Parameters
    ----------
    t, lengths : ndarray, shape (n,)
        Starts of the cells, rising, and times up to which the motion from there is smooth [T].
    """
    slack, width = EQUAL * lengths[:-1], 2 * BEFORE + 1
    joined = (np.abs(np.diff(lengths)) <= slack) & (np.abs(np.diff(t) - lengths[:-1]) <= slack)
    out = np.zeros(len(t), bool)
    if len(t) > width:  # the sample at the end of the last one tells, too
        runs: Flags = np.all(np.lib.stride_tricks.sliding_window_view(joined, width), axis=1)
        out[BEFORE : BEFORE + len(runs)] = runs
    return out


def may_exceed_alone(values: Array, cells: Index, low: Array, high: Array) -> Doubts:
    """Which quantities may exceed what is known of them in some cells, by values in these alone.

    Parameters
    ----------
    values : ndarray, shape (n, n_cells, COUNT)
        At the `NODES` of the cells.
    cells : ndarray of int, shape (n_cells,)
        Their numbers.
    low, high : ndarray, shape (n,)
        Smallest and largest values so far.
    """
    looks = (_LOOKS @ values.reshape(-1, COUNT).T).reshape(-1, *values.shape[:2])
    top, bottom = looks[:-2].max(axis=0), looks[:-2].min(axis=0)
    rest = np.abs(looks[-2:]).sum(axis=0) + EXCESS * (top - bottom)
    found = []
    for sign, most, best in ((1.0, top + rest, high), (-1.0, rest - bottom, -low)):
        row, at = np.nonzero(most > best[:, None])
        found.append(Doubts(np.full(len(row), sign), row, cells[at], most[row, at]))
    return Doubts(*map(np.concatenate, zip(*found)))
