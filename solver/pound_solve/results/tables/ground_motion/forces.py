"""Table ``forces``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.columns import time_column
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table
from pound_solve.results.words import text_of


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each FORCES card."""
    for n, f in enumerate(run.forces, 1):
        t_peak, peak = f.history.peak()
        name = f"{n} {f.info.get('name', f.info['kind'])}"
        yield name, text_of(f.nodes), *f.push, peak, t_peak, f.history.end


TABLE = Table(
    name="forces",
    title="Forces in time",
    place=20,
    stages=(Stage.INPUT,),
    columns=(
        Column("force", doc="number in the deck, and kind or name of the history"),
        Column("nodes", doc="nodes on which it acts"),
        Column("fx", "force X", "F", "given", doc="force in X where the history is one"),
        Column("fy", "force Y", "F", "given", doc="force in Y where the history is one"),
        Column("mz", "moment", "F*L", "given", doc="moment where the history is one"),
        Column("peak", "peak", "-", "short", doc="value of the history of the largest magnitude"),
        time_column("t_peak", "at time", "time of that value"),
        time_column("end", "end", "time at which the history ends"),
    ),
    rows=rows,
    note="The force at each node is the given force times the history.",
)
