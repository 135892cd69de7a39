"""Table ``push_events``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.columns import ELEMENT
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each change of a spring, hinge or contact."""
    laws = run.pushover.structure.laws
    for p, c in run.pushover.ladder:
        spring = laws[c.law]
        yield (
            p.changes,
            p.displacement,
            p.shear,
            p.factor,
            spring.element,
            spring.component,
            c.before,
            c.after,
        )


TABLE = Table(
    name="push_events",
    title="Events of the pushover",
    place=40,
    stages=(Stage.PUSHOVER,),
    columns=(
        Column("event", fmt="int", doc="number"),
        Column("displacement", "control\ndispl.", "L", "num", doc="displacement of the control node"),
        Column(
            "base_shear",
            "base\nshear",
            "F",
            "num",
            doc="force on the ground along the direction of the pushover",
        ),
        Column("factor", "load\nfactor", "-", "num", doc="factor on the pattern"),
        ELEMENT,
        Column("component", "comp.", doc="spring, hinge or contact of the element"),
        Column("before", "from", doc="branch before the event"),
        Column("after", "to", doc="branch after the event"),
    ),
    rows=rows,
    limit=1000,
)
