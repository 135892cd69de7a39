"""Table ``member_envelope``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.columns import ELEMENT, UNIT, extreme_columns
from pound_solve.results.record import RunRecord
from pound_solve.results.remarks import SIGNS, how_sampled
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each force of each recorded member."""
    envelope = run.history.recorder.envelopes.output.rows()
    for o, extremes in zip(run.history.items.outputs, envelope):
        yield o.element, o.quantity, run.model.units.text(o.unit), *extremes


def remark(run: RunRecord) -> str:
    """Remark on the instants that the envelopes are taken from, and on the sign convention."""
    return how_sampled(run) + SIGNS


TABLE = Table(
    name="member_envelope",
    title="Member envelopes",
    place=10,
    stages=(Stage.SAMPLES,),
    columns=(ELEMENT, Column("quantity", doc="name of the force or moment"), UNIT, *extreme_columns("")),
    rows=rows,
    remark=remark,
)
