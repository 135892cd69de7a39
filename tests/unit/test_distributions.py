"""Distributions of uncertain variables: moments, ends, and the correlations of dependent ones."""

import math

import numpy as np
import pytest
from scipy.special import ndtri
from scipy.stats import norm

from pound_solve.statistics.distributions import Distribution, DistributionError, Parameters, dependent
from pound_solve.statistics.replicates import uniform

MIDDLES = (np.arange(400_000) + 0.5) / 400_000  #: of equal parts of the probability
CASES = (
    ("normal", Parameters(-3.0, 0.7), -3.0, 0.7),
    ("lognormal", Parameters(4000.0, 1200.0), 4000.0, 1200.0),
    ("gumbel", Parameters(0.4, 0.1), 0.4, 0.1),
    ("weibull", Parameters(2.0, 0.5), 2.0, 0.5),
    ("weibull", Parameters(1.0, 0.01), 1.0, 0.01),
    ("gamma", Parameters(2.0, 0.5), 2.0, 0.5),
    ("beta", Parameters(3.0, 0.5, low=2.0, high=5.0), 3.0, 0.5),
    ("uniform", Parameters(low=2.0, high=5.0), 3.5, 3.0 / math.sqrt(12.0)),
    ("triangular", Parameters(mode=3.0, low=2.0, high=5.0), 10.0 / 3.0, math.sqrt(7.0 / 18.0)),
)


@pytest.mark.parametrize("family, parameters, mean, sd", CASES)
def test_moments_are_those_that_are_given(family, parameters, mean, sd):
    values = Distribution(family, parameters).quantile(MIDDLES)
    assert np.all(np.diff(values) > 0.0)
    assert values.mean() == pytest.approx(mean, rel=1e-4)
    assert values.std() == pytest.approx(sd, rel=1e-3)


def test_fractiles_of_closed_form():
    cov = 0.3
    assert Distribution("lognormal", Parameters(4000.0, 1200.0)).quantile(0.5) == pytest.approx(
        4000.0 / math.sqrt(1.0 + cov**2), rel=1e-12
    )
    scale = 0.1 * math.sqrt(6.0) / math.pi
    at = 0.4 - np.euler_gamma * scale - scale * math.log(-math.log(0.84))
    assert Distribution("gumbel", Parameters(0.4, 0.1)).quantile(0.84) == pytest.approx(at, rel=1e-12)


def test_a_truncated_distribution_stays_between_its_ends():
    """The mean of a normal one is that of the textbook."""
    values = Distribution("normal", Parameters(1.0, 0.5, low=0.5, high=3.0)).quantile(MIDDLES)
    a, b = -1.0, 4.0
    mean = 1.0 + 0.5 * (norm.pdf(a) - norm.pdf(b)) / (norm.cdf(b) - norm.cdf(a))
    assert values.min() >= 0.5 and values.max() <= 3.0
    assert values.mean() == pytest.approx(mean, rel=1e-6)


@pytest.mark.parametrize(
    "family, parameters, why",
    [
        ("lognormal", Parameters(-1.0, 0.1), "mean is above zero"),
        ("weibull", Parameters(1.0, 20.0), "coefficient of variation"),
        ("triangular", Parameters(mode=6.0, low=2.0, high=5.0), "mode is 2 to 5"),
        ("beta", Parameters(6.0, 0.1, low=2.0, high=5.0), "between 2 and 5"),
        ("beta", Parameters(3.0, 3.0, low=2.0, high=5.0), "below 1.41421"),
        ("normal", Parameters(0.0, 1.0, low=9.0), "of its probability is between"),
    ],
)
def test_parameters_of_no_distribution(family, parameters, why):
    with pytest.raises(DistributionError, match=why):
        Distribution(family, parameters)


def test_correlations_are_those_of_the_normals():
    """Of lognormal variables themselves they are those of the closed form."""
    matrix = np.array([[1.0, 0.6, 0.0], [0.6, 1.0, -0.3], [0.0, -0.3, 1.0]])
    u = dependent(uniform("sobol", 2**14, 3, 0).reshape(-1, 3), matrix)
    np.testing.assert_allclose(np.corrcoef(ndtri(u).T), matrix, atol=0.01)
    s = [math.sqrt(math.log1p(cov**2)) for cov in (0.3, 0.5)]
    x = [
        Distribution("lognormal", Parameters(1.0, cov)).quantile(u[:, i])
        for i, cov in enumerate((0.3, 0.5))
    ]
    expected = math.expm1(0.6 * s[0] * s[1]) / (0.3 * 0.5)
    assert np.corrcoef(x)[0, 1] == pytest.approx(expected, abs=0.01)
