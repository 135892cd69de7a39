"""Report of fragilities: the probability that a demand exceeds a limit, over the level, for every case."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from pound_solve.report.plot import suites
from pound_solve.report.text import printed
from pound_solve.results.schema import Column, Row, Sheet
from pound_solve.results.sweep_file import Sweep
from pound_solve.statistics.curves import Asked, measure, unit_of, units_of
from pound_solve.statistics.fragility_of_sweep import Fitted

POINTS: Final = 200  #: points of a drawn curve
DIGITS: Final = 4  #: digits of printed probabilities


def rows(fits: Sequence[Fitted]) -> Iterator[Row]:
    """One row for each fragility."""
    for f in fits:
        fit = f.fragility
        if fit is None:
            yield f.case, f.limit, f.method, 0, *([math.nan] * 6), f.remark
        else:
            ends = fit.median, *fit.median_interval, fit.dispersion, *fit.dispersion_interval
            yield f.case, f.limit, f.method, fit.count, *map(_finite, ends), f.remark


def _finite(x: float) -> float:
    return x if math.isfinite(x) else math.nan


def report(sweep: Sweep, asked: Asked, fits: Sequence[Fitted], at: Sequence[float]) -> Iterator[str]:
    """Lines of the table of fragilities, and of their probabilities at some levels."""
    units, unit = units_of(sweep), unit_of(sweep, asked)
    sure = next((f.fragility.level for f in fits if f.fragility is not None), math.nan)
    yield f"Demand: {asked.quantity} {asked.label}".rstrip()
    yield _base(sweep, fits)
    yield ""
    yield from printed(units, fragility_table(unit, sure), rows(fits))
    if at:
        yield ""
        yield from printed(units, probability_table(unit, at), _probable(fits, at))


def _base(sweep: Sweep, fits: Sequence[Fitted]) -> str:
    """Line of text on the runs to which the fragilities are fitted."""
    seen = {f.case: f.observed for f in fits}
    levels = sorted({x for observed in seen.values() for x, _, _ in observed})
    runs = sum(count for observed in seen.values() for _, _, count in observed)
    which = (
        f"{measure(sweep)} {levels[0]:.6g} to {levels[-1]:.6g}, {len(levels)} levels" if levels else "none"
    )
    return f"Runs: {runs} of the {len(sweep)} in the sweep; {which}"


def _probable(fits: Sequence[Fitted], at: Sequence[float]) -> Iterator[Row]:
    """One row for each fragility: its probabilities at some levels."""
    for f in fits:
        values = f.fragility.probability(at) if f.fragility else np.full(len(at), math.nan)
        yield f.case, f.limit, *np.round(values, DIGITS).tolist()


def drawn(fits: Sequence[Fitted]) -> list[suites.Fragilities]:
    """Data of the picture of all fragilities that could be fitted."""
    curves = []
    most = max((x for f in fits for x, _, _ in f.observed), default=0.0)
    at = np.linspace(0.0, most, POINTS)[1:]
    for f in fits:
        if f.fragility is not None:
            limit = "" if math.isnan(f.limit) else f"limit {f.limit:g}"
            level, exceeded, runs = np.array(f.observed, np.float64).T
            title = ", ".join(filter(None, [f.case, limit])) or "collapse"
            fit, seen = f.fragility, (level, exceeded / runs) if f.method == "stripes" else (at[:0], at[:0])
            curves.append(
                suites.Fragilities(title, at, fit.probability(at), seen, fit.median, fit.median_interval)
            )
    return curves


def fragility_table(unit: str, level: float) -> Sheet:
    """Table of fragilities for a unit of the demand and a level of confidence."""
    sure = f"{100 * level:g} %"
    return Sheet(
        columns=(
            Column("case", "case", doc="PARAMs that differ in the sweep"),
            Column("limit", "limit", unit, "given", doc="of the demand"),
            Column("method", "from", doc="capacities, stripes or cloud"),
            Column("n", "data", fmt="int", doc="records or runs"),
            Column("median", "median", "-", "short", doc="level of probability one half"),
            Column("low", f"{sure}\nfrom", "-", "short", doc="interval of the median"),
            Column("high", "to", "-", "short", doc="interval of the median"),
            Column("beta", "dispersion", "-", "short", doc="standard deviation of the logarithm"),
            Column("beta_low", f"{sure}\nfrom", "-", "short", doc="interval of the dispersion"),
            Column("beta_high", "to", "-", "short", doc="interval of the dispersion"),
            Column("remark", "remark", doc="what is missing"),
        ),
        note="Lognormal, most likely parameters; intervals by profile likelihood. The dispersion is that "
        "of the records alone: it knows no uncertainty of the model.",
    )


def probability_table(unit: str, at: Sequence[float]) -> Sheet:
    """The table of probabilities at some levels."""
    return Sheet(
        columns=(
            Column("case", "case", doc="PARAMs that differ in the sweep"),
            Column("limit", "limit", unit, "given", doc="of the demand"),
            *(Column(f"p{n}", f"at\n{x:g}", "-", "short", doc="probability") for n, x in enumerate(at)),
        )
    )
