r"""Free vibration: :math:`(K - \omega^2 M)\,\phi = 0` on the freedoms that have stiffness.

Massless freedoms are condensed first, which is exact for free vibration.  Modes are scaled to
:math:`\phi^T M \phi = 1` with the largest component positive.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Modes:
    """Natural modes.

    Attributes
    ----------
    omega : ndarray, shape (n_modes,)
        Circular frequencies [rad/T], ascending.
    shapes : ndarray, shape (n, n_modes)
        Mass-normalised shapes.
    """

    omega: Array
    shapes: Array


def massless(m: Array) -> NDArray[np.bool_]:
    """Which freedoms have no mass at all, shape (n,)."""
    return ~np.any(m != 0.0, axis=1)


def scaling(k: Array) -> Array:
    """Factors that make a diagonal of ones of K, shape (n,)."""
    diagonal = np.abs(np.diag(k))
    return 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))


def deficiency(k: Array) -> int:
    """How many independent motions K, scaled to a diagonal of ones,
    does not resist (mechanisms, rigid bodies).

    Pivots, not eigenvalues, tell a mechanism from a slender mesh: those of a cantilever
    of n members fall as n^-3 (its eigenvalues as n^-4), those of a mechanism are rounding.
    Without pivoting rounding may grow as n^3.
    """
    try:
        if np.diag(np.linalg.cholesky(k)).min(initial=1.0) ** 2 > 1e-7:
            return 0
    except np.linalg.LinAlgError:
        pass
    from scipy.linalg.lapack import dpstrf  # pivoting: of no use to the common run, and slow to import

    return len(k) - int(dpstrf(k, tol=1e-15 * max(len(k), 10))[2])


def condense(k: Array, out: NDArray[np.bool_]) -> Array:
    """Map from the kept freedoms to all, with those of `out` following statically, shape (n, n_kept).

    Freedoms of `out` without any stiffness stay at zero.

    Raises
    ------
    numpy.linalg.LinAlgError
        The stiffness of `out` is singular: part of it is a mechanism.
    """
    n = len(k)
    keep = np.flatnonzero(~out)
    go = np.flatnonzero(out & np.any(k != 0.0, axis=1))
    t = np.zeros((n, len(keep)))
    t[keep, np.arange(len(keep))] = 1.0
    if len(go):
        t[go] = -np.linalg.solve(k[np.ix_(go, go)], k[np.ix_(go, keep)])
    return t


def solve(k: Array, m: Array) -> Modes:
    """Return all modes of the freedoms that have mass and are tied to any stiffness.

    Parameters
    ----------
    k, m : ndarray, shape (n, n)
        Stiffness [F/L] and mass [F T^2/L].

    Raises
    ------
    numpy.linalg.LinAlgError
        A massless part is a mechanism, or the mass matrix is not positive definite.
    """
    active = np.any(k != 0.0, axis=1)
    t = condense(k, massless(m) | ~active)
    kk, mm = t.T @ k @ t, t.T @ m @ t
    if not len(kk):
        return Modes(np.zeros(0), np.zeros((len(k), 0)))
    if np.any(mm - np.diag(np.diag(mm))):
        # a mass on a slaved node is felt along fewer directions than its master has:
        # the rest is massless too
        root = 1.0 / np.sqrt(np.diag(mm))
        share, basis = np.linalg.eigh(root[:, None] * mm * root)
        if share[0] < 1e-13 * len(share):
            turned = root[:, None] * basis
            t = t @ turned @ condense(turned.T @ kk @ turned, share < 1e-13 * len(share))
            kk, mm = t.T @ k @ t, t.T @ m @ t
    values, shapes = _eigen(kk, mm)
    full = t @ shapes
    # signs free of rounding: the first component within a hair of the largest is positive
    big = np.abs(full) > (1 - 1e-9) * np.abs(full).max(axis=0)
    sign = np.sign(full[np.argmax(big, axis=0), np.arange(full.shape[1])])
    return Modes(np.sqrt(values), full * sign)


def generalised(k: Array, m: Array) -> tuple[Array, Array]:
    """Squared frequencies, ascending, and mass-normalised shapes of K and a positive definite M.

    All values carry the rounding of the largest.
    """
    if not np.any(m - np.diag(np.diag(m))):
        root = 1.0 / np.sqrt(np.diag(m))
        values, vectors = np.linalg.eigh(root[:, None] * k * root)
        return values, root[:, None] * vectors
    lower = np.linalg.inv(np.linalg.cholesky(m))
    values, vectors = np.linalg.eigh(lower @ k @ lower.T)
    return values, lower.T @ vectors


def _eigen(k: Array, m: Array) -> tuple[Array, Array]:
    """`generalised`, with rigid-body modes told from slow ones, and these sharpened."""
    values, shapes = generalised(k, m)
    size = scaling(k)
    scaled = size[:, None] * k * size
    rigid = np.arange(len(k)) < deficiency(scaled)  # rounding leaves them at +-1e-16 of the largest value
    values = np.where(rigid, 0.0, np.maximum(values, 0.0))
    low = values < 1e-5 * values[-1]
    if low.any() and not rigid.any():
        # values far below the largest have lost digits to it: sharpen them by one step of inverse iteration
        push = m @ shapes[:, low]
        x = size[:, None] * np.linalg.solve(scaled, size[:, None] * push)
        scale = 1.0 / np.linalg.norm(x, axis=0)
        x, push = x * scale, push * scale
        work, energy = push.T @ x, x.T @ m @ x
        lower = np.linalg.inv(np.linalg.cholesky(0.5 * (work + work.T)))
        squares, y = np.linalg.eigh(lower @ energy @ lower.T)  # of 1 / omega^2
        squares, y = squares[::-1], lower.T @ y[:, ::-1]
        values[low], shapes[:, low] = 1.0 / squares, x @ (y / np.sqrt(squares))
    return values, shapes
