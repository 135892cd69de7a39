"""Table ``push_legs``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.columns import LEG, PUSH, base_shear, control_displacement
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each leg of a pushover that turns."""
    from pound_solve.analyses.cycles import legs  # not needed to read a report

    for pushed in run.pushovers:
        if not pushed.turns:
            continue
        for leg in legs(pushed):
            place = pushed.number, leg.end.leg, leg.end.displacement, leg.end.shear, leg.largest.shear
            yield *place, leg.stiffness, leg.loop, 100.0 * leg.damping


TABLE = Table(
    name="push_legs",
    title="Cycles of the pushovers",
    place=34,
    stages=(Stage.PUSHOVER,),
    columns=(
        PUSH,
        LEG,
        control_displacement("at the end of the leg"),
        base_shear("at the end of the leg"),
        Column(
            "largest", "largest\nin the leg", "F", "num", doc="base shear furthest in the sense of the leg"
        ),
        Column(
            "stiffness", "secant\nstiffness", "F/L", "short", doc="from the start of the leg to its end"
        ),
        Column(
            "loop",
            "loop",
            "F*L",
            "num",
            doc="of this leg and the one before; NaN unless this one ends where that one began",
        ),
        Column(
            "damping",
            "equivalent\ndamping",
            "%",
            "short",
            doc="of that loop; NaN where the base shear does not rise with the displacement",
        ),
    ),
    rows=rows,
    group="push",
    note=(
        "A leg leads from one target to the next. It closes a loop with the leg before it if it ends where "
        "that one began."
    ),
)
