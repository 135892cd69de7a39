r"""Exact solution of a linear block between events.

.. math:: M\ddot u + C\dot u + K u = p(t) = F s(t) + f, \qquad s(t)\ \text{polynomial in } t

The massive DOFs are written in the undamped modes, :math:`u = \Phi\eta`,
with the state :math:`z = (\omega\eta, \dot\eta)`, which balances displacement
against velocity and leaves a nearly normal matrix.  Its complex modes :math:`q` are uncoupled,
:math:`\dot q_i = \lambda_i q_i + \sum_k g_{ik} t^k`, hence

.. math:: q_i(t) = e^{\lambda_i t} q_i(0) + \sum_k g_{ik}\, t^{k+1} K_k(\lambda_i t)

(:mod:`~pound_solve.numerics.phi`).  Undamped rigid-body modes are polynomials and are kept apart, so that
the double eigenvalue zero of a plastic storey needs no special care.  Massless DOFs are eliminated:
those that a dashpot moves keep a first-order state, the others follow statically.

Where the modes do not span the space (critical damping, repeated defective eigenvalues)
`SeriesPropagator` takes over: the exponential series of the same matrix, exact to rounding as well, only
slower.

References
----------
Nigam NC, Jennings PC (1969), Bull. Seism. Soc. Am. 59: 909-922 (exact integration for straight-line
accelerograms); Foss KA (1958), J. Appl. Mech. 25: 361-364 (complex modes of damped systems).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_solve.numerics import phi, polynomial
from pound_solve.numerics.modes import generalised
from pound_solve.numerics.types import Array, Complex, Flags

MOST_CONDITION = 1e6  #: of the mode matrix; beyond it the series is used
SLOW = 1e-3  #: omega^2 below this share of the largest is sought again among the slow modes
TERMS = 22  #: of a Taylor series over 1 / (fastest eigenvalue): 1/22! is 1e-21
RECURRING = 64  #: lengths of segments for which the response is kept
RIGID = 1e-14  #: omega^2 below this share of the rounding scale (times the size) is a rigid-body mode


#: k! m! / (k + m + 1)!: what the m-th of `Propagator._derivatives` makes of a force t^k
_SHARES = [
    np.array([factorial(k) * factorial(m) / factorial(k + m + 1) for m in range(TERMS - k - 1)])
    for k in range(TERMS - 1)
]


class Mechanism(Exception):
    """Massless DOFs that nothing holds; `shape` is their motion over the block's DOFs."""

    def __init__(self, shape: Array) -> None:
        super().__init__("massless degrees of freedom without stiffness")
        self.shape = shape


@dataclass(frozen=True)
class StateSpace:
    """First-order form of a block:
    ``z' = a z + b p``, ``u = u_z z + u_p p``, ``v = v_z z + v_p p + u_p p'``.

    `enter` maps (u, v) to z: ``z = z_u u + z_v v``.  `rigid` lists pairs (displacement, velocity) of states
    that are undamped rigid-body modes.
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
    """Return the balanced first-order form of a block, massless DOFs eliminated.

    Parameters
    ----------
    m, c, k : ndarray, shape (n, n)
        Mass, damping and stiffness, symmetric.

    Raises
    ------
    Mechanism
        Massless DOFs with neither stiffness nor dashpot.
    """
    n = len(m)
    heavy = np.any(m != 0.0, axis=1)
    if heavy.all():
        return _second_order(m, c, k)
    z = np.flatnonzero(~heavy)
    h = np.flatnonzero(heavy)
    # split the massless DOFs into what dashpots move (range of C)
    # and what follows statically (its kernel)
    values, vectors = np.linalg.eigh(c[np.ix_(z, z)])
    damped = values > 1e-12 * max(np.abs(c).max(), 1e-300)
    basis = np.zeros((n, n))
    basis[h, np.arange(len(h))] = 1.0
    basis[np.ix_(z, len(h) + np.arange(len(z)))] = np.hstack([vectors[:, damped], vectors[:, ~damped]])
    n1 = len(h) + int(damped.sum())  # states' displacements: heavy, then damped massless
    kb = basis.T @ k @ basis
    knn = kb[n1:, n1:]
    if n1 < n:
        low, shapes = np.linalg.eigh(knn)
        if low[0] <= 1e-13 * max(np.abs(np.diag(kb)).max(), 1e-300):
            raise Mechanism(basis[:, n1:] @ shapes[:, 0])
        flex = np.linalg.inv(knn)
        keep = basis[:, :n1] - basis[:, n1:] @ flex @ kb[n1:, :n1]  # u = keep x + u_p p
        u_p = basis[:, n1:] @ flex @ basis[:, n1:].T
    else:
        keep, u_p = basis, np.zeros((n, n))
    k1, c1, m1 = keep.T @ k @ keep, keep.T @ c @ keep, keep.T @ m @ keep
    nh, nd = len(h), n1 - len(h)
    rate = np.linalg.inv(c1[nh:, nh:]) if nd else np.zeros((0, 0))
    # d' = rate (p_d - c_dh v - k_dh u - k_dd d); put into the heavy equations
    to_h = c1[:nh, nh:] @ rate
    c_h = c1[:nh, :nh] - to_h @ c1[nh:, :nh]
    k_h = k1[:nh, :nh] - to_h @ k1[nh:, :nh]
    k_hd = k1[:nh, nh:] - to_h @ k1[nh:, nh:]
    # scaled to the root of the energy with the dashpots' DOFs held
    omega2, phi_h = _undamped(m1[:nh, :nh], k1[:nh, :nh])
    top = np.abs(omega2).max(initial=0.0)
    scale = np.sqrt(np.where(np.abs(omega2) > 1e-12 * top, np.abs(omega2), min(1.0, top) if top else 1.0))
    size = 2 * nh + nd
    a = np.zeros((size, size))
    u, v, d = slice(0, nh), slice(nh, 2 * nh), slice(2 * nh, size)
    # like the others, displacements of damped massless DOFs are scaled to the root of their energy
    grip = np.sqrt(np.abs(np.diag(k1)[nh:]))
    grip[grip == 0.0] = 1.0
    rate_z = grip[:, None] * rate
    a[u, v] = np.diag(scale)
    a[v, u] = -(phi_h.T @ k_h @ phi_h) / scale
    a[v, v] = -phi_h.T @ c_h @ phi_h
    a[v, d] = -phi_h.T @ k_hd / grip
    a[d, u] = -rate_z @ k1[nh:, :nh] @ phi_h / scale
    a[d, v] = -rate_z @ c1[nh:, :nh] @ phi_h
    a[d, d] = -rate_z @ k1[nh:, nh:] / grip
    b = np.zeros((size, n))
    b[v] = phi_h.T @ (keep[:, :nh].T - to_h @ keep[:, nh:].T)
    b[d] = rate_z @ keep[:, nh:].T
    x_z = np.zeros((n1, size))
    x_z[:nh, u] = phi_h / scale
    x_z[nh:, d] = np.diag(1.0 / grip)
    xdot_z = np.zeros((n1, size))
    xdot_z[:nh, v] = phi_h
    xdot_z[nh:] = a[d] / grip[:, None]
    z_u, z_v = np.zeros((size, n)), np.zeros((size, n))
    back = np.linalg.pinv(basis[:, :n1])  # the basis is orthonormal apart from the eliminated part
    z_u[u] = (scale[:, None] * phi_h.T @ m1[:nh, :nh]) @ back[:nh]
    z_v[v] = (phi_h.T @ m1[:nh, :nh]) @ back[:nh]
    z_u[d] = grip[:, None] * back[nh:]
    v_p = keep[:, nh:] @ rate @ keep[:, nh:].T if nd else np.zeros((n, n))
    return StateSpace(a, b, keep @ x_z, keep @ xdot_z, z_u, z_v, u_p, v_p, ())


def held_space(m: Array, c: Array, k: Array, rows: Array) -> StateSpace:
    r"""Return the first-order form of a block some of whose deformations are held, ``rows u = x(t)``.

    With :math:`u = T y + W x`, T a basis of what the rows leave free and W their pseudo-inverse,

    .. math:: T^T M T\ddot y + T^T C T\dot y + T^T K T y = T^T (p - K W x - C W\dot x - M W\ddot x)

    is a block without constraints.  The forces are ``p`` extended by :math:`x, \dot x, \ddot x`.

    Parameters
    ----------
    m, c, k : ndarray, shape (n, n)
    rows : ndarray, shape (n_held, n)
        They touch massive DOFs only.
    """
    n = len(m)
    touched = np.flatnonzero(rows.any(axis=0))
    others = np.delete(np.arange(n), touched)
    _, size, turn = np.linalg.svd(rows[:, touched])
    null = turn[int((size > 1e-12 * size[0]).sum()) :].T
    t = np.zeros((n, null.shape[1] + len(others)))
    t[touched, : null.shape[1]] = null
    t[others, null.shape[1] + np.arange(len(others))] = 1.0
    w = np.linalg.pinv(rows, rcond=1e-12)
    try:
        inner = state_space(t.T @ m @ t, t.T @ c @ t, t.T @ k @ t)
    except Mechanism as err:
        raise Mechanism(t @ err.shape) from None
    push = t.T @ np.hstack([np.eye(n), -k @ w, -c @ w, -m @ w])
    u_p, v_p = np.zeros((n, push.shape[1])), np.zeros((n, push.shape[1]))
    if inner.u_p is not None and inner.v_p is not None:
        u_p, v_p = t @ inner.u_p @ push, t @ inner.v_p @ push
    u_p[:, n : n + len(rows)] += w
    back = t.T
    return StateSpace(
        inner.a,
        inner.b @ push,
        t @ inner.u_z,
        t @ inner.v_z,
        inner.z_u @ back,
        inner.z_v @ back,
        u_p,
        v_p,
        inner.rigid,
    )


def _undamped(m: Array, k: Array) -> tuple[Array, Array]:
    """Squared frequencies and mass-normalised modes of K and a positive definite M."""
    values, phi_u = generalised(k, m)
    # all values carry the rounding of the largest: cleared of the fast modes, the slow ones are solved
    # again among themselves (a light node beside heavy ones would cost the slow modes half their digits)
    slow = np.arange(len(values))
    # no further than their stiffness, as assembled, is known: what cancels in it is rounding
    while len(slow) and np.abs(values[slow]).max() > SLOW * _terms(phi_u[:, slow], k).max():
        chosen = np.abs(values[slow]) < SLOW * np.abs(values[slow]).max()
        fast, slow = slow[~chosen], slow[chosen]
        shapes = phi_u[:, slow]
        shapes = shapes - phi_u[:, fast] @ ((phi_u[:, fast].T @ (k @ shapes)) / values[fast][:, None])
        values[slow], turn = np.linalg.eigh(shapes.T @ k @ shapes)
        phi_u[:, slow] = shapes @ turn
    return values, phi_u


def _rigid(omega2: Array, terms: Array) -> Flags:
    """Which squared frequencies are rounding, from what makes them up (see `_terms`).

    Shapes of several rigid-body modes are known but for a mixture: one that no stiffness touches has next
    to nothing that makes up its own value, and the rounding of what joins it to the others.
    """
    share, size = RIGID * len(omega2), np.abs(omega2)
    still = size <= share * terms
    others = np.sqrt(terms * terms[still].max(initial=0.0))
    return np.asarray(still | (size < share * np.maximum(others, share * size.max(initial=0.0))))


def _terms(shapes: Array, k: Array) -> Array:
    """Sum of the magnitudes that make up each shape's quadratic form: its rounding is this times 1e-16."""
    return np.asarray(np.einsum("ri,rs,si->i", np.abs(shapes), np.abs(k), np.abs(shapes), optimize=True))


def _second_order(m: Array, c: Array, k: Array) -> StateSpace:
    n = len(m)
    omega2, phi_u = _undamped(m, k)
    top = np.abs(omega2).max(initial=0.0)
    still = _rigid(omega2, _terms(phi_u, k))
    omega2 = np.where(still, 0.0, omega2)
    # among rigid-body modes those without damping are told from the others
    phi_u[:, still] = phi_u[:, still] @ np.linalg.eigh(phi_u[:, still].T @ c @ phi_u[:, still])[1]
    # the scale of a rigid mode's displacement is free; that of a falling one
    # (negative stiffness) is its rate
    scale = np.sqrt(np.abs(omega2))
    scale[scale == 0.0] = min(1.0, np.sqrt(top)) if top else 1.0
    damping = phi_u.T @ c @ phi_u
    a = np.zeros((2 * n, 2 * n))
    a[:n, n:] = np.diag(scale)
    a[n:, :n] = np.diag(-omega2 / scale)
    a[n:, n:] = -damping
    zero = np.zeros((n, n))
    free = still & (np.abs(damping).max(axis=1, initial=0.0) <= 1e-14 * np.abs(damping).max(initial=0.0))
    rigid = tuple((int(i), int(n + i)) for i in np.flatnonzero(free))
    to_modes = phi_u.T @ m
    return StateSpace(
        a,
        np.vstack([zero, phi_u.T]),
        np.hstack([phi_u / scale, zero]),
        np.hstack([zero, phi_u]),
        np.vstack([scale[:, None] * to_modes, zero]),
        np.vstack([zero, to_modes]),
        None,
        None,
        rigid,
    )


def stacked(x: NDArray[Any], axis: int = 0) -> Array:
    """Real numbers of a state, or of several along other axes: its real parts, then its imaginary ones."""
    return np.concatenate([x.real, x.imag], axis) if np.iscomplexobj(x) else x


def on_stacked(rows: NDArray[Any]) -> Array:
    """Rows on a state as rows on what is `stacked` of it: half the work of a complex product."""
    return np.concatenate([rows.real, -rows.imag], axis=1) if np.iscomplexobj(rows) else rows


class Propagator(ABC):
    """A block's exact motion; the base of `ModalPropagator` and `SeriesPropagator`.

    Attributes
    ----------
    fastest : float
        Largest |eigenvalue| [1/T]: what the sampling grid must resolve.
    u_q, v_q : ndarray, shape (n, n_q)
    u_p, v_p : ndarray, shape (n, n), or None
        ``u = Re(u_q q) + u_p p``, ``v = Re(v_q q) + v_p p + u_p p'``; None without massless DOFs.
    condition, residual : float
        Of the matrix of modes; of its eigenvectors, relative to `fastest`.
    """

    fastest: float
    condition: float
    residual: float
    u_q: NDArray[Any]
    v_q: NDArray[Any]
    u_p: Array | None
    v_p: Array | None

    def __init__(self, space: StateSpace, inputs: Array) -> None:
        self.u_p, self.v_p = space.u_p, space.v_p
        self.inputs = inputs  # F, shape (n, n_inputs)

    @abstractmethod
    def enter(self, u: Array, v: Array) -> NDArray[Any]:
        """Return q at a given displacement and velocity."""

    @abstractmethod
    def forcing(self, coefs: Array, constant: Array) -> NDArray[Any]:
        """Return the forcing g of q, shape (..., degree + 1, n_q), from inputs' coefficients
        and a constant force.
        """

    @abstractmethod
    def push(self, p: Array) -> NDArray[Any]:
        """Return the forcing of q from force polynomials, shape (..., degree + 1, n)."""

    @abstractmethod
    def integral(self, q: NDArray[Any], g: NDArray[Any], t: float) -> NDArray[Any]:
        """Return the integral of q over (0, t)."""

    def march(self, q: NDArray[Any], gs: NDArray[Any], lengths: Array) -> NDArray[Any]:
        """Return q at the ends of successive intervals of some `lengths`,
        shape (n_q, n + 1), the start included.

        `gs`, shape (n, degree + 1, n_q), holds the forcing of each interval about its own start.
        """
        out = [q]
        for g, length in zip(gs, lengths.tolist()):
            out.append(self.at(out[-1], g, length))
        return np.stack(out, axis=1)

    @abstractmethod
    def bends(self, qs: NDArray[Any], gs: NDArray[Any], lengths: Array) -> Array:
        """Return bounds of the second and third derivatives of q over intervals of some `lengths` with
        starts `qs` (n_q, n), shape (2, n_q, n); infinite where none is known.
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
    def onward(self, rows: NDArray[Any]) -> NDArray[Any]:
        """Return what rows on q are on dq/dt by q itself: with the rows on its forcing g they give
        the rate, shape of `rows`.
        """

    def taylor(self, row: NDArray[Any], q: NDArray[Any], g: NDArray[Any], h: float) -> Array:
        """Return the coefficients of ``Re(row q(h x))`` in powers of x, shape (TERMS,), up to x = 1.

        `q` and `g` are of the start, and `h` is no longer than 1 / `fastest`:
        by :math:`q^{(m+1)} = A q^{(m)} + g^{(m)}`.
        """
        by = self._derivatives(row, h)
        out: Array = (by @ q).real
        for k, force in enumerate(g):
            # t^k enters at the power k + 1, and each derivative of q carries it one further
            out[k + 1 :] += h ** (k + 1) * _SHARES[k] * (by[: TERMS - k - 1] @ force).real
        return out

    @abstractmethod
    def _derivatives(self, row: NDArray[Any], h: float) -> NDArray[Any]:
        """Return ``row (A h)^m / m!``, shape (TERMS, n_q)."""

    @abstractmethod
    def paths(self, qs: NDArray[Any], gs: NDArray[Any], times: Array) -> NDArray[Any]:
        """Return q at rising `times` of several intervals with starts `qs` (n_q, n) and forcing `gs`
        (n, degree + 1, n_q), shape (n_q, n, n_times).
        """

    def path(self, q: NDArray[Any], g: NDArray[Any], times: Array) -> NDArray[Any]:
        """Return `paths` of one interval, shape (n_q, n_times)."""
        out: NDArray[Any] = self.paths(q[:, None], g[None], times)[:, 0]
        return out


def powers(t: NDArray[Any] | float, degree: int) -> Array:
    """Return t^0 .. t^degree, shape (degree + 1, ...)."""
    return np.stack([np.asarray(t, float) ** k for k in range(degree + 1)])


class ModalPropagator(Propagator):
    """Motion in complex modes; of each conjugate pair one is kept, with double weight."""

    def __init__(self, space: StateSpace, inputs: Array) -> None:
        super().__init__(space, inputs)
        rigid_u = [r[0] for r in space.rigid]
        rigid_v = [r[1] for r in space.rigid]
        rest = [i for i in range(len(space.a)) if i not in set(rigid_u) | set(rigid_v)]
        if rest:
            lam, x = np.linalg.eig(space.a[np.ix_(rest, rest)])
        else:
            lam, x = np.zeros(0, complex), np.zeros((0, 0), complex)
        residual = np.abs(space.a[np.ix_(rest, rest)] @ x - x * lam).max(initial=0.0)
        self.residual = float(residual / max(np.abs(lam).max(initial=0.0), 1e-300))
        keep = lam.imag >= 0.0
        lam, x = lam[keep], x[:, keep]
        paired = lam.imag > 0.0
        weight = np.where(paired, 2.0, 1.0)
        # inverted as real and imaginary parts: a complex inverse keeps pairs conjugate only to rounding,
        # which near critical damping costs the condition twice over
        parts = np.hstack([x.real, x.imag[:, paired]])
        back = np.linalg.inv(parts)
        left = back[: len(lam)].astype(complex)
        left[paired] = 0.5 * (back[: len(lam)][paired] - 1j * back[len(lam) :])
        self.condition = float(np.linalg.norm(parts, 1) * np.linalg.norm(back, 1)) if rest else 1.0
        nr, ne = len(rigid_u), len(lam)
        self.a_rows = np.arange(ne, ne + nr)  # displacements of rigid modes among q
        self.b_rows = np.arange(ne + nr, ne + 2 * nr)  # their velocities
        self.scale = np.array([space.a[i, j] for i, j in space.rigid])
        self.lam: Complex = np.concatenate([lam, np.zeros(2 * nr)])
        x_full: Complex = np.zeros((len(space.a), ne + 2 * nr), complex)
        x_full[np.ix_(rest, range(ne))] = x * weight
        x_full[rigid_u, self.a_rows] = 1.0
        x_full[rigid_v, self.b_rows] = 1.0
        left_full: Complex = np.zeros((ne + 2 * nr, len(space.a)), complex)
        left_full[np.ix_(range(ne), rest)] = left
        left_full[self.a_rows, rigid_u] = 1.0
        left_full[self.b_rows, rigid_v] = 1.0
        self.u_q, self.v_q = space.u_z @ x_full, space.v_z @ x_full
        self._enter_u, self._enter_v = left_full @ space.z_u, left_full @ space.z_v
        self._force = left_full @ space.b
        self._input = self._force @ inputs
        self.fastest = float(np.abs(lam).max(initial=0.0))
        self._keep_nothing()

    def _keep_nothing(self) -> None:
        self._tables: dict[tuple[float, int], Complex] = {}
        self._powers: dict[float, Complex] = {}  # of eigenvalues times h, over their factorials
        # responses at a few times that recur
        self._single: dict[tuple[float, int], tuple[Complex, Complex]] = {}

    @classmethod
    def joined(cls, propagators: Sequence[ModalPropagator]) -> ModalPropagator:
        """Return the motion of several blocks without massless DOFs as that of one."""
        out = cls.__new__(cls)
        out.u_p = out.v_p = None
        out.inputs, out._input = (
            np.concatenate([getattr(f, x) for f in propagators]) for x in ("inputs", "_input")
        )
        out.lam, out.scale = (
            np.concatenate([getattr(f, x) for f in propagators]) for x in ("lam", "scale")
        )
        before = np.cumsum([0, *(len(f.lam) for f in propagators)])
        out.a_rows, out.b_rows = (
            np.concatenate([getattr(f, x) + n for f, n in zip(propagators, before)])
            for x in ("a_rows", "b_rows")
        )
        out.u_q, out.v_q = (diagonal([getattr(f, x) for f in propagators]) for x in ("u_q", "v_q"))
        out._enter_u, out._enter_v, out._force = (
            diagonal([getattr(f, x) for f in propagators]) for x in ("_enter_u", "_enter_v", "_force")
        )
        out.fastest, out.condition, out.residual = (
            max(getattr(f, x) for f in propagators) for x in ("fastest", "condition", "residual")
        )
        out._keep_nothing()
        return out

    def enter(self, u: Array, v: Array) -> Complex:  # noqa: D102
        return self._enter_u @ u + self._enter_v @ v

    def forcing(self, coefs: Array, constant: Array) -> Complex:  # noqa: D102
        g = coefs @ self._input.T
        g[..., 0, :] += self._force @ constant
        return g

    def push(self, p: Array) -> Complex:  # noqa: D102
        return p @ self._force.T

    def integral(self, q: Complex, g: Complex, t: float) -> Complex:  # noqa: D102
        kernels = phi.duhamel(self.lam * t, len(g))
        out = t * kernels[0] * q
        for k in range(len(g)):
            out += g[k] * t ** (k + 2) * kernels[k + 1] / (k + 1)
        if len(self.a_rows):
            a, b, s = self.a_rows, self.b_rows, self.scale
            out[a] += s * q[b] * t**2 / 2
            for k in range(len(g)):
                out[a] += s * g[k][b] * t ** (k + 3) / ((k + 1) * (k + 2) * (k + 3))
        return out

    def _responses(self, t: NDArray[Any], degree: int) -> tuple[Complex, Complex]:
        z = self.lam[:, None] * t
        e = np.exp(z)
        # t^(k+1) K_k(lam t), shape (degree + 1, n_q, n_t)
        return e, phi.duhamel(z, degree, e) * powers(t, degree + 1)[1:, None, :]

    def _table(self, h: float, count: int, degree: int) -> Complex:
        """Responses at 0, h, ..., (count - 1) h to a unit of q and of each g, kept,
        shape (n_q, degree + 2, count).
        """
        found = self._tables.get((h, degree))
        if found is None or found.shape[2] < count:
            e, tables = self._responses(h * np.arange(max(count, 16)), degree)
            found = np.concatenate([e[:, None], tables.swapaxes(0, 1)], axis=1)
            self._tables[h, degree] = found
        return found[:, :, :count]

    def _once(self, t: float, degree: int) -> tuple[Complex, Complex]:
        """Response at one time, kept if there is room: lengths of segments recur."""
        found = self._single.get((t, degree))
        if found is None:
            e, tables = self._responses(np.array([t]), degree)
            found = e[:, 0], tables[:, :, 0]
            if len(self._single) < RECURRING:
                self._single[t, degree] = found
        return found

    def samples(self, qs: Complex, gs: Complex, h: float, count: int) -> Complex:  # noqa: D102
        table = self._table(h, count, gs.shape[1] - 1)
        return self._answered(qs, gs, h * np.arange(count), table)

    def at(self, q: Complex, g: Complex, t: float) -> Complex:  # noqa: D102
        e, table = self._once(t, len(g) - 1)
        out = e * q + (table * g).sum(axis=0)
        if len(self.a_rows):
            out = out[:, None, None]
            self._drift(out, q[:, None], g[None], np.array([t]))
            out = out[:, 0, 0]
        return out

    def march(self, q: Complex, gs: Complex, lengths: Array) -> Complex:  # noqa: D102
        if len(self.a_rows):
            return super().march(q, gs, lengths)
        out = np.empty((len(q), len(gs) + 1), complex)
        out[:, 0], out[:, 1] = q, self.at(q, gs[0], float(lengths[0]))
        if len(gs) > 1:  # the others are equal
            e, table = self._once(float(lengths[1]), gs.shape[1] - 1)
            q = out[:, 1]
            for i, push in enumerate((table * gs[1:]).sum(axis=1), 2):
                out[:, i] = q = e * q + push
        return out

    def bends(self, qs: Complex, gs: Complex, lengths: Array) -> Array:  # noqa: D102
        # dq/dt = lambda q + g, and its derivatives likewise: what |exp(lambda t)| makes of their start,
        # and all that the derivatives of g can add
        a, b, g = self.a_rows, self.b_rows, gs.transpose(1, 2, 0)
        start = qs
        grow = np.exp(np.maximum(self.lam.real[:, None], 0.0) * lengths)
        out = np.empty((3, *qs.shape))
        for order in range(3):
            before = start
            start = self.lam[:, None] * start
            if order < len(g):
                start += factorial(order) * g[order]
            start[a] += self.scale[:, None] * before[b]
            later = polynomial.values(np.abs(gs), lengths, order + 1).T
            out[order] = grow * (np.abs(start) + lengths * later)
            out[order, a] += lengths * np.abs(self.scale[:, None]) * out[order, b]
        return out[1:]

    def onward(self, rows: Complex) -> Complex:  # noqa: D102
        out = rows * self.lam
        out[..., self.b_rows] += rows[..., self.a_rows] * self.scale
        return out

    def _derivatives(self, row: Complex, h: float) -> Complex:
        found = self._powers.get(h)
        if found is None:
            steps = h * self.lam / np.arange(1, TERMS)[:, None]
            found = np.cumprod(np.concatenate([np.ones((1, len(self.lam))), steps]), axis=0)
            if len(self._powers) < RECURRING:
                self._powers[h] = found
        out = row * found
        out[1, self.b_rows] += h * row[self.a_rows] * self.scale
        return out

    def paths(self, qs: Complex, gs: Complex, times: Array) -> Complex:  # noqa: D102
        e, table = self._responses(times, gs.shape[1] - 1)
        return self._answered(qs, gs, times, np.concatenate([e[:, None], table.swapaxes(0, 1)], axis=1))

    def _answered(self, qs: Complex, gs: Complex, times: NDArray[Any], table: Complex) -> Complex:
        """What a table of responses (n_q, degree + 2, n_times) makes of starts and forcing."""
        start = np.concatenate([qs[:, :, None], gs.transpose(2, 0, 1)], axis=2)
        out: Complex = start @ table
        self._drift(out, qs, gs, times)
        return out

    def _drift(self, out: Complex, qs: Complex, gs: Complex, t: NDArray[Any]) -> None:
        """Add what rigid-body velocities and forces do to rigid-body displacements, shape (n_q, n, n_t)."""
        if len(self.a_rows):
            a, b, s = self.a_rows, self.b_rows, self.scale[:, None, None]
            out[a] += s * qs[b][:, :, None] * t
            for k in range(gs.shape[1]):
                out[a] += s * gs[:, k, b].T[:, :, None] * t ** (k + 2) / ((k + 1) * (k + 2))


def diagonal(active: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Return matrices as the blocks of one, zero elsewhere."""
    out = np.zeros(np.sum([b.shape for b in active], axis=0), np.result_type(*active))
    i = j = 0
    for b in active:
        out[i : i + b.shape[0], j : j + b.shape[1]] = b
        i, j = i + b.shape[0], j + b.shape[1]
    return out


class SeriesPropagator(Propagator):
    """Motion by the exponential series of the state matrix; q is the state itself."""

    def __init__(self, space: StateSpace, inputs: Array) -> None:
        super().__init__(space, inputs)
        self.space = space
        self.u_q, self.v_q = space.u_z, space.v_z
        self._input = space.b @ inputs
        self.norm = float(np.linalg.norm(space.a, 2))
        self.fastest = self.norm
        self.condition, self.residual = 1.0, 0.0
        self._maps: dict[tuple[float, int], Array] = {}

    def enter(self, u: Array, v: Array) -> Array:  # noqa: D102
        return self.space.z_u @ u + self.space.z_v @ v

    def forcing(self, coefs: Array, constant: Array) -> Array:  # noqa: D102
        g = coefs @ self._input.T
        g[..., 0, :] += self.space.b @ constant
        return g

    def push(self, p: Array) -> Array:  # noqa: D102
        return p @ self.space.b.T

    def integral(self, q: Array, g: Array, t: float) -> Array:  # noqa: D102
        w, points = gauss(t, self.fastest)
        return self.path(q, g, points) @ w

    def bends(self, qs: Array, gs: Array, lengths: Array) -> Array:  # noqa: D102
        return np.full((2, *qs.shape), np.inf)

    def onward(self, rows: Array) -> Array:  # noqa: D102
        return rows @ self.space.a

    def _derivatives(self, row: Array, h: float) -> Array:
        out = [row]
        for m in range(1, TERMS):
            out.append(h / m * (out[-1] @ self.space.a))
        return np.array(out)

    def paths(self, qs: Array, gs: Array, times: Array) -> Array:  # noqa: D102
        # from time to time, each as the start of the next
        out = np.empty((*qs.shape, len(times)))
        for n, (q, g) in enumerate(zip(qs.T, gs)):
            last = 0.0
            for i, t in enumerate(times.tolist()):
                q = self.at(q, polynomial.shift(g, last), t - last)
                out[:, n, i], last = q, t
        return out

    def at(self, q: Array, g: Array, t: float) -> Array:  # noqa: D102
        # Taylor series of the solution in substeps with |a| h <= 1: derivative by derivative
        steps = max(1, int(np.ceil(abs(t) * self.norm)))
        h = t / steps
        for s in range(steps):
            local = polynomial.shift(g, s * h)
            term, total, j = q.copy(), q.copy(), 0
            while True:
                # q^(j+1) / (j+1)! h^(j+1) from q^(j) / j! h^j; the force adds its own Taylor coefficient
                term = h / (j + 1) * (self.space.a @ term)
                if j < len(local):
                    term = term + local[j] * h ** (j + 1) / (j + 1)
                total = total + term
                j += 1
                if j > len(local) and np.abs(term).max(initial=0.0) <= 1e-18 * np.abs(total).max(
                    initial=0.0
                ):
                    break
                if j > 80:
                    break
            q = total
        return q

    def samples(self, qs: Array, gs: Array, h: float, count: int) -> Array:  # noqa: D102
        size, degree = len(qs), gs.shape[1] - 1
        key = (h, degree)
        if key not in self._maps:
            # the map of one step for (q, g_0, ..., g_degree), column by column
            unit = np.zeros((degree + 1, size))
            cols = [self.at(e, unit, h) for e in np.eye(size)]
            for k in range(degree + 1):
                for i in range(size):
                    unit[k, i] = 1.0
                    cols.append(self.at(np.zeros(size), unit, h))
                    unit[k, i] = 0.0
            self._maps[key] = np.array(cols).T
        step, forcing = self._maps[key], gs.swapaxes(0, 1)
        out = np.empty((*qs.shape, count))
        out[:, :, 0] = qs
        for i in range(1, count):
            local = polynomial.shift(forcing, (i - 1) * h).transpose(0, 2, 1)
            out[:, :, i] = step @ np.concatenate([out[:, :, i - 1], *local])
        return out


_X, _W = np.polynomial.legendre.leggauss(12)
_X, _W = 0.5 * (_X + 1.0), 0.5 * _W


def gauss(t: float, fastest: float) -> tuple[Array, Array]:
    """Weights and points on (0, t) for functions made of modes up to `fastest` and their products."""
    cells = max(1, int(np.ceil(t * fastest / 4.0)))
    width = t / cells
    return np.tile(_W * width, cells), (np.arange(cells)[:, None] * width + _X * width).ravel()


def make_propagator(
    m: Array, c: Array, k: Array, inputs: Array, rows: Array | None = None
) -> ModalPropagator | SeriesPropagator:
    """Return the exact motion of a block: in modes, or by series where the modes are defective.

    With `rows` it is that of `held_space`.
    """
    if rows is None:
        space = state_space(m, c, k)
    else:
        space = held_space(m, c, k, rows)
        inputs = np.vstack([inputs, np.zeros((3 * len(rows), inputs.shape[1]))])
    try:
        propagator = ModalPropagator(space, inputs)
    except np.linalg.LinAlgError:
        return SeriesPropagator(space, inputs)
    return propagator if propagator.condition < MOST_CONDITION else SeriesPropagator(space, inputs)
