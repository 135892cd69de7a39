"""Table ``checks``."""

from __future__ import annotations

from collections.abc import Iterator
from enum import StrEnum

from pound_solve.check import Bound, Subject, Verdict
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each check of all analyses so far."""
    return (check.row() for check in run.checks)


def _all(words: type[StrEnum]) -> str:
    return ", ".join(f"`{word}`" if word else "or empty" for word in words)


TABLE = Table(
    name="checks",
    title="Checks of this run",
    place=50,
    stages=(Stage.STATIC, Stage.PUSHOVER, Stage.PEAKS),
    columns=(
        Column("subject", doc=_all(Subject)),
        Column("check", doc="what was checked"),
        Column("value", fmt="short", doc="what was found"),
        Column("unit", doc="of value and allowed; empty for a pure number"),
        Column("bound", doc=_all(Bound)),
        Column("allowed", fmt="short", doc="what the value may be; NaN where there is no bound"),
        Column("verdict", doc=_all(Verdict)),
        Column("remark", doc="what to do about it, or how to read it"),
    ),
    rows=rows,
    group="check",  # a check has its own number of digits
)
