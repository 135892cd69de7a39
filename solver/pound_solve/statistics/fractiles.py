"""Fractiles of an incremental analysis: demands not exceeded by a fraction of the records, by level."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.statistics.curves import IdaCurve, fractiles_of
from pound_solve.statistics.incremental import Rules, collapse, demand_at

ROWS: Final = 12  #: levels of the table of fractiles


class Analysis(NamedTuple):
    """Curves of one case, and the rules that define collapse."""

    curves: Sequence[IdaCurve]
    rules: Rules


def levels(analysis: Analysis) -> Array:
    """Levels of the table of fractiles: equal steps up to the highest level without collapse."""
    tops = [collapse(c.points, analysis.rules)[0] for c in analysis.curves]
    return np.linspace(0.0, max(tops, default=0.0), ROWS + 1)[1:]


def fractiles(analysis: Analysis, at: Sequence[float] | Array) -> Array:
    """Demands not exceeded by the fractions `FRACTILES` of the records, shape (n_levels, 3).

    Infinite where that many records collapsed; NaN where a record was not run up to the level.
    """
    demands = np.array([[demand_at(c.points, analysis.rules, x) for c in analysis.curves] for x in at])
    with np.errstate(invalid="ignore"):  # between two that have collapsed
        quantiles = fractiles_of(demands)
    return np.asarray(quantiles.T)
