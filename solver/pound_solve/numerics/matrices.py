"""Matrices of a structure: plain arrays if they are small, otherwise sparse rows (CSR).

A sparse matrix is faster from a few hundred DOFs on.  Below that it costs more than it saves, and a deck
with few DOFs does not even import scipy.sparse.  Operations that both types support (``@``, ``+``, ``.T``,
slices, ``numpy.ix_``) are written as for arrays; this module contains the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pound_solve.numerics.types import Array, Flags, Index

#: an ndarray, or a scipy.sparse.csr_array
Matrix = Any

MAX_DENSE = 300  #: largest number of rows and columns of a plain array


def gathered(
    shape: tuple[int, int], rows: Any, columns: Any, values: Any, *, most_dense: int = MAX_DENSE
) -> Matrix:
    """Return the matrix whose entries are sums of `values` at (`rows`, `columns`)."""
    i, j, x = np.asarray(rows, np.int64), np.asarray(columns, np.int64), np.asarray(values, float)
    if max(shape) <= most_dense:
        matrix = np.zeros(shape)
        np.add.at(matrix, (i, j), x)
        return matrix
    from scipy.sparse import coo_array  # slow to import, and not needed for small decks

    return coo_array((x, (i, j)), shape).tocsr()


def selection(size: int, columns: Index) -> Matrix:
    """Return the columns of the unit matrix, shape (size, len(columns))."""
    return gathered((size, len(columns)), columns, np.arange(len(columns)), np.ones(len(columns)))


def dense(a: Matrix) -> Array:
    """Return the matrix as a plain array."""
    return np.asarray(a if isinstance(a, np.ndarray) else a.toarray())


def entries(a: Matrix) -> tuple[Index, Index, Array]:
    """Return the rows, columns and values of the non-zero entries, row by row."""
    if isinstance(a, np.ndarray):
        i, j = np.nonzero(a)
        return i.astype(np.int64), j.astype(np.int64), np.asarray(a[i, j], float)
    a = a.tocsr(copy=True)
    a.sum_duplicates()
    a.eliminate_zeros()
    i = np.repeat(np.arange(a.shape[0], dtype=np.int64), np.diff(a.indptr))
    return i, a.indices.astype(np.int64), np.asarray(a.data, float)


def by_rows(a: Matrix) -> list[tuple[Index, Array]]:
    """Return the columns and values of the non-zero entries of every row."""
    i, j, x = entries(a)
    ends = np.searchsorted(i, np.arange(a.shape[0] + 1))
    return [(j[p:q], x[p:q]) for p, q in zip(ends[:-1].tolist(), ends[1:].tolist())]


def at(a: Matrix, rows: Index, columns: Index) -> Array:
    """Return the values at the given rows and columns, shape (n,)."""
    if isinstance(a, np.ndarray):
        return a[rows, columns]
    i, j, x = entries(a)
    keys, wanted = i * a.shape[1] + j, rows * a.shape[1] + columns
    place = np.minimum(np.searchsorted(keys, wanted), max(len(keys) - 1, 0))
    return np.where(keys[place] == wanted, x[place], 0.0) if len(keys) else np.zeros(len(rows))


def used_rows(a: Matrix) -> Flags:
    """Return which rows have non-zero entries, shape (n_rows,)."""
    if isinstance(a, np.ndarray):
        used: Flags = np.any(a != 0.0, axis=1)
        return used
    flags = np.zeros(a.shape[0], bool)
    flags[entries(a)[0]] = True
    return flags


def used_columns(a: Matrix) -> Flags:
    """Return which columns have non-zero entries, shape (n_columns,)."""
    return used_rows(a.T)


def diagonal(a: Matrix) -> Array:
    """Return the entries on the diagonal."""
    return np.array(a.diagonal(), float)


def is_diagonal(a: Matrix) -> bool:
    """Return whether all entries off the diagonal are zero."""
    i, j, _ = entries(a)
    return bool((i == j).all())


def scaled(a: Matrix, factors: Array) -> Matrix:
    """Return the matrix with row i and column i multiplied by ``factors[i]``."""
    if isinstance(a, np.ndarray):
        return factors[:, None] * a * factors
    from scipy.sparse import diags_array

    d = diags_array(factors)
    return (d @ a @ d).tocsr()


def weighted(rows: Matrix, weights: Sequence[float] | Array) -> Matrix:
    """Return ``rows^T diag(weights) rows``."""
    if isinstance(rows, np.ndarray):
        return (rows.T * np.asarray(weights, float)) @ rows
    from scipy.sparse import diags_array

    return (rows.T @ diags_array(np.asarray(weights, float)) @ rows).tocsr()


def least_squares(a: Matrix, b: Matrix, rcond: float | None = None) -> Array:
    """Return the solution of ``a x = b`` for a symmetric `a`, with the least norm if `a` is singular."""
    if not isinstance(a, np.ndarray):
        try:
            return Factor(a).solve(dense(b))
        except np.linalg.LinAlgError:
            pass
    return np.asarray(np.linalg.lstsq(dense(a), dense(b), rcond=rcond)[0], float)


def bordered(a: Matrix, right: Array, below: Array, b: Array) -> Array:
    """Return the solution of ``[[a, right], [below^T, 0]] x = b``, or NaN if there is none.

    Parameters
    ----------
    a : Matrix, shape (n, n)
    right, below : ndarray, shape (n, n_more)
    b : ndarray, shape (n + n_more,)
    """
    nothing = np.full(len(b), np.nan)
    if isinstance(a, np.ndarray):
        try:
            return np.linalg.solve(np.block([[a, right], [below.T, np.zeros((right.shape[1],) * 2)]]), b)
        except np.linalg.LinAlgError:
            return nothing
    from scipy.sparse import block_array, csc_array
    from scipy.sparse.linalg import splu

    try:
        lu = splu(block_array([[a, csc_array(right)], [csc_array(below.T), None]], format="csc"))
    except RuntimeError:
        return nothing
    return np.asarray(lu.solve(b))


class Factor:
    """Sparse symmetric :math:`A = L D L^T` factorisation in an order with little fill, without pivoting.

    Parameters
    ----------
    a : csr_array
    least : float
        Smallest allowed pivot, as a fraction of n times its diagonal entry.

    Attributes
    ----------
    pivots : ndarray, shape (n,)
        D, by unknown.  The number of negative pivots equals that of negative eigenvalues of A (Sylvester).

    Raises
    ------
    numpy.linalg.LinAlgError
        A pivot is zero, or negligible compared with its diagonal entry.
    """

    def __init__(self, a: Matrix, least: float = 1e-15) -> None:
        from scipy.sparse import csc_array
        from scipy.sparse.linalg import splu

        size = np.abs(diagonal(a))
        try:
            self._lu = splu(
                csc_array(a),
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True, "Equil": False},
            )
        except RuntimeError:
            raise np.linalg.LinAlgError("singular matrix") from None
        order = np.argsort(self._lu.perm_c)
        self.pivots = np.empty(len(order))
        self.pivots[order] = self._lu.U.diagonal()
        exchanged = (self._lu.perm_r != self._lu.perm_c).any()
        if exchanged or (np.abs(self.pivots) < least * max(len(order), 10) * size).any():
            raise np.linalg.LinAlgError("singular matrix")

    @property
    def negative(self) -> int:
        """Number of negative eigenvalues of A."""
        return int((self.pivots < 0.0).sum())

    def solve(self, b: Array) -> Array:
        """Return the solution of A x = b, shape (n,) or (n, n_columns)."""
        return np.asarray(self._lu.solve(np.ascontiguousarray(b, float)))
