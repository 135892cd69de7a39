"""Table ``elements``."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pound_solve.results.columns import ELEMENT
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each element."""
    model = run.model
    for e in model.elements.values():
        i, j = model.nodes[e.i], None if e.j is None else model.nodes[e.j]
        length = 0.0 if j is None else math.hypot(j.x - i.x, j.y - i.y)
        yield e.id, e.name, e.prop, model.props[e.prop].spec.name, e.i, e.j or 0, length


TABLE = Table(
    name="elements",
    title="Elements",
    place=30,
    stages=(Stage.INPUT,),
    columns=(
        ELEMENT,
        Column("name", doc="name in the deck, if any"),
        Column("property", doc="property set"),
        Column("kind", doc="kind of element"),
        Column("i", "node I", fmt="int", doc="first node"),
        Column("j", "node J", fmt="int", doc="second node, 0 for the ground or a wall", zero="ground"),
        Column("length", "length", "L", "num", doc="distance between the nodes"),
    ),
    rows=rows,
)
