"""Demands of the runs at points, as arrays."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.results.sweep_file import DONE
from pound_solve.statistics.curves import Asked, CurveError, demand
from pound_solve.sweep.points import PointResult


def demands(results: Sequence[PointResult], asked: Asked) -> Array:
    """Demands, shape (n_points, n_records): infinite for a run that stopped, NaN for one that failed.

    Raises
    ------
    CurveError
        A run lacks the label.
    """
    return np.array(
        [
            [
                demand(entry.status, entry.reached, values.get(asked.quantity, {}), asked)
                for entry, values in zip(result.entries, result.values)
            ]
            for result in results
        ]
    )


def quantities_of(result: PointResult, wanted: Iterable[Asked]) -> set[str]:
    """Quantities that the runs at a point have.

    Raises
    ------
    CurveError
        They lack one that is wanted, and at least one of them is done.
    """
    there = {name for values in result.values for name in values}
    missing = next((q for q in wanted if q.quantity not in there), None)
    if missing is not None and any(entry.status == DONE for entry in result.entries):
        raise CurveError(f"its runs have no {missing.quantity}: they have {', '.join(sorted(there))}")
    return there
