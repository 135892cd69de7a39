"""Every hysteresis rule and contact law of the catalog keeps the contract of `pound_solve.laws`.

A new rule or law is tested as soon as its file declares a SPEC: its fields tell what parameters to try.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np
import pytest

from pound_deck.schema import Field, Kind, Spec
from pound_solve.catalog import specs
from pound_solve.laws import Branch, Exit, Law, NoProgressError, follow

K, PLUS, MINUS = 800.0, 12.0, -8.0  #: stiffness and yield forces of the rules: they yield at 15 and -10 mm
REACH = 0.1  #: histories run between plus and minus this
GAPS = (0.01, 0.0, -0.005)  #: of the contacts
MASS = 2.0  #: reduced mass of the contacts


def choices(field: Field) -> list[Any]:
    """A few values of a field: its default, its limits where they are included, and some between."""
    if field.kind is Kind.WORD:
        return list(field.words)
    if field.kind is not Kind.REAL:
        raise AssertionError(f"{field.name}: say here what values a field of kind {field.kind} has")
    low = max(x for x in (field.lo, field.above, -np.inf) if x is not None)
    high = min(x for x in (field.hi, field.below, np.inf) if x is not None)
    if field.unit == "-":
        found = [x for x in (-0.1, 0.0, 0.05, 0.4, 0.9) if low < x < high]
    elif field.unit == "L":
        found = [0.0, 0.004]
    else:  # a stiffness or a dashpot
        found = [60.0]
    found += [x for x in (field.lo, field.hi) if x is not None and x not in found]
    if field.count[1] > 1:
        pairs = [(found[-1], -0.5 * found[-1])] if field.count[1] == 2 else []
        return [(x,) for x in found] + pairs
    return found


def parameter_sets(spec: Spec) -> Iterator[dict[str, Any]]:
    """All mixtures of the fields' choices; of those that may be left out at most one is given at a time."""
    optional = [f for f in spec.fields if f.default is None]
    fixed = [f for f in spec.fields if f.default is not None]
    for values in product(*(choices(f) for f in fixed)):
        base = {f.name: v for f, v in zip(fixed, values)} | {f.name: None for f in optional}
        yield base
        for f in optional:
            for value in choices(f):
                yield base | {f.name: value}


def rules() -> list[Any]:
    found = []
    for spec in specs():
        if spec.family == "hysteresis" and spec.impl is not None:
            for plus, minus in ((PLUS, MINUS), (PLUS, -PLUS)):
                for values in parameter_sets(spec):
                    name = f"{spec.name} {plus}/{minus} {values}"
                    found.append(pytest.param(spec.impl(values, K, plus, minus), values, id=name))
    return found


def contacts() -> list[Any]:
    found = []
    for spec in specs():
        if spec.family == "contact" and spec.impl is not None:
            built = 0
            for gap, values in product(GAPS, parameter_sets(spec)):
                try:
                    law = spec.impl({"GAP": gap, **values}, MASS).law
                except ValueError:  # a mixture that the law refuses
                    continue
                built += 1
                found.append(pytest.param(law, id=f"{spec.name} {gap} {values}"))
            assert built, f"no parameters found for {spec.name}"
    return found


RULES, CONTACTS = rules(), contacts()
rule = pytest.mark.parametrize(("law", "values"), RULES)
contact = pytest.mark.parametrize("law", CONTACTS)


def history(seed: int, count: int = 24) -> list[float]:
    """Turning points of growing, shrinking and small cycles, the first one at zero."""
    rng = np.random.default_rng(seed)
    size = rng.choice([0.2, 0.5, 1.0], count) * REACH
    return [0.0, *(float(x) for x in rng.uniform(-1.0, 1.0, count) * size)]


class Walk:
    """A quasi-static path through a law, branch by branch, with the work done on it."""

    def __init__(self, law: Law) -> None:
        self.law, self.state, self.d, self.work = law, law.start(), 0.0, 0.0
        self.visits: list[tuple[Branch, float, float]] = []  # branch, from, to
        self.forces = [self.force]

    @property
    def force(self) -> float:
        return self.law.branch(self.state).force(self.d, 0.0)

    def move(self, goal: float) -> None:
        """Go to `goal` in small enough pieces that no branch is missed, adding the exact work of each."""
        # the same walk as `follow`, in steps: bisect every step that changes the branch
        stack = [goal]
        while stack:
            to = stack[-1]
            after = follow(self.law, self.state, self.d, to)
            here, there = self.law.branch(self.state), self.law.branch(after)
            if here != there and abs(to - self.d) > 1e-13:
                middle = 0.5 * (self.d + to)
                if middle not in (self.d, to):
                    stack.append(middle)
                    continue
            f0, f1 = here.force(self.d, 0.0), there.force(to, 0.0)
            self.work += 0.5 * (f0 + f1) * (to - self.d)
            self.visits.append((there, self.d, to))
            self.d, self.state = to, after
            self.forces.append(f1)
            stack.pop()


def energy(law: Law, state: Any, d: float) -> float:
    return law.stored(state, d) + law.dissipated(state, d)


@rule
def test_forces_stay_within_the_backbone(law: Law, values: dict[str, Any]) -> None:
    r = values.get("R", 0.0)
    gap = values.get("SLACK", (0.0,))
    gap_plus, gap_minus = gap[0], gap[1] if len(gap) == 2 else -gap[0]
    plus, minus = law.fy_plus, law.fy_minus  # type: ignore[attr-defined]
    for seed in range(2):
        walk = Walk(law)
        for goal in history(seed):
            walk.move(goal)
            assert np.isfinite(walk.force)
            upper = plus + r * K * (goal - gap_plus - plus / K)
            lower = minus + r * K * (goal - gap_minus - minus / K)
            if "SLACK" in values:  # open, it carries nothing
                upper, lower = max(upper, 0.0), min(lower, 0.0)
            assert lower - 1e-9 <= walk.force <= upper + 1e-9
            assert np.isfinite(energy(law, walk.state, goal))


@rule
def test_force_is_continuous(law: Law, values: dict[str, Any]) -> None:
    for seed in range(2):
        walk = Walk(law)
        for goal in history(seed):
            walk.move(goal)
        steps = np.array([abs(b - a) for _, a, b in walk.visits])
        jumps = np.abs(np.diff(walk.forces))
        # no slope is steeper than the first stiffness
        assert (jumps <= K * steps * (1 + 1e-9) + 1e-10).all()


@rule
def test_work_is_stored_or_dissipated(law: Law, values: dict[str, Any]) -> None:
    for seed in range(2):
        walk = Walk(law)
        gross, lost = 0.0, 0.0
        for goal in history(seed):
            walk.move(goal)
            gross = max(gross, abs(walk.work))
            assert energy(law, walk.state, goal) == pytest.approx(walk.work, abs=1e-11 * (1.0 + gross))
            now = law.dissipated(walk.state, goal)
            assert now >= lost - 1e-12 * (1.0 + gross)
            lost = now
        assert lost > 0.0


@rule
def test_closed_loops_dissipate(law: Law, values: dict[str, Any]) -> None:
    rng = np.random.default_rng(5)
    for size in (0.005, 0.02, 0.06, 0.1):
        walk = Walk(law)
        low, high = -size * rng.uniform(0.3, 1.0), size
        for goal in (high, low, high):
            walk.move(goal)
        before = walk.work
        for goal in (low, high):
            walk.move(goal)
        assert walk.work - before >= -1e-12


SYMMETRIC = [
    p
    for p in RULES
    if p.values[0].fy_plus == -p.values[0].fy_minus and len(p.values[1].get("SLACK", (0.0,))) == 1
]


@pytest.mark.parametrize(("law", "values"), SYMMETRIC)
def test_symmetric_parameters_answer_symmetrically(law: Law, values: dict[str, Any]) -> None:
    for seed in range(2):
        one, other = Walk(law), Walk(law)
        for goal in history(seed):
            one.move(goal)
            other.move(-goal)
            assert other.force == pytest.approx(-one.force, abs=1e-10)
            assert other.work == pytest.approx(one.work, abs=1e-10)


def assert_contract(law: Law, path: list[float]) -> None:
    """Values, exits and slopes of a law along a path, the branches entered on the way included."""
    state, d = law.start(), path[0]
    assert law.branch(state).force(0.0, 0.0) == pytest.approx(
        max(0.0, -getattr(law, "gap", 0.0)) * law.branch(state).stiffness
    )
    entered = set()
    for goal in path[1:]:
        # a tried step changes nothing, and hashing and comparing are those of values
        tried = follow(law, state, d, 2.0 * goal - d)
        assert hash(tried) == hash(tuple(tried))
        assert law.branch(state) == law.branch(tuple(state))
        sign = 1.0 if goal > d else -1.0
        for n, exit_ in enumerate(law.branch(state).exits):
            assert isinstance(exit_, Exit)
            if exit_.d_factor * sign <= 0.0:
                continue
            where = -exit_.constant / exit_.d_factor
            if not min(d, goal) < where < max(d, goal):
                continue
            after = law.leave(state, n, where)
            entered.add(law.branch(after).name)
            for again in law.branch(after).exits:
                # at rest, and moving on the way that led here
                size = abs(again.d_factor) * REACH + abs(again.constant)
                assert again.d_factor * where + again.constant <= 1e-12 * size
        after = follow(law, state, d, goal)
        assert after == follow(law, state, d, goal)
        state, d = after, goal
        branch = law.branch(state)
        h = 1e-7
        inside = all(
            abs(e.d_factor * d + e.constant) > 10 * h * abs(e.d_factor) for e in branch.exits if e.d_factor
        )
        if inside and not any(e.v_factor and not e.d_factor for e in branch.exits):
            ahead, behind = (
                law.branch(follow(law, state, d, d + s * h)).force(d + s * h, 0.0) for s in (1, -1)
            )
            assert (ahead - behind) / (2 * h) == pytest.approx(branch.stiffness, abs=1e-5 * K)
            slope = (law.stored(state, d + h) - law.stored(state, d - h)) / (2 * h)
            assert slope == pytest.approx(branch.force(d, 0.0), abs=1e-5 * K * REACH)
    assert entered


@rule
def test_contract_of_a_rule(law: Law, values: dict[str, Any]) -> None:
    for seed in range(3):
        assert_contract(law, history(seed))


@contact
def test_contract_of_a_contact(law: Law) -> None:
    for seed in range(3):
        assert_contract(law, history(seed))


@contact
def test_contact_pushes_and_forgets(law: Law) -> None:
    """Quasi-statically a contact is an elastic stop: the same force on the way in and out."""
    gap, k = law.gap, law.k  # type: ignore[attr-defined]
    state, d = law.start(), 0.0
    for seed in range(2):
        for goal in history(seed):
            state = follow(law, state, d, goal)
            d = goal
            assert law.branch(state).force(d, 0.0) == pytest.approx(k * max(0.0, d - gap), abs=1e-9)
            assert law.stored(state, d) == pytest.approx(0.5 * k * max(0.0, d - gap) ** 2, abs=1e-9)
            assert law.dissipated(state, d) == pytest.approx(0.0, abs=1e-12)


def test_the_catalog_is_not_empty() -> None:
    assert len(RULES) >= 20
    assert len(CONTACTS) >= 20


def test_a_law_that_never_settles_is_stopped() -> None:
    class Restless:
        def start(self) -> tuple[str]:
            return ("here",)

        def branch(self, state: tuple[str]) -> Branch:
            return Branch("here", 1.0, 0.0, 0.0, (Exit(1.0, 0.0, 1.0),))

        def leave(self, state: tuple[str], exit_index: int, d: float) -> tuple[str]:
            return state

        def stored(self, state: tuple[str], d: float) -> float:
            return 0.0

        def dissipated(self, state: tuple[str], d: float) -> float:
            return 0.0

    with pytest.raises(NoProgressError):
        follow(Restless(), ("here",), 0.0, 1.0)
