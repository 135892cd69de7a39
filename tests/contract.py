"""The contract of hysteresis rules, clause by clause, each along random paths up to `reach` both ways.

Tolerances are shares of the force and the work that the first stiffness would need for `reach`.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from paths import Walk, pieces, turning_points
from pound_solve.laws.automaton import BranchKind, Law, State, drive

SEEDS = (0, 1, 2)


def close(a: float, b: float, tolerance: float) -> bool:
    return bool(abs(a - b) <= tolerance)


def starts_empty(law: Law, reach: float) -> None:
    """No force and no energy before anything happens."""
    state = law.start()
    assert law.force(state, 0.0)[0] == law.work(state, 0.0) == law.stored(state, 0.0) == 0.0


def trying_changes_nothing(law: Law, reach: float) -> None:
    """The same state gives the same answers, whatever was asked or tried in between."""
    for seed in SEEDS:
        walk = Walk(law)
        for goal in turning_points(seed, reach):
            state, d = walk.state, walk.d
            before = hash(state), law.branch(state), law.force(state, d), law.stored(state, d)
            once = drive(law, state, d, goal)
            drive(law, state, d, d - 2.0 * (goal - d))
            law.transition(state, 0, d)
            again = hash(state), law.branch(state), law.force(state, d), law.stored(state, d)
            assert before == again, "asking changed the law"
            assert once == drive(law, state, d, goal), "asking changed the law"
            walk.move(goal)
            # and the walk, written anew, comes out where `drive` does
            assert once[0] == walk.state[0]
            assert close(law.force(once, goal)[0], walk.force, 1e-12 * law.p[0] * reach)


def force_is_continuous(law: Law, reach: float) -> None:
    """At every exit the force is the same on both sides."""
    for seed in SEEDS:
        walk = Walk(law).move(*turning_points(seed, reach))
        for (before, _, d), (after, again, _) in pairwise(walk.visits):
            assert d == again
            same = close(law.force(before, d)[0], law.force(after, d)[0], 2e-13 * law.p[0] * reach)
            assert same, ("the force jumps", before, after)


def branches_begin_clear_of_their_exits(law: Law, reach: float) -> None:
    """None is above zero where a branch is entered, but for rounding."""
    for seed in SEEDS:
        walk = Walk(law).move(*turning_points(seed, reach))
        for (before, _, _), (state, d, _) in pairwise(walk.visits):
            for e in law.branch(state).events if state is not before else ():
                size = abs(e.on_d) * reach + abs(e.constant)
                assert e.on_d * d + e.constant <= 1e-12 * size, ("an exit is above zero", before, state)


def tangent_is_the_slope_of_the_force(law: Law, reach: float) -> None:
    """On the branch, and on the way itself."""
    h, tried = 1e-6 * reach, 0
    for seed in SEEDS:
        walk = Walk(law)
        for goal in turning_points(seed, reach):
            walk.move(goal)
            state, low, high = walk.visits[-1]
            if abs(high - low) < 10.0 * h:
                continue
            tried += 1
            d, step = 0.5 * (low + high), h if high > low else -h
            f, k, c = law.force(state, d)
            slope = (law.force(state, d + h)[0] - law.force(state, d - h)[0]) / (2.0 * h)
            assert close(slope, k, 1e-6 * law.p[0]), "the tangent is not the slope of the force"
            after = law.force(drive(law, state, d, d + step), d + step)[0]
            halfway = law.force(state, d + 0.5 * step)[1]
            assert close((after - f) / step, halfway, 1e-5 * law.p[0]), (
                "the tangent is not the slope of the force"
            )
            assert c == 0.0
    assert tried > 30


def work_is_the_area_below_the_force(law: Law, reach: float) -> None:
    """And what of it is not stored has been lost."""
    for seed in SEEDS:
        walk, gross = Walk(law), law.p[0] * reach * reach
        for goal in turning_points(seed, reach):
            walk.move(goal)
            assert close(law.work(walk.state, goal), walk.work, 1e-11 * gross), "the work is not the area"
            balance = law.stored(walk.state, goal) + law.dissipated(walk.state, goal)
            assert close(balance, walk.work, 1e-11 * gross), "energy is lost or made"


def taken_off(law: Law, state: State, d: float, reach: float) -> tuple[float, bool]:
    """Work given back while the force is taken off; whether along straight branches only, and no yield."""
    f = law.force(state, d)[0]
    away = -1.0 if f > 0.0 else 1.0
    walk = Walk(law)
    walk.state, walk.d = state, d
    plain = not law.curved
    while walk.force * f > 0.0 and abs(walk.force) > 1e-13 * law.p[0] * reach:
        if abs(walk.d - d) > 10.0 * reach:
            return math.inf, False  # a falling yield line leads away from zero force
        # to the end of the branch, or where its force is gone
        way = pieces(law, walk.state, walk.d, walk.d + 10.0 * reach * away)
        state, low, high = next(s for s in way if s[1] != s[2])
        if law.force(state, high)[0] * f < 0.0:
            inside, outside = low, high
            for _ in range(100):
                middle = 0.5 * (inside + outside)
                if law.force(state, middle)[0] * f > 0.0:
                    inside = middle
                else:
                    outside = middle
            high = inside
        plain = plain and law.rule.branches[state[0]].kind is not BranchKind.YIELDING
        walk.move(high + 1e-14 * reach * away)
    return -walk.work, plain


def stored_energy_comes_back(law: Law, reach: float) -> None:
    """All of it along straight lines; no less where the spring yields back, or is curved, on the way."""
    full, gross = 0, law.p[0] * reach * reach
    for seed in SEEDS:
        walk = Walk(law)
        for goal in turning_points(seed, reach):
            walk.move(goal)
            stored = law.stored(walk.state, goal)
            back, plain = taken_off(law, walk.state, goal, reach)
            assert stored <= back + 1e-10 * gross, "more is stored than comes back"
            if plain:
                full += 1
                assert close(stored, back, 1e-10 * gross), "less is stored than comes back"
    assert full > 5 or law.curved


def closed_loops_dissipate(law: Law, reach: float) -> None:
    """However it began: after some rounds of a loop, what goes in beyond the change of the store is no less
    than nothing.
    """
    rng = np.random.default_rng(5)
    for size in (0.05, 0.2, 0.6, 1.0):
        for seed in SEEDS:
            walk = Walk(law).move(*turning_points(seed, reach, 6))
            ends = size * reach * rng.uniform(-1.0, 1.0), size * reach
            walk.move(*ends * 4)
            before = walk.work - law.stored(walk.state, walk.d)
            walk.move(*ends)
            gain = before - walk.work + law.stored(walk.state, walk.d)
            assert gain <= 1e-11 * law.p[0] * reach * reach, "a closed loop gives energy"


def stopping_on_the_way_changes_nothing(law: Law, reach: float) -> None:
    """A path in two steps is the path in one."""
    rng = np.random.default_rng(7)
    for seed in SEEDS:
        whole, broken = Walk(law), Walk(law)
        for goal in turning_points(seed, reach):
            whole.move(goal)
            broken.move(broken.d + rng.uniform() * (goal - broken.d), goal)
            assert close(broken.force, whole.force, 1e-12 * law.p[0] * reach)
            stored = law.stored(whole.state, goal)
            assert close(law.stored(broken.state, goal), stored, 1e-12 * law.p[0] * reach * reach)


def no_branch_is_steeper_than_stated(law: Law, reach: float) -> None:
    """What takes a share of its elastic deformation from a law of straight branches counts on that."""
    if law.curved:
        return
    most = law.rule.steepest(law.p) * (1.0 + 1e-9)
    for seed in SEEDS:
        for state, d, _ in Walk(law).move(*turning_points(seed, reach)).visits:
            assert law.force(state, d)[1] <= most, ("steeper than stated", state)


def resting_at_its_strength_is_not_yielding(law: Law, reach: float) -> None:
    """Where a motion turns as it comes to a line of yielding, a hair before or beyond, the same follows: in
    series with a spring of the same strength that yields, rounding decides where it turns.
    """
    rng = np.random.default_rng(3)
    kinds = [b.kind for b in law.rule.branches]
    for seed in SEEDS:
        start = law.start()
        for since, goal in pairwise([0.0, *turning_points(seed, reach, 8)]):
            way = [x for x in pieces(law, start, since, goal) if x[1] != x[2]]
            then = [-math.copysign(abs(x), goal - since) for x in rng.uniform(0.0, reach, 1)]
            then += rng.uniform(-reach, reach, 4).tolist()
            for (before, _, end), (after, _, _) in pairwise(way):
                if kinds[after[0]] is not BranchKind.YIELDING or kinds[before[0]] is BranchKind.YIELDING:
                    continue
                forces = []
                for hair in (-1e-13, 0.0, 1e-13):
                    d = end + math.copysign(reach, goal - since) * hair
                    state, own = drive(law, start, since, d), []
                    for a, b in pairwise([d, *then]):
                        state = drive(law, state, a, b)
                        own.append(law.force(state, b)[0])
                    forces.append(own)
                apart = np.ptp(forces, axis=0).max()
                assert close(apart, 0.0, 1e-9 * law.p[0] * reach), ("rounding decides", before, after)
            start = drive(law, start, since, goal)


CLAUSES = (
    starts_empty,
    trying_changes_nothing,
    force_is_continuous,
    branches_begin_clear_of_their_exits,
    tangent_is_the_slope_of_the_force,
    work_is_the_area_below_the_force,
    stored_energy_comes_back,
    closed_loops_dissipate,
    stopping_on_the_way_changes_nothing,
    no_branch_is_steeper_than_stated,
    resting_at_its_strength_is_not_yielding,
)


def keep(law: Law, reach: float) -> set[str]:
    """Hold a law to all clauses; return the branches that it has been on."""
    for clause in CLAUSES:
        clause(law, reach)
    return set().union(*(Walk(law).move(*turning_points(seed, reach)).names for seed in SEEDS))
