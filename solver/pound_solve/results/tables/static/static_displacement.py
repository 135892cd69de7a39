"""Table ``static_displacement``."""

from __future__ import annotations

from pound_solve.results.columns import NODE
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> list[Row]:
    """One row for each node."""
    return [(node, *three) for node, three in zip(run.model.nodes, run.static.displacements.tolist())]


TABLE = Table(
    name="static_displacement",
    title="Static displacements",
    place=10,
    stages=(Stage.STATIC,),
    columns=(
        NODE,
        Column("x", "X", "L", "num", doc="displacement"),
        Column("y", "Y", "L", "num", doc="displacement"),
        Column("r", "R", "rad", "num", doc="rotation"),
    ),
    rows=rows,
)
