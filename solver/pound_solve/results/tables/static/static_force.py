"""Table ``static_force``."""

from __future__ import annotations

from pound_solve.results.columns import ELEMENT, UNIT
from pound_solve.results.record import RunRecord
from pound_solve.results.remarks import SIGNS
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> list[Row]:
    """All forces of members, springs and contacts, by element."""
    units = run.model.units
    return [(f.element, f.quantity, f.value, units.text(f.unit)) for f in run.static.forces]


def remark(run: RunRecord) -> str:
    """State the sign convention."""
    return SIGNS


TABLE = Table(
    name="static_force",
    title="Static element forces",
    place=20,
    stages=(Stage.STATIC,),
    columns=(
        ELEMENT,
        Column("quantity", doc="name of the force or moment"),
        Column("value", fmt="num", doc="force or moment"),
        UNIT,
    ),
    rows=rows,
    remark=remark,
)
