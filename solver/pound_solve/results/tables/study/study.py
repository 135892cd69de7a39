"""Table ``study``."""

from __future__ import annotations

import math

from pound_solve.results.schema import Column, Row, Stage, Table
from pound_solve.results.study_record import MethodStudy


def rows(study: MethodStudy) -> list[Row]:
    """One row for each trial."""
    return [
        (
            t.method,
            t.setting,
            t.time,
            t.steps,
            t.events,
            *(t.errors.get(kind, math.nan) for kind in ("drift", "member", "contact")),
            order,
            t.collisions,
            t.residual,
        )
        for t, order in zip(study.trials, study.orders)
    ]


def remark(study: MethodStudy) -> str:
    """Remark on the reference of the errors, and on whether the times can be trusted."""
    own_errors = ", ".join(
        f"{e:.1e} ({kind})" for kind, e in study.reference.error.items() if math.isfinite(e)
    )
    errors = f"; its own errors are about {own_errors}." if own_errors else "."
    times = " Times are CPU times of the history alone, in a process that has loaded what it needs."
    return f"The reference is {study.reference.how}{errors}{times} {study.warning}".rstrip()


TABLE = Table(
    name="study",
    title="Error and time of every run",
    place=10,
    stages=(Stage.STUDY,),
    columns=(
        Column("method", doc="method of HISTORY"),
        Column("setting", doc="its step or tolerance as a deck has it"),
        Column("seconds", "CPU time,\nsolve [s]", fmt="short", doc="median CPU time of the repeated runs"),
        Column("steps", fmt="int", doc="steps taken", zero="-"),
        Column("events", fmt="int", doc="changes of springs and contacts that were located"),
        Column(
            "drift",
            "drifts",
            "-",
            "short",
            doc="error of the drifts, or of displacements if there are none",
        ),
        Column("member", "member\nforces", "-", "short", doc="error of forces of members and springs"),
        Column("contact", "contact\nforces", "-", "short", doc="error of the peak contact forces"),
        Column(
            "order",
            "order",
            "-",
            "short",
            doc="order of convergence of the largest of the three errors, against the row above",
        ),
        Column("collisions", "colli-\nsions", fmt="int", doc="number of collisions"),
        Column(
            "residual",
            "energy\nresidual",
            "-",
            "short",
            doc="largest energy residual over the largest energy",
        ),
    ),
    rows=rows,
    remark=remark,
    note=(
        "An error is the largest difference of an extreme from that of the reference, over "
        "the largest extreme of that kind."
    ),
    group="method",
)
