"""Table ``push_legs``."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pound_solve.results.columns import LEG, PUSH
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each leg of a pushover that turns."""
    from pound_solve.analyses.cycles import legs  # not needed to read a report

    for pushed in run.pushovers:
        if pushed.curve[-1].leg == 1:
            continue
        lost = 0.0
        for leg in legs(pushed):
            lost += 0.0 if math.isnan(leg.loop) else leg.loop
            peak, damping = leg.largest.shear, 100.0 * leg.damping
            place = pushed.number, leg.end.leg, leg.end.displacement, leg.end.shear, peak
            yield *place, leg.stiffness, leg.loop, lost, damping


TABLE = Table(
    name="push_legs",
    title="Cycles of the pushovers",
    place=34,
    stages=(Stage.PUSHOVER,),
    columns=(
        PUSH,
        LEG,
        Column("displacement", "control\ndispl.", "L", "num", doc="at the end of the leg"),
        Column("base_shear", "base\nshear", "F", "num", doc="at the end of the leg"),
        Column(
            "largest", "largest\nin the leg", "F", "num", doc="base shear furthest in the sense of the leg"
        ),
        Column(
            "stiffness", "secant\nstiffness", "F/L", "short", doc="from the start of the leg to its end"
        ),
        Column(
            "loop", "half\nloop", "F*L", "num", doc="area between the leg and its chord, NaN for the first"
        ),
        Column("lost", "lost\nso far", "F*L", "num", doc="sum of these areas"),
        Column(
            "damping",
            "equivalent\ndamping",
            "%",
            "short",
            doc="that of a cycle of such legs, NaN for the first",
        ),
    ),
    rows=rows,
    group="push",
    note=(
        "A leg leads from one target to the next. Half a loop of base shear over control displacement lies "
        "between a leg and its chord."
    ),
)
