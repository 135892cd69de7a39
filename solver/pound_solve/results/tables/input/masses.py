"""Table ``masses``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.columns import NODE
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """Nodes with mass, the members' shares included."""
    mass = run.structure.nodal_mass
    for node in run.structure.model.nodes:
        masses = [mass.get((node, d), 0.0) for d in range(3)]
        if any(masses):
            yield node, *masses


TABLE = Table(
    name="masses",
    title="Lumped masses",
    place=50,
    stages=(Stage.INPUT,),
    columns=(
        NODE,
        Column("mx", "X", "F*T^2/L", "num", doc="mass in X"),
        Column("my", "Y", "F*T^2/L", "num", doc="mass in Y"),
        Column("mr", "R", "F*L*T^2", "num", doc="rotational inertia"),
    ),
    rows=rows,
)
