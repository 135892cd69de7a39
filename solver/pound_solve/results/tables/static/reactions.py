"""Table ``reactions``."""

from __future__ import annotations

from pound_solve.results.columns import NODE
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> list[Row]:
    """One row for each support."""
    return [(node, *three) for node, three in zip(run.static.held, run.static.reactions.tolist())]


TABLE = Table(
    name="reactions",
    title="Support reactions",
    place=30,
    stages=(Stage.STATIC,),
    columns=(
        NODE,
        Column("fx", "force X", "F", "num", doc="force of the support on the structure"),
        Column("fy", "force Y", "F", "num", doc="force of the support on the structure"),
        Column("mz", "moment", "F*L", "num", doc="moment of the support on the structure"),
    ),
    rows=rows,
    note="Forces of the supports on the structure.",
)
