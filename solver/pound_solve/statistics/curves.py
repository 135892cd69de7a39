"""Curves of a sweep: the demand of one record over its levels, for every case of PARAMs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple, Self

import numpy as np

from pound_deck.model import Units
from pound_solve.numerics.types import Array
from pound_solve.results.sweep_file import DONE, RUN, STOPPED, Sweep
from pound_solve.statistics.incremental import IdaPoint

LEVELS: Final = (
    "sa",
    "pga",
    "scale",
)  #: variables that measure the strength of a record, in order of preference
FRACTILES: Final = (0.16, 0.5, 0.84)  #: shares of the records, or runs, in tables and pictures
PARAM: Final = "PARAM "  #: prefix of the description of a PARAM's variable
COLLAPSE: Final = "collapse"  #: demand that is infinite where a run stopped early, else zero
#: demand that is infinite for runs with a collision: above the gap, but unknown
NEEDED: Final = "needed_gap"


class Asked(NamedTuple):
    """Quantity used as the demand.

    Attributes
    ----------
    quantity : str
        Of a sweep, or `COLLAPSE`.
    label : str
        Label to use; empty for the largest value over all labels.
    """

    quantity: str
    label: str = ""


class CurveError(Exception):
    """Raised if a sweep lacks the requested data; the message states which."""


@dataclass(frozen=True)
class IdaCurve:
    """One record at several levels.

    Attributes
    ----------
    case : str
        PARAMs and deck, those that differ within the sweep.
    record : str
    points : tuple of IdaPoint
        In the order of their levels.
    left_out : int
        Runs that failed or have not ended.
    from_rest : bool
        Whether the demand is proportional to the level before the first yielding or collision.
    """

    case: str
    record: str
    points: tuple[IdaPoint, ...]
    left_out: int = 0
    from_rest: bool = False

    @classmethod
    def of(
        cls,
        case: str,
        record: str,
        levels: Iterable[float],
        values: Iterable[float],
        from_rest: bool = False,
    ) -> Self:
        """Make a curve from the levels and demands of runs; runs with demand NaN count as left out."""
        pairs = sorted(zip(levels, values))
        points = tuple(IdaPoint(float(x), float(d)) for x, d in pairs if not math.isnan(d))
        return cls(case, record, points, len(pairs) - len(points), from_rest)


def measure(sweep: Sweep) -> str:
    """Variable of the levels.

    Raises
    ------
    CurveError
        The runs have no levels: the decks' own motions act.
    """
    for name in LEVELS:
        if name in sweep.variables:
            return name
    raise CurveError("its runs have no levels: the study needs [[motions]] with scale, pga or sa")


def fractiles_of(values: Array) -> Array:
    """Fractiles `FRACTILES` of a sample along its last axis, as order statistics."""
    return np.asarray(np.quantile(values, FRACTILES, axis=-1, method="inverted_cdf"))


def units_of(sweep: Sweep) -> Units:
    """Force, length and time of the decks."""
    force, length, time = sweep.about["units"].split()
    return Units(force, length, time, stated=True)


def unit_of(sweep: Sweep, asked: Asked) -> str:
    """Unit of the demand; empty for a collapse."""
    return "" if asked.quantity == COLLAPSE else sweep.variables[asked.quantity].unit


def demand(status: str, reached: float, values: Mapping[str, float], asked: Asked) -> float:
    """Demand of one run: infinite if it stopped early or needed a wider gap, NaN if it has none.

    Parameters
    ----------
    status : str
        See `entry`.
    reached : float
        Last time of its history; NaN without one.
    values : mapping of str to float
        Values of the requested quantity by label.
    asked : Asked

    Raises
    ------
    CurveError
        The run lacks the requested label.
    """
    if status == STOPPED and math.isfinite(reached):
        return math.inf
    if status != DONE:
        return math.nan
    if asked.quantity == COLLAPSE:
        return 0.0
    if asked.label and asked.label not in values:
        raise CurveError(f"{asked.quantity} has no {asked.label}: there are {', '.join(values) or 'none'}")
    chosen = [values[asked.label]] if asked.label else values.values()
    unknown = math.inf if asked.quantity == NEEDED and values else math.nan
    return max((abs(x) for x in chosen if not math.isnan(x)), default=unknown)


def demands(sweep: Sweep, asked: Asked) -> Array:
    """Demand of every run, see `demand`.

    Raises
    ------
    CurveError
        The sweep lacks the quantity or the label.
    """
    there = [n for n, v in sweep.variables.items() if n != RUN and v.values.dtype.kind in "fi"]
    if asked.quantity not in (COLLAPSE, *there):
        raise CurveError(
            f"there is no quantity {asked.quantity}: there are {', '.join((COLLAPSE, *there))}"
        )
    rows = _rows(sweep, asked.quantity)
    return np.array([demand(*row, asked) for row in zip(sweep["status"], sweep["reached"], rows)])


def _rows(sweep: Sweep, quantity: str) -> Iterator[Mapping[str, float]]:
    """Yield for every run the values of a quantity by their labels."""
    if quantity == COLLAPSE:
        return iter([{}] * len(sweep))
    variable = sweep.variables[quantity]
    labels = sweep.labels[variable.axis] if variable.axis else ("",)
    rows = variable.values.reshape(len(sweep), len(labels))
    there = np.ones(rows.shape, bool)
    if quantity == NEEDED:  # NaN of a deck that has not the contact means nothing
        there = ~np.isnan(sweep["given_gap"])
    return ({n: float(x) for n, x, h in zip(labels, *row) if h} for row in zip(rows, there))


def widest_known(sweep: Sweep) -> dict[str, float]:
    """Widest gap of each case whose exceedance is known for all runs; infinite without collisions.

    A collision changes the motion: a run with a collision needed more than its smallest gap.
    """
    widest = dict.fromkeys(cases(sweep), math.inf)
    columns = (sweep[name] for name in ("status", NEEDED, "given_gap"))
    for case, status, needed, given_gap in zip(cases(sweep), *columns):
        if status == DONE and (np.isnan(needed) & ~np.isnan(given_gap)).any():
            widest[case] = min(widest[case], float(np.nanmin(given_gap)))
    return widest


def cases(sweep: Sweep, leave_out: str = "") -> list[str]:
    """Name of the case of every run: its deck and those of its PARAMs that differ within the sweep, without
    the one that is left out.
    """
    names = [n for n, v in sweep.variables.items() if v.doc.startswith(PARAM) and n != leave_out]
    varied = [n for n in ("deck", *names) if len({str(x) for x in sweep[n]}) > 1]
    return [
        ", ".join(str(sweep[n][i]) if n == "deck" else f"{n}={_short(sweep[n][i])}" for n in varied)
        for i in range(len(sweep))
    ]


def _short(value: object) -> str:
    """Value of a PARAM as text, numbers with six digits."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def curves(sweep: Sweep, asked: Asked) -> list[IdaCurve]:
    """Return one curve per record and case, in the order of the sweep.

    Raises
    ------
    CurveError
        See `measure` and `demands`.
    """
    levels, values = np.asarray(sweep[measure(sweep)], np.float64), demands(sweep, asked)
    groups: dict[tuple[str, str], list[int]] = {}
    for i, key in enumerate(zip(cases(sweep), sweep["record"].tolist())):
        groups.setdefault(key, []).append(i)
    free = asked.quantity == NEEDED  # its motion is without collisions, and elastic at low levels
    return [IdaCurve.of(*key, levels[runs], values[runs], free) for key, runs in groups.items()]


def by_case(curves: Sequence[IdaCurve]) -> dict[str, list[IdaCurve]]:
    """Group curves by their case."""
    groups: dict[str, list[IdaCurve]] = {}
    for curve in curves:
        groups.setdefault(curve.case, []).append(curve)
    return groups
