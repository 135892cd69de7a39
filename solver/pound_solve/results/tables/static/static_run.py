"""Table ``static_run``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.columns import ITEM, VALUE
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """Counts of the analysis; the buckling load factor where axial forces matter."""
    state = run.static.state
    yield "changes of springs and contacts", str(state.events)
    if run.structure.geometric:
        yield "rounds of P-Delta", str(state.rounds)
        yield "buckling load factor", f"{state.buckling:.5g}"


TABLE = Table(
    name="static_run",
    title="Log of the static analysis",
    place=50,
    stages=(Stage.STATIC,),
    columns=(ITEM, VALUE),
    rows=rows,
)
