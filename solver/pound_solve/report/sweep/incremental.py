"""Report of an incremental analysis: the capacity of every record, and fractiles over the level."""

from __future__ import annotations

import math
from collections.abc import Iterator
from types import MappingProxyType
from typing import Final

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.plot import suites
from pound_solve.report.text import printed
from pound_solve.results.schema import Column, Row, Sheet
from pound_solve.results.sweep_file import Sweep
from pound_solve.statistics.curves import (
    FRACTILES,
    Asked,
    IdaCurve,
    by_case,
    curves,
    measure,
    unit_of,
    units_of,
)
from pound_solve.statistics.fractiles import Analysis, fractiles, levels
from pound_solve.statistics.incremental import STANDS, Rules, collapse, ends, standing

LEVEL_NAMES: Final = MappingProxyType(
    {
        "sa": "Sa / gravity [-]",
        "pga": "peak acceleration / gravity [-]",
        "scale": "factor on the record [-]",
    }
)


def capacities(analysis: Analysis) -> Iterator[Row]:
    """One row for each record: the levels between which the structure collapses."""
    for curve in analysis.curves:
        stands, falls = collapse(curve.points, analysis.rules)
        how = [end for end in ends(curve.points, analysis.rules) if end != STANDS]
        remark = how[0] if how else "stands"
        if curve.left_out:
            remark += f"; runs that failed or are missing: {curve.left_out}"
        yield curve.record, len(curve.points), stands, falls if how else math.nan, remark


def rows_of_fractiles(analysis: Analysis) -> Iterator[Row]:
    """One row for each level: the fractiles of the demand."""
    at = levels(analysis)
    for level, values in zip(at, fractiles(analysis, at)):
        yield (level, *(x if math.isfinite(x) else math.nan for x in values))


def report(sweep: Sweep, asked: Asked, rules: Rules) -> Iterator[str]:
    """Lines of the tables of capacities and fractiles of every case.

    Raises
    ------
    CurveError
        See `curves`.
    """
    units = units_of(sweep)
    table = fractile_table(measure(sweep), unit_of(sweep, asked))
    yield f"Demand: {asked.quantity} {asked.label}".rstrip()
    for case, records in by_case(curves(sweep, asked)).items():
        analysis = Analysis(records, rules)
        yield from ("", case) if case else ("",)
        yield from printed(units, CAPACITIES, capacities(analysis))
        yield ""
        yield from printed(units, table, rows_of_fractiles(analysis))
        yield ""


def drawn(sweep: Sweep, asked: Asked, rules: Rules) -> list[suites.Curves]:
    """Data of the picture of every case."""
    cases = []
    for case, records in by_case(curves(sweep, asked)).items():
        analysis = Analysis(records, rules)
        at = np.append(0.0, levels(analysis))
        demands = np.vstack([np.zeros(len(FRACTILES)), fractiles(analysis, at[1:])])
        named = [
            (f"{100 * q:.0f} %", np.where(np.isfinite(x), x, np.nan)) for q, x in zip(FRACTILES, demands.T)
        ]
        cases.append(suites.Curves(case, [_line(c, rules) for c in records], at, named))
    return cases


def _line(curve: IdaCurve, rules: Rules) -> tuple[Array, Array]:
    """Demands and levels of a record from the origin up to the highest level without collapse."""
    levels, demands = np.array(standing(curve.points, rules)).T
    return demands, levels


def axes_of(sweep: Sweep, asked: Asked) -> tuple[str, str]:
    """Names of the demand and of the level, with their units."""
    unit = f"[{unit_of(sweep, asked) or '-'}]"
    demand = " ".join(filter(None, [asked.quantity.replace("_", " "), asked.label, unit]))
    return demand, LEVEL_NAMES[measure(sweep)]


CAPACITIES: Final = Sheet(
    columns=(
        Column("record", "record", doc="record"),
        Column("runs", "runs", fmt="int", doc="runs of it"),
        Column("stands", "highest level\nthat stands", "-", "short", doc="below the first that collapses"),
        Column("falls", "lowest level\nthat collapses", "-", "short", doc="NaN where none does"),
        Column("end", "how", doc="what counts as its collapse"),
    ),
    note="A record collapses the structure where its run stops, where the demand reaches the limit, or "
    "where the curve has gone flat.",
)


def fractile_table(measure: str, unit: str) -> Sheet:
    """Table of fractiles for a measure of the levels and a unit of the demand."""
    names = [f"{100 * q:.0f} %" for q in FRACTILES]
    return Sheet(
        columns=(
            Column("level", f"level\n{measure}", "-", "short", doc="level of all records"),
            *(
                Column(
                    f"q{n}", f"demand\n{name}", unit, "num", doc=f"not exceeded by {name} of the records"
                )
                for n, name in enumerate(names)
            ),
        ),
        note="Nothing stands where so many records have collapsed, or a record was not run so far.",
    )
