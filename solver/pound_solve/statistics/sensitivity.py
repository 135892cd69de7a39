"""Derivatives of quantities with respect to variables: of one record, or of a weighted sum of records."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from pound_solve.numerics.types import Array
from pound_solve.statistics.curves import Asked


class Derivative(NamedTuple):
    """Derivative of a quantity of one run with respect to a variable.

    Attributes
    ----------
    value, slope, error : float
        Value of the quantity, its derivative and the bound of the derivative's error; NaN without one.
    step : float
        Outer step of the differences.
    reason : str
        Why there is no derivative; empty if there is one.
    left, right : float
        Slopes on both sides.
    exact : bool
        Whether it is that of the equations of motion, no difference of runs.
    """

    value: float
    slope: float = math.nan
    error: float = math.nan
    step: float = math.nan
    reason: str = ""
    left: float = math.nan
    right: float = math.nan
    exact: bool = False

    def better_than(self, other: Derivative) -> bool:
        """Whether it is known better than one with a larger step."""
        if self.reason or other.reason:
            return bool(other.reason)
        return self.error < other.error

    def without(self, reason: str) -> Derivative:
        """The value alone, with the reason why there is no derivative."""
        return Derivative(self.value, step=self.step, reason=reason)


class Sensitivity(NamedTuple):
    """Derivative of a quantity, of one record or over all, with respect to a variable.

    Attributes
    ----------
    asked : Asked
    record : str
        Name of a record, or how the values of all became one; empty for the motion of the deck.
    variable : str
    at : float
        Value of the variable.
    derivative : Derivative
    """

    asked: Asked
    record: str
    variable: str
    at: float
    derivative: Derivative

    @property
    def elasticity(self) -> float:
        """Relative change of the quantity over that of the variable; NaN where the quantity is zero."""
        value = self.derivative.value
        return self.derivative.slope * self.at / value if value else math.nan

    @property
    def elasticity_error(self) -> float:
        """Bound of the error of the elasticity."""
        value = self.derivative.value
        return abs(self.derivative.error * self.at / value) if value else math.nan


class Sensitivities(NamedTuple):
    """Result of an analysis of sensitivities.

    Attributes
    ----------
    lines : list of Sensitivity
        By quantity, record and variable.
    gentlest : dict of str to float
        By record, the smallest approach speed of a collision over the largest.
    remarks : list of (str, str)
        Records, and what their exact derivatives lack or are close to.
    unknown_error : bool
        Whether a run took steps whose error it does not estimate.
    """

    lines: list[Sensitivity]
    gentlest: dict[str, float]
    remarks: list[tuple[str, str]]
    unknown_error: bool


def weighted(parts: Sequence[Derivative], weights: Array) -> Derivative:
    """Derivative of a weighted sum; it needs those of all parts.

    Parameters
    ----------
    parts : sequence of Derivative
    weights : ndarray, shape (n_parts,)
    """
    value, slope, error = (
        float(sum(w * x for w, x in zip(weights, column)))
        for column in zip(*((p.value, p.slope, p.error) for p in parts))
    )
    step = max(p.step for p in parts)
    lacking = [p.reason for p in parts if p.reason]
    if len(parts) == 1 or not lacking:
        reason, exact = (lacking or [""])[0], all(p.exact for p in parts)
        return Derivative(value, slope, error, step, reason, exact=exact)
    return Derivative(value, step=step, reason=f"{len(lacking)} of {len(parts)} records have none")
