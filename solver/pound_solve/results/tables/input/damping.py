"""Table ``damping``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table
from pound_solve.results.words import damped_part


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each card."""
    for card, text in run.structure.damping_texts:
        yield damped_part(card), card.spec.name, text


TABLE = Table(
    name="damping",
    title="Damping",
    place=80,
    stages=(Stage.INPUT,),
    columns=(
        Column("group", doc="part of the structure"),
        Column("kind", doc="damping model"),
        Column("description", doc="coefficients, and what they multiply"),
    ),
    rows=rows,
)
