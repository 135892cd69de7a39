"""Table ``motions``."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pound_solve.results.columns import time_column
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table
from pound_solve.results.words import text_of


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each motion; a wave is one for each support."""
    for n, m in enumerate(run.motions, 1):
        i = m.info
        yield (
            f"{n} {m.name}",
            "R (rad)" if m.direction == "R" else m.direction,
            "all" if m.supports is None else text_of(m.supports),
            str(i.get("format") or i.get("kind") or ""),
            int(i.get("npts") or 0),
            float(i.get("dt") or math.nan),
            float(i["scale"]),
            float(i["pga"]),
            float(i["t_pga"]),
            float(i["pgv"]),
            float(i["pgd"]),
            float(i.get("start") or 0.0),
            float(m.acceleration.end),
            float(i.get("misfit", math.nan)),
            str(i.get("sha256") or ""),
        )


TABLE = Table(
    name="motions",
    title="Ground motions",
    place=10,
    stages=(Stage.INPUT,),
    columns=(
        Column("motion", doc="name of the ground motion"),
        Column(
            "direction", "dir.", doc="direction of the motion; a rotation is in radians instead of lengths"
        ),
        Column("supports", doc="supports that it moves"),
        Column("format", doc="format of the record"),
        Column("points", fmt="int", doc="number of points read, 0 for a motion without a record", zero="-"),
        Column("dt", "step", "T", "given", doc="time step of the record"),
        Column("scale", "scale", "-", "given", doc="factor on the record"),
        Column("pga", "peak\naccel.", "L/T^2", "short", doc="largest absolute acceleration, scaled"),
        time_column("t_pga", "at time", "time of the largest acceleration"),
        Column("pgv", "peak\nvelocity", "L/T", "short", doc="largest absolute velocity, scaled"),
        Column("pgd", "peak\ndisp.", "L", "short", doc="largest absolute displacement, scaled"),
        time_column("start", "start", "time at which the record starts"),
        time_column("end", "end", "time at which the motion ends"),
        Column(
            "misfit",
            unit="-",
            fmt="short",
            doc="largest share by which the spectrum of a MATCHED motion misses the given one, else NaN",
        ),
        Column("sha256", doc="checksum of the record's file", clip=12),
    ),
    rows=rows,
    note=(
        "Peaks are those of the whole motion, from start to end, even if the history is "
        "shorter. Velocity and displacement are integrals of the record as it stands, without "
        "baseline correction. The checksum is shortened to its first 12 characters."
    ),
)
