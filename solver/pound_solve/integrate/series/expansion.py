r"""Kernels of TAYLOR: the motion of a step as a power series, and how far that is accurate.

With :math:`s = t/h` the coefficients of :math:`u = \sum_k c_k s^k` follow from the equations of motion,

.. math::
    (k+1)(k+2)\,M c_{k+2} = h^2\Bigl(p_k - K c_k - \sum_i b_i f_{ik}\Bigr) - h (k+1)\,C c_{k+1},

:math:`f_{ik} = k_i d_{ik} + (k+1) c_i d_{i,k+1}/h` those of the laws' forces on their present branches.
Terms are added until two in a row are below the fraction `TRUNCATION` of the motion in the energy norm,
:math:`k^2 c_k^T M c_k / h^2`.  If the last terms allowed are still larger, the step ends at the place where
they are that small.  If that place is far from the end, a shorter step is tried.

Two numbers go through these kernels: `degree`, the highest power of the series of a step, and `n_powers`,
the number of coefficients of the excitation's polynomials, one more than their degree.
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.kernels.law_state import Laws
from pound_solve.integrate.kernels.products import add_row, multiply, row_product
from pound_solve.integrate.kernels.state import MASS, LinearSystem, Piece, Simulation
from pound_solve.integrate.series.friction import add_friction
from pound_solve.integrate.series.massless import add_massless
from pound_solve.integrate.series.p_delta import add_p_delta
from pound_solve.integrate.series.power_contacts import add_contacts, any_overlap, contacts_valid_up_to
from pound_solve.integrate.series.power_dampers import (
    add_damper_remainders,
    dampers_valid_up_to,
    find_damper_remainders,
)
from pound_solve.integrate.series.rigid import hold_contacts
from pound_solve.integrate.series.smooth import add_remainders, find_remainders, smooth_valid_up_to
from pound_solve.integrate.series.springs import add_product, deformation_term
from pound_solve.integrate.series.state import Series
from pound_solve.numerics.jit import reorder_sums
from pound_solve.numerics.ldl import solve
from pound_solve.numerics.types import Array

MAX_DEGREE = 32  #: highest degree of a series
UNCHECKED_TERMS = 4  #: terms after which it is checked whether they suffice
TRUNCATION = 1e-14  #: largest term left out, as a fraction of the motion
UNSEEN_ENERGY = 1e-13  #: fraction of the energy up to which works may neglect a term
MAX_GROWTH = 2.0  #: largest ratio of the lengths of successive steps


@reorder_sums
def dot(a: Array, b: Array) -> float:
    """Return the product of two vectors."""
    total = 0.0
    for k in range(len(a)):
        total += a[k] * b[k]
    return total


def expand_inputs(series: Series, piece: Piece, t: float, h: float) -> None:
    """Expand the inputs about the time `t` for a step of length `h`."""
    s, coefs, begin = series.inputs, piece.coefs, t - piece.begin
    n_powers, n = coefs.shape
    for j in range(n):
        for k in range(n_powers):
            s[k, j] = coefs[k, j]
        for i in range(n_powers - 1):
            for k in range(n_powers - 2, i - 1, -1):
                s[k, j] += begin * s[k + 1, j]
        scale = 1.0
        for k in range(n_powers):
            s[k, j] *= scale
            scale *= h


def expand_deformations(laws: Laws, series: Series, degree: int, n_powers: int) -> None:
    """Compute the coefficients of the deformations up to `degree`."""
    for k in range(degree + 1):
        for i in range(len(laws.definition.rule)):
            series.deformation[i, k] = deformation_term(laws.definition, series, k, n_powers, i)


def kinetic_of_term(linear: LinearSystem, series: Series, k: int, h: float) -> float:
    """Return twice the kinetic energy of the term `k`."""
    multiply(linear.mass, series.motion[k], series.mass_product)
    energy: float = dot(series.motion[k], series.mass_product) * (k / h) * (k / h)
    return energy


def energy_of_term(linear: LinearSystem, series: Series, k: int, h: float) -> float:
    """Return twice the kinetic energy of the term `k` plus twice the elastic one of massless unknowns."""
    massless, energy = series.massless, kinetic_of_term(linear, series, k, h)
    for n in range(len(massless.unknown)):
        x = series.motion[k, massless.unknown[n]]
        energy += massless.elastic[n] * x * x
    return energy


def structural_forces(
    linear: LinearSystem, series: Series, k: int, on_stiffness: float, on_damping: float, out: Array
) -> None:
    """Compute negative forces of structure and laws from the coefficients `k`, and of dashpots from the
    coefficients `k` + 1, times factors.  They are zero for massless unknowns, which do not need them.
    """
    c, massless, springs = series.motion, series.massless, series.springs
    if len(massless.unknown):
        for i in massless.unknown:
            out[i] = 0.0
        for r in range(len(massless.with_mass)):
            i = massless.with_mass[r]
            elastic = row_product(springs.rows, springs.index_of[i], c[k])
            damping = row_product(massless.damping_with_mass, r, c[k + 1])
            out[i] = -on_stiffness * elastic - on_damping * damping
        return
    multiply(linear.stiffness, c[k], series.stiffness_product)
    add_product(springs, c[k], series.stiffness_product)
    multiply(linear.damping, c[k + 1], series.damping_product)
    for i in range(len(out)):
        out[i] = -on_stiffness * series.stiffness_product[i] - on_damping * series.damping_product[i]


def next_term(sim: Simulation, series: Series, k: int, h: float, n_powers: int) -> None:
    """Compute the coefficients `k` + 2 of the unknowns from the two before (see the module docstring).

    The order matters: forces `k` give the unknowns with mass; closed contacts constrain these; remainders
    of smooth laws (`k` + 2) and of dampers (`k` + 1) follow from the motion so far, and the unknowns
    without mass from all of them.
    """
    linear, laws, step = sim.linear, sim.laws, sim.step
    new = series.motion[k + 2]
    n = len(new)
    springs = series.springs
    on_damping = h * (k + 1)
    structural_forces(linear, series, k, h * h, on_damping, new)
    if k == 0:
        for i in range(n):
            new[i] += h * h * springs.constant[i]
    if k < n_powers:
        for j in range(series.inputs.shape[1]):
            load = h * h * series.inputs[k, j]
            if load != 0.0:
                for i in range(n):
                    new[i] += springs.inputs[j, i] * load
    for q in range(springs.n_dashpots[0]):
        law = springs.dashpots[q]
        term = deformation_term(laws.definition, series, k + 1, n_powers, law)
        force = on_damping * laws.tangent.damping[law] * term
        add_row(laws.definition.rows, law, -force, new)
    add_contacts(laws, series, k, h, n_powers, new)
    add_friction(laws, series, k, h, n_powers, new)
    add_remainders(laws, series.smooth, k, h, new)
    add_damper_remainders(laws.definition, series.power_dampers, k, h, new)
    add_p_delta(sim.members, series, k, h, n_powers, new)
    below = 1.0 / ((k + 1) * (k + 2))
    if linear.diagonal:
        for i in range(n):
            new[i] *= series.inverse[i] * below
    else:
        for i in range(n):
            new[i] *= below
        solve(linear.pattern, step.factors[MASS], step.pivots[MASS], new)
        for i in series.massless.unknown:  # `add_massless` applies their loads
            new[i] = 0.0
    hold_contacts(laws, series, k + 2, h, n_powers)
    find_remainders(laws, series, k + 2, n_powers)
    find_damper_remainders(laws, series, k + 1, h, n_powers)
    if len(series.massless.unknown):
        add_massless(laws, step, series, k + 2, h, n_powers)


def begin_series(sim: Simulation, series: Series, piece: Piece, h: float) -> None:
    """Set the first two coefficients of the series from the present state."""
    laws = sim.laws
    c, now, n_powers = series.motion, sim.step.now, len(piece.coefs)
    expand_inputs(series, piece, sim.run.time, h)
    for i in range(len(now.displacement)):
        c[0, i], c[1, i] = now.displacement[i], h * now.velocity[i]
    for k in range(2):
        hold_contacts(laws, series, k, h, n_powers)
        find_remainders(laws, series, k, n_powers)
        if k == 1:
            find_damper_remainders(laws, series, 0, h, n_powers)
        if len(series.massless.unknown):
            add_massless(laws, sim.step, series, k, h, n_powers)


def valid_up_to(series: Series, degree: int, end: float) -> float:
    """Return the multiple of a step, at most `end`, up to which forces that are series are accurate."""
    end = contacts_valid_up_to(series.power_contacts, degree, end)
    end = smooth_valid_up_to(series.smooth, degree, end)
    return dampers_valid_up_to(series.power_dampers, degree, end)


def expand_series(sim: Simulation, series: Series, piece: Piece, h: float) -> tuple[int, float]:
    """Find the series of a step of length `h` from the present state on.

    Returns
    -------
    degree : int
        Its highest power.
    end : float
        Fraction or multiple of the step up to which the series is accurate; NaN if numbers overflow.
    """
    control = series.control
    linear = sim.linear
    n_powers = len(piece.coefs)
    begin_series(sim, series, piece, h)
    control.largest_kinetic = max(control.largest_kinetic, kinetic_of_term(linear, series, 1, h))
    control.quadrature_degree = UNCHECKED_TERMS
    most, tail, last = control.largest_kinetic, 0.0, 0.0
    k = 0
    while k + 2 <= MAX_DEGREE:
        next_term(sim, series, k, h, n_powers)
        k += 1
        if (k + 1) % UNCHECKED_TERMS != 0:
            continue
        degree = k + 1
        tail = energy_of_term(linear, series, degree, h)
        last = energy_of_term(linear, series, degree - 1, h)
        if most == 0.0:  # from rest
            most = max(energy_of_term(linear, series, 2, h), last, tail)
        if tail + last > UNSEEN_ENERGY * most:
            control.quadrature_degree = degree + UNCHECKED_TERMS
        enough = degree > n_powers and tail + last <= TRUNCATION * TRUNCATION * most
        if enough and valid_up_to(series, degree, 1.0) == 1.0:
            break
    # losses follow powers of the overlap and of the rate, and forces at supports those of smooth laws
    others = len(series.smooth.laws) + len(series.power_dampers.laws) + len(series.p_delta.force)
    if any_overlap(series.power_contacts) or others:
        control.quadrature_degree = degree + UNCHECKED_TERMS
    if not tail + last < np.inf:
        return degree, np.nan
    expand_deformations(sim.laws, series, degree, n_powers)
    end = MAX_GROWTH
    if tail > 0.0:
        end = min(end, (TRUNCATION * TRUNCATION * most / tail) ** (0.5 / degree))
    if last > 0.0:
        end = min(end, (TRUNCATION * TRUNCATION * most / last) ** (0.5 / (degree - 1)))
    return degree, valid_up_to(series, degree, end)


def derivative_factor(k: int, order: int, h: float) -> float:
    """Return the factor of the power `k` in a derivative of the given order, for a step of length `h`."""
    factor = 1.0
    for j in range(order):
        factor *= (k - j) / h
    return factor


def evaluate_motion(c: Array, degree: int, s: float, h: float, order: int, out: Array) -> None:
    """Derivative of an order of a motion with coefficients `c` at the place `s`."""
    n = len(out)
    for i in range(n):
        out[i] = 0.0
    k = degree
    while k >= order:
        # four terms at once: to read and write a row takes longer than the arithmetic
        f0, f1 = derivative_factor(k, order, h), derivative_factor(k - 1, order, h)
        f2, f3 = derivative_factor(k - 2, order, h), derivative_factor(k - 3, order, h)
        s2, s3, s4 = s * s, s * s * s, s * s * s * s
        if k - 3 >= order:
            for i in range(n):
                out[i] = (
                    out[i] * s4
                    + f0 * s3 * c[k, i]
                    + f1 * s2 * c[k - 1, i]
                    + f2 * s * c[k - 2, i]
                    + f3 * c[k - 3, i]
                )
            k -= 4
        else:
            for i in range(n):
                out[i] = out[i] * s + f0 * c[k, i]
            k -= 1


def law_at(series: Series, degree: int, s: float, h: float, i: int) -> tuple[float, float]:
    """Return deformation and rate of a law at the place `s`."""
    d, v = series.deformation[i, degree], 0.0
    for k in range(degree - 1, -1, -1):
        v = v * s + d
        d = d * s + series.deformation[i, k]
    return d, v / h
