"""Table ``spring_envelope``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.columns import COMPONENT, ELEMENT, RULE
from pound_solve.results.record import RunRecord
from pound_solve.results.remarks import how_found
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each spring and hinge."""
    units = run.model.units
    for r in run.history.springs:
        yield (
            r.spring.element,
            r.spring.component,
            r.spring.rule,
            units.text(r.spring.unit),
            r.force.high,
            r.force.low,
            units.text(r.deformation_unit),
            r.deformation.high,
            r.deformation.low,
            r.yields,
            r.ductility,
            r.loss,
        )


TABLE = Table(
    name="spring_envelope",
    title="Spring envelopes",
    place=20,
    stages=(Stage.PEAKS,),
    columns=(
        ELEMENT,
        COMPONENT,
        RULE,
        Column("unit", "unit of\nforce", doc="unit of the forces in this row"),
        Column("force_max", "largest\nforce", fmt="short", doc="largest force or moment"),
        Column("force_min", "smallest\nforce", fmt="short", doc="smallest force or moment"),
        Column("deformation_unit", "unit of\ndeform.", doc="unit of the deformations in this row"),
        Column("deformation_max", "largest\ndeform.", fmt="short", doc="largest deformation"),
        Column("deformation_min", "smallest\ndeform.", fmt="short", doc="smallest deformation"),
        Column(
            "yield_events",
            "yield\nevents",
            fmt="count",
            doc="number of times that the spring started to yield, NaN for a rule without a yield line",
        ),
        Column(
            "ductility",
            "ductility",
            "-",
            "short",
            doc="largest absolute deformation over yield, NaN for none",
        ),
        Column("plastic_work", "plastic\nwork", "F*L", "short", doc="energy lost in hysteresis"),
    ),
    rows=rows,
    remark=how_found,
)
