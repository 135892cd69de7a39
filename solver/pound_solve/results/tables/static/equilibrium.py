"""Table ``equilibrium``."""

from __future__ import annotations

from pound_solve.results.columns import ITEM
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> list[Row]:
    """Rows of the forces that act on the structure, and of their sum."""
    return run.static.balance


TABLE = Table(
    name="equilibrium",
    title="Equilibrium of the static state",
    place=40,
    stages=(Stage.STATIC,),
    columns=(
        ITEM,
        Column("fx", "force X", "F", "num", doc="sum of the forces in X"),
        Column("fy", "force Y", "F", "num", doc="sum of the forces in Y"),
        Column("mz", "moment", "F*L", "num", doc="sum of the moments about the origin"),
    ),
    rows=rows,
    note="All that acts on the structure, moments about the origin of the coordinates.",
)
