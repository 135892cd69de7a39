r"""Two families of integrals of the exponential function times powers, for complex arguments.

.. math:: K_k(z) = \int_0^1 e^{z(1-x)} x^k\,dx, \qquad J_k(z) = \int_0^1 e^{zx} x^k\,dx

:math:`K_k = k!\,\varphi_{k+1}(z)` is the response of a mode to a force :math:`t^k` (Duhamel); :math:`J_k`
is the integral of a mode times :math:`t^k`.  Both are summed as power series near zero and by their upward
recurrences elsewhere: :math:`K_k = (k K_{k-1} - 1)/z`, :math:`J_k = (e^z - k J_{k-1})/z`.
"""

from __future__ import annotations

from functools import cache
from math import factorial

import numpy as np

from pound_solve.numerics.types import Array, Complex


def _near(degree: int) -> tuple[float, int]:
    """Return the radius within which the series is used, and its number of terms for an error of 1e-17.

    The recurrence multiplies rounding errors by k!/|z|^k; for a negative argument the series multiplies
    them by e^|z|.
    """
    return (0.3, 13) if degree <= 1 else (1.5, 25) if degree <= 3 else (4.0, 38)


@cache
def _series(degree: int, of_duhamel: bool) -> Array:
    """Return the power-series coefficients of all K_k or J_k, lowest power first, (n_terms, degree + 1).

    ``K_k = k! sum z^n / (n + k + 1)!`` and ``J_k = sum z^n / (n! (n + k + 1))``; see `_near`.
    """
    count = _near(degree)[1]
    coefs = np.empty((count, degree + 1))
    for k in range(degree + 1):
        for n in range(count):
            coefs[n, k] = (
                factorial(k) / factorial(n + k + 1) if of_duhamel else 1.0 / (factorial(n) * (n + k + 1))
            )
    return coefs


def _sum_series(z: Complex, degree: int, of_duhamel: bool) -> Complex:
    """Sum the series of all k at once for a row of arguments, shape (degree + 1, n)."""
    coefs = _series(degree, of_duhamel)
    powers: Complex = np.empty((len(coefs), len(z)), complex)
    powers[0] = 1.0
    powers[1:] = z
    np.multiply.accumulate(powers, axis=0, out=powers)
    return coefs.T @ powers


def duhamel(z: Complex, degree: int, exp_z: Complex | None = None) -> Complex:
    """Return ``K_0 .. K_degree``, shape ``(degree + 1, *z.shape)``; see the module docstring."""
    z = np.asarray(z, complex)
    integrals = np.empty((degree + 1, *z.shape), complex)
    small = np.abs(z) < _near(degree)[0]
    safe = np.where(small, 1.0, z)
    integrals[0] = np.expm1(z) / safe if exp_z is None else (exp_z - 1.0) / safe
    for k in range(1, degree + 1):
        integrals[k] = (k * integrals[k - 1] - 1.0) / safe
    if small.any():
        integrals[:, small] = _sum_series(z[small], degree, True)
    return integrals


def moments(z: Complex, degree: int) -> Complex:
    """Return ``J_0 .. J_degree``, shape ``(degree + 1, *z.shape)``; see the module docstring."""
    z = np.asarray(z, complex)
    integrals = np.empty((degree + 1, *z.shape), complex)
    small = np.abs(z) < _near(degree)[0]
    safe = np.where(small, 1.0, z)
    exp_z = np.exp(z)
    integrals[0] = (exp_z - 1.0) / safe
    for k in range(1, degree + 1):
        integrals[k] = (exp_z - k * integrals[k - 1]) / safe
    if small.any():
        integrals[:, small] = _sum_series(z[small], degree, False)
    return integrals
