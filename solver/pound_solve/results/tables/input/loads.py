"""Table ``loads``."""

from __future__ import annotations

from pound_solve.results.columns import NODE
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table
from pound_solve.results.words import text_of


def rows(run: RunRecord) -> list[Row]:
    """One row for each node of each card; weights that act as loads are among them."""
    return [(node, c["FX"], c["FY"], c["MZ"]) for c in run.structure.model.loads for node in c["NODES"]]


def remark(run: RunRecord) -> str | None:
    """Remark on the loads that are removed at the start of the history; None without any."""
    cards = [c for c in run.structure.model.loads if c["HELD"] == "NO" and c["NODES"]]
    if not cards:
        return None
    each = "; ".join(f"{c['FX']:.6g} {c['FY']:.6g} {c['MZ']:.6g} on {text_of(c['NODES'])}" for c in cards)
    return f"Removed where the history starts (HELD=NO): {each}."


TABLE = Table(
    name="loads",
    title="Nodal loads",
    place=60,
    stages=(Stage.INPUT,),
    columns=(
        NODE,
        Column("fx", "force X", "F", "given", doc="force in X"),
        Column("fy", "force Y", "F", "given", doc="force in Y"),
        Column("mz", "moment", "F*L", "given", doc="moment"),
    ),
    rows=rows,
    remark=remark,
)
