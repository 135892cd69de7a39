"""Calibration: values of the variables of a study with which its runs fit measured peaks and histories."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from pound_deck.model import Units
from pound_solve.numerics.types import Array
from pound_solve.statistics.calibration import Calibration, FittedVariable, MeasuredFit, StartedFit
from pound_solve.statistics.curves import CurveError
from pound_solve.statistics.least_squares import Fit, autocorrelation_time, correlated, fit
from pound_solve.sweep.points import PointResult, Points
from pound_solve.sweep.study import measured
from pound_solve.sweep.study.document import Document
from pound_solve.sweep.study.measured import Measured
from pound_solve.sweep.study.quantities import QUANTITIES, require, value_of
from pound_solve.sweep.study.scaling import design_variables, scales

TABLE: Final = "calibrate"  #: of a study
ITEMS: Final = ("starts", "confidence")
STEP: Final = 1e-4  #: of the differences, as a fraction of the range of a variable
UNREACHED: Final = 10.0  #: residual of a value that a run does not reach, over the largest measured value
CORRELATED: Final = 0.95  #: correlation of two variables from which the report names them
MOST_STARTS: Final = 1000


@dataclass(frozen=True)
class CalibrationAim:
    """What is fitted, and how it is searched.

    Attributes
    ----------
    measured : tuple of Measured
    starts : int
        Number of starts: the values of the study, and points spread between the bounds.
    confidence : float
        Of the intervals.
    scales : mapping of str to str
        Scale of every variable, one of `scaling.SCALES`.
    """

    measured: tuple[Measured, ...]
    starts: int
    confidence: float
    scales: Mapping[str, str]


def aim(document: Document) -> CalibrationAim:
    """Read the tables ``[[measured]]`` and ``[calibrate]``; mistakes are added to the document.

    The study keeps the histories that were measured.
    """
    document.take((TABLE,), dict, {})
    document.known((TABLE,), ITEMS)
    wanted = tuple(measured.measured(document))
    histories = document.listed(("histories",), (str,)) if document.at(("histories",)) else []
    names = list(dict.fromkeys([*histories, *(m.history for m in wanted if m.history)]))
    if names:
        document.values["histories"] = names
    starts = document.take((TABLE, "starts"), int, 1)
    confidence = document.take((TABLE, "confidence"), float, 0.95)
    if not 1 <= starts <= MOST_STARTS:
        document.mistake("S603", f"starts is a number from 1 to {MOST_STARTS}", (TABLE, "starts"))
    if not 0.0 < confidence < 1.0:
        document.mistake("S603", "confidence is between 0 and 1", (TABLE, "confidence"))
    return CalibrationAim(wanted, starts, confidence, scales(document))


class CalibrationAnalysis:
    """Search of the values that fit best.

    Parameters
    ----------
    points : Points
    aim : CalibrationAim
    """

    def __init__(self, points: Points, aim: CalibrationAim) -> None:
        self.points, self.aim = points, aim
        self.variables = design_variables(points.variables, aim.scales)
        self.values = np.concatenate([m.values for m in aim.measured])
        sizes = [len(m.values) for m in aim.measured]
        self.block = np.repeat(np.arange(len(sizes)), sizes)
        self.weights = np.repeat([1.0 / m.sd if m.sd > 0.0 else 1.0 for m in aim.measured], sizes)
        self.largest = np.repeat([np.abs(m.values).max() for m in aim.measured], sizes)
        self.known = all(m.sd > 0.0 for m in aim.measured)

    def carry_out(self) -> Calibration:
        """Execute the runs and fit the variables.

        Raises
        ------
        Interrupted
            After Ctrl-C.
        CurveError
            A run has not the quantity, the history or the label that was measured, or no run fits.
        """
        (at_start,) = self.points.results([self.points.nominal])
        self._check(at_start)
        fits = []
        for x in self._starts():
            fits.append(
                (x, fit(self._residuals, self._jacobian, x, self.block, self.known, self.aim.confidence))
            )
        best = min((f for _, f in fits), key=lambda f: f.cost)
        starts = [StartedFit(self._point(x), self._point(f.x), f.cost) for x, f in fits]
        return Calibration(
            [self._variable(i, best) for i in range(len(self.variables))],
            list(self._compared(self.points.results([self._point(best.x)])[0])),
            starts,
            correlated(best, [v.name for v in self.variables], CORRELATED),
            best.scatter,
            self.known,
            self.aim.confidence,
        )

    def _starts(self) -> list[Array]:
        """Points of the unit cube from which the search starts."""
        from scipy.stats.qmc import Sobol

        first = np.array([v.share(v.value) for v in self.variables])
        if self.aim.starts == 1:
            return [first]
        spread = Sobol(len(first), scramble=False).random_base2((self.aim.starts - 1).bit_length() + 1)
        return [first, *spread[1 : self.aim.starts]]

    def _point(self, x: Array) -> tuple[float, ...]:
        """Values of the variables at a point of the unit cube."""
        return tuple(v.unrounded(min(max(float(s), 0.0), 1.0)) for v, s in zip(self.variables, x))

    def _residuals(self, x: Array) -> Array:
        """Weighted residuals at a point of the unit cube."""
        (result,) = self.points.results([self._point(x)])
        return self._of(result)

    def _jacobian(self, x: Array) -> Array:
        """Derivatives of the weighted residuals, by differences within the bounds, shape (n, p)."""
        ends = np.array([[x, x]] * len(x))
        for i in range(len(x)):
            ends[i, :, i] = np.clip([x[i] - STEP, x[i] + STEP], 0.0, 1.0)
        results = self.points.results(self._point(end) for pair in ends for end in pair)
        columns = []
        for i, (low, high) in enumerate(zip(results[::2], results[1::2])):
            columns.append((self._of(high) - self._of(low)) / (ends[i, 1, i] - ends[i, 0, i]))
        return np.array(columns).T

    def _of(self, result: PointResult) -> Array:
        """Weighted residuals of the runs of one point; large where a run has no value."""
        model = np.concatenate([self._model(m, result) for m in self.aim.measured])
        missing = np.where(np.isnan(model), UNREACHED * self.largest, model - self.values)
        return np.asarray(missing * self.weights)

    def _model(self, m: Measured, result: PointResult) -> Array:
        """What the runs of a point give in place of the measured values; NaN where they end before."""
        r = self._record(m, result)
        if m.asked is not None:
            return np.array([value_of(result.values[r], m.asked)])
        kept = self._kept(result, r)
        rows = measured.column(kept, m.history, m.label)[0]
        if rows is None:
            return np.full(len(m.times), np.nan)
        return np.interp(m.times, kept["time"], rows, math.nan, math.nan)

    def _kept(self, result: PointResult, r: int) -> Mapping[str, Array]:
        """Histories that a run has kept."""
        path = self.points.session.journal.histories(result.runs[r].identity)
        if not path.is_file():
            return {}
        with np.load(path) as kept:
            return dict(kept)

    def _record(self, m: Measured, result: PointResult) -> int:
        """Number of the run under the record of a measured value."""
        names = [run.shaking.record.name if run.shaking else "" for run in result.runs]
        if not m.record and len(names) == 1:
            return 0
        if m.record not in names:
            there = f"there are {', '.join(names)}" if any(names) else "the motion is that of the deck"
            raise CurveError(
                f"{m.name}: no record {m.record}: {there}" if m.record else f"{m.name}: name its record"
            )
        return names.index(m.record)

    def _check(self, result: PointResult) -> None:
        """Raise CurveError if the runs at the values of the study have not what was measured."""
        for m in self.aim.measured:
            r = self._record(m, result)
            entry = result.entries[r]
            if not result.values[r]:
                raise CurveError(f"the run with the values of the study {entry.status}: {entry.message}")
            if m.asked is not None:
                require(result.values[r], m.asked)
                if math.isnan(value_of(result.values[r], m.asked)):
                    raise CurveError(f"the run with the values of the study has no {m.name}")
            if m.history:
                rows, labels = measured.column(self._kept(result, r), m.history, m.label)
                if rows is None:
                    what = f"no label {m.label}" if m.label else "several labels"
                    raise CurveError(f"{m.history} has {what}: there are {', '.join(labels)}")

    def _variable(self, i: int, best: Fit) -> FittedVariable:
        """A variable with its interval."""
        v, share, half = self.variables[i], float(best.x[i]), float(best.half[i])
        low, high = (share + sign * half for sign in (-1.0, 1.0))
        if math.isfinite(half):
            low, high = v.unrounded(low), v.unrounded(high)
        if math.isnan(half):
            remark = f"at its {'lower' if share < 0.5 else 'upper'} bound"
        else:
            remark = "" if math.isfinite(half) else "the measured values do not determine it"
        return FittedVariable(v.name, v.value, self._point(best.x)[i], low, high, remark)

    def _unit(self, m: Measured, result: PointResult) -> str:
        """Unit of measured values."""
        if m.asked is not None:
            unit = next(q.unit for q in QUANTITIES if q.name == m.asked.quantity)
            return Units(*self.points.session.study.units, stated=True).text(unit)
        kept = self._kept(result, self._record(m, result))
        labels, units = measured.column(kept, m.history, m.label)[1], kept[f"{m.history}|unit"].tolist()
        return str(units[labels.index(m.label) % len(units) if m.label else 0])

    def _compared(self, result: PointResult) -> Sequence[MeasuredFit]:
        """Measured values beside those of the fitted runs."""
        return [
            MeasuredFit(
                m.name,
                m.record,
                self._unit(m, result),
                m.times,
                m.values,
                model := self._model(m, result),
                m.sd,
                autocorrelation_time(model - m.values),
            )
            for m in self.aim.measured
        ]
