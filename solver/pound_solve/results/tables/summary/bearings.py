"""Table ``bearings``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.columns import BUILDING, STOREY, time_column
from pound_solve.results.record import RunRecord
from pound_solve.results.remarks import how_sampled
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each layer of bearings."""
    from pound_solve.structure.storeys import storeys  # not needed to read a report

    sums = run.history.recorder.envelopes.sums
    drift, force = sums["drift"].largest(), sums["storey"].largest()
    last = run.stored("storey/drift")[-1] if len(drift) else ()
    for n, (b, i) in enumerate(storeys(run.history.items.buildings)):
        if i in b.bearings:
            height, (ratio, t) = b.levels[i] - b.levels[i - 1], drift[n]
            yield b.name, i, b.levels[i], height * ratio, t, height * float(last[n]), *force[2 * n]


TABLE = Table(
    name="bearings",
    title="Layers of bearings",
    place=65,
    stages=(Stage.SAMPLES,),
    columns=(
        BUILDING,
        STOREY,
        Column("level", "floor\nlevel", "L", "given", doc="height of the floor above the layer"),
        Column("displacement", "largest\ndisp.", "L", "num", doc="largest absolute displacement across it"),
        time_column("t_displacement", "at time", "time of the largest displacement"),
        Column("residual", "at the\nend", "L", "num", doc="displacement at the end of the history"),
        Column("shear", "", "F", "num", doc="largest absolute shear"),
        time_column("t_shear", "at time", "time of the largest shear"),
    ),
    rows=rows,
    remark=how_sampled,
    note="A layer of bearings is a storey with a SPRING that has BEARING=YES, or one lower than a quarter "
    "of the highest storey of its building and without BEARING=NO.",
)
