r"""The motion that TAYLOR has kept for the envelopes, as a `Course`: at `LOOKS` instants of every step, at
the ends and middles of the cells of every interval in modes, and at any instant between these.

Over an interval in modes every quantity is a product of a row with :math:`x = (\mathrm{Re}\,c,
\mathrm{Im}\,c, \sigma_0, \sigma_1)` of its start (see `modal_tables`).  At a place s of the interval the
row :math:`(\rho_r, \rho_i, r_0, r_1)` is

.. math:: \bigl(\mathrm{Re}\,g\,\rho_r + \mathrm{Im}\,g\,\rho_i,\; \mathrm{Re}\,g\,\rho_i -
          \mathrm{Im}\,g\,\rho_r,\; r_0,\; r_1 + s\,r_0\bigr), \qquad g = e^{\lambda h s} .
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pound_solve.integrate.protocol import Course, Motion
from pound_solve.integrate.series.expansion import TERMS
from pound_solve.integrate.series.shown import INTERVALS, STEPS
from pound_solve.integrate.series.state import Modal, Shown
from pound_solve.numerics.crests import on_nodes
from pound_solve.numerics.types import Array, Complex, Index

LOOKS = 2  #: cells of a step, of some 2.5 radians each


class ShownSteps:
    """Steps that were kept; `order` tells the unknowns from their places in the order of elimination."""

    def __init__(self, shown: Shown, order: Index) -> None:
        self.shown, self.size = shown, len(order)
        self.unknowns = order[shown.which]

    def at(self, steps: Index | slice, places: Array) -> Motion:
        """The motion at places in [0, 1] of some steps, shape (n_steps, n_places)."""
        x = self.shown
        h, end = x.length[steps, None], x.end[steps, None]
        k = np.arange(TERMS + 1)
        s = (places * end)[..., None]
        power = np.cumprod(np.concatenate([np.ones_like(s), np.repeat(s, TERMS, axis=2)], axis=2), axis=2)
        basis = np.zeros((len(s), 3, *power.shape[1:]))
        basis[:, 0] = power
        basis[:, 1, :, 1:] = power[..., :-1] * k[1:] / h[..., None]
        basis[:, 2, :, 2:] = power[..., :-2] * (k * (k - 1))[2:] / h[..., None] ** 2
        motion = basis.reshape(len(s), -1, TERMS + 1) @ x.coefs[steps]
        u, v, a = out = np.zeros((3, self.size, places.size))
        shape = len(s), 3, places.shape[1], len(x.which)
        out[:, self.unknowns] = motion.reshape(shape).transpose(1, 3, 0, 2).reshape(3, -1, places.size)
        forces = on_nodes(places) @ x.law_forces[steps]
        t = (x.begin[steps, None] + places * end * h).ravel()
        return Motion(t, u, v, a, forces.reshape(places.size, -1).T)

    def course(self) -> Course:
        """The motion of all that were kept."""
        count, shares = int(self.shown.kept[STEPS]), np.arange(LOOKS) / LOOKS
        motion = self.at(slice(count), np.tile(shares, (count, 1)))
        whole = self.shown.length[:count] * self.shown.end[:count]

        def within(cells: Index, shares: Array) -> Motion:
            return self.at(cells // LOOKS, ((cells % LOOKS)[:, None] + shares) / LOOKS)

        return Course(motion, np.repeat(whole / LOOKS, LOOKS), within)


class ShownIntervals:
    """Intervals in modes that were kept, over the parts of the structure."""

    def __init__(self, shown: Shown, modal: Modal, order: Index) -> None:
        self.shown, self.modal, self.size = shown, modal, len(order)
        self.unknowns = order[shown.which]
        self.cells = modal.growth.shape[1] - 1
        self.rows = [self._rows(b) for b in range(len(modal.counts))]

    def _rows(self, b: int) -> Array:
        """Rows of a part for displacements, velocities, accelerations and the forces of the laws on x."""
        modal, acting, (_, q, _, seen) = self.modal, self.shown.acting, self.modal.counts[b]
        place = modal.place[b, acting]
        force = np.where(
            place[:, None] >= 0, modal.stiffness[acting, None] * modal.rows[b, np.maximum(place, 0)], 0.0
        )
        return np.vstack([*modal.motion[b, :, :seen], force])[:, : 2 * q + modal.steady.shape[2]]

    def _rates(self, b: int) -> tuple[Complex, int, int]:
        """Eigenvalues of a part times the length of the interval; numbers of modes and of inputs."""
        modal, q = self.modal, int(self.modal.counts[b, 1])
        rate = (modal.turn[b, 0, :q] + 1j * modal.turn[b, 1, :q]) * (self.cells // 2)
        return rate, q, modal.steady.shape[2] // 2

    def _on_grid(self, b: int, count: int) -> Array:
        """The rows of a part at the starts of all cells of the first `count` intervals, shape
        (n_rows, n_intervals, n_cells), by rows that are taken to these places.
        """
        rate, q, n_inputs = self._rates(b)
        places = np.arange(self.cells) / self.cells
        re, im, start, slope = np.split(self.rows[b], [q, 2 * q, 2 * q + n_inputs], axis=1)
        g, s = np.exp(rate * places[:, None])[:, None], places[:, None, None]
        whole = np.broadcast_to(start, (self.cells, *start.shape))
        parts = g.real * re + g.imag * im, g.real * im - g.imag * re, whole, slope + s * start
        table = np.concatenate(parts, axis=2)
        moved = self.shown.x[:count, b, : table.shape[2]] @ table.reshape(-1, table.shape[2]).T
        return np.asarray(moved.reshape(count, self.cells, -1).transpose(2, 0, 1))

    def _at(self, b: int, intervals: Index, places: Array) -> Array:
        """The rows of a part at places in some intervals, shape (n_rows, n_intervals, n_places), by the
        modes there.
        """
        rate, q, n_inputs = self._rates(b)
        x = self.shown.x[intervals, b, None]
        free = (x[..., :q] + 1j * x[..., q : 2 * q]) * np.exp(rate * places[..., None])
        slope = np.broadcast_to(x[..., 2 * q + n_inputs : 2 * (q + n_inputs)], (*places.shape, n_inputs))
        start = x[..., 2 * q : 2 * q + n_inputs] + slope * places[..., None]
        moved = np.concatenate([free.real, free.imag, start, slope], axis=2)
        return np.asarray((moved @ self.rows[b].T).transpose(2, 0, 1))

    def _motion(self, intervals: Index, places: Array, parts: Sequence[Array]) -> Motion:
        """The motion from the rows of all parts."""
        shown, modal = self.shown, self.modal
        t = shown.start[intervals, None] + places * modal.length[0]
        u, v, a = out = np.zeros((3, self.size, t.size))
        forces = np.repeat(shown.held[intervals].T, t.shape[1], axis=1)
        for b, (moved, (_, q, _, seen)) in enumerate(zip(parts, modal.counts.tolist())):
            own = self.unknowns[modal.shown[b, :seen]]
            for k, motion in enumerate(out):
                motion[own] = moved[k * seen : (k + 1) * seen].reshape(seen, -1)
            still = self.rows[b][:seen, : 2 * q] @ shown.rest[intervals, b, : 2 * q].T
            u[own] += np.repeat(still, t.shape[1], axis=1)
            forces += moved[3 * seen :].reshape(len(forces), -1)
        return Motion(t.ravel(), u, v, a, forces)

    def course(self) -> Course:
        """The motion of all that were kept."""
        count, parts = int(self.shown.kept[INTERVALS]), range(len(self.rows))
        places = np.arange(self.cells)[None] / self.cells
        motion = self._motion(np.arange(count), places, [self._on_grid(b, count) for b in parts])

        def within(cells: Index, shares: Array) -> Motion:
            own, cell = np.divmod(cells, self.cells)
            at = (cell[:, None] + shares) / self.cells
            return self._motion(own, at, [self._at(b, own, at) for b in parts])

        return Course(motion, np.full(count * self.cells, float(self.modal.length[0]) / self.cells), within)
