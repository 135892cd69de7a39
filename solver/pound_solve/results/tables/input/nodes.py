"""Table ``nodes``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.columns import NODE
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each node."""
    for n in run.model.nodes.values():
        masters = [str(master) for master in n.slaved.values()]
        differ = len(set(masters)) > 1
        yield n.id, n.x, n.y, n.fixed, "".join(n.slaved), ",".join(masters if differ else masters[:1])


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
        Column("slaved", "slaved", doc="directions that follow the master node, out of `XYR`"),
        Column(
            "master", "master", doc="master node; where they differ, that of each direction, with commas"
        ),
    ),
    rows=rows,
    note="X and Y are translations, R is the rotation (positive counter-clockwise).",
)
