"""Kernels for the power that moved supports and loads put in and dashpots take out."""

from __future__ import annotations

from pound_solve.integrate.kernels.law_state import LawMotion, Laws
from pound_solve.integrate.kernels.laws import linear_force
from pound_solve.integrate.kernels.state import Corotational, LinearSystem, MemberState, MotionState
from pound_solve.numerics.jit import reorder_sums
from pound_solve.numerics.types import Array


def support_power(
    linear: LinearSystem, laws: Laws, members: Corotational, motion: MotionState, law_motion: LawMotion,
    member_state: MemberState,
) -> tuple[float, float]:  # fmt: skip
    """Return the power that moved supports put in, and the loss in dashpots attached to them, now."""
    definition = laws.definition
    put, lost = 0.0, 0.0
    moved = len(linear.support_damping)
    for q in range(moved):
        speed, force, drag = 0.0, 0.0, 0.0
        for j in range(len(motion.inputs)):
            speed += linear.support_rates[q, j] * motion.inputs[j]
            force += linear.support_forces[q, j] * motion.inputs[j]
        if speed == 0.0:
            continue
        for i in range(len(motion.displacement)):
            force += (
                linear.reactions[0, q, i] * motion.displacement[i]
                + linear.reactions[2, q, i] * motion.acceleration[i]
            )
            drag += linear.reactions[1, q, i] * motion.velocity[i]
        for i in range(len(definition.rule)):
            if definition.supports[i, q] != 0.0:
                f = linear_force(laws.tangent, i, law_motion.deformation[i], law_motion.rate[i])
                force += definition.supports[i, q] * f
        for c in range(len(member_state.forces)):
            for j in range(6):
                force += members.supports[c, j, q] * member_state.forces[c, j]
        put += (force + drag) * speed
        lost += 2.0 * drag * speed
        for z in range(moved):
            for j in range(len(motion.inputs)):
                lost += speed * linear.support_damping[q, z] * linear.support_rates[z, j] * motion.inputs[j]
    return put, lost


def load_on_nodes(linear: LinearSystem, inputs: Array, i: int) -> float:
    """Return the force on unknown `i` due to constant loads and FORCES."""
    force: float = linear.constant[i]
    for j in range(len(inputs)):
        force += linear.nodal_inputs[i, j] * inputs[j]
    return force


@reorder_sums
def damping_power_sum(now: MotionState, trial: MotionState) -> float:
    """Return three times the mean power that the structure's dashpots take in a step with linear forces and
    velocities.
    """
    loss = 0.0
    for i in range(len(now.velocity)):
        loss += (
            now.damping_force[i] * (now.velocity[i] + trial.velocity[i])
            + trial.damping_force[i] * trial.velocity[i]
        )
    return loss


@reorder_sums
def load_power_sum(now: MotionState, trial: MotionState) -> float:
    """Return six times the mean power of the loads in a step with linear loads and velocities."""
    work = 0.0
    for i in range(len(now.velocity)):
        work += (2.0 * now.load[i] + trial.load[i]) * now.velocity[i] + (
            now.load[i] + 2.0 * trial.load[i]
        ) * trial.velocity[i]
    return work
