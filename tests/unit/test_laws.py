"""Laws as automata: `pound_solve.laws.automaton` on a toy rule, and the contract of the contact laws of the
catalog.

A new contact law is tested as soon as its file declares a SPEC: its fields tell what parameters to try.
The contract of hysteresis rules is in test_hysteresis_contract.py.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from importlib import import_module
from itertools import product
from pkgutil import walk_packages
from typing import Any

import numpy as np
import pytest

from paths import Walk, turning_points
from pound_deck.schema import Field, Kind, Spec
from pound_solve import laws
from pound_solve.assess.law_test import specimen
from pound_solve.catalog import specs
from pound_solve.laws import functions
from pound_solve.laws.automaton import (
    EVENTS,
    GAP,
    NEVER,
    REVERSAL_DOWN,
    BranchKind,
    EventFunction,
    Law,
    NoProgressError,
    Numbers,
    Rule,
    above,
    below,
    consistent,
    drive,
    linear,
)
from pound_solve.laws.contact import bilinear_impact, table

REACH = 0.1  #: paths run between plus and minus this
GAPS = (0.01, 0.0, -0.005)  #: of the contacts
MASS = 2.0  #: reduced mass of the contacts
#: what the contact's own card says of the bodies
BODIES = {"MASSES": (2 * MASS, 2 * MASS), "DIAPHRAGMS": (60.0, 40.0)}

# ---------------------------------------------------------------------- the machine, on a toy

STAIR, FLAT = 0, 1


def stair_start(p: Numbers) -> tuple[int, Numbers]:
    return STAIR, (0.0,)


def stair_branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Stiffness k above the foot m; flat from the height p[1] on, until the motion turns."""
    k, height = p[:2]
    if at == STAIR:
        return linear(k, -k * m[0], above(m[0] + height / k), below(m[0] - height / k))
    return linear(0.0, height, REVERSAL_DOWN)


def stair_leave(p: Numbers, at: int, m: Numbers, way: int, d: float, v: float) -> tuple[int, Numbers]:
    if at == STAIR:
        return (FLAT, m) if way == 0 else (STAIR, (d,))
    return STAIR, (d - p[1] / p[0],)


STEPS = Law(
    Rule(
        BranchKind.ELASTIC.named("stair", "flat"),
        stair_start,
        stair_branch,
        stair_leave,
        parameters=3,
        variables=1,
    ),
    (100.0, 5.0),
)


def test_numbers_have_the_lengths_that_the_rule_says() -> None:
    assert STEPS.p == (100.0, 5.0, 0.0)  # what is left out is zero
    with pytest.raises(ValueError, match="a rule of 3 parameters was given 4"):
        Law(STEPS.rule, (1.0, 2.0, 3.0, 4.0))
    with pytest.raises(ValueError, match="a rule of 2 internal variables starts with 1"):
        Law(replace(STEPS.rule, variables=2), (100.0, 5.0)).start()
    with pytest.raises(ValueError, match="a rule has 3 parameters and 99 internal variables: the kernels"):
        functions.tables([replace(STEPS.rule, variables=99)])
    flat = linear(1.0, 2.0, c=3.0)
    assert flat == (1.0, 3.0, 2.0, *NEVER * EVENTS)


def test_branch_with_its_events() -> None:
    state = STEPS.start()
    assert state == (STAIR, 0.0, 0.0, (0.0,))
    branch = STEPS.branch(state)
    assert (branch.name, branch.stiffness, branch.damping, branch.force0) == ("stair", 100.0, 0.0, 0.0)
    # trailing event functions that never rise are left out
    assert branch.events == (EventFunction(1.0, 0.0, -0.05), EventFunction(-1.0, 0.0, -0.05))
    assert STEPS.branch(STEPS.transition(state, 0, 0.05)).events == (EventFunction(0.0, -1.0, 0.0),)
    assert STEPS.force(state, 0.02, 7.0) == (2.0, 100.0, 0.0)


def test_work_goes_on_over_branches() -> None:
    flat = STEPS.transition(STEPS.start(), 0, 0.05)
    assert flat == (FLAT, 0.05, pytest.approx(0.125), (0.0,))  # 1/2 * 5 * 0.05
    assert STEPS.work(flat, 0.08) == pytest.approx(0.125 + 5.0 * 0.03)
    assert STEPS.stored(flat, 0.08) == pytest.approx(0.125)
    assert STEPS.dissipated(flat, 0.08) == pytest.approx(0.15)
    back = STEPS.transition(flat, 0, 0.08)
    assert back == (STAIR, 0.08, pytest.approx(0.275), (pytest.approx(0.03),))
    assert STEPS.work(back, 0.03) == pytest.approx(0.275 - 0.125)
    assert STEPS.dissipated(back, 0.03) == pytest.approx(0.15)


def test_rounding_is_no_loss_and_a_loss_is_no_rounding() -> None:
    """Only what is below the rounding of the deformation is taken for nothing."""
    state = (STAIR, 0.04, 0.5 * 100.0 * 0.04**2, (0.0,))
    assert STEPS.dissipated(state, 0.04) == 0.0
    off = 0.9e-14 * 100.0 * 0.04**2
    assert STEPS.dissipated((STAIR, 0.04, state[2] + off, (0.0,)), 0.04) == 0.0
    off = 1.2e-14 * 100.0 * 0.04**2
    assert STEPS.dissipated((STAIR, 0.04, state[2] + off, (0.0,)), 0.04) > 0.0


def test_drive_takes_the_events_on_its_way() -> None:
    state = drive(STEPS, STEPS.start(), 0.0, 0.08)
    assert state[0] == FLAT
    assert drive(STEPS, state, 0.08, 0.09) == state
    down = drive(STEPS, state, 0.08, 0.05)
    assert down[0] == STAIR
    assert STEPS.force(down, 0.05)[0] == pytest.approx(2.0)
    # not left where the path just ends
    assert drive(STEPS, STEPS.start(), 0.0, 0.05) == STEPS.start()


def test_consistent_leaves_a_branch_that_is_passed_already() -> None:
    assert consistent(STEPS, STEPS.start(), 0.02, 0.0) == STEPS.start()
    assert consistent(STEPS, STEPS.start(), 0.08, 1.0)[0] == FLAT
    stationary = consistent(STEPS, STEPS.start(), 0.08, -1.0)
    assert (stationary[0], stationary[3][0]) == (STAIR, pytest.approx(0.03))


def test_a_law_that_never_comes_to_rest_is_stopped() -> None:
    def restless(p: Numbers, at: int, m: Numbers) -> Numbers:
        return linear(1.0, 0.0, above(-1.0))

    def stay(p: Numbers, at: int, m: Numbers, way: int, d: float, v: float) -> tuple[int, Numbers]:
        return at, m

    law = Law(
        Rule(BranchKind.ELASTIC.named("here"), stair_start, restless, stay, parameters=1, variables=1),
        (1.0,),
    )
    with pytest.raises(NoProgressError):
        drive(law, law.start(), 0.0, 1.0)


# ---------------------------------------------------------------------- contacts


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


def contacts() -> list[Any]:
    found = []
    for spec in specs():
        if spec.family == "contact" and spec.impl is not None:
            built = 0
            for gap, values in product(GAPS, parameter_sets(spec)):
                try:
                    made = spec.impl({"GAP": gap, **BODIES, **values}, MASS)
                except ValueError:  # a mixture that the law refuses
                    continue
                built += 1
                assert made.law.p[GAP] == gap, spec.name
                if made.law.rigid:  # no force follows from its deformation, see test_rigid_contact
                    continue
                found.append(pytest.param(made.law, gap, made.k, id=f"{spec.name} {gap} {values}"))
            if not built:  # items that only go together: the law's own example
                spring = specimen(spec, [])[0]
                found.append(pytest.param(spring.law, spring.gap, spring.facts["k"], id=spec.name))
    return found


CONTACTS = contacts()
contact = pytest.mark.parametrize(("law", "gap", "k"), CONTACTS)


def test_the_catalog_is_not_empty() -> None:
    assert len(CONTACTS) >= 20


@pytest.mark.full
@contact
def test_contract_of_a_contact(law: Law, gap: float, k: float) -> None:
    """Values, event functions and slopes along a path, the branches entered on the way included."""
    for seed in range(3):
        state, d = law.start(), 0.0
        if not law.curved:
            assert law.branch(state).force(0.0, 0.0) == pytest.approx(k * max(0.0, -gap))
        entered = set()
        for goal in turning_points(seed, REACH):
            # a tried step changes nothing, and hashing and comparing are those of values
            tried = drive(law, state, d, 2.0 * goal - d)
            assert hash(tried) == hash(tuple(tried))
            assert law.branch(state) == law.branch(tuple(state))
            sign = 1.0 if goal > d else -1.0
            for n, event in enumerate(law.branch(state).events):
                if event.on_d * sign <= 0.0:
                    continue
                where = -event.constant / event.on_d
                if not min(d, goal) < where < max(d, goal):
                    continue
                after = law.transition(state, n, where)
                entered.add(law.branch(after).name)
                for again in law.branch(after).events:
                    # at rest, and moving on the way that led here
                    size = abs(again.on_d) * REACH + abs(again.constant)
                    assert again.on_d * where + again.constant <= 1e-12 * size
            after = drive(law, state, d, goal)
            assert after == drive(law, state, d, goal)
            state, d = after, goal
            branch, h = law.branch(state), 1e-7
            if all(abs(e.on_d * d + e.constant) > 10 * h * abs(e.on_d) for e in branch.events if e.on_d):
                ahead, behind = (law.force(drive(law, state, d, d + s * h), d + s * h)[0] for s in (1, -1))
                force, stiffness, _ = law.force(state, d)
                assert (ahead - behind) / (2 * h) == pytest.approx(stiffness, abs=1e-5 * k)
                slope = (law.stored(state, d + h) - law.stored(state, d - h)) / (2 * h)
                assert slope == pytest.approx(force, abs=1e-5 * k * REACH)
        assert entered


@contact
def test_contact_pushes_and_forgets(law: Law, gap: float, k: float) -> None:
    """Quasi-statically a contact is an elastic stop: the same force on the way in and out."""
    if law.rule in (bilinear_impact.RULE, table.RULE):
        pytest.skip("unloads along another line")

    def once(goal: float) -> tuple[float, float]:
        """Force and energy of the stop pressed once; of a linear one from its stiffness."""
        over = max(0.0, goal - gap)
        if not law.curved:
            return k * over, 0.5 * k * over**2
        fresh = drive(law, law.start(), 0.0, goal)
        return law.force(fresh, goal)[0], law.stored(fresh, goal)

    walk, begin = Walk(law), law.stored(law.start(), 0.0)
    for seed in range(2):
        for goal in turning_points(seed, REACH):
            walk.move(goal)
            force, energy = once(goal)
            assert walk.force == pytest.approx(force, abs=1e-9)
            assert law.stored(walk.state, goal) == pytest.approx(energy, abs=1e-9)
            assert law.work(walk.state, goal) == pytest.approx(begin + walk.work, abs=1e-12)
            assert law.dissipated(walk.state, goal) == pytest.approx(0.0, abs=1e-12)


def test_the_kernels_have_room_for_the_longest_rule_and_no_more():
    """`laws.functions` holds both lengths as constants; every rule of the catalog is looked at."""
    found = []
    for module in walk_packages(laws.__path__, f"{laws.__name__}."):
        rule = getattr(import_module(module.name), "RULE", None)
        found += [] if rule is None else [(rule.parameters, rule.variables)]
    longest = tuple(max(lengths) for lengths in zip(*found))
    assert len(found) > 20
    assert longest == (functions.PARAMETERS, functions.VARIABLES), "set them in laws/functions.py"
