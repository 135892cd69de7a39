"""Results of a calibration: fitted variables with intervals, and measured beside fitted values."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pound_solve.numerics.types import Array


class FittedVariable(NamedTuple):
    """A variable after the fit.

    Attributes
    ----------
    name : str
    start, value : float
        Before and after the fit.
    low, high : float
        Ends of its interval; NaN at a bound, infinite where the measured values say nothing of it.
    remark : str
        Why it has no interval; empty if it has one.
    """

    name: str
    start: float
    value: float
    low: float
    high: float
    remark: str


class MeasuredFit(NamedTuple):
    """A measured peak or history beside that of the fitted run.

    Attributes
    ----------
    name, record : str
    unit : str
    times : ndarray, shape (n,)
        Of a history [T]; one NaN for a peak.
    measured, fitted : ndarray, shape (n,)
    sd : float
        Standard deviation of the errors of the measured values; NaN if it is not known.
    memory : float
        Number of values that tell as much as one independent value.
    """

    name: str
    record: str
    unit: str
    times: Array
    measured: Array
    fitted: Array
    sd: float
    memory: float

    @property
    def is_peak(self) -> bool:
        """Whether it is a peak."""
        return bool(np.isnan(self.times).all())

    @property
    def scatter(self) -> float:
        """Root of the mean square of the differences."""
        return float(np.sqrt(np.mean((self.fitted - self.measured) ** 2)))

    @property
    def share(self) -> float:
        """Fraction of the mean square of the measured values that the fit leaves."""
        return float(np.sum((self.fitted - self.measured) ** 2) / np.sum(self.measured**2))


class StartedFit(NamedTuple):
    """One start of the search: variables at its start and its end, and the sum of squares there."""

    start: tuple[float, ...]
    end: tuple[float, ...]
    cost: float


class Calibration(NamedTuple):
    """Result of a calibration.

    Attributes
    ----------
    variables : list of FittedVariable
    fits : list of MeasuredFit
    starts : list of StartedFit
        The first is that from the values of the study.
    correlated : list of (str, str, float)
        Pairs of variables whose errors are correlated, with their correlation.
    scatter : float
        Standard deviation of the weighted residuals.
    known : bool
        Whether the weights are known standard deviations.
    confidence : float
        Of the intervals.
    """

    variables: list[FittedVariable]
    fits: list[MeasuredFit]
    starts: list[StartedFit]
    correlated: list[tuple[str, str, float]]
    scatter: float
    known: bool
    confidence: float
