"""Separation of buildings from many records: the probability of contact against the gap, beside rules.

The runs whose gaps stayed open tell the gap that each of them needed.  A run in which something met needed
more than its smallest gap; it counts as contact up to there, and nothing is said of wider gaps.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.plot import suites
from pound_solve.report.text import printed
from pound_solve.results.columns import CONTACT
from pound_solve.results.schema import Column, Row, Table
from pound_solve.results.sweep_file import Sweep, Variable
from pound_solve.sweep.curves import FRACTILES, CurveError, cases, fractiles_of, measure, units_of
from pound_solve.sweep.entry import DONE
from pound_solve.theory.fragility import Fragility, FragilityError, from_capacities
from pound_solve.theory.separation import RULES, Peaks, share

ANY: Final = "any"  #: contact that stands for all, where a deck has several
STEPS: Final = 8  #: gaps of the table where none are given
POINTS: Final = 400  #: of a drawn curve
DIGITS: Final = 4  #: of probabilities by a distribution
NEEDS: Final = ("needed_gap", "given_gap", "peak_i", "peak_j", "correlation")


class Options(NamedTuple):
    """How separations are judged.

    Attributes
    ----------
    gaps : sequence of float
        At which probabilities are asked for; empty for steps up to the largest that was needed.
    correlation : float
        Of both buildings; NaN for that of their modes.
    raised : tuple of float
        Factors of codes on the displacements of both buildings.
    level : float
        Of confidence.
    """

    gaps: Sequence[float] = ()
    correlation: float = math.nan
    raised: tuple[float, float] = (1.0, 1.0)
    level: float = 0.95


class Group(NamedTuple):
    """One contact under the records of one case and level.

    Attributes
    ----------
    case : str
    level : float
    contact : str
        Its name, or `ANY`.
    needed : ndarray, shape (n_free,)
        Gap that each run needed in which nothing met.
    met : ndarray, shape (n_met,)
        Smallest gap of each run in which something met.
    left_out : int
        Runs that stopped, failed, or have not ended.
    rules : tuple of float
        Gaps by `RULES` for the mean peaks of the runs in which nothing met.
    fitted : Fragility or None
        Lognormal distribution of the gap that is needed.
    """

    case: str
    level: float
    contact: str
    needed: Array
    met: Array
    left_out: int
    rules: tuple[float, ...]
    fitted: Fragility | None

    def contacts(self, gap: float) -> tuple[int, int]:
        """Runs that meet at a gap, and all; no runs where some do not tell."""
        if (self.met < gap).any() or not math.isfinite(gap):
            return 0, 0
        return int((self.needed > gap).sum()) + len(self.met), len(self.needed) + len(self.met)

    def by_fit(self, gap: float) -> float:
        """Probability of contact by the lognormal distribution."""
        if self.fitted is None or not math.isfinite(gap):
            return math.nan
        return 1.0 if gap <= 0.0 else round(1.0 - float(self.fitted.probability(gap)), DIGITS)


def groups(sweep: Sweep, options: Options) -> list[Group]:
    """Every contact of every case and level; `ANY` first.

    Raises
    ------
    CurveError
        The sweep has no contacts, or no levels.
    """
    if not set(NEEDS) <= set(sweep.variables):
        raise CurveError(
            "its runs tell of no gaps that are needed: the decks need contacts and a HISTORY, "
            "and the sweep a version of the program that keeps them"
        )
    levels, done = np.asarray(sweep[measure(sweep)], np.float64), sweep["status"] == DONE
    places: dict[tuple[str, float], list[int]] = {}
    for i, key in enumerate(zip(cases(sweep), levels.tolist())):
        places.setdefault(key, []).append(i)
    return [
        group
        for (case, level), own in places.items()
        for group in _contacts(sweep, case, level, np.array(own)[done[own]], len(own), options)
    ]


def _contacts(
    sweep: Sweep, case: str, level: float, own: Array, asked: int, options: Options
) -> Iterator[Group]:
    """The contacts of one case and level, which has runs of some numbers."""
    needed, given, u1, u2, rho = (sweep[name][own] for name in NEEDS)
    there = ~np.isnan(given).all(axis=0)  # contacts of this deck
    names = [n for n, is_there in zip(sweep.labels["contact"], there) if is_there]
    if not names or not len(own):
        return
    needed, given, u1, u2, rho = (x[:, there] for x in (needed, given, u1, u2, rho))
    free = ~np.isnan(needed).any(axis=1)
    met = given[~free].min(axis=1)
    gaps = np.full((len(names), len(RULES)), np.nan)
    for k in range(len(names) if free.any() else 0):
        correlation = options.correlation if math.isfinite(options.correlation) else rho[free, k].mean()
        peaks = Peaks(u1[free, k].mean(), u2[free, k].mean(), float(correlation), *options.raised)
        gaps[k] = [rule.of(peaks) for rule in RULES]

    def group(contact: str, of: Array, rules: Array) -> Group:
        found = _fit(of, met, options.level)
        return Group(case, level, contact, of, met, asked - len(own), tuple(rules.tolist()), found)

    if len(names) > 1:
        yield group(ANY, needed[free].max(axis=1), gaps.max(axis=0))
    if len(names) == 1 or not len(
        met
    ):  # else it is not known which of them a free motion would have closed
        for k, name in enumerate(names):
            yield group(name, needed[free, k], gaps[k])


def _fit(needed: Array, met: Array, level: float) -> Fragility | None:
    """Lognormal distribution of the gaps that are needed; None where they determine none."""
    try:
        return from_capacities(needed, met, level=level)
    except FragilityError:
        return None


def needs(found: Sequence[Group]) -> Iterator[Row]:
    """One row for each group: what the runs needed."""
    for g in found:
        row: list[float] = [math.nan] * 3
        if len(g.needed) and not len(g.met):
            row = fractiles_of(g.needed).tolist()
        own = g.fitted
        fit = (own.median, *own.median_interval, own.dispersion) if own else [math.nan] * 4
        row.append(float(g.needed.max(initial=0.0)) if not len(g.met) else math.nan)
        counts = len(g.needed), len(g.met)
        yield g.case, g.level, g.contact, *counts, *row, *map(_finite, fit), _remark(g)


def _finite(x: float) -> float:
    return x if math.isfinite(x) else math.nan


def _remark(g: Group) -> str:
    """What is missing."""
    out = []
    if len(g.met):
        out.append(f"met at a gap of {g.met.min():.6g} or more: wider gaps are not known")
    if g.left_out:
        out.append(f"{g.left_out} runs stopped, failed or are missing")
    return "; ".join(out)


def probabilities(found: Sequence[Group], options: Options) -> Iterator[Row]:
    """Rows of every group: its rules, then the gaps that are asked for."""
    for g in found:
        asked = [("", "", gap) for gap in options.gaps or _steps(g)]
        for name, source, gap in (*((r.name, r.source, x) for r, x in zip(RULES, g.rules)), *asked):
            count, total = g.contacts(gap)
            if math.isfinite(gap):
                told = share(count, total, options.level)
                yield g.case, g.level, g.contact, name, source, gap, count, total, *told, g.by_fit(gap)


def _steps(g: Group) -> list[float]:
    """Equal steps of the gap up to the largest that was needed, or that is known."""
    most = float(g.met.min()) if len(g.met) else float(g.needed.max(initial=0.0))
    return np.linspace(0.0, most, STEPS + 1)[1:].tolist() if most > 0.0 else []


def report(sweep: Sweep, found: Sequence[Group], options: Options) -> Iterator[str]:
    """Both tables, as the report prints tables; that of probabilities for all contacts together."""
    units, level = units_of(sweep), measure(sweep)
    yield from printed(units, needed_table(level, options.level), needs(found))
    yield ""
    rows = probabilities(_together(found), options)
    yield from printed(units, probability_table(level, options.level), rows)


def _together(found: Sequence[Group]) -> list[Group]:
    """Every case and level once, with all its contacts."""
    several = {(g.case, g.level) for g in found if g.contact == ANY}
    return [g for g in found if g.contact == ANY or (g.case, g.level) not in several]


def variables(sweep: Sweep, found: Sequence[Group], options: Options) -> dict[str, Variable]:
    """The table of probabilities as columns of a file."""
    table, units = probability_table(measure(sweep), options.level), units_of(sweep)
    columns = zip(*probabilities(found, options))
    return {
        c.name: Variable(np.array(values, object if c.is_text else None), "", units.text(c.unit), c.doc)
        for c, values in zip(table.columns, columns)
    }


def drawn(sweep: Sweep, found: Sequence[Group], options: Options) -> list[suites.Contacts]:
    """What a picture shows: every case and level with all its contacts together."""
    out = []
    for g in _together(found):
        rules: dict[float, list[str]] = {}
        for rule, gap in zip(RULES, g.rules):
            if math.isfinite(gap):
                rules.setdefault(gap, []).append(rule.name)
        most = 1.2 * max((*g.needed, *g.met, *rules), default=0.0)
        gaps = np.linspace(0.0, min(most, g.met.min(initial=math.inf)), POINTS)
        seen = np.array([share(*g.contacts(x), options.level) for x in gaps])
        title = ", ".join(filter(None, [g.case, f"{measure(sweep)} {g.level:g}"]))
        named = [(", ".join(names), gap) for gap, names in rules.items()]
        out.append(suites.Contacts(title, gaps, seen, np.array([g.by_fit(x) for x in gaps]), named))
    return out


def _keys(measure: str) -> tuple[Column, ...]:
    """Columns that tell a group."""
    return (
        Column("case", "case", doc="PARAMs that differ in the sweep"),
        Column("level", measure, "-", "short", doc="level of the records"),
        CONTACT,
    )


def needed_table(measure: str, level: float) -> Table[Sequence[Group]]:
    """The table of gaps that are needed."""
    sure = f"{100 * level:g} %\nfrom"
    return Table(
        name="needed",
        title="Gaps that are needed",
        place=0,
        stages=(),  # it is printed, not stored
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
        rows=needs,
        note="The gap that a run needs is its largest closure. The lognormal distribution takes runs that "
        "met for ones that needed more than their gap.",
        sample=(("", 0.4, ANY, 8, 0, 0.02, 0.03, 0.04, 0.05, 0.031, 0.025, 0.037, 0.3, ""),),
    )


def probability_table(measure: str, level: float) -> Table[Sequence[Group]]:
    """The table of probabilities of contact."""
    sure = f"{100 * level:g} %\nfrom"
    return Table(
        name="separation",
        title="Probability of contact",
        place=0,
        stages=(),
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
        rows=lambda found: probabilities(found, Options()),
        note="Rules take the mean peaks of the runs of a case and level in which nothing met. The interval "
        "is that of Clopper and Pearson.",
        sample=(
            ("", 0.4, ANY, "SRSS", "(u1^2 + u2^2)^1/2", 0.04, 1, 8, 0.125, 0.003, 0.527, 0.18),
            ("", 0.4, ANY, "", "", 0.02, 7, 8, 0.875, 0.47, 0.997, 0.9),
        ),
    )
