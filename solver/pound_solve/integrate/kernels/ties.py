"""Laws that reach the ends of their branches at the same instant.

If only massless unknowns separate such laws, rounding may decide which of them changes branch (see
`integrate.uniqueness`).  A law may also rest at the start of a branch while another one in series yields at
the same force.  Whether it has yielded is then undecided; this is examined when either law reverses.

One order is decided here.  Laws in series at a joint without mass lose their forces at the same instant.
If one of them becomes slack, the others do not deform while it is.  A law whose branch ends at zero force
therefore changes first, as it would with a small mass at the joint.
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.kernels.consistency import lets_go, touches_massless
from pound_solve.integrate.kernels.laws import leave_branch, restore_state, save_state
from pound_solve.integrate.kernels.state import Laws, LinearSystem, Simulation
from pound_solve.laws.functions import Tables

#: share of its largest terms that an event function may lack of an event at the same instant
NEAR_EVENT = 1e-9
STATIONARY_RATE = 1e-4  #: share of its largest rate up to which a law stands still


def event_near(a: float, b: float, c: float, d: float, largest: float) -> bool:
    """Whether the event function ``a d + b v + c`` depends on the deformation alone and is zero at `d`, to
    within a share of its terms at the `largest` deformation so far.
    """
    return b == 0.0 and a != 0.0 and abs(a * d + c) <= NEAR_EVENT * (abs(a) * largest + abs(c))


def event_arrives(a: float, b: float, c: float, d: float, v: float, largest: float) -> bool:
    """Whether such an event function is zero at the deformation `d` and rises at the rate `v`."""
    return a * v > 0.0 and event_near(a, b, c, d, largest)


def arriving_event(linear: LinearSystem, laws: Laws, i: int) -> int:
    """Number of the event of a law that occurs now, if the law holds an unknown without mass; else -1."""
    if laws.contact[i] or laws.curved[i] or laws.normal[i] >= 0 or not touches_massless(linear, laws, i):
        return -1
    d, v, largest = laws.now.deformation[i], laws.now.rate[i], laws.largest_deformation[i]
    for e in range(laws.n_events[i]):
        if event_arrives(laws.events[i, e, 0], laws.events[i, e, 1], laws.events[i, e, 2], d, v, largest):
            return e
    return -1


def becomes_slack(linear: LinearSystem, laws: Laws, rules: Tables, i: int, event: int) -> bool:
    """Whether a law that holds an unknown without mass has neither stiffness nor force after an event, and
    loses no force by it.
    """
    d, v, k, f0 = laws.now.deformation[i], laws.now.rate[i], laws.stiffness[i], laws.offset[i]
    if laws.contact[i] or laws.curved[i] or not touches_massless(linear, laws, i):
        return False
    save_state(laws, i)
    leave_branch(laws, rules, i, event, d, v)
    slack = laws.stiffness[i] == 0.0 and laws.offset[i] == 0.0 and not lets_go(linear, laws, i, k, f0, d)
    restore_state(laws, rules, i)
    laws.saved[i] = 0
    return slack


def event_before_slack(sim: Simulation, rules: Tables, law: int, event: int) -> tuple[int, int]:
    """Law and event to be taken first where `law` becomes slack by its `event`: those of another law that
    comes to zero force at the same instant and keeps a stiffness (see the module's head); else the given
    ones.
    """
    linear, laws = sim.linear, sim.laws
    if laws.stiffness[law] != 0.0 and becomes_slack(linear, laws, rules, law, event):
        for i in range(len(laws.rule)):
            e = arriving_event(linear, laws, i) if i != law else -1
            if e >= 0 and not becomes_slack(linear, laws, rules, i, e):
                return i, e
    return law, event


def branch_begun(linear: LinearSystem, laws: Laws, rules: Tables, i: int, turns: bool) -> int:
    """Branch at whose beginning law `i` stands, as it `turns` or else rests; -1 for none, and for laws that
    hold no unknown without mass.
    """
    if laws.contact[i] or laws.curved[i] or laws.normal[i] >= 0 or not touches_massless(linear, laws, i):
        return -1
    d, v, largest = laws.now.deformation[i], laws.now.rate[i], laws.largest_deformation[i]
    entered = abs(d - laws.entry_deformation[i]) <= NEAR_EVENT * largest
    if not turns and (entered or abs(v) > STATIONARY_RATE * laws.largest_rate[i]):
        return -1
    for e in range(laws.n_events[i]):
        if event_near(laws.events[i, e, 0], laws.events[i, e, 1], laws.events[i, e, 2], d, largest):
            save_state(laws, i)
            leave_branch(laws, rules, i, e, d, v)
            branch: int = laws.branch[i]
            restore_state(laws, rules, i)
            laws.saved[i] = 0
            return branch
    return laws.branch[i] if entered else -1


def note_rests(sim: Simulation, rules: Tables, law: int, event: int) -> None:
    """Record which laws, `law` included, stand at the beginning of a branch as `law` reverses by its
    `event`.
    """
    laws, buffers, run = sim.laws, sim.buffers, sim.run
    turns = laws.events[law, event, 0] == 0.0 and laws.events[law, event, 1] != 0.0
    if not turns or laws.contact[law] or not touches_massless(sim.linear, laws, law):
        return
    for i in range(len(laws.rule)):
        branch = branch_begun(sim.linear, laws, rules, i, i == law)
        if branch >= 0 and run.rests < len(buffers.rests):
            row = buffers.rests[run.rests]
            row[0], row[1], row[2], row[3] = run.time, law, i, branch
            run.rests += 1


def note_ties(sim: Simulation, rules: Tables, law: int, stiffness: float, offset: float) -> None:
    """Record the tangents that the laws have if all that come to their events together with `law` change
    branch; nothing where no other does.

    `law` has just left a branch of that `stiffness` and `offset`.  Where it has become softer, the tangents
    of other laws that become softer are recorded; where its force has fallen, minus infinity and the next
    branch of other laws whose forces fall.
    """
    linear, laws, buffers, run = sim.linear, sim.laws, sim.buffers, sim.run
    plain = not laws.contact[law] and not laws.curved[law]
    fell = lets_go(linear, laws, law, stiffness, offset, laws.now.deformation[law])
    softer = plain and laws.stiffness[law] < stiffness and touches_massless(linear, laws, law)
    if not (fell or softer) or run.tied == len(buffers.ties):
        return
    row, count = buffers.ties[run.tied], 0
    rate = laws.now.rate
    for i in range(len(laws.rule)):
        row[0, i], row[1, i], row[2, i] = laws.stiffness[i], laws.damping[i], 0.0
        e = arriving_event(linear, laws, i) if i != law else -1
        if e < 0:
            continue
        d, v, k, f0 = laws.now.deformation[i], rate[i], laws.stiffness[i], laws.offset[i]
        save_state(laws, i)
        leave_branch(laws, rules, i, e, d, v)
        if fell and lets_go(linear, laws, i, k, f0, d):
            row[0, i], row[1, i], row[2, i] = -np.inf, laws.branch[i], v
            count += 1
        elif not fell and laws.stiffness[i] < k:
            row[0, i], row[2, i] = laws.stiffness[i], v
            count += 1
        restore_state(laws, rules, i)
        laws.saved[i] = 0
    if count > 0:
        row[2, law] = rate[law]
        buffers.tie_time[run.tied] = run.time
        run.tied += 1
