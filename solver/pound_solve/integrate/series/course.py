r"""The motion that TAYLOR keeps for envelopes, as a `Course`.

A run keeps two kinds of spans: steps, whose motion is a power series, and intervals that were advanced in
modes (see `modal_tables`).  Either is divided into cells; a `Course` gives the motion at the ends of the
cells and at any instant between them.

Over an interval of length h every quantity is the product of a row with the vector :math:`x =
(\mathrm{Re}\,c, \mathrm{Im}\,c, \sigma_0, \sigma_1)`: coefficients c of the free motions of eigenvalues
:math:`\lambda`, inputs :math:`\sigma_0`, and their changes over the interval :math:`\sigma_1`.  Let
:math:`(\rho_r, \rho_i, r_0, r_1)` be the row at the start.  At the fraction s of the interval it is

.. math:: \bigl(\mathrm{Re}\,g\,\rho_r + \mathrm{Im}\,g\,\rho_i,\; \mathrm{Re}\,g\,\rho_i -
          \mathrm{Im}\,g\,\rho_r,\; r_0,\; r_1 + s\,r_0\bigr), \qquad g = e^{\lambda h s} .
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pound_solve.integrate.events.polynomial_roots import room
from pound_solve.integrate.protocol import Course, Motion, RowPeaks
from pound_solve.integrate.series.envelope_buffers import INTERVALS, STEPS
from pound_solve.integrate.series.extremes import RowExtremes, find_extremes
from pound_solve.integrate.series.state import EnvelopeBuffers, Modal
from pound_solve.loading.excitation import Excitation
from pound_solve.numerics.providers import provider
from pound_solve.numerics.types import Array, Complex, Index

TERMS_OF_CELL = 16  #: terms of the series of a step per cell of about 2.5 radians


class StepCourse:
    """Steps kept for the envelopes; `order` holds the unknowns in the order of elimination."""

    def __init__(self, envelope: EnvelopeBuffers, order: Index, excitation: Excitation) -> None:
        self.envelope, self.size, self.excitation = envelope, len(order), excitation
        self.cells = max(envelope.coefs.shape[2] // TERMS_OF_CELL, 1)  # of a step
        self.unknowns = order[envelope.unknowns]
        self.rows = np.zeros(3 * self.size + len(envelope.laws), np.int64)  # in the coefficients
        for derivative in range(3):
            self.rows[derivative * self.size + self.unknowns] = np.arange(len(envelope.unknowns))
        self.rows[3 * self.size :] = len(envelope.unknowns) + np.arange(len(envelope.laws))
        self.derivatives = np.append(np.repeat(np.arange(3), self.size), 0 * envelope.laws)

    def _motion(self, steps: Index, places: Array) -> Motion:
        """Return the motion at places between 0 and 1 in some steps."""
        x, n, count = self.envelope, len(self.unknowns), len(places)
        first, last = (int(steps[0]), int(steps[-1]) + 1) if len(steps) else (0, 0)
        coefs = x.coefs[first:last] if last - first == len(steps) else x.coefs[steps]
        h, table = x.length[steps, None], _powers(places, coefs.shape[2])
        values = coefs[:, :n] @ table.reshape(-1, coefs.shape[2]).T
        motion = np.zeros((3, self.size, len(steps), count))
        motion[:, self.unknowns] = values.reshape(len(steps), n, 3, count).transpose(2, 1, 0, 3)
        motion[1] /= h
        motion[2] /= h**2
        forces = (coefs[:, n:] @ table[0].T).transpose(1, 0, 2)
        t = (x.begin[steps, None] + places * h).ravel()
        u, v, a = motion.reshape(3, self.size, len(t))
        return Motion(t, u, v, a, forces.reshape(coefs.shape[1] - n, len(t)))

    def _within(self, cells: Index, shares: Array) -> Motion:
        """Return the motion at fractions of some cells (see `protocol.Course`)."""
        steps = np.unique(cells // self.cells)
        places = ((np.arange(self.cells)[:, None] + shares) / self.cells).ravel()
        whole = self._motion(steps, places)
        chosen = np.searchsorted(steps, cells // self.cells) * self.cells + cells % self.cells
        if len(chosen) == self.cells * len(steps) and np.all(np.diff(chosen) == 1):
            return whole
        return Motion(*(_of_cells(x, chosen, len(shares)) for x in whole))

    def _extremes(self, peaks: RowPeaks) -> None:
        """Update the extremes of rows with the steps (see `protocol.Course`)."""
        x, count = self.envelope, int(self.envelope.kept[STEPS])
        about = self.excitation.about(x.begin[:count])
        _, n_powers, n_inputs = about.shape
        inputs = np.zeros((count, n_inputs, max(n_powers, x.coefs.shape[2])))
        inputs[:, :, :n_powers] = (
            about * x.length[:count, None, None] ** np.arange(n_powers)[:, None]
        ).swapaxes(1, 2)
        on_motion, (row, column) = peaks.rows, np.nonzero(peaks.on_inputs[:, :-1])
        rows = np.concatenate([on_motion.row, row])
        order = np.argsort(rows, kind="stable")
        source = [self.rows[on_motion.columns], x.coefs.shape[1] + column % n_inputs]
        derivative = [self.derivatives[on_motion.columns], column // n_inputs]
        factors = [on_motion.factors, peaks.on_inputs[row, column]]
        bounds = x.coefs.shape[1] + n_inputs, 3
        provider().ready(find_extremes)(
            x,
            inputs,
            RowExtremes(
                np.searchsorted(rows[order], np.arange(len(peaks.high) + 1)).astype(np.uint32),
                np.concatenate(source)[order].astype(np.uint32),
                np.concatenate(derivative)[order],
                np.concatenate(factors)[order],
                peaks.on_inputs[:, -1].copy(),
                *peaks[2:],
                np.zeros(bounds),
                np.zeros(bounds),
                np.zeros(room(x.coefs.shape[2] - 1)),
            ),
        )

    def course(self) -> Course:
        """Return the motion over all steps that were kept."""
        steps, shares = np.arange(self.envelope.kept[STEPS]), np.arange(self.cells) / self.cells
        motion = self._motion(steps, shares)
        lengths = np.repeat(self.envelope.length[steps] / self.cells, self.cells)
        return Course(motion, lengths, self._within, self._extremes)


def _powers(places: Array, count: int) -> Array:
    """Return the first `count` powers and their first two derivatives, shape (3, n_places, count)."""
    k = np.arange(count)
    powers = np.zeros((3, len(places), count))
    powers[0] = places[:, None] ** k
    powers[1, :, 1:] = powers[0, :, :-1] * k[1:]
    powers[2, :, 2:] = powers[0, :, :-2] * (k * (k - 1))[2:]
    return powers


def _of_cells(x: Array, chosen: Index, count: int) -> Array:
    """Return the columns of an array that belong to the chosen cells, `count` for each cell."""
    cells = x.reshape(*x.shape[:-1], x.shape[-1] // count, count)
    return np.asarray(cells[..., chosen, :].reshape(*x.shape[:-1], len(chosen) * count))


class IntervalCourse:
    """Intervals in modes kept for the envelopes, part by part of the structure."""

    def __init__(self, envelope: EnvelopeBuffers, modal: Modal, order: Index) -> None:
        self.envelope, self.modal, self.size = envelope, modal, len(order)
        self.unknowns = order[envelope.unknowns]
        self.cells = modal.exponentials.shape[1] - 1
        self.rows = [self._rows(b) for b in range(len(modal.counts))]

    def _rows(self, b: int) -> Array:
        """Return the rows that give displacements, velocities, accelerations and forces of laws of a part
        from its x.
        """
        modal, laws, (_, q, _, seen) = self.modal, self.envelope.laws, self.modal.counts[b]
        place = modal.index_of[b, laws]
        force = np.where(
            place[:, None] >= 0, modal.stiffness[laws, None] * modal.rows[b, np.maximum(place, 0)], 0.0
        )
        n_x = 2 * q + modal.particular_solution.shape[2]
        return np.vstack([*modal.motion[b, :, :seen], force])[:, :n_x]

    def _exponents(self, b: int) -> tuple[Complex, int, int]:
        """Return the eigenvalues of a part times the interval length; numbers of modes and of inputs."""
        modal, q = self.modal, int(self.modal.counts[b, 1])
        real, imaginary = modal.exponent_per_cell[b, :, :q]
        exponents = (real + 1j * imaginary) * (self.cells // 2)
        return exponents, q, modal.particular_solution.shape[2] // 2

    def _on_grid(self, b: int, count: int) -> Array:
        """Return the rows of a part at the starts of all cells of the first `count` intervals, shape
        (n_rows, n_intervals, n_cells), with one table for all intervals.
        """
        exponents, q, n_inputs = self._exponents(b)
        places = np.arange(self.cells) / self.cells
        re, im, start, slope = np.split(self.rows[b], [q, 2 * q, 2 * q + n_inputs], axis=1)
        g, s = np.exp(exponents * places[:, None])[:, None], places[:, None, None]
        whole = np.broadcast_to(start, (self.cells, *start.shape))
        parts = g.real * re + g.imag * im, g.real * im - g.imag * re, whole, slope + s * start
        table = np.concatenate(parts, axis=2)
        moved = self.envelope.x[:count, b, : table.shape[2]] @ table.reshape(-1, table.shape[2]).T
        return np.asarray(moved.reshape(count, self.cells, -1).transpose(2, 0, 1))

    def _at(self, b: int, intervals: Index, places: Array) -> Array:
        """Return the rows of a part at places in some intervals, shape (n_rows, n_intervals, n_places),
        with the modes evaluated there.
        """
        exponents, q, n_inputs = self._exponents(b)
        x = self.envelope.x[intervals, b, None]
        free = (x[..., :q] + 1j * x[..., q : 2 * q]) * np.exp(exponents * places[..., None])
        slope = np.broadcast_to(x[..., 2 * q + n_inputs : 2 * (q + n_inputs)], (*places.shape, n_inputs))
        start = x[..., 2 * q : 2 * q + n_inputs] + slope * places[..., None]
        moved = np.concatenate([free.real, free.imag, start, slope], axis=2)
        return np.asarray((moved @ self.rows[b].T).transpose(2, 0, 1))

    def _motion(self, intervals: Index, places: Array, parts: Sequence[Array]) -> Motion:
        """Return the motion from the rows of all parts."""
        envelope, modal = self.envelope, self.modal
        t = envelope.start[intervals, None] + places * modal.length
        u, v, a = motions = np.zeros((3, self.size, t.size))
        forces = np.repeat(envelope.constant_forces[intervals].T, t.shape[1], axis=1)
        for b, (moved, (_, q, _, seen)) in enumerate(zip(parts, modal.counts.tolist())):
            unknowns = self.unknowns[modal.enveloped[b, :seen]]
            for k, motion in enumerate(motions):
                motion[unknowns] = moved[k * seen : (k + 1) * seen].reshape(seen, t.size)
            still = self.rows[b][:seen, : 2 * q] @ envelope.equilibrium[intervals, b, : 2 * q].T
            u[unknowns] += np.repeat(still, t.shape[1], axis=1)
            forces += moved[3 * seen :].reshape(len(forces), t.size)
        return Motion(t.ravel(), u, v, a, forces)

    def course(self) -> Course:
        """Return the motion over all intervals that were kept."""
        count, parts = int(self.envelope.kept[INTERVALS]), range(len(self.rows))
        places = np.arange(self.cells)[None] / self.cells
        motion = self._motion(np.arange(count), places, [self._on_grid(b, count) for b in parts])

        def within(cells: Index, shares: Array) -> Motion:
            intervals, cell = np.divmod(cells, self.cells)
            at = (cell[:, None] + shares) / self.cells
            return self._motion(intervals, at, [self._at(b, intervals, at) for b in parts])

        return Course(motion, np.full(count * self.cells, self.modal.length / self.cells), within)
