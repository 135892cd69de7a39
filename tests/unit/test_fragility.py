"""Lognormal fragilities: closed forms, and intervals that hold the truth as often as they say."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import norm
from scipy.stats import t as student

from pound_solve.statistics.fragility import FragilityError, from_capacities, from_cloud, from_stripes

MEDIAN, BETA = 0.8, 0.45
STRIPES = np.array([0.2, 0.4, 0.6, 0.8, 1.0, 1.4, 2.0])


def capacities(rng, n):
    return MEDIAN * np.exp(BETA * rng.standard_normal(n))


def test_known_capacities_give_the_sample_and_the_interval_of_student():
    x = np.log(capacities(np.random.default_rng(4), 12))
    found = from_capacities(np.exp(x), level=0.9)
    half = student.ppf(0.95, 11) * x.std(ddof=1) / math.sqrt(12)
    assert found.median == pytest.approx(math.exp(x.mean()), rel=1e-6)
    assert found.dispersion == pytest.approx(x.std(), rel=1e-6)
    assert found.median_interval == pytest.approx(np.exp(x.mean() + np.array([-half, half])), rel=1e-5)
    assert found.probability(found.intensity(0.16)) == pytest.approx(0.16, rel=1e-12)
    assert found.interval(0.5) == pytest.approx(found.median_interval, rel=1e-6)


def test_records_that_never_reach_the_limit_raise_the_median():
    reached = capacities(np.random.default_rng(4), 12)
    top = float(np.median(reached))
    below = reached[reached < top]
    told = from_capacities(below, np.full(12 - len(below), top))
    assert from_capacities(below).median < 0.8 * told.median
    assert told.median == pytest.approx(top, rel=0.1)


def test_capacities_between_two_levels_count_as_such():
    """The most likely parameters by a search with the distribution function; close levels are as values."""
    x = capacities(np.random.default_rng(4), 30)
    levels = np.array([0.0, 0.5, 0.9, 1.4, 9.0])
    at = np.searchsorted(levels, x)
    found = from_capacities([], [], list(zip(levels[at - 1], levels[at])))

    def unlikely(p):
        z = norm.cdf((np.log(np.maximum(levels, 1e-300)) - p[0]) / math.exp(p[1]))
        return -np.log(z[at] - z[at - 1]).sum()

    best = minimize(unlikely, [-0.2, -0.8], method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-12}).x
    assert (found.median, found.dispersion) == pytest.approx(tuple(np.exp(best)), rel=1e-5)
    close = from_capacities([], [], list(zip(x * (1 - 1e-6), x * (1 + 1e-6))))
    known = from_capacities(x)
    assert (close.median, close.dispersion) == pytest.approx((known.median, known.dispersion), rel=1e-5)


def test_stripes_of_two_intensities_meet_both_shares():
    """Two unknowns and two shares: the curve goes through both."""
    found = from_stripes([0.5, 1.0], [3, 14], [20, 20])
    assert found.probability([0.5, 1.0]) == pytest.approx([0.15, 0.7], rel=1e-5)


def test_a_cloud_gives_the_regression_and_the_interval_of_fieller():
    rng = np.random.default_rng(8)
    x, limit = rng.uniform(-2.0, 1.0, 30), 0.02
    y = math.log(0.01) + 1.2 * x + 0.3 * rng.standard_normal(30)
    found = from_cloud(np.exp(x), np.exp(y), limit)
    (b, a), d = np.polyfit(x, y, 1), math.log(limit)
    rest = y - a - b * x
    assert found.median == pytest.approx(math.exp((d - a) / b), rel=1e-6)
    assert found.dispersion == pytest.approx(rest.std() / b, rel=1e-6)
    s2, xx = rest @ rest / 28, ((x - x.mean()) ** 2).sum()
    for end in found.median_interval:
        m = math.log(end)
        t = (a + b * m - d) / math.sqrt(s2 * (1 / 30 + (m - x.mean()) ** 2 / xx))
        assert abs(t) == pytest.approx(student.ppf(0.975, 28), rel=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["capacities", "stripes", "cloud"])
def test_intervals_hold_the_truth_as_often_as_they_say(kind):
    """1000 trials: the share at a level of 95 % has a standard deviation of 0.7 %."""
    rng, hits, trials = np.random.default_rng(2011), np.zeros(2), 1000
    for _ in range(trials):
        if kind == "capacities":
            x = capacities(rng, 20)
            found = from_capacities(x[x < 1.6], np.full((x >= 1.6).sum(), 1.6))
        elif kind == "stripes":
            of_each = np.full(7, 20)
            share = [np.mean(capacities(rng, 20) < x) for x in STRIPES]
            found = from_stripes(STRIPES, np.round(np.multiply(share, of_each)), of_each)
        else:
            x = np.exp(rng.uniform(-2.0, 0.5, 40))
            # the demand reaches 1 at the median, and its scatter over the slope is the dispersion
            found = from_cloud(x, (x / MEDIAN) ** 1.3 * np.exp(1.3 * BETA * rng.standard_normal(40)), 1.0)
        ends = (found.median_interval, found.dispersion_interval)
        hits += [low <= truth <= high for (low, high), truth in zip(ends, (MEDIAN, BETA))]
    assert (np.abs(hits / trials - 0.95) < 0.025).all(), hits


@pytest.mark.parametrize(
    ("fit", "why"),
    [
        (lambda: from_capacities([0.5]), "1 of 1 records"),
        (lambda: from_capacities([0.5, 0.5], [1.0]), "two capacities that differ"),
        (lambda: from_capacities([0.5, -1.0]), "above zero"),
        (lambda: from_capacities([], [], [(0.5, 1.0)] * 4), "run levels between"),
        (lambda: from_capacities([], [0.5], [(0.0, 0.5), (0.5, 1.0)]), "run levels between"),
        (lambda: from_stripes([1, 2], [0, 20], [20, 20]), "lie apart"),
        (lambda: from_stripes([1, 2, 3], [15, 10, 3], [20, 20, 20]), "does not rise"),
        (lambda: from_cloud([1, 2], [1, 2], 1), "three runs"),
        (lambda: from_cloud([1, 2, 3], [3, 2, 1], 1), "does not rise"),
    ],
)
def test_data_that_determine_nothing_are_refused(fit, why):
    with pytest.raises(FragilityError, match=why):
        fit()


#: counts at intensities, runs at each, and what probit regression on the logarithm gives: exp(-a/b) and 1/b
#: (statsmodels 0.15.0, GLM of the binomial family with the link Probit, converged to 1e-14)
BAKER = (  # the example data that Baker published with the paper of 2015
    [0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9, 1.0],
    [0, 0, 0, 4, 6, 13, 12, 16],
    40,
    (1.07611579464, 0.42923720436),
)
PACKAGE = (  # the example of the public package pyFragility
    [x / 1000 for x in (178, 274, 444, 560, 652, 790, 982, 1246)]
    + [x / 1000 for x in (1564, 2014, 2417, 3021, 3625, 4028, 4431, 5035)],
    [0, 0, 0, 0, 0, 4, 13, 23, 38, 41, 44, 45, 45, 45, 45, 45],
    45,
    (1.21944746820, 0.31006603946),
)


@pytest.mark.parametrize(("intensity", "exceeded", "runs", "peer"), [BAKER, PACKAGE])
def test_stripes_agree_with_probit_regression(intensity, exceeded, runs, peer):
    found = from_stripes(intensity, exceeded, [runs] * len(intensity))
    assert (found.median, found.dispersion) == pytest.approx(peer, rel=1e-7)
