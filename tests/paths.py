"""Quasi-static paths through a force law, walked event by event; work is found by quadrature of the force.

Written anew beside `pound_solve.laws.automaton.drive`, so that tests of the one see faults of the other.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.integrate import quad

from pound_solve.laws.automaton import Law, State

STALLS = 4  #: most branch changes without motion; no law needs more


def pieces(law: Law, state: State, d0: float, d1: float) -> Iterator[tuple[State, float, float]]:
    """Stretches (state, from, to) of the way from `d0` to `d1`, at least one."""
    direction = 1.0 if d1 >= d0 else -1.0
    at, still = d0, 0
    while True:
        where, which = d1, None
        for n, (a, b, c) in enumerate(law.branch(state).events):
            if a == 0.0:
                reached = at if b * direction > 0.0 and d1 != d0 else None
            else:
                reached = -c / a if a * direction > 0.0 else None
            if reached is None or (reached - d1) * direction >= 0.0:
                continue
            if which is None or (reached - where) * direction < 0.0:
                where, which = (reached if (reached - at) * direction > 0.0 else at), n
        yield state, at, where
        if which is None:
            return
        still = still + 1 if where == at else 0
        assert still <= STALLS, f"{law.branch(state).name}: the law changes branch without moving"
        state, at = law.transition(state, which, where), where


def quadrature(law: Law, state: State, a: float, b: float) -> float:
    """Integral of the force over a stretch of one branch."""
    if not law.curved:
        return 0.5 * (law.force(state, a)[0] + law.force(state, b)[0]) * (b - a)
    # adaptive: a curve may have kinks where its force changes sign
    size = max(abs(law.force(state, x)[0]) for x in (a, b)) * abs(b - a)
    return float(
        quad(lambda x: law.force(state, x)[0], a, b, epsabs=1e-13 * size, epsrel=1e-12, limit=200)[0]
    )


class Walk:
    """A law on its way.

    Attributes
    ----------
    state, d : State, float
        Where it is.
    work : float
        Integral of the force so far.
    visits : list of (State, float, float)
        Stretches behind it.
    """

    def __init__(self, law: Law) -> None:
        self.law, self.state, self.d, self.work = law, law.start(), 0.0, 0.0
        self.visits: list[tuple[State, float, float]] = []

    @property
    def force(self) -> float:
        return self.law.force(self.state, self.d)[0]

    @property
    def names(self) -> set[str]:
        """Branches that it has been on."""
        return {self.law.rule.branches[state[0]].name for state, _, _ in self.visits}

    def move(self, *goals: float) -> Walk:
        """Go to each of `goals` in turn."""
        for goal in goals:
            for stretch in pieces(self.law, self.state, self.d, goal):
                self.work += quadrature(self.law, *stretch)
                self.visits.append(stretch)
            self.state, self.d = stretch[0], goal
        return self


def turning_points(seed: int, reach: float, count: int = 24) -> list[float]:
    """Growing, shrinking and small cycles."""
    rng = np.random.default_rng(seed)
    size = rng.choice([0.2, 0.5, 1.0], count) * reach
    return [float(x) for x in rng.uniform(-1.0, 1.0, count) * size]
