r"""Kernels of TAYLOR: intervals that are advanced in modes because they certainly contain no event.

While no contact is closed and all laws are on branches with their initial stiffness, the motion over an
interval between two goals is known in closed form (`modal_tables`).  An interval without an event is
advanced by this form; any other is advanced by series.

A followed quantity is :math:`y = \mathrm{Re}\sum_j \rho_j c_j e^{\lambda_j t}` plus a straight line.  Its
distance from the chord between two places a time :math:`\tau` apart is at most

.. math:: |y - y_\text{chord}| \le \sum_j |\rho_j|\,|c_j| \min\bigl(2, \tfrac18|\lambda_j\tau|^2\bigr)

The bound holds because no mode grows: :math:`|c_j e^{\lambda_j t}| \le |c_j|` bounds a mode and
the ends of its chord, and :math:`\tau^2/8` times the second derivative bounds its distance from the chord.
If an event or a peak may therefore lie in a cell, the power series of that quantity over the cell, with the
terms :math:`\rho_j c_j (\lambda_j\tau)^k/k!`, decides, as in a step by series.
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.energy import Works
from pound_solve.integrate.events.polynomial_roots import POLYNOMIAL
from pound_solve.integrate.intervals import SAME_LENGTH
from pound_solve.integrate.kernels.law_state import BranchEvents, Laws
from pound_solve.integrate.kernels.products import row_product
from pound_solve.integrate.kernels.recording import update_extreme
from pound_solve.integrate.kernels.state import LinearSystem, Piece, Simulation, Step
from pound_solve.integrate.series.envelope_buffers import keep_interval
from pound_solve.integrate.series.expansion import MAX_DEGREE, UNCHECKED_TERMS, dot, expand_inputs
from pound_solve.integrate.series.state import Extent, Modal, Series
from pound_solve.integrate.series.tracking import event_of, track_law, update_peak
from pound_solve.integrate.tracker import TrackedExtremes
from pound_solve.numerics.jit import reorder_sums
from pound_solve.numerics.types import Array

SERIES_ROUNDING = 1e-16  #: fraction of the terms of a series that is rounding
UNKNOWNS, MODES, FOLLOWED, SHOWN = range(4)  #: columns of `Modal.counts`
DISPLACEMENT, VELOCITY = range(2)  #: rows of `Modal.to_modes` and `Modal.from_modes`


@reorder_sums
def multiply_dense(a: Array, x: Array, rows: int, columns: int, out: Array, before: float) -> None:
    """Set the first `rows` of `out` to the product of a matrix and a vector plus `before` times their
    previous values.
    """
    for i in range(rows):
        total = before * out[i]
        for j in range(columns):
            total += a[i, j] * x[j]
        out[i] = total


def refresh_modes(laws: Laws, series: Series) -> None:
    """Check whether the modes are valid on the present branches, and compute their static positions."""
    modal = series.modal
    modal.is_valid[0] = 0
    if modal.length == 0.0:
        return
    for i in range(len(laws.definition.rule)):
        if laws.tangent.stiffness[i] != modal.stiffness[i] or laws.tangent.damping[i] != 0.0:
            return
    modal.is_valid[0] = 1
    for i in range(len(modal.offset)):
        modal.offset[i] = 0.0
    for b in range(len(modal.counts)):
        n, twice = modal.counts[b, UNKNOWNS], 2 * modal.counts[b, MODES]
        load, equilibrium = modal.x[b, 0], modal.equilibrium[b]
        for i in range(n):
            load[i] = series.springs.constant[modal.unknowns[b, i]]
        multiply_dense(modal.static_positions[b], load, twice, n, equilibrium, 0.0)
        for i in range(modal.counts[b, FOLLOWED]):
            at = modal.followed[b, i]
            for j in range(twice):
                modal.offset[at] += modal.rows[b, i, j] * equilibrium[j]


def to_modes(modal: Modal, step: Step) -> None:
    """Convert the present motion to modal coordinates."""
    now = step.now
    for b in range(len(modal.counts)):
        n, twice = modal.counts[b, UNKNOWNS], 2 * modal.counts[b, MODES]
        for kind in range(2):
            motion = now.displacement if kind == DISPLACEMENT else now.velocity
            for i in range(n):
                modal.x[b, 0, i] = motion[modal.unknowns[b, i]]
            multiply_dense(modal.to_modes[b, kind], modal.x[b, 0], twice, n, modal.modes[b], kind)
    modal.is_present[0] = 1


def from_modes(laws: Laws, modal: Modal, step: Step) -> None:
    """Convert the modal coordinates back to the present motion, if the motion is in modes."""
    rows, largest = laws.definition.rows, laws.largest
    if not modal.is_present[0]:
        return
    now = step.now
    for b in range(len(modal.counts)):
        n, twice = modal.counts[b, UNKNOWNS], 2 * modal.counts[b, MODES]
        for kind in range(2):
            motion = now.displacement if kind == DISPLACEMENT else now.velocity
            multiply_dense(modal.from_modes[b, kind], modal.modes[b], n, twice, modal.x[b, 0], 0.0)
            for i in range(n):
                motion[modal.unknowns[b, i]] = modal.x[b, 0, i]
    for i in range(len(laws.definition.rule)):
        d, v = row_product(rows, i, now.displacement), row_product(rows, i, now.velocity)
        laws.now.deformation[i], laws.now.rate[i] = d, v
        largest.deformation[i] = max(largest.deformation[i], abs(d))
        largest.rate[i] = max(largest.rate[i], abs(v))


def start_interval(modal: Modal, inputs: Array) -> None:
    """Compute the state x, of modes and inputs, at the ends and the middles of all cells."""
    n_inputs, places = inputs.shape[1], modal.exponentials.shape[1]
    for b in range(len(modal.counts)):
        count, x = modal.counts[b, MODES], modal.x[b]
        for place in range(places):
            for j in range(n_inputs):
                later = inputs[1, j] * place / (places - 1)
                x[place, 2 * count + j], x[place, 2 * count + n_inputs + j] = (
                    inputs[0, j] + later,
                    inputs[1, j],
                )
        for i in range(2 * count):
            x[0, i] = modal.modes[b, i] - modal.equilibrium[b, i]
            for j in range(2 * n_inputs):
                x[0, i] -= modal.particular_solution[b, i, j] * x[0, 2 * count + j]
        for place in range(1, places):
            re, im = modal.exponentials[b, place, 0], modal.exponentials[b, place, 1]
            for j in range(count):
                x[place, j] = re[j] * x[0, j] - im[j] * x[0, count + j]
                x[place, count + j] = re[j] * x[0, count + j] + im[j] * x[0, j]


def follow_cells(linear: LinearSystem, modal: Modal, n_inputs: int) -> None:
    """Compute the followed quantities at the ends of all cells, and bounds of their departure from
    chords.
    """
    n_followed, outputs, ends = len(modal.offset), len(linear.monitored_constants), len(modal.values)
    for i in range(n_followed):
        modal.chord_error[i] = 0.0
        constant = modal.offset[i]
        if i >= n_followed - outputs:
            constant += linear.monitored_constants[i - n_followed + outputs]
        for end in range(ends):
            modal.values[end, i] = constant
    for b in range(len(modal.counts)):
        count, x = modal.counts[b, MODES], modal.x[b]
        size = 2 * (count + n_inputs)
        for j in range(count):
            free = np.sqrt(x[0, j] * x[0, j] + x[0, count + j] * x[0, count + j])
            modal.mode_chord_error[b, j] = modal.chord_error_factor[b, j] * free
        for i in range(modal.counts[b, FOLLOWED]):
            at, row = modal.followed[b, i], modal.rows[b, i, :size]
            modal.chord_error[at] += dot(modal.amplitude[b, i, :count], modal.mode_chord_error[b, :count])
            for end in range(ends):
                modal.values[end, at] += dot(row, x[2 * end, :size])


def cell_bounds(modal: Modal, cell: int, i: int) -> tuple[float, float]:
    """Return bounds of a followed quantity over a cell."""
    begin, end = modal.values[cell, i], modal.values[cell + 1, i]
    return min(begin, end) - modal.chord_error[i], max(begin, end) + modal.chord_error[i]


@reorder_sums
def next_powers(re: Array, im: Array, turn: Array, share: float) -> tuple[float, float]:
    """Multiply complex numbers by their factors `turn` times `share`; return their real sum, and the sum of
    their magnitudes.
    """
    total, sizes = 0.0, 0.0
    for j in range(len(re)):
        real = (re[j] * turn[0, j] - im[j] * turn[1, j]) * share
        im[j] = (re[j] * turn[1, j] + im[j] * turn[0, j]) * share
        re[j] = real
        total += real
        sizes += abs(real) + abs(im[j])
    return total, sizes


def expand_in_cell(modal: Modal, cell: int, i: int, n_inputs: int, p: Array) -> int:
    """Form the power series of a followed quantity over a cell; return its degree, 0 if it is too high."""
    for k in range(MAX_DEGREE + 1):
        p[k] = 0.0
    p[0], degree = modal.values[cell, i], UNCHECKED_TERMS
    for b in range(len(modal.counts)):
        at, count = modal.index_of[b, i], modal.counts[b, MODES]
        if at < 0:
            continue
        row, x, later = modal.rows[b, at], modal.x[b, 2 * cell], modal.x[b, 2 * cell + 2]
        for j in range(2 * count, 2 * (count + n_inputs)):
            p[1] += row[j] * (later[j] - x[j])
        re, im, turn = modal.term[0], modal.term[1], modal.exponent_per_cell[b]
        first, fastest = abs(p[0]), 0.0
        for j in range(count):
            re[j] = row[j] * x[j] + row[count + j] * x[count + j]
            im[j] = row[j] * x[count + j] - row[count + j] * x[j]
            first += abs(re[j]) + abs(im[j])
            fastest = max(fastest, abs(turn[0, j]) + abs(turn[1, j]))
        k, tail = 0, first
        while tail > SERIES_ROUNDING * first or k < fastest:
            k += 1
            if k > MAX_DEGREE:
                return 0
            term, tail = next_powers(re[:count], im[:count], turn, 1.0 / k)
            p[k] += term
        degree = max(degree, k)
    return degree


def may_change(events: BranchEvents, modal: Modal, cell: int, i: int) -> bool:
    """Return whether law `i` may leave its branch within a cell, by the bounds of its deformation (not of
    its rate).
    """
    coefficients = events.coefficients
    low, high = cell_bounds(modal, cell, i)
    for e in range(events.n_events[i]):
        on_d, on_v, constant = coefficients[i, e, 0], coefficients[i, e, 1], coefficients[i, e, 2]
        if on_v != 0.0 or (on_d != 0.0 and not max(on_d * low, on_d * high) + constant <= 0.0):
            return True
    return False


def is_quiet(laws: Laws, series: Series, n_inputs: int, t: float) -> bool:
    """Return whether no law can leave its branch within the interval that starts at the time `t`."""
    modal = series.modal
    cells = len(modal.values) - 1
    h = modal.length / cells
    for cell in range(cells):
        for i in range(len(laws.definition.rule)):
            if may_change(laws.events, modal, cell, i):
                degree = expand_in_cell(modal, cell, i, n_inputs, series.deformation[i])
                if degree == 0 or event_of(laws, series, Extent(t + cell * h, h, degree, 1.0), i).law >= 0:
                    return False
    return True


def exceeds_peaks(extremes: TrackedExtremes, i: int, low: float, high: float) -> bool:
    """Return whether a tracked quantity within these bounds may exceed its peaks."""
    return not (high <= extremes.high[i] and low >= extremes.low[i])


def update_peaks_at_cell_ends(
    laws: Laws, step: Step, modal: Modal, i: int, at: int, k: float, constant: float, t: float
) -> None:
    """Update peak `at` with ``k y + constant`` at the ends of the cells, where y is followed quantity `i`.
    The motion within cells then seldom exceeds the peak.
    """
    cells = len(modal.values) - 1
    for end in range(cells + 1):
        when = t + end * modal.length / cells
        update_extreme(laws, step, -1, at, k * modal.values[end, i] + constant, when)


def update_peaks(sim: Simulation, series: Series, n_inputs: int, t: float) -> bool:
    """Update the peaks with the motion within the interval; False if a power series would be too long."""
    laws, step = sim.laws, sim.step
    tangent = laws.tangent
    modal, n_laws, outputs = series.modal, len(laws.definition.rule), len(sim.linear.monitored_constants)
    cells, extremes = len(modal.values) - 1, step.extremes
    h = modal.length / cells
    for i in range(n_laws):
        k, offset = tangent.stiffness[i], tangent.offset[i]
        update_peaks_at_cell_ends(laws, step, modal, i, outputs + i, 1.0, 0.0, t)
        update_peaks_at_cell_ends(laws, step, modal, i, outputs + n_laws + i, k, offset, t)
    for i in range(outputs):
        update_peaks_at_cell_ends(laws, step, modal, n_laws + i, i, 1.0, 0.0, t)
    for cell in range(cells):
        for i in range(n_laws):
            low, high = cell_bounds(modal, cell, i)
            k, offset = tangent.stiffness[i], tangent.offset[i]
            least, most = min(k * low, k * high) + offset, max(k * low, k * high) + offset
            force = outputs + n_laws + i
            if exceeds_peaks(extremes, outputs + i, low, high) or exceeds_peaks(
                extremes, force, least, most
            ):
                degree = expand_in_cell(modal, cell, i, n_inputs, series.deformation[i])
                if degree == 0:
                    return False
                track_law(laws, step, series, Extent(t + cell * h, h, degree, 1.0), outputs, i)
        for i in range(outputs):
            low, high = cell_bounds(modal, cell, n_laws + i)
            if exceeds_peaks(extremes, i, low, high):
                p = series.polynomial[POLYNOMIAL]
                degree = expand_in_cell(modal, cell, n_laws + i, n_inputs, p)
                if degree == 0:
                    return False
                update_peak(laws, step, series, Extent(t + cell * h, h, degree, 1.0), i, -1)
    return True


def add_interval_works(modal: Modal, n_inputs: int, works: Works) -> None:
    """Add up the works over the interval."""
    put = 0.0
    for b in range(len(modal.counts)):
        first, x = 2 * modal.counts[b, MODES], modal.x[b, 0]
        size = first + 2 * n_inputs
        for i in range(size):  # one half of a symmetric form
            half = dot(modal.damping_work[b, i, :i], x[:i])
            works.damping += x[i] * (2.0 * half + modal.damping_work[b, i, i] * x[i])
        for i in range(2 * n_inputs):
            put += x[first + i] * dot(modal.input_work[b, i, :size], x[:size])
        put += dot(modal.constant_work[b, :size], x[:size])
    works.input += put
    works.gross_input += abs(put)


def advance_modes(modal: Modal, n_inputs: int) -> None:
    """Advance the modes to the end of the interval."""
    for b in range(len(modal.counts)):
        twice, modes = 2 * modal.counts[b, MODES], modal.modes[b]
        x = modal.x[b, modal.exponentials.shape[1] - 1]
        for i in range(twice):
            modes[i] = x[i] + modal.equilibrium[b, i]
            for j in range(2 * n_inputs):
                modes[i] += modal.particular_solution[b, i, j] * x[twice + j]


def advance_in_modes(sim: Simulation, series: Series, piece: Piece, goal: float) -> bool:
    """Advance in modes over the interval up to a goal; return False if that may be wrong.

    The motion stays in the modes: call `from_modes` before using it.
    """
    run = sim.run
    modal, n_inputs = series.modal, series.inputs.shape[1]
    if run.branches_changed or not modal.is_valid[0]:
        return False
    h = modal.length
    if abs(goal - run.time - h) > SAME_LENGTH * h:
        return False
    if not modal.is_present[0]:
        to_modes(modal, sim.step)
    expand_inputs(series, piece, run.time, h)
    start_interval(modal, series.inputs)
    follow_cells(sim.linear, modal, n_inputs)
    if not is_quiet(sim.laws, series, n_inputs, run.time):
        return False
    if not update_peaks(sim, series, n_inputs, run.time):
        return False
    add_interval_works(modal, n_inputs, sim.works)
    keep_interval(sim.laws.tangent, series, run.time)
    advance_modes(modal, n_inputs)
    run.time = goal
    run.steps += 1
    series.control.n_modal_intervals += 1
    return True
