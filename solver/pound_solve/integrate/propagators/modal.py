r"""Propagator in complex modes.

The complex modes :math:`q` of the state matrix are uncoupled,
:math:`\dot q_i = \lambda_i q_i + \sum_k g_{ik} t^k`, hence

.. math:: q_i(t) = e^{\lambda_i t} q_i(0) + \sum_k g_{ik}\, t^{k+1} K_k(\lambda_i t)

(:mod:`~pound_solve.numerics.phi`).  Undamped rigid-body modes are polynomials and are kept separate, so
that the double zero eigenvalue of a plastic storey needs no special treatment.

References
----------
Foss KA (1958), J. Appl. Mech. 25: 361-364 (complex modes of damped systems).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import factorial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_solve.integrate.propagators.base import TAYLOR_TERMS, Propagator, powers
from pound_solve.integrate.propagators.state_space import StateSpace
from pound_solve.numerics import phi, polynomial
from pound_solve.numerics.types import Array, Complex, Index

MAX_TABLES = 64  #: interval lengths whose responses are kept
MIN_SAMPLES = 16  #: samples of a table of responses, at least


class ModalPropagator(Propagator):
    """Motion in complex modes; one mode of each conjugate pair is kept, with double weight.

    Attributes
    ----------
    eigenvalues : ndarray of complex, shape (n_q,)
        Those of the modes, then zeros for displacements and velocities of the rigid-body modes.
    rigid_u, rigid_v : ndarray of int, shape (n_rigid,)
        Indices of those displacements and velocities in q.
    rigid_scale : ndarray, shape (n_rigid,)
        Rate of the displacement for a unit of velocity.
    """

    eigenvalues: Complex
    rigid_u: Index
    rigid_v: Index
    rigid_scale: Array
    _state_u: Complex
    _state_v: Complex
    _load_forcing: Complex
    _input_forcing: Complex

    def __init__(self, space: StateSpace, inputs: Array) -> None:
        super().__init__(space, inputs)
        rigid_u, rigid_v = [r[0] for r in space.rigid], [r[1] for r in space.rigid]
        rest = [i for i in range(len(space.a)) if i not in set(rigid_u) | set(rigid_v)]
        eigenvalues, modes, inverse = self._solve(space.a[np.ix_(rest, rest)])
        n_rigid, n_modes = len(rigid_u), len(eigenvalues)
        self.rigid_u = np.arange(n_modes, n_modes + n_rigid)
        self.rigid_v = np.arange(n_modes + n_rigid, n_modes + 2 * n_rigid)
        self.rigid_scale = np.array([space.a[i, j] for i, j in space.rigid])
        self.eigenvalues = np.concatenate([eigenvalues, np.zeros(2 * n_rigid)])
        z_q: Complex = np.zeros((len(space.a), n_modes + 2 * n_rigid), complex)
        z_q[np.ix_(rest, range(n_modes))] = modes
        z_q[rigid_u, self.rigid_u] = 1.0
        z_q[rigid_v, self.rigid_v] = 1.0
        q_z: Complex = np.zeros((n_modes + 2 * n_rigid, len(space.a)), complex)
        q_z[np.ix_(range(n_modes), rest)] = inverse
        q_z[self.rigid_u, rigid_u] = 1.0
        q_z[self.rigid_v, rigid_v] = 1.0
        self.u_q, self.v_q = space.u_z @ z_q, space.v_z @ z_q
        self._state_u, self._state_v = q_z @ space.z_u, q_z @ space.z_v
        self._load_forcing = q_z @ space.b
        self._input_forcing = self._load_forcing @ inputs
        self.spectral_radius = float(np.abs(eigenvalues).max(initial=0.0))
        self._clear_tables()

    def _solve(self, a: Array) -> tuple[Complex, Complex, Complex]:
        """Return the eigenvalues with imaginary part >= 0, their weighted modes, and the rows that give q;
        set `condition` and `residual`.
        """
        if len(a):
            eigenvalues, modes = np.linalg.eig(a)
        else:
            eigenvalues, modes = np.zeros(0, complex), np.zeros((0, 0), complex)
        residual = np.abs(a @ modes - modes * eigenvalues).max(initial=0.0)
        self.residual = float(residual / max(np.abs(eigenvalues).max(initial=0.0), 1e-300))
        keep = eigenvalues.imag >= 0.0
        eigenvalues, modes = eigenvalues[keep], modes[:, keep]
        paired = eigenvalues.imag > 0.0
        # real and imaginary parts are inverted: a complex inverse keeps pairs conjugate only to rounding,
        # which near critical damping multiplies the error by the condition number twice
        parts = np.hstack([modes.real, modes.imag[:, paired]])
        inverse = np.linalg.inv(parts)
        rows = inverse[: len(eigenvalues)].astype(complex)
        rows[paired] = 0.5 * (inverse[: len(eigenvalues)][paired] - 1j * inverse[len(eigenvalues) :])
        self.condition = float(np.linalg.norm(parts, 1) * np.linalg.norm(inverse, 1)) if len(a) else 1.0
        return eigenvalues, modes * np.where(paired, 2.0, 1.0), rows

    def _clear_tables(self) -> None:
        self._tables: dict[tuple[float, int], Complex] = {}
        self._powers: dict[float, Complex] = {}  # of eigenvalues times h, over their factorials
        self._single: dict[tuple[float, int], tuple[Complex, Complex]] = {}  # at times that recur

    @classmethod
    def joined(cls, propagators: Sequence[ModalPropagator]) -> ModalPropagator:
        """Return the motion of several subsystems without massless DOFs as that of one."""

        def each(name: str) -> list[Any]:
            return [getattr(x, name) for x in propagators]

        joint = cls.__new__(cls)
        joint.u_p = joint.v_p = None
        first = np.cumsum([0, *map(len, each("eigenvalues"))])
        joint.eigenvalues = np.concatenate(each("eigenvalues"))
        joint.rigid_u = np.concatenate([x + n for x, n in zip(each("rigid_u"), first)])
        joint.rigid_v = np.concatenate([x + n for x, n in zip(each("rigid_v"), first)])
        joint.rigid_scale = np.concatenate(each("rigid_scale"))
        joint.inputs = np.concatenate(each("inputs"))
        joint._input_forcing = np.concatenate(each("_input_forcing"))
        joint._load_forcing = block_diagonal(each("_load_forcing"))
        joint._state_u, joint._state_v = block_diagonal(each("_state_u")), block_diagonal(each("_state_v"))
        joint.u_q, joint.v_q = block_diagonal(each("u_q")), block_diagonal(each("v_q"))
        joint.spectral_radius = max(each("spectral_radius"))
        joint.condition, joint.residual = max(each("condition")), max(each("residual"))
        joint._clear_tables()
        return joint

    def state_of(self, u: Array, v: Array) -> Complex:  # noqa: D102
        return self._state_u @ u + self._state_v @ v

    def forcing(self, input_coefs: Array, constant: Array) -> Complex:  # noqa: D102
        g = input_coefs @ self._input_forcing.T
        g[..., 0, :] += self._load_forcing @ constant
        return g

    def load_forcing(self, p: Array) -> Complex:  # noqa: D102
        return p @ self._load_forcing.T

    def integral(self, q: Complex, g: Complex, t: float) -> Complex:  # noqa: D102
        kernels = phi.duhamel(self.eigenvalues * t, len(g))
        total: Complex = t * kernels[0] * q
        for k in range(len(g)):
            total += g[k] * t ** (k + 2) * kernels[k + 1] / (k + 1)
        if len(self.rigid_u):
            u, v, s = self.rigid_u, self.rigid_v, self.rigid_scale
            total[u] += s * q[v] * t**2 / 2
            for k in range(len(g)):
                total[u] += s * g[k][v] * t ** (k + 3) / ((k + 1) * (k + 2) * (k + 3))
        return total

    def _responses(self, t: NDArray[Any], degree: int) -> tuple[Complex, Complex]:
        """Return the responses at times `t` to a unit of q, shape (n_q, n_t), and to a unit of each g,
        shape (degree + 1, n_q, n_t): exponentials and ``t^(k+1) K_k(lambda t)``.
        """
        z = self.eigenvalues[:, None] * t
        e = np.exp(z)
        return e, phi.duhamel(z, degree, e) * powers(t, degree + 1)[1:, None, :]

    def _table(self, h: float, count: int, degree: int) -> Complex:
        """Return `_responses` at 0, h, ..., (count - 1) h, cached, shape (n_q, degree + 2, count)."""
        table = self._tables.get((h, degree))
        if table is None or table.shape[2] < count:
            e, tables = self._responses(h * np.arange(max(count, MIN_SAMPLES)), degree)
            table = np.concatenate([e[:, None], tables.swapaxes(0, 1)], axis=1)
            self._tables[h, degree] = table
        return table[:, :, :count]

    def _single_response(self, t: float, degree: int) -> tuple[Complex, Complex]:
        """Return `_responses` at one time, cached if there is room: interval lengths recur."""
        response = self._single.get((t, degree))
        if response is None:
            e, tables = self._responses(np.array([t]), degree)
            response = e[:, 0], tables[:, :, 0]
            if len(self._single) < MAX_TABLES:
                self._single[t, degree] = response
        return response

    def samples(self, qs: Complex, gs: Complex, h: float, count: int) -> Complex:  # noqa: D102
        table = self._table(h, count, gs.shape[1] - 1)
        return self._superposed(qs, gs, h * np.arange(count), table)

    def at(self, q: Complex, g: Complex, t: float) -> Complex:  # noqa: D102
        e, table = self._single_response(t, len(g) - 1)
        state: Complex = e * q + (table * g).sum(axis=0)
        if len(self.rigid_u):
            state = state[:, None, None]
            self._add_rigid_motion(state, q[:, None], g[None], np.array([t]))
            state = state[:, 0, 0]
        return state

    def free_motion(self, q: Complex, times: Array) -> Complex:  # noqa: D102
        after: Complex = q * np.exp(times[:, None] * self.eigenvalues)
        after[..., self.rigid_u] += self.rigid_scale * times[:, None] * q[..., self.rigid_v]
        return after

    def free_integral(self, q: Complex, times: Array) -> Complex:  # noqa: D102
        t = times[:, None]
        integral: Complex = q * t * phi.duhamel(t * self.eigenvalues, 0)[0]
        integral[..., self.rigid_u] += self.rigid_scale * 0.5 * t * t * q[..., self.rigid_v]
        return integral

    def march(self, q: Complex, gs: Complex, lengths: Array) -> Complex:  # noqa: D102
        if len(self.rigid_u):
            return super().march(q, gs, lengths)
        states = np.empty((len(q), len(gs) + 1), complex)
        states[:, 0], states[:, 1] = q, self.at(q, gs[0], float(lengths[0]))
        if len(gs) > 1:  # the others are equal
            e, table = self._single_response(float(lengths[1]), gs.shape[1] - 1)
            q = states[:, 1]
            for i, forced in enumerate((table * gs[1:]).sum(axis=1), 2):
                states[:, i] = q = e * q + forced
        return states

    def derivative_bounds(self, qs: Complex, gs: Complex, lengths: Array) -> Array:  # noqa: D102
        # dq/dt = lambda q + g, and its derivatives likewise: |exp(lambda t)| times their start, plus the
        # largest contribution of the derivatives of g
        u, v, g = self.rigid_u, self.rigid_v, gs.transpose(1, 2, 0)
        start = qs
        growth = np.exp(np.maximum(self.eigenvalues.real[:, None], 0.0) * lengths)
        bounds = np.empty((3, *qs.shape))
        for order in range(3):
            before = start
            start = self.eigenvalues[:, None] * start
            if order < len(g):
                start += factorial(order) * g[order]
            start[u] += self.rigid_scale[:, None] * before[v]
            later = polynomial.values(np.abs(gs), lengths, order + 1).T
            bounds[order] = growth * (np.abs(start) + lengths * later)
            bounds[order, u] += lengths * np.abs(self.rigid_scale[:, None]) * bounds[order, v]
        return bounds[1:]

    def rate_rows(self, rows: Complex) -> Complex:  # noqa: D102
        rates = rows * self.eigenvalues
        rates[..., self.rigid_v] += rows[..., self.rigid_u] * self.rigid_scale
        return rates

    def _taylor_rows(self, row: Complex, h: float) -> Complex:
        factors = self._powers.get(h)
        if factors is None:
            steps = h * self.eigenvalues / np.arange(1, TAYLOR_TERMS)[:, None]
            factors = np.cumprod(np.concatenate([np.ones((1, len(self.eigenvalues))), steps]), axis=0)
            if len(self._powers) < MAX_TABLES:
                self._powers[h] = factors
        rows = row * factors
        rows[1, self.rigid_v] += h * row[self.rigid_u] * self.rigid_scale
        return rows

    def trajectories(self, qs: Complex, gs: Complex, times: Array) -> Complex:  # noqa: D102
        e, tables = self._responses(times, gs.shape[1] - 1)
        table = np.concatenate([e[:, None], tables.swapaxes(0, 1)], axis=1)
        return self._superposed(qs, gs, times, table)

    def _superposed(self, qs: Complex, gs: Complex, times: NDArray[Any], table: Complex) -> Complex:
        """Superpose a table of responses (n_q, degree + 2, n_times) to starts and forcing."""
        start = np.concatenate([qs[:, :, None], gs.transpose(2, 0, 1)], axis=2)
        states: Complex = start @ table
        self._add_rigid_motion(states, qs, gs, times)
        return states

    def _add_rigid_motion(self, out: Complex, qs: Complex, gs: Complex, t: NDArray[Any]) -> None:
        """Add the effect of rigid-body velocities and forces on rigid-body displacements, shape
        (n_q, n, n_t).
        """
        if len(self.rigid_u):
            u, v, s = self.rigid_u, self.rigid_v, self.rigid_scale[:, None, None]
            out[u] += s * qs[v][:, :, None] * t
            for k in range(gs.shape[1]):
                out[u] += s * gs[:, k, v].T[:, :, None] * t ** (k + 2) / ((k + 1) * (k + 2))


def block_diagonal(blocks: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Return a block-diagonal matrix of the given blocks."""
    matrix = np.zeros(np.sum([b.shape for b in blocks], axis=0), np.result_type(*blocks))
    i = j = 0
    for b in blocks:
        matrix[i : i + b.shape[0], j : j + b.shape[1]] = b
        i, j = i + b.shape[0], j + b.shape[1]
    return matrix
