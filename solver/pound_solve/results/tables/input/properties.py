"""Table ``properties``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_deck.model import Card
from pound_deck.schema import Field, Kind
from pound_solve.results.columns import DEFAULT, ITEM
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table
from pound_solve.results.words import fields_of, text_of


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each item of each property set; items left out that have no default are not shown."""
    for label, card in run.model.props.items():
        for f in fields_of(card):
            given = f.name in card.spans
            if card[f.name] is None and not given:
                continue
            counts = f.kind in (Kind.REAL, Kind.INT) and f.unit != "-"
            unit = " or ".join(map(run.model.units.text, _dimensions(card, f))) if counts else ""
            yield label, card.spec.name, f.name, text_of(card[f.name]), unit, "" if given else "*"


def _dimensions(card: Card, field: Field) -> tuple[str, ...]:
    """Dimensions that an item can have: a rule's deformation is a rotation where it is for moments."""
    rules = [spec for specs in card.laws.values() for spec in specs if spec.family == "hysteresis"]
    if field.unit != "L" or not any(field in rule.fields for rule in rules):
        return (field.unit,)
    items = [f for f in card.spec.fields if card[f.name] is not None]
    moments = any(f.name in ("MI", "MJ", "MR") for f in items)
    forces = any(f.name in ("FX", "FY") for f in items)
    return ("L", "rad") if moments and forces else ("rad",) if moments else ("L",)


TABLE = Table(
    name="properties",
    title="Property sets",
    place=40,
    stages=(Stage.INPUT,),
    columns=(
        Column("property", doc="property set"),
        Column("kind", doc="kind of element, rule or law that the item belongs to"),
        ITEM,
        Column("value", doc="value in the deck's units"),
        Column("unit", doc="unit of the value"),
        DEFAULT,
    ),
    rows=rows,
    group="property",
)
