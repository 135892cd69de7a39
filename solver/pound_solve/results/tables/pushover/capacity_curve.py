"""Table ``capacity_curve``."""

from __future__ import annotations

from pound_solve.results.columns import LEG, PUSH, base_shear, control_displacement
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> list[Row]:
    """The starts of legs, the stations, and the points at which springs, hinges and contacts changed."""
    return [
        (pushed.number, p.leg, p.displacement, p.shear, p.factor, p.changes)
        for pushed in run.pushovers
        for p in pushed.curve
    ]


TABLE = Table(
    name="capacity_curve",
    title="Capacity curve",
    place=30,
    stages=(Stage.PUSHOVER,),
    columns=(
        PUSH,
        LEG,
        control_displacement("displacement of the control node"),
        base_shear("force on the ground along the direction of the pushover"),
        Column("factor", "load\nfactor", "-", "num", doc="factor on the pattern"),
        Column("events", fmt="int", doc="changes of springs, hinges and contacts so far"),
    ),
    rows=rows,
    group="push",
    note="Displacements and base shears include those of the static state.",
    limit=500,
)
