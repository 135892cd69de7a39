"""Table ``options``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Final

from pound_solve.results.columns import DEFAULT, ITEM
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table
from pound_solve.results.words import fields_of, text_of

#: what each GEOMETRY means
GEOMETRY: Final[Mapping[str, str]] = MappingProxyType(
    {
        "SMALL": "small displacements",
        "PDELTA": "axial forces of the static state act along the line between the nodes",
        "PDELTA_MEMBER": "axial forces of the static state act along the bent member",
        "PDELTA_VARYING": "the present axial forces act along the line between the nodes",
        "LARGE": "members turn and lengthen as their nodes move",
    }
)


def rows(run: RunRecord) -> Iterator[Row]:
    """Rows on units, mass, geometry, suppressed warnings, PARAMs, analyses with items, and OUTPUT."""
    model, units = run.model, run.model.units

    def default(key: str) -> str:
        return "*" if key in model.defaults else ""

    named = f"{units.force} {units.length} {units.time}"
    yield "units", named, default("units"), "names only: nothing is converted"
    yield "gravity", f"{model.gravity:.10g}", default("gravity"), "mass = weight / gravity"
    yield "mass of members", model.mass, default("mass"), ""
    yield "geometry", model.geometry, default("geometry"), GEOMETRY[model.geometry]
    if model.meant:
        yield "MEANT", ", ".join(sorted(model.meant)), "", "codes of warnings that are not reported"
    for name, value in model.params.items():
        remark = "set on the command line" if name.lower() in run.overridden else ""
        yield f"PARAM {name}", text_of(value), "", remark
    for card in model.analyses:
        yield card.spec.name, "", "", card.spec.title
        for f in fields_of(card):
            yield f"  {f.name}", text_of(card[f.name]), "" if f.name in card.spans else "*", f.doc
    output = model.output
    for f in fields_of(output):
        yield f"OUTPUT {f.name}", text_of(output[f.name]), "" if f.name in output.spans else "*", f.doc


TABLE = Table(
    name="options",
    title="Analysis options and parameters",
    place=10,
    stages=(Stage.INPUT,),
    columns=(
        ITEM,
        Column("value", doc="value in the deck's words and units"),
        DEFAULT,
        Column("meaning", doc="meaning of the option"),
    ),
    rows=rows,
)
