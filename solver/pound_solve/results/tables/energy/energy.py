"""Table ``energy``."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pound_solve.results.columns import ITEM
from pound_solve.results.histories.energy import ENERGIES
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each energy, and the residual."""
    changes = run.history.recorder.energy.changes
    share = 100.0 / changes[0] if changes[0] else math.nan
    for name, value in zip(ENERGIES, changes):
        yield name, value, value * share


def remark(run: RunRecord) -> str:
    """Remark on the motion, total or relative to the ground, that the energies belong to."""
    if run.history.system.total:
        return "Changes since the start."
    return "Changes since the start, of the motion relative to the ground."


TABLE = Table(
    name="energy",
    title="Energy at the end",
    place=10,
    stages=(Stage.SAMPLES,),
    columns=(
        ITEM,
        Column("value", "energy", "F*L", "num", doc="energy or work"),
        Column("share", "of input", "%", "percent", doc="share of the input energy"),
    ),
    rows=rows,
    remark=remark,
)
