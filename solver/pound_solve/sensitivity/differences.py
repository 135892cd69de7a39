"""Derivatives by differences over runs of a study.

The step of a variable is reduced until its runs have the events of the central run and the derivatives are
known well enough; runs with other events, a kink or an error that stays large leave a quantity without a
derivative, and the reason is stated.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final, TypeAlias

import numpy as np

from pound_solve.results.sweep_file import DONE
from pound_solve.statistics.curves import Asked
from pound_solve.statistics.differences import STENCIL, slope
from pound_solve.statistics.sensitivity import Derivative
from pound_solve.sweep.points import Point, PointResult, Points
from pound_solve.sweep.study.quantities import Values, value_of

REDUCTION: Final = 0.1  #: of the step from one round to the next
ROUNDS: Final = 4
#: relative error of a derivative over that of the results of runs by steps, if the elasticity is 1: their
#: error varies with the variable
AMPLIFIED: Final = 10.0
GOOD: Final = 1e-4  #: error of a derivative, as a fraction of it, below which the steps end
WORST: Final = 0.1  #: largest such error with which a derivative is reported
#: elasticities below which a derivative counts as zero, so that its error is compared with this one
MINOR: Final = 1e-3
TOGETHER: Final = -1  #: number of the direction in which all variables change by the same fraction

Key: TypeAlias = tuple[int, int, int]  #: numbers of a variable or a direction, a quantity and a record


class Differences:
    """Derivatives by differences around the values of the variables.

    Parameters
    ----------
    points : Points
    center : PointResult
        Runs at these values.
    quantities : sequence of Asked
    step : float
        First step as a fraction of the values.
    """

    def __init__(
        self, points: Points, center: PointResult, quantities: Sequence[Asked], step: float
    ) -> None:
        self.points, self.center, self.quantities, self.step = points, center, quantities, step

    def along(self, directions: Sequence[int]) -> dict[Key, Derivative]:
        """Derivatives of all quantities with respect to some variables; or along `TOGETHER`, with respect
        to the fraction.

        Raises
        ------
        Interrupted
            After Ctrl-C.
        """
        varied, best = list(directions), dict[Key, Derivative]()
        for count in range(ROUNDS):
            steps = [(i, self._first_step(i) * REDUCTION**count) for i in varied]
            around = self.points.results(p for i, h in steps for p in self._around(i, h))
            for k, (i, h) in enumerate(steps):
                for key, new in self._derivatives(i, h, around[k * len(STENCIL) : (k + 1) * len(STENCIL)]):
                    if key not in best or new.better_than(best[key]):
                        best[key] = new
            varied = sorted({key[0] for key, d in best.items() if not self._ends(key, d)})
            if not varied:
                break
        return {key: self._checked(key, d) for key, d in best.items()}

    def scale(self, i: int) -> float:
        """Size of a variable: its value, or its range if that is zero; 1 for the fraction of all."""
        if i == TOGETHER:
            return 1.0
        v = self.points.variables[i]
        return abs(v.value) or v.high - v.low

    def _first_step(self, i: int) -> float:
        """First step of a variable within its bounds, or of the fraction of all."""
        if i == TOGETHER:
            return min(self._first_step(k) / self.scale(k) for k in range(len(self.points.variables)))
        v = self.points.variables[i]
        return min(self.step * self.scale(i), v.high - v.value, v.value - v.low)

    def _around(self, i: int, h: float) -> Iterator[Point]:
        """Points at the places of the stencil."""
        nominal = self.points.nominal
        moved = range(len(nominal)) if i == TOGETHER else [i]
        steps = [h * self.scale(k) if i == TOGETHER else h for k in moved]
        for place in STENCIL:
            point = list(nominal)
            for k, step in zip(moved, steps):
                point[k] += place * step
            yield tuple(point)

    def _derivatives(
        self, i: int, h: float, around: Sequence[PointResult]
    ) -> Iterator[tuple[Key, Derivative]]:
        """Derivatives of all quantities and records along direction `i` from one step."""
        for r, (entry, values) in enumerate(zip(self.center.entries, self.center.values)):
            others = [result.entries[r] for result in around]
            reason = ""
            if entry.status != DONE:
                reason = f"the run {entry.status}"
            elif bad := next((e for e in others if e.status != DONE), None):
                reason = f"a run within {h:.3g} {bad.status}"
            elif any(e.sequence != entry.sequence for e in others):
                reason = f"the sequence of events changes within {h:.3g}"
            for q, asked in enumerate(self.quantities):
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
        return max(abs(derivative.slope), MINOR * abs(derivative.value) / self.scale(i))

    def _checked(self, key: Key, derivative: Derivative) -> Derivative:
        """The derivative, whose error now includes that of the runs, or the reason why there is none."""
        if derivative.reason:
            return derivative
        if derivative.error > WORST * self._size(key[0], derivative):
            sides = f"{derivative.left:.4g} and {derivative.right:.4g}"
            return derivative.without(f"slopes of {sides} on the two sides within {derivative.step:.3g}")
        size = max(abs(derivative.slope), abs(derivative.value) / self.scale(key[0]))
        estimate = estimated(self.center.values[key[2]])
        of_runs = 0.0 if math.isnan(estimate) else AMPLIFIED * estimate * size
        return derivative._replace(error=derivative.error + of_runs)


def estimated(values: Values) -> float:
    """Relative error of the results of a run by steps, as AUTO estimates it; NaN without."""
    return values.get("error_estimate", {}).get("", math.nan)
