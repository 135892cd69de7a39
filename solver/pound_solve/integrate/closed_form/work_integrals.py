r"""Work done on and by a subsystem over intervals of time, in closed form.

Each mode is split into a free and a forced part, :math:`q_i = c_i e^{\lambda_i t} + p_i(t)` with a
polynomial :math:`p_i`.  With :math:`S = V^T C V` (V are the velocities of the modes)

.. math:: \int_0^\tau v^T C v\,dt

has free-free terms :math:`c_i c_j S_{ij}(e^{(\lambda_i+\lambda_j)\tau}-1)/(\lambda_i+\lambda_j)`,
free-forced terms from the moments :math:`\int t^k e^{\lambda t}`, and polynomial forced-forced terms.  No
energy balance is used, so the sum of all energies remains a check.

Modes that hardly change over the interval are treated entirely as polynomials.  For forces above the first
degree, and for nearly or fully defective modes, Gauss quadrature on a grid that resolves the fastest mode
is used instead.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pound_solve.integrate.propagators.base import Propagator, gauss, powers
from pound_solve.integrate.propagators.modal import ModalPropagator
from pound_solve.laws.automaton import Branch
from pound_solve.numerics import phi, polynomial
from pound_solve.numerics.types import Array, Complex
from pound_solve.structure.reduction import ReducedSystem

#: modes with a magnitude of eigenvalue times interval below this are expanded in powers of time
SMALL_PHASE = 0.1
EXPANSION_TERMS = 11  #: number of terms of that expansion, in addition to those of the force
MAX_NUMBERS = 2**20  #: largest number of velocities that the quadrature stores at once
MAX_CONDITION = 3e3  #: largest condition number of the modes for which their products are used


class Work(NamedTuple):
    """Dissipation in the structure's dashpots, input, and for each law with a dashpot (law, loss) [F L]."""

    damping: float
    input: float
    laws: list[tuple[int, float]]


class IntervalWork(NamedTuple):
    """`Work` of several intervals, arrays of shape (n,)."""

    damping: Array
    input: Array
    laws: list[tuple[int, Array]]


class WorkIntegrals:
    """Work in one subsystem for one set of stiffnesses.

    Parameters
    ----------
    propagator : Propagator
    damping : ndarray, shape (n, n)
        Damping of the structure, without the laws.
    inputs : ndarray, shape (n, n_inputs)
    laws : list of (law, c, row)
        Laws with a dashpot on their present branch: pressed contacts, and springs with
        stiffness-proportional damping.
    """

    def __init__(
        self, propagator: Propagator, damping: Array, inputs: Array, laws: list[tuple[int, float, Array]]
    ) -> None:
        self.propagator, self.inputs, self.laws, self.damping = propagator, inputs, laws, damping
        self.damped = bool(np.any(damping))
        # the quadratic forms lose digits by the square of the condition number of the modes
        self.closed_form = (
            isinstance(propagator, ModalPropagator)
            and propagator.u_p is None
            and propagator.condition < MAX_CONDITION
        )
        if not isinstance(propagator, ModalPropagator) or not self.closed_form:
            return
        self.eigenvalues = propagator.eigenvalues
        self.form = self._form(propagator.v_q, damping) if self.damped else np.zeros((0, 0))
        self.law_forms = [c * self._form(row[None, :] @ propagator.v_q, np.eye(1)) for _, c, row in laws]

    def _form(self, v: Complex, c: Array) -> Array:
        """Return the quadratic form of the real and imaginary parts of the free amplitudes, shape (2 n_q, 2
        n_q), whose change over an interval is the dissipation; each term is divided by its exponent.
        """
        cv = c @ v
        plain, mixed = v.T @ cv, v.conj().T @ cv
        values = self.eigenvalues
        s1, s2 = values[:, None] + values[None, :], values.conj()[:, None] + values[None, :]
        # an undamped pair has no dissipation: 0/0 is 0
        floor = 1e-15 * max(float(np.abs(values).max(initial=0.0)), 1e-300)
        r1 = np.where(np.abs(s1) > floor, plain / np.where(np.abs(s1) > floor, s1, 1.0), 0.0)
        r2 = np.where(np.abs(s2) > floor, mixed / np.where(np.abs(s2) > floor, s2, 1.0), 0.0)
        # v = Re(V q): v^T C v = (q^T S1 q + q^H S2 q) / 2, real part
        return 0.5 * np.block([[(r1 + r2).real, -(r1 + r2).imag], [(r2 - r1).imag, (r2 - r1).real]])

    def _split(self, qs: Complex, gs: Complex, tau: Array) -> tuple[Complex, Complex, Complex, Complex]:
        """Return the free amplitudes at 0 and tau (n_q, n), forced polynomials and moments (powers, n_q,
        n).
        """
        degree = gs.shape[1] - 1
        g = gs.transpose(1, 2, 0)
        # the free and forced parts of a slow mode would be large and nearly cancel: it is a power series
        # instead (which is finite for a rigid-body mode)
        slow = np.abs(self.eigenvalues) * tau.max() < SMALL_PHASE
        more = 0 if not slow.any() else 1 if not self.eigenvalues[slow].any() else EXPANSION_TERMS
        count = degree + 1 + more
        # many intervals have the same length
        lengths, place = np.unique(tau, return_inverse=True)
        z: Complex = np.where(slow, 0j, self.eigenvalues)[:, None] * lengths.astype(complex)
        growth = np.exp(z)[:, place]
        moments = (phi.moments(z, count - 1) * powers(lengths, count)[1:, None])[:, :, place]
        eigenvalues = np.where(slow, 1.0, self.eigenvalues)[:, None]
        p = np.zeros((count + 1, *qs.shape), complex)
        for k in range(degree, -1, -1):
            p[k] = ((k + 1) * p[k + 1] - g[k]) / eigenvalues
        p[:, slow] = 0.0
        c0 = np.where(slow[:, None], 0.0, qs - p[0])
        if slow.any():
            p[:count, slow] = self._slow_series(qs[slow], g[:, slow], self.eigenvalues[slow, None], count)
        return c0, c0 * growth, p[:count], moments

    @staticmethod
    def _slow_series(q: Complex, g: Complex, eigenvalues: Complex, count: int) -> Complex:
        """Return the coefficients of ``q' = eigenvalue q + g`` in powers of time, shape (count,
        n_slow, n).
        """
        coefs = np.empty((count, *q.shape), complex)
        coefs[0] = q
        for k in range(count - 1):
            coefs[k + 1] = (eigenvalues * coefs[k] + (g[k] if k < len(g) else 0.0)) / (k + 1)
        return coefs

    def over_intervals(
        self,
        qs: NDArray[Any],
        gs: NDArray[Any],
        tau: Array,
        input_coefs: Array,
        constant: Array,
        loads: Array | None = None,
    ) -> IntervalWork:
        """Return the work over several intervals.

        Parameters
        ----------
        qs : ndarray, shape (n_q, n)
            States at the starts of the intervals.
        gs : ndarray, shape (n, degree + 1, n_q)
            Forcing of the intervals.
        tau : ndarray, shape (n,)
            Lengths of the intervals [T].
        input_coefs : ndarray, shape (n, degree + 1, n_inputs)
            Inputs; their forces and `constant` loads (n_unknowns,) do the input work.
        loads : ndarray, shape (n, degree + 1, n_unknowns), or None
            Load polynomials on the unknowns, if massless DOFs need them.
        """
        if not self.closed_form or gs.shape[1] > 2:
            return self._quadrature(qs, gs, tau, input_coefs, constant, loads)
        c0, c1, forced, moments = self._split(qs, gs, tau)
        ends = np.concatenate([c0, c1], axis=1)
        ends = np.concatenate([ends.real, ends.imag])
        # of the velocities: the forced polynomials, and the integrals of t^k times the free part, and times
        # both parts; shape (powers, n, n_intervals) each
        steady, free = ((self.propagator.v_q @ x).real for x in (forced, c0 * moments))
        both = np.add.outer(np.arange(len(forced)), np.arange(1, len(forced) + 1))[:, :, None]
        whole = free + np.einsum("kln,lin->kin", tau**both / both, steady)
        loss, losses = np.zeros(len(gs)), []
        if self.damped:
            loss = self._change(self.form, ends)
            loss += ((self.damping @ steady) * (free + whole)).sum(axis=(0, 1))
        for (law, c, row), form in zip(self.laws, self.law_forms):
            lost = self._change(form, ends) + c * ((row @ steady) * (row @ (free + whole))).sum(axis=0)
            losses.append((law, lost))
        total = np.asarray(constant @ whole[0])
        for k in range(input_coefs.shape[1]):
            total += ((self.inputs @ input_coefs[:, k].T) * whole[k]).sum(axis=0)
        return IntervalWork(loss, total, losses)

    def _change(self, form: Array, ends: Array) -> Array:
        """Return the change of a form from `_form` between the amplitudes at the starts and those at the
        ends.
        """
        start, end = np.split((ends * (form @ ends)).sum(axis=0), 2)
        return np.asarray(end - start)

    def _quadrature(
        self,
        qs: NDArray[Any],
        gs: NDArray[Any],
        tau: Array,
        input_coefs: Array,
        constant: Array,
        loads: Array | None,
    ) -> IntervalWork:
        """Return the result of `over_intervals` by Gauss quadrature."""
        loss, done, *losses = np.zeros((2 + len(self.laws), len(tau)))
        v_q, u_p, v_p = self.propagator.v_q, self.propagator.u_p, self.propagator.v_p
        for length in np.unique(tau).tolist():
            w, points = gauss(length, self.propagator.spectral_radius)
            same = np.flatnonzero(tau == length)
            at_once = max(1, MAX_NUMBERS // (len(points) * max(len(qs), len(constant))))
            for i in range(0, len(same), at_once):
                chosen = same[i : i + at_once]
                times = np.broadcast_to(points, (len(chosen), len(points)))
                q = self.propagator.trajectories(qs[:, chosen], gs[chosen], points)
                v = np.tensordot(v_q, q, 1).real
                if u_p is not None and v_p is not None and loads is not None:
                    v += np.tensordot(v_p, polynomial.on(loads[chosen], times), 1)
                    v += np.tensordot(u_p, polynomial.on(loads[chosen], times, 1), 1)
                force = np.tensordot(self.inputs, polynomial.on(input_coefs[chosen], times), 1)
                force += constant[:, None, None]
                done[chosen] = np.einsum("int,int,t->n", v, force, w)
                if self.damped:
                    drag = np.tensordot(self.damping, v, 1)
                    loss[chosen] = np.einsum("int,int,t->n", v, drag, w)
                for lost, (_, c, row) in zip(losses, self.laws):
                    lost[chosen] = c * (np.tensordot(row, v, 1) ** 2 @ w)
        return IntervalWork(loss, done, [(law, lost) for (law, _, _), lost in zip(self.laws, losses)])


def total_work(
    system: ReducedSystem,
    tau: float,
    spectral_radius: float,
    input_coefs: Array,
    motion: Callable[[Array], tuple[Array, Array, Array]],
    branches: Sequence[Branch],
) -> Work:
    """Return the work over an interval in total displacements.

    The input is the work of the supports (their reactions times their velocities), of constant loads and of
    FORCES.  Dashpots of laws may be attached to supports.

    Parameters
    ----------
    system : ReducedSystem
    tau : float
        Length of the interval [T].
    spectral_radius : float
        Of the subsystems [1/T], for the quadrature.
    input_coefs : ndarray, shape (degree + 1, n_inputs)
        Inputs over the interval.
    motion : callable
        Displacement, velocity and acceleration of the unknowns at local times, shape (n, n_times) each.
    branches : sequence of Branch
        Of all laws.
    """
    structure, n = system.structure, system.structure.n_free
    w, x = gauss(tau, spectral_radius)
    inputs = [polynomial.on(input_coefs[None], x[None], order)[:, 0] for order in range(3)]
    u, v, a = motion(x)
    k, c, f0 = (
        np.array([getattr(b, name) for b in branches])[:, None]
        for name in ("stiffness", "damping", "force0")
    )
    rate = system.law_rows @ v + system.law_inputs @ inputs[1]
    law = k * (system.law_rows @ u + system.law_inputs @ inputs[0]) + c * rate + f0
    u, v, a = (system.expanded(y, s, order) for order, (y, s) in enumerate(zip((u, v, a), inputs)))
    force = (
        structure.stiffness @ u + structure.damping @ v + structure.mass @ a + structure.law_rows.T @ law
    )
    constrained = [i for i, b in enumerate(branches) if b.constrains]
    if constrained:  # the residual force of the unknowns is the force of the rigid contacts
        rows = structure.law_rows[constrained]
        rest = system.applied(inputs[0]) - force[:n]
        force += rows.T @ np.linalg.lstsq(rows[:, :n].T, rest, rcond=1e-12)[0]
    power = (force[n:] * v[n:]).sum(axis=0) + (system.applied(inputs[0]) * v[:n]).sum(axis=0)
    losses = (c * rate**2) @ w
    return Work(
        float(w @ (v * (structure.damping @ v)).sum(axis=0)),
        float(w @ power),
        [(i, float(losses[i])) for i in np.flatnonzero(c).tolist()],
    )
