"""Report of sensitivities: derivatives of quantities with respect to variables, and their errors."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from pound_solve.report.plot.suites import BarPanel
from pound_solve.report.text import printed
from pound_solve.results.schema import Column, Row, Sheet
from pound_solve.results.sweep_file import Sweep, Variable
from pound_solve.statistics.curves import Asked, units_of
from pound_solve.statistics.sensitivity import Sensitivities, Sensitivity

GRAZING: Final = 1e-2  #: approach speed over the largest of a run below which a collision grazes


def report(sweep: Sweep, result: Sensitivities) -> Iterator[str]:
    """Lines of the report: a table for each quantity."""
    units = units_of(sweep)
    if result.unknown_error:
        yield "The runs take steps whose error is not known: errors are those of the differences alone."
        yield "METHOD=AUTO estimates its error, or has none."
        yield ""
    yield "Elasticity: relative change of the quantity over the relative change of the variable."
    for asked, some in by_quantity(result.lines).items():
        yield from ("", heading(sweep, asked), "")
        yield from printed(units, TABLE, [_row(line) for line in some])
        if lacking := [line for line in some if line.derivative.reason]:
            yield from ("", *printed(units, REASONS, [_reason(line) for line in lacking]))
    if result.remarks:
        yield from ("", *printed(units, REMARKS, result.remarks))
    for record, share in result.gentlest.items():
        if share < GRAZING:
            yield ""
            run = record or "the run"
            yield f"A collision of {run} grazes: its approach speed is {share:.2g} of the largest."
            yield "Near a grazing contact, a derivative holds within a small change of the variable only."


def by_quantity(lines: Sequence[Sensitivity]) -> dict[Asked, list[Sensitivity]]:
    """Group lines by their quantity."""
    groups: dict[Asked, list[Sensitivity]] = {}
    for line in lines:
        groups.setdefault(line.asked, []).append(line)
    return groups


def heading(sweep: Sweep, asked: Asked) -> str:
    """Name of a quantity with its label and unit."""
    variable = sweep.variables.get(asked.quantity)
    label = asked.label or ("largest of all" if variable is not None and variable.axis else "")
    unit = variable.unit if variable is not None else ""
    return f"{asked.quantity}{', ' * bool(label)}{label} [{unit or '-'}]"


def _row(line: Sensitivity) -> Row:
    d = line.derivative
    return (
        line.variable,
        f"{line.at:.6g}",
        line.record,
        d.value,
        d.slope,
        "events" if d.exact else "",
        line.elasticity,
        line.elasticity_error,
    )


def _reason(line: Sensitivity) -> Row:
    return line.variable, line.record, line.derivative.reason


def variables(sweep: Sweep, lines: Sequence[Sensitivity]) -> dict[str, Variable]:
    """Columns of the table of sensitivities as a file."""

    def texts(values: Sequence[str]) -> Variable:
        return Variable(np.array(values, object))

    def unit(asked: Asked) -> str:
        return sweep.variables[asked.quantity].unit if asked.quantity in sweep.variables else ""

    ds = [line.derivative for line in lines]
    return {
        "quantity": texts([line.asked.quantity for line in lines]),
        "label": texts([line.asked.label for line in lines]),
        "unit": texts([unit(line.asked) for line in lines]),
        "record": texts([line.record for line in lines]),
        "variable": texts([line.variable for line in lines]),
        "at": Variable(np.array([line.at for line in lines]), doc="value of the variable"),
        "value": Variable(np.array([d.value for d in ds]), doc="value of the quantity"),
        "derivative": Variable(np.array([d.slope for d in ds]), doc="derivative by the variable"),
        "error": Variable(np.array([d.error for d in ds]), doc="bound of its error"),
        "elasticity": Variable(np.array([line.elasticity for line in lines]), doc="relative derivative"),
        "step": Variable(np.array([d.step for d in ds]), doc="outer step of the differences"),
        "exact": texts(["yes" if d.exact else "no" for d in ds]),
        "reason": texts([d.reason for d in ds]),
    }


def drawn(sweep: Sweep, lines: Sequence[Sensitivity]) -> list[BarPanel]:
    """Data of the picture: the elasticities of every quantity."""
    panels = []
    for asked, some in by_quantity(lines).items():
        rows = dict.fromkeys(line.variable for line in some)
        records = dict.fromkeys(line.record for line in some)
        values = {(line.variable, line.record): line.elasticity for line in some}
        bars = [(record, np.array([values[name, record] for name in rows])) for record in records]
        panels.append(BarPanel(heading(sweep, asked), "elasticity [-]", list(rows), bars))
    return panels


TABLE: Final = Sheet(
    columns=(
        Column("variable", doc="PARAM, or the factor on the records"),
        Column("at", doc="value of the variable"),
        Column("record", doc="record, or how the values of all records became one"),
        Column("value", "quantity", "", "num", doc="value of the quantity"),
        Column("slope", "derivative", "", "num", doc="derivative by the variable"),
        Column("by", doc="events: an exact derivative through the events of one run"),
        Column("elasticity", "elasticity", "-", "num", doc="relative derivative"),
        Column("error", "its error\nat most", "-", "short", doc="bound of the error of the elasticity"),
    )
)
REMARKS: Final = Sheet(
    columns=(
        Column("record", doc="record"),
        Column("remark", "exact derivatives", doc="what they lack or are close to"),
    )
)
REASONS: Final = Sheet(
    columns=(
        Column("variable", doc="PARAM, or the factor on the records"),
        Column("record", doc="record"),
        Column("reason", "no derivative", doc="why there is none"),
    )
)
