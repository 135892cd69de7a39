"""Table ``drift_envelope``."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pound_solve.results.columns import extreme_columns
from pound_solve.results.record import RunRecord
from pound_solve.results.remarks import how_found
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each DRIFT card."""
    from pound_solve.analyses.history import drift_heights  # which reading a report does not need

    monitored, heights = run.history.returned.peaks.monitored, drift_heights(run.model)
    for (name, ratio), e, h in zip(run.history.drift_ratios(), monitored, heights):
        yield name, e.high, e.t_high, e.low, e.t_low, h, ratio


TABLE = Table(
    name="drift_envelope",
    title="Drift envelopes",
    place=10,
    stages=(Stage.PEAKS,),
    columns=(
        Column("name", "drift", doc="name in the deck"),
        *extreme_columns("L"),
        Column(
            "height", "height", "L", "given", doc="distance over which the drift is taken, NaN for none"
        ),
        Column("ratio_max", "largest\nratio", "-", "short", doc="largest absolute drift over the height"),
    ),
    rows=rows,
    remark=how_found,
    sample=(
        ("B1 storey 1", 0.0105303, 2.726, -0.0103757, 5.06, 3.5, 0.00745856),
        ("B1 storey 2", 0.00718489, 8.168, -0.0080023, 8.606, 3.5, 0.00420513),
        ("B2 storey 1", 0.00519127, 2.062, -0.0154064, 1.842, 3.5, 0.0112619),
        ("B2 storey 2", 0.00191461, 3.38, -0.00405248, 1.88, 3.5, 0.0181223),
        ("across the gap", 0.0312345, 4.21, -0.008, 3.998, math.nan, math.nan),
    ),
)
