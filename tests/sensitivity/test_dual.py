"""Arithmetic of dual numbers."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from pound_solve.sensitivity.dual import Dual, duals

X, Y = 1.7, -0.6
FORMS: dict[str, Callable[[Any, Any], Any]] = {
    "sums": lambda x, y: 2.0 + x - y - 3.0 - (1.0 - x) + (+y),
    "products": lambda x, y: 3.0 * x * y - y * 2.0 + np.float64(2.0) * x,
    "quotients": lambda x, y: x / y + 2.0 / x - y / 4.0,
    "powers": lambda x, y: x**2.5 + y**2 + x**y + 2.0**x + x**0.0,
    "sides": lambda x, y: abs(y) * max(x, 1.0) + min(x, y, 3.0) - abs(x),
}


@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS)
def test_derivatives_are_those_of_plain_numbers(form: Callable[[Any, Any], Any]) -> None:
    x, y = duals((X, Y), np.eye(2))
    h = 1e-6
    expected = [
        (form(X + h, Y) - form(X - h, Y)) / (2.0 * h),
        (form(X, Y + h) - form(X, Y - h)) / (2.0 * h),
    ]
    assert form(x, y).value == pytest.approx(form(X, Y), rel=1e-15)
    assert form(x, y).slopes == pytest.approx(expected, rel=1e-8, abs=1e-9)


def test_comparisons_look_at_values() -> None:
    one, two = Dual(1.0, np.ones(1)), Dual(2.0, np.zeros(1))
    assert one < two <= 2.0 < Dual(3.0)
    assert two > one >= 1.0
    assert one == 1.0 != two
    assert one
    assert not Dual(0.0, np.ones(1))


def test_no_function_drops_a_derivative() -> None:
    varying = Dual(2.0, np.ones(1))
    for lossy in (math.exp, math.sqrt, float, int, np.exp):
        with pytest.raises(TypeError):
            lossy(varying)
    assert int(Dual(2.0, np.zeros(1))) == 2
