"""Intervals of samples contain what is known of the functions, as often as they say."""

import math

import numpy as np
import pytest
from scipy.special import ndtr
from scipy.stats import beta
from scipy.stats import t as student

from pound_solve.statistics.distributions import Distribution, Parameters
from pound_solve.statistics.replicates import (
    REPLICATES,
    SAMPLINGS,
    fractiles,
    jackknifed,
    moments,
    share,
    uniform,
)
from pound_solve.statistics.sobol_indices import indices, mixed

TRIALS, LEVEL, LIMIT = 100, 0.95, 2.0
SHARES = np.array([0.05, 0.5, 0.95])
SIGMA = math.sqrt(math.log1p(0.3**2) + 0.5**2)
MU = -0.5 * math.log1p(0.3**2)
#: moments, probability and fractiles of the product of two lognormal variables
MEAN = math.exp(MU + 0.5 * SIGMA**2)
SD = MEAN * math.sqrt(math.expm1(SIGMA**2))
PROBABILITY = ndtr((MU - math.log(LIMIT)) / SIGMA)
FRACTILES = np.exp(MU + SIGMA * np.array([-1.6448536, 0.0, 1.6448536]))


def product(sampling, count, seed):
    """Values of x * exp(y / 2), x lognormal of mean 1 and y standard normal."""
    u = uniform(sampling, count, 2, seed)
    x = Distribution("lognormal", Parameters(1.0, 0.3)).quantile(u[..., 0])
    y = Distribution("normal", Parameters(0.0, 1.0)).quantile(u[..., 1])
    return (x * np.exp(0.5 * y))[..., None]


@pytest.mark.parametrize("sampling", SAMPLINGS)
@pytest.mark.parametrize("count", [64, 256])
def test_intervals_contain_the_truth(sampling, count):
    """Intervals of 95 % in 90 of 100 samples, and those of means get narrower than independent points'."""
    inside, widths = np.zeros(6), []
    for seed in range(TRIALS):
        values = product(sampling, count, seed)
        mean, sd = moments(values, LEVEL)
        probability = share((values >= LIMIT).astype(float), LEVEL)
        for k, (e, true) in enumerate(((mean, MEAN), (sd, SD), (probability, PROBABILITY))):
            inside[k] += e.low <= true <= e.high
        f = fractiles(values, SHARES, LEVEL)
        inside[3:] += (f.low <= FRACTILES) & (f.high >= FRACTILES)
        widths.append(mean.high - mean.low)
    assert inside.min() >= 90, inside
    assert np.mean(widths) < 2.0 * 1.96 * SD / math.sqrt(count)


def test_nothing_hit_is_not_known_to_be_impossible():
    hits = np.zeros((REPLICATES, 8, 1))
    none = share(hits, LEVEL)
    assert (none.value, none.low) == (0.0, 0.0)
    assert none.high == pytest.approx(beta.ppf(0.975, 1, 64), rel=1e-12)
    hits[0, 0, 0] = np.nan  # may have been one
    assert share(hits, LEVEL).high == pytest.approx(beta.ppf(0.975, 2, 63), rel=0.2)
    assert share(hits, LEVEL).high > none.high
    assert np.isnan(share(np.full((8, 8, 1), np.nan), LEVEL).value)


def test_fractiles_of_runs_that_stopped_or_failed():
    values = np.arange(64.0).reshape(REPLICATES, 8, 1)
    values[0, :4] = np.inf
    known = fractiles(values, SHARES, LEVEL)
    assert known.value[2] == np.inf and known.value[1] == 35.0
    values[0, 4:] = np.nan
    unknown = fractiles(values, SHARES, LEVEL)
    assert unknown.low[1] <= known.low[1] and unknown.high[1] >= known.high[1]
    assert unknown.low[0] == -np.inf
    assert np.isnan(fractiles(np.full((8, 8, 1), np.nan), SHARES, LEVEL).value).all()


def test_moments_that_the_values_do_not_give():
    values = np.zeros((REPLICATES, 8, 1))
    values[3, 2] = 7.0
    mean, sd = moments(values, LEVEL)
    assert mean.value == pytest.approx(7.0 / 64.0) and np.isnan([mean.low, mean.high, sd.low]).all()
    values[3, 2] = np.inf
    assert np.isnan(moments(values, LEVEL)).all()
    assert np.isnan(moments(values * np.nan, LEVEL)).all()


def test_values_that_differ_in_one_replicate_only_have_no_interval_that_is_narrow():
    values = np.zeros((REPLICATES, 32, 1))
    values[2] = np.linspace(1.0, 2.0, 32)[:, None]
    mean, sd = moments(values, LEVEL)
    assert mean.low < 0.0 < mean.high and np.isnan([sd.low, sd.high]).all()


def test_the_interval_of_a_mean_is_students():
    """With 2 / (2/7 + 3/8) degrees of freedom, see the module."""
    values = np.random.default_rng(1).normal(size=REPLICATES)
    estimate = jackknifed(lambda some: values[some].mean(), LEVEL)
    half = student.ppf(0.975, 2.0 / (2.0 / 7.0 + 3.0 / 8.0)) * values.std(ddof=1) / math.sqrt(REPLICATES)
    mean = values.mean()
    assert estimate == pytest.approx((mean, mean - half, mean + half), rel=1e-9)


#: function of Ishigami and Homma (1990), of three variables between -pi and pi
A, B = 7.0, 0.1
PARTS = np.array([0.5 * (1.0 + B * math.pi**4 / 5.0) ** 2, A**2 / 8.0, 8.0 * B**2 * math.pi**8 / 225.0])
FIRST = np.array([PARTS[0], PARTS[1], 0.0, 0.0]) / PARTS.sum()
TOTAL = np.array([PARTS[0] + PARTS[2], PARTS[1], PARTS[2], 0.0]) / PARTS.sum()


def ishigami(u):
    x = 2.0 * math.pi * u - math.pi
    return (np.sin(x[..., 0]) + A * np.sin(x[..., 1]) ** 2 + B * x[..., 2] ** 4 * np.sin(x[..., 0]))[
        ..., None
    ]


def of_ishigami(sampling, count, seed):
    u = uniform(sampling, count, 6, seed)
    a, b = u[..., :3], u[..., 3:]
    return indices(ishigami(a), ishigami(b), ishigami(mixed(a, b)), LEVEL)


@pytest.mark.parametrize("sampling", SAMPLINGS)
def test_indices_of_ishigami_are_inside_their_intervals(sampling):
    inside = np.zeros((2, 4))
    for seed in range(TRIALS):
        for k, (e, true) in enumerate(zip(of_ishigami(sampling, 256, seed), (FIRST, TOTAL))):
            inside[k] += (e.low <= true + 1e-12) & (true - 1e-12 <= e.high)
    assert inside.min() >= 90, inside


def test_many_points_give_the_closed_form():
    first, total = of_ishigami("sobol", 2**13, 0)
    np.testing.assert_allclose(first.value, FIRST, atol=0.02)
    np.testing.assert_allclose(total.value, TOTAL, atol=0.02)


def test_records_are_one_more_variable():
    """f = x + y * z with records y of -1, 0 and 4: their indices follow by hand."""
    u = uniform("sobol", 2**12, 4, 3)
    a, b = u[..., :2], u[..., 2:]
    y = np.array([-1.0, 0.0, 4.0])

    def f(u):
        return u[..., :1] + y * u[..., 1:2]

    first, total = indices(f(a), f(b), f(mixed(a, b)), LEVEL)
    parts = np.array([1.0, y.mean() ** 2, 12.0 * y.var() / 4.0]) / 12.0
    mixed_part = y.var() / 12.0
    variance = parts.sum() + mixed_part
    np.testing.assert_allclose(first.value, parts / variance, atol=0.01)
    np.testing.assert_allclose(
        total.value, (parts + np.array([0.0, mixed_part, mixed_part])) / variance, atol=0.01
    )
