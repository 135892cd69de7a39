"""Checks for material, soil and section properties that are impossible in the deck's units."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Card, Element, Model
from pound_solve.loading.motions.base import METRE
from pound_solve.structure.checks.members import members_by_set
from pound_solve.structure.checks.weights import NEWTON
from pound_solve.structure.structure import Structure

#: least modulus of elasticity of members [Pa]: adobe has 0.2e9, rubber 1e6
MIN_ELASTIC_MODULUS: Final = 1e8
#: weights by volume of concrete and steel, read as N/m: more than any column under 0.6 m^2 weighs
UNIT_WEIGHTS, MAX_COLUMN_AREA = ((22e3, 26e3), (76e3, 79e3)), 0.6
#: of soils: shear modulus [Pa] from peat to rock, weight by volume [N/m^3]; and the largest half width of a
#: footing [m]
SHEAR_MODULI, SOIL_UNIT_WEIGHTS, MAX_HALF_WIDTH = (5e5, 1e11), (8e3, 35e3), 100.0


def impossible_materials(structure: Structure) -> list[Diagnostic]:
    """Report property sets of members and footings with values that no material has."""
    model = structure.model
    newton, metre = NEWTON.get(model.units.force.lower()), METRE.get(model.units.length.lower())
    if not newton or not metre:
        return []
    pascal, by_volume = newton * metre**2, newton * metre**3
    flaws = []
    for label, members in members_by_set(model).items():
        flaws += [
            *_soft(model, model.props[label], pascal),
            *_heavy(model, label, members, newton * metre, metre**2),
        ]
    for card in model.props.values():
        if card.spec.name == "FOUNDATION":
            flaws += _soil(model, card, {"G": pascal, "WGT": by_volume, "B": 1.0 / metre, "L": 1.0 / metre})
    return flaws


def _soft(model: Model, card: Card, pascal: float) -> Iterator[Diagnostic]:
    if card["I"] and card["E"] * pascal < MIN_ELASTIC_MODULUS:
        unit = model.units.text("F/L^2")
        message = (
            f"E of {card.label} is {card['E']:g} {unit}, {card['E'] * pascal / 1e6:.3g} MPa: timber has "
            "10000, concrete 25000"
        )
        hint = f"E is in {unit}: correct it, or UNITS"
        yield Diagnostic("P376", message, card.place("E"), hint, "warning")


def _heavy(
    model: Model, label: str, members: list[Element], by_length: float, face: float
) -> Iterator[Diagnostic]:
    """Yield warnings for columns whose weight per length has the value of the weight per volume of concrete
    or steel.
    """
    card, nodes = model.props[label], model.nodes
    upright = all(nodes[e.i].x == nodes[e.j or e.i].x for e in members)
    weight, area = card["WGT"] * by_length, card["A"] / face
    if upright and area < MAX_COLUMN_AREA and any(low <= weight <= high for low, high in UNIT_WEIGHTS):
        unit = model.units.text("F/L")
        message = (
            f"columns of {label} weigh {card['WGT']:g} {unit}, {card['WGT'] / card['A']:.3g} "
            f"{model.units.text('F/L^3')} of their section"
        )
        hint = "WGT is a weight by length: that of the material times A"
        yield Diagnostic("P376", message, card.place("WGT"), hint, "warning")


def _soil(model: Model, card: Card, factors: dict[str, float]) -> Iterator[Diagnostic]:
    limits = {
        "G": SHEAR_MODULI,
        "WGT": SOIL_UNIT_WEIGHTS,
        "B": (0.0, MAX_HALF_WIDTH),
        "L": (0.0, MAX_HALF_WIDTH),
    }
    usual = {
        "G": "soils have 10 to 1000 MPa",
        "WGT": "soils have 15 to 22 kN/m^3",
        "B": "it is half the length of the footing",
        "L": "it is half the width of the footing",
    }
    for item, (low, high) in limits.items():
        value, unit = card[item], model.units.text(card.spec.field(item).unit)  # type: ignore[union-attr]
        if value and not low <= value * factors[item] <= high:
            message = f"{item} of {card.label} is {value:g} {unit}: {usual[item]}"
            yield Diagnostic("P376", message, card.place(item), f"{item} is in {unit}", "warning")
