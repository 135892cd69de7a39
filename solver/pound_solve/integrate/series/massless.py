r"""Massless unknowns in a power series: kernels, and the arrays they work on.

A massless unknown that a dashpot resists is of order one: its rate follows from the remaining force on
the dashpot.  One that only springs resist is of order zero: its displacement follows from equilibrium.
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
    inverse_index,
    laid_out,
    places_in_pattern,
    sparse_rows,
)
from pound_solve.integrate.kernels.law_state import Laws, LawTangent
from pound_solve.integrate.kernels.laws import linear_force
from pound_solve.integrate.kernels.products import add_row, row_product
from pound_solve.integrate.kernels.state import LinearSystem, Step
from pound_solve.integrate.series.smooth import Q, dashpot_remainder
from pound_solve.integrate.series.springs import deformation_term, load_term
from pound_solve.integrate.series.state import Massless, Series
from pound_solve.integrate.tolerances import EVENT_TOLERANCE
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

#: fraction of the largest deformation above which a change at one instant is a jump
DEFORMATION_JUMP = 1e-9
#: rows of `Massless.factors`: unknowns that a dashpot resists, and those that springs alone hold
ORDER_ONE, ORDER_ZERO = range(2)
PARTICIPATION = 1e-6  #: fraction of the largest component of a motion above which an unknown takes part


def allocate(
    linear: LinearSystem, stiffness: Matrix, damping: Matrix, law_rows: Matrix, elastic: Array
) -> Massless:
    """Lay out the massless unknowns.

    Parameters
    ----------
    linear : LinearSystem
    stiffness, damping : Matrix, shape (n, n)
        In the order of elimination, without laws.
    law_rows : Matrix, shape (n_laws, n)
    elastic : ndarray, shape (n_laws,)
        Initial stiffness of the laws [F/L].
    """
    unordered = np.flatnonzero(~linear.has_mass)
    laws = np.flatnonzero(used_rows(law_rows[:, unordered]))
    touched = law_rows[laws][:, unordered]
    among = [a[np.ix_(unordered, unordered)] for a in (damping, stiffness)]
    linked = [*(entries(a)[:2] for a in among), coupled_pairs(columns for columns, _ in by_rows(touched))]
    first, second = (np.concatenate(part) for part in zip(*linked))
    layout = laid_out(len(unordered), first, second, np.ones(len(laws), bool))
    order, pattern, column, unknown = layout.order, layout.pattern, layout.column, unordered[layout.order]
    rows = sparse_rows(touched[:, order])
    pointers, pairs, values = places_in_pattern(rows, layout)
    lower = pattern.ai.astype(np.int64)
    springs = weighted(touched[:, order], elastic[laws])
    return Massless(
        unknown=unknown,
        with_mass=np.flatnonzero(linear.has_mass),
        damping=sparse_rows(damping[unknown]),
        damping_with_mass=sparse_rows(damping[linear.has_mass]),
        laws=laws,
        index_of_law=inverse_index(laws, law_rows.shape[0]),
        rows=rows,
        pattern=pattern,
        column=column,
        on_pattern=np.array([at(a[np.ix_(order, order)], lower, column) for a in among]),
        pair_pointers=pointers,
        pair_places=pairs,
        pair_values=values,
        damped=np.zeros(len(unordered), bool),
        unknowns_of_order=np.zeros((2, len(unordered)), np.int64),
        n_of_order=np.zeros(2, np.int64),
        factors=np.zeros((2, len(pattern.li))),
        failed_pivot=np.zeros(1),
        inverse_pivots=np.ones((2, len(unordered))),
        matrix=np.zeros(len(column)),
        row=np.zeros(len(unordered)),
        right_side=np.zeros(len(unordered)),
        elastic=np.abs(diagonal(stiffness)[unknown] + diagonal(springs)),
    )


def form_matrix(tangent: LawTangent, massless: Massless, which: int) -> None:
    """Fill in C or K (`which`) of the massless unknowns, with the laws on their present branches."""
    for q in range(len(massless.matrix)):
        massless.matrix[q] = massless.on_pattern[which, q]
    for n in range(len(massless.laws)):
        i = massless.laws[n]
        coefficient = tangent.damping[i] if which == ORDER_ONE else tangent.stiffness[i]
        for q in range(massless.pair_pointers[n], massless.pair_pointers[n + 1]):
            massless.matrix[massless.pair_places[q]] += coefficient * massless.pair_values[q]


def factorise_orders(laws: Laws, massless: Massless) -> int:
    """Find the orders of the unknowns on the present branches, and factorise C and K for them.

    Returns
    -------
    int
        -1 or the number of a failed unknown.  A failure of K means that it is unrestrained or would snap
        through; a failure of C, that it has dashpots only to other such unknowns.
    """
    form_matrix(laws.tangent, massless, ORDER_ONE)
    massless.n_of_order[ORDER_ONE] = massless.n_of_order[ORDER_ZERO] = 0
    for i in range(len(massless.unknown)):
        massless.damped[i] = massless.matrix[massless.pattern.ap[i]] != 0.0
        which = ORDER_ONE if massless.damped[i] else ORDER_ZERO
        massless.unknowns_of_order[which, massless.n_of_order[which]] = i
        massless.n_of_order[which] += 1
    for which in range(2):
        if which == ORDER_ZERO:
            form_matrix(laws.tangent, massless, ORDER_ZERO)
        for q in range(len(massless.matrix)):
            i, j = massless.pattern.ai[q], massless.column[q]
            if massless.damped[i] != (which == ORDER_ONE) or massless.damped[j] != (which == ORDER_ONE):
                massless.matrix[q] = 1.0 if i == j else 0.0
        pivots = massless.inverse_pivots[which]  # at first the pivots themselves
        fault = factor(massless.pattern, massless.matrix, massless.factors[which], pivots, massless.row)
        for i in range(len(massless.unknown)):
            if fault < 0 and pivots[i] < 0.0:
                fault = i
        if fault >= 0:
            massless.failed_pivot[0] = pivots[fault]
            return fault
        for i in range(len(massless.unknown)):
            pivots[i] = 1.0 / pivots[i]
    return -1


def least_damped_unknowns(laws: Laws, massless: Massless) -> Index:
    """Return the numbers of the unknowns of order one that take part in their least damped motion."""
    form_matrix(laws.tangent, massless, ORDER_ONE)
    c = np.zeros((len(massless.unknown), len(massless.unknown)))
    c[massless.pattern.ai, massless.column] = c[massless.column, massless.pattern.ai] = massless.matrix
    at = np.flatnonzero(massless.damped)
    motion = softest(scaled(c[np.ix_(at, at)], scaling(c[np.ix_(at, at)])))[1]
    return np.asarray(at[np.abs(motion) > PARTICIPATION * np.abs(motion).max()], np.int64)


def solve_order(massless: Massless, which: int) -> None:
    """Solve in place for the unknowns of one order; the right sides of the others do not matter.

    Like `ldl.solve`, but for some unknowns only.  Unknowns of the other order have unit rows, so their part
    of L is zero.  The unknowns must be in ascending order of elimination.
    """
    pattern, lower, x = massless.pattern, massless.factors[which], massless.right_side
    unknowns, inverse_pivots = massless.unknowns_of_order[which], massless.inverse_pivots[which]
    for q in range(massless.n_of_order[which]):
        j = unknowns[q]
        for e in range(pattern.lp[j], pattern.lp[j + 1]):
            x[pattern.li[e]] -= lower[e] * x[j]
    for q in range(massless.n_of_order[which] - 1, -1, -1):
        j = unknowns[q]
        total = x[j] * inverse_pivots[j]
        for e in range(pattern.lp[j], pattern.lp[j + 1]):
            total -= lower[e] * x[pattern.li[e]]
        x[j] = total


def balance_forces(series: Series, k: int, n_powers: int, which: int) -> None:
    """Form the right sides for the unknowns of one order from the coefficients `k`: loads less the forces
    of K and of the laws, including the parts of smooth laws and dampers beyond their tangents.
    """
    massless, springs, c = series.massless, series.springs, series.motion[k]
    unknowns, x = massless.unknowns_of_order[which], massless.right_side
    for q in range(massless.n_of_order[which]):
        x[unknowns[q]] = -row_product(springs.rows, massless.unknown[unknowns[q]], c)
    if k < n_powers:
        for q in range(massless.n_of_order[which]):
            x[unknowns[q]] += load_term(springs, series, k, n_powers, massless.unknown[unknowns[q]])
    smooth = series.smooth
    for r in range(len(smooth.laws)):
        n = massless.index_of_law[smooth.laws[r]]
        if n >= 0:
            add_row(massless.rows, n, -smooth.constants[r, Q] * smooth.remainder[r, k], x)
    dampers = series.power_dampers
    for r in range(len(dampers.laws)):
        n = massless.index_of_law[dampers.laws[r]]
        if n >= 0 and dampers.is_series[r]:
            add_row(massless.rows, n, -dampers.remainder[r, k], x)


def add_damped(laws: Laws, series: Series, k: int, h: float, n_powers: int) -> None:
    """Compute the coefficients `k` > 0 of the unknowns of order one."""
    massless, c, x = series.massless, series.motion, series.massless.right_side
    unknowns = massless.unknowns_of_order[ORDER_ONE]
    balance_forces(series, k - 1, n_powers, ORDER_ONE)
    for q in range(massless.n_of_order[ORDER_ONE]):
        x[unknowns[q]] -= k / h * row_product(massless.damping, unknowns[q], c[k])
    for q in range(series.springs.n_dashpots[0]):
        i = series.springs.dashpots[q]
        if massless.index_of_law[i] >= 0:
            force = (
                k / h * laws.tangent.damping[i] * deformation_term(laws.definition, series, k, n_powers, i)
            )
            add_row(massless.rows, massless.index_of_law[i], -force, x)
    for r in range(len(series.smooth.laws)):
        n = massless.index_of_law[series.smooth.laws[r]]
        if n >= 0:
            add_row(massless.rows, n, -dashpot_remainder(laws.definition, series.smooth, r, k - 1, h), x)
    solve_order(massless, ORDER_ONE)
    for q in range(massless.n_of_order[ORDER_ONE]):
        c[k, massless.unknown[unknowns[q]]] = x[unknowns[q]] * (h / k)


def add_massless(laws: Laws, step: Step, series: Series, k: int, h: float, n_powers: int) -> None:
    """Compute the coefficients `k` of the massless unknowns (see the module docstring).  For `k` > 1
    they must be zero before the call.
    """
    massless, c, x = series.massless, series.motion, series.massless.right_side
    if k < 2:
        for n in range(len(x)):
            i = massless.unknown[n]
            c[k, i] = step.now.displacement[i] if k == 0 and massless.damped[n] else 0.0
    if k > 0 and massless.n_of_order[ORDER_ONE] > 0:
        add_damped(laws, series, k, h, n_powers)
    balance_forces(series, k, n_powers, ORDER_ZERO)
    solve_order(massless, ORDER_ZERO)
    unknowns = massless.unknowns_of_order[ORDER_ZERO]
    for q in range(massless.n_of_order[ORDER_ZERO]):
        c[k, massless.unknown[unknowns[q]]] = x[unknowns[q]]


def joints_jump(laws: Laws, series: Series, n_powers: int) -> bool:
    """Return whether the laws at massless joints deform instantly."""
    massless, most, far = series.massless, 0.0, 0.0
    for i in massless.laws:
        d = laws.now.deformation[i]
        most = max(most, abs(d), laws.largest.deformation[i])
        far = max(far, abs(deformation_term(laws.definition, series, 0, n_powers, i) - d))
    return far > DEFORMATION_JUMP * most


def first_violated(laws: Laws, which: Index) -> tuple[int, int]:
    """Return the first of some laws whose rate has jumped so that an event function of the rate is above
    zero, and its event; -1 if there is none.

    A rate up to the rounding of the force over the dashpot's coefficient counts as zero: at rest the rate
    is only this rounding.
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
