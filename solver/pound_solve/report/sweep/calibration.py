"""Report of a calibration: fitted variables with intervals, fit of the measured values, other starts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from pound_solve.report.plot.suites import FitPanel
from pound_solve.report.text import printed
from pound_solve.results.schema import Column, Row, Sheet
from pound_solve.results.sweep_file import Sweep, Variable
from pound_solve.statistics.calibration import Calibration, MeasuredFit
from pound_solve.statistics.curves import units_of

SAME: Final = 1e-3  #: relative difference of two sums of squares up to which two searches agree
LACKS: Final = 1.5  #: scatter over the known standard deviations above which the model lacks something


def report(sweep: Sweep, result: Calibration, deck: str) -> Iterator[str]:
    """Lines of the report; `deck` is the name of the deck in the study."""
    units = units_of(sweep)
    yield from printed(units, variables_table(result.confidence), _variables(result))
    yield ""
    for one, other, correlation in result.correlated:
        yield f"The errors of {one} and {other} are correlated by {correlation:.3f}:"
        yield "the measured values tell little more than one combination of them."
    yield from printed(units, FITS, map(_fit, result.fits))
    yield ""
    yield from _scatter(result)
    yield from _agreement(result)
    options = " ".join(f"--set {v.name}={v.value!r}" for v in result.variables)
    yield from ("", "The run that fits best:", f"  pound-solve {deck} {options}")


def _variables(result: Calibration) -> Iterator[Row]:
    for v in result.variables:
        ends = ("", "") if v.remark else (f"{v.low:.6g}", f"{v.high:.6g}")
        yield v.name, f"{v.start:.6g}", f"{v.value:.6g}", *ends, v.remark


def _fit(m: MeasuredFit) -> Row:
    peak = m.is_peak
    ends = (m.measured[0], m.fitted[0]) if peak else (np.abs(m.measured).max(), np.nanmax(np.abs(m.fitted)))
    peaks = [f"{end:.5g}" for end in ends]
    return m.name, m.record, m.unit, len(m.measured), *peaks, m.scatter, m.sd, m.memory


def _scatter(result: Calibration) -> Iterator[str]:
    """What the differences that remain tell."""
    if result.known and result.scatter > LACKS:
        yield f"The differences are {result.scatter:.3g} times the given standard deviations:"
        yield "the model lacks something, or the values are less certain; the intervals allow for it."
    if any(m.memory > 2.0 for m in result.fits):
        yield "Successive differences are correlated: the last column is the number that counts as one."
        yield "What the model lacks may shift the variables by more than the intervals."


def _agreement(result: Calibration) -> Iterator[str]:
    """Whether all starts ended at one fit."""
    if len(result.starts) == 1:
        return
    best = min(s.cost for s in result.starts)
    others = sorted(
        s.cost / best if best > 0.0 else np.inf for s in result.starts if s.cost > best * (1.0 + SAME)
    )
    count = len(result.starts) - len(others)
    yield f"{count} of {len(result.starts)} starts ended at this fit."
    if others:
        yield f"There are other local fits: the next sum of squares is {others[0]:.4g} times as large."


def columns(result: Calibration) -> dict[str, Variable]:
    """Measured and fitted values as columns of a file."""
    fits = result.fits
    counts = [len(m.measured) for m in fits]

    def repeated(values: list[str]) -> Variable:
        return Variable(np.repeat(np.array(values, object), counts))

    return {
        "measured": repeated([m.name for m in fits]),
        "record": repeated([m.record for m in fits]),
        "unit": repeated([m.unit for m in fits]),
        "time": Variable(np.concatenate([m.times for m in fits]), doc="empty for a peak"),
        "value": Variable(np.concatenate([m.measured for m in fits]), doc="measured"),
        "fitted": Variable(np.concatenate([m.fitted for m in fits]), doc="of the fitted run"),
    }


def about(sweep: Sweep, result: Calibration) -> dict[str, str]:
    """Attributes of the file: those of the sweep, and the fitted variables with their intervals."""
    fitted = {v.name: f"{v.value!r} from {v.low!r} to {v.high!r}" for v in result.variables}
    return {**sweep.about, "confidence": repr(result.confidence), **fitted}


def drawn(sweep: Sweep, result: Calibration) -> list[FitPanel]:
    """Data of the picture: each measured history and its fit, and the peaks as ratios."""
    time = f"time [{units_of(sweep).time}]"
    panels = [
        FitPanel(
            " ".join(filter(None, [m.name, m.record])),
            time,
            f"[{m.unit or '-'}]",
            m.times,
            m.measured,
            m.fitted,
        )
        for m in result.fits
        if not m.is_peak
    ]
    if peaks := [m for m in result.fits if m.is_peak]:
        at = np.arange(1.0, len(peaks) + 1.0)
        ratio = np.array([m.fitted[0] / m.measured[0] if m.measured[0] else np.nan for m in peaks])
        panels.append(
            FitPanel("peaks", "number of the peak", "over the measured [-]", at, np.ones(len(at)), ratio)
        )
    return panels


def variables_table(confidence: float) -> Sheet:
    """Table of the variables with intervals of a confidence."""
    share = f"{100.0 * confidence:g} % interval"
    return Sheet(
        columns=(
            Column("variable", doc="PARAM, or the factor on the records"),
            Column("start", doc="value in the study"),
            Column("value", "fitted", doc="value that fits best"),
            Column("low", f"{share}\nfrom", doc="lower end of the interval"),
            Column("high", f"{share}\nto", doc="upper end of the interval"),
            Column("remark", doc="why it has no interval"),
        )
    )


FITS: Final = Sheet(
    columns=(
        Column("measured", doc="quantity or history"),
        Column("record", doc="record"),
        Column("unit", doc="of the values"),
        Column("values", "values", fmt="int", doc="number of values"),
        Column("peak", "measured\npeak", doc="largest measured magnitude, or the peak"),
        Column("fitted", "fitted\npeak", doc="the same of the fitted run"),
        Column("scatter", "scatter", fmt="short", doc="root mean square of the differences"),
        Column("sd", "given sd", fmt="short", doc="standard deviation of the measured values"),
        Column(
            "memory", "values\nas one", fmt="short", doc="values that tell as much as an independent one"
        ),
    )
)
