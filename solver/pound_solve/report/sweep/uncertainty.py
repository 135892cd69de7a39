"""Report of an analysis of uncertainty: statistics of quantities, probabilities, indices and tornado."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.plot.uncertain import UncertainPanel
from pound_solve.report.text import WIDTH, printed
from pound_solve.results.schema import Column, Row, Sheet
from pound_solve.results.sweep_file import Sweep, Variable
from pound_solve.statistics.curves import Asked, unit_of, units_of
from pound_solve.statistics.propagation import CONTACT, SPREAD, Propagated, UncertaintyAim
from pound_solve.statistics.replicates import REPLICATES, Estimate, fractiles, moments, share
from pound_solve.statistics.sobol_indices import indices

SHARES: Final = (0.05, 0.16, 0.5, 0.84, 0.95)  #: fractiles in tables
RECORD: Final = "record"  #: the variable of the indices beside those of the study
MEAN, DEVIATION, FRACTILE, FIRST, TOTAL, SWING = (
    "mean", "standard deviation", "fractile", "first order", "total", "tornado",
)  # fmt: skip


class Evaluation:
    """Statistics of the runs of an analysis.

    Parameters
    ----------
    sweep : Sweep
        The runs.
    variables : mapping of str to float
        Values of the variables in the study.
    aim : UncertaintyAim
    runs : Propagated
    """

    def __init__(
        self, sweep: Sweep, variables: Mapping[str, float], aim: UncertaintyAim, runs: Propagated
    ) -> None:
        self.sweep, self.variables, self.aim, self.runs = sweep, variables, aim, runs
        others = () if aim.quantities else (CONTACT,)
        self.shown = [q for q in aim.quantities or runs.sample if q not in others]
        self.moments = {q: moments(runs.sample[q], aim.level) for q in self.shown}
        self.fractiles = {q: fractiles(runs.sample[q], np.array(SHARES), aim.level) for q in self.shown}
        limits = [*aim.limits, *([(CONTACT, 1.0)] if CONTACT in runs.sample else [])]
        self.shares = [(q, x, share(_reached(runs.sample[q], x), aim.level)) for q, x in limits]
        self.indices = {q: self._indices(q) for q in self.shown} if aim.with_indices else {}

    def _indices(self, q: Asked) -> tuple[Estimate, Estimate] | None:
        """Indices of a quantity of first order and in total; None where not all its runs have a value, or
        all have the same.
        """
        half = self.aim.runs // REPLICATES
        sample, mixtures = self.runs.sample[q], self.runs.mixtures[q]
        if not (np.isfinite(sample).all() and np.isfinite(mixtures).all() and np.ptp(sample) > 0.0):
            return None
        return indices(sample[:, :half], sample[:, half:], mixtures, self.aim.level)

    def name(self, q: Asked) -> str:
        """Name of a quantity with its unit."""
        return f"{' '.join(filter(None, q))} [{unit_of(self.sweep, q) or '-'}]"

    @property
    def factors(self) -> list[str]:
        """Variables that have indices: the record too if there are several."""
        names = list(self.variables)
        several = next(iter(self.runs.nominal.values())).size > 1
        return [*names, *([RECORD] if several else [])]

    def of_variables(self) -> Iterator[Row]:
        """One row for each variable."""
        for name, value in self.variables.items():
            d = self.aim.distributions[name]
            p = d.parameters
            given = [p.mean, p.sd, p.mode, p.low, p.high]
            known = (x if math.isfinite(x) else math.nan for x in given)
            yield (
                name,
                value,
                d.family,
                *known,
                *d.quantile(np.array([SPREAD[0], 0.5, SPREAD[1]])).tolist(),
            )

    def of_quantities(self) -> Iterator[Row]:
        """One row for each quantity: its mean and standard deviation."""
        for q, (mean, sd) in self.moments.items():
            values = self.runs.sample[q]
            unknown, stopped = int(np.isnan(values).sum()), int(np.isinf(values).sum())
            remarks = [f"{unknown} runs failed"] if unknown else []
            if stopped:
                remarks.append(f"{stopped} runs stopped: no mean")
            elif np.isnan(mean.low):
                remarks.append("too few runs differ: no interval")
            nominal = float(self.runs.nominal[q].mean())
            yield self.name(q), nominal, *_numbers(mean), *_numbers(sd), "; ".join(remarks)

    def of_fractiles(self) -> Iterator[Row]:
        """One row for each quantity and fractile."""
        for q, estimate in self.fractiles.items():
            for k, at in enumerate(SHARES):
                yield self.name(q), 100.0 * at, *(float(x[k]) for x in estimate)

    def of_limits(self) -> Iterator[Row]:
        """One row for each limit: the probability that it is reached; contact is one of them."""
        for q, limit, estimate in self.shares:
            hits = _reached(self.runs.sample[q], limit)
            count, runs = int(np.nansum(hits)), int((~np.isnan(hits)).sum())
            what = "contact" if (q, limit) == (CONTACT, 1.0) else f"{self.name(q)} >= {limit:g}"
            yield what, count, runs, *_numbers(estimate)

    def of_indices(self) -> Iterator[Row]:
        """One row for each quantity and variable."""
        for q, estimates in self.indices.items():
            for k, factor in enumerate(self.factors if estimates else ()):
                yield self.name(q), factor, *(float(x[k]) for e in estimates or () for x in e)

    def of_tornado(self) -> Iterator[Row]:
        """One row for each quantity and variable, the largest swing first: means of the records."""
        for q in self.shown:
            means = self.runs.tornado[q].mean(axis=1)
            rows = [
                (name, low, high, abs(high - low))
                for name, low, high in zip(self.variables, means[1::2].tolist(), means[2::2].tolist())
            ]
            rows.sort(key=lambda row: -row[3] if row[3] == row[3] else math.inf)
            for name, low, high, swing in rows:
                yield self.name(q), name, low, float(means[0]), high, swing

    def report(self) -> Iterator[str]:
        """Lines of the report."""
        units, sure = units_of(self.sweep), f"{100 * self.aim.level:g} %"
        yield from _wrapped(self._plan())
        yield ""
        yield from printed(units, VARIABLES, self.of_variables())
        if self.aim.is_dependent:
            yield from ("", *printed(units, CORRELATIONS, self._correlations()))
        yield from ("", *printed(units, quantity_table(sure), self.of_quantities()))
        yield from ("", *printed(units, fractile_table(sure), self.of_fractiles()))
        if self.shares:
            yield from ("", *printed(units, limit_table(sure), self.of_limits()))
        if any(self.indices.values()):
            yield from ("", *printed(units, index_table(sure), self.of_indices()))
        for q, estimates in self.indices.items():
            if estimates is None:
                yield from ("", *_wrapped(f"{self.name(q)} has no indices: {self._why_no_indices(q)}."))
        yield from ("", *printed(units, TORNADO, self.of_tornado()))

    def _plan(self) -> str:
        """Sentences on the sample."""
        aim, records = self.aim, next(iter(self.runs.nominal.values())).size
        plan = {"sobol": "Sobol sequence", "latin": "Latin hypercube"}[aim.sampling]
        twice = 2 if aim.with_indices else 1
        text = (
            f"The sample has {twice * aim.runs} points: {REPLICATES} independent randomizations of a "
            f"{plan} of {aim.runs // REPLICATES}" + (", twice for the indices" if twice == 2 else "") + ". "
        )
        if records > 1:
            text += (
                f"Each point is run under all {records} records, which count alike: the statistics are "
                "those of points and records. The intervals hold for these records; they do not contain "
                "the choice of the records. "
            )
        return text + (
            f"The intervals of {100 * aim.level:g} % follow from the scatter of the randomizations; those "
            "of probabilities and fractiles are never narrower than those of independent points."
        )

    def _correlations(self) -> Iterator[Row]:
        """One row for each pair of variables that depend on each other."""
        names, matrix = list(self.variables), self.aim.correlation
        for i, j in zip(*np.triu_indices(len(names), 1)):
            if matrix[i, j] != 0.0:
                yield names[i], names[j], float(matrix[i, j])

    def _why_no_indices(self, q: Asked) -> str:
        values = [self.runs.sample[q], self.runs.mixtures[q]]
        stopped, failed = (sum(int(f(x).sum()) for x in values) for f in (np.isinf, np.isnan))
        if stopped or failed:
            return f"{stopped} of its runs stopped and {failed} failed, and its variance is not known"
        return "all its runs have the same value"

    def table(self) -> dict[str, Variable]:
        """Columns of the table of all statistics, one row for each."""
        rows = list(self._rows())
        columns = zip(*rows)
        texts = ("quantity", "unit", "statistic", "variable")
        return {
            name: Variable(np.array(values, object if name in texts else float), doc=doc)
            for (name, doc), values in zip(COLUMNS.items(), columns)
        }

    def _rows(self) -> Iterator[Row]:
        none = (math.nan,) * 2
        for q in self.shown:
            head = " ".join(filter(None, q)), unit_of(self.sweep, q)
            for statistic, estimate in zip((MEAN, DEVIATION), self.moments[q]):
                yield *head, statistic, "", math.nan, *_numbers(estimate)
            for k, at in enumerate(SHARES):
                yield *head, FRACTILE, "", at, *(float(x[k]) for x in self.fractiles[q])
            for statistic, of in zip((FIRST, TOTAL), self.indices.get(q) or ()):
                for k, factor in enumerate(self.factors):
                    yield *head, statistic, factor, math.nan, *(float(x[k]) for x in of)
            means = self.runs.tornado[q].mean(axis=1).tolist()
            yield *head, SWING, "", 0.5, means[0], *none
            for i, name in enumerate(self.variables):
                for at, value in zip(SPREAD, means[1 + 2 * i : 3 + 2 * i]):
                    yield *head, SWING, name, at, value, *none
        for q, limit, estimate in self.shares:
            yield " ".join(filter(None, q)), "", "probability", "", limit, *_numbers(estimate)

    def drawn(self) -> list[UncertainPanel]:
        """Data of the picture of every quantity with finite values."""
        panels = []
        rows = list(self.of_tornado())
        for q in self.shown:
            values = np.sort(self.runs.sample[q], axis=None)
            values = values[~np.isnan(values)]
            limits = [x for other, x in self.aim.limits if other == q]
            bars = [(r[1], r[2], r[4]) for r in rows if r[0] == self.name(q) and math.isfinite(r[5])]
            if np.isfinite(values).any():
                middle = float(self.runs.tornado[q][0].mean())
                panels.append(UncertainPanel(self.name(q).replace("_", " "), middle, bars, values, limits))
        return panels


def _reached(values: Array, limit: float) -> Array:
    """1 for a value that reaches a limit, 0 for one that does not, NaN for one that is not known."""
    return np.where(np.isnan(values), np.nan, values >= limit)


def _numbers(estimate: Estimate) -> tuple[float, float, float]:
    return float(estimate.value), float(estimate.low), float(estimate.high)


def _wrapped(text: str) -> list[str]:
    return textwrap.wrap(text, WIDTH, initial_indent="  ", subsequent_indent="  ")


#: columns of the table of all statistics, and their meanings
COLUMNS: Final[Mapping[str, str]] = {
    "quantity": "quantity of the sweep",
    "unit": "unit of the value",
    "statistic": "what the value is",
    "variable": "variable of an index, or of a tornado",
    "at": "share of a fractile, fractile of the variable of a tornado, or limit",
    "value": "estimate",
    "low": "lower end of its interval",
    "high": "upper end of its interval",
}
_QUANTITY: Final = Column("quantity", doc="quantity and unit")
VARIABLES: Final = Sheet(
    columns=(
        Column("variable", doc="variable"),
        Column("nominal", "value", fmt="given", doc="value in the study"),
        Column("distribution", doc="its distribution"),
        Column("mean", fmt="given", doc="before a truncation"),
        Column("sd", "standard\ndeviation", fmt="given", doc="before a truncation"),
        Column("mode", fmt="given", doc="most probable value"),
        Column("low", fmt="given", doc="lower end"),
        Column("high", fmt="given", doc="upper end"),
        Column("q16", "16 %", fmt="num", doc="fractile"),
        Column("q50", "50 %", fmt="num", doc="fractile"),
        Column("q84", "84 %", fmt="num", doc="fractile"),
    ),
    group="variable",
    note="Mean and standard deviation are those before a truncation at the ends; fractiles those after it.",
)
CORRELATIONS: Final = Sheet(
    columns=(
        Column("one", "variable", doc="one variable"),
        Column("other", "variable", doc="the other"),
        Column("correlation", fmt="short", doc="of their normals"),
    ),
    note="Correlation of the standard normals to which the variables belong (Gaussian copula).",
)
TORNADO: Final = Sheet(
    columns=(
        _QUANTITY,
        Column("variable", doc="variable that is varied"),
        Column("low", f"{100 * SPREAD[0]:.0f} %", fmt="num", doc="at the lower fractile of the variable"),
        Column("middle", "50 %", fmt="num", doc="with all variables at their medians"),
        Column("high", f"{100 * SPREAD[1]:.0f} %", fmt="num", doc="at the upper fractile of the variable"),
        Column("swing", fmt="num", doc="distance of both"),
    ),
    group="quantity",
    note="Each variable at two of its fractiles, all others at their medians; mean of the records.",
)


def _ends(sure: str, name: str = "") -> tuple[Column, Column]:
    """Columns of an interval."""
    return (
        Column(f"{name}low", f"{sure}\nfrom", fmt="num", doc="interval"),
        Column(f"{name}high", "to", fmt="num", doc="interval"),
    )


def quantity_table(sure: str) -> Sheet:
    """The table of means and standard deviations."""
    return Sheet(
        columns=(
            _QUANTITY,
            Column("nominal", "at the values\nof the study", fmt="num", doc="mean of the records"),
            Column("mean", fmt="num", doc="over points and records"),
            *_ends(sure),
            Column("sd", "standard\ndeviation", fmt="num", doc="over points and records"),
            *_ends(sure, "sd_"),
            Column("remark", doc="what is missing"),
        ),
        group="quantity",
    )


def fractile_table(sure: str) -> Sheet:
    """The table of fractiles."""
    return Sheet(
        columns=(
            _QUANTITY,
            Column(
                "share", "fractile\n[%]", fmt="short", doc="share of the runs that do not exceed the value"
            ),
            Column("value", fmt="num", doc="order statistic of the runs"),
            *_ends(sure),
        ),
        group="quantity",
        note="A run that stopped counts as an infinite value.",
    )


def limit_table(sure: str) -> Sheet:
    """The table of probabilities."""
    return Sheet(
        columns=(
            Column("event", doc="limit that is reached"),
            Column("count", "runs that\nreach it", fmt="int", doc="runs that reach the limit"),
            Column("runs", "runs that\ntell", fmt="int", doc="runs that did not fail"),
            Column("probability", fmt="num", doc="share of the runs"),
            *_ends(sure),
        ),
        note="A run that stopped reaches every limit. The interval takes a run that failed as either.",
    )


def index_table(sure: str) -> Sheet:
    """The table of Sobol indices."""
    return Sheet(
        columns=(
            _QUANTITY,
            Column("variable", doc="variable; record: which of the records acts"),
            Column("first", "first\norder", fmt="short", doc="share of the variance by the variable alone"),
            *_ends(sure),
            Column("total", fmt="short", doc="share of the variance with all interactions"),
            *_ends(sure, "total_"),
        ),
        group="quantity",
        note="Shares of the variance: by the variable alone, and with its interactions (Saltelli 2010, "
        "Jansen 1999). Estimates may lie somewhat outside of 0 to 1.",
    )
