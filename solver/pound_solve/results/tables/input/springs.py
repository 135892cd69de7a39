"""Table ``springs``."""

from __future__ import annotations

from collections.abc import Iterator
from math import nan

from pound_solve.results.columns import COMPONENT, ELEMENT, RULE
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each spring and hinge with a hysteresis rule."""
    from pound_solve.structure.elements.base import Role  # not needed to read a report

    units = run.model.units
    for s in run.structure.laws:
        if s.role is Role.SPRING:
            stiffness = s.k0 / (1.0 + s.k0 * s.beside)
            of_stiffness = units.text("F/L" if s.unit == "F" else "F*L/rad")
            strengths = s.strengths or (nan, nan)
            yield s.element, s.component, s.rule, stiffness, of_stiffness, *strengths, units.text(s.unit)


TABLE = Table(
    name="springs",
    title="Springs and hinges",
    place=45,
    stages=(Stage.INPUT,),
    columns=(
        ELEMENT,
        COMPONENT,
        RULE,
        Column("stiffness", "initial\nstiffness", fmt="num", doc="initial stiffness"),
        Column("stiffness_unit", "unit", doc="unit of the stiffness in this row"),
        Column("yield_plus", "yield\npositive", fmt="num", doc="force of first yield, NaN for none"),
        Column("yield_minus", "yield\nnegative", fmt="num", doc="the same for negative deformations"),
        Column("unit", doc="unit of these forces"),
    ),
    rows=rows,
    limit=100,
)
