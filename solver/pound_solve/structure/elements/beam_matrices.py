r"""Local matrices of the Timoshenko beam, and its joints condensed.

Local axes: x from I to J, y to its left.  Interpolation over the flexible length with :math:`\xi = x/L`:

.. math::
    N_1 &= \frac{1 - 3\xi^2 + 2\xi^3 + \phi(1-\xi)}{1+\phi}, &
    N_2 &= \frac{L(\xi - 2\xi^2 + \xi^3 + \tfrac{\phi}{2}(\xi - \xi^2))}{1+\phi}

(mirrored at J), which solves the unloaded Timoshenko beam, so nodal results are exact for both end loads
and consistent loads.

References
----------
Przemieniecki JS (1968), Theory of Matrix Structural Analysis, McGraw-Hill, sections 5.6 and 11.3.
"""

from __future__ import annotations

import numpy as np

from pound_solve.numerics.types import Array

# Gauss points and weights on (0, 1): four points integrate the products of cubics exactly
GAUSS_X, GAUSS_W = (a for a in np.polynomial.legendre.leggauss(4))
GAUSS_X, GAUSS_W = 0.5 * (GAUSS_X + 1.0), 0.5 * GAUSS_W


def shapes(xi: float, length: float, phi: float) -> Array:
    """Interpolation of axial and transverse displacement, shape (2, 6), at `xi` in [0, 1]."""
    d = 1.0 + phi
    n = np.zeros((2, 6))
    n[0, 0], n[0, 3] = 1.0 - xi, xi
    n[1, 1] = (1 - 3 * xi**2 + 2 * xi**3 + phi * (1 - xi)) / d
    n[1, 2] = length * (xi - 2 * xi**2 + xi**3 + phi / 2 * (xi - xi**2)) / d
    n[1, 4] = (3 * xi**2 - 2 * xi**3 + phi * xi) / d
    n[1, 5] = length * (-(xi**2) + xi**3 - phi / 2 * (xi - xi**2)) / d
    return n


def slopes(xi: float, length: float, phi: float) -> Array:
    """Derivative of the transverse displacement along the member, shape (6,)."""
    a, b = (6 * xi * (xi - 1) - phi) / length, 1 - 4 * xi + 3 * xi**2
    half = phi / 2 * (1 - 2 * xi)
    row = np.array([0.0, a, b + half, 0.0, -a, 3 * xi**2 - 2 * xi - half])
    return row / (1.0 + phi)


def stiffness(ea: float, ei: float, length: float, phi: float) -> Array:
    """Local stiffness of the flexible part, shape (6, 6), [F/L, F, F L]."""
    k = np.zeros((6, 6))
    k[0, 0] = k[3, 3] = ea / length
    k[0, 3] = k[3, 0] = -ea / length
    a, b = 12 * ei / length**3 / (1 + phi), 6 * ei / length**2 / (1 + phi)
    c, d = (4 + phi) * ei / length / (1 + phi), (2 - phi) * ei / length / (1 + phi)
    k[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = [[a, b, -a, b], [b, c, -b, d], [-a, -b, a, -b], [b, d, -b, c]]
    return k


def end_blocks(at_i: float, at_j: float) -> Array:
    """Local displacements of the flexible ends from those of the nodes, shape (6, 6)."""
    t = np.eye(6)
    t[1, 2], t[4, 5] = at_i, -at_j
    return t


def soften(k: Array, pins: list[int], soft: Array) -> tuple[Array, Array, Array]:
    """Put pins and flexibilities between the beam's ends and their supports.

    With loads f on the beam its ends x follow the held displacements u by
    ``u - x = soft (k x - f)``, and a pinned end by ``0 = k x - f``.

    Parameters
    ----------
    k : ndarray, shape (6, 6)
        Local stiffness of the beam.
    pins : list of int
        Local DOFs that are not held.
    soft : ndarray, shape (6, 6)
        Flexibility of the joints [L/F, 1/F, 1/(F L)]; negative if the beam is stiffened.

    Returns
    -------
    forces, shape, flexibility : ndarray, shape (6, 6)
        End forces and x for unit u, and x for unit f.
    """
    if not pins and not soft.any():
        return k.copy(), np.eye(6), np.zeros((6, 6))
    held, b = np.ones(6), soft.copy()
    if pins and k[np.ix_(pins, pins)].any():  # an axial bar has no bending stiffness to condense
        held[pins] = 0.0
        b[pins] = 0.0
        b[pins, pins] = 1.0
    whole = np.diag(held) + b @ k
    shape, flexibility = (np.asarray(np.linalg.solve(whole, x), float) for x in (np.diag(held), b))
    forces = k @ shape
    # rounding must not count as stiffness, since it would hide a mechanism
    forces[pins] = 0.0
    if len(pins) == 2:
        forces[[1, 4]] = 0.0
    return forces, shape, flexibility


def spare(k: Array, length: float, ea: float, joints: Array, taken: Array, pins: list[int]) -> float:
    """Multiple of the flexibility `taken` from the ends at which the beam would have none left."""
    flexibility = np.zeros((3, 3))
    flexibility[0, 0] = length / ea
    flexibility[1:, 1:] = np.linalg.inv(k[np.ix_([2, 5], [2, 5])])
    chord = np.array([0.0, 1.0, 0.0, 0.0, -1.0, 0.0]) / length
    natural = np.array([[-1, 0, 0, 1, 0, 0], np.eye(6)[2] + chord, np.eye(6)[5] + chord])
    free = [0] + [n for n, d in ((1, 2), (2, 5)) if d not in pins]
    at = np.ix_(free, free)
    flexibility, less = (flexibility + natural @ joints @ natural.T)[at], (natural @ taken @ natural.T)[at]
    return float(1.0 / np.linalg.eigvals(np.linalg.solve(flexibility, less)).real.max())


def block_mass(m: float, length: float, sign: float) -> Array:
    """Mass of a rigid end block on (axial, transverse, rotation) of its node, shape (3, 3)."""
    s = sign * m * length**2 / 2
    return np.array([[m * length, 0, 0], [0, m * length, s], [0, s, m * length**3 / 3]])
