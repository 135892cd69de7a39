"""Report of sensitivities: derivatives of quantities with respect to variables, and their errors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

import numpy as np

from pound_solve.report.plot.suites import BarPanel
from pound_solve.report.text import printed
from pound_solve.results.schema import Column, Row, Sheet
from pound_solve.results.sweep_file import Sweep, Variable
from pound_solve.statistics.curves import Asked, units_of
from pound_solve.statistics.sensitivity import Sensitivity

GRAZING: Final = 1e-2  #: approach speed over the largest of a run below which a collision grazes


def report(
    sweep: Sweep, lines: Sequence[Sensitivity], gentlest: Mapping[str, float], unknown_error: bool
) -> Iterator[str]:
    """Lines of the report: a table for each quantity.

    Parameters
    ----------
    sweep : Sweep
    lines : sequence of Sensitivity
    gentlest : mapping of str to float
        By record, the smallest approach speed of a collision over the largest.
    unknown_error : bool
        Whether runs took steps whose error they do not estimate.
    """
    units = units_of(sweep)
    if unknown_error:
        yield "The runs take steps whose error is not known: errors are those of the differences alone."
        yield "METHOD=AUTO estimates its error, or has none."
        yield ""
    yield "Elasticity: relative change of the quantity over the relative change of the variable."
    for asked, some in by_quantity(lines).items():
        yield from ("", heading(sweep, asked), "")
        yield from printed(units, TABLE, [_row(line) for line in some])
        if lacking := [line for line in some if line.derivative.reason]:
            yield from ("", *printed(units, REASONS, [_reason(line) for line in lacking]))
    for record, share in gentlest.items():
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
        Column("elasticity", "elasticity", "-", "num", doc="relative derivative"),
        Column("error", "its error\nat most", "-", "short", doc="bound of the error of the elasticity"),
    )
)
REASONS: Final = Sheet(
    columns=(
        Column("variable", doc="PARAM, or the factor on the records"),
        Column("record", doc="record"),
        Column("reason", "no derivative", doc="why there is none"),
    )
)
