"""Table ``run``."""

from __future__ import annotations

from pound_solve.results.columns import ITEM, VALUE
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Row, Stage, Table


def rows(run: RunRecord) -> list[Row]:
    """Number of unknowns, the figures of the method, and whether close-ups were thinned out."""
    figures = run.history.figures
    return [("unknowns", str(run.history.system.size)), *((k, str(v)) for k, v in figures.items())]


TABLE = Table(
    name="run", title="Run log", place=30, stages=(Stage.PEAKS,), columns=(ITEM, VALUE), rows=rows
)
