"""Table ``drift_envelope``."""

from __future__ import annotations

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
)
