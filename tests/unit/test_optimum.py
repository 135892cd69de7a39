"""Searches for an optimum find those of functions whose optimum is known, within their points."""

import math

import pytest

from pound_solve.statistics.design_variable import DesignVariable
from pound_solve.statistics.optimum import (
    METHODS,
    SPENT,
    DesignLimit,
    OptimumProblem,
    OptimumSearch,
    PointOutcome,
    SearchRules,
    agreement,
)

TOLERANCE = 1e-3


def searched(function, first, limits=(), method="smooth", runs=600, starts=5):
    search = OptimumSearch(
        lambda points: [function(*p) for p in points],
        first,
        limits,
        SearchRules(method, starts, runs, TOLERANCE, 0),
    )
    search.carry_out()
    return search


@pytest.mark.parametrize("method", METHODS)
def test_a_quadratic_function(method):
    best = searched(
        lambda x, y: PointOutcome(1.0 + (x - 0.3) ** 2 + 2.0 * (y - 0.6) ** 2, ()),
        (0.9, 0.1),
        method=method,
    ).best
    assert best.x == pytest.approx((0.3, 0.6), abs=0.02)
    assert best.outcome.objective == pytest.approx(1.0, abs=TOLERANCE)


@pytest.mark.parametrize("method", METHODS)
def test_a_limit_is_active_at_the_optimum(method):
    """2x + y with x*y of at least 0.25: y = 2x = sqrt(1/2)."""
    search = searched(
        lambda x, y: PointOutcome(2.0 * x + y, (x * y,)),
        (0.9, 0.9),
        [DesignLimit("product", 0.25, True)],
        method,
    )
    best = search.best
    assert best.outcome.objective == pytest.approx(math.sqrt(2.0), rel=TOLERANCE)
    assert best.is_feasible and -2.0 * TOLERANCE <= best.excess <= 0.0
    assert best.x == pytest.approx((0.5 * math.sqrt(0.5), math.sqrt(0.5)), abs=0.03)


@pytest.mark.parametrize("method", METHODS)
def test_runs_that_stop_are_avoided(method):
    """Beside a region without results, and with a kink at the optimum."""
    search = searched(
        lambda x, y: PointOutcome(math.inf if x < 0.2 else 1.0 + x + abs(y - 0.5), (1100.0 - 1000.0 * x,)),
        (0.1, 0.9),
        [DesignLimit("force", 800.0, False)],
        method,
    )
    assert search.best.outcome.objective == pytest.approx(1.3, rel=2.0 * TOLERANCE)
    assert math.isfinite(search.best.outcome.objective)


def test_several_optima_are_told_apart():
    search = searched(lambda x: PointOutcome(1.0 + math.sin(9.0 * x) + 0.2 * x, ()), (0.9,))
    assert search.best.x[0] == pytest.approx(0.5211, abs=1e-2)
    same, elsewhere, worse = agreement(search.ends, search.best, TOLERANCE)
    assert same and worse and len(same) + len(elsewhere) + len(worse) == 5
    flat_search = searched(lambda x: PointOutcome(1.0, ()), (0.9,))
    ended = agreement(flat_search.ends, flat_search.best, TOLERANCE)
    assert not ended.worse and ended.same and ended.elsewhere


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("runs", [1, 7, 40])
def test_no_more_points_than_allowed(method, runs):
    asked = []

    def function(x, y):
        asked.append((x, y))
        return PointOutcome(x + y, (x,))

    search = searched(function, (0.9, 0.9), [DesignLimit("x", 0.5, True)], method, runs)
    assert len(asked) == len(set(asked)) == len(search.tried) <= runs
    assert any(end.how == SPENT for end in search.ends) and search.spent
    assert search.best in search.tried.values()


@pytest.mark.parametrize("method", METHODS)
def test_without_a_point_that_satisfies_the_limits_the_nearest_is_best(method):
    best = searched(
        lambda x: PointOutcome(-x, (1.0 + x,)), (0.9,), [DesignLimit("force", 0.5, False)], method, runs=100
    ).best
    assert not best.is_feasible and best.x[0] == pytest.approx(0.0, abs=0.01)


def test_a_search_is_repeated_point_by_point():
    def points(method):
        return list(
            searched(
                lambda x, y: PointOutcome(x * x + y, (x + y,)),
                (0.4, 0.3),
                [DesignLimit("s", 0.4, True)],
                method,
            ).tried
        )

    for method in METHODS:
        assert points(method) == points(method)


def test_limits_and_scales():
    assert DesignLimit("f", 800.0, False).excess(880.0) == pytest.approx(0.1)
    assert DesignLimit("f", 800.0, True).excess(880.0) == pytest.approx(-0.1)
    assert DesignLimit("f", 0.0, False).excess(2.0) == 2.0
    assert DesignLimit("f", 1.0, True).excess(math.inf) == math.inf  # a run that stopped satisfies nothing
    v = DesignVariable("k", 10.0, 1.0, 100.0, True)
    assert v.share(10.0) == pytest.approx(0.5) and v.at(0.5) == 10.0 and v.at(1.0) == 100.0
    assert DesignVariable("k", 4000.0, 1e3, 2e4, True).at(0.462756) == 4000.0  # to the last digit
    assert DesignVariable("g", 0.2, 0.1, 2.0 / 3.0).at(1.0) == 2.0 / 3.0  # not rounded beyond the bound
    problem = OptimumProblem((v,), "k", True, "", (), SearchRules("smooth", 1, 1, TOLERANCE, 0))
    assert problem.values((0.25,)) == (3.1622777,) and problem.sign == -1.0
