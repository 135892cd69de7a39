"""Laws that reach the ends of their branches at the same instant.

If only massless unknowns separate such laws, rounding may decide which of them changes branch (see
`integrate.uniqueness`).  A law may also rest at the start of a branch while another one in series yields at
the same force.  Whether it has yielded is then undecided; this is examined when either law reverses.

One order is decided here.  Laws in series at a massless joint lose their forces at the same instant.
While one of them is slack, the others do not deform.  Therefore a law whose branch ends at zero force
changes first, as it would with a small mass at the joint.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pound_solve.integrate.kernels.consistency import loses_force, touches_massless
from pound_solve.integrate.kernels.law_state import Laws
from pound_solve.integrate.kernels.laws import leave_branch, restore_state, save_state
from pound_solve.integrate.kernels.state import (
    TIE_DAMPING,
    TIE_RATE,
    TIE_STIFFNESS,
    LinearSystem,
    Simulation,
)
from pound_solve.integrate.tolerances import NEAR_EVENT
from pound_solve.laws.functions import RuleFunctions

STATIONARY_RATE = 1e-4  #: fraction of its largest rate up to which a law counts as at rest


class AfterEvent(NamedTuple):
    """What a law would be after an event: its branch, tangent, and whether it would lose a force that holds
    an unknown without mass.
    """

    branch: int
    stiffness: float
    offset: float
    loses_force: bool


def probe_event(linear: LinearSystem, laws: Laws, rules: RuleFunctions, i: int, event: int) -> AfterEvent:
    """Return what law `i` would be after an event at the present instant.  The law is changed for this and
    then restored, so it must not be curved: the tangent of its branch replaces the present one.
    """
    tangent, d = laws.tangent, laws.now.deformation[i]
    k, f0 = tangent.stiffness[i], tangent.offset[i]
    save_state(laws, i)
    leave_branch(laws, rules, i, event, d, laws.now.rate[i])
    after = AfterEvent(
        laws.state.branch[i],
        tangent.stiffness[i],
        tangent.offset[i],
        loses_force(linear, laws, i, k, f0, d),
    )
    restore_state(laws, rules, i)
    return after


def event_near(a: float, b: float, c: float, d: float, largest: float) -> bool:
    """Return whether the event function ``a d + b v + c`` depends on the deformation alone and is zero at
    `d`, within a fraction of its terms at the `largest` deformation so far.
    """
    return b == 0.0 and a != 0.0 and abs(a * d + c) <= NEAR_EVENT * (abs(a) * largest + abs(c))


def event_arrives(a: float, b: float, c: float, d: float, v: float, largest: float) -> bool:
    """Return whether such an event function is zero at the deformation `d` and rises at the rate `v`."""
    return a * v > 0.0 and event_near(a, b, c, d, largest)


def arriving_event(linear: LinearSystem, laws: Laws, i: int) -> int:
    """Return the event of law `i` that occurs now, if it holds a massless unknown; else -1."""
    definition, coefficients = laws.definition, laws.events.coefficients
    if (
        definition.contact[i]
        or definition.curved[i]
        or laws.friction.normal_law[i] >= 0
        or not touches_massless(linear, definition.rows, i)
    ):
        return -1
    d, v, largest = laws.now.deformation[i], laws.now.rate[i], laws.largest.deformation[i]
    for e in range(laws.events.n_events[i]):
        if event_arrives(
            coefficients[i, e, 0], coefficients[i, e, 1], coefficients[i, e, 2], d, v, largest
        ):
            return e
    return -1


def becomes_slack(linear: LinearSystem, laws: Laws, rules: RuleFunctions, i: int, event: int) -> bool:
    """Return whether a law that holds a massless unknown has neither stiffness nor force after an
    event, and loses no force by it.
    """
    definition = laws.definition
    if definition.contact[i] or definition.curved[i] or not touches_massless(linear, definition.rows, i):
        return False
    after = probe_event(linear, laws, rules, i, event)
    return after.stiffness == 0.0 and after.offset == 0.0 and not after.loses_force


def event_before_slack(sim: Simulation, rules: RuleFunctions, law: int, event: int) -> tuple[int, int]:
    """Return the law and event to be taken first if `law` becomes slack by its `event`.  They are those of
    another law that reaches zero force at the same instant and keeps a stiffness (see the module
    docstring), else the given ones.
    """
    linear, laws = sim.linear, sim.laws
    if laws.tangent.stiffness[law] != 0.0 and becomes_slack(linear, laws, rules, law, event):
        for i in range(len(laws.definition.rule)):
            e = arriving_event(linear, laws, i) if i != law else -1
            if e >= 0 and not becomes_slack(linear, laws, rules, i, e):
                return i, e
    return law, event


def branch_begun(linear: LinearSystem, laws: Laws, rules: RuleFunctions, i: int, reverses: bool) -> int:
    """Return the branch at whose start law `i` is, as it `reverses` or else rests; -1 for none, and for
    laws that hold no massless unknown.
    """
    definition, coefficients, state = laws.definition, laws.events.coefficients, laws.state
    if (
        definition.contact[i]
        or definition.curved[i]
        or laws.friction.normal_law[i] >= 0
        or not touches_massless(linear, definition.rows, i)
    ):
        return -1
    d, v, largest = laws.now.deformation[i], laws.now.rate[i], laws.largest.deformation[i]
    entered = abs(d - state.entry_deformation[i]) <= NEAR_EVENT * largest
    if not reverses and (entered or abs(v) > STATIONARY_RATE * laws.largest.rate[i]):
        return -1
    for e in range(laws.events.n_events[i]):
        if event_near(coefficients[i, e, 0], coefficients[i, e, 1], coefficients[i, e, 2], d, largest):
            return probe_event(linear, laws, rules, i, e).branch
    return state.branch[i] if entered else -1


def note_rests(sim: Simulation, rules: RuleFunctions, law: int, event: int) -> None:
    """Record which laws, `law` included, are at the start of a branch as `law` reverses by its `event`."""
    laws, buffers, run = sim.laws, sim.buffers, sim.run
    definition, coefficients = laws.definition, laws.events.coefficients
    reverses = coefficients[law, event, 0] == 0.0 and coefficients[law, event, 1] != 0.0
    if not reverses or definition.contact[law] or not touches_massless(sim.linear, definition.rows, law):
        return
    for i in range(len(definition.rule)):
        branch = branch_begun(sim.linear, laws, rules, i, i == law)
        if branch >= 0 and run.n_rests < len(buffers.rests):
            row = buffers.rests[run.n_rests]
            row[0], row[1], row[2], row[3] = run.time, law, i, branch
            run.n_rests += 1


def note_ties(sim: Simulation, rules: RuleFunctions, law: int, stiffness: float, offset: float) -> None:
    """Record the tangents of the laws if all that reach their events together with `law` change branch.
    Nothing is recorded if there is no other.

    `law` has just left a branch with the given `stiffness` and `offset`.  If it has become softer, the
    tangents of other laws that become softer are recorded.  If it has lost its force, minus infinity and
    the next branch are recorded for other laws that lose their forces.
    """
    linear, laws, buffers, run = sim.linear, sim.laws, sim.buffers, sim.run
    definition, tangent = laws.definition, laws.tangent
    plain = not definition.contact[law] and not definition.curved[law]
    lost_force = loses_force(linear, laws, law, stiffness, offset, laws.now.deformation[law])
    softer = plain and tangent.stiffness[law] < stiffness and touches_massless(linear, definition.rows, law)
    if not (lost_force or softer) or run.n_ties == len(buffers.ties):
        return
    row, count = buffers.ties[run.n_ties], 0
    rate = laws.now.rate
    for i in range(len(definition.rule)):
        row[TIE_STIFFNESS, i], row[TIE_DAMPING, i], row[TIE_RATE, i] = (
            tangent.stiffness[i],
            tangent.damping[i],
            0.0,
        )
        e = arriving_event(linear, laws, i) if i != law else -1
        if e < 0:
            continue
        k, after = tangent.stiffness[i], probe_event(linear, laws, rules, i, e)
        if lost_force and after.loses_force:
            row[TIE_STIFFNESS, i], row[TIE_DAMPING, i], row[TIE_RATE, i] = -np.inf, after.branch, rate[i]
            count += 1
        elif not lost_force and after.stiffness < k:
            row[TIE_STIFFNESS, i], row[TIE_RATE, i] = after.stiffness, rate[i]
            count += 1
    if count > 0:
        row[TIE_RATE, law] = rate[law]
        buffers.tie_time[run.n_ties] = run.time
        run.n_ties += 1
