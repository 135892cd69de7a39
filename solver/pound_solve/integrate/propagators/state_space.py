r"""First-order form of a linear subsystem, massless DOFs eliminated.

.. math:: M\ddot u + C\dot u + K u = p(t) \quad\Rightarrow\quad \dot z = A z + B p

The DOFs with mass are written in the undamped modes, :math:`u = \Phi\eta`, with the state
:math:`z = (\omega\eta, \dot\eta)`, which balances displacement against velocity and leaves a nearly normal
matrix.  Massless DOFs are eliminated: DOFs on which a dashpot acts keep a first-order state; the others
follow statically.

References
----------
Foss KA (1958), J. Appl. Mech. 25: 361-364 (first-order form of damped systems).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pound_solve.numerics.modes import generalised
from pound_solve.numerics.types import Array, Flags

#: modes with omega^2 below this fraction of the largest are solved again in their subspace
SLOW_MODES = 1e-3
RIGID_MODE = 1e-14  #: omega^2 below this fraction of the rounding scale (times the size): rigid-body mode
DEPENDENT = 1e-12  #: singular values of constraints below this fraction of the largest count as zero


class Mechanism(Exception):
    """Massless DOFs have neither stiffness nor dashpot, or a negative stiffness (`softens`); `shape` is
    their motion over the subsystem's DOFs.
    """

    def __init__(self, shape: Array, softens: bool) -> None:
        super().__init__("massless degrees of freedom without stiffness")
        self.shape, self.softens = shape, softens


@dataclass(frozen=True)
class StateSpace:
    """First-order form of a subsystem:
    ``z' = a z + b p``, ``u = u_z z + u_p p``, ``v = v_z z + v_p p + u_p p'``.

    Attributes
    ----------
    a : ndarray, shape (n_z, n_z)
    b : ndarray, shape (n_z, n)
    u_z, v_z : ndarray, shape (n, n_z)
    z_u, z_v : ndarray, shape (n_z, n)
        Give the state from displacement and velocity, ``z = z_u u + z_v v``.
    u_p, v_p : ndarray, shape (n, n), or None
        None without massless DOFs.
    rigid : tuple of (int, int)
        Pairs (displacement, velocity) of states that are undamped rigid-body modes.
    """

    a: Array
    b: Array
    u_z: Array
    v_z: Array
    z_u: Array
    z_v: Array
    u_p: Array | None
    v_p: Array | None
    rigid: tuple[tuple[int, int], ...]


def state_space(m: Array, c: Array, k: Array) -> StateSpace:
    """Return the balanced first-order form of a subsystem, massless DOFs eliminated.

    Parameters
    ----------
    m, c, k : ndarray, shape (n, n)
        Mass, damping and stiffness, symmetric.

    Raises
    ------
    Mechanism
        Massless DOFs with neither stiffness nor dashpot.
    """
    with_mass = np.any(m != 0.0, axis=1)
    if with_mass.all():
        return _second_order(m, c, k)
    n_mass = int(with_mass.sum())
    keep, u_p, back = _without_static_dofs(c, k, with_mass)
    return _with_relaxing_dofs(
        n_mass, keep.T @ m @ keep, keep.T @ c @ keep, keep.T @ k @ keep, keep, u_p, back
    )


def _without_static_dofs(c: Array, k: Array, with_mass: Flags) -> tuple[Array, Array, Array]:
    """Eliminate the massless DOFs without dashpots: ``u = keep x + u_p p``, ``x = back u``.

    x holds the DOFs with mass, then the coordinates of massless DOFs in the range of C.
    """
    n = len(with_mass)
    massless, massive = np.flatnonzero(~with_mass), np.flatnonzero(with_mass)
    values, vectors = np.linalg.eigh(c[np.ix_(massless, massless)])
    damped = values > 1e-12 * max(np.abs(c).max(), 1e-300)
    basis = np.zeros((n, n))
    basis[massive, np.arange(len(massive))] = 1.0
    basis[np.ix_(massless, len(massive) + np.arange(len(massless)))] = np.hstack(
        [vectors[:, damped], vectors[:, ~damped]]
    )
    n_x = len(massive) + int(damped.sum())
    # the basis is orthonormal apart from the eliminated part
    back = np.asarray(np.linalg.pinv(basis[:, :n_x]), float)
    if n_x == n:
        return basis, np.zeros((n, n)), back
    kb = basis.T @ k @ basis
    static = kb[n_x:, n_x:]
    low, shapes = np.linalg.eigh(static)
    none = 1e-13 * max(np.abs(np.diag(kb)).max(), 1e-300)
    if low[0] <= none:
        raise Mechanism(basis[:, n_x:] @ shapes[:, 0], bool(low[0] < -none))
    flexibility = np.linalg.inv(static)
    keep = basis[:, :n_x] - basis[:, n_x:] @ flexibility @ kb[n_x:, :n_x]
    return keep, basis[:, n_x:] @ flexibility @ basis[:, n_x:].T, back


def _with_relaxing_dofs(
    n_mass: int, m: Array, c: Array, k: Array, keep: Array, u_p: Array, back: Array
) -> StateSpace:
    """Return the first-order form for ``n_mass`` DOFs with mass, then massless DOFs d with dashpots.

    ``d' = C_dd^-1 (p_d - C_dh v - K_dh u - K_dd d)`` is substituted into the equations of those with mass.
    `keep`, `u_p` and `back` relate these DOFs to all DOFs of the subsystem (see `_without_static_dofs`).
    """
    n, n_x, n_damped = len(u_p), len(m), len(m) - n_mass
    h, d = slice(0, n_mass), slice(n_mass, n_x)
    inverse_damping = np.linalg.inv(c[d, d]) if n_damped else np.zeros((0, 0))
    to_h = c[h, d] @ inverse_damping
    c_h = c[h, h] - to_h @ c[d, h]
    k_h = k[h, h] - to_h @ k[d, h]
    k_hd = k[h, d] - to_h @ k[d, d]
    # scaled to the root of the energy with the dashpots' DOFs held
    omega2, phi = _undamped_modes(m[h, h], k[h, h])
    top = np.abs(omega2).max(initial=0.0)
    scale = np.sqrt(np.where(np.abs(omega2) > 1e-12 * top, np.abs(omega2), min(1.0, top) if top else 1.0))
    # displacements of damped massless DOFs are scaled to the root of their energy, like the others
    scale_d = np.sqrt(np.abs(np.diag(k)[d]))
    scale_d[scale_d == 0.0] = 1.0
    inverse_damping_z = scale_d[:, None] * inverse_damping
    size = 2 * n_mass + n_damped
    zu, zv, zd = slice(0, n_mass), slice(n_mass, 2 * n_mass), slice(2 * n_mass, size)
    a = np.zeros((size, size))
    a[zu, zv] = np.diag(scale)
    a[zv, zu] = -(phi.T @ k_h @ phi) / scale
    a[zv, zv] = -phi.T @ c_h @ phi
    a[zv, zd] = -phi.T @ k_hd / scale_d
    a[zd, zu] = -inverse_damping_z @ k[d, h] @ phi / scale
    a[zd, zv] = -inverse_damping_z @ c[d, h] @ phi
    a[zd, zd] = -inverse_damping_z @ k[d, d] / scale_d
    b = np.zeros((size, n))
    b[zv] = phi.T @ (keep[:, h].T - to_h @ keep[:, d].T)
    b[zd] = inverse_damping_z @ keep[:, d].T
    x_z, xdot_z = np.zeros((n_x, size)), np.zeros((n_x, size))
    x_z[h, zu] = phi / scale
    x_z[d, zd] = np.diag(1.0 / scale_d)
    xdot_z[h, zv] = phi
    xdot_z[d] = a[zd] / scale_d[:, None]
    z_u, z_v = np.zeros((size, n)), np.zeros((size, n))
    z_u[zu] = (scale[:, None] * phi.T @ m[h, h]) @ back[h]
    z_v[zv] = (phi.T @ m[h, h]) @ back[h]
    z_u[zd] = scale_d[:, None] * back[d]
    v_p = keep[:, d] @ inverse_damping @ keep[:, d].T if n_damped else np.zeros((n, n))
    return StateSpace(a, b, keep @ x_z, keep @ xdot_z, z_u, z_v, u_p, v_p, ())


def held_space(m: Array, c: Array, k: Array, rows: Array) -> StateSpace:
    r"""Return the first-order form of a subsystem with prescribed deformations, ``rows u = x(t)``.

    With :math:`u = T y + W x`, where T is a basis of the null space of the rows and W their pseudo-inverse,

    .. math:: T^T M T\ddot y + T^T C T\dot y + T^T K T y = T^T (p - K W x - C W\dot x - M W\ddot x)

    is a subsystem without constraints.  The loads are ``p`` extended by :math:`x, \dot x, \ddot x`.

    Parameters
    ----------
    m, c, k : ndarray, shape (n, n)
    rows : ndarray, shape (n_held, n)
        Only DOFs with mass occur in them.

    Raises
    ------
    Mechanism
        Massless DOFs with neither stiffness nor dashpot.
    """
    n = len(m)
    touched = np.flatnonzero(rows.any(axis=0))
    others = np.delete(np.arange(n), touched)
    _, size, right = np.linalg.svd(rows[:, touched])
    null = right[int((size > DEPENDENT * size[0]).sum()) :].T
    t = np.zeros((n, null.shape[1] + len(others)))
    t[touched, : null.shape[1]] = null
    t[others, null.shape[1] + np.arange(len(others))] = 1.0
    w = np.linalg.pinv(rows, rcond=DEPENDENT)
    try:
        inner = state_space(t.T @ m @ t, t.T @ c @ t, t.T @ k @ t)
    except Mechanism as err:
        raise Mechanism(t @ err.shape, err.softens) from None
    load = t.T @ np.hstack([np.eye(n), -k @ w, -c @ w, -m @ w])
    u_p, v_p = np.zeros((n, load.shape[1])), np.zeros((n, load.shape[1]))
    if inner.u_p is not None and inner.v_p is not None:
        u_p, v_p = t @ inner.u_p @ load, t @ inner.v_p @ load
    u_p[:, n : n + len(rows)] += w
    return StateSpace(
        a=inner.a,
        b=inner.b @ load,
        u_z=t @ inner.u_z,
        v_z=t @ inner.v_z,
        z_u=inner.z_u @ t.T,
        z_v=inner.z_v @ t.T,
        u_p=u_p,
        v_p=v_p,
        rigid=inner.rigid,
    )


def _second_order(m: Array, c: Array, k: Array) -> StateSpace:
    """Return the first-order form of a subsystem all of whose DOFs have mass."""
    n = len(m)
    omega2, phi = _undamped_modes(m, k)
    top = np.abs(omega2).max(initial=0.0)
    zero_stiffness = _are_rigid(omega2, _rounding_scale(phi, k))
    omega2 = np.where(zero_stiffness, 0.0, omega2)
    # separate the undamped modes from the damped ones among the rigid-body modes
    rigid_phi = phi[:, zero_stiffness]
    phi[:, zero_stiffness] = rigid_phi @ np.linalg.eigh(rigid_phi.T @ c @ rigid_phi)[1]
    # the scale of a rigid mode's displacement is arbitrary; that of a diverging mode (negative stiffness)
    # is its rate
    scale = np.sqrt(np.abs(omega2))
    scale[scale == 0.0] = min(1.0, np.sqrt(top)) if top else 1.0
    damping = phi.T @ c @ phi
    a = np.zeros((2 * n, 2 * n))
    a[:n, n:] = np.diag(scale)
    a[n:, :n] = np.diag(-omega2 / scale)
    a[n:, n:] = -damping
    undamped = np.abs(damping).max(axis=1, initial=0.0) <= 1e-14 * np.abs(damping).max(initial=0.0)
    zero, to_modes = np.zeros((n, n)), phi.T @ m
    return StateSpace(
        a=a,
        b=np.vstack([zero, phi.T]),
        u_z=np.hstack([phi / scale, zero]),
        v_z=np.hstack([zero, phi]),
        z_u=np.vstack([scale[:, None] * to_modes, zero]),
        z_v=np.vstack([zero, to_modes]),
        u_p=None,
        v_p=None,
        rigid=tuple((int(i), int(n + i)) for i in np.flatnonzero(zero_stiffness & undamped)),
    )


def _undamped_modes(m: Array, k: Array) -> tuple[Array, Array]:
    """Return the squared frequencies and mass-normalised modes of K and a positive definite M.

    All squared frequencies have the absolute rounding of the largest.  Therefore the slow modes are
    orthogonalised against the fast ones and solved again in their subspace.  Otherwise a node with little
    mass beside nodes with much mass would cost the slow modes half their digits.
    """
    omega2, phi = generalised(k, m)
    slow = np.arange(len(omega2))
    # down to the rounding of the assembled stiffness
    while len(slow) and np.abs(omega2[slow]).max() > SLOW_MODES * _rounding_scale(phi[:, slow], k).max():
        chosen = np.abs(omega2[slow]) < SLOW_MODES * np.abs(omega2[slow]).max()
        fast, slow = slow[~chosen], slow[chosen]
        shapes = phi[:, slow]
        shapes = shapes - phi[:, fast] @ ((phi[:, fast].T @ (k @ shapes)) / omega2[fast][:, None])
        omega2[slow], vectors = np.linalg.eigh(shapes.T @ k @ shapes)
        phi[:, slow] = shapes @ vectors
    return omega2, phi


def _are_rigid(omega2: Array, scale: Array) -> Flags:
    """Return which squared frequencies are rounding, given their rounding scale (see `_rounding_scale`).

    The shapes of several rigid-body modes are known only as linear combinations of each other.  A shape
    without any stiffness has almost no rounding scale; its rounding is that of the other shapes in the
    combination.
    """
    share, size = RIGID_MODE * len(omega2), np.abs(omega2)
    rigid = size <= share * scale
    mixed = np.sqrt(scale * scale[rigid].max(initial=0.0))
    return np.asarray(rigid | (size < share * np.maximum(mixed, share * size.max(initial=0.0))))


def _rounding_scale(shapes: Array, k: Array) -> Array:
    """Return the sum of magnitudes of the terms of each shape's quadratic form; 1e-16 of it is rounding."""
    return np.asarray(np.einsum("ri,rs,si->i", np.abs(shapes), np.abs(k), np.abs(shapes), optimize=True))
