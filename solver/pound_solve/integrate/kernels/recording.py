"""Kernels that store results for Python to fetch: peaks, transitions, samples, motions between samples."""

from __future__ import annotations

from pound_solve.integrate.energy import CONTACT, DAMPING, INPUT
from pound_solve.integrate.kernels.consistency import make_consistent, touches_massless
from pound_solve.integrate.kernels.law_state import Laws
from pound_solve.integrate.kernels.laws import internal, law_force, law_work, parameters
from pound_solve.integrate.kernels.products import row_product
from pound_solve.integrate.kernels.state import (
    LOG_AFTER,
    LOG_BEFORE,
    LOG_DEFORMATION,
    LOG_FORCE,
    LOG_IMPULSE,
    LOG_LAW,
    LOG_PEAK,
    LOG_PEAK_TIME,
    LOG_RATE,
    LOG_TIME,
    Run,
    Simulation,
    Step,
)
from pound_solve.laws.automaton import LOSS_ROUNDING, K
from pound_solve.laws.functions import RuleFunctions, recoverable_of
from pound_solve.numerics.cubic import cubic_peak

#: steps, and steps times unknowns, after which Python may check for an interrupt
PAUSE, BUSY = 100_000, 10_000_000


def next_pause(step: Step, run: Run) -> int:
    """Return the number of steps after which Python may check again for an interrupt."""
    return run.steps + min(PAUSE, 1 + BUSY // (1 + len(step.residual)))


def update_extreme(laws: Laws, step: Step, law: int, i: int, value: float, t: float) -> None:
    """Update peak `i` with a value; `law` is not negative for the force of a law."""
    collision = laws.collision
    extremes = step.extremes
    if value > extremes.high[i]:
        extremes.high[i], extremes.t_high[i] = value, t
    if value < extremes.low[i]:
        extremes.low[i], extremes.t_low[i] = value, t
    if law >= 0 and laws.definition.contact[law] and value > collision.peak_force[law]:
        collision.peak_force[law], collision.peak_time[law] = value, t


def tracked_value(sim: Simulation, i: int) -> tuple[float, float]:
    """Return value and slope of tracked quantity `i` at the next start (`tracker.TrackedExtremes`)."""
    linear, laws = sim.linear, sim.laws
    definition, rows, tangent = laws.definition, laws.definition.rows, laws.tangent
    now, outputs, n_laws = sim.step.now, len(linear.monitored_constants), len(definition.rule)
    if i < outputs:
        value = row_product(linear.monitored, i, now.displacement) + linear.monitored_constants[i]
        slope = row_product(linear.monitored, i, now.velocity)
        for j in range(len(now.inputs)):
            value += linear.monitored_inputs[i, j] * now.inputs[j]
            slope += linear.monitored_inputs[i, j] * now.input_rates[j]
        return value, slope
    if i < outputs + n_laws:
        return laws.now.deformation[i - outputs], laws.now.rate[i - outputs]
    law = i - outputs - n_laws
    d, v = laws.now.deformation[law], laws.now.rate[law]
    value, slope = tangent.stiffness[law] * d + tangent.offset[law], tangent.stiffness[law] * v
    if definition.reports_damping[law] and tangent.damping[law] != 0.0:
        value += tangent.damping[law] * v
        slope += tangent.damping[law] * row_product(rows, law, now.acceleration)
        # the acceleration of a massless unknown is a jump of its velocity over the length of a step
        if touches_massless(linear, rows, law):
            slope = 0.0
    return value, slope


def track_peaks(sim: Simulation, t: float, since: float) -> None:
    """Update the peaks with the motion at the start of the next step and, on unchanged branches, with the
    stationary points since the last update, `since` ago (0: none).
    """
    laws, step = sim.laws, sim.step
    extremes, forces = step.extremes, len(sim.linear.monitored_constants) + len(laws.definition.rule)
    for i in range(forces + len(laws.definition.rule)):
        value, slope = tracked_value(sim, i)
        update_extreme(laws, step, i - forces, i, value, t)
        if since > 0.0 and extremes.slope[i] * slope < 0.0:
            sign = 1.0 if extremes.slope[i] > 0.0 else -1.0
            place, top = cubic_peak(
                sign * extremes.value[i], sign * value, sign * extremes.slope[i], sign * slope, since
            )
            update_extreme(laws, step, i - forces, i, sign * top, t - since + place)
        extremes.value[i], extremes.slope[i] = value, slope
        extremes.steepest[i] = max(extremes.steepest[i], abs(slope))
        extremes.reached[i] = max(extremes.reached[i], abs(value))


def log_transition(sim: Simulation, i: int, before: int, t: float, force: float) -> None:
    """Add a change of branch to the log, and reset the collision forces of a contact."""
    laws = sim.laws
    collision = laws.collision
    row = sim.buffers.log[sim.run.n_transitions]
    row[LOG_LAW], row[LOG_BEFORE], row[LOG_AFTER], row[LOG_TIME] = i, before, laws.state.branch[i], t
    row[LOG_DEFORMATION], row[LOG_RATE], row[LOG_FORCE] = laws.now.deformation[i], laws.now.rate[i], force
    row[LOG_PEAK], row[LOG_PEAK_TIME] = collision.peak_force[i], collision.peak_time[i]
    row[LOG_IMPULSE] = collision.impulse[i]
    sim.run.n_transitions += 1
    if laws.definition.contact[i]:
        collision.peak_force[i], collision.peak_time[i], collision.impulse[i] = force, t, 0.0


def store_sample(sim: Simulation, rules: RuleFunctions, t: float) -> None:
    """Store the motion, the laws' forces and energies, and the works."""
    laws, buffers, works = sim.laws, sim.buffers, sim.works
    definition, state = laws.definition, laws.state
    at, now = sim.run.n_samples, sim.step.now
    buffers.time[at] = t
    for i in range(len(sim.step.residual)):
        buffers.displacement[at, i] = now.displacement[i]
        buffers.velocity[at, i] = now.velocity[i]
        buffers.acceleration[at, i] = now.acceleration[i]
    for i in range(len(definition.rule)):
        d = laws.now.deformation[i]
        still = law_force(laws, rules, i, d, 0.0)
        whole = law_force(laws, rules, i, d, laws.now.rate[i])
        buffers.force[at, i] = whole if definition.reports_damping[i] else still
        buffers.dashpot[at, i] = whole - buffers.force[at, i]
        stored = recoverable_of(
            rules,
            definition.rule[i],
            parameters(definition.parameters, i),
            state.branch[i],
            internal(state.internal, i),
            d,
            still,
        )
        lost = law_work(laws, rules, i, d) - stored
        size = max(abs(d), abs(state.entry_deformation[i]))
        rounding = LOSS_ROUNDING * definition.parameters[i, K] * size * size
        buffers.stored[at, i] = stored
        buffers.lost[at, i] = lost if abs(lost) > rounding else 0.0
    kept = buffers.works[at]
    kept[INPUT], kept[DAMPING], kept[CONTACT] = works.input, works.damping, works.contact
    sim.run.n_samples += 1


def take_first_sample(sim: Simulation, rules: RuleFunctions) -> None:
    """Make the start consistent and store it as the first sample."""
    run = sim.run
    make_consistent(sim)
    track_peaks(sim, run.time, 0.0)
    store_sample(sim, rules, run.time)
    run.started = 1


def store_motion(sim: Simulation, rules: RuleFunctions, t: float) -> None:
    """Store the present motion for the envelopes.

    If a step is cut into more parts than there is room for, the rest is not stored.
    """
    laws, buffers, run = sim.laws, sim.buffers, sim.run
    nothing = len(buffers.enveloped_unknowns) + len(buffers.enveloped_laws) == 0
    if nothing or run.n_motions == len(buffers.motion_time):
        return
    at, now = run.n_motions, sim.step.now
    buffers.motion_time[at] = t
    for i in range(len(buffers.enveloped_unknowns)):
        unknown = buffers.enveloped_unknowns[i]
        buffers.motion[at, 0, i] = now.displacement[unknown]
        buffers.motion[at, 1, i] = now.velocity[unknown]
        buffers.motion[at, 2, i] = now.acceleration[unknown]
    for i in range(len(buffers.enveloped_laws)):
        law = buffers.enveloped_laws[i]
        buffers.law_forces[at, i] = law_force(
            laws, rules, law, laws.now.deformation[law], laws.now.rate[law]
        )
    run.n_motions += 1
