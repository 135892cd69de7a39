"""Fragilities of each case of a sweep: the probability that a demand exceeds a limit, over the level."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Final, NamedTuple

from pound_solve.results.sweep_file import Sweep
from pound_solve.statistics.curves import (
    COLLAPSE,
    NEEDED,
    Asked,
    CurveError,
    IdaCurve,
    by_case,
    curves,
    widest_known,
)
from pound_solve.statistics.fragility import (
    Fragility,
    FragilityError,
    from_capacities,
    from_cloud,
    from_stripes,
)
from pound_solve.statistics.incremental import Rules, capacity

#: only a run that stops counts as collapse; limits of the demand are given separately
STOPS: Final = Rules(step=1.0, slope=0.0)
FEW: Final = 10  #: number of data below which a remark warns
MIN_LEVELS: Final = 3  #: fewest levels of a record that make a curve


class Fitted(NamedTuple):
    """One fragility, or the reason why none could be fitted.

    Attributes
    ----------
    case : str
    limit : float
        Of the demand; NaN for collapse.
    method : str
    fragility : Fragility or None
    remark : str
    observed : tuple of (level, exceeded, runs)
        Numbers of runs at each level.
    """

    case: str
    limit: float
    method: str
    fragility: Fragility | None
    remark: str
    observed: tuple[tuple[float, int, int], ...]


def by_capacities(records: Sequence[IdaCurve], limit: float, level: float) -> Fragility:
    """Fit a fragility to the levels at which the records reach the limit."""
    demands = [p.demand for c in records for p in c.points if math.isfinite(p.demand)]
    in_steps = all(d == round(d) for d in demands)  # as counts and indicators are
    pairs = [capacity(c.points, STOPS, limit, in_steps, c.from_rest) for c in records if c.points]
    known = [low for low, high in pairs if low == high]
    never = [low for low, high in pairs if 0.0 < low < high == math.inf]
    return from_capacities(known, never, [pair for pair in pairs if pair[0] < pair[1] < math.inf], level)


def by_stripes(records: Sequence[IdaCurve], limit: float, level: float) -> Fragility:
    """Fit a fragility to the number of runs at every level that reach the limit."""
    levels, exceeded, runs = zip(*counts(records, limit))
    return from_stripes(levels, exceeded, runs, level)


def by_cloud(records: Sequence[IdaCurve], limit: float, level: float) -> Fragility:
    """Fit a fragility to the demands of all runs that did not collapse."""
    points = [p for c in records for p in c.points if 0.0 < p.demand < math.inf]
    if not math.isfinite(limit):
        raise FragilityError("a cloud has no collapse: take stripes or capacities")
    return from_cloud([p.level for p in points], [p.demand for p in points], limit, level)


METHODS: Final[Mapping[str, Callable[[Sequence[IdaCurve], float, float], Fragility]]] = MappingProxyType(
    {"capacities": by_capacities, "stripes": by_stripes, "cloud": by_cloud}
)


def counts(records: Sequence[IdaCurve], limit: float) -> tuple[tuple[float, int, int], ...]:
    """Return for each level the number of runs that reach the limit, and the number of all runs."""
    points = [p for c in records for p in c.points]
    return tuple(
        (x, sum(p.demand >= limit for p in points if p.level == x), sum(p.level == x for p in points))
        for x in sorted({p.level for p in points})
    )


def suited(records: Sequence[IdaCurve]) -> str:
    """Name of the default method: capacities if each record has at least `MIN_LEVELS` levels, else stripes
    if all records have the same two or more levels, else a cloud.
    """
    levels = [tuple(p.level for p in c.points) for c in records if c.points]
    if levels and min(map(len, levels)) >= MIN_LEVELS:
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
        One of `METHODS`; empty for the default of each case, see `suited`.
    level : float
        Of confidence.

    Raises
    ------
    CurveError
        The sweep lacks the demand, or no limit is given.
    """
    if asked.quantity == COLLAPSE:
        limits = (math.inf,)
    elif not limits:
        raise CurveError(f"{asked.quantity} needs limits: --limit")
    cases = by_case(curves(sweep, asked))
    known = widest_known(sweep) if asked.quantity == NEEDED else {}
    met = min(known.values(), default=math.inf) < math.inf
    if met and asked.label and len(sweep.labels[sweep.variables[NEEDED].axis]) > 1:
        raise CurveError(
            "runs in which something met do not tell what a single contact needs: leave --label out"
        )
    return [
        _fitted(case, records, limit, method or suited(records), level, known.get(case, math.inf))
        for case, records in cases.items()
        for limit in limits
    ]


def _fitted(
    case: str, records: Sequence[IdaCurve], limit: float, method: str, level: float, known: float
) -> Fitted:
    """Fragility of one limit; none, with a remark, for limits above `known`, where it is unknown."""
    remarks, fragility = [], None
    try:
        if known < limit:
            raise FragilityError(f"met at a gap of {known:.6g}: wider gaps are not known")
        fragility = METHODS[method](records, limit, level)
    except FragilityError as err:
        remarks.append(str(err))
    if fragility is not None and fragility.count < FEW:
        remarks.append(f"fewer than {FEW} data")
    below = sum(c.from_rest and limit <= c.points[0].demand < math.inf for c in records if c.points)
    if fragility is not None and method == "capacities" and below:
        remarks.append(f"below the lowest level, in proportion to it: {below}")
    endless = sum(math.isinf(p.demand) for c in records for p in c.points)
    if method == "cloud" and endless:
        what = "stopped runs" if known == math.inf else "runs that met"
        remarks.append(f"{what}, which are not in the cloud: {endless}")
    if missing := sum(c.left_out for c in records):
        remarks.append(f"runs that failed or are missing: {missing}")
    shown = limit if math.isfinite(limit) else math.nan
    return Fitted(case, shown, method, fragility, "; ".join(remarks), counts(records, limit))
