"""Sensitivities: derivatives of the quantities of a study with respect to its variables.

Differences over runs around the values of the variables.  The step of a variable is reduced until its runs
have the events of the central run and the derivatives are known well enough; runs with other events, a kink
or an error that stays large leave a quantity without a derivative, and the reason is stated.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np

from pound_solve.results.sweep_file import DONE
from pound_solve.statistics.curves import Asked
from pound_solve.statistics.differences import STENCIL, slope
from pound_solve.statistics.over_records import EACH, OverRecords
from pound_solve.statistics.sensitivity import Derivative, Sensitivity, weighted
from pound_solve.sweep.points import Point, PointResult, Points
from pound_solve.sweep.study.asked import all_asked, over_records
from pound_solve.sweep.study.document import Document
from pound_solve.sweep.study.quantities import Values, require, value_of
from pound_solve.sweep.study.variables import StudyVariable

TABLE: Final = "sensitivity"  #: of a study
ITEMS: Final = ("quantities", "records", "step")
STEP: Final = 1e-3  #: first step, as a fraction of the value of a variable
REDUCTION: Final = 0.1  #: of the step from one round to the next
ROUNDS: Final = 4
#: relative error of a derivative over that of the results of runs by steps, if the elasticity is 1: their
#: error varies with the variable
AMPLIFIED: Final = 10.0
GOOD: Final = 1e-4  #: error of a derivative, as a fraction of it, below which the steps end
WORST: Final = 0.1  #: largest such error with which a derivative is reported
#: elasticities below which a derivative counts as zero, so that its error is compared with this one
MINOR: Final = 1e-3

Key: TypeAlias = tuple[int, int, int]  #: numbers of a variable, a quantity and a record


@dataclass(frozen=True)
class SensitivityAim:
    """What sensitivities are asked for.

    Attributes
    ----------
    quantities : tuple of Asked
    records : OverRecords
    step : float
        First step as a fraction of the values of the variables.
    """

    quantities: tuple[Asked, ...]
    records: OverRecords
    step: float


def aim(document: Document) -> SensitivityAim:
    """Read the table ``[sensitivity]`` of a study; mistakes are added to the document."""
    document.take((TABLE,), dict, {})
    document.known((TABLE,), ITEMS)
    path = (TABLE, "quantities")
    quantities = tuple(all_asked(document, path))
    if not quantities and document.at(path) is None:
        message = f"[{TABLE}] names no quantities"
        document.mistake("S604", message, (TABLE,), 'write quantities = ["contact_force"]')
    step = document.take((TABLE, "step"), float, STEP)
    if not 0.0 < step < 1.0:
        document.mistake("S603", "step is a fraction above 0 and below 1", (TABLE, "step"))
    return SensitivityAim(quantities, over_records(document, (TABLE, "records"), OverRecords(EACH)), step)


def check_steps(document: Document, variables: Sequence[StudyVariable]) -> None:
    """Add a mistake for every variable that has no room for a step, or no scale of its own."""
    for v in variables:
        if v.value == 0.0 and not math.isfinite(v.high - v.low):
            message = f"{v.name} is 0, so that a fraction of it is no step"
            hint = "give low and high: the step is a fraction of their distance"
            document.mistake("S605", message, v.path, hint)
        elif not v.low < v.value < v.high:
            message = f"{v.name} is at one of its bounds: differences need values on both sides"
            document.mistake("S605", message, v.path, "move the value, or the bound")


class SensitivityAnalysis:
    """Derivatives at the values of the variables.

    Parameters
    ----------
    aim : SensitivityAim

    Attributes
    ----------
    lines : list of Sensitivity
        By quantity, record and variable.
    gentlest : dict of str to float
        By record, the smallest approach speed of a collision over the largest.
    unknown_error : bool
        Whether a run took steps whose error it does not estimate.
    """

    def __init__(self, aim: SensitivityAim) -> None:
        self.aim = aim
        self.lines: list[Sensitivity] = []
        self.gentlest: dict[str, float] = {}
        self.unknown_error = False

    def carry_out(self, points: Points) -> None:
        """Execute the runs and form the derivatives.

        Raises
        ------
        Interrupted
            After Ctrl-C.
        CurveError
            The runs have other labels of a quantity.
        """
        self.points = points
        (self.center,) = points.results([points.nominal])
        for asked, values in itertools.product(self.aim.quantities, self.center.values):
            require(values, asked)
        self.records = [run.shaking.record.name if run.shaking else "" for run in self.center.runs]
        self.gentlest = {name: e.gentlest for name, e in zip(self.records, self.center.entries)}
        ends = zip(self.center.entries, self.center.values)
        self.unknown_error = any(not e.exact and math.isnan(_estimate(values)) for e, values in ends)
        varied = list(range(len(points.variables)))
        best: dict[Key, Derivative] = {}
        for count in range(ROUNDS):
            steps = [(i, self._step(i) * REDUCTION**count) for i in varied]
            around = points.results(p for i, h in steps for p in self._around(i, h))
            for k, (i, h) in enumerate(steps):
                for key, new in self._derivatives(i, h, around[k * len(STENCIL) : (k + 1) * len(STENCIL)]):
                    if key not in best or new.better_than(best[key]):
                        best[key] = new
            varied = sorted({key[0] for key, d in best.items() if not self._ends(key, d)})
            if not varied:
                break
        self.lines = list(self._lines({key: self._checked(key, d) for key, d in best.items()}))

    def _scale(self, i: int) -> float:
        """Size of a variable: its value, or its range if that is zero."""
        v = self.points.variables[i]
        return abs(v.value) or v.high - v.low

    def _step(self, i: int) -> float:
        """First step of a variable, within its bounds."""
        v = self.points.variables[i]
        return min(self.aim.step * self._scale(i), v.high - v.value, v.value - v.low)

    def _around(self, i: int, h: float) -> Iterator[Point]:
        """Points at the places of the stencil."""
        nominal = self.points.nominal
        for place in STENCIL:
            yield (*nominal[:i], nominal[i] + place * h, *nominal[i + 1 :])

    def _derivatives(
        self, i: int, h: float, around: Sequence[PointResult]
    ) -> Iterator[tuple[Key, Derivative]]:
        """Derivatives of all quantities and records with respect to variable `i` from one step."""
        for r, (entry, values) in enumerate(zip(self.center.entries, self.center.values)):
            others = [result.entries[r] for result in around]
            reason = ""
            if entry.status != DONE:
                reason = f"the run {entry.status}"
            elif bad := next((e for e in others if e.status != DONE), None):
                reason = f"a run within {h:.3g} {bad.status}"
            elif any(e.sequence != entry.sequence for e in others):
                reason = f"the sequence of events changes within {h:.3g}"
            for q, asked in enumerate(self.aim.quantities):
                value = value_of(values, asked)
                near = [value_of(result.values[r], asked) for result in around]
                if reason or not np.isfinite([value, *near]).all():
                    yield (i, q, r), Derivative(value, step=h, reason=reason or "the run has no such value")
                    continue
                at = slope(value, near, h)
                yield (i, q, r), Derivative(value, at.value, at.error, h, "", at.left, at.right)

    def _ends(self, key: Key, derivative: Derivative) -> bool:
        """Whether smaller steps are not needed, or would not help."""
        if self.center.entries[key[2]].status != DONE or math.isnan(derivative.value):
            return True
        return not derivative.reason and derivative.error <= GOOD * self._size(key[0], derivative)

    def _size(self, i: int, derivative: Derivative) -> float:
        """Magnitude with which the error of a derivative is compared."""
        return max(abs(derivative.slope), MINOR * abs(derivative.value) / self._scale(i))

    def _checked(self, key: Key, derivative: Derivative) -> Derivative:
        """The derivative, whose error now includes that of the runs, or the reason why there is none."""
        if derivative.reason:
            return derivative
        if derivative.error > WORST * self._size(key[0], derivative):
            sides = f"{derivative.left:.4g} and {derivative.right:.4g}"
            return derivative.without(f"slopes of {sides} on the two sides within {derivative.step:.3g}")
        size = max(abs(derivative.slope), abs(derivative.value) / self._scale(key[0]))
        estimate = _estimate(self.center.values[key[2]])
        of_runs = 0.0 if math.isnan(estimate) else AMPLIFIED * estimate * size
        return derivative._replace(error=derivative.error + of_runs)

    def _lines(self, by_key: Mapping[Key, Derivative]) -> Iterator[Sensitivity]:
        """Lines of the table: each record, or over all of them."""
        records = self.aim.records
        for q, asked in enumerate(self.aim.quantities):
            values = np.array([value_of(v, asked) for v in self.center.values])
            for weights in records.weights(values):
                counting = np.flatnonzero(weights)
                name = self.records[counting[0]] if records.how == EACH else records.text
                for i, variable in enumerate(self.points.variables):
                    parts = [by_key[i, q, r] for r in counting.tolist()]
                    total = weighted(parts, weights[counting])
                    yield Sensitivity(asked, name, variable.name, variable.value, total)


def _estimate(values: Values) -> float:
    """Relative error of the results of a run by steps, as AUTO estimates it; NaN without."""
    return values.get("error_estimate", {}).get("", math.nan)
