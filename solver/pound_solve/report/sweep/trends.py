"""Trends of a sweep: quantities of its runs over one PARAM, as the force over the gap."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.plot.suites import Trend, TrendPanel
from pound_solve.results.sweep_file import Sweep
from pound_solve.statistics.curves import LEVELS, PARAM, Asked, CurveError, cases, demands, fractiles_of

#: quantities that are drawn if none is named, as far as the runs have them
USUAL: Final = (
    "contact_force",
    "closures",
    "storey_drift",
    "drift_ratio",
    "base_shear",
    "floor_acceleration",
)
MOST: Final = 6  #: panels


def varied(sweep: Sweep) -> list[str]:
    """Names of the PARAMs whose values are numbers and differ within a sweep."""
    params = [name for name, variable in sweep.variables.items() if variable.doc.startswith(PARAM)]
    return [name for name in params if sweep[name].dtype.kind == "f" and len(set(sweep[name].tolist())) > 1]


def panels(sweep: Sweep, over: str = "", quantities: Sequence[str] = ()) -> list[TrendPanel]:
    """Data of the picture: a panel for each quantity.

    Parameters
    ----------
    sweep : Sweep
    over : str
        PARAM along x; empty for the first one that varies.
    quantities : sequence of str
        Of the sweep; empty for `USUAL`.

    Raises
    ------
    CurveError
        No such PARAM varies, or there is no such quantity.
    """
    names = varied(sweep)
    if not names or (over and over not in names):
        there = ", ".join(names) or "none"
        raise CurveError(
            f"no numbers of PARAM {over or 'of any name'} vary in this sweep; there are: {there}"
        )
    over = over or names[0]
    chosen = [name for name in quantities or USUAL if quantities or name in sweep.variables][:MOST]
    drawn = []
    for name in chosen:
        values = demands(sweep, Asked(name))
        finite = np.where(np.isfinite(values), values, np.nan)  # a run that stopped has no value
        if quantities or not np.isnan(finite).all():
            drawn.append(TrendPanel(name, sweep.variables[name].unit, _trends(sweep, over, finite)))
    if not drawn:
        raise CurveError("its runs have no values of the usual quantities: name one")
    return drawn


def _trends(sweep: Sweep, over: str, values: Array) -> list[Trend]:
    """One trend for each case and level, with a curve for each record."""
    x = np.asarray(sweep[over], np.float64)
    records = sweep["record"].tolist() if "record" in sweep.variables else [""] * len(x)
    runs: dict[str, dict[str, list[int]]] = {}
    for i, (case, record) in enumerate(zip(_cases(sweep, over), records)):
        runs.setdefault(case, {}).setdefault(record, []).append(i)
    return [
        Trend(case, *_fractiles(curves), curves)
        for case, of_records in runs.items()
        for curves in [[_sorted(x[rows], values[rows]) for rows in of_records.values()]]
    ]


def _cases(sweep: Sweep, over: str) -> list[str]:
    """Case and level of every run, without the PARAM along x."""
    named = cases(sweep, leave_out=over)
    for level in [name for name in LEVELS if name in sweep.variables][:1]:
        if len(set(sweep[level].tolist())) > 1:
            texts = (f"{level} {value:.6g}" for value in sweep[level].tolist())
            return [", ".join(filter(None, pair)) for pair in zip(named, texts)]
    return named


def _sorted(x: Array, y: Array) -> tuple[Array, Array]:
    """A curve in the order of x."""
    order = np.argsort(x, kind="stable")
    return x[order], y[order]


def _fractiles(curves: Sequence[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Abscissas of all curves, shape (n,), and the fractiles of their values there, shape (3, n); NaN where
    a curve has none.
    """
    at = np.unique(np.concatenate([x for x, _ in curves]))
    rows = []
    for x0 in at:
        there = np.concatenate([y[x == x0] for x, y in curves])
        there = there[~np.isnan(there)]
        rows.append(fractiles_of(there) if len(there) else np.full(3, np.nan))
    return at, np.array(rows).T
