"""Table ``member_loads``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.columns import ELEMENT
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each element of each card."""
    for c in run.model.member_loads:
        parts = [f"{k} {c[k]:.6g}" for k in ("WX", "WY", "PX", "PY") if c[k]]
        if c["PX"] or c["PY"]:
            parts.append(f"AT {c['AT']:.4g}")
        for element in c["ELEMENTS"]:
            yield element, ", ".join(parts)


TABLE = Table(
    name="member_loads",
    title="Member loads",
    place=70,
    stages=(Stage.INPUT,),
    columns=(
        ELEMENT,
        Column("load", doc="the load in words"),
    ),
    rows=rows,
    sample=((101, "uniform -12 kN/m in global Y over the whole length"),),
)
