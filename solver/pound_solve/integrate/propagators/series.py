"""Propagator by the exponential series of the state matrix, for defective complex modes."""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.propagators.base import TAYLOR_TERMS, Propagator, gauss
from pound_solve.integrate.propagators.state_space import StateSpace
from pound_solve.numerics import polynomial
from pound_solve.numerics.types import Array

MAX_TERMS = 80  #: of the exponential series in a substep
TRUNCATION = 1e-18  #: fraction of the sum below which a term ends the series


class SeriesPropagator(Propagator):
    """Motion by the exponential series of the state matrix; q is the state itself."""

    def __init__(self, space: StateSpace, inputs: Array) -> None:
        super().__init__(space, inputs)
        self.space = space
        self.u_q, self.v_q = space.u_z, space.v_z
        self._input_forcing = space.b @ inputs
        self.norm = float(np.linalg.norm(space.a, 2))
        self.spectral_radius = self.norm  # a bound of it
        self.condition, self.residual = 1.0, 0.0
        self._maps: dict[tuple[float, int], Array] = {}

    def state_of(self, u: Array, v: Array) -> Array:  # noqa: D102
        return self.space.z_u @ u + self.space.z_v @ v

    def forcing(self, input_coefs: Array, constant: Array) -> Array:  # noqa: D102
        g = input_coefs @ self._input_forcing.T
        g[..., 0, :] += self.space.b @ constant
        return g

    def load_forcing(self, p: Array) -> Array:  # noqa: D102
        return p @ self.space.b.T

    def integral(self, q: Array, g: Array, t: float) -> Array:  # noqa: D102
        w, points = gauss(t, self.spectral_radius)
        return self.trajectory(q, g, points) @ w

    def derivative_bounds(self, qs: Array, gs: Array, lengths: Array) -> Array:  # noqa: D102
        return np.full((2, *qs.shape), np.inf)

    def rate_rows(self, rows: Array) -> Array:  # noqa: D102
        return rows @ self.space.a

    def _taylor_rows(self, row: Array, h: float) -> Array:
        rows = [row]
        for m in range(1, TAYLOR_TERMS):
            rows.append(h / m * (rows[-1] @ self.space.a))
        return np.array(rows)

    def trajectories(self, qs: Array, gs: Array, times: Array) -> Array:  # noqa: D102
        # from each time to the next
        states = np.empty((*qs.shape, len(times)))
        for n, (q, g) in enumerate(zip(qs.T, gs)):
            last = 0.0
            for i, t in enumerate(times.tolist()):
                q = self.at(q, polynomial.shift(g, last), t - last)
                states[:, n, i], last = q, t
        return states

    def at(self, q: Array, g: Array, t: float) -> Array:  # noqa: D102
        substeps = max(1, int(np.ceil(abs(t) * self.norm)))
        h = t / substeps
        for i in range(substeps):
            q = self._substep(q, polynomial.shift(g, i * h), h)
        return q

    def free_motion(self, q: Array, times: Array) -> Array:  # noqa: D102
        return np.asarray(np.einsum("tij,...tj->...ti", self._exponentials(times)[0], q))

    def free_integral(self, q: Array, times: Array) -> Array:  # noqa: D102
        return np.asarray(np.einsum("tij,...tj->...ti", self._exponentials(times)[1], q))

    def _exponentials(self, times: Array) -> tuple[Array, Array]:
        """Return the exponentials of the state matrix times each time, and their integrals from zero."""
        from scipy.linalg import expm  # slow to import, and few runs need it

        n = len(self.space.a)
        augmented = np.zeros((2 * n, 2 * n))
        augmented[:n, :n], augmented[:n, n:] = self.space.a, np.eye(n)
        whole = expm(times[:, None, None] * augmented)
        return whole[:, :n, :n], whole[:, :n, n:]

    def _substep(self, q: Array, g: Array, h: float) -> Array:
        """Return the state after a substep with ``|a| h <= 1``, by the Taylor series of the solution."""
        term, total, j = q.copy(), q.copy(), 0
        while True:
            # q^(j+1) / (j+1)! h^(j+1) from q^(j) / j! h^j; the force adds its Taylor coefficient
            term = h / (j + 1) * (self.space.a @ term)
            if j < len(g):
                term = term + g[j] * h ** (j + 1) / (j + 1)
            total = total + term
            j += 1
            small = TRUNCATION * np.abs(total).max(initial=0.0)
            if j > MAX_TERMS or (j > len(g) and np.abs(term).max(initial=0.0) <= small):
                return total

    def samples(self, qs: Array, gs: Array, h: float, count: int) -> Array:  # noqa: D102
        step, forcing = self._step_map(h, gs.shape[1] - 1), gs.swapaxes(0, 1)
        states = np.empty((*qs.shape, count))
        states[:, :, 0] = qs
        for i in range(1, count):
            local = polynomial.shift(forcing, (i - 1) * h).transpose(0, 2, 1)
            states[:, :, i] = step @ np.concatenate([states[:, :, i - 1], *local])
        return states

    def _step_map(self, h: float, degree: int) -> Array:
        """Return the matrix of a step for (q, g_0, ..., g_degree), cached, (n_q, (degree + 2) n_q)."""
        key = (h, degree)
        if key not in self._maps:
            size = len(self.space.a)
            unit = np.zeros((degree + 1, size))
            columns = [self.at(e, unit, h) for e in np.eye(size)]
            for k in range(degree + 1):
                for i in range(size):
                    unit[k, i] = 1.0
                    columns.append(self.at(np.zeros(size), unit, h))
                    unit[k, i] = 0.0
            self._maps[key] = np.array(columns).T
        return self._maps[key]
