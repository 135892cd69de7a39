r"""Two families of integrals of the exponential against powers, for complex arguments.

.. math:: K_k(z) = \int_0^1 e^{z(1-x)} x^k\,dx, \qquad J_k(z) = \int_0^1 e^{zx} x^k\,dx

:math:`K_k = k!\,\varphi_{k+1}(z)` answers a mode under a force :math:`t^k` (Duhamel); :math:`J_k` integrates a mode
against :math:`t^k`.  Both are summed as power series near zero and by their upward recurrences elsewhere:
:math:`K_k = (k K_{k-1} - 1)/z`, :math:`J_k = (e^z - k J_{k-1})/z`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Complex = NDArray[np.complex128]


def _near(degree: int) -> float:
    # the recurrence multiplies rounding by k!/|z|^k; the series loses e^|z| for a negative argument
    return 1.0 if degree <= 1 else 4.0


def duhamel(z: Complex, degree: int, exp_z: Complex | None = None) -> Complex:
    """Return ``K_0 .. K_degree``, shape ``(degree + 1, *z.shape)``; see the module's head."""
    z = np.asarray(z, complex)
    out = np.empty((degree + 1, *z.shape), complex)
    small = np.abs(z) < _near(degree)
    safe = np.where(small, 1.0, z)
    if exp_z is None:
        exp_z = np.exp(z)
    out[0] = (exp_z - 1.0) / safe
    for k in range(1, degree + 1):
        out[k] = (k * out[k - 1] - 1.0) / safe
    if small.any():
        zs = z[small]
        for k in range(degree + 1):
            out[k, small] = _series(zs, lambda n, k=k: 1.0 / (n + k + 1))  # type: ignore[misc]
    return out


def moments(z: Complex, degree: int) -> Complex:
    """Return ``J_0 .. J_degree``, shape ``(degree + 1, *z.shape)``; see the module's head."""
    z = np.asarray(z, complex)
    out = np.empty((degree + 1, *z.shape), complex)
    small = np.abs(z) < _near(degree)
    safe = np.where(small, 1.0, z)
    exp_z = np.exp(np.where(small, 0.0, z))
    out[0] = (exp_z - 1.0) / safe
    for k in range(1, degree + 1):
        out[k] = (exp_z - k * out[k - 1]) / safe
    if small.any():
        zs = z[small]
        for k in range(degree + 1):
            total = np.zeros_like(zs)
            term = np.ones_like(zs)
            for n in range(60):
                total += term / (n + k + 1)
                term = term * zs / (n + 1)
                if np.abs(term).max() < 1e-18:
                    break
            out[k, small] = total
    return out


def _series(z: Complex, ratio) -> Complex:  # type: ignore[no-untyped-def]
    """Sum ``a_0 + a_1 + ...`` with ``a_0 = ratio(0)`` and ``a_n = a_(n-1) * z * ratio(n)``: k! sum z^n/(n+k+1)!."""
    term = np.full_like(z, ratio(0))
    total = term.copy()
    for n in range(1, 80):
        term = term * z * ratio(n)
        total += term
        if np.abs(term).max() < 1e-18:
            break
    return total
