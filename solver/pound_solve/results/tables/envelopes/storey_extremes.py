"""Table ``storey_extremes``."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pound_solve.results.columns import BUILDING, STOREY, UNIT, extreme_columns
from pound_solve.results.record import RunRecord
from pound_solve.results.remarks import how_sampled
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """Three rows for each storey."""
    from pound_solve.structure.storeys import storeys  # not needed to read a report

    seen, units = run.history.recorder.envelopes.sums, run.model.units
    drift, force, motion = (list(seen[name].rows()) for name in ("drift", "storey", "acceleration"))
    for n, (b, i) in enumerate(storeys(run.history.items.buildings)):
        yield b.name, i, "drift ratio", "-", *((math.nan,) * 4 if i in b.bearings else drift[n])
        yield b.name, i, "shear", units.text("F"), *force[2 * n]
        yield b.name, i, "floor acceleration", units.text("L/T^2"), *motion[n]


TABLE = Table(
    name="storey_extremes",
    title="Storeys to both sides",
    place=50,
    stages=(Stage.SAMPLES,),
    columns=(
        BUILDING,
        STOREY,
        Column("quantity", doc="`drift ratio`, `shear` or `floor acceleration`, of the floor above"),
        UNIT,
        *extreme_columns(""),
    ),
    rows=rows,
    remark=how_sampled,
    note="The quantities are those of the table of storeys, positive along x. A layer of bearings has no "
    "drift ratio.",
    group="quantity",
)
