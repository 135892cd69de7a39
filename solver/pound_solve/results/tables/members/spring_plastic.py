"""Table ``spring_plastic``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.columns import ELEMENT
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each spring and hinge that has lost energy."""
    for r in run.history.springs:
        if r.plastic is not None:
            unit = run.model.units.text(r.deformation_unit)
            yield r.spring.element, r.spring.component, unit, *r.plastic


TABLE = Table(
    name="spring_plastic",
    title="Plastic deformation of springs",
    place=30,
    stages=(Stage.PEAKS,),
    columns=(
        ELEMENT,
        Column("component", "comp.", doc="as in the spring envelopes"),
        Column("unit", doc="unit of the deformations in this row"),
        Column("last", "at the\nend", fmt="short", doc="deformation at the end"),
        Column(
            "residual",
            "residual",
            fmt="short",
            doc="deformation left after unloading; NaN for a run that stopped early",
        ),
        Column("path", "plastic\npath", fmt="short", doc="plastic work over the yield force"),
        Column("path_ratio", "path over\nyield", "-", "short", doc="path over the deformation at yield"),
    ),
    rows=rows,
    note=(
        "Springs that have lost energy. The plastic path is the plastic work over the mean of "
        "both yield forces: for an elastic, perfectly plastic spring, the sum of all plastic "
        "deformations."
    ),
)
