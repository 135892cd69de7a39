r"""Unknowns without mass in a power series: kernels, and the arrays they work on.

An unknown without mass that a dashpot resists is of order one: its rate follows from the force that is left
for the dashpot.  One that springs alone resist is of order zero: its displacement follows from equilibrium.
The coefficient k of the first kind follows from the coefficients k - 1 of all unknowns and k of those with
mass; that of the second kind then follows from the coefficients k of all others:

.. math::
    \frac kh\,C_{RR}\, c_{R,k} &= p_{R,k-1} - (K c_{k-1} + f_{k-1})_R - \frac kh\,C_{RH}\, c_{H,k} \\
    K_{ZZ}\, c_{Z,k} &= p_{Z,k} - K_{ZH}\, c_{H,k} - K_{ZR}\, c_{R,k}

H, R and Z are the unknowns of order two, one and zero.  C includes the dashpots of laws, and
:math:`K_{ZZ}` the tangents of laws on unknowns of order zero; f includes the part of smooth laws beyond
their tangents (see `smooth`), which is known.  The order of an unknown depends on the branches of the laws,
so both matrices are factorised again when a branch changes, and in every step if tangents change.
:math:`c_{Z,0}` is solved for in every step, so that errors do not accumulate.
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.kernels.allocation import (
    coupled_pairs,
    laid_out,
    places,
    places_in_pattern,
    sparse_rows,
)
from pound_solve.integrate.kernels.laws import linear_force
from pound_solve.integrate.kernels.products import add_row, row_product
from pound_solve.integrate.kernels.state import Laws, LinearSystem, Step
from pound_solve.integrate.protocol import EVENT_TOLERANCE
from pound_solve.integrate.series.smooth import Q, dashpot_rest
from pound_solve.integrate.series.springs import deformation_term, load_term
from pound_solve.integrate.series.state import Massless, Series
from pound_solve.numerics.ldl import factor
from pound_solve.numerics.matrices import (
    Matrix,
    at,
    by_rows,
    diagonal,
    entries,
    scaled,
    used_rows,
    weighted,
)
from pound_solve.numerics.modes import scaling, softest
from pound_solve.numerics.types import Array, Index

DEFORMATION_JUMP = 1e-9  #: share of the largest deformation above which a change at one instant is a jump
DAMPING, STIFFNESS = range(2)  #: rows of `Massless.factors`
PARTICIPATION = 1e-6  #: share of the largest component of a motion above which an unknown takes part


def allocate(
    linear: LinearSystem, stiffness: Matrix, damping: Matrix, law_rows: Matrix, elastic: Array
) -> Massless:
    """Lay out the unknowns without mass.

    Parameters
    ----------
    linear : LinearSystem
    stiffness, damping : Matrix, shape (n, n)
        In the order of elimination, laws apart.
    law_rows : Matrix, shape (n_laws, n)
    elastic : ndarray, shape (n_laws,)
        Initial stiffness of the laws [F/L].
    """
    first = np.flatnonzero(~linear.has_mass)
    laws = np.flatnonzero(used_rows(law_rows[:, first]))
    touched = law_rows[laws][:, first]
    among = [a[np.ix_(first, first)] for a in (damping, stiffness)]
    linked = [*(entries(a)[:2] for a in among), coupled_pairs(columns for columns, _ in by_rows(touched))]
    one, other = (np.concatenate(part) for part in zip(*linked))
    layout = laid_out(len(first), one, other, np.ones(len(laws), bool))
    order, pattern, column, unknown = layout.order, layout.pattern, layout.column, first[layout.order]
    rows = sparse_rows(touched[:, order])
    pointers, pairs, values = places_in_pattern(rows, layout)
    lower = pattern.ai.astype(np.int64)
    springs = weighted(touched[:, order], elastic[laws])
    return Massless(
        unknown=unknown,
        heavy=np.flatnonzero(linear.has_mass),
        damping=sparse_rows(damping[unknown]),
        heavy_damping=sparse_rows(damping[linear.has_mass]),
        laws=laws,
        law_number=places(laws, law_rows.shape[0]),
        rows=rows,
        pattern=pattern,
        column=column,
        on_pattern=np.array([at(a[np.ix_(order, order)], lower, column) for a in among]),
        pair_pointers=pointers,
        pair_places=pairs,
        pair_values=values,
        damped=np.zeros(len(first), bool),
        members=np.zeros((2, len(first)), np.int64),
        counts=np.zeros(2, np.int64),
        factors=np.zeros((2, len(pattern.li))),
        pivots=np.ones((2, len(first))),
        matrix=np.zeros(len(column)),
        row=np.zeros(len(first)),
        right_side=np.zeros(len(first)),
        elastic=np.abs(diagonal(stiffness)[unknown] + diagonal(springs)),
    )


def form_matrix(laws: Laws, held: Massless, which: int) -> None:
    """Fill in C or K (`which`) of the unknowns without mass, with the laws on their present branches."""
    for q in range(len(held.matrix)):
        held.matrix[q] = held.on_pattern[which, q]
    for n in range(len(held.laws)):
        i = held.laws[n]
        coefficient = laws.tangent.damping[i] if which == DAMPING else laws.tangent.stiffness[i]
        for q in range(held.pair_pointers[n], held.pair_pointers[n + 1]):
            held.matrix[held.pair_places[q]] += coefficient * held.pair_values[q]


def factorise_orders(laws: Laws, held: Massless) -> int:
    """Find the orders of the unknowns on the present branches, and factorise C and K for them.

    Returns
    -------
    int
        -1, or the number of one that nothing holds, or that would snap through, by K; one that is held by
        dashpots between such unknowns alone, by C.
    """
    form_matrix(laws, held, DAMPING)
    held.counts[DAMPING] = held.counts[STIFFNESS] = 0
    for i in range(len(held.unknown)):
        held.damped[i] = held.matrix[held.pattern.ap[i]] != 0.0
        which = DAMPING if held.damped[i] else STIFFNESS
        held.members[which, held.counts[which]] = i
        held.counts[which] += 1
    for which in range(2):
        if which == STIFFNESS:
            form_matrix(laws, held, STIFFNESS)
        for q in range(len(held.matrix)):
            i, j = held.pattern.ai[q], held.column[q]
            if held.damped[i] != (which == DAMPING) or held.damped[j] != (which == DAMPING):
                held.matrix[q] = 1.0 if i == j else 0.0
        fault = factor(held.pattern, held.matrix, held.factors[which], held.pivots[which], held.row)
        if fault >= 0:
            return fault
        for i in range(len(held.unknown)):
            if held.pivots[which, i] < 0.0:
                return i
        for i in range(len(held.unknown)):
            held.pivots[which, i] = 1.0 / held.pivots[which, i]
    return -1


def undamped_unknowns(laws: Laws, held: Massless) -> Index:
    """Numbers of the unknowns of order one that take part in the motion which dashpots resist least."""
    form_matrix(laws, held, DAMPING)
    c = np.zeros((len(held.unknown), len(held.unknown)))
    c[held.pattern.ai, held.column] = c[held.column, held.pattern.ai] = held.matrix
    at = np.flatnonzero(held.damped)
    motion = softest(scaled(c[np.ix_(at, at)], scaling(c[np.ix_(at, at)])))[1]
    return np.asarray(at[np.abs(motion) > PARTICIPATION * np.abs(motion).max()], np.int64)


def solve_order(held: Massless, which: int) -> None:
    """Solve in place for the unknowns of one order; the right sides of the others do not matter."""
    s, l, d, x = held.pattern, held.factors[which], held.pivots[which], held.right_side  # noqa: E741
    members = held.members[which]
    for q in range(held.counts[which]):
        j = members[q]
        t = x[j]
        for y in range(s.lp[j], s.lp[j + 1]):
            x[s.li[y]] -= l[y] * t
    for q in range(held.counts[which] - 1, -1, -1):
        j = members[q]
        t = x[j] * d[j]
        for y in range(s.lp[j], s.lp[j + 1]):
            t -= l[y] * x[s.li[y]]
        x[j] = t


def balance_forces(series: Series, k: int, top: int, which: int) -> None:
    """Right sides for the unknowns of one order: loads less the forces of K and of the laws, with the parts
    of smooth laws and dampers beyond their tangents, at the coefficients `k`.
    """
    held, springs, c = series.massless, series.springs, series.motion[k]
    members, x = held.members[which], held.right_side
    for q in range(held.counts[which]):
        x[members[q]] = -row_product(springs.rows, held.unknown[members[q]], c)
    if k < top:
        for q in range(held.counts[which]):
            x[members[q]] += load_term(springs, series, k, top, held.unknown[members[q]])
    smooth = series.smooth
    for r in range(len(smooth.laws)):
        n = held.law_number[smooth.laws[r]]
        if n >= 0:
            add_row(held.rows, n, -smooth.numbers[r, Q] * smooth.rest[r, k], x)
    viscous = series.viscous
    for r in range(len(viscous.laws)):
        n = held.law_number[viscous.laws[r]]
        if n >= 0 and viscous.fast[r]:
            add_row(held.rows, n, -viscous.rest[r, k], x)


def add_damped(laws: Laws, series: Series, k: int, h: float, top: int) -> None:
    """Compute the coefficients `k` > 0 of the unknowns of order one."""
    held, c, x = series.massless, series.motion, series.massless.right_side
    members = held.members[DAMPING]
    balance_forces(series, k - 1, top, DAMPING)
    for q in range(held.counts[DAMPING]):
        x[members[q]] -= k / h * row_product(held.damping, members[q], c[k])
    for q in range(series.springs.n_dashpots[0]):
        i = series.springs.dashpots[q]
        if held.law_number[i] >= 0:
            force = k / h * laws.tangent.damping[i] * deformation_term(laws, series, k, top, i)
            add_row(held.rows, held.law_number[i], -force, x)
    for r in range(len(series.smooth.laws)):
        n = held.law_number[series.smooth.laws[r]]
        if n >= 0:
            add_row(held.rows, n, -dashpot_rest(laws, series.smooth, r, k - 1, h), x)
    solve_order(held, DAMPING)
    for q in range(held.counts[DAMPING]):
        c[k, held.unknown[members[q]]] = x[members[q]] * (h / k)


def add_massless(laws: Laws, step: Step, series: Series, k: int, h: float, top: int) -> None:
    """Compute the coefficients `k` of the unknowns without mass (see the module's head), which must be zero
    before for `k` > 1.
    """
    held, c, x = series.massless, series.motion, series.massless.right_side
    if k < 2:
        for n in range(len(x)):
            i = held.unknown[n]
            c[k, i] = step.now.displacement[i] if k == 0 and held.damped[n] else 0.0
    if k > 0 and held.counts[DAMPING] > 0:
        add_damped(laws, series, k, h, top)
    balance_forces(series, k, top, STIFFNESS)
    solve_order(held, STIFFNESS)
    members = held.members[STIFFNESS]
    for q in range(held.counts[STIFFNESS]):
        c[k, held.unknown[members[q]]] = x[members[q]]


def joints_jump(laws: Laws, series: Series, top: int) -> bool:
    """Whether the laws at joints without mass deform in no time; the inputs have `top` coefficients."""
    held, most, far = series.massless, 0.0, 0.0
    for i in held.laws:
        d = laws.now.deformation[i]
        most = max(most, abs(d), laws.largest.deformation[i])
        far = max(far, abs(deformation_term(laws, series, 0, top, i) - d))
    return far > DEFORMATION_JUMP * most


def first_violated(laws: Laws, which: Index) -> tuple[int, int]:
    """First of some laws whose rate has jumped so that an event function of the rate is above zero, and its
    event; -1 where there is none.

    A rate up to the rounding of the force over the dashpot's coefficient counts as zero: at rest it is
    nothing else.
    """
    coefficients = laws.events.coefficients
    for i in which:
        d, v, c = laws.now.deformation[i], laws.now.rate[i], laws.tangent.damping[i]
        largest = laws.largest.rate[i]
        if c > 0.0:
            largest = max(largest, abs(linear_force(laws.tangent, i, d, 0.0)) / c)
        for e in range(laws.events.n_events[i]):
            on_d, on_v, constant = coefficients[i, e, 0], coefficients[i, e, 1], coefficients[i, e, 2]
            if on_v != 0.0:
                scale = abs(on_d) * laws.largest.deformation[i] + abs(on_v) * largest
                if on_d * d + on_v * v + constant > EVENT_TOLERANCE * (scale + abs(constant)):
                    return i, e
    return -1, -1
