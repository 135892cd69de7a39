"""Kernels of TAYLOR: the works of a step, by Gauss's rule; those of loads in closed form."""

from __future__ import annotations

from pound_solve.integrate.kernels.laws import dissipative_force, linearise_law
from pound_solve.integrate.kernels.products import evaluate_inputs, multiply
from pound_solve.integrate.kernels.state import LinearSystem, Piece, Simulation
from pound_solve.integrate.kernels.work import load_on_nodes, support_power
from pound_solve.integrate.series.expansion import MAX_DEGREE, UNCHECKED_TERMS, dot, evaluate_motion, law_at
from pound_solve.integrate.series.forces import update_branch_forces
from pound_solve.integrate.series.friction import is_sliding
from pound_solve.integrate.series.p_delta import p_delta_power
from pound_solve.integrate.series.power_contacts import APART
from pound_solve.integrate.series.state import Extent, Series
from pound_solve.laws.functions import RuleFunctions


def add_law_losses(
    sim: Simulation, rules: RuleFunctions, series: Series, extent: Extent, s: float, weight: float
) -> None:
    """Add up the losses in the laws' dashpots and the contacts' impulses at the Gauss point `s`.

    Afterwards forces, tangents of smooth laws and dampers, and `laws.trial` are those of this point.
    """
    laws, works, moved = sim.laws, sim.works, len(sim.linear.support_damping) > 0
    definition, tangent = laws.definition, laws.tangent
    update_branch_forces(laws, series, extent.degree, s, extent.h)
    for i in range(len(definition.rule)):
        drag, curved = tangent.damping[i], series.power_contacts.index_of[i]
        overlaps = curved >= 0 and series.power_contacts.phase[curved] != APART
        pressed = definition.contact[i] and (tangent.stiffness[i] != 0.0 or tangent.offset[i] != 0.0)
        curves = overlaps or series.power_dampers.index_of[i] >= 0
        sliding = is_sliding(series.friction, i)
        if drag != 0.0 or moved or pressed or curves or sliding:
            d, v = law_at(series, extent.degree, s, extent.h, i)
            laws.trial.deformation[i], laws.trial.rate[i] = d, v
            if series.smooth.index_of[i] >= 0 or (moved and series.power_dampers.index_of[i] >= 0):
                linearise_law(laws, rules, i, d, v)
                drag = tangent.damping[i]
            if sliding:
                laws.state.entry_work[i] += weight * tangent.offset[i] * v
                continue
            lost = weight * v * (dissipative_force(laws, rules, i, d, v) if curves else drag * v)
            laws.state.dashpot_loss[i] += lost
            if definition.contact[i]:
                works.contact += lost
                laws.collision.impulse[i] += weight * (
                    tangent.stiffness[i] * d + drag * v + tangent.offset[i]
                )
            else:
                works.damping += lost


def work_put_in(linear: LinearSystem, series: Series, extent: Extent, n_powers: int) -> float:
    """Return the work of the loads on the nodes over a step: their series times those of the velocities."""
    put, power, degree, end = 0.0, 1.0, extent.degree, extent.end
    for k in range(1, degree + 1):
        power *= end
        put += power * dot(linear.constant, series.motion[k])
        for j in range(series.inputs.shape[1]):
            share, integral, further = dot(linear.inputs[j], series.motion[k]), 0.0, power
            for m in range(min(n_powers, degree)):
                integral += series.inputs[m, j] * further * k / (k + m)
                further *= end
            put += share * integral
    return put


def add_works(sim: Simulation, rules: RuleFunctions, series: Series, piece: Piece, extent: Extent) -> None:
    """Add up the works over a step, all but those of the loads by Gauss's rule.

    It leaves forces, tangents and `laws.trial` of the last Gauss point (see `add_law_losses`), so it comes
    last of all that reads those at the start of the step.
    """
    linear, laws, works = sim.linear, sim.laws, sim.works
    begin, degree, h, end = extent.begin - piece.begin, extent.degree, extent.h, extent.end
    moved, trial, damped = len(linear.support_damping) > 0, sim.step.trial, series.damped
    for k in range(1, degree + 1):
        for i in range(len(damped.unknown)):
            damped.motion[k, i] = series.motion[k, damped.unknown[i]]
    put = 0.0 if moved else work_put_in(linear, series, extent, len(piece.coefs))
    rule = min(series.control.quadrature_degree, MAX_DEGREE) // UNCHECKED_TERMS
    for g in range(2 * (rule + 1)):
        weight, s = series.gauss[rule, 0, g] * end * h, series.gauss[rule, 1, g] * end
        evaluate_motion(damped.motion, degree, s, h, 1, damped.velocity)
        multiply(damped.damping, damped.velocity, damped.force)
        works.damping += weight * dot(damped.velocity, damped.force)
        if moved:
            evaluate_inputs(piece.coefs, begin + s * h, trial.inputs, trial.input_rates)
        add_law_losses(sim, rules, series, extent, s, weight)
        put += weight * p_delta_power(sim.members, series, degree, s, h)
        if moved:
            evaluate_motion(series.motion, degree, s, h, 0, trial.displacement)
            evaluate_motion(series.motion, degree, s, h, 1, trial.velocity)
            evaluate_motion(series.motion, degree, s, h, 2, trial.acceleration)
            supplied, lost = support_power(linear, laws, sim.members, trial, laws.trial, sim.members.trial)
            put += weight * supplied
            works.damping += weight * lost
            for i in range(len(trial.velocity)):
                put += weight * load_on_nodes(linear, trial.inputs, i) * trial.velocity[i]
    works.input += put
    works.gross_input += abs(put)
