"""Steps in parts that end at events.  A part that passes an event is shortened until it ends there.  Then
the law changes its branch, the state is made consistent, and the rest of the step follows.
"""

from __future__ import annotations

from pound_solve.integrate.events.protocol import LocatedEvent
from pound_solve.integrate.events.within_step import first_event
from pound_solve.integrate.kernels.recording import store_motion, track_peaks
from pound_solve.integrate.kernels.state import (
    CHATTER,
    DONE,
    LOST_FORCE,
    NOT_CONVERGED,
    PART,
    SINGULAR,
    TOO_MANY_EVENTS,
    WHOLE,
    Piece,
    Scheme,
    Simulation,
)
from pound_solve.integrate.stepping.acceptance import accept_trial
from pound_solve.integrate.stepping.branches import change_branches
from pound_solve.integrate.stepping.factor import factorise_step, invalidate_factor
from pound_solve.integrate.stepping.locating import locate_event
from pound_solve.integrate.stepping.step import restore_start_tangents, try_step
from pound_solve.integrate.tolerances import SAME_INSTANT_OF_STEP
from pound_solve.laws.functions import RuleFunctions

MAX_HALVINGS = 25
MAX_PARTS, MAX_PARTS_PER_LAW = (
    100,
    8,
)  #: parts of a step that may end at one instant: in all, and more per law
#: shortest part, as a fraction of the step, used while laws alternate between branches; longer than an
#: instant (`SAME_INSTANT_OF_STEP`), so that the time advances
SHORTEST_PART = 3e-8


def factorise_part(sim: Simulation, scheme: Scheme, length: float, halvings: int) -> int:
    """Factorise A for a part of a step, halved `halvings` times so far; return DONE or why it fails."""
    bad = factorise_step(sim, scheme, length, PART)
    if bad < 0:
        return DONE
    if halvings > 0:
        return NOT_CONVERGED
    sim.run.failed_unknown = bad
    return SINGULAR


def solve_part(
    sim: Simulation,
    rules: RuleFunctions,
    scheme: Scheme,
    piece: Piece,
    part: float,
    factor: int,
    tried: bool,
) -> tuple[int, float, int]:
    """Solve a part of a step of length `part`, halved until Newton's iterations converge.

    Returns
    -------
    why : int
        DONE or the reason for failure.
    part : float
        Length of the part that was solved [T].
    factor : int
        Row of the factor that was used.
    """
    laws, run = sim.laws, sim.run
    for halvings in range(MAX_HALVINGS + 1):
        if factor == PART:
            # from here on, trials change the tangents of curved laws, but not the nominal factor
            if laws.definition.curved.any():
                invalidate_factor(run)
            why = factorise_part(sim, scheme, part, halvings)
            if why != DONE:
                return why, part, factor
        if tried or try_step(sim, rules, scheme, piece.coefs, run.time + part - piece.begin, part, factor):
            return DONE, part, factor
        invalidate_factor(run)
        restore_start_tangents(sim, rules)
        part, factor = 0.5 * part, PART
    return NOT_CONVERGED, part, factor


def end_part_at_event(
    sim: Simulation,
    rules: RuleFunctions,
    scheme: Scheme,
    piece: Piece,
    part: float,
    h: float,
    event: LocatedEvent,
) -> tuple[int, LocatedEvent]:
    """Shorten a part so that it ends at its first event, see `locate_event`."""
    laws, run = sim.laws, sim.run
    curved = laws.definition.curved.any()
    if curved:  # shorter trials change the tangents, but not the present factor
        invalidate_factor(run)
    why, event = locate_event(sim, rules, scheme, piece, part, h, event)
    if why == DONE and event.time > SAME_INSTANT_OF_STEP * h:
        run.changes_at_instant = 0
    elif why == DONE and event.time == 0.0 and curved:
        restore_start_tangents(sim, rules)  # else forces and tangents of the last trial would be used
    return why, event


def accept_part(sim: Simulation, rules: RuleFunctions, scheme: Scheme, part: float, factor: int) -> None:
    """Make the motion at the end of a part the present one, and record it."""
    accept_trial(sim, rules, scheme, part, factor)
    sim.run.time += part
    track_peaks(sim, sim.run.time, part)
    if factor == PART:
        store_motion(sim, rules, sim.run.time)


def answer_event(
    sim: Simulation, rules: RuleFunctions, scheme: Scheme, h: float, event: LocatedEvent, left: float
) -> int:
    """Change branches at an event that leaves the time `left` of the step; return DONE or why it stops."""
    laws, run = sim.laws, sim.run
    change_branches(sim, rules, scheme, h, event)
    run.changed_law = event.law
    run.changes_at_instant += 1
    n_laws = len(laws.definition.rule)
    if run.changes_at_instant > MAX_PARTS + MAX_PARTS_PER_LAW * n_laws:
        return CHATTER
    if run.changes_at_instant > n_laws:  # a law may alternate: the next part is shorter
        run.longest_part = max(0.5 * min(run.longest_part, left), SHORTEST_PART * h)
    if run.lost_force >= 0:
        run.remaining_step = left
        return LOST_FORCE
    return DONE


def step_in_parts(
    sim: Simulation,
    rules: RuleFunctions,
    scheme: Scheme,
    piece: Piece,
    length: float,
    h: float,
    tried: bool,
) -> int:
    """Advance by `length`, in parts that end at events.  The present factor is for the step `h`; `tried`
    means that the first trial step has been made.

    A part is halved until Newton's method converges.  After the touch of a curved contact the first part
    is short and the next ones grow, because forces begin there like the fourth root of time.  If a law that
    holds a massless joint loses its force, the step stops, and Python moves the joint (see
    `integrate.release`).
    """
    laws, run = sim.laws, sim.run
    left = length
    factor = WHOLE if abs(length - h) <= SAME_INSTANT_OF_STEP * h else PART
    while left > 0.0:
        if len(sim.buffers.log) - run.n_transitions <= len(laws.friction.coupled):
            return TOO_MANY_EVENTS
        part = min(left, run.longest_part)
        factor = factor if part == left else PART
        why, part, factor = solve_part(sim, rules, scheme, piece, part, factor, tried)
        if why != DONE:
            return why
        tried = False
        event = first_event(laws, sim.step, part)
        if event.law >= 0:
            factor = PART
            why, event = end_part_at_event(sim, rules, scheme, piece, part, h, event)
            if why != DONE:
                return why
            part = event.time
        else:
            run.longest_part *= 2.0
        if part > 0.0:
            accept_part(sim, rules, scheme, part, factor)
            left -= part
        factor = PART
        if event.law >= 0:
            why = answer_event(sim, rules, scheme, h, event, left)
            if why != DONE:
                return why
    return DONE
