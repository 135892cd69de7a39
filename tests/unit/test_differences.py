"""Derivatives by differences: exact for polynomials, and bounds of the error at kinks and jumps."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pound_solve.statistics.differences import STENCIL, slope

NUMBERS = st.floats(-10.0, 10.0)


def at(f, x, h):
    return slope(f(x), [f(x + place * h) for place in STENCIL], h)


@given(st.lists(NUMBERS, min_size=1, max_size=5), st.floats(-2.0, 2.0))
def test_polynomials_up_to_the_fourth_degree_are_exact(coefficients, x):
    p = np.polynomial.Polynomial(coefficients)
    true = float(p.deriv()(x))
    assert at(p, x, 0.5).value == pytest.approx(true, abs=1e-10)


def test_the_error_of_a_smooth_function_falls_with_the_fourth_power_and_stays_below_its_bound():
    errors = []
    for h in (0.4, 0.2, 0.1):
        derivative = at(math.exp, 0.3, h)
        errors.append(abs(derivative.value - math.exp(0.3)))
        assert errors[-1] < derivative.error
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(16.0, rel=0.1)


@given(st.floats(-0.999, 0.999).filter(lambda t: abs(t) > 1e-3), NUMBERS, NUMBERS, NUMBERS)
def test_the_bound_holds_for_one_kink_or_jump_within_the_step(t, left, right, jump):
    """The function is linear on both sides of x = t; at x = 0 its slope is that of the side of 0."""

    def f(x):
        return left * (x - t) if x < t else right * (x - t) + jump

    derivative = at(f, 0.0, 1.0)
    error = abs(derivative.value - (left if t > 0.0 else right))
    assert derivative.error >= 1.4999 * error - 1e-9


def test_a_kink_at_the_point_has_the_slopes_of_both_sides():
    derivative = at(abs, 0.0, 0.1)
    assert (derivative.left, derivative.right) == (-1.0, 1.0)
    assert derivative.error >= 1.0


def test_values_that_are_not_finite_have_no_derivative():
    derivative = slope(1.0, (1.0, math.inf, 1.0, 1.0), 0.1)
    assert math.isnan(derivative.value) and derivative.error == math.inf
