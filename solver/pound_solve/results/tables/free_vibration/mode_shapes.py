"""Table ``mode_shapes``."""

from __future__ import annotations

from pound_solve.results.columns import NODE
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> list[Row] | None:
    """One row for each node in each mode, if shapes are requested."""
    if run.modal.shapes is None:
        return None
    return [
        (mode, node, *three)
        for mode, shape in enumerate(run.modal.shapes.tolist(), 1)
        for node, three in zip(run.model.nodes, shape)
    ]


TABLE = Table(
    name="mode_shapes",
    title="Mode shapes",
    place=20,
    stages=(Stage.MODAL,),
    columns=(
        Column("mode", fmt="int", doc="number of the mode"),
        NODE,
        Column("x", "X", "-", "num", doc="translation"),
        Column("y", "Y", "-", "num", doc="translation"),
        Column("r", "R", "rad/L", "num", doc="rotation"),
    ),
    rows=rows,
    note="Scaled to a largest component of 1.",
    group="mode",
    limit=2000,
)
