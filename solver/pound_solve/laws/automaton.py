"""Force laws as automata: the common ground of hysteresis rules and contact laws.

A law is always on one of its *branches*.  A branch has up to three *event functions*
``on_d d + on_v v + constant`` of the deformation ``d`` and its rate ``v``; where one of them rises through
zero, a *transition* to another branch takes place.  On most branches the force is linear, ``f = k d + c v +
f0``; a law with a `curve` computes the force itself.  Integrators need nothing else from a law, and laws do
not depend on the integrators.  The state (the branch and the *internal variables*) is immutable, so a trial
step can be discarded.

The functions of a Rule take and return plain numbers and tuples of fixed length, so that `jit` can compile
the same source.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from enum import IntEnum
from typing import NamedTuple

EVENTS = 3  #: largest number of event functions of a branch
K = 0  #: index of the (initial) stiffness among the parameters of a law
FY, FY_MINUS = 1, 2  #: indices of the yield forces (the negative one is signed) in most hysteresis rules
GAP = 2  #: index of the gap among the parameters of a contact
RESTITUTION = 1  #: index of the restitution among the parameters of a rigid contact
PAST = 1e-12  #: the variable of a smooth rule counts as zero up to this fraction of its scale
AT_END = 1e-9  #: fraction of the deformation by which a law must pass the end of a line to leave it
LOSS_ROUNDING = 1e-14  #: fraction of the energy k d^2 up to which a loss is rounding, as in an elastic law
NORMAL_FORCE, NORMAL_FORCE_RATE = 0, 1  #: internal variables of a law with normal-force coupling
UNCOUPLED = 0  #: branch of such a law while its contact is open
CONTACT_CLOSES, CONTACT_OPENS = 0, 2  #: events by which such a law follows its contact

Numbers = tuple[float, ...]
State = tuple[int, float, float, Numbers]  #: branch; deformation and work at its entry; internal variables

# types of the functions of a Rule; see its docstring
StartFunction = Callable[[Numbers], tuple[int, Numbers]]
BranchFunction = Callable[[Numbers, int, Numbers], Numbers]
TransitionFunction = Callable[[Numbers, int, Numbers, int, float, float], tuple[int, Numbers]]
EnergyFunction = Callable[[Numbers, int, Numbers, float, float], float]
CurveFunction = Callable[[Numbers, int, Numbers, float, float, float], tuple[float, float, float, float]]
PowerFunction = Callable[[Numbers, int, Numbers, float, float], float]
PowerLawNumbers = tuple[float, float, float, float, float, float]
PowerLawFunction = Callable[[Numbers, int, Numbers], PowerLawNumbers]
SmoothNumbers = tuple[float, float, float, float, float, float, float]
SmoothFunction = Callable[[Numbers, int, Numbers, float, float], SmoothNumbers]

NEVER = (0.0, 0.0, -1.0)  #: the event function of an event that never occurs
# event functions of a change of sign of the rate
REVERSAL_DOWN, REVERSAL_UP = (0.0, -1.0, 0.0), (0.0, 1.0, 0.0)


def above(d: float) -> tuple[float, float, float]:
    """Return the event function of a deformation that rises above `d`."""
    return (1.0, 0.0, -d)


def below(d: float) -> tuple[float, float, float]:
    """Return the event function of a deformation that falls below `d`."""
    return (-1.0, 0.0, d)


def passes(x: float, end: float, size: float) -> bool:
    """Return whether the deformation `x` is beyond the `end` of a line by more than the rounding error of a
    value of the given `size`.

    If a spring in series has the same strength and yields, a law rests at the end of its line until the
    motion reverses.  It has not left the line, so its internal variables must not depend on the last digit.
    """
    return x - end > AT_END * size


def linear(
    k: float,
    f0: float,
    first: tuple[float, float, float] = NEVER,
    second: tuple[float, float, float] = NEVER,
    third: tuple[float, float, float] = NEVER,
    c: float = 0.0,
) -> Numbers:
    """Return the branch ``f = k d + c v + f0`` with its event functions as 3 + 3 x 3 numbers."""
    return (k, c, f0, *first, *second, *third)


def on_spring(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the recoverable energy of a law that unloads with its initial stiffness ``p[K]``."""
    return 0.5 * f * f / p[K]


def first_stiffness(p: Numbers) -> float:
    """Return the initial stiffness, for a rule whose first branch is the steepest."""
    return p[K]


def rate_independent(p: Numbers, at: int, m: Numbers, d: float, v: float) -> float:
    """Return zero, the rate-dependent power of a rule whose force does not depend on the rate."""
    return 0.0


def rate_power(curve: CurveFunction, p: Numbers, at: int, m: Numbers, d: float, v: float) -> float:
    """Return the power of the rate-dependent part of a curve's force."""
    return (curve(p, at, m, d, d, v)[0] - curve(p, at, m, d, d, 0.0)[0]) * v


class BranchKind(IntEnum):
    """Kind of a branch; it decides what counts as a yield event or a collision."""

    ELASTIC = 0  #: below yield: loading, unloading or reloading; every branch of a smooth rule
    YIELDING = 1  #: on the yield line; its entry from another kind is a yield event
    SLIPPING = 2  #: friction at its limit
    VISCOUS = 3  #: the force depends on the rate alone
    OPEN = 4  #: without force: a contact that is open, a spring that is slack or has failed
    PRESSED = 5  #: a closed contact; its entry is a collision
    #: a contact without force but with some overlap left; a new pressing continues the same collision
    RELEASED = 6
    HELD = 7  #: a closed rigid contact: the deformation is constant, the force a reaction

    @property
    def closed(self) -> bool:
        """Whether a contact on such a branch is closed."""
        return self in (BranchKind.PRESSED, BranchKind.HELD)

    def named(self, *names: str) -> tuple[BranchType, ...]:
        """Return branches of this kind."""
        return tuple(BranchType(name, self) for name in names)


STRENGTHLESS = "failed"  #: name of the branch of a spring that has lost all its strength permanently


class BranchType(NamedTuple):
    """A branch of a rule: its name, as shown in reports, and its kind."""

    name: str
    kind: BranchKind


@dataclass(frozen=True)
class Rule:
    """A kind of law: functions of its parameters ``p``, present branch ``at`` and internal variables ``m``.

    Attributes
    ----------
    branches : tuple of BranchType
        Names and kinds; ``at`` is an index into them.  A rigid contact has one branch of the kind HELD, on
        which the deformation stays at ``p[GAP]``.  The event functions of that branch are functions of the
        force instead of the deformation, and its entry is an impact with the restitution
        ``p[RESTITUTION]``.
    start : callable
        ``start(p) -> (at, m)``: the virgin state, at zero deformation.
    branch : callable
        ``branch(p, at, m) -> linear(...)``.
    transition : callable
        ``transition(p, at, m, event, d, v) -> (at, m)``: the state after the event with the index `event`,
        at deformation `d` and rate `v`.  The force is continuous unless a dashpot or a release makes it
        jump.
    recoverable : callable
        ``recoverable(p, at, m, d, f) -> energy`` that is recovered when the force `f` is removed.
    curve : callable or None
        ``curve(p, at, m, d0, d, v) -> (force, d force/d d, d force/d v, work since d0)`` of a rule whose
        branches are not linear; `d0` is the deformation at the entry of the branch.
    dissipated_power : callable or None
        ``dissipated_power(p, at, m, d, v) -> power`` that a rule with a `curve` dissipates at the rate `v`.
        None: the power of the rate-dependent part of the force, see `rate_power`.  A linear branch
        dissipates the power ``c v^2``.
    power_law : callable or None
        ``power_law(p, at, m) -> (k, n, c, q, pulls, shift)``: the force of a pressed contact with a `curve`
        is ``k x^n + c x^q v``, where x is the overlap ``d - p[GAP]`` minus `shift`.  Unless `pulls` is
        above zero, the force is zero where this expression would pull.  The force of a damper on a
        nonlinear branch is ``k |v|^n``, where `k` has the sign of the rate.  None: the rule has neither
        form.
    smooth_curve : callable or None
        ``smooth_curve(p, at, m, d, f) -> (w, y, n, a, b, k, q)``: starting from the deformation `d` and the
        force `f`, the force of a rule with a `curve` is ``k d + q w`` plus a constant, with ``dw/dd = (1 +
        a x^n) / (1 + b x^n)``, ``x = w / y``.  The numbers change where `x` falls to zero; a remainder up
        to `PAST` is rounding error.  None: the rule does not have this form.
    steepest : callable
        ``steepest(p) -> stiffness``, an upper bound of the stiffness of all straight branches.
    first_yield : callable or None
        ``first_yield(p) -> (positive, negative)`` deformations at which a virgin spring yields; NaN for a
        side that never does.  None: the yield forces divided by the initial stiffness.
    parameters, variables : int
        Numbers of values in ``p`` and ``m``.
    """

    branches: tuple[BranchType, ...]
    start: StartFunction
    branch: BranchFunction
    transition: TransitionFunction
    recoverable: EnergyFunction = on_spring
    curve: CurveFunction | None = None
    dissipated_power: PowerFunction | None = None
    power_law: PowerLawFunction | None = None
    smooth_curve: SmoothFunction | None = None
    steepest: Callable[[Numbers], float] = first_stiffness
    first_yield: Callable[[Numbers], tuple[float, float]] | None = None
    parameters: int = field(kw_only=True)
    variables: int = field(kw_only=True)

    def __post_init__(self) -> None:
        if self.dissipated_power is not None and self.curve is None:
            raise ValueError("a rule states its power beside a curve only: a linear branch loses c v^2")

    @property
    def rigid(self) -> bool:
        """Whether the law is a rigid contact."""
        return any(b.kind is BranchKind.HELD for b in self.branches)


class EventFunction(NamedTuple):
    """An event occurs where ``on_d * d + on_v * v + constant`` rises through zero."""

    on_d: float
    on_v: float
    constant: float


class Branch(NamedTuple):
    """One linear branch: ``f = stiffness * d + damping * v + force0`` up to its first event."""

    name: str
    kind: BranchKind
    stiffness: float
    damping: float
    force0: float
    events: tuple[EventFunction, ...]

    @property
    def constrains(self) -> bool:
        """Whether a rigid contact holds the deformation."""
        return self.kind is BranchKind.HELD

    def force(self, d: float, v: float) -> float:
        """Return the force at deformation `d` and rate `v`."""
        return self.stiffness * d + self.damping * v + self.force0


@dataclass(frozen=True)
class Law:
    """A force law with internal variables: a Rule with its parameters.

    The energy balance is the same for every rule: the work done on the spring is integrated in closed form
    along each branch, and the part that cannot be recovered is the dissipated energy.
    """

    rule: Rule
    p: Numbers  #: parameters, the (initial) stiffness first; those omitted at the end are zero

    def __post_init__(self) -> None:
        missing = self.rule.parameters - len(self.p)
        if missing < 0:
            raise ValueError(f"a rule of {self.rule.parameters} parameters was given {len(self.p)}")
        object.__setattr__(self, "p", tuple(map(float, self.p)) + (0.0,) * missing)

    @property
    def curved(self) -> bool:
        """Whether the branches are nonlinear."""
        return self.rule.curve is not None

    @property
    def rigid(self) -> bool:
        """Whether the law is a rigid contact."""
        return self.rule.rigid

    def start(self) -> State:
        """Return the virgin state at zero deformation."""
        at, m = self.rule.start(self.p)
        if len(m) != self.rule.variables:
            raise ValueError(f"a rule of {self.rule.variables} internal variables starts with {len(m)}")
        state = (at, 0.0, 0.0, m)
        return (at, 0.0, self.stored(state, 0.0), m)

    def branch(self, state: State) -> Branch:
        """Return the linear branch of `state` (for a curved law: the event functions and a tangent)."""
        k, c, f0, *flat = self.rule.branch(self.p, state[0], state[3])
        events = [EventFunction(*flat[i : i + 3]) for i in range(0, 3 * EVENTS, 3)]
        while events and events[-1] == NEVER:
            events.pop()
        return Branch(*self.rule.branches[state[0]], k, c, f0, tuple(events))

    def force(self, state: State, d: float, v: float = 0.0) -> tuple[float, float, float]:
        """Return the force at deformation `d` and rate `v`, and its derivatives with respect to both."""
        if self.rule.curve is not None:
            return self.rule.curve(self.p, state[0], state[3], state[1], d, v)[:3]
        k, c, f0 = self.rule.branch(self.p, state[0], state[3])[:3]
        return k * d + c * v + f0, k, c

    def dissipated_power(self, state: State, d: float, v: float) -> float:
        """Return the power [F L/T] that the law dissipates at rate `v` and deformation `d`."""
        at, _, _, m = state
        if self.rule.curve is None:
            return self.rule.branch(self.p, at, m)[1] * v * v
        if self.rule.dissipated_power is None:
            return rate_power(self.rule.curve, self.p, at, m, d, v)
        return self.rule.dissipated_power(self.p, at, m, d, v)

    def work(self, state: State, d: float) -> float:
        """Return the work done on the law so far [F L] at deformation `d`, excluding dashpots."""
        at, d0, before, m = state
        if self.rule.curve is not None:
            return before + self.rule.curve(self.p, at, m, d0, d, 0.0)[3]
        k, _, f0 = self.rule.branch(self.p, at, m)[:3]
        return before + (0.5 * k * (d + d0) + f0) * (d - d0)

    def transition(self, state: State, event_index: int, d: float, v: float = 0.0) -> State:
        """Return the state after event `event_index` of the branch, at deformation `d` and rate `v`."""
        at, m = self.rule.transition(self.p, state[0], state[3], event_index, d, v)
        return at, d, self.work(state, d), m

    def stored(self, state: State, d: float) -> float:
        """Return the recoverable energy [F L] at deformation `d`."""
        return self.rule.recoverable(self.p, state[0], state[3], d, self.force(state, d)[0])

    def dissipated(self, state: State, d: float) -> float:
        """Return the energy [F L] lost so far by slip or release, excluding dashpots."""
        lost = self.work(state, d) - self.stored(state, d)
        # ignore a loss within the rounding error of d: an elastic law dissipates nothing
        return lost if abs(lost) > LOSS_ROUNDING * self.p[K] * max(abs(d), abs(state[1])) ** 2 else 0.0


def consistent(law: Law, state: State, d: float, v: float) -> State:
    """Return the state after the transitions of all events that deformation `d` and rate `v` have already
    passed, as at a sudden start.
    """
    for _ in range(10):
        events = law.branch(state).events
        passed = [n for n, e in enumerate(events) if e.on_d * d + e.on_v * v + e.constant > 0.0]
        if not passed:
            break
        state = law.transition(state, passed[0], d, v)
    return state


class NoProgressError(Exception):
    """A law changed branch repeatedly without any motion."""


def drive(law: Law, state: State, d0: float, d1: float, limit: int = 1000) -> State:
    """Drive a law quasi-statically along a straight path from `d0` to `d1`; see `transitions`."""
    after = state
    for change in transitions(law, state, d0, d1, limit=limit):
        after = change[1]
    return after


def transitions(
    law: Law, state: State, d0: float, d1: float, rate: float = 0.0, limit: int = 1000
) -> Iterator[tuple[float, State]]:
    """Yield the changes of branch along a straight path from `d0` to `d1`.

    Parameters
    ----------
    law : Law
    state : State
        State at `d0`.
    d0, d1 : float
        Deformations [L] or [rad].
    rate : float
        Speed along the path.  0: infinitely slow; a branch that ends at a reversal still ends there.
    limit : int
        Largest number of branch changes on the path.

    Yields
    ------
    tuple of float and State
        Deformation at the change, and the state after it.

    Raises
    ------
    NoProgressError
        There are more than `limit` branch changes.
    """
    direction = 1.0 if d1 >= d0 else -1.0
    at, v = d0, direction * rate
    for _ in range(limit):
        places = [event_place(event, at, d1, direction, v) for event in law.branch(state).events]
        reached = [(where, n) for n, where in enumerate(places) if where is not None]
        if not reached:
            return
        at, first = min(reached, key=lambda event: direction * event[0])
        state = law.transition(state, first, at, v)
        yield at, state
    raise NoProgressError("the law changed branch again and again")


def event_place(event: EventFunction, at: float, d1: float, direction: float, v: float) -> float | None:
    """Return the deformation of an event on a straight path from `at` to `d1` at the rate `v`, or None if
    it does not occur.  A reversal occurs at once if the path runs against the branch.
    """
    on_d, on_v, constant = event
    value, slope = on_d * at + on_v * v + constant, on_d * direction
    if on_v and not on_d and not constant:
        return at if on_v * direction > 0 else None
    if value >= 0 and (slope > 0 or (slope == 0 and value > 0)):
        return at
    if slope > 0 and on_d * d1 + on_v * v + constant > 0:
        return at - value / slope * direction
    return None
