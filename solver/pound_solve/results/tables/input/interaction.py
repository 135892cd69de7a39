"""Table ``interaction``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each corner of the diagram of each BEAM_COLUMN section, anticlockwise."""
    # not needed to read a report
    from pound_solve.structure.elements.beam_column import capacity, diagram, springs

    for label in dict.fromkeys(e.prop for e in run.model.elements.values()):
        card = run.model.props[label]
        if card.spec.name == "BEAM_COLUMN":
            for axial, moment in capacity(springs(diagram(card))).tolist():
                yield label, axial, moment


TABLE = Table(
    name="interaction",
    title="Diagrams of axial force and moment",
    place=42,
    stages=(Stage.INPUT,),
    columns=(
        Column("property", doc="property set"),
        Column("axial", "axial\nforce", "F", "num", "axial force of a corner, tension positive"),
        Column("moment", "moment", "F*L", "num", "moment of the corner, sagging positive"),
    ),
    rows=rows,
    group="property",
    note="Strength of the hinges of BEAM_COLUMN: the diagram of their springs.",
)
