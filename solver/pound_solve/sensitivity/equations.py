r"""The equations of motion and of their derivatives.

With the motion u(t, p) of a history,

.. math:: M\ddot u + C\dot u + K u + \sum_i b_i f_i = F s + p_0, \qquad
          f_i = k_i d_i + c_i \dot d_i + f_{0i},

the derivative :math:`S = \partial u/\partial p` at a fixed time obeys, between events, equations with the
same matrices,

.. math:: M\ddot S + C\dot S + K S + \sum_i b_i (k_i b_i^T S + c_i b_i^T \dot S) = R(t),

in which R is minus the derivative of the residual of the first equation at fixed u, its rates, and t.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pound_solve.numerics.types import Array, Index
from pound_solve.sensitivity.coefficients import Coefficients
from pound_solve.sensitivity.dual_law import BranchSlopes
from pound_solve.sensitivity.instants import Instants


class TangentEquations:
    """The equations of motion with the derivatives of their coefficients.

    Parameters
    ----------
    base : Coefficients
    slopes : Coefficients
        Derivatives, with a leading axis over the parameters.
    """

    def __init__(self, base: Coefficients, slopes: Coefficients) -> None:
        self.base, self.slopes = base, slopes
        self.n_params = len(slopes.constant)
        self.massive: Index = np.flatnonzero(base.mass.any(axis=1))
        self._inverse = np.linalg.inv(base.mass[np.ix_(self.massive, self.massive)])
        self._terms = [_nonzero(x) for x in (slopes.stiffness, slopes.damping, slopes.mass)]
        self._rows_move = bool(slopes.law_rows.any() or slopes.law_inputs.any())

    def deformations(self, x: Instants, order: int = 0) -> Array:
        """Return the deformations of the laws, or their rates of an order, shape (n_laws, n_times)."""
        return np.asarray(self.base.law_rows @ (x.u, x.v, x.a)[order] + self.base.law_inputs @ x.s[order])

    def deformations_at_fixed_motion(self, x: Instants, order: int = 0) -> Array:
        """Return the derivatives of the deformations at fixed motion, (n_params, n_laws, n_times)."""
        slopes = np.asarray(self.base.law_inputs @ x.ds[order])
        if self._rows_move:
            slopes = slopes + self.slopes.law_rows @ (x.u, x.v, x.a)[order]
            slopes += self.slopes.law_inputs @ x.s[order]
        return slopes

    def forces_at_fixed_motion(self, x: Instants, branches: BranchSlopes, order: int = 0) -> Array:
        """Return the derivatives of the forces of the laws, or of their rates, at fixed motion, shape
        (n_params, n_laws, n_times).
        """
        d, rate = self.deformations(x, order), self.deformations(x, order + 1)
        dd, drate = (self.deformations_at_fixed_motion(x, i) for i in (order, order + 1))
        k, c, _ = branches.values[:, :, None]
        dk, dc, df0 = branches.slopes[..., None]
        return np.asarray(dk * d + dc * rate + (df0 if order == 0 else 0.0) + k * dd + c * drate)

    def residual(self, x: Instants, branches: BranchSlopes, order: int = 0) -> Array:
        """Return R, or its rate without the inertia, shape (n_params, n, n_times).

        The rate, `order` 1, is that of the rows of massless unknowns.
        """
        base, slopes = self.base, self.slopes
        motion = (x.u, x.v, x.a)[order:]
        constant = 1.0 if order == 0 else 0.0
        r = slopes.inputs @ x.s[order] + base.inputs @ x.ds[order] + constant * slopes.constant[:, :, None]
        for terms, y in zip(self._terms, motion):
            for j, matrix in terms:
                r[j] -= matrix @ y
        r -= base.law_rows.T @ self.forces_at_fixed_motion(x, branches, order)
        if self._rows_move:
            d, rate = self.deformations(x, order), self.deformations(x, order + 1)
            k, c, f0 = branches.values[:, :, None]
            r -= slopes.law_rows.swapaxes(1, 2) @ (k * d + c * rate + constant * f0)
        return np.asarray(r)

    def accelerations(self, x: Instants, branches: BranchSlopes, su: Array, sv: Array) -> Array:
        """Return the derivatives of the accelerations, zero of massless unknowns, shape (n_params, n), at
        one instant, from those of displacements and velocities, shape (n_params, n) each.
        """
        base, (k, c, _) = self.base, branches.values
        rest = self.residual(x, branches)[:, :, 0] - su @ base.stiffness - sv @ base.damping
        rest -= (su @ base.law_rows.T * k + sv @ base.law_rows.T * c) @ base.law_rows
        accelerations = np.zeros_like(su)
        accelerations[:, self.massive] = rest[:, self.massive] @ self._inverse
        return accelerations


def _nonzero(matrices: Array) -> Sequence[tuple[int, Array]]:
    """Return the matrices that are not zero, with their parameters."""
    return [(j, matrix) for j, matrix in enumerate(matrices) if matrix.any()]
