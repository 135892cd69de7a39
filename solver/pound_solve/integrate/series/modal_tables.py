r"""Tables for intervals in modes: the matrices that `modal` multiplies with, for one interval length h.

On the initial branches, each part of the structure that only contacts join to others has separate complex
modes, :math:`\dot q_i = \lambda_i q_i + F_i s(t)`.  Under inputs that are straight lines over the
interval, :math:`s = \sigma_0 + \sigma_1 t/h`, each is a free motion plus a straight line,

.. math:: q_i = c_i\,e^{\lambda_i t} - \frac{F_i}{\lambda_i}\Bigl(\sigma_0 + \frac{\sigma_1}{\lambda_i h}
          + \sigma_1\frac th\Bigr),

so that every quantity at a place of the interval is a product of a table with :math:`x = (\mathrm{Re}\,c,
\mathrm{Im}\,c, \sigma_0, \sigma_1)`, and the works are quadratic forms of x.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pound_solve.integrate import costs
from pound_solve.integrate.intervals import MAX_UNKNOWNS, MIN_RADIANS, most_common_length
from pound_solve.integrate.protocol import MonitoredOutputs
from pound_solve.integrate.series.state import Modal
from pound_solve.numerics.graph import components
from pound_solve.numerics.matrices import dense, used_rows
from pound_solve.numerics.memo import by_content
from pound_solve.numerics.types import Array, Complex, Index
from pound_solve.structure.reduction import ReducedSystem

MAX_CONDITION = 3e3  #: of its modes
NOT_HELD = 1e-9  #: fraction of the fastest rate below which a mode is not held
GROWS = 1e-12  #: fraction of the fastest rate above which a mode that grows does so beyond rounding
MAX_CELLS = 100_000  #: most cells in an interval: faster modes get no table
MAX_RADIANS = 5.0  #: most radians of the fastest mode in a cell, as in a step by series
MIN_CELLS = 4  #: cells
START = np.zeros(1)  #: of an interval
PANEL, POINTS = 8.0, 16  #: radians that Gauss's rule with so many points integrates to rounding


class WorkForms(NamedTuple):
    """Works over an interval on x: the dashpots' loss is ``x^T D x``, the input ``sigma^T P x + w x``.

    Attributes
    ----------
    damping, input, constant : ndarray
        D, P and w.
    """

    damping: Array
    input: Array
    constant: Array


class ModalPart:
    """A part of the structure over intervals of one length.

    Parameters
    ----------
    mass, damping, stiffness : ndarray, shape (n, n)
        Matrices of its n unknowns, including laws on their branches.
    inputs : ndarray, shape (n, n_inputs)
    constant : ndarray, shape (n,)
    rows : ndarray, shape (n_laws + n_monitored, n)
        Deformations of the laws and monitored outputs.
    length : float

    Attributes
    ----------
    followed : ndarray of int
        Indices of the deformations of the laws and the monitored outputs that it moves.
    rows : ndarray of complex, shape (n_followed, n_modes)
        These quantities in terms of the modes.

    Raises
    ------
    numpy.linalg.LinAlgError
        The modes do not span the motion, or a mode is not held or grows.
    """

    def __init__(
        self, mass: Array, damping: Array, stiffness: Array, inputs: Array, constant: Array, rows: Array,
        length: float,
    ) -> None:  # fmt: skip
        # loaded only if modes pay
        from pound_solve.integrate.propagators.modal import ModalPropagator
        from pound_solve.integrate.propagators.state_space import state_space

        self.damping, self.inputs, self.constant, self.length = damping, inputs, constant, length
        self.modes = ModalPropagator(state_space(mass, damping, stiffness), inputs)
        self.eigenvalues = self.modes.eigenvalues
        size = np.abs(self.eigenvalues)
        loose = size.min() < NOT_HELD * size.max() or self.eigenvalues.real.max() > GROWS * size.max()
        if loose or self.modes.condition > MAX_CONDITION:
            raise np.linalg.LinAlgError
        unit, none = np.eye(inputs.shape[1]), np.zeros(len(mass))
        forcing = np.array([self.modes.forcing(s[None], none)[0] for s in unit]).T
        self.steady = -forcing.reshape(len(self.eigenvalues), len(unit)) / self.eigenvalues[:, None]
        self.static_positions = -self.modes.load_forcing(np.eye(len(mass))).T / self.eigenvalues[:, None]
        self.followed = np.flatnonzero(rows.any(axis=1))
        self.rows = rows[self.followed] @ self.modes.u_q

    def table(self, rows: Complex, places: Array, order: int = 0) -> Array:
        """Return the derivative of order 0 or 1 of some rows at places in [0, 1] of the interval, as rows
        on x, shape (n_places, n_rows, n_x).
        """
        growth = np.exp(self.eigenvalues * self.length * places[:, None])
        free = (rows * self.eigenvalues**order) * growth[:, None]
        start, slope = rows @ self.steady, rows @ (self.steady / (self.eigenvalues * self.length)[:, None])
        grown = slope + start * places[:, None, None]
        if order:
            start, grown = 0.0 * start, np.broadcast_to(start / self.length, grown.shape)
        first = np.broadcast_to(start, grown.shape)
        return np.concatenate([free.real, -free.imag, first.real, grown.real], axis=2)

    @cached_property
    def works(self) -> WorkForms:
        """Works over the interval."""
        panels = int(np.ceil(np.abs(self.eigenvalues).max() * self.length / PANEL))
        points, weights = np.polynomial.legendre.leggauss(POINTS)
        places = ((np.arange(panels)[:, None] + 0.5 + 0.5 * points) / panels).ravel()
        shares = np.tile(0.5 * self.length / panels * weights, panels)
        damped = used_rows(self.damping)
        c, v = self.damping[np.ix_(damped, damped)], self.modes.v_q
        velocity = self.table(v[damped], places)
        force = shares[:, None, None] * (c @ velocity)
        lost = np.tensordot(velocity, force, axes=([0, 1], [0, 1]))
        power = shares[:, None, None] * self.table(self.inputs.T @ v, places)
        put = np.vstack([power.sum(axis=0), (places[:, None, None] * power).sum(axis=0)])
        start, end = self.table(self.constant[None] @ self.modes.u_q, np.array([0.0, 1.0]))[:, 0]
        return WorkForms(lost, put, end - start)


#: runs of one structure under several motions share them
shared_part = by_content(most=16)(ModalPart)


def parts_of(
    system: ReducedSystem, stiffness: Array, monitored: Array, length: float
) -> list[tuple[Index, ModalPart]]:
    """Return the parts that only contacts join, with their unknowns; none if modes do not apply or pay."""
    straight = system.excitation.coefs.shape[1] <= 2
    if not straight or length == 0.0 or costs.fastest_rate(system) * length < MIN_RADIANS:
        return []
    laws = dense(system.law_rows)
    groups = [np.flatnonzero(row) for s, row in zip(system.structure.laws, laws) if not s.role.collides]
    label = components(system.size, (system.mass, system.damping, system.stiffness), groups)
    members = [np.flatnonzero(label == x) for x in np.unique(label)]
    if max(map(len, members)) > MAX_UNKNOWNS:
        return []

    def part(unknowns: Index) -> ModalPart:
        block = np.ix_(unknowns, unknowns)
        mass, damping, k = (dense(a[block]) for a in (system.mass, system.damping, system.stiffness))
        law_rows, outputs = (dense(rows[:, unknowns]) for rows in (laws, monitored))
        return shared_part(
            mass,
            damping,
            k + (law_rows.T * stiffness) @ law_rows,
            dense(system.inputs[unknowns]),
            system.constant[unknowns],
            np.vstack([law_rows, outputs]),
            length,
        )

    try:
        return [(unknowns, part(unknowns)) for unknowns in members]
    except np.linalg.LinAlgError:
        return []


def allocate(
    system: ReducedSystem, stiffness: Array, monitored: MonitoredOutputs, times: Array, place: Index,
    enveloped: Index,
) -> Modal:  # fmt: skip
    """Allocate the tables of all parts.

    Parameters
    ----------
    system : ReducedSystem
    stiffness : ndarray, shape (n_laws,)
        Stiffness of the laws on their initial branches [F/L].
    monitored : MonitoredOutputs
    times : ndarray
        Times at which the run must arrive.
    place : ndarray of int, shape (n,)
        Index of each unknown in the order of elimination.
    enveloped : ndarray of int
        Unknowns that the envelopes need, in that order.
    """
    length, outputs = most_common_length(times), dense(monitored.rows)
    open_ = np.array([not s.role.collides for s in system.structure.laws], bool)
    stiffness = stiffness * open_  # parts have separate modes while all contacts are open
    parts = parts_of(system, stiffness, outputs, length)
    if any(np.abs(p.eigenvalues).max() * length > MAX_CELLS * MAX_RADIANS for _, p in parts):
        parts = []
    seen = [np.flatnonzero(np.isin(enveloped, place[unknowns])) for unknowns, _ in parts]
    n_inputs, n_followed = system.inputs.shape[1], len(stiffness) + len(outputs)
    counts = [(len(u), len(p.eigenvalues), len(p.followed), len(s)) for (u, p), s in zip(parts, seen)]
    n, q, r, w = np.max([(0, 0, 0, 0), *counts], axis=0).tolist()
    b, size = len(parts), 2 * q + 2 * n_inputs
    fastest = max((float(np.abs(p.eigenvalues).max()) for _, p in parts), default=0.0)
    cells = max(MIN_CELLS, int(np.ceil(fastest * length / MAX_RADIANS)))
    places = 2 * cells + 1
    modal = Modal(
        length=length if parts else 0.0,
        is_present=np.zeros(1, np.int64),
        is_valid=np.zeros(1, np.int64),
        stiffness=stiffness,
        counts=np.array(counts, np.int64).reshape(b, 4),
        unknowns=np.zeros((b, n), np.int64),
        to_modes=np.zeros((b, 2, 2 * q, n)),
        from_modes=np.zeros((b, 2, n, 2 * q)),
        static_positions=np.zeros((b, 2 * q, n)),
        exponentials=np.zeros((b, places, 2, q)),
        particular_solution=np.zeros((b, 2 * q, 2 * n_inputs)),
        chord_error_factor=np.zeros((b, q)),
        followed=np.zeros((b, r), np.int64),
        index_of=np.full((b, n_followed), -1),
        exponent_per_cell=np.zeros((b, 2, q)),
        amplitude=np.zeros((b, r, q)),
        rows=np.zeros((b, r, size)),
        damping_work=np.zeros((b, size, size)),
        input_work=np.zeros((b, 2 * n_inputs, size)),
        constant_work=np.zeros((b, size)),
        enveloped=np.zeros((b, w), np.int64),
        motion=np.zeros((b, 3, w, size)),
        modes=np.zeros((b, 2 * q)),
        equilibrium=np.zeros((b, 2 * q)),
        offset=np.zeros(n_followed),
        x=np.zeros((b, places, size)),
        mode_chord_error=np.zeros((b, q)),
        term=np.zeros((2, q)),
        values=np.zeros((cells + 1, n_followed)),
        chord_error=np.zeros(n_followed),
    )
    for i, ((unknowns, p), numbers) in enumerate(zip(parts, seen)):
        fill_tables(modal, i, p, numbers, place[unknowns], enveloped[numbers])
    return modal


def fill_tables(
    out: Modal, b: int, part: ModalPart, seen: Index, unknowns: Index, enveloped: Index
) -> None:
    """Fill in the tables of part `b`.  `enveloped` are those of its `unknowns` that the envelopes need, and
    `seen` their numbers among all that the envelopes need.
    """
    modes, eigenvalues = part.modes, part.eigenvalues
    h, steady = part.length, part.steady

    def put(array: NDArray[Any], values: NDArray[Any]) -> None:
        array[b][tuple(map(slice, values.shape))] = values

    put(out.unknowns, unknowns)
    unit = np.eye(len(unknowns))
    to_modes = modes.state_of(unit, 0.0 * unit), modes.state_of(0.0 * unit, unit)
    put(out.to_modes, np.array([np.vstack([x.real, x.imag]) for x in to_modes]))
    put(out.from_modes, np.array([np.hstack([x.real, -x.imag]) for x in (modes.u_q, modes.v_q)]))
    put(out.static_positions, np.vstack([part.static_positions.real, part.static_positions.imag]))
    cells = len(out.values) - 1
    growth = np.exp(eigenvalues * h * np.linspace(0.0, 1.0, 2 * cells + 1)[:, None])
    put(out.exponentials, np.stack([growth.real, growth.imag], axis=1))
    start = np.hstack([steady, steady / (eigenvalues * h)[:, None]])
    put(out.particular_solution, np.vstack([start.real, start.imag]))
    put(out.chord_error_factor, np.minimum(2.0, (np.abs(eigenvalues) * h / cells) ** 2 / 8.0))
    put(out.followed, part.followed)
    out.index_of[b, part.followed] = np.arange(len(part.followed))
    put(out.exponent_per_cell, np.array([eigenvalues.real, eigenvalues.imag]) * h / cells)
    put(out.amplitude, np.abs(part.rows))
    put(out.rows, part.table(part.rows, START)[0])
    put(out.damping_work, part.works.damping)
    put(out.input_work, part.works.input)
    put(out.constant_work, part.works.constant)
    put(out.enveloped, seen)
    order = np.argsort(unknowns)
    places = order[np.searchsorted(unknowns, enveloped, sorter=order)]
    motion = (modes.u_q[places], 0), (modes.v_q[places], 0), (modes.v_q[places], 1)
    put(out.motion, np.concatenate([part.table(rows, START, order) for rows, order in motion]))
