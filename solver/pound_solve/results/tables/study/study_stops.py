"""Table ``study_stops``."""

from __future__ import annotations

from pound_solve.results.schema import Column, Row, Stage, Table
from pound_solve.results.study_record import MethodStudy


def rows(study: MethodStudy) -> list[Row]:
    """One row for each trial that stopped early."""
    return [(t.method, t.setting, t.stopped) for t in study.trials if t.stopped]


TABLE = Table(
    name="study_stops",
    title="Runs that stopped early",
    place=20,
    stages=(Stage.STUDY,),
    columns=(
        Column("method", doc="method of HISTORY"),
        Column("setting", doc="its step or tolerance"),
        Column("why", doc="reason"),
    ),
    rows=rows,
)
