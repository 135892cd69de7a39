"""Table ``push_events``."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from pound_solve.results.columns import ELEMENT, PUSH, base_shear, control_displacement
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table

if TYPE_CHECKING:
    from pound_solve.analyses.path_following import Change
    from pound_solve.analyses.pushover import CapacityPoint, PushoverResult


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each change of a spring, hinge or contact."""
    for pushed, p, c in _events(run):
        spring = pushed.structure.laws[c.law]
        yield (
            pushed.number,
            p.changes,
            p.displacement,
            p.shear,
            p.factor,
            spring.element,
            spring.component,
            c.before,
            c.after,
        )


def _events(run: RunRecord) -> Iterator[tuple[PushoverResult, CapacityPoint, Change]]:
    return ((pushed, *event) for pushed in run.pushovers for event in pushed.ladder)


TABLE = Table(
    name="push_events",
    title="Events of the pushover",
    place=40,
    stages=(Stage.PUSHOVER,),
    columns=(
        PUSH,
        Column("event", fmt="int", doc="number"),
        control_displacement("displacement of the control node"),
        base_shear("force on the ground along the direction of the pushover"),
        Column("factor", "load\nfactor", "-", "num", doc="factor on the pattern"),
        ELEMENT,
        Column("component", "comp.", doc="spring, hinge or contact of the element"),
        Column("before", "from", doc="branch before the event"),
        Column("after", "to", doc="branch after the event"),
    ),
    rows=rows,
    group="push",
    limit=1000,
)
