"""Fits by least squares: linear regression in closed form, coverage of intervals, bounds, correlation."""

import numpy as np
import pytest
from scipy.stats import t as student

from pound_solve.statistics.least_squares import autocorrelation_time, correlated, fit

X = np.linspace(0.0, 1.0, 60)
DESIGN = np.c_[np.ones_like(X), X]
TRUE = np.array([0.4, 0.6])
ONE = np.zeros(len(X), int)


def fitted(y, weight=1.0, known=False, start=(0.5, 0.5), design=DESIGN, blocks=ONE):
    return fit(
        lambda p: weight * (design @ p - y), lambda p: weight * design, np.array(start), blocks, known, 0.95
    )


def noise(seed, sd, rho=0.0):
    """Errors, of which each is correlated with the one before."""
    rng = np.random.default_rng(seed)
    e = np.empty(len(X))
    e[0] = rng.normal()
    for i in range(1, len(e)):
        e[i] = rho * e[i - 1] + np.sqrt(1.0 - rho**2) * rng.normal()
    return sd * e


def test_a_line_has_the_intervals_of_linear_regression():
    y = DESIGN @ TRUE + noise(5, 0.02)
    result = fitted(y)
    beta, (square,), *_ = np.linalg.lstsq(DESIGN, y, rcond=None)
    covariance = np.linalg.inv(DESIGN.T @ DESIGN) * square / (len(X) - 2)
    tau = autocorrelation_time(DESIGN @ beta - y)
    half = student.ppf(0.975, len(X) - 2) * np.sqrt(tau * np.diag(covariance))
    np.testing.assert_allclose(result.x, beta, atol=1e-9)
    np.testing.assert_allclose(result.half, half, rtol=1e-9)
    assert result.cost == pytest.approx(square)
    assert result.correlation[0, 1] == pytest.approx(
        covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])
    )
    assert correlated(result, ["a", "b"], 0.8) == [("b", "a", pytest.approx(result.correlation[0, 1]))]


@pytest.mark.parametrize("known", [False, True])
@pytest.mark.parametrize("rho", [0.0, 0.6])
def test_intervals_of_95_percent_hold_the_true_values(rho, known):
    """With correlated errors too: of 400 intervals of each parameter at least 92 %, as of a binomial."""
    inside = np.zeros(2)
    for seed in range(400):
        result = fitted(DESIGN @ TRUE + noise(seed, 0.02, rho), 1.0 / 0.02, known)
        inside += np.abs(result.x - TRUE) <= result.half
    least = 0.92 if rho == 0.0 else 0.88  # the correlation itself is estimated from 60 values
    assert (inside >= least * 400).all(), inside


def test_known_deviations_give_intervals_to_as_many_values_as_parameters():
    design = DESIGN[[0, -1]]
    result = fitted(design @ TRUE, 50.0, True, design=design, blocks=np.arange(2))
    np.testing.assert_allclose(result.half, 1.959964 * np.array([0.02, np.sqrt(2) * 0.02]), rtol=1e-5)
    unknown = fitted(design @ TRUE, 1.0, False, design=design, blocks=np.arange(2))
    assert np.isinf(unknown.half).all()


def test_a_parameter_at_its_bound_and_one_without_effect():
    assert np.isnan(fitted(DESIGN @ np.array([0.4, 1.5])).half[1])
    flat = np.c_[np.ones_like(X), np.zeros_like(X)]
    result = fitted(flat @ TRUE + noise(1, 0.01), design=flat)
    assert np.isinf(result.half).all()


def test_the_autocorrelation_time_of_an_autoregression():
    """(1 + rho) / (1 - rho) of a long one; 1 of independent values, within their scatter."""
    rng = np.random.default_rng(3)
    e = rng.normal(size=20000)
    assert 1.0 <= autocorrelation_time(e) < 1.15
    for i in range(1, len(e)):
        e[i] = 0.6 * e[i - 1] + 0.8 * e[i]
    assert autocorrelation_time(e) == pytest.approx(4.0, rel=0.15)
    assert autocorrelation_time(np.zeros(10)) == autocorrelation_time(np.ones(2)) == 1.0
