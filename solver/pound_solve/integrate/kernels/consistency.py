r"""Kernels that make the state at an instant consistent with the present branches of the laws.

Accelerations follow from the equations of motion.  Velocities of massless unknowns jump if a stiffness or a
dashpot jumps.  An implicit step of a tiny length e finds them,

.. math:: (C + e K)\,\Delta v = p - C v - K u - f + e\,\tfrac{d}{dt}(p - K u - f)

over the massless unknowns.  Of a residual :math:`r = p - C v - K u - f`, only the part that dashpots resist
makes them jump.  The part that only springs resist (rounding, an event that is not met to the last digit, a
curved law on its tangent) would require a jump of the displacement, and a velocity of r / (e K).  It is
left out: :math:`(C + e K)\,\Delta v_1 = r` splits r into :math:`C\,\Delta v_1`, resisted by dashpots, and
the rest.
"""

from __future__ import annotations

from pound_solve.integrate.kernels.corotational import (
    add_tangent,
    add_tangent_force,
    form_members,
    form_quantities,
    subtract_force,
)
from pound_solve.integrate.kernels.law_state import Laws
from pound_solve.integrate.kernels.laws import linear_force
from pound_solve.integrate.kernels.products import multiply, row_product
from pound_solve.integrate.kernels.sparse import Rows
from pound_solve.integrate.kernels.state import C_ROW, K_ROW, MASS, MASSLESS, LinearSystem, Simulation
from pound_solve.integrate.tolerances import LOST_FORCE_OF_STEPS, NEARLY_MET
from pound_solve.numerics.ldl import factor, solve
from pound_solve.numerics.types import Array
from pound_solve.structure.corotational import quantity_stiffness

DELAY = 1e-8  #: e as a fraction of the longest C / K among massless unknowns


def touches_massless(linear: LinearSystem, rows: Rows, i: int) -> bool:
    """Return whether law `i` holds a massless unknown, whose velocity may jump."""
    if not linear.all_mass:
        for q in range(rows.pointers[i], rows.pointers[i + 1]):
            if not linear.has_mass[rows.columns[q]]:
                return True
    return False


def loses_force(
    linear: LinearSystem, laws: Laws, i: int, stiffness: float, offset: float, d: float
) -> bool:
    """Return whether law `i` lost a force that held a massless unknown when it left a branch with the
    given `stiffness` and `offset` at the deformation `d`.
    """
    definition = laws.definition
    if definition.contact[i] or definition.curved[i]:
        return False
    largest, now, after = laws.largest.deformation[i], laws.tangent.stiffness[i], laws.tangent.offset[i]
    size = (abs(stiffness) + abs(now)) * largest + abs(offset) + abs(after)
    lost = abs((stiffness - now) * d + offset - after) > LOST_FORCE_OF_STEPS * size
    return lost and touches_massless(linear, definition.rows, i)


def slowest_decay(sim: Simulation) -> float:
    """Return the longest ratio of dashpot to stiffness of a massless unknown, from the diagonals [T].

    It fills the first two rows of `Step.scratch`.
    """
    linear, laws, step = sim.linear, sim.laws, sim.step
    rows = laws.definition.rows
    stiffness, damping, slowest = step.scratch[0], step.scratch[1], 0.0
    for i in range(len(stiffness)):
        stiffness[i], damping[i] = 0.0, 0.0
    for q in range(len(step.matrix)):
        i = linear.column[q]
        if linear.pattern.ai[q] == i and not linear.has_mass[i]:
            stiffness[i], damping[i] = linear.on_pattern[K_ROW, q], linear.on_pattern[C_ROW, q]
    for i in range(len(laws.definition.rule)):
        for q in range(rows.pointers[i], rows.pointers[i + 1]):
            j, square = rows.columns[q], rows.values[q] * rows.values[q]
            stiffness[j] += laws.tangent.stiffness[i] * square
            damping[j] += laws.tangent.damping[i] * square
    for i in range(len(stiffness)):
        if not linear.has_mass[i] and stiffness[i] > 0.0:
            slowest = max(slowest, damping[i] / stiffness[i])
    return slowest


def factorise_massless(sim: Simulation, quantities: Array) -> float:
    """Factorise ``K + C / e`` over the massless unknowns, with the members at the given quantities; fill
    the first two rows of `Step.scratch` (see `slowest_decay`).

    Returns
    -------
    float
        1 / e: large enough that dashpots hold their unknowns, small enough that the springs are not lost
        in rounding beside them.
    """
    linear, laws, step = sim.linear, sim.laws, sim.step
    definition = laws.definition
    slowest = slowest_decay(sim)
    inverse_instant = max(1.0 / linear.instant, 1.0 / (DELAY * slowest) if slowest > 0.0 else 0.0)
    for q in range(len(step.matrix)):
        i, j = linear.pattern.ai[q], linear.column[q]
        step.matrix[q] = 0.0
        if not linear.has_mass[i] and not linear.has_mass[j]:
            step.matrix[q] = linear.on_pattern[K_ROW, q] + inverse_instant * linear.on_pattern[C_ROW, q]
        elif i == j:
            step.matrix[q] = 1.0
    for i in range(len(definition.rule)):
        change = laws.tangent.stiffness[i] + inverse_instant * laws.tangent.damping[i]
        for q in range(definition.pair_pointers[i], definition.pair_pointers[i + 1]):
            at = definition.pair_places[q]
            if not linear.has_mass[linear.pattern.ai[at]] and not linear.has_mass[linear.column[at]]:
                step.matrix[at] += change * definition.pair_values[q]
    members = sim.members
    for c in range(len(members.parameters) * linear.massless_vary):
        quantity_stiffness(members.parameters, c, quantities, 0, members.present_tangent, c)
        add_tangent(linear, members, step, c, members.present_tangent, 1.0, True)
    if factor(linear.pattern, step.matrix, step.factors[MASSLESS], step.pivots[MASSLESS], step.row) >= 0:
        for i in range(len(step.row)):  # unrestrained unknowns keep their motion
            step.pivots[MASSLESS, i] = float("inf")
    return inverse_instant


def force_rates(sim: Simulation, velocity: Array, rate: Array, input_rates: Array, out: Array) -> None:
    """Compute the rates of the forces on the massless unknowns, dashpots excluded, at the given velocities
    and rates of the laws.
    """
    linear, laws, members = sim.linear, sim.laws, sim.members
    rows = laws.definition.rows
    multiply(linear.stiffness, velocity, out)
    for i in range(len(out)):
        change = 0.0
        for j in range(len(input_rates)):
            change += linear.inputs[j, i] * input_rates[j]
        out[i] = change - out[i]
    for i in range(len(laws.definition.rule)):
        change = laws.tangent.stiffness[i] * rate[i] + laws.friction.offset_rate[i]
        for q in range(rows.pointers[i], rows.pointers[i + 1]):
            out[rows.columns[q]] -= rows.values[q] * change
    if linear.massless_vary:
        form_quantities(members, velocity, input_rates, members.predicted)
    for c in range(len(members.parameters) * linear.massless_vary):
        for j in range(6):
            members.at_zero[c, j] = 0.0
        add_tangent_force(members.present_tangent, c, members.predicted, members.at_zero, 1.0)
        subtract_force(members, c, members.at_zero, out)
    for i in range(len(out)):
        if linear.has_mass[i]:
            out[i] = 0.0


def dashpot_forces(linear: LinearSystem, laws: Laws, velocity: Array, out: Array) -> None:
    """Compute the forces of the dashpots, those of the laws included, at the given velocities."""
    rows = laws.definition.rows
    multiply(linear.damping, velocity, out)
    for i in range(len(laws.definition.rule)):
        if laws.tangent.damping[i] != 0.0:
            force = laws.tangent.damping[i] * row_product(rows, i, velocity)
            for q in range(rows.pointers[i], rows.pointers[i + 1]):
                out[rows.columns[q]] += rows.values[q] * force


def correct_massless_rates(sim: Simulation, stale: bool, h: float) -> None:
    """Correct velocities of massless unknowns without dashpots, at the end of a step of length `h`.

    They follow from the rates of the forces, which remain in balance.  The method itself would give about
    twice their mean over the step less those at its start: an undamped oscillation about the true ones.

    Parameters
    ----------
    stale : bool
        Whether the matrix of the massless unknowns must be factorised again.
    """
    linear, laws, step = sim.linear, sim.laws, sim.step
    if stale:
        factorise_massless(sim, sim.members.trial.quantities)
    now, trial, change = step.now, step.trial, step.scratch[0]
    force_rates(sim, trial.velocity, laws.trial.rate, trial.input_rates, change)
    solve(linear.pattern, step.factors[MASSLESS], step.pivots[MASSLESS], change)
    for i in range(len(change)):
        if not linear.has_mass[i]:
            trial.velocity[i] += change[i]
            trial.acceleration[i] = (trial.velocity[i] - now.velocity[i]) / h
    for i in range(len(laws.definition.rule)):
        laws.trial.rate[i] += row_product(laws.definition.rows, i, change)


def jump_massless_rates(sim: Simulation) -> None:
    """Set the velocities of massless unknowns for the present branches (see the module docstring)."""
    linear, laws, step = sim.linear, sim.laws, sim.step
    definition, rows, tangent = laws.definition, laws.definition.rows, laws.tangent
    # before the scratch rows are filled here
    inverse_instant = factorise_massless(sim, sim.members.now.quantities)
    now, change, force = step.now, step.scratch[0], step.scratch[1]
    size, damping_force = step.scratch[2], step.scratch[3]
    multiply(linear.stiffness, now.displacement, force)
    for i in range(len(force)):
        force[i] = now.load[i] - force[i] - now.damping_force[i]
        elastic = abs(linear.stiffness.diagonals[0, i] * now.displacement[i])
        size[i] = abs(now.load[i]) + elastic + abs(now.damping_force[i])
    for i in range(len(definition.rule)):
        f = (
            tangent.stiffness[i] * laws.now.deformation[i]
            + tangent.offset[i]
            + tangent.damping[i] * laws.now.rate[i]
        )
        for q in range(rows.pointers[i], rows.pointers[i + 1]):
            force[rows.columns[q]] -= rows.values[q] * f
            size[rows.columns[q]] += abs(rows.values[q] * f)
    for c in range(len(sim.members.parameters)):
        subtract_force(sim.members, c, sim.members.now.forces, force)
    for i in range(len(force)):
        if linear.has_mass[i] or abs(force[i]) <= NEARLY_MET * size[i]:
            force[i] = 0.0
        force[i] *= inverse_instant
    solve(linear.pattern, step.factors[MASSLESS], step.pivots[MASSLESS], force)
    dashpot_forces(linear, laws, force, damping_force)
    force_rates(sim, now.velocity, laws.now.rate, now.input_rates, change)
    for i in range(len(change)):
        if not linear.has_mass[i]:
            change[i] += inverse_instant * damping_force[i]
    solve(linear.pattern, step.factors[MASSLESS], step.pivots[MASSLESS], change)
    for i in range(len(change)):
        now.velocity[i] += change[i]
    multiply(linear.damping, now.velocity, now.damping_force)
    for i in range(len(definition.rule)):
        laws.now.rate[i] += row_product(rows, i, change)


def make_consistent(sim: Simulation) -> None:
    """Make velocities of massless unknowns and all accelerations consistent with the present branches."""
    linear, laws, step = sim.linear, sim.laws, sim.step
    rows = laws.definition.rows
    now, residual, elastic = step.now, step.residual, step.scratch[0]
    form_members(sim.members, step)
    if linear.has_stiffness and not linear.all_mass:
        jump_massless_rates(sim)
    multiply(linear.stiffness, now.displacement, elastic)
    for i in range(len(residual)):
        residual[i] = now.load[i] - elastic[i] - now.damping_force[i]
    for i in range(len(laws.definition.rule)):
        f = linear_force(laws.tangent, i, laws.now.deformation[i], laws.now.rate[i])
        if f != 0.0:
            for q in range(rows.pointers[i], rows.pointers[i + 1]):
                residual[rows.columns[q]] -= rows.values[q] * f
    for c in range(len(sim.members.parameters)):
        subtract_force(sim.members, c, sim.members.now.forces, residual)
    for i in range(len(residual)):
        if not linear.has_mass[i]:
            residual[i] = 0.0  # in balance; the alphas would treat its rounding as a load
        now.acceleration[i] = residual[i]
    if linear.diagonal:
        for i in range(len(residual)):
            now.acceleration[i] /= step.pivots[MASS, i]
    else:
        solve(linear.pattern, step.factors[MASS], step.pivots[MASS], now.acceleration)
    multiply(linear.damping, now.acceleration, now.damping_rate)
