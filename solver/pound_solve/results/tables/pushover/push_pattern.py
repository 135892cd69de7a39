"""Table ``push_pattern``."""

from __future__ import annotations

from pound_solve.results.columns import NODE, PUSH
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> list[Row]:
    """One row for each degree of freedom that is pushed."""
    return [
        (pushed.number, owner, "XYR"[d], float(a), float(b))
        for pushed in run.pushovers
        for (owner, d), a, b in zip(pushed.structure.dofs.free, pushed.first, pushed.last)
        if d < 3 and (a or b)
    ]


TABLE = Table(
    name="push_pattern",
    title="Pattern of the pushing forces",
    place=20,
    stages=(Stage.PUSHOVER,),
    columns=(
        PUSH,
        NODE,
        Column("direction", "dir.", doc="`X`, `Y` or `R`"),
        Column("first", "at the start", fmt="num", doc="force or moment for a load factor of one"),
        Column("last", "at the end", fmt="num", doc="force or moment for a load factor of one"),
    ),
    rows=rows,
    group="push",
    note=("For a load factor of one. Forces on slaved degrees of freedom stand at their masters."),
)
