"""Table ``member_loads``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.columns import ELEMENT
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each element of each card."""
    for c in run.model.member_loads:
        units = (run.model.units.text(unit) for unit in ("F/L", "F/L", "F", "F"))
        parts = [f"{k} {c[k]:.6g} {unit}" for k, unit in zip(("WX", "WY", "PX", "PY"), units) if c[k]]
        if c["PX"] or c["PY"]:
            parts.append(f"AT {c['AT']:.4g}")
        for element in c["ELEMENTS"]:
            yield element, ", ".join(parts)


TABLE = Table(
    name="member_loads",
    title="Member loads",
    place=70,
    stages=(Stage.INPUT,),
    columns=(ELEMENT, Column("load", doc="the load in words")),
    rows=rows,
)
