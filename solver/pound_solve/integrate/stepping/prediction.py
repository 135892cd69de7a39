"""Prediction of a step: motion and forces at its end without the terms of the acceleration there."""

from __future__ import annotations

from pound_solve.integrate.kernels.corotational import predict_members
from pound_solve.integrate.kernels.products import evaluate_inputs, form_load, multiply
from pound_solve.integrate.kernels.state import Scheme, Simulation
from pound_solve.numerics.types import Array


def predict_step(sim: Simulation, scheme: Scheme, coefs: Array, end: float, h: float) -> None:
    """Predict the motion and the forces at the end of a step of length `h`, at the local time `end`,
    without the terms of the acceleration there.
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
        factor = 1.0 / (1.0 - scheme.alpha_f)
        for i in range(n):
            right[i] -= factor * (scheme.alpha_f * step.residual[i] - scheme.alpha_m * inertia[i])
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
