"""Table ``backbone``."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pound_solve.results.columns import PUSH, base_shear, control_displacement
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each target that lies further out than all before it."""
    from pound_solve.analyses.cycles import backbone  # not needed to read a report

    for pushed in run.pushovers:
        if not pushed.turns:
            continue
        for first, last, cycles in backbone(pushed):
            left = last.shear / first.shear if first.shear else math.nan
            yield pushed.number, first.leg, first.displacement, first.shear, cycles, last.shear, left


TABLE = Table(
    name="backbone",
    title="Backbone of the cycles",
    place=36,
    stages=(Stage.PUSHOVER,),
    columns=(
        PUSH,
        Column("leg", "first\nleg", fmt="int", doc="number of the leg that reached it first"),
        control_displacement("target displacement"),
        base_shear("when it was reached first"),
        Column("times", "times\nreached", fmt="int", doc="number of legs that end there"),
        Column("last", "at the\nlast", "F", "num", doc="base shear when it was reached last"),
        Column(
            "ratio",
            "last over\nfirst",
            "-",
            "short",
            doc="base shear when it was reached last over that at first",
        ),
    ),
    rows=rows,
    group="push",
    note="The ends of the legs that went further to their side than all before them.",
)
