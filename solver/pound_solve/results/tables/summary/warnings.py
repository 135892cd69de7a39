"""Table ``warnings``."""

from __future__ import annotations

from pathlib import Path

from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> list[Row] | None:
    """One row for each warning about the deck; none where there is nothing to warn of."""
    out = []
    for own in run.warnings:
        place = f"{Path(own.span.file).name}:{own.span.line}" if own.span else ""
        out.append((own.code, place, f"{own.message}; {own.hint}" if own.hint else own.message))
    return out or None


TABLE = Table(
    name="warnings",
    title="Warnings about the input",
    place=20,
    stages=(Stage.INPUT,),
    columns=(
        Column("number", doc="number of the message"),
        Column("place", doc="file and line"),
        Column("warning", doc="what may be wrong, and what would be right"),
    ),
    rows=rows,
    sample=(
        ("P336", "model.inp:31", "contacts of WALL are pressed at rest: GAP is -0.002"),
        ("R404", "model.inp:44", "the peak is 4.1 g"),
    ),
)
