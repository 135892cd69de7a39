r"""Propagators: the exact motion of a linear subsystem under piecewise-polynomial loads.

.. math:: \dot q = A q + \sum_k g_k t^k, \qquad u = \mathrm{Re}(U q) + u_p p, \qquad
   v = \mathrm{Re}(V q) + v_p p + u_p \dot p

`Propagator` is the common interface.  A `ModalPropagator` has a diagonal A.  If the complex modes do not
span the space (critical damping, repeated defective eigenvalues), a `SeriesPropagator` sums the exponential
series of the state matrix instead; it is also exact to rounding, but slower.

References
----------
Nigam NC, Jennings PC (1969), Bull. Seism. Soc. Am. 59: 909-922 (exact integration for straight-line
accelerograms).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from math import factorial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_solve.integrate.propagators.state_space import StateSpace
from pound_solve.numerics.types import Array

TAYLOR_TERMS = 22  #: terms of a Taylor series over 1 / (spectral radius): 1/22! is 1e-21

#: k! m! / (k + m + 1)!: contribution of a force t^k to the Taylor coefficient of order k + m + 1, as a
#: factor of the m-th of `Propagator._taylor_rows`
_FORCE_FACTORS = [
    np.array([factorial(k) * factorial(m) / factorial(k + m + 1) for m in range(TAYLOR_TERMS - k - 1)])
    for k in range(TAYLOR_TERMS - 1)
]


class Propagator(ABC):
    """Exact motion of a subsystem; the base of `ModalPropagator` and `SeriesPropagator`.

    Parameters
    ----------
    space : StateSpace
    inputs : ndarray, shape (n, n_inputs)
        Loads of unit inputs.

    Attributes
    ----------
    spectral_radius : float
        Largest \\|eigenvalue\\| [1/T]: the sampling grid must resolve it.
    u_q, v_q : ndarray, shape (n, n_q)
    u_p, v_p : ndarray, shape (n, n), or None
        ``u = Re(u_q q) + u_p p``, ``v = Re(v_q q) + v_p p + u_p p'``; None without massless DOFs.
    condition, residual : float
        Condition of the matrix of modes; residual of its eigenvectors, relative to `spectral_radius`.
    """

    spectral_radius: float
    condition: float
    residual: float
    u_q: NDArray[Any]
    v_q: NDArray[Any]
    u_p: Array | None
    v_p: Array | None

    def __init__(self, space: StateSpace, inputs: Array) -> None:
        self.u_p, self.v_p = space.u_p, space.v_p
        self.inputs = inputs

    @abstractmethod
    def state_of(self, u: Array, v: Array) -> NDArray[Any]:
        """Return the state q at displacement `u` and velocity `v`, shape (n_q,)."""

    @abstractmethod
    def forcing(self, input_coefs: Array, constant: Array) -> NDArray[Any]:
        """Return the forcing g of q, shape (..., degree + 1, n_q), for input polynomials
        (..., degree + 1, n_inputs) and a constant load (n,).
        """

    @abstractmethod
    def load_forcing(self, p: Array) -> NDArray[Any]:
        """Return the forcing g of q for load polynomials, shape (..., degree + 1, n)."""

    @abstractmethod
    def integral(self, q: NDArray[Any], g: NDArray[Any], t: float) -> NDArray[Any]:
        """Return the integral of q over (0, t)."""

    def march(self, q: NDArray[Any], gs: NDArray[Any], lengths: Array) -> NDArray[Any]:
        """Return q at the ends of successive intervals with the given `lengths`, shape (n_q, n + 1), the
        start included.

        `gs`, shape (n, degree + 1, n_q), holds the forcing of each interval about its own start.
        """
        states = [q]
        for g, length in zip(gs, lengths.tolist()):
            states.append(self.at(states[-1], g, length))
        return np.stack(states, axis=1)

    @abstractmethod
    def derivative_bounds(self, qs: NDArray[Any], gs: NDArray[Any], lengths: Array) -> Array:
        """Return bounds of the second and third derivatives of q over intervals with the given `lengths`
        and starts `qs` (n_q, n), shape (2, n_q, n); infinite where none is known.
        """

    @abstractmethod
    def samples(self, qs: NDArray[Any], gs: NDArray[Any], h: float, count: int) -> NDArray[Any]:
        """Return q at 0, h, ..., (count - 1) h of several intervals with starts `qs` (n_q, n) and
        forcing `gs` (n, degree + 1, n_q), shape (n_q, n, count).
        """

    @abstractmethod
    def at(self, q: NDArray[Any], g: NDArray[Any], t: float) -> NDArray[Any]:
        """Return q at one time `t`."""

    @abstractmethod
    def free_motion(self, q: NDArray[Any], times: Array) -> NDArray[Any]:
        """Return states, shape (..., n_times, n_q), each after its time without forcing."""

    @abstractmethod
    def free_integral(self, q: NDArray[Any], times: Array) -> NDArray[Any]:
        """Return the integrals of `free_motion` from zero to its times, of the same shape."""

    @abstractmethod
    def rate_rows(self, rows: NDArray[Any]) -> NDArray[Any]:
        """Return ``rows A``, of the shape of `rows`: the rate of ``rows q`` is ``rows A q`` plus `rows`
        times the forcing g.
        """

    def taylor(self, row: NDArray[Any], q: NDArray[Any], g: NDArray[Any], h: float) -> Array:
        """Return the coefficients of ``Re(row q(h x))`` in powers of x, shape (TERMS,), for x up to 1.

        `q` and `g` are those of the start, and `h` is at most 1 / `spectral_radius`.  The recurrence is
        :math:`q^{(m+1)} = A q^{(m)} + g^{(m)}`.
        """
        rows = self._taylor_rows(row, h)
        coefs: Array = (rows @ q).real
        for k, force in enumerate(g):
            # t^k enters at the power k + 1, and each derivative of q raises it by one
            coefs[k + 1 :] += h ** (k + 1) * _FORCE_FACTORS[k] * (rows[: TAYLOR_TERMS - k - 1] @ force).real
        return coefs

    @abstractmethod
    def _taylor_rows(self, row: NDArray[Any], h: float) -> NDArray[Any]:
        """Return ``row (A h)^m / m!``, shape (TERMS, n_q)."""

    @abstractmethod
    def trajectories(self, qs: NDArray[Any], gs: NDArray[Any], times: Array) -> NDArray[Any]:
        """Return q at ascending `times` of several intervals with starts `qs` (n_q, n) and forcing `gs`
        (n, degree + 1, n_q), shape (n_q, n, n_times).
        """

    def trajectory(self, q: NDArray[Any], g: NDArray[Any], times: Array) -> NDArray[Any]:
        """Return `trajectories` of one interval, shape (n_q, n_times)."""
        states: NDArray[Any] = self.trajectories(q[:, None], g[None], times)[:, 0]
        return states


def real_parts(x: NDArray[Any], axis: int = 0) -> Array:
    """Return states, or factors of states, as real numbers: the real parts along an axis, followed by the
    imaginary parts.
    """
    return np.concatenate([x.real, x.imag], axis) if np.iscomplexobj(x) else x


def real_rows(rows: NDArray[Any]) -> Array:
    """Return real rows whose product with `real_parts` of a state q is ``Re(rows q)``, at half the work of
    a complex product.
    """
    return np.concatenate([rows.real, -rows.imag], axis=1) if np.iscomplexobj(rows) else rows


def powers(t: NDArray[Any] | float, degree: int) -> Array:
    """Return t^0 .. t^degree, shape (degree + 1, ...)."""
    return np.stack([np.asarray(t, float) ** k for k in range(degree + 1)])


_X, _W = np.polynomial.legendre.leggauss(12)
_X, _W = 0.5 * (_X + 1.0), 0.5 * _W


def gauss(t: float, spectral_radius: float) -> tuple[Array, Array]:
    """Return Gauss weights and points on (0, t) for modes up to `spectral_radius` and their products."""
    cells = max(1, int(np.ceil(t * spectral_radius / 4.0)))
    width = t / cells
    return np.tile(_W * width, cells), (np.arange(cells)[:, None] * width + _X * width).ravel()
