"""Acceptance of a trial step: its works are added up, and its end becomes the start of the next step."""

from __future__ import annotations

from pound_solve.integrate.energy import Works
from pound_solve.integrate.kernels.corotational import force_size
from pound_solve.integrate.kernels.law_state import Laws
from pound_solve.integrate.kernels.laws import (
    add_slip_work,
    dissipative_force,
    law_force,
    save_friction_limits,
)
from pound_solve.integrate.kernels.products import copy, multiply
from pound_solve.integrate.kernels.state import Corotational, LinearSystem, Scheme, Simulation, Step
from pound_solve.integrate.kernels.work import (
    damping_power_sum,
    load_on_nodes,
    load_power_sum,
    support_power,
)
from pound_solve.laws.functions import RuleFunctions
from pound_solve.structure.corotational import ACROSS, AXIAL, KIND, LENGTH, STRING


def add_external_work(sim: Simulation, h: float) -> None:
    """Add the work of loads and moved supports over the step, and the loss in the structure's dashpots.

    `work` is six times the mean power, `loss` three times (see `kernels.work`).  If supports move, both
    are means of the powers at the ends of the step.
    """
    linear, laws, members, works = sim.linear, sim.laws, sim.members, sim.works
    now, trial = sim.step.now, sim.step.trial
    before, work, loss = works.input, 0.0, 0.0
    loss += damping_power_sum(now, trial)
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
        work += load_power_sum(now, trial)
    p = members.parameters
    for c in range(len(p)):
        if p[c, KIND] == STRING:  # work of the axial force on the shortening that a string leaves out
            s0, s1 = members.now.quantities, members.trial.quantities
            square = s0[c, ACROSS] * s0[c, ACROSS] + s1[c, ACROSS] * s1[c, ACROSS]
            works.input += 0.25 * square / p[c, LENGTH] * (s1[c, AXIAL] - s0[c, AXIAL])
    works.input += work * h / 6.0
    works.damping += loss * h / 3.0
    works.gross_input += abs(works.input - before)


def accept_laws(laws: Laws, rules: RuleFunctions, h: float, works: Works) -> None:
    """Add the losses in the laws' dashpots and the contacts' impulses; accept the laws' trial motion."""
    definition, largest = laws.definition, laws.largest
    for i in range(len(definition.rule)):
        d0, d1 = laws.now.deformation[i], laws.trial.deformation[i]
        v0, v1 = laws.now.rate[i], laws.trial.rate[i]
        drag0, drag1 = dissipative_force(laws, rules, i, d0, v0), dissipative_force(laws, rules, i, d1, v1)
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
    """Compute the residual of the alpha methods at the end of the step."""
    factor = 1.0 / (1.0 - scheme.alpha_f)
    before, after, residual = step.now.acceleration, step.trial.acceleration, step.residual
    mean, inertia = step.scratch[0], step.scratch[1]
    for i in range(len(residual)):
        mean[i] = (1.0 - scheme.alpha_m) * after[i] + scheme.alpha_m * before[i]
    multiply(linear.mass, mean, inertia)
    for i in range(len(residual)):
        residual[i] = factor * (inertia[i] - scheme.alpha_f * residual[i])


def accept_trial(sim: Simulation, rules: RuleFunctions, scheme: Scheme, h: float, factor: int) -> None:
    """Make the end of the trial step the start of the next.  Count the step if it is longer than the time
    in which a softening branch gives way.

    A then has a negative eigenvalue, which shows as a negative pivot of its `factor` (Sylvester's law of
    inertia).  Along that mode the method moves against the force, but the true motion follows it.
    """
    linear, laws, step = sim.linear, sim.laws, sim.step
    now, trial = step.now, step.trial
    n = len(now.velocity)
    for i in range(n):
        if step.pivots[factor, i] < 0.0:
            sim.run.softening += 1
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
        save_friction_limits(laws)
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
