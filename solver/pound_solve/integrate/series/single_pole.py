r"""Kernels of LAGUERRE: a Laguerre series with one pole for the motion of a step, and its error estimate.

Written as :math:`E\dot y = A y + g`, :math:`y = (u, v)`, the equations of motion have in
:math:`\theta = t/h` the solution

.. math:: y = \sum_{n \ge 0} L_n^{(-1)}(\theta/\gamma)\, y_n, \qquad
          (E - \gamma h A)(y_n - y_{n+1}) = E y_n + \gamma h\,(g_n - g_{n+1}),

where :math:`g_n` are the coefficients of the loads in the same polynomials.  So each term needs one solve
with the same matrix :math:`S = M + \gamma h C + (\gamma h)^2 K` over the unknowns:

.. math:: S\,\delta = M v_n + \gamma h\,(p_n - p_{n+1} - K u_n), \qquad
          u_{n+1} = -\gamma h\,\delta, \quad v_{n+1} = v_n - \delta .

Massless unknowns are no special case: E leaves out their rates.  The series ends with the term s for
which :math:`L_s(1/\gamma) = 0`.  The equations of motion are then met at the end of the step, and stiff
components have decayed there (the method is L-stable).  Within the step the sum is a polynomial in
:math:`\theta`, a series like TAYLOR's, so events, peaks, works and contacts are treated as in TAYLOR.

The initial rate of the truncated sum is wrong by the terms left out.  Reversals of hinges are detected by
the sign of the rate, so a polynomial that restores the exact initial rate is added,
:math:`\theta(1-\theta)^{s-1}`; it leaves the end of the step unchanged.

The length of a step is such that the last term is below a fraction of the motion in the energy norm,
:math:`v^T M v + u^T K u`; it bounds the error of the step while the terms decrease.

References
----------
Nørsett SP (1974), One-step methods of Hermite type for numerical integration of stiff systems, BIT 14:
63-77; Hairer E, Wanner G (1996), Solving Ordinary Differential Equations II, 2nd ed., Springer, IV.6
(methods with one real pole, their stability and the polynomials of Laguerre).
"""

from __future__ import annotations

import math

import numpy as np

from pound_solve.integrate.kernels.effective_mass import factorise_effective_mass
from pound_solve.integrate.kernels.law_state import Laws
from pound_solve.integrate.kernels.products import add_row, multiply, row_product
from pound_solve.integrate.kernels.state import WHOLE, LinearSystem, Piece, Simulation
from pound_solve.integrate.series.expansion import MAX_GROWTH, dot, expand_deformations, expand_inputs
from pound_solve.integrate.series.springs import add_product
from pound_solve.integrate.series.state import Series, SinglePole
from pound_solve.numerics.ldl import solve
from pound_solve.numerics.types import Array

LAST_TERM = 6  #: number of the last term of a series
#: index (ascending) of the root of Laguerre's polynomial used for 1/gamma; it makes the method A-stable
ROOT = 2
ERROR_SHARE = 0.5  #: fraction of the allowed error at which the length of a step aims
TERM_ROUNDING = 1e-24  #: fraction of the energy of a state that the rounding of a term may have
TERMS_OF_WORK = 8  #: terms for which works are integrated accurately


def pole(last: int, root: int) -> float:
    """Return the pole gamma of a series with the last term `last`: one over a root of its polynomial."""
    return 1.0 / float(np.sort(np.polynomial.laguerre.lagroots(np.eye(last + 1)[last]).real)[root])


def basis(last: int, gamma: float) -> Array:
    r"""Powers of :math:`\theta` in :math:`L_n^{(-1)}(\theta/\gamma)`, shape (last + 1, last + 1)."""
    powers = np.zeros((last + 1, last + 1))
    powers[0, 0] = 1.0
    for n in range(1, last + 1):
        for k in range(1, n + 1):
            powers[n, k] = math.comb(n - 1, k - 1) * (-1.0 / gamma) ** k / math.factorial(k)
    return powers


def monomials(last: int, gamma: float) -> Array:
    r""":math:`\theta^k` in :math:`L_n^{(-1)}(\theta/\gamma)`, shape (last + 1, last + 1): the inverse of
    `basis`.
    """
    inverse = np.zeros((last + 1, last + 1))
    inverse[0, 0] = 1.0
    for k in range(1, last + 1):
        for n in range(1, k + 1):
            inverse[k, n] = math.factorial(k) * gamma**k * (-1.0) ** n * math.comb(k - 1, n - 1)
    return inverse


def allocate(n: int, n_inputs: int, tolerance: float | None) -> SinglePole:
    """Allocate series of `n` unknowns, with the last term below a `tolerance` of the motion; None: none."""
    if tolerance is None:
        none, empty = np.zeros(0), np.zeros((0, 0))
        return SinglePole(empty, empty, 0.0, 0.0, empty, empty, empty, none, none, none)
    gamma = pole(LAST_TERM, ROOT)
    terms = basis(LAST_TERM, gamma)
    highest = np.abs(np.polynomial.polynomial.polyval(np.linspace(0.0, 1.0, 1001), terms[LAST_TERM])).max()
    return SinglePole(
        basis=terms,
        monomials=monomials(LAST_TERM, gamma),
        gamma=gamma,
        allowed=(ERROR_SHARE * tolerance / float(highest)) ** 2,
        displacement=np.zeros((LAST_TERM + 1, n)),
        velocity=np.zeros((LAST_TERM + 1, n)),
        inputs=np.zeros((LAST_TERM + 2, n_inputs)),
        decrement=np.zeros(n),
        velocity_defect=np.zeros(n),
        initial_slope=np.array([0.0, *np.polynomial.polynomial.polypow([1.0, -1.0], LAST_TERM - 1)]),
    )


def is_laguerre(series: Series) -> bool:
    """Return whether the steps of a run are Laguerre series."""
    return len(series.single_pole.basis) > 0


def elastic_force(linear: LinearSystem, series: Series, u: Array, out: Array) -> None:
    """Forces of the structure and of the laws' springs at displacements `u`."""
    springs = series.springs
    if len(series.massless.unknown):  # K is part of these sums then
        for r in range(len(springs.row)):
            out[springs.row[r]] = row_product(springs.rows, r, u)
        return
    multiply(linear.stiffness, u, out)
    add_product(springs, u, out)


def expand_loads(series: Series, n_powers: int) -> None:
    """Coefficients of the inputs in Laguerre's polynomials; they have `n_powers` powers."""
    laguerre = series.single_pole
    for j in range(laguerre.inputs.shape[1]):
        for n in range(len(laguerre.inputs)):
            laguerre.inputs[n, j] = 0.0
        for k in range(min(n_powers, len(laguerre.monomials))):
            for n in range(k + 1):
                laguerre.inputs[n, j] += laguerre.monomials[k, n] * series.inputs[k, j]


def add_loads(laws: Laws, series: Series, n: int, h: float, n_powers: int, out: Array) -> None:
    """Add the coefficient `n` of the loads, less the next one, times gamma h."""
    laguerre, springs = series.single_pole, series.springs
    scale = laguerre.gamma * h
    if n == 0:
        for i in range(len(out)):
            out[i] += scale * springs.constant[i]
    if n >= n_powers:
        return
    for j in range(laguerre.inputs.shape[1]):
        load = scale * (laguerre.inputs[n, j] - laguerre.inputs[n + 1, j])
        if load != 0.0:
            for i in range(len(out)):
                out[i] += springs.inputs[j, i] * load
    for q in range(springs.n_dashpots[0]):  # rates of moved supports: the coefficients k + 1 of a power k
        law, rate = springs.dashpots[q], 0.0
        for k in range(min(n_powers - 1, len(laguerre.monomials))):
            change = laguerre.monomials[k, n] - (laguerre.monomials[k, n + 1] if n + 1 <= k else 0.0)
            for j in range(laguerre.inputs.shape[1]):
                rate += change * (k + 1) / h * laws.definition.inputs[law, j] * series.inputs[k + 1, j]
        if rate != 0.0:
            add_row(laws.definition.rows, law, -scale * laws.tangent.damping[law] * rate, out)


def energy(linear: LinearSystem, series: Series, n: int) -> float:
    """Twice the kinetic energy and twice the elastic one of a term."""
    u, v = series.single_pole.displacement[n], series.single_pole.velocity[n]
    multiply(linear.mass, v, series.mass_product)
    total: float = abs(dot(v, series.mass_product))
    elastic_force(linear, series, u, series.stiffness_product)
    total += abs(dot(u, series.stiffness_product))
    return total


def match_initial_velocity(series: Series, velocity: Array, h: float) -> None:
    """Correct the initial velocities of the truncated series, which lack the terms left out, to the present
    velocities.  The end of the step does not change.
    """
    laguerre, last = series.single_pole, len(series.single_pole.basis) - 1
    defect = laguerre.velocity_defect
    for i in range(len(velocity)):
        defect[i] = h * velocity[i] - series.motion[1, i]
    for k in range(1, last + 1):
        term, share = series.motion[k], laguerre.initial_slope[k]
        for i in range(len(velocity)):
            term[i] += share * defect[i]


def find_terms(sim: Simulation, series: Series, h: float, n_powers: int) -> float:
    """Find the terms of the series from the present state on; return twice the energy of that state."""
    linear, step = sim.linear, sim.step
    laguerre, now, present = series.single_pole, step.now, 0.0
    u, v, force = laguerre.displacement, laguerre.velocity, series.stiffness_product
    delta = laguerre.decrement  # of the velocities; first its right-hand side
    scale = laguerre.gamma * h
    for i in range(len(delta)):
        u[0, i], v[0, i] = now.displacement[i], now.velocity[i]
    for n in range(len(laguerre.basis) - 1):
        multiply(linear.mass, v[n], delta)
        elastic_force(linear, series, u[n], force)
        if n == 0:
            kinetic = dot(v[0], delta)
            series.control.largest_kinetic = max(series.control.largest_kinetic, kinetic)
            present = abs(kinetic) + abs(dot(u[0], force))
        for i in range(len(delta)):
            delta[i] -= scale * force[i]
        add_loads(sim.laws, series, n, h, n_powers, delta)
        solve(linear.pattern, step.factors[WHOLE], step.pivots[WHOLE], delta)
        for i in range(len(delta)):
            u[n + 1, i] = -scale * delta[i]
            v[n + 1, i] = v[n, i] - delta[i]
    return present


def write_in_powers(series: Series) -> None:
    """Write the series in powers of the place, as TAYLOR has them."""
    laguerre = series.single_pole
    for k in range(len(laguerre.basis)):
        term = series.motion[k]
        for i in range(len(term)):
            term[i] = 0.0
        for n in range(k, len(laguerre.basis)):
            share = laguerre.basis[n, k]
            for i in range(len(term)):
                term[i] += share * laguerre.displacement[n, i]


def expand_laguerre(sim: Simulation, series: Series, piece: Piece, h: float) -> tuple[int, float]:
    """Find the series of a step of length `h` from the present state on, as `expansion.expand_series` does.

    Returns
    -------
    degree : int
        Its highest power.
    fit : float
        Multiple of the step that would fit; below 1 the step must be repeated, shorter.  NaN if an unknown
        is unrestrained or numbers overflow.
    """
    control = series.control
    run = sim.run
    laguerre, n_powers = series.single_pole, len(piece.coefs)
    last = len(laguerre.basis) - 1
    if run.factor_length != h:
        run.factor_length = -1.0
        scale = laguerre.gamma * h
        if factorise_effective_mass(sim, 1.0, scale, scale * scale, WHOLE) >= 0:
            return last, np.nan
        run.factor_length = h
        control.n_factorisations += 1
    expand_inputs(series, piece, run.time, h)
    expand_loads(series, n_powers)
    present = find_terms(sim, series, h, n_powers)
    write_in_powers(series)
    match_initial_velocity(series, sim.step.now.velocity, h)
    control.quadrature_degree = TERMS_OF_WORK
    expand_deformations(sim.laws, series, last, n_powers)
    most = control.largest_kinetic
    if most == 0.0:  # from rest
        most = energy(sim.linear, series, 1)
    left_out = energy(sim.linear, series, last)
    if not left_out < np.inf:
        return last, np.nan
    fit = MAX_GROWTH
    if left_out > 0.0:
        allowed = max(laguerre.allowed * most, TERM_ROUNDING * present)
        fit = min(fit, (allowed / left_out) ** (0.5 / last))
    return last, fit
