"""Piecewise-linear laws: what hysteresis rules and contact laws share.

Between events such a law is a spring, a dashpot and a constant:
``f = k d + c v + f0`` with the deformation ``d`` and its rate ``v``.  It leaves this branch when
one of its *exits* ``g = a d + b v + g0`` rises through zero.  An integrator needs no more than that;
it never knows which law it drives, and a law never knows the integrator.  The state is an immutable value,
so a step can be tried and forgotten.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

State = Any  #: a law's memory: a hashable tuple, its first item the branch


class Exit(NamedTuple):
    """Leave the branch when ``d_factor * d + v_factor * v + constant`` rises through zero."""

    d_factor: float
    v_factor: float
    constant: float


class Branch(NamedTuple):
    """One linear piece: ``f = stiffness * d + damping * v + force0`` until an exit is reached."""

    name: str
    stiffness: float
    damping: float
    force0: float
    exits: tuple[Exit, ...]

    def force(self, d: float, v: float) -> float:
        """Force at deformation `d` and rate `v`."""
        return self.stiffness * d + self.damping * v + self.force0


class Law(Protocol):
    """A piecewise-linear force law with memory."""

    def start(self) -> State:
        """Return the virgin state at zero deformation."""
        ...

    def branch(self, state: State) -> Branch:
        """Return the linear piece that `state` is on."""
        ...

    def leave(self, state: State, exit_index: int, d: float) -> State:
        """Return the state after that exit of the branch was reached at deformation `d`."""
        ...

    def stored(self, state: State, d: float) -> float:
        """Return the recoverable energy [F L] at deformation `d`."""
        ...

    def dissipated(self, state: State, d: float) -> float:
        """Return the energy [F L] lost so far by slip or release, dashpots apart."""
        ...


def settle(law: Law, state: State, d: float, v: float) -> State:
    """Leave every branch whose exit is passed already at deformation `d` and rate `v`,
    as at a sudden start.
    """
    for _ in range(10):
        exits = law.branch(state).exits
        passed = [n for n, e in enumerate(exits) if e.d_factor * d + e.v_factor * v + e.constant > 0.0]
        if not passed:
            break
        state = law.leave(state, passed[0], d)
    return state


class NoProgressError(Exception):
    """A law changed branch again and again without moving."""


def follow(law: Law, state: State, d0: float, d1: float, limit: int = 1000) -> State:
    """Drive a law quasi-statically along a straight path from `d0` to `d1`.

    Parameters
    ----------
    law : Law
    state : State
        State at `d0`.
    d0, d1 : float
        Deformations [L] or [rad].
    limit : int
        Most branch changes on the way.

    Returns
    -------
    State
        State at `d1`.

    Raises
    ------
    NoProgressError
        More than `limit` branch changes.
    """
    direction = 1.0 if d1 >= d0 else -1.0
    at = d0
    for _ in range(limit):
        # the rate is infinitely slow, but its sign releases branches that end at a reversal
        first: tuple[float, int] | None = None
        for n, (a, b, c) in enumerate(law.branch(state).exits):
            now = a * at + c
            slope = a * direction
            if b and not a and not c:
                where = at if b * direction > 0 else None
            elif now >= 0 and (slope > 0 or (slope == 0 and now > 0)):
                where = at
            elif slope > 0 and (a * d1 + c) > 0:
                where = at - now / slope * direction
            else:
                where = None
            if where is not None and (first is None or (where - first[0]) * direction < 0):
                first = (where, n)
        if first is None:
            return state
        at = first[0]
        state = law.leave(state, first[1], at)
    raise NoProgressError("the law changed branch again and again")
