"""Sensitivities: derivatives of the quantities of a study with respect to its variables.

They are differences over runs, or exact derivatives along one run, which runs along one direction check.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np

from pound_solve.results.sweep_file import DONE
from pound_solve.sensitivity.differences import TOGETHER, Differences, Key, estimated
from pound_solve.sensitivity.worker import differentiated, slopes_of
from pound_solve.statistics.curves import Asked
from pound_solve.statistics.over_records import EACH, MEAN, OverRecords
from pound_solve.statistics.sensitivity import Derivative, Sensitivities, Sensitivity, weighted
from pound_solve.sweep.points import PointResult, Points
from pound_solve.sweep.study.asked import all_asked, over_records
from pound_solve.sweep.study.document import Document
from pound_solve.sweep.study.quantities import label_of, require, value_of
from pound_solve.sweep.study.variables import StudyVariable

TABLE: Final = "sensitivity"  #: of a study
ITEMS: Final = ("quantities", "records", "step", "method")
DIFFERENCES, EXACT = METHODS = ("differences", "exact")
OVER: Final = MappingProxyType({how: OverRecords(how) for how in (EACH, MEAN)})
STEP: Final = 1e-3  #: first step, as a fraction of the value of a variable
#: largest disagreement of exact derivatives with a difference beyond its bound, as a fraction
DISAGREE: Final = 1e-6


@dataclass(frozen=True)
class SensitivityAim:
    """What sensitivities are asked for.

    Attributes
    ----------
    quantities : tuple of Asked
    records : OverRecords
    step : float
        First step as a fraction of the values of the variables.
    method : str
        `DIFFERENCES`, or `EXACT`: exact derivatives where the run has them.
    """

    quantities: tuple[Asked, ...]
    records: OverRecords
    step: float
    method: str


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
    method = document.take((TABLE, "method"), str, DIFFERENCES)
    if method not in METHODS:
        document.mistake("S603", f"method is {DIFFERENCES} or {EXACT}", (TABLE, "method"))
    over = over_records(document, (TABLE, "records"), OVER)
    return SensitivityAim(quantities, over, step, method)


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
    """

    def __init__(self, aim: SensitivityAim) -> None:
        self.aim = aim
        self.remarks: list[tuple[str, str]] = []

    def carry_out(self, points: Points) -> Sensitivities:
        """Execute the runs and return the derivatives.

        Raises
        ------
        Interrupted
            After Ctrl-C.
        CurveError
            The runs have other labels of a quantity.
        """
        self.variables = points.variables
        (self.center,) = points.results([points.nominal])
        for asked, values in itertools.product(self.aim.quantities, self.center.values):
            require(values, asked)
        self.records = [run.shaking.record.name if run.shaking else "" for run in self.center.runs]
        differences = Differences(points, self.center, self.aim.quantities, self.aim.step)
        by_key = dict[Key, Derivative]()
        if self.aim.method == EXACT:
            run = points.derived(points.nominal, differentiated)
            by_key |= self._confirmed(dict(self._exact(run)), differences)
        sizes = len(self.variables), len(self.aim.quantities), len(self.records)
        lacking = sorted({key[0] for key in itertools.product(*map(range, sizes)) if key not in by_key})
        by_key = differences.along(lacking) | by_key
        ends = zip(self.center.entries, self.center.values)
        return Sensitivities(
            list(self._lines(by_key)),
            {name: e.gentlest for name, e in zip(self.records, self.center.entries)},
            self.remarks,
            any(not e.exact and math.isnan(estimated(values)) for e, values in ends),
        )

    def _exact(self, run: PointResult) -> Iterator[tuple[Key, Derivative]]:
        """Exact derivatives of the quantities that have some."""
        names = [v.name for v in self.variables]
        for r, (record, entry) in enumerate(zip(self.records, run.entries)):
            if entry.status != DONE:
                self.remarks.append((record, f"no exact derivatives: {entry.message}"))
            self.remarks += [(record, flag) for flag in entry.doubt.split("; ") if flag]
            for q, asked in enumerate(self.aim.quantities):
                value = value_of(self.center.values[r], asked)
                label = label_of(self.center.values[r], asked)
                slopes = slopes_of(run.values[r], asked.quantity, label, names)
                if slopes is not None:
                    yield from (((i, q, r), Derivative(value, x, exact=True)) for i, x in enumerate(slopes))

    def _confirmed(
        self, exact: Mapping[Key, Derivative], differences: Differences
    ) -> dict[Key, Derivative]:
        """The exact derivatives with an error: what their sum deviates from the difference along the
        direction in which all variables change by the same fraction, and the bound of this difference.
        Without those that disagree with it.
        """
        if not exact:
            return {}
        scales = [differences.scale(i) for i in range(len(self.variables))]
        confirmed = dict[Key, Derivative]()
        for (_, q, r), along in differences.along([TOGETHER]).items():
            some = [exact.get((i, q, r)) for i in range(len(self.variables))]
            parts = [d for d in some if d is not None]
            if not parts:
                continue
            total = sum(d.slope * scale for d, scale in zip(parts, scales))
            error = math.nan if along.reason else abs(total - along.slope) + along.error
            if error > 2.0 * along.error + DISAGREE * max(abs(total), abs(along.value)):
                self.remarks.append((self.records[r], f"{self._named(q)} disagrees with differences"))
                continue
            if along.reason:
                self.remarks.append((self.records[r], f"{self._named(q)} is not checked: {along.reason}"))
            for i, (d, scale) in enumerate(zip(parts, scales)):
                confirmed[i, q, r] = d._replace(error=error / scale, step=along.step)
        return confirmed

    def _named(self, q: int) -> str:
        """Name of a quantity with its label."""
        return " ".join(filter(None, self.aim.quantities[q]))

    def _lines(self, by_key: Mapping[Key, Derivative]) -> Iterator[Sensitivity]:
        """Lines of the table: each record, or over all of them."""
        records = self.aim.records
        for q, asked in enumerate(self.aim.quantities):
            values = np.array([value_of(v, asked) for v in self.center.values])
            for weights in records.weights(values):
                counting = np.flatnonzero(weights)
                name = self.records[counting[0]] if records.how == EACH else records.text
                for i, variable in enumerate(self.variables):
                    parts = [by_key[i, q, r] for r in counting.tolist()]
                    total = weighted(parts, weights[counting])
                    yield Sensitivity(asked, name, variable.name, variable.value, total)
