"""Table ``checks``."""

from __future__ import annotations

from collections.abc import Sequence

from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Sequence[Row]:
    """One row for each check of all analyses so far."""
    return run.checks


TABLE = Table(
    name="checks",
    title="Checks of this run",
    place=50,
    stages=(
        Stage.STATIC,
        Stage.PUSHOVER,
        Stage.PEAKS,
    ),
    columns=(
        Column("check", doc="what was checked"),
        Column("value", doc="what was found"),
        Column("verdict", doc="`good`, or what to look at"),
    ),
    rows=rows,
    sample=(
        ("energy residual over input", "1.9E-13", "good"),
        ("propagator against half steps", "3.1E-15", "good"),
        ("largest open gap at an event", "2.2E-16 m", "good"),
    ),
)
