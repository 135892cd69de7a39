r"""Friction in a power series: kernels.

A sliding face has the force :math:`\pm\mu_d N`, a series like the contact force N; a sticking face is a
linear spring.  Its limit :math:`\mu_s N` and the rate of that limit are series too, so that slip and stick
(see `laws.contact.friction`) begin where polynomials first rise above zero, as all other branches do.
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.events.polynomial_roots import POLYNOMIAL, first_rise
from pound_solve.integrate.events.protocol import LocatedEvent, earlier, no_event
from pound_solve.integrate.kernels.allocation import inverse_index
from pound_solve.integrate.kernels.law_state import Laws, LawState
from pound_solve.integrate.kernels.laws import curved_force, linear_force
from pound_solve.integrate.kernels.products import add_row
from pound_solve.integrate.series.force_events import LIFT
from pound_solve.integrate.series.power_contacts import PRESSED
from pound_solve.integrate.series.springs import deformation_term
from pound_solve.integrate.series.state import Extent, Friction, Series
from pound_solve.integrate.tolerances import EVENT_TOLERANCE
from pound_solve.laws.automaton import CONTACT_CLOSES, CONTACT_OPENS, NORMAL_FORCE, NORMAL_FORCE_RATE
from pound_solve.laws.contact.friction import ANCHOR, MINUS, OPEN, PLUS
from pound_solve.laws.functions import RuleFunctions
from pound_solve.numerics.types import Array, Index

KT, MU, MUD = range(3)  #: indices of parameters
OVERDUE = 1e-9  #: fraction of its terms above which an event function has jumped with the normal force


def allocate(laws: Index, normal: Index, n_laws: int, n_coefs: int) -> Friction:
    """Lay out the friction `laws` for series of `n_coefs` coefficients.

    The forces of the laws `normal` are the normal forces.
    """
    return Friction(
        laws=laws,
        index_of=inverse_index(laws, n_laws),
        normal=normal,
        sliding_direction=np.zeros(len(laws)),
        pressing=np.ones(len(laws), bool),
        normal_force=np.zeros((len(laws), n_coefs)),
        force=np.zeros((len(laws), n_coefs)),
        largest=np.zeros(len(laws)),
    )


def set_sliding_direction(state: LawState, friction: Friction, i: int) -> None:
    """Set the direction in which friction law `i` slides on its branch: +1, -1, or 0 if it does not."""
    at = state.branch[i]
    friction.sliding_direction[friction.index_of[i]] = 1.0 if at == PLUS else -1.0 if at == MINUS else 0.0


def is_sliding(friction: Friction, i: int) -> bool:
    """Return whether law `i` is friction that slides."""
    return bool(friction.index_of[i] >= 0 and friction.sliding_direction[friction.index_of[i]] != 0.0)


def normal_force_term(laws: Laws, series: Series, r: int, k: int, h: float, n_powers: int) -> float:
    """Return coefficient `k` of the normal force of friction `r`."""
    tangent = laws.tangent
    j, contacts = series.friction.normal[r], series.power_contacts
    row = contacts.index_of[j]
    if row >= 0:
        force: float = contacts.force[row, k] if contacts.phase[row] == PRESSED else 0.0
        return force
    linear: float = tangent.stiffness[j] * deformation_term(laws.definition, series, k, n_powers, j)
    if tangent.damping[j] != 0.0:
        term = deformation_term(laws.definition, series, k + 1, n_powers, j)
        linear += tangent.damping[j] * (k + 1) / h * term
    return linear + tangent.offset[j] if k == 0 else linear


def add_friction(laws: Laws, series: Series, k: int, h: float, n_powers: int, new: Array) -> None:
    """Add coefficients `k` of the friction forces to the right side `new` of coefficients `k` + 2."""
    friction = series.friction
    for r in range(len(friction.laws)):
        i = friction.laws[r]
        if laws.state.branch[i] == OPEN:
            continue
        friction.normal_force[r, k] = normal_force_term(laws, series, r, k, h, n_powers)
        if friction.sliding_direction[r] != 0.0:
            share = (
                friction.sliding_direction[r] * laws.definition.parameters[i, MUD]
                if friction.pressing[r]
                else 0.0
            )
            friction.force[r, k] = share * friction.normal_force[r, k]
            add_row(laws.definition.rows, i, -h * h * friction.force[r, k], new)


def update_friction(laws: Laws, series: Series, degree: int, s: float, h: float) -> None:
    """Set the normal forces of the friction laws, and the forces of sliding, to those at the place `s`."""
    state, friction = laws.state, series.friction
    for r in range(len(friction.laws)):
        i = friction.laws[r]
        if state.branch[i] == OPEN:
            continue
        force, rate = 0.0, 0.0
        for k in range(degree - 2, -1, -1):
            rate = rate * s + force
            force = force * s + friction.normal_force[r, k]
        state.internal[i, NORMAL_FORCE], state.internal[i, NORMAL_FORCE_RATE] = max(force, 0.0), rate / h
        friction.largest[r] = max(friction.largest[r], force)
        if friction.sliding_direction[r] != 0.0:
            laws.tangent.offset[i] = (
                friction.sliding_direction[r] * laws.definition.parameters[i, MUD] * max(force, 0.0)
            )


def touch_event(laws: Laws, rules: RuleFunctions, friction: Friction, r: int) -> int:
    """Set the normal force of friction `r` after a change of its contact, and return the event that
    follows; -1 for none.
    """
    state = laws.state
    i, j = friction.laws[r], friction.normal[r]
    pressed = (laws.friction.pressed_branches[i] >> state.branch[j]) & 1
    if bool(pressed) == (state.branch[i] != OPEN):
        return -1
    d, v = laws.now.deformation[j], laws.now.rate[j]
    force, rate = linear_force(laws.tangent, j, d, v), laws.tangent.stiffness[j] * v
    if laws.definition.curved[j]:
        response = curved_force(laws, rules, j, d, v)
        force, rate = response[0], response[1] * v
    friction.pressing[r] = force >= 0.0
    state.internal[i, NORMAL_FORCE], state.internal[i, NORMAL_FORCE_RATE] = max(force, 0.0), rate
    return CONTACT_CLOSES if pressed else CONTACT_OPENS


def lift_event(series: Series, degree: int, end: float, i: int) -> LocatedEvent:
    """Return when the contact of friction `i` begins to pull, or to press again; law -1 for none."""
    friction, p = series.friction, series.polynomial[POLYNOMIAL]
    r = friction.index_of[i]
    sign = -1.0 if friction.pressing[r] else 1.0
    for k in range(degree + 1):
        p[k] = sign * friction.normal_force[r, k] if k < degree - 1 else 0.0
    at = first_rise(series.polynomial, degree, end, EVENT_TOLERANCE * friction.largest[r])
    return earlier(no_event(end), i, LIFT, at)


def friction_event(laws: Laws, series: Series, extent: Extent, i: int) -> LocatedEvent:
    """Return the first event of friction law `i` before the place `end`, see `no_event`."""
    friction, d, p = series.friction, series.deformation, series.polynomial[POLYNOMIAL]
    r, parameters = friction.index_of[i], laws.definition.parameters[i]
    if laws.state.branch[i] == OPEN:
        return no_event(extent.end)
    degree, h = extent.degree, extent.h
    first = lift_event(series, degree, extent.end, i)
    sliding, pressing = friction.sliding_direction[r] != 0.0, 1.0 if friction.pressing[r] else 0.0
    for e in range(1 if sliding else 2):
        sign = friction.sliding_direction[r] if sliding else 1.0 - 2.0 * e
        for k in range(degree + 1):
            p[k] = 0.0
        if sliding:  # the slider would turn back
            scale, share = laws.largest.rate[i], pressing * parameters[MUD] / parameters[KT]
            for k in range(degree - 2):
                p[k] = (k + 1) / h * (share * friction.normal_force[r, k + 1] - sign * d[i, k + 1])
        else:  # the spring reaches the limit
            scale = parameters[KT] * laws.largest.deformation[i] + parameters[MU] * friction.largest[r]
            for k in range(degree - 1):
                p[k] = (
                    sign * parameters[KT] * d[i, k]
                    - pressing * parameters[MU] * friction.normal_force[r, k]
                )
            p[0] -= sign * parameters[KT] * laws.state.internal[i, ANCHOR]
        if p[0] > OVERDUE * scale:
            return LocatedEvent(i, e, 0.0)
        at = first_rise(series.polynomial, degree, first.time, EVENT_TOLERANCE * scale)
        first = earlier(first, i, e, at)
    return first
