r"""Closed rigid contacts in statics: constraints on the unknowns, and contact forces.

With the rows B of the closed contacts, rates of displacement obey :math:`B\dot u = 0`.  In each row one
unknown follows the others, :math:`\dot u = Z\dot v`, and for loads :math:`\lambda p` equilibrium along the
remaining motions is

.. math:: Z^T K Z\,\dot v = \dot\lambda\,Z^T p, \qquad B^T \dot r = \dot\lambda\,p - K\dot u

The forces r of contacts with dependent rows are shared evenly: the solution has the least norm.
"""

from __future__ import annotations

import numpy as np

from pound_solve.numerics.matrices import Matrix, gathered
from pound_solve.numerics.types import Array, Index

DEPENDENT = 1e-12  #: largest fraction of a row that remains if it depends on others


class ContactConstraints:
    """Constraints that closed rigid contacts impose on the unknowns.

    Parameters
    ----------
    laws : ndarray of int, shape (n_closed,)
    rows : ndarray, shape (n_closed, n)
        Deformations from the unknowns.

    Attributes
    ----------
    laws : ndarray of int, shape (n_closed,)
    basis : Matrix, shape (n, n)
        Z; its columns for the unknowns that follow are zero.
    """

    def __init__(self, laws: Index, rows: Array) -> None:
        self.laws, n = laws, rows.shape[1]
        self._forces = np.linalg.pinv(rows.T, rcond=DEPENDENT)
        left, followers = rows.copy(), list[int]()
        for i, row in enumerate(rows):
            j = int(np.argmax(np.abs(left[i])))
            if np.abs(left[i, j]) <= DEPENDENT * np.abs(row).max():
                left[i] = 0.0
                continue
            left[i] /= left[i, j]
            others = np.arange(len(rows)) != i
            left[others] -= np.outer(left[others, j], left[i])
            followers.append(j)
        left, free = left[left.any(axis=1)], np.setdiff1d(np.arange(n), followers)
        of, on = np.nonzero(left[:, free])
        self.basis = gathered(
            (n, n),
            np.append(free, np.array(followers, np.intp)[of]),
            np.append(free, free[on]),
            np.append(np.ones(len(free)), -left[of, free[on]]),
        )

    def __len__(self) -> int:
        return len(self.laws)

    def reduced_matrix(self, matrix: Matrix) -> Matrix:
        """Reduce a matrix of the unknowns, shape (n, n), to the free motions: Z^T A Z."""
        return self.basis.T @ matrix @ self.basis if len(self) else matrix

    def reduced_vector(self, force: Array) -> Array:
        """Reduce forces on the unknowns, shape (n,), to the free motions: Z^T p."""
        return np.asarray(self.basis.T @ force) if len(self) else force

    def expand(self, u: Array) -> Array:
        """Return the motions of all unknowns from the free motions, shape (n,) or (n, count): Z u."""
        return np.asarray(self.basis @ u) if len(self) else u

    def forces(self, residual: Array) -> Array:
        """Return the contact forces, shape (n_closed,), that balance the force `residual` on the
        unknowns.
        """
        return np.asarray(self._forces @ residual)

    def magnitudes(self, terms: Array) -> Array:
        """Return the magnitudes of the terms of these forces, for the absolute `terms` of the residual."""
        return np.asarray(np.abs(self._forces) @ terms)
