"""Kernels of corotational members: their quantities, forces and tangents within a step."""

from __future__ import annotations

from pound_solve.integrate.kernels.state import Corotational, LinearSystem, MemberState, Step
from pound_solve.numerics.types import Array
from pound_solve.structure.corotational import (
    ACROSS,
    ALONG,
    AXIAL,
    END_MOMENT,
    KNN,
    KTT,
    LENGTH,
    ROTATION_I,
    quantity_forces,
    quantity_stiffness,
)

FORCE_TOLERANCE = 1e-12  #: tolerance of the members' forces, as a fraction of the largest force
MEMBER_ROUNDING = 1e-15  #: rounding of a member's forces, as a fraction of its axial stiffness


def form_quantities(members: Corotational, u: Array, inputs: Array, out: Array) -> None:
    """Compute the quantities of the members at displacements `u` and the given inputs."""
    for c in range(len(out)):
        for j in range(6):
            total = 0.0
            for y in range(members.pointers[c], members.pointers[c + 1]):
                total += members.rows[y, j] * u[members.unknown[y]]
            for i in range(len(inputs)):
                total += members.inputs[c, j, i] * inputs[i]
            out[c, j] = total


def subtract_force(members: Corotational, c: int, forces: Array, out: Array) -> None:
    """Subtract the forces of member `c` from those on the unknowns."""
    for y in range(members.pointers[c], members.pointers[c + 1]):
        total = 0.0
        for j in range(6):
            total += members.rows[y, j] * forces[c, j]
        out[members.unknown[y]] -= total


def add_tangent_force(tangent: Array, c: int, quantities: Array, out: Array, sign: float) -> None:
    """Add `sign` times the tangent of member `c` times its quantities to row `c` of `out`."""
    for i in range(6):
        total = 0.0
        for j in range(6):
            total += tangent[c, 6 * i + j] * quantities[c, j]
        out[c, i] += sign * total


def add_tangent(
    linear: LinearSystem, members: Corotational, step: Step, c: int, tangent: Array, factor: float,
    massless_only: bool,
) -> None:  # fmt: skip
    """Add `factor` times the tangent of member `c` to A, optionally for massless unknowns only."""
    first = members.pointers[c]
    for y in range(first, members.pointers[c + 1]):
        for i in range(6):
            total = 0.0
            for j in range(6):
                total += tangent[c, 6 * i + j] * members.rows[y, j]
            members.product[y - first, i] = factor * total
    for y in range(members.pair_pointers[c], members.pair_pointers[c + 1]):
        at = members.pair[y, 0]
        has_mass = linear.has_mass[linear.pattern.ai[at]] or linear.has_mass[linear.column[at]]
        if massless_only and has_mass:
            continue
        row, product_row = members.pair[y, 1], members.pair[y, 2] - first
        for j in range(6):
            step.matrix[at] += members.rows[row, j] * members.product[product_row, j]


def form_members(members: Corotational, step: Step) -> None:
    """Compute the quantities and forces of the members at the start of a step."""
    form_quantities(members, step.now.displacement, step.now.inputs, members.now.quantities)
    for c in range(len(members.parameters)):
        quantity_forces(members.parameters, c, members.now.quantities, 0, members.now.forces, 0)


def predict_members(members: Corotational, step: Step) -> None:
    """Linearise the members' forces about the predicted displacements (without the end acceleration)."""
    form_quantities(members, step.trial.displacement, step.trial.inputs, members.predicted)
    for c in range(len(members.parameters)):
        quantity_forces(members.parameters, c, members.predicted, 0, members.at_zero, 0)
        add_tangent_force(members.tangent, c, members.predicted, members.at_zero, -1.0)


def predicted_force(members: Corotational, c: int) -> None:
    """Set the force of member `c` at the end of the step to the linearised one at the prediction."""
    for j in range(6):
        members.trial.forces[c, j] = members.at_zero[c, j]
    add_tangent_force(members.tangent, c, members.predicted, members.trial.forces, 1.0)


def anchor_member(members: Corotational, c: int) -> None:
    """Shift the linearised force of member `c` so that it agrees with the force at the end of the step."""
    for j in range(6):
        members.at_zero[c, j] = members.trial.forces[c, j]
    add_tangent_force(members.tangent, c, members.trial.quantities, members.at_zero, -1.0)


def correct_members(members: Corotational, step: Step, beta_h2: float) -> float:
    """Compute the members' forces for the trial acceleration, and shift the linearised ones to agree with
    them.

    Returns
    -------
    float
        Largest distance of a force from its linearisation, over the tolerance.
    """
    trial, p = members.trial, members.parameters
    size, worst = members.largest[0], 0.0
    for c in range(len(p)):
        for j in range(6):
            total = 0.0
            for y in range(members.pointers[c], members.pointers[c + 1]):
                total += members.rows[y, j] * step.trial.acceleration[members.unknown[y]]
            trial.quantities[c, j] = members.predicted[c, j] + beta_h2 * total
        quantity_forces(p, c, trial.quantities, 0, trial.forces, 0)
        size = max(size, force_size(trial, c, p[c, LENGTH]))
    for c in range(len(p)):
        length, knn = p[c, LENGTH], p[c, KNN]
        reach = length + abs(trial.quantities[c, ALONG]) + abs(trial.quantities[c, ACROSS])
        allowed = FORCE_TOLERANCE * size + MEMBER_ROUNDING * knn * reach
        add_tangent_force(members.tangent, c, trial.quantities, members.at_zero, 1.0)
        for j in range(6):
            off = abs(trial.forces[c, j] - members.at_zero[c, j])
            if j == AXIAL:
                off *= knn
            elif j == END_MOMENT:
                off *= p[c, KTT] / length
            elif j >= ROTATION_I:
                off /= length
            worst = off / allowed if not off <= worst * allowed else worst
        anchor_member(members, c)
    return worst


def force_size(state: MemberState, c: int, length: float) -> float:
    """Return the magnitude of the forces of member `c` [F]."""
    size: float = max(
        abs(state.quantities[c, AXIAL]),
        abs(state.quantities[c, END_MOMENT]) / length,
        abs(state.forces[c, ALONG]),
        abs(state.forces[c, ACROSS]),
    )
    return size


def compute_tangents(members: Corotational, quantities: Array) -> None:
    """Compute the members' tangents at the given quantities, for the next factorisation."""
    for c in range(len(members.parameters)):
        quantity_stiffness(members.parameters, c, quantities, 0, members.tangent, c)
