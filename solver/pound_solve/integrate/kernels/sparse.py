"""Sparse matrices in the form that the kernels multiply with."""

from __future__ import annotations

from typing import NamedTuple

from pound_solve.numerics.ldl import Positions
from pound_solve.numerics.types import Array, Index


class Product(NamedTuple):
    """A matrix for products with vectors, stored by diagonals that are full enough, otherwise by rows.

    Attributes
    ----------
    offsets : ndarray, shape (n_diagonals,)
        Column less row; the first is zero.
    diagonals : ndarray, shape (n_diagonals, n)
        Entries of the diagonals, each from its first row on.
    row : ndarray, shape (n_rows,)
        Rows that have other entries.
    pointers : ndarray, shape (n_rows + 1,)
    columns, values : ndarray, shape (n_others,)
        These entries.
    """

    offsets: Index
    diagonals: Array
    row: Positions
    pointers: Positions
    columns: Positions
    values: Array


class Rows(NamedTuple):
    """Sparse rows over the unknowns.

    Attributes
    ----------
    pointers : ndarray, shape (n_rows + 1,)
    columns, values : ndarray, shape (n_entries,)
    """

    pointers: Positions
    columns: Positions
    values: Array
