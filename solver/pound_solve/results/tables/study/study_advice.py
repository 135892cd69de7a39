"""Table ``study_advice``."""

from __future__ import annotations

import math
from collections.abc import Iterator
from operator import attrgetter

from pound_solve.results.schema import Column, Row, Stage, Table
from pound_solve.results.study_record import MethodStudy


def rows(study: MethodStudy) -> Iterator[Row]:
    """One row for each target."""
    for a in study.advice:
        if a.trial is None:
            yield a.target, "", "", *[math.nan] * 3
        else:
            yield a.target, a.trial.method, a.trial.setting, a.trial.time, a.trial.error, a.sure


TABLE = Table(
    name="study_advice",
    title="Least time for an error",
    place=30,
    stages=(Stage.STUDY,),
    columns=(
        Column("target", "largest\nerror", "-", "short", doc="error that must be met"),
        Column("method", doc="method of HISTORY; empty where no run is sure to meet it"),
        Column("setting", doc="its step or tolerance"),
        Column("seconds", "CPU time,\nsolve [s]", fmt="short", doc="CPU time of that run"),
        Column("error", "error\nfound", "-", "short", doc="largest error of that run"),
        Column("sure", "error\nallowed for", "-", "short", doc="that error with a safety margin"),
    ),
    rows=rows,
    remark=attrgetter("sentence"),
)
