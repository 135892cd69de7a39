"""Table ``nodes``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.columns import NODE
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each node."""
    for n in run.model.nodes.values():
        yield n.id, n.x, n.y, n.fixed, "".join(n.slaved), next(iter(n.slaved.values()), 0)


TABLE = Table(
    name="nodes",
    title="Nodes",
    place=20,
    stages=(Stage.INPUT,),
    columns=(
        NODE,
        Column("x", "X", "L", "given", doc="coordinate"),
        Column("y", "Y", "L", "given", doc="coordinate"),
        Column("fixed", "fixed", doc="fixed directions, out of `XYR`"),
        Column("slaved", "slaved", doc="directions that follow the master node"),
        Column("master", "master", fmt="int", doc="master node, 0 for none", zero="-"),
    ),
    rows=rows,
    note="X and Y are translations, R is the rotation (positive counter-clockwise).",
)
