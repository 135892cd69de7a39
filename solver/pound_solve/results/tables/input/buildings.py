"""Table ``buildings``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each building."""
    from pound_solve.structure.buildings import buildings  # not needed to read a report

    for b in buildings(run.structure):
        yield b.name, b.nodes[0], len(b.nodes), b.mass, b.base, b.levels[-1], len(b.floors)


TABLE = Table(
    name="buildings",
    title="Buildings",
    place=120,
    stages=(Stage.INPUT,),
    columns=(
        Column("building", doc="name in the deck, or its number"),
        Column("node", "lowest\nnode", fmt="int", doc="lowest number of its nodes"),
        Column("nodes", fmt="int", doc="number of nodes"),
        Column("mass", "mass", "F*T^2/L", "num", doc="mass of all its nodes along x, else along y"),
        Column("base", "base", "L", "given", doc="height of its base"),
        Column("top", "top", "L", "given", doc="height of its highest floor"),
        Column("storeys", fmt="int", doc="number of storeys, which is that of the floors"),
    ),
    rows=rows,
    note="A building is what elements and slaving connect; contacts do not. A floor is a level of nodes "
    "with mass above the lowest support.",
)
