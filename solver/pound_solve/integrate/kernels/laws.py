"""Kernels of the laws: their branches, forces, work and internal variables."""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.kernels.law_state import (
    LARGEST_REVERSAL,
    SECANT_STIFFNESS,
    Laws,
    LawState,
    LawTangent,
)
from pound_solve.integrate.kernels.products import row_product
from pound_solve.integrate.tolerances import EVENT_TOLERANCE
from pound_solve.laws.automaton import (
    CONTACT_CLOSES,
    CONTACT_OPENS,
    NORMAL_FORCE,
    NORMAL_FORCE_RATE,
    UNCOUPLED,
)
from pound_solve.laws.functions import (
    PARAMETERS,
    VARIABLES,
    RuleFunctions,
    branch_of,
    curve_of,
    dissipated_power_of,
    row,
    transition_of,
)
from pound_solve.numerics.types import Array

parameters, internal = row(PARAMETERS), row(VARIABLES)  #: rows of arrays as tuples


def curved_force(
    laws: Laws, rules: RuleFunctions, i: int, d: float, v: float
) -> tuple[float, float, float, float]:
    """Return the force of a curved law, its derivatives by `d` and `v`, and the work since branch entry."""
    state = laws.state
    response: tuple[float, float, float, float] = curve_of(
        rules,
        laws.definition.rule[i],
        parameters(laws.definition.parameters, i),
        state.branch[i],
        internal(state.internal, i),
        state.entry_deformation[i],
        d,
        v,
    )
    return response


def linear_force(tangent: LawTangent, i: int, d: float, v: float) -> float:
    """Return the force of law `i` on its linear branch or tangent."""
    force: float = tangent.stiffness[i] * d + tangent.damping[i] * v + tangent.offset[i]
    return force


def proportional_damping(laws: Laws, i: int, k: float) -> float:
    """Return the dashpot in proportion to the tangent stiffness `k` of law `i`, or its secant stiffness."""
    c: float = (
        laws.definition.tangent_damping[i] * max(k, 0.0)
        + laws.definition.secant_damping[i] * laws.state.internal[i, SECANT_STIFFNESS]
    )
    return c


def enter_branch(laws: Laws, rules: RuleFunctions, i: int) -> None:
    """Copy the linear branch of law `i` and its event functions into the arrays of the kernels."""
    definition, state, tangent = laws.definition, laws.state, laws.tangent
    b = branch_of(
        rules,
        definition.rule[i],
        parameters(definition.parameters, i),
        state.branch[i],
        internal(state.internal, i),
    )
    damping = b[1] + proportional_damping(laws, i, b[0])
    tangent.stiffness[i], tangent.damping[i], tangent.offset[i] = b[0], damping, b[2]
    coefficients, n_events = laws.events.coefficients, 0
    for e in range(coefficients.shape[1]):
        on_d, on_v, constant = b[3 + 3 * e], b[4 + 3 * e], b[5 + 3 * e]
        coefficients[i, e, 0], coefficients[i, e, 1], coefficients[i, e, 2] = on_d, on_v, constant
        if on_d != 0.0 or on_v != 0.0:
            n_events = e + 1
    laws.events.n_events[i] = n_events


def law_work(laws: Laws, rules: RuleFunctions, i: int, d: float) -> float:
    """Return the work done on law `i` so far, dashpots excluded."""
    state = laws.state
    before: float = state.entry_work[i]
    if laws.definition.curved[i]:
        return before + curved_force(laws, rules, i, d, 0.0)[3]
    mean = 0.5 * laws.tangent.stiffness[i] * (d + state.entry_deformation[i]) + laws.tangent.offset[i]
    done: float = before + mean * (d - state.entry_deformation[i])
    return done


def law_force(laws: Laws, rules: RuleFunctions, i: int, d: float, v: float) -> float:
    """Return the force of law `i`."""
    if laws.definition.curved[i]:
        c = curved_force(laws, rules, i, d, v)
        return c[0] + proportional_damping(laws, i, c[1]) * v
    return linear_force(laws.tangent, i, d, v)


def dissipative_force(laws: Laws, rules: RuleFunctions, i: int, d: float, v: float) -> float:
    """Return the dissipative force of law `i` at the rate `v`: its rate-dependent part and proportional
    dashpots.
    """
    definition = laws.definition
    if not definition.curved[i]:
        dashpot: float = laws.tangent.damping[i] * v
        return dashpot
    if v == 0.0:
        return 0.0
    power: float = dissipated_power_of(
        rules,
        definition.rule[i],
        parameters(definition.parameters, i),
        laws.state.branch[i],
        internal(laws.state.internal, i),
        d,
        v,
    )
    return power / v + proportional_damping(laws, i, laws.tangent.stiffness[i]) * v


def leave_branch(laws: Laws, rules: RuleFunctions, i: int, event: int, d: float, v: float) -> None:
    """Change the branch of law `i` by one of its events, at deformation `d` and rate `v`."""
    state, coefficients = laws.state, laws.events.coefficients
    done = law_work(laws, rules, i, d)
    reversal = coefficients[i, event, 0] == 0.0 and coefficients[i, event, 2] == 0.0
    if reversal and abs(d) > state.internal[i, LARGEST_REVERSAL]:
        state.internal[i, LARGEST_REVERSAL] = abs(d)
        state.internal[i, SECANT_STIFFNESS] = max(law_force(laws, rules, i, d, 0.0) / d, 0.0)
    at, m = transition_of(
        rules,
        laws.definition.rule[i],
        parameters(laws.definition.parameters, i),
        state.branch[i],
        internal(state.internal, i),
        event,
        d,
        v,
    )
    state.branch[i], state.entry_deformation[i], state.entry_work[i] = at, d, done
    for j in range(len(m)):
        state.internal[i, j] = m[j]
    enter_branch(laws, rules, i)


def store_normal_force(state: LawState, i: int, force: float, rate: float, v: float) -> None:
    """Set the normal force of coupled law `i` and its rate to those of its contact; zero while the contact
    pulls.

    It pulls only as the bodies part, at a rate `v` below zero; a negative force at touch is rounding.
    """
    state.internal[i, NORMAL_FORCE] = max(force, 0.0)
    state.internal[i, NORMAL_FORCE_RATE] = rate if force >= 0.0 or v > 0.0 else 0.0


def set_normal_force(laws: Laws, i: int, d: float, v: float, a: float) -> None:
    """Compute the normal force of coupled law `i` and its rate from the motion of its contact."""
    j = laws.friction.normal_law[i]
    rate = laws.tangent.stiffness[j] * v + laws.tangent.damping[j] * a
    store_normal_force(laws.state, i, linear_force(laws.tangent, j, d, v), rate, v)


def enter_coupled(laws: Laws, rules: RuleFunctions, i: int) -> None:
    """Copy the branch of coupled law `i` and its event functions into the arrays, with the rates of its
    force and of the limits of its events.

    Both are linear in the normal force N.  So the rates are the differences between the branch at N plus
    its change per unit of time and the branch at N.
    """
    state, coefficients, friction = laws.state, laws.events.coefficients, laws.friction
    force = state.internal[i, NORMAL_FORCE]
    state.internal[i, NORMAL_FORCE] = force + state.internal[i, NORMAL_FORCE_RATE]
    enter_branch(laws, rules, i)
    friction.offset_rate[i] = laws.tangent.offset[i]
    for e in range(coefficients.shape[1]):
        friction.limit_rates[i, e] = coefficients[i, e, 2]
    state.internal[i, NORMAL_FORCE] = force
    enter_branch(laws, rules, i)
    friction.offset_rate[i] -= laws.tangent.offset[i]
    for e in range(coefficients.shape[1]):
        friction.limit_rates[i, e] -= coefficients[i, e, 2]


def update_friction_limits(laws: Laws, rules: RuleFunctions, acceleration: Array) -> None:
    """Update the strengths of the coupled laws at the end of a step."""
    for i in laws.friction.coupled:
        j = laws.friction.normal_law[i]
        a = row_product(laws.definition.rows, j, acceleration)
        set_normal_force(laws, i, laws.trial.deformation[j], laws.trial.rate[j], a)
        enter_coupled(laws, rules, i)


def save_friction_limits(laws: Laws) -> None:
    """Store the limits of the coupled laws and their rates as those at the start of the next step."""
    coefficients, friction = laws.events.coefficients, laws.friction
    for i in friction.coupled:
        for e in range(coefficients.shape[1]):
            friction.limits_at_start[i, e] = coefficients[i, e, 2]
            friction.limit_rates_at_start[i, e] = friction.limit_rates[i, e]


def add_slip_work(laws: Laws, h: float) -> None:
    """Add up the work of the coupled laws that slip, over a step of length `h`."""
    friction = laws.friction
    for i in friction.coupled:
        if laws.tangent.stiffness[i] == 0.0:
            f0, f1 = friction.force[i], laws.tangent.offset[i]
            v0, v1 = laws.now.rate[i], laws.trial.rate[i]
            laws.state.entry_work[i] += h / 6.0 * ((2.0 * f0 + f1) * v0 + (f0 + 2.0 * f1) * v1)
            friction.force[i], laws.state.entry_deformation[i] = f1, laws.trial.deformation[i]


def couple_friction(laws: Laws, rules: RuleFunctions, acceleration: Array, i: int) -> None:
    """Let coupled law `i` engage or release with the contact that presses it, at the present normal
    force.
    """
    friction = laws.friction
    j = friction.normal_law[i]
    d, v, a = laws.now.deformation[j], laws.now.rate[j], row_product(laws.definition.rows, j, acceleration)
    set_normal_force(laws, i, d, v, a)
    if laws.definition.curved[j]:  # its tangent may be that at the end of a trial step
        c = curved_force(laws, rules, j, d, v)
        force = c[0]
        if force == 0.0 == c[1]:  # outside by rounding: the rate is that from inside
            c = curved_force(laws, rules, j, d + EVENT_TOLERANCE * laws.largest.deformation[j], v)
        store_normal_force(laws.state, i, force, c[1] * v + c[2] * a, v)
    pressed = (friction.pressed_branches[i] >> laws.state.branch[j]) & 1
    if pressed != (laws.state.branch[i] != UNCOUPLED):
        event = CONTACT_CLOSES if pressed else CONTACT_OPENS
        leave_branch(laws, rules, i, event, laws.now.deformation[i], laws.now.rate[i])
    enter_coupled(laws, rules, i)
    friction.force[i] = laws.tangent.stiffness[i] * laws.now.deformation[i] + laws.tangent.offset[i]


def linearise_law(laws: Laws, rules: RuleFunctions, i: int, d: float, v: float) -> None:
    """Replace the branch of a curved law by its tangent at deformation `d` and rate `v`."""
    tangent = laws.tangent
    c = curved_force(laws, rules, i, d, v)
    k, proportional = c[1], proportional_damping(laws, i, c[1])
    tangent.stiffness[i], tangent.damping[i] = k, c[2] + proportional
    tangent.offset[i] = c[0] - k * d - c[2] * v


def linearise_laws(laws: Laws, rules: RuleFunctions) -> None:
    """Linearise all curved laws at the start of the step."""
    for i in range(len(laws.definition.rule)):
        if laws.definition.curved[i]:
            linearise_law(laws, rules, i, laws.now.deformation[i], laws.now.rate[i])


def save_state(laws: Laws, i: int) -> None:
    """Save the state of law `i`."""
    state, saved = laws.state, laws.saved.values[i]
    saved[0], saved[1], saved[2] = state.branch[i], state.entry_deformation[i], state.entry_work[i]
    for j in range(state.internal.shape[1]):
        saved[3 + j] = state.internal[i, j]


def restore_state(laws: Laws, rules: RuleFunctions, i: int) -> None:
    """Restore the saved state of law `i`."""
    state, saved = laws.state, laws.saved.values[i]
    state.branch[i], state.entry_deformation[i], state.entry_work[i] = int(saved[0]), saved[1], saved[2]
    for j in range(state.internal.shape[1]):
        state.internal[i, j] = saved[3 + j]
    enter_branch(laws, rules, i)


def event_on_path(laws: Laws, i: int, start: float, end: float, rate: float) -> tuple[int, float]:
    """Return the first event of law `i` on the straight path of deformations from `start` to `end`, at the
    rate of its end, and the deformation there (see `laws.automaton.drive`); -1 if there is none.
    """
    sign = 1.0 if end >= start else -1.0
    best, where = -1, 0.0
    for e in range(laws.events.n_events[i]):
        place = event_place(laws, i, e, start, end, rate)
        if place == place and (best < 0 or (place - where) * sign < 0.0):
            best, where = e, place
    return best, where


def event_place(laws: Laws, i: int, e: int, start: float, end: float, rate: float) -> float:
    """Return the deformation of event `e` of law `i` on such a path; NaN if the event is not met."""
    coefficients = laws.events.coefficients
    sign = 1.0 if end >= start else -1.0
    on_d, on_v, constant = coefficients[i, e, 0], coefficients[i, e, 1], coefficients[i, e, 2]
    if on_d != 0.0:
        constant += on_v * rate
    value, slope = on_d * start + constant, on_d * sign
    rounding = EVENT_TOLERANCE * abs(on_d) * laws.largest.deformation[i]
    if laws.definition.contact[i] and on_d != 0.0 and on_d * end + constant <= rounding:
        return np.nan
    if on_v != 0.0 and on_d == 0.0 and constant == 0.0:
        return np.nan if on_v * sign <= 0.0 or end == start else start
    if value >= 0.0 and (slope > 0.0 or (slope == 0.0 and value > 0.0)):
        return start
    if slope > 0.0 and on_d * end + constant > 0.0:
        place: float = start - value / slope * sign
        return place
    return np.nan
