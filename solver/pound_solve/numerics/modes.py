r"""Free vibration: :math:`(K - \omega^2 M)\,\phi = 0` on the DOFs that have stiffness.

Massless DOFs are condensed first, which is exact for free vibration.  Modes are scaled to
:math:`\phi^T M \phi = 1` with the largest component positive.

For a sparse K only the slowest modes are computed, by the Lanczos method on :math:`(K - \sigma M)^{-1} M`,
which needs no condensation (Ericsson and Ruhe 1980).  The number of negative pivots of :math:`K - \mu M` is
the number of modes below :math:`\mu` (Sylvester's law of inertia), so a count shows whether a mode was
missed.

References
----------
Ericsson T, Ruhe A (1980), The spectral transformation Lanczos method for the numerical solution of large
sparse generalized symmetric eigenvalue problems, Math. Comp. 35: 1251-1268.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pound_solve.numerics import matrices
from pound_solve.numerics.matrices import Factor, Matrix, dense, diagonal, scaled, used_rows
from pound_solve.numerics.types import Array, Flags

MAX_REPEATS = 8  #: largest number of repetitions of the search for missed modes
TINY_PIVOT = 1e-15  #: smallest pivot of a matrix with unit diagonal; it prevents zero pivots
EXTRA_MODES = 4  #: modes beyond those requested, to find a gap after them
WORTH_LANCZOS = 5  #: unknowns with mass per mode from which on the Lanczos method is used

# of a stiffness with unit diagonal: smallest values that count, by how they are computed
NEGATIVE = 1e-10  #: eigenvalue or pivot below minus this is negative, not zero with rounding errors
SAFE_PIVOT = 1e-7  #: pivots above this show without pivoting that there is no mechanism
PIVOT_ROUNDING = 1e-15  #: pivots with pivoting, times the size (10 at least), below which they are zero

#: eigenvalue of a mass matrix with unit diagonal, times the size, below which a direction has no mass
NO_MASS = 1e-13
INVERSE_ITERATIONS = 20  #: to a motion with negative stiffness, from any vector
LARGEST = 1e-9  #: components that differ from the largest by less are equally large
SHIFT = 1e-8  #: stiffness at the masses that makes rigid-body modes slow modes
RIGID_BODY = 1e-6  #: fraction of this shift below which a squared frequency is zero
SAME_FREQUENCY = 1e-9  #: fraction of the squared highest frequency to which it is bracketed
LOST_DIGITS = 1e-5  #: fraction of the largest value below which values are refined: five digits are lost
ONLY_ROUNDING = 1e-14  #: fraction of the largest refined 1 / omega^2 below which others are rounding errors


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


def massless(m: Matrix) -> Flags:
    """Return which DOFs have no mass, shape (n,)."""
    return ~used_rows(m)


def scaling(k: Matrix) -> Array:
    """Return the factors that scale K to a unit diagonal, shape (n,)."""
    stiffness = np.abs(diagonal(k))
    return 1.0 / np.sqrt(np.where(stiffness > 0.0, stiffness, 1.0))


def softest(a: Matrix) -> tuple[float, Array]:
    """Return the smallest eigenvalue of a positive semidefinite matrix with unit diagonal, and its
    eigenvector; for a sparse matrix the value is 0 if it is singular, otherwise 1.
    """
    if isinstance(a, np.ndarray):
        values, vectors = np.linalg.eigh(a)
        return float(values[0]), vectors[:, 0]
    null_space = SingularStiffness(a).null_space
    return (0.0, null_space[:, 0]) if null_space.shape[1] else (1.0, np.zeros(a.shape[0]))


def _generic(n: int) -> Array:
    """Return a fixed vector that could be orthogonal to a mode only by chance, shape (n,)."""
    return np.random.default_rng(0).standard_normal(n)


class SingularStiffness:
    """A symmetric stiffness, scaled to unit diagonal, that may be singular or indefinite.

    A sparse K that is a mechanism is restrained where its pivots vanish, which makes it regular.  The
    motions V that K does not resist (:math:`K V = 0`) are then :math:`(K + E E^T)^{-1} E`.  Loads
    orthogonal to them cause no forces in the restraints.

    Attributes
    ----------
    null_space : ndarray, shape (n, n_null)
        Motions that K does not resist, orthonormal.
    negative : ndarray, shape (n,), or None
        A motion with negative stiffness, if there is one.

    Raises
    ------
    numpy.linalg.LinAlgError
        A sparse K has more than these defects.
    """

    def __init__(self, k: Matrix) -> None:
        self.k, self.negative = k, None
        self.null_space = np.zeros((k.shape[0], 0))
        self._factor: Factor | None = None
        if isinstance(k, np.ndarray):
            lacking = deficiency(k)
            if lacking:
                self._values, self._vectors = np.linalg.eigh(k)
                self.null_space = self._vectors[:, :lacking]
                self.negative = self._vectors[:, 0] if self._values[0] < -NEGATIVE else None
            return
        n = k.shape[0]
        try:
            self._factor = Factor(k)
            pivots, least = self._factor.pivots, 0.0
        except np.linalg.LinAlgError:
            tiny = TINY_PIVOT * matrices.selection(n, np.arange(n))
            pivots, least = Factor(k + tiny, 0.0).pivots, 10 * TINY_PIVOT * max(n, 10)
        weak = np.flatnonzero((pivots < least) & (pivots > -NEGATIVE))
        if len(weak):  # K does not resist the motion due to the release of a restraint
            self._factor = Factor(k + matrices.gathered(k.shape, weak, weak, np.ones(len(weak))))
            self.null_space = np.linalg.qr(self._factor.solve(dense(matrices.selection(n, weak))))[0]
        assert self._factor is not None
        if self._factor.negative:
            x = _generic(k.shape[0])
            # a pivot near zero, as in a structure that has just collapsed
            for _ in range(INVERSE_ITERATIONS):
                x = self._factor.solve(x / np.linalg.norm(x))
            self.negative = x

    def solve(self, push: Array) -> Array:
        """Return the displacements under a load, orthogonal to `null_space`, shape (n,)."""
        if isinstance(self.k, np.ndarray):
            if not self.null_space.shape[1]:
                return np.asarray(np.linalg.solve(self.k, push))
            weak = np.arange(len(push)) < self.null_space.shape[1]
            along = np.where(weak, 0.0, self._vectors.T @ push)
            return np.asarray(self._vectors @ (along / np.where(weak, 1.0, self._values)))
        assert self._factor is not None
        if not self.null_space.shape[1]:
            return self._factor.solve(push)
        resisted = push - self.null_space @ (self.null_space.T @ push)
        u = self._factor.solve(resisted)
        return np.asarray(u - self.null_space @ (self.null_space.T @ u))


def deficiency(k: Array) -> int:
    """Return the number of independent motions that K, scaled to unit diagonal, does not resist
    (mechanisms, rigid bodies).

    Pivots distinguish a mechanism from a slender mesh better than eigenvalues: the pivots of a cantilever
    with n members decrease as n^-3 (its eigenvalues as n^-4), and those of a mechanism are rounding errors.
    Without pivoting, rounding errors may grow as n^3.
    """
    try:
        if np.diag(np.linalg.cholesky(k)).min(initial=1.0) ** 2 > SAFE_PIVOT:
            return 0
    except np.linalg.LinAlgError:
        pass
    from scipy.linalg.lapack import dpstrf  # with pivoting; slow to import and rarely needed

    return len(k) - int(dpstrf(k, tol=PIVOT_ROUNDING * max(len(k), 10))[2])


def moving_mass(k: Matrix, m: Matrix, ground: Array) -> Array:
    """Return the sum of the effective masses of all modes, for each row of `ground` = M r, shape (n_rows,).

    Masses at DOFs without stiffness belong to no mode.
    """
    at = np.flatnonzero(used_rows(k) & ~massless(m))
    root = 1.0 / np.sqrt(diagonal(m[np.ix_(at, at)]))
    inertia = SingularStiffness(scaled(m[np.ix_(at, at)], root))
    return np.array([x @ inertia.solve(x) for x in ground[:, at] * root])


def condense(k: Matrix, out: Flags) -> Array:
    """Return the map from the kept DOFs to all DOFs, where those of `out` follow statically, shape (n,
    n_kept).

    DOFs of `out` without stiffness stay at zero.

    Raises
    ------
    numpy.linalg.LinAlgError
        The stiffness of `out` is singular: part of it is a mechanism.
    """
    n = k.shape[0]
    keep = np.flatnonzero(~out)
    go = np.flatnonzero(out & used_rows(k))
    t = np.zeros((n, len(keep)))
    t[keep, np.arange(len(keep))] = 1.0
    if len(go):
        held, pull = k[np.ix_(go, go)], dense(k[np.ix_(go, keep)])
        t[go] = -(np.linalg.solve(held, pull) if isinstance(held, np.ndarray) else Factor(held).solve(pull))
    return t


def solve(k: Matrix, m: Matrix, count: int | None = None) -> Modes:
    """Return all modes of the DOFs that have mass and are connected to any stiffness.

    Parameters
    ----------
    k, m : Matrix, shape (n, n)
        Stiffness [F/L] and mass [F T^2/L].
    count : int or None
        Number of slowest modes that are needed; more may be returned.  None: all.

    Raises
    ------
    numpy.linalg.LinAlgError
        A massless part is a mechanism, or the mass matrix is not positive definite.
    """
    if (
        not isinstance(k, np.ndarray)
        and count is not None
        and WORTH_LANCZOS * (count + EXTRA_MODES) < (~massless(m)).sum()
    ):
        few = _slowest(k, m, count)
        if few is not None:
            return few
    active = used_rows(k)
    t = condense(k, massless(m) | ~active)
    kk, mm = t.T @ (k @ t), t.T @ (m @ t)
    if not len(kk):
        return Modes(np.zeros(0), np.zeros((k.shape[0], 0)))
    if np.any(mm - np.diag(np.diag(mm))):
        # a mass on a slaved node acts in fewer directions than its master has:
        # the others are massless, too
        root = 1.0 / np.sqrt(np.diag(mm))
        share, basis = np.linalg.eigh(root[:, None] * mm * root)
        if share[0] < NO_MASS * len(share):
            stationary = root[:, None] * basis
            t = t @ stationary @ condense(stationary.T @ kk @ stationary, share < NO_MASS * len(share))
            kk, mm = t.T @ (k @ t), t.T @ (m @ t)
    values, shapes = _eigen(kk, mm)
    return Modes(np.sqrt(values), _signed(t @ shapes))


def _signed(shapes: Array) -> Array:
    """Return the shapes with reproducible signs: the first component that is the largest to `LARGEST` is
    positive.
    """
    big = np.abs(shapes) > (1 - LARGEST) * np.abs(shapes).max(axis=0)
    return np.asarray(shapes * np.sign(shapes[np.argmax(big, axis=0), np.arange(shapes.shape[1])]))


def _slowest(k: Matrix, m: Matrix, count: int) -> Modes | None:
    """Return the `count` slowest modes of sparse matrices, or None if they cannot be separated
    from others.
    """
    from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

    n, at = k.shape[0], np.flatnonzero(used_rows(k))
    size = scaling(k[np.ix_(at, at)])
    k, m = (scaled(a[np.ix_(at, at)], size) for a in (k, m))
    shift = 0.0
    try:
        if Factor(k).negative:
            raise np.linalg.LinAlgError("negative stiffness")
    except np.linalg.LinAlgError:  # rigid bodies become slow modes through a small stiffness at the masses
        shift = SHIFT / float(diagonal(m).max())
    factor = Factor(k + shift * m)
    if factor.negative:
        raise np.linalg.LinAlgError("negative stiffness")
    wanted, values, shapes = count, np.zeros(0), np.zeros((len(at), 0))
    for _ in range(MAX_REPEATS):
        # known modes are removed, so that another of the same frequency can be found
        def follow(push: Array, known: Array = shapes, known_values: Array = values) -> Array:
            x = factor.solve(push.ravel())
            return np.asarray(x - known @ ((known.T @ push.ravel()) / (known_values + shift)))

        more = max(wanted + EXTRA_MODES - len(values), 1)
        start = follow(m @ _generic(len(at)))
        try:
            eigenvalues, x = eigsh(
                k, more, m, -shift, "LM", start, OPinv=LinearOperator(k.shape, follow), tol=0, ncv=None
            )
        except ArpackError:
            return None
        x = factor.solve(m @ x)  # removes massless components
        x /= np.sqrt((x * (m @ x)).sum(axis=0))
        values, shapes = np.append(values, eigenvalues), np.hstack([shapes, x])
        order = np.argsort(values, kind="stable")
        values, shapes = values[order], shapes[:, order]
        # find the widest gap after the requested modes, and test whether as many modes lie below it
        gap = wanted - 1 + int(np.argmax(np.diff(values[wanted - 1 :] + shift) / (values[wanted:] + shift)))
        below = Factor(k - 0.5 * (values[gap] + values[gap + 1]) * m, 0.0).negative
        if below == gap + 1:
            break
        wanted = max(wanted, below)
    else:
        return None
    values, shapes = np.maximum(values[:count], 0.0), shapes[:, :count]
    values[values < RIGID_BODY * shift] = 0.0
    full = np.zeros((n, count))
    full[at] = size[:, None] * shapes
    return Modes(np.sqrt(values), _signed(full))


def fastest(k: Matrix, m: Matrix) -> float:
    """Return the highest circular frequency [rad/T] of a structure whose DOFs all have mass; 0 without
    DOFs.
    """
    if isinstance(k, np.ndarray):
        return float(solve(k, m).omega.max(initial=0.0))
    # above the highest frequency all pivots of w^2 M - K are positive
    low = float((diagonal(k) / diagonal(m)).max(initial=0.0))
    high = 2.0 * low
    while low < high and not _above(k, m, high):
        low, high = high, 2.0 * high
    while high - low > SAME_FREQUENCY * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if _above(k, m, middle) else (middle, high)
    return float(np.sqrt(high))


def _above(k: Matrix, m: Matrix, square: float) -> bool:
    """Return whether a squared frequency lies above all those of K and M."""
    try:
        return not Factor(square * m - k, 0.0).negative
    except np.linalg.LinAlgError:
        return False


def generalised(k: Array, m: Array) -> tuple[Array, Array]:
    """Return the squared frequencies, ascending, and the mass-normalised shapes of K and a positive
    definite M.

    All values have the rounding error of the largest one.
    """
    if not np.any(m - np.diag(np.diag(m))):
        root = 1.0 / np.sqrt(np.diag(m))
        values, vectors = np.linalg.eigh(root[:, None] * k * root)
        return values, root[:, None] * vectors
    lower = np.linalg.inv(np.linalg.cholesky(m))
    values, vectors = np.linalg.eigh(lower @ k @ lower.T)
    return values, lower.T @ vectors


def _eigen(k: Array, m: Array) -> tuple[Array, Array]:
    """Return the result of `generalised` with rigid-body modes separated from slow modes, which are
    refined.
    """
    values, shapes = generalised(k, m)
    size = scaling(k)
    scaled = size[:, None] * k * size
    rigid = np.arange(len(k)) < deficiency(scaled)  # computed as +-1e-16 of the largest value
    values = np.where(rigid, 0.0, np.maximum(values, 0.0))
    low = values < LOST_DIGITS * values[-1]
    if low.any() and not rigid.any():
        # values far below the largest have lost digits: one step of inverse iteration refines them
        push = m @ shapes[:, low]
        x = size[:, None] * np.linalg.solve(scaled, size[:, None] * push)
        scale = 1.0 / np.linalg.norm(x, axis=0)
        x, push = x * scale, push * scale
        work, energy = push.T @ x, x.T @ m @ x
        lower = np.linalg.inv(np.linalg.cholesky(0.5 * (work + work.T)))
        squares, y = np.linalg.eigh(lower @ energy @ lower.T)  # of 1 / omega^2
        squares, y = squares[::-1], lower.T @ y[:, ::-1]
        if squares[-1] > ONLY_ROUNDING * squares[0]:
            values[low], shapes[:, low] = 1.0 / squares, x @ (y / np.sqrt(squares))
    return values, shapes
