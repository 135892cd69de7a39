"""Incremental dynamic analysis: hunt and fill on curves that are known."""

import math
from itertools import pairwise

import pytest

from pound_solve.statistics.incremental import (
    FLAT,
    STANDS,
    STOPPED,
    IdaPoint,
    Rules,
    capacity,
    collapse,
    demand_at,
)

from pound_solve.statistics.incremental import ends, next_level  # isort: skip


def trace(demand, rules, first=0.1):
    """All points of a record whose demand is a function of the level."""
    points = [IdaPoint(first, demand(first))]
    while (level := next_level(points, rules)) is not None:
        assert all(abs(level - p.level) > 1e-9 * level for p in points), "no level is run twice"
        points = sorted([*points, IdaPoint(level, demand(level))])
    return points


def linear(level):
    return 0.02 * level


def falls_at(least, of=linear):
    return lambda level: of(level) if level < least else math.inf


def test_hunt_takes_steps_that_grow():
    points = trace(linear, Rules(step=0.1, growth=0.05, runs=5))
    assert [p.level for p in points] == pytest.approx([0.1, 0.2, 0.35, 0.55, 0.8])


def test_a_linear_structure_has_a_straight_line_and_its_capacities():
    rules = Rules(step=0.2, growth=0.1, top=3.0)
    points = trace(linear, rules)
    assert len(points) == rules.runs and points[-1].level == 3.0
    assert set(ends(points, rules)) == {STANDS}
    for demand in (0.004, 0.0137, 0.059):
        assert capacity(points, rules, demand) == pytest.approx((demand / 0.02, demand / 0.02), rel=1e-12)
    assert capacity(points, rules, 0.001) == (0.0, points[0].level)  # nothing was run below
    assert capacity(points, rules, 0.07) == (3.0, math.inf)
    assert demand_at(points, rules, 1.234) == pytest.approx(linear(1.234), rel=1e-12)
    assert math.isnan(demand_at(points, rules, 3.1))


@pytest.mark.parametrize("least", [0.15, 0.33, 0.9, 2.71])
def test_a_collapse_is_bracketed_and_the_rest_fills_the_gaps(least):
    rules = Rules(step=0.1, growth=0.1, runs=16)
    points = trace(falls_at(least), rules)
    stands, falls = collapse(points, rules)
    assert stands < least <= falls and falls - stands <= 0.1 * stands * (1 + 1e-9)
    assert len(points) == 16
    levels = [0.0, *(p.level for p in points if p.level <= stands)]
    widest = max(b - a for a, b in pairwise(levels))
    assert widest <= 0.5 * max(0.1, least)  # the gaps that the hunt had left are halved
    assert capacity(points, rules, math.inf) == (stands, falls)
    assert demand_at(points, rules, falls) == math.inf


def test_a_curve_that_goes_flat_has_collapsed():
    """Beyond level 1 the demand grows ten times faster: the slope is a tenth."""
    points = trace(lambda x: linear(x) if x <= 1.0 else 0.02 + 0.2 * (x - 1.0), Rules(step=0.25, runs=14))
    rules = Rules(step=0.25, runs=14)
    stands, falls = collapse(points, rules)
    assert 0.9 <= stands <= 1.1 * (1 + 1e-9) and FLAT in ends(points, rules)
    assert falls - stands <= 0.1 * stands * (1 + 1e-9)
    assert set(ends(points, Rules(step=0.25, slope=0.0))) == {STANDS}


def test_what_stands_again_above_a_collapse_counts_as_collapsed():
    rules = Rules(step=0.1)
    points = [IdaPoint(0.1, 0.002), IdaPoint(0.2, math.inf), IdaPoint(0.3, 0.005)]
    assert collapse(points, rules) == (0.1, 0.2)
    assert ends(points, rules) == [STANDS, STOPPED, STANDS]
    assert capacity(points, rules, 0.004) == (0.1, 0.2)


def test_counts_and_what_begins_between_two_runs_are_not_interpolated():
    rules = Rules(step=0.1)
    counted = [IdaPoint(0.1, 1.0), IdaPoint(0.2, 3.0), IdaPoint(0.3, 9.0)]
    assert capacity(counted, rules, 2.0, in_steps=True) == (0.1, 0.2)
    assert capacity(counted, rules, 1.0, in_steps=True) == (0.0, 0.1)
    force = [IdaPoint(0.1, 0.0), IdaPoint(0.2, 300.0), IdaPoint(0.3, 500.0)]
    assert capacity(force, rules, 100.0) == (0.1, 0.2)
    assert capacity(force, rules, 400.0) == pytest.approx((0.25, 0.25), rel=1e-12)


def test_levels_follow_from_the_points_alone():
    """Whatever is left of an interrupted analysis, the next level is that of an undisturbed one."""
    rules = Rules(step=0.1, growth=0.1, runs=12)
    demand, points, order = falls_at(0.77), [IdaPoint(0.1, linear(0.1))], [0.1]
    while (level := next_level(points, rules)) is not None:
        order.append(level)
        points = sorted([*points, IdaPoint(level, demand(level))])
    for n in range(1, len(order)):
        assert next_level(sorted(IdaPoint(x, demand(x)) for x in order[:n]), rules) == order[n]
