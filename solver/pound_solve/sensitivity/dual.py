r"""Dual numbers: values with their derivatives with respect to all parameters.

Laws are functions of plain numbers (:mod:`pound_solve.laws.automaton`).  With dual numbers as arguments the
same functions return their derivatives too: every operation applies the chain rule, and comparisons look at
the values only, so a function takes the branch that it takes with plain numbers.

A function of :mod:`math` raises TypeError for a dual number, since it would lose the derivatives.

References
----------
Griewank A, Walther A (2008), Evaluating derivatives, 2nd ed., SIAM, chapter 3 (forward mode).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any, TypeAlias

import numpy as np

from pound_solve.numerics.types import Array

Term: TypeAlias = "Dual | float"


class Dual:
    """A value and its derivatives.

    Parameters
    ----------
    value : float
    slopes : ndarray, shape (n_params,), or float
        Derivatives; 0.0 for a constant.
    """

    __slots__ = ("slopes", "value")
    __array_ufunc__ = None  # a product with a number of numpy is a dual number, not an array

    def __init__(self, value: float, slopes: Array | float = 0.0) -> None:
        self.value, self.slopes = float(value), slopes

    def __repr__(self) -> str:
        return f"Dual({self.value!r}, {self.slopes!r})"

    def __add__(self, other: Term) -> Dual:
        return Dual(self.value + value_of(other), self.slopes + slopes_of(other))

    __radd__ = __add__

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.slopes)

    def __pos__(self) -> Dual:
        return self

    def __sub__(self, other: Term) -> Dual:
        return Dual(self.value - value_of(other), self.slopes - slopes_of(other))

    def __rsub__(self, other: Term) -> Dual:
        return -self + other

    def __mul__(self, other: Term) -> Dual:
        x, y = self.value, value_of(other)
        return Dual(x * y, y * self.slopes + x * slopes_of(other))

    __rmul__ = __mul__

    def __truediv__(self, other: Term) -> Dual:
        y = value_of(other)
        ratio = self.value / y
        return Dual(ratio, (self.slopes - ratio * slopes_of(other)) / y)

    def __rtruediv__(self, other: Term) -> Dual:
        return Dual(value_of(other)) / self

    def __pow__(self, other: Term) -> Dual:
        x, n = self.value, value_of(other)
        power = x**n
        slopes = n * x ** (n - 1.0) * self.slopes if n != 0.0 else 0.0 * self.slopes
        if np.any(by_exponent := slopes_of(other)):
            slopes = slopes + power * math.log(x) * by_exponent
        return Dual(power, slopes)

    def __rpow__(self, other: Term) -> Dual:
        return Dual(value_of(other)) ** self

    def __abs__(self) -> Dual:
        return -self if self.value < 0.0 else self

    def __int__(self) -> int:
        if np.any(self.slopes):
            raise TypeError("a number that is not whole has no derivative as a whole one")
        return int(self.value)

    def __bool__(self) -> bool:
        return self.value != 0.0

    def __lt__(self, other: Term) -> bool:
        return self.value < value_of(other)

    def __le__(self, other: Term) -> bool:
        return self.value <= value_of(other)

    def __gt__(self, other: Term) -> bool:
        return self.value > value_of(other)

    def __ge__(self, other: Term) -> bool:
        return self.value >= value_of(other)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Dual | float | int) and self.value == value_of(other)

    __hash__ = None  # type: ignore[assignment]


def value_of(x: Term) -> float:
    """Return the value of a dual or plain number."""
    return x.value if isinstance(x, Dual) else x


def slopes_of(x: Term) -> Array | float:
    """Return the derivatives of a dual number, zero for a plain one."""
    return x.slopes if isinstance(x, Dual) else 0.0


def duals(values: Iterable[float], slopes: Array) -> tuple[Any, ...]:
    """Return dual numbers from values and their derivatives, shape (n_params, n); `Any`, since they take
    the place of the plain numbers of a law.
    """
    return tuple(Dual(x, s) for x, s in zip(values, slopes.T))
