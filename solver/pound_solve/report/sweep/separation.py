"""Report of separations: the probability of contact over the gap, compared with rules."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from pound_solve.report.plot import suites
from pound_solve.report.text import printed
from pound_solve.results.columns import CONTACT
from pound_solve.results.schema import Column, Row, Sheet
from pound_solve.results.sweep_file import Sweep, Variable
from pound_solve.statistics.curves import FRACTILES, fractiles_of, measure, units_of
from pound_solve.statistics.needed_gaps import ANY, NeededGaps, Options
from pound_solve.statistics.separation import RULES, share

STEPS: Final = 8  #: number of gaps in the table if none are given
POINTS: Final = 400  #: points of a drawn curve


def needs(groups: Sequence[NeededGaps]) -> Iterator[Row]:
    """One row for each group: fractiles and lognormal fit of the gaps that its runs needed."""
    for g in groups:
        row: list[float] = [math.nan] * 3
        if len(g.needed) and not len(g.met):
            row = fractiles_of(g.needed).tolist()
        fitted = g.fitted
        fit = (fitted.median, *fitted.median_interval, fitted.dispersion) if fitted else [math.nan] * 4
        row.append(float(g.needed.max(initial=0.0)) if not len(g.met) else math.nan)
        counts = len(g.needed), len(g.met)
        yield g.case, g.level, g.contact, *counts, *row, *map(_finite, fit), _remark(g)


def _finite(x: float) -> float:
    return x if math.isfinite(x) else math.nan


def _remark(g: NeededGaps) -> str:
    """Remark on missing runs of a group, and on runs with collisions, which need an unknown wider gap."""
    remarks = []
    if len(g.met):
        remarks.append(f"met at a gap of {g.met.min():.6g} or more: wider gaps are not known")
    if g.left_out:
        remarks.append(f"{g.left_out} runs stopped, failed or are missing")
    return "; ".join(remarks)


def probabilities(groups: Sequence[NeededGaps], options: Options) -> Iterator[Row]:
    """Rows of the probability of contact in each group: at gaps of the rules, then at requested ones."""
    for g in groups:
        asked = [("", "", gap) for gap in options.gaps or _steps(g)]
        for name, source, gap in (*((r.name, r.source, x) for r, x in zip(RULES, g.rules)), *asked):
            count, total = g.contacts(gap)
            if math.isfinite(gap):
                estimate = share(count, total, options.level)
                yield g.case, g.level, g.contact, name, source, gap, count, total, *estimate, g.by_fit(gap)


def _steps(g: NeededGaps) -> list[float]:
    """Gaps in equal steps up to the widest needed gap or, if runs collided, the widest known one."""
    most = float(g.met.min()) if len(g.met) else float(g.needed.max(initial=0.0))
    return np.linspace(0.0, most, STEPS + 1)[1:].tolist() if most > 0.0 else []


def report(sweep: Sweep, groups: Sequence[NeededGaps], options: Options) -> Iterator[str]:
    """Lines of both tables; probabilities are those of all contacts together."""
    units, level = units_of(sweep), measure(sweep)
    yield from printed(units, needed_table(level, options.level), needs(groups))
    yield ""
    rows = probabilities(_together(groups), options)
    yield from printed(units, probability_table(level, options.level), rows)


def _together(groups: Sequence[NeededGaps]) -> list[NeededGaps]:
    """One group for every case and level: that of all its contacts."""
    several = {(g.case, g.level) for g in groups if g.contact == ANY}
    return [g for g in groups if g.contact == ANY or (g.case, g.level) not in several]


def variables(sweep: Sweep, groups: Sequence[NeededGaps], options: Options) -> dict[str, Variable]:
    """Columns of the table of probabilities as variables of a file."""
    table, units = probability_table(measure(sweep), options.level), units_of(sweep)
    columns = zip(*probabilities(groups, options))
    return {
        c.name: Variable(np.array(values, object if c.is_text else None), "", units.text(c.unit), c.doc)
        for c, values in zip(table.columns, columns)
    }


def drawn(sweep: Sweep, groups: Sequence[NeededGaps], options: Options) -> list[suites.Contacts]:
    """Data of the picture of every case and level, all its contacts together."""
    panels = []
    for g in _together(groups):
        rules: dict[float, list[str]] = {}
        for rule, gap in zip(RULES, g.rules):
            if math.isfinite(gap):
                rules.setdefault(gap, []).append(rule.name)
        most = 1.2 * max((*g.needed, *g.met, *rules), default=0.0)
        gaps = np.linspace(0.0, min(most, g.met.min(initial=math.inf)), POINTS)
        seen = np.array([share(*g.contacts(x), options.level) for x in gaps])
        title = ", ".join(filter(None, [g.case, f"{measure(sweep)} {g.level:g}"]))
        named = [(", ".join(names), gap) for gap, names in rules.items()]
        panels.append(suites.Contacts(title, gaps, seen, np.array([g.by_fit(x) for x in gaps]), named))
    return panels


def _keys(measure: str) -> tuple[Column, ...]:
    """Columns that identify a group."""
    return (
        Column("case", "case", doc="PARAMs that differ in the sweep"),
        Column("level", measure, "-", "short", doc="level of the records"),
        CONTACT,
    )


def needed_table(measure: str, level: float) -> Sheet:
    """The table of needed gaps."""
    sure = f"{100 * level:g} %\nfrom"
    return Sheet(
        columns=(
            *_keys(measure),
            Column("free", "runs\nfree", fmt="int", doc="runs in which nothing met"),
            Column("met", "met", fmt="int", doc="runs in which something met"),
            *(
                Column(f"q{n}", f"{100 * q:.0f} %", "L", "short", doc="not exceeded by so many runs")
                for n, q in enumerate(FRACTILES)
            ),
            Column("most", "largest", "L", "short", doc="largest gap that a run needed"),
            Column("median", "lognormal\nmedian", "L", "short", doc="of the fitted distribution"),
            Column("low", sure, "L", "short", doc="interval of the median"),
            Column("high", "to", "L", "short", doc="interval of the median"),
            Column("beta", "dispersion", "-", "short", doc="standard deviation of the logarithm"),
            Column("remark", "remark", doc="what is missing"),
        ),
        note="The gap that a run needs is its largest closure. The lognormal distribution takes runs that "
        "met for ones that needed more than their gap.",
    )


def probability_table(measure: str, level: float) -> Sheet:
    """The table of probabilities of contact."""
    sure = f"{100 * level:g} %\nfrom"
    return Sheet(
        columns=(
            *_keys(measure),
            Column("rule", "rule", doc="rule that gives the gap; empty for a gap that is asked for"),
            Column("source", "source", doc="where the rule stands"),
            Column("gap", "gap", "L", "short", doc="gap"),
            Column("contacts", "contacts", fmt="int", doc="runs that need more than the gap"),
            Column("runs", "runs", fmt="int", doc="runs that tell; 0: the gap is wider than known"),
            Column("probability", "probability", "-", "short", doc="contacts over runs"),
            Column("low", sure, "-", "short", doc="exact interval of the probability"),
            Column("high", "to", "-", "short", doc="exact interval of the probability"),
            Column("lognormal", "lognormal", "-", "short", doc="probability by the fitted distribution"),
        ),
        note="Rules take the mean peaks of the runs of a case and level in which nothing met. The interval "
        "is that of Clopper and Pearson.",
    )
