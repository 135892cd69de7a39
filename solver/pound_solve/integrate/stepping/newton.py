"""Newton's iterations for the acceleration at the end of a step.

Curved laws and corotational members are linearised again until their forces agree with their tangents.
Without them the equations are linear, and one solution is enough.
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.kernels.corotational import (
    anchor_member,
    compute_tangents,
    correct_members,
    predicted_force,
    subtract_force,
)
from pound_solve.integrate.kernels.laws import (
    curved_force,
    linear_force,
    proportional_damping,
    set_normal_force,
)
from pound_solve.integrate.kernels.products import copy, row_product
from pound_solve.integrate.kernels.state import WHOLE, Scheme, Simulation
from pound_solve.integrate.stepping.factor import (
    factorise_step,
    invalidate_factor,
    tangent_change,
    update_factor,
)
from pound_solve.laws.functions import RuleFunctions
from pound_solve.numerics.ldl import solve as solve_factored

CONVERGED = 1e-12  #: largest deviation of a curved law's force from its tangent, as a fraction of the force
POOR_CONVERGENCE = 0.05  #: fraction of the error that may remain after an iteration without refactorisation
MAX_ITERATIONS = 50


def solve_acceleration(sim: Simulation, factor: int) -> None:
    """Solve for the acceleration at the end of the step with the present tangents of laws and members."""
    laws, members, step = sim.laws, sim.members, sim.step
    rows = laws.definition.rows
    acceleration = step.trial.acceleration
    copy(step.right_side, acceleration)
    for i in range(len(laws.definition.rule)):
        f = linear_force(laws.tangent, i, laws.trial.deformation[i], laws.trial.rate[i])
        if f != 0.0:
            for q in range(rows.pointers[i], rows.pointers[i + 1]):
                acceleration[rows.columns[q]] -= rows.values[q] * f
    for c in range(len(members.parameters)):
        predicted_force(members, c)
        subtract_force(members, c, members.trial.forces, acceleration)
    solve_factored(sim.linear.pattern, step.factors[factor], step.pivots[factor], acceleration)


def correct_curved(
    sim: Simulation, rules: RuleFunctions, scheme: Scheme, h: float, factor: int
) -> tuple[float, int]:
    """Linearise the curved laws at the trial acceleration, and update the factor.

    Returns
    -------
    worst, law : float, int
        Largest distance of a law from its last tangent, over its force, and the index of that law; the
        distance is -1.0 if the factorisation fails.
    """
    laws = sim.laws
    definition, rows, tangent = laws.definition, laws.definition.rows, laws.tangent
    beta_h2, gamma_h = scheme.beta * h * h, scheme.gamma * h
    acceleration, worst, law = sim.step.trial.acceleration, 0.0, -1
    for i in range(len(definition.rule)):
        if not definition.curved[i]:
            continue
        j = laws.friction.normal_law[i]
        if j >= 0:
            a = row_product(rows, j, acceleration)
            set_normal_force(
                laws, i, laws.trial.deformation[j] + beta_h2 * a, laws.trial.rate[j] + gamma_h * a, a
            )
        a = row_product(rows, i, acceleration)
        d, v = laws.trial.deformation[i] + beta_h2 * a, laws.trial.rate[i] + gamma_h * a
        c = curved_force(laws, rules, i, d, v)
        k, proportional = c[1], proportional_damping(laws, i, c[1])
        damp, force = c[2] + proportional, c[0] + proportional * v
        guess = linear_force(tangent, i, d, v)
        size = max(abs(force), abs(k * laws.largest.deformation[i]), 1e-300)
        if abs(force - guess) > worst * size:
            worst, law = abs(force - guess) / size, i
        change = tangent_change(scheme, h, k - tangent.stiffness[i], damp - tangent.damping[i])
        tangent.stiffness[i], tangent.damping[i], tangent.offset[i] = k, damp, force - k * d - damp * v
        sim.run.updates += 1
        if sim.linear.explicit or update_factor(sim, i, change, factor):
            continue
        if factorise_step(sim, scheme, h, factor) >= 0:
            return -1.0, -1
    return worst, law


def update_member_tangents(sim: Simulation, scheme: Scheme, h: float, factor: int) -> bool:
    """Recompute the members' tangents and factorise A again; return False if that fails."""
    members = sim.members
    compute_tangents(members, members.trial.quantities)
    for c in range(len(members.parameters)):
        anchor_member(members, c)
    if factorise_step(sim, scheme, h, factor) >= 0:
        return False
    if factor != WHOLE:
        invalidate_factor(sim.run)
    return True


def iterate_newton(sim: Simulation, rules: RuleFunctions, scheme: Scheme, h: float, factor: int) -> bool:
    """Solve for the acceleration at the end of the step.  Return False if Newton's method does not
    converge; `run.failed_law` is then the law with the largest error.
    """
    last, worst, law = np.inf, 0.0, -1
    sim.run.failed_law = -1
    for _ in range(MAX_ITERATIONS):
        solve_acceleration(sim, factor)
        worst, law = correct_curved(sim, rules, scheme, h, factor)
        if worst == -1.0:
            return False
        has_members = len(sim.members.parameters) > 0
        error = correct_members(sim.members, sim.step, scheme.beta * h * h) if has_members else 0.0
        if worst <= CONVERGED and error <= 1.0:
            return True
        if not error < np.inf:
            return False
        slow = error > 1.0 and error > POOR_CONVERGENCE * last
        if slow and not update_member_tangents(sim, scheme, h, factor):
            return False
        last = error
    if worst > CONVERGED:
        sim.run.failed_law = law
    return False
