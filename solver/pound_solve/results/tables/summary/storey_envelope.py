"""Table ``storey_envelope``."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pound_solve.results.columns import BUILDING, STOREY, time_column
from pound_solve.results.record import RunRecord
from pound_solve.results.remarks import how_sampled
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each storey."""
    from pound_solve.structure.storeys import storeys  # not needed to read a report

    seen = run.history.recorder.envelopes.sums
    drift, force, motion = (seen[name].largest() for name in ("drift", "storey", "acceleration"))
    last = run.stored("storey/drift")[-1] if len(drift) else ()
    for n, (b, i) in enumerate(storeys(run.history.items.buildings)):
        height, floor = b.levels[i] - b.levels[i - 1], b.floors[i - 1]
        drifts = (math.nan,) * 3 if i in b.bearings else (*drift[n], float(last[n]))
        peaks = *drifts, *force[2 * n], *force[2 * n + 1], *motion[n]
        yield b.name, i, floor.level, height, floor.mass, *peaks


TABLE = Table(
    name="storey_envelope",
    title="Storeys",
    place=60,
    stages=(Stage.SAMPLES,),
    columns=(
        BUILDING,
        STOREY,
        Column("level", "floor\nlevel", "L", "given", doc="height of the floor above the storey"),
        Column("height", "", "L", "given", doc="height of the storey"),
        Column("mass", "floor\nmass", "F*T^2/L", "num", doc="mass of that floor along x"),
        Column(
            "drift",
            "drift\nratio",
            "-",
            "short",
            doc="largest absolute drift ratio, NaN for a layer of bearings",
        ),
        time_column("t_drift", "at time", "time of the largest drift"),
        Column("residual", "drift at\nthe end", "-", "short", doc="drift ratio at the end of the history"),
        Column("shear", "", "F", "num", doc="largest absolute shear"),
        time_column("t_shear", "at time", "time of the largest shear"),
        Column("moment", "", "F*L", "num", doc="largest absolute overturning moment at the storey's foot"),
        time_column("t_moment", "at time", "time of the largest moment"),
        Column("acceleration", "floor\naccel.", "L/T^2", "num", doc="largest absolute total acceleration"),
        time_column("t_acceleration", "at time", "time of the largest acceleration"),
    ),
    rows=rows,
    remark=how_sampled,
    note="Displacements and accelerations of a floor are the means of its nodes, weighted by mass, along "
    "x; those of the base are the means of the feet. The shear is the sum of the forces of all elements "
    "that cross the storey.",
)
