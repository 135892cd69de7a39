r"""Sparse :math:`A = L D L^T` factorisation on a fixed pattern, with rank-one updates.

The unknowns are ordered once, for little fill.  The pattern of L follows from that of A, and every further
factorisation only visits known positions.  A spring that changes its stiffness by :math:`\delta` along the
row b changes A by :math:`\delta\, b b^T`.  This changes the factor only along the path from the first
unknown of b to the root of the elimination tree.

References
----------
Davis TA (2006), Direct Methods for Sparse Linear Systems, SIAM, chapters 4 (factor) and 4.6 (update).
"""

from __future__ import annotations

from collections.abc import Sequence, Sized
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pound_solve.numerics import ordering
from pound_solve.numerics.matrices import MAX_DENSE
from pound_solve.numerics.types import Array, Index

#: positions of entries: unsigned, so that kernels need not test every index for negative values, which
#: count from the end
Positions = NDArray[np.uint32]


PIVOT_ROUNDING = 1e-14  #: fraction of its terms up to which a pivot counts as zero
UPDATE_BREAKDOWN = 1e-8  #: fraction of a pivot that an update must leave of it
SPARE_ENTRIES = 0.05  #: additional entries per unknown that are accepted for an order with few diagonals


class Pattern(NamedTuple):
    """Positions of the entries of A and L.

    Attributes
    ----------
    ap, ai : ndarray
        Columns of the lower triangle of A, the diagonal first: pointers (n + 1,) and rows.
    lp, li : ndarray
        Columns of L below the diagonal, rows ascending.
    rp, rk, rq : ndarray
        Rows of L: pointers, columns, and positions in the arrays of L.
    """

    ap: Positions
    ai: Positions
    lp: Positions
    li: Positions
    rp: Positions
    rk: Positions
    rq: Index


def order(n: int, i: Index, j: Index) -> Index:
    """Return an order of elimination with little fill, shape (n,).

    The order follows a line (reverse Cuthill-McKee) if that fills hardly more than minimum degree; the
    entries then lie on few diagonals.  It takes unknowns alternately from both ends of the line, so that
    two eliminations do not depend on each other.

    Parameters
    ----------
    n : int
    i, j : ndarray, shape (n_pairs,)
        Pairs of coupled unknowns; a pair may occur more than once.
    """
    if n <= MAX_DENSE:
        return _order_of_few(n, i, j)
    from scipy.sparse import csc_array
    from scipy.sparse.csgraph import reverse_cuthill_mckee
    from scipy.sparse.linalg import splu

    every = np.arange(n)
    rows, columns = np.concatenate([i, j, every]), np.concatenate([j, i, every])
    a = csc_array((np.ones(len(rows)), (rows, columns)), (n, n))
    a.data[:] = 1.0
    a.setdiag(n + 1.0)  # the values are irrelevant, because pivots are never exchanged
    symmetric = {"SymmetricMode": True}
    by_degree = splu(a, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=symmetric)
    line = from_both_ends(reverse_cuthill_mckee(a, symmetric_mode=True).astype(np.int64))
    banded = splu(a[line][:, line], permc_spec="NATURAL", diag_pivot_thresh=0.0, options=symmetric)
    if banded.L.nnz <= by_degree.L.nnz + SPARE_ENTRIES * n:
        return line
    return np.argsort(by_degree.perm_c).astype(np.int64)


def _order_of_few(n: int, i: Index, j: Index) -> Index:
    """Return the result of `order` for few unknowns."""
    near: list[set[int]] = [set() for _ in range(n)]
    for a, b in zip(i.tolist(), j.tolist()):
        if a != b:
            near[a].add(b)
            near[b].add(a)
    line = from_both_ends(np.array(ordering.along_a_line(near), np.int64))
    by_degree = np.array(ordering.minimum_degree(near), np.int64)
    return line if _fill(near, line) <= _fill(near, by_degree) + SPARE_ENTRIES * n else by_degree


def from_both_ends(line: Index) -> Index:
    """Take a sequence of unknowns alternately from its two ends."""
    return np.stack([line, line[::-1]], axis=1).ravel()[: len(line)]


def _fill(near: Sequence[set[int]], order: Index) -> int:
    """Return the number of entries of the factor for an order of elimination."""
    place = np.argsort(order).tolist()
    coupled = [{place[x] for x in near[k] if place[x] > column} for column, k in enumerate(order.tolist())]
    return sum(map(len, filled(coupled)))


def analyse(n: int, i: Index, j: Index) -> Pattern:
    """Return the pattern of a matrix in its order of elimination, and of its factor; see `order`."""
    coupled: list[set[int]] = [set() for _ in range(n)]
    for a, b in zip(np.maximum(i, j).tolist(), np.minimum(i, j).tolist()):
        if a != b:
            coupled[b].add(a)
    ap, ai = _compressed([[column, *sorted(rows)] for column, rows in enumerate(coupled)])
    below = filled(coupled)
    lp, li = _compressed(below)
    rows: list[list[tuple[int, int]]] = [[] for _ in range(n)]  # of L: columns and positions
    for column in range(n):
        for q in range(lp[column], lp[column + 1]):
            rows[li[q]].append((column, q))
    rp, rk = _compressed([[column for column, _ in row] for row in rows])
    rq = np.array([q for row in rows for _, q in row], np.int64)
    return Pattern(ap, ai, lp, li, rp, rk, rq)


def filled(columns: Sequence[set[int]]) -> list[list[int]]:
    """Perform the symbolic factorisation: return the rows of L below the diagonal, column by column.

    A column of L has the entries of A and those of its children in the elimination tree.

    Parameters
    ----------
    columns : sequence of set
        Rows of A below the diagonal, column by column.
    """
    below: list[list[int]] = []
    children: list[list[int]] = [[] for _ in columns]
    for column, entries in enumerate(columns):
        rows = entries.union(*(below[child][1:] for child in children[column]))
        below.append(sorted(rows))
        if rows:
            children[below[column][0]].append(column)
    return below


def pointers(lists: Sequence[Sized]) -> Positions:
    """Return where each list begins when the lists are concatenated, and where the last one ends."""
    return np.concatenate([[0], np.cumsum([len(x) for x in lists])]).astype(np.uint32)


def _compressed(lists: Sequence[Sequence[int]]) -> tuple[Positions, Positions]:
    """Return the pointers and entries of a list of lists in one array."""
    return pointers(lists), np.array([x for row in lists for x in row], np.uint32)


def factor(s: Pattern, a: Array, l: Array, d: Array, w: Array) -> int:  # noqa: E741
    """Factorise A with the values `a` into L and the pivots D; `w` is zero before and after.

    Parameters
    ----------
    s : Pattern
    a, l : ndarray
        Values on the pattern, as many as `s.ai` and `s.li`.
    d, w : ndarray, shape (n,)

    Returns
    -------
    int
        The first unknown whose pivot vanishes, or -1.
    """
    for j in range(len(d)):
        for y in range(s.ap[j], s.ap[j + 1]):
            w[s.ai[y]] = a[y]
        pivot = w[j]
        size = abs(pivot)
        for r in range(s.rp[j], s.rp[j + 1]):
            k, y = s.rk[r], s.rq[r]
            t = l[y] * d[k]
            pivot -= l[y] * t
            for x in range(y + 1, s.lp[k + 1]):
                w[s.li[x]] -= l[x] * t
        w[j] = 0.0
        if not abs(pivot) > PIVOT_ROUNDING * size:
            for y in range(s.lp[j], s.lp[j + 1]):
                w[s.li[y]] = 0.0
            return j
        d[j] = pivot
        for y in range(s.lp[j], s.lp[j + 1]):
            l[y] = w[s.li[y]] / pivot
            w[s.li[y]] = 0.0
    return -1


def update(s: Pattern, l: Array, d: Array, w: Array, first: int, change: float) -> bool:  # noqa: E741
    """Add ``change * w w^T`` to the factorised matrix; `w`, which starts at unknown `first`, is set to
    zero.

    Returns
    -------
    bool
        False if a pivot (nearly) vanishes: the matrix must be factorised again.
    """
    j, n = first, len(d)
    good = True
    while j < n:
        p = w[j]
        w[j] = 0.0
        if p != 0.0:
            pivot = d[j] + change * p * p
            if not abs(pivot) > UPDATE_BREAKDOWN * abs(d[j]):
                good = False
                pivot = d[j]
            g = p * change / pivot
            change *= d[j] / pivot
            d[j] = pivot
            for y in range(s.lp[j], s.lp[j + 1]):
                i = s.li[y]
                w[i] -= p * l[y]
                l[y] += g * w[i]
        j = s.li[s.lp[j]] if s.lp[j + 1] > s.lp[j] else n
    return good


def solve(s: Pattern, l: Array, d: Array, x: Array) -> None:  # noqa: E741
    """Solve in place for `x`, shape (n,)."""
    n = len(d)
    for j in range(n):
        t = x[j]
        for y in range(s.lp[j], s.lp[j + 1]):
            x[s.li[y]] -= l[y] * t
    for j in range(n):
        x[j] /= d[j]
    for j in range(n - 1, -1, -1):
        t = x[j]
        for y in range(s.lp[j], s.lp[j + 1]):
            t -= l[y] * x[s.li[y]]
        x[j] = t
