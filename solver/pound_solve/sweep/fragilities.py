"""Fragilities of a sweep: the probability that a demand exceeds a limit, over the level, for every case."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Final, NamedTuple

import numpy as np

from pound_solve.report.plot import suites
from pound_solve.report.text import printed
from pound_solve.results.schema import Column, Row, Table
from pound_solve.results.sweep_file import Sweep
from pound_solve.sweep.curves import (
    COLLAPSE,
    NEEDED,
    Asked,
    Curve,
    CurveError,
    by_case,
    curves,
    measure,
    unit_of,
    units_of,
    widest_known,
)
from pound_solve.sweep.incremental import Rules, capacity
from pound_solve.theory.fragility import (
    Fragility,
    FragilityError,
    from_capacities,
    from_cloud,
    from_stripes,
)

#: only a run that stops brings the structure down; a limit of the demand is a limit of its own
STOPS: Final = Rules(step=1.0, slope=0.0)
FEW: Final = 10  #: data below which a remark says so
FEWEST: Final = 3  #: levels of a record that make a curve
POINTS: Final = 200  #: of a curve that is drawn
DIGITS: Final = 4  #: of probabilities that are printed


class Fitted(NamedTuple):
    """One fragility, or why there is none.

    Attributes
    ----------
    case : str
    limit : float
        Of the demand; NaN for collapse.
    method : str
    fragility : Fragility or None
    remark : str
    observed : tuple of (level, exceeded, runs)
        Counts at every level.
    """

    case: str
    limit: float
    method: str
    fragility: Fragility | None
    remark: str
    observed: tuple[tuple[float, int, int], ...]


def by_capacities(own: Sequence[Curve], limit: float, level: float) -> Fragility:
    """Of the levels at which the records reach the limit."""
    demands = [p.demand for c in own for p in c.points if math.isfinite(p.demand)]
    in_steps = all(d == round(d) for d in demands)  # as counts and indicators are
    found = [capacity(c.points, STOPS, limit, in_steps, c.from_rest) for c in own if c.points]
    known = [low for low, high in found if low == high]
    never = [low for low, high in found if 0.0 < low < high == math.inf]
    return from_capacities(known, never, [pair for pair in found if pair[0] < pair[1] < math.inf], level)


def by_stripes(own: Sequence[Curve], limit: float, level: float) -> Fragility:
    """Of the runs at every level that exceed the limit."""
    levels, exceeded, runs = zip(*counts(own, limit))
    return from_stripes(levels, exceeded, runs, level)


def by_cloud(own: Sequence[Curve], limit: float, level: float) -> Fragility:
    """Of the demands of all runs that stand."""
    points = [p for c in own for p in c.points if 0.0 < p.demand < math.inf]
    if not math.isfinite(limit):
        raise FragilityError("a cloud has no collapse: take stripes or capacities")
    return from_cloud([p.level for p in points], [p.demand for p in points], limit, level)


METHODS: Final[Mapping[str, Callable[[Sequence[Curve], float, float], Fragility]]] = MappingProxyType(
    {"capacities": by_capacities, "stripes": by_stripes, "cloud": by_cloud}
)


def counts(own: Sequence[Curve], limit: float) -> tuple[tuple[float, int, int], ...]:
    """Every level, the runs there that reach the limit, and all."""
    points = [p for c in own for p in c.points]
    return tuple(
        (x, sum(p.demand >= limit for p in points if p.level == x), sum(p.level == x for p in points))
        for x in sorted({p.level for p in points})
    )


def suited(own: Sequence[Curve]) -> str:
    """Method for some curves: capacities where each record has several levels, stripes where all have the
    same two, else a cloud.
    """
    levels = [tuple(p.level for p in c.points) for c in own if c.points]
    if levels and min(map(len, levels)) >= FEWEST:
        return "capacities"
    return "stripes" if len(set(levels)) == 1 and len(levels[0]) > 1 else "cloud"


def fit(
    sweep: Sweep, asked: Asked, limits: Sequence[float], method: str = "", level: float = 0.95
) -> list[Fitted]:
    """Fragilities of every case and limit.

    Parameters
    ----------
    sweep : Sweep
    asked : Asked
        The demand.
    limits : sequence of float
        Of the demand; collapse has none.
    method : str
        One of `METHODS`; empty for the one that suits each case.
    level : float
        Of confidence.

    Raises
    ------
    CurveError
        The sweep does not hold the demand, or no limit is given.
    """
    if asked.quantity == COLLAPSE:
        limits = (math.inf,)
    elif not limits:
        raise CurveError(f"{asked.quantity} needs limits: --limit")
    found = by_case(curves(sweep, asked))
    known = widest_known(sweep) if asked.quantity == NEEDED else {}
    met = min(known.values(), default=math.inf) < math.inf
    if met and asked.label and len(sweep.labels[sweep.variables[NEEDED].axis]) > 1:
        raise CurveError(
            "runs in which something met do not tell what a single contact needs: leave --label out"
        )
    return [
        _fitted(case, own, limit, method or suited(own), level, known.get(case, math.inf))
        for case, own in found.items()
        for limit in limits
    ]


def _fitted(
    case: str, own: Sequence[Curve], limit: float, method: str, level: float, known: float
) -> Fitted:
    """One fragility, of limits up to the largest of which the runs tell."""
    remarks, found = [], None
    try:
        if known < limit:
            raise FragilityError(f"met at a gap of {known:.6g}: wider gaps are not known")
        found = METHODS[method](own, limit, level)
    except FragilityError as err:
        remarks.append(str(err))
    if found is not None and found.count < FEW:
        remarks.append(f"fewer than {FEW} data")
    below = sum(c.from_rest and limit <= c.points[0].demand < math.inf for c in own if c.points)
    if found is not None and method == "capacities" and below:
        remarks.append(f"below the lowest level, in proportion to it: {below}")
    endless = sum(math.isinf(p.demand) for c in own for p in c.points)
    if method == "cloud" and endless:
        what = "stopped runs" if known == math.inf else "runs that met"
        remarks.append(f"{what}, which are not in the cloud: {endless}")
    if missing := sum(c.left_out for c in own):
        remarks.append(f"runs that failed or are missing: {missing}")
    shown = limit if math.isfinite(limit) else math.nan
    return Fitted(case, shown, method, found, "; ".join(remarks), counts(own, limit))


def rows(found: Sequence[Fitted]) -> Iterator[Row]:
    """One row for each fragility."""
    for f in found:
        own = f.fragility
        if own is None:
            yield f.case, f.limit, f.method, 0, *([math.nan] * 6), f.remark
        else:
            ends = own.median, *own.median_interval, own.dispersion, *own.dispersion_interval
            yield f.case, f.limit, f.method, own.count, *map(_finite, ends), f.remark


def _finite(x: float) -> float:
    return x if math.isfinite(x) else math.nan


def report(sweep: Sweep, asked: Asked, found: Sequence[Fitted], at: Sequence[float]) -> Iterator[str]:
    """The table of fragilities, and their probabilities at some levels, as the report prints tables."""
    units, unit = units_of(sweep), unit_of(sweep, asked)
    sure = next((f.fragility.level for f in found if f.fragility is not None), math.nan)
    yield f"Demand: {asked.quantity} {asked.label}".rstrip()
    yield _base(sweep, found)
    yield ""
    yield from printed(units, fragility_table(unit, sure), rows(found))
    if at:
        yield ""
        yield from printed(units, probability_table(unit, at), _probable(found, at))


def _base(sweep: Sweep, found: Sequence[Fitted]) -> str:
    """The runs that the fragilities rest on, in words."""
    seen = {f.case: f.observed for f in found}
    levels = sorted({x for observed in seen.values() for x, _, _ in observed})
    runs = sum(count for observed in seen.values() for _, _, count in observed)
    which = (
        f"{measure(sweep)} {levels[0]:.6g} to {levels[-1]:.6g}, {len(levels)} levels" if levels else "none"
    )
    return f"Runs: {runs} of the {len(sweep)} in the sweep; {which}"


def _probable(found: Sequence[Fitted], at: Sequence[float]) -> Iterator[Row]:
    """Probabilities at some levels."""
    for f in found:
        values = f.fragility.probability(at) if f.fragility else np.full(len(at), math.nan)
        yield f.case, f.limit, *np.round(values, DIGITS).tolist()


def drawn(found: Sequence[Fitted]) -> list[suites.Fragilities]:
    """What a picture shows of the fragilities that could be fitted."""
    out = []
    most = max((x for f in found for x, _, _ in f.observed), default=0.0)
    at = np.linspace(0.0, most, POINTS)[1:]
    for f in found:
        if f.fragility is not None:
            limit = "" if math.isnan(f.limit) else f"limit {f.limit:g}"
            level, exceeded, runs = np.array(f.observed, np.float64).T
            title = ", ".join(filter(None, [f.case, limit])) or "collapse"
            own, seen = f.fragility, (level, exceeded / runs) if f.method == "stripes" else (at[:0], at[:0])
            out.append(
                suites.Fragilities(title, at, own.probability(at), seen, own.median, own.median_interval)
            )
    return out


def fragility_table(unit: str, level: float) -> Table[Sequence[Fitted]]:
    """The table of fragilities for the dimensions of the demand and a level of confidence."""
    sure = f"{100 * level:g} %"
    return Table(
        name="fragility",
        title="Fragilities",
        place=0,
        stages=(),  # it is printed, not stored
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
        rows=rows,
        note="Lognormal, most likely parameters; intervals by profile likelihood. The dispersion is that "
        "of the records alone: it knows no uncertainty of the model.",
        sample=(("gap=0.02", 0.01, "capacities", 20, 0.61, 0.5, 0.74, 0.42, 0.32, 0.62, ""),),
    )


def probability_table(unit: str, at: Sequence[float]) -> Table[Sequence[Fitted]]:
    """The table of probabilities at some levels."""
    return Table(
        name="probabilities",
        title="Probabilities at levels",
        place=0,
        stages=(),
        columns=(
            Column("case", "case", doc="PARAMs that differ in the sweep"),
            Column("limit", "limit", unit, "given", doc="of the demand"),
            *(Column(f"p{n}", f"at\n{x:g}", "-", "short", doc="probability") for n, x in enumerate(at)),
        ),
        rows=lambda found: _probable(found, at),
        sample=(("gap=0.02", 0.01, *(0.5 for _ in at)),),
    )
