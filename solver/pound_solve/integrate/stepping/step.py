r"""One step of the generalised-alpha family (Chung & Hulbert 1993): factor, predict, solve, correct,
accept.

With the length h of the step,

.. math::
    u_1 = \tilde u + \beta h^2 a_1, \qquad \tilde u = u_0 + h v_0 + h^2(\tfrac12-\beta) a_0 \\
    v_1 = \tilde v + \gamma h a_1, \qquad \tilde v = v_0 + (1-\gamma) h a_0 \\
    \Bigl[\tfrac{1-\alpha_m}{1-\alpha_f} M + \gamma h C + \beta h^2 K\Bigr] a_1
      = p_1 - C\tilde v - K\tilde u - f(\tilde u, \tilde v)
      + \frac{\alpha_f r_0 - \alpha_m M a_0}{1-\alpha_f}

with the residual :math:`r = p - C v - K u - f` at the start of the step.  Between events the laws are
linear, so a step is one solution; curved laws take Newton iterations that change the factor by rank one.
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.energy import Works
from pound_solve.integrate.kernels.consistency import correct_massless_rates
from pound_solve.integrate.kernels.corotational import (
    anchor_member,
    correct_members,
    force_size,
    predict_members,
    predicted_force,
    subtract_force,
    take_tangents,
)
from pound_solve.integrate.kernels.effective_mass import factorise_effective_mass
from pound_solve.integrate.kernels.laws import (
    add_slip_work,
    curved_force,
    drag_force,
    hold_friction_limits,
    law_force,
    linear_force,
    linearise_laws,
    proportional_damping,
    set_normal_force,
    update_friction_limits,
)
from pound_solve.integrate.kernels.products import (
    copy,
    evaluate_inputs,
    form_load,
    multiply,
    row_magnitude,
    row_product,
)
from pound_solve.integrate.kernels.state import (
    WHOLE,
    Corotational,
    Laws,
    LinearSystem,
    Scheme,
    Simulation,
    Step,
)
from pound_solve.integrate.kernels.work import (
    load_on_nodes,
    mean_damping_power,
    mean_load_power,
    support_power,
)
from pound_solve.laws.functions import Tables
from pound_solve.numerics.ldl import solve as solve_factored
from pound_solve.numerics.ldl import update
from pound_solve.numerics.types import Array
from pound_solve.structure.corotational import ACROSS, AXIAL, KIND, LENGTH, STRING

MAX_UPDATES = 200  #: updates of rank one before a factor is made anew
CONVERGED = 1e-12  #: largest deviation of a curved law's force from its tangent, as a share of the force
POOR_CONVERGENCE = 0.05  #: part of an error that an iteration may leave before the factor is made anew
MAX_ITERATIONS = 50


def factorise_step(sim: Simulation, scheme: Scheme, h: float, at: int) -> int:
    """Factorise A for steps of length `h`; return -1 or the unknown whose pivot vanishes."""
    on_mass = (1.0 - scheme.alpha_m) / (1.0 - scheme.alpha_f)
    return factorise_effective_mass(sim, on_mass, scheme.gamma * h, scheme.beta * h * h, at)


def update_factor(sim: Simulation, i: int, change: float, at: int) -> bool:
    """Add ``change b b^T`` of law `i` to a factor; False where it must be made anew."""
    step = sim.step
    rows = sim.laws.definition.rows
    if change == 0.0 or rows.pointers[i] == rows.pointers[i + 1]:
        return True
    first = len(step.row)
    for q in range(rows.pointers[i], rows.pointers[i + 1]):
        step.row[rows.columns[q]] += rows.values[q]
        first = min(first, rows.columns[q])
    return update(sim.linear.pattern, step.factors[at], step.pivots[at], step.row, first, change)


def predict_step(sim: Simulation, scheme: Scheme, coefs: Array, end: float, h: float) -> None:
    """Motion and forces at the end of a step of length `h`, at the local time `end`, but for the
    acceleration there.
    """
    linear, laws, step = sim.linear, sim.laws, sim.step
    definition, rows = laws.definition, laws.definition.rows
    now, trial, right = step.now, step.trial, step.right_side
    on_displacement, on_velocity = h * h * (0.5 - scheme.beta), (1.0 - scheme.gamma) * h
    n = len(right)
    evaluate_inputs(coefs, end, trial.inputs, trial.input_rates)
    form_load(linear, trial.inputs, trial.load)
    for i in range(n):
        trial.displacement[i] = (
            now.displacement[i] + h * now.velocity[i] + on_displacement * now.acceleration[i]
        )
    for i in range(n):
        trial.velocity[i] = now.velocity[i] + on_velocity * now.acceleration[i]
    multiply(linear.stiffness, trial.displacement, right)
    if scheme.alpha_f != 0.0 or scheme.alpha_m != 0.0:
        inertia = step.scratch[0]
        multiply(linear.mass, now.acceleration, inertia)
        one = 1.0 / (1.0 - scheme.alpha_f)
        for i in range(n):
            right[i] -= one * (scheme.alpha_f * step.residual[i] - scheme.alpha_m * inertia[i])
    for i in range(n):
        right[i] = trial.load[i] - right[i] - now.damping_force[i] - on_velocity * now.damping_rate[i]
    for i in range(len(definition.rule)):
        d, v, terms = 0.0, 0.0, 0.0
        for j in range(len(trial.inputs)):
            d += definition.inputs[i, j] * trial.inputs[j]
            term = definition.inputs[i, j] * trial.input_rates[j]
            v, terms = v + term, terms + abs(term)
        for q in range(rows.pointers[i], rows.pointers[i + 1]):
            d += rows.values[q] * trial.displacement[rows.columns[q]]
            term = rows.values[q] * trial.velocity[rows.columns[q]]
            v, terms = v + term, terms + abs(term)
        laws.trial.deformation[i], laws.trial.rate[i] = d, v
        laws.largest.terms[i] = max(laws.largest.terms[i], terms)
    predict_members(sim.members, step)


def solve_acceleration(sim: Simulation, at: int) -> None:
    """Acceleration at the end of the step, with the laws and the members on their present tangents."""
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
    solve_factored(sim.linear.pattern, step.factors[at], step.pivots[at], acceleration)


def correct_curved(sim: Simulation, rules: Tables, scheme: Scheme, h: float, at: int) -> tuple[float, int]:
    """Linearise the curved laws at the acceleration that was tried, and let the factor follow.

    Returns
    -------
    worst, law : float, int
        Largest distance of a law from its last tangent, over its force, and which law it is; -1.0 where the
        factor fails.
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
        change = beta_h2 * (k - tangent.stiffness[i]) + gamma_h * (damp - tangent.damping[i])
        tangent.stiffness[i], tangent.damping[i], tangent.offset[i] = k, damp, force - k * d - damp * v
        sim.run.updates += 1
        if sim.linear.explicit or update_factor(sim, i, change, at):
            continue
        if factorise_step(sim, scheme, h, at) >= 0:
            return -1.0, -1
    return worst, law


def update_member_tangents(sim: Simulation, scheme: Scheme, h: float, at: int) -> bool:
    """Recompute the members' tangents, and factorise again; False where that fails."""
    members = sim.members
    take_tangents(members, members.trial.quantities)
    for c in range(len(members.parameters)):
        anchor_member(members, c)
    if factorise_step(sim, scheme, h, at) >= 0:
        return False
    if at != WHOLE:
        sim.run.updates = MAX_UPDATES + 1
    return True


def iterate_newton(sim: Simulation, rules: Tables, scheme: Scheme, h: float, at: int) -> bool:
    """Solve for the acceleration at the end of the step; False where Newton does not converge, and the law
    furthest from it in `run.fault`.
    """
    last, worst, law = np.inf, 0.0, -1
    sim.run.fault = -1
    for _ in range(MAX_ITERATIONS):
        solve_acceleration(sim, at)
        worst, law = correct_curved(sim, rules, scheme, h, at)
        if worst == -1.0:
            return False
        has_members = len(sim.members.parameters) > 0
        error = correct_members(sim.members, sim.step, scheme.beta * h * h) if has_members else 0.0
        if worst <= CONVERGED and error <= 1.0:
            return True
        if not error < np.inf:
            return False
        slow = error > 1.0 and error > POOR_CONVERGENCE * last
        if slow and not update_member_tangents(sim, scheme, h, at):
            return False
        last = error
    if worst > CONVERGED:
        sim.run.fault = law
    return False


def try_step(
    sim: Simulation, rules: Tables, scheme: Scheme, coefs: Array, end: float, h: float, at: int
) -> bool:
    """Try a step of length `h` that ends at the local time `end`, with the factor `at`; False where Newton
    does not converge (see `iterate_newton`).
    """
    linear, laws = sim.linear, sim.laws
    definition, rows = laws.definition, laws.definition.rows
    predict_step(sim, scheme, coefs, end, h)
    if not iterate_newton(sim, rules, scheme, h, at):
        return False
    trial, beta_h2, gamma_h = sim.step.trial, scheme.beta * h * h, scheme.gamma * h
    for i in range(len(trial.acceleration)):
        trial.displacement[i] += beta_h2 * trial.acceleration[i]
    for i in range(len(trial.acceleration)):
        trial.velocity[i] += gamma_h * trial.acceleration[i]
    for i in range(len(definition.rule)):
        a = row_product(rows, i, trial.acceleration)
        laws.trial.deformation[i] += beta_h2 * a
        laws.trial.rate[i] += gamma_h * a
        if definition.contact[i]:  # of bodies that move alike the deformation is rounding
            far = row_magnitude(rows, i, trial.displacement)
            laws.largest.deformation[i] = max(laws.largest.deformation[i], far)
    if len(laws.friction.coupled) > 0:
        update_friction_limits(laws, rules, trial.acceleration)
    if linear.implicit and not linear.all_mass:
        correct_massless_rates(sim, linear.massless_vary or sim.run.stale != 0, h)
        sim.run.stale = 0
    return True


def restore_start_tangents(sim: Simulation, rules: Tables) -> None:
    """Linearise the curved laws and the members at the start of the step."""
    linearise_laws(sim.laws, rules)
    take_tangents(sim.members, sim.members.now.quantities)


def add_external_work(sim: Simulation, h: float) -> None:
    """Add up the work of loads and moved supports over the step, and the loss in dashpots of the
    structure.
    """
    linear, laws, members, works = sim.linear, sim.laws, sim.members, sim.works
    now, trial = sim.step.now, sim.step.trial
    before, work, loss = works.input, 0.0, 0.0
    loss += mean_damping_power(now, trial)
    if len(linear.support_damping) > 0:
        for i in range(len(now.velocity)):
            pushed0 = load_on_nodes(linear, now.inputs, i)
            pushed1 = load_on_nodes(linear, trial.inputs, i)
            work += 3.0 * (pushed0 * now.velocity[i] + pushed1 * trial.velocity[i])
        put0, lost0 = support_power(linear, laws, members, now, laws.now, members.now)
        put1, lost1 = support_power(linear, laws, members, trial, laws.trial, members.trial)
        work += 3.0 * (put0 + put1)
        loss += 1.5 * (lost0 + lost1)
    else:
        work += mean_load_power(now, trial)
    p = members.parameters
    for c in range(len(p)):
        if p[c, KIND] == STRING:  # work of the axial force on the shortening that a string leaves out
            s0, s1 = members.now.quantities, members.trial.quantities
            square = s0[c, ACROSS] * s0[c, ACROSS] + s1[c, ACROSS] * s1[c, ACROSS]
            works.input += 0.25 * square / p[c, LENGTH] * (s1[c, AXIAL] - s0[c, AXIAL])
    works.input += work * h / 6.0
    works.damping += loss * h / 3.0
    works.gross_input += abs(works.input - before)


def accept_laws(laws: Laws, rules: Tables, h: float, works: Works) -> None:
    """Add up the losses in the laws' dashpots and the contacts' impulses; take over the end of the step."""
    definition, largest = laws.definition, laws.largest
    for i in range(len(definition.rule)):
        d0, d1 = laws.now.deformation[i], laws.trial.deformation[i]
        v0, v1 = laws.now.rate[i], laws.trial.rate[i]
        drag0, drag1 = drag_force(laws, rules, i, d0, v0), drag_force(laws, rules, i, d1, v1)
        if drag0 != 0.0 or drag1 != 0.0:
            lost = h / 6.0 * (drag0 * (2.0 * v0 + v1) + drag1 * (v0 + 2.0 * v1))
            laws.state.dashpot_loss[i] += lost
            if definition.contact[i]:
                works.contact += lost
            else:
                works.damping += lost
        if definition.contact[i]:
            force0, force1 = law_force(laws, rules, i, d0, v0), law_force(laws, rules, i, d1, v1)
            laws.collision.impulse[i] += 0.5 * h * (force0 + force1)
        laws.now.deformation[i], laws.now.rate[i] = d1, v1
        largest.deformation[i] = max(largest.deformation[i], abs(d1))
        largest.rate[i] = max(largest.rate[i], abs(v1))


def accept_members(members: Corotational) -> None:
    """Make the members' state at the end of the step the present one."""
    for c in range(len(members.parameters)):
        size = force_size(members.trial, c, members.parameters[c, LENGTH])
        members.largest[0] = max(members.largest[0], size)
        for j in range(6):
            members.now.quantities[c, j] = members.trial.quantities[c, j]
            members.now.forces[c, j] = members.trial.forces[c, j]


def update_residual(linear: LinearSystem, step: Step, scheme: Scheme) -> None:
    """Residual of the alpha methods at the end of the step."""
    one = 1.0 / (1.0 - scheme.alpha_f)
    before, after, residual = step.now.acceleration, step.trial.acceleration, step.residual
    mean, inertia = step.scratch[0], step.scratch[1]
    for i in range(len(residual)):
        mean[i] = (1.0 - scheme.alpha_m) * after[i] + scheme.alpha_m * before[i]
    multiply(linear.mass, mean, inertia)
    for i in range(len(residual)):
        residual[i] = one * (inertia[i] - scheme.alpha_f * residual[i])


def accept_trial(sim: Simulation, rules: Tables, scheme: Scheme, h: float, at: int) -> None:
    """Make the end of the trial step the start of the next; count it, if it is longer than the time in
    which a falling branch gives way.

    A then has a negative eigenvalue, as its pivots in row `at` show (Sylvester's law of inertia): along
    that mode the method moves against the force, the true motion with it.
    """
    linear, laws, step = sim.linear, sim.laws, sim.step
    now, trial = step.now, step.trial
    n = len(now.velocity)
    for i in range(n):
        if step.pivots[at, i] < 0.0:
            sim.run.falling += 1
            break
    multiply(linear.damping, trial.acceleration, trial.damping_rate)
    if linear.all_mass:
        on_velocity, gamma_h = (1.0 - scheme.gamma) * h, scheme.gamma * h
        for i in range(n):
            trial.damping_force[i] = (
                now.damping_force[i] + on_velocity * now.damping_rate[i] + gamma_h * trial.damping_rate[i]
            )
    else:
        multiply(linear.damping, trial.velocity, trial.damping_force)
    add_external_work(sim, h)
    accept_members(sim.members)
    if len(laws.friction.coupled) > 0:
        add_slip_work(laws, h)
        hold_friction_limits(laws)
    accept_laws(laws, rules, h, sim.works)
    if scheme.alpha_f != 0.0 or scheme.alpha_m != 0.0:
        update_residual(linear, step, scheme)
    copy(trial.displacement, now.displacement)
    copy(trial.velocity, now.velocity)
    copy(trial.acceleration, now.acceleration)
    copy(trial.damping_force, now.damping_force)
    copy(trial.damping_rate, now.damping_rate)
    copy(trial.load, now.load)
    copy(trial.inputs, now.inputs)
    copy(trial.input_rates, now.input_rates)
