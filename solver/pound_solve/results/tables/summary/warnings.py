"""Table ``warnings``."""

from __future__ import annotations

from pathlib import Path

from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> list[Row] | None:
    """One row for each warning about the deck; none where there is nothing to warn of."""
    listed = []
    for warning in run.warnings:
        place = f"{Path(warning.span.file).name}:{warning.span.line}" if warning.span else ""
        listed.append(
            (warning.code, place, f"{warning.message}; {warning.hint}" if warning.hint else warning.message)
        )
    return listed or None


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
)
