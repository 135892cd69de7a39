"""Laws that come to the end of their branches at one instant: where unknowns without mass stand between
them, which of them goes on may hang on rounding (see `integrate.uniqueness`).
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.kernels.consistency import lets_go, touches_massless
from pound_solve.integrate.kernels.laws import leave_branch, restore_state, save_state
from pound_solve.integrate.kernels.state import Simulation
from pound_solve.laws.functions import Tables

TIED = 1e-9  #: share of its largest terms that an event function may lack of an event at the same instant


def event_arrives(a: float, b: float, c: float, d: float, v: float, largest: float) -> bool:
    """Whether the event function ``a d + b v + c`` of a deformation alone comes to zero at `d` and the rate
    `v`, where the largest deformation so far is `largest`.
    """
    near = abs(a * d + c) <= TIED * (abs(a) * largest + abs(c))
    return b == 0.0 and a * v > 0.0 and near


def note_ties(sim: Simulation, rules: Tables, law: int, stiffness: float, offset: float) -> None:
    """Keep what becomes of the laws if all go on that come to their events together with `law`; nothing
    where none does.

    It has just left a branch of that `stiffness` and `offset`.  Where it has become softer, these are other
    laws that do, and their tangents; where its force has fallen, other laws whose forces fall: minus
    infinity, and the branch that they go to.
    """
    linear, laws, buffers, run = sim.linear, sim.laws, sim.buffers, sim.run
    plain = not laws.contact[law] and not laws.curved[law]
    fell = lets_go(linear, laws, law, stiffness, offset, laws.now.deformation[law])
    softer = plain and laws.stiffness[law] < stiffness and touches_massless(linear, laws, law)
    if not (fell or softer) or run.tied == len(buffers.ties):
        return
    row, found = buffers.ties[run.tied], 0
    rate = laws.now.rate
    for i in range(len(laws.rule)):
        row[0, i], row[1, i], row[2, i] = laws.stiffness[i], laws.damping[i], 0.0
        if i == law or laws.contact[i] or laws.curved[i] or laws.normal[i] >= 0:
            continue
        d, v, k, f0 = laws.now.deformation[i], rate[i], laws.stiffness[i], laws.offset[i]
        for e in range(laws.n_events[i]):
            a, b, c = laws.events[i, e, 0], laws.events[i, e, 1], laws.events[i, e, 2]
            if event_arrives(a, b, c, d, v, laws.largest_deformation[i]) and touches_massless(
                linear, laws, i
            ):
                save_state(laws, i)
                leave_branch(laws, rules, i, e, d, v)
                if fell and lets_go(linear, laws, i, k, f0, d):
                    row[0, i], row[1, i], row[2, i] = -np.inf, laws.branch[i], v
                    found += 1
                elif not fell and laws.stiffness[i] < k:
                    row[0, i], row[2, i] = laws.stiffness[i], v
                    found += 1
                restore_state(laws, rules, i)
                laws.saved[i] = 0
                break
    if found > 0:
        row[2, law] = rate[law]
        buffers.tie_time[run.tied] = run.time
        run.tied += 1
