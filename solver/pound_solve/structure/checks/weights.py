"""Checks for weights and strengths that do not fit the structure."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Final

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Element, Model
from pound_solve.loading.motions.base import METRE
from pound_solve.structure.buildings import SAME_LEVEL, Building, buildings, stands
from pound_solve.structure.checks.members import (
    MEMBERS,
    USUAL_DEPTHS,
    depth,
    is_horizontal,
    length,
    members_by_set,
)
from pound_solve.structure.checks.supports import shaken
from pound_solve.structure.structure import Structure

NEWTON: Final[Mapping[str, float]] = MappingProxyType(
    {"n": 1.0, "kn": 1e3, "mn": 1e6, "lb": 4.448, "lbf": 4.448, "kip": 4448.0, "kips": 4448.0}
)
#: modulus of elasticity from and to [Pa], and weight by volume [N/m^3], of concrete and of steel
MATERIALS: Final = ((15e9, 60e9, 24e3), (180e9, 220e9, 77e3))
EARTH_GRAVITY: Final = 9.81  #: [m/s^2]
#: fraction of gravity by which that of a model in a centrifuge differs at least
MIN_GRAVITY_DIFFERENCE: Final = 0.1
#: fraction of beams and columns in the whole weight: 0.1 to 0.45 with slabs and walls, ten times that where
#: masses are written in place of weights
MAX_FRAME_WEIGHT_RATIO: Final = 0.6
#: strain of columns under the whole weight: 0.0003 to 0.0008 at design stresses of concrete, steel, timber
MAX_COLUMN_STRAIN: Final = 1e-3
#: strength of the lowest storey over the weight; sliding bearings have 0.02, walls of one storey 3
MIN_STRENGTH_RATIO, MAX_STRENGTH_RATIO = 0.002, 20.0
MIN_HEIGHT, MAX_HEIGHT = 0.1, 1000.0  #: height of a building or a model of one [m]


def outsized_buildings(structure: Structure) -> Iterator[tuple[str, Diagnostic]]:
    """Yield the names of buildings lower than any shaking-table model or higher than any building, each
    with a warning; centrifuge models, recognised by their gravity, are skipped.
    """
    model = structure.model
    metre = METRE.get(model.units.length.lower())
    spun = metre and not math.isclose(model.gravity, EARTH_GRAVITY * metre, rel_tol=MIN_GRAVITY_DIFFERENCE)
    for b in _standing(structure) if metre and not spun else ():
        high = (max(model.nodes[n].y for n in b.nodes) - b.base) / (metre or 1.0)
        if high > 0.0 and not MIN_HEIGHT <= high <= MAX_HEIGHT:
            message = f"{b.name!r} is {high:.3g} m high"
            hint = f"coordinates under NODES are in {model.units.length}: correct them, or UNITS"
            yield b.name, Diagnostic("P362", message, model.nodes[b.nodes[0]].span, hint, "warning")


def misweighed_buildings(structure: Structure) -> Iterator[tuple[str, Diagnostic]]:
    """Yield the names of buildings that weigh hardly more than their frame or more than their columns can
    carry, each with a warning.
    """
    model = structure.model
    force, metre = NEWTON.get(model.units.force.lower()), METRE.get(model.units.length.lower())
    beams = {e.i for members in members_by_set(model).values() for e in members if is_horizontal(model, e)}
    for b in _standing(structure) if force and metre else ():
        assert force and metre
        weight = b.mass * force * metre * EARTH_GRAVITY
        bare = _bare_weight(model, b, force * metre**2, metre)
        strain = _strain(model, b, weight / force)
        if bare > MAX_FRAME_WEIGHT_RATIO * weight and beams & set(b.nodes):
            finding = (
                f"weighs {weight / force:.3g} {model.units.force}, but its beams and columns alone weigh "
                f"{bare / force:.3g} {model.units.force} by A and E"
            )
            yield b.name, _weights(model, b, finding, "; keep it if the frame bears no slab")
        elif strain > MAX_COLUMN_STRAIN:
            finding = (
                f"weighs {weight / force:.3g} {model.units.force}, which shortens its columns by "
                f"{1e3 * strain:.2g} per mille: columns bear less than one"
            )
            yield b.name, _weights(model, b, finding)


def _weights(model: Model, b: Building, finding: str, unless: str = "") -> Diagnostic:
    heavy = {n for f in b.floors for n in f.nodes}
    card = next((c for c in model.weights if heavy & set(c["NODES"])), None)
    place = card.place("WX") if card else model.nodes[b.nodes[0]].span
    hint = (
        f"WEIGHTS are forces in {model.units.force}, mass times gravity; "
        f"gravity is {model.gravity:g} here, A is in {model.units.text('L^2')}{unless}"
    )
    return Diagnostic("P361", f"{b.name!r} {finding}", place, hint, "warning")


def _bare_weight(model: Model, b: Building, pascal: float, metre: float) -> float:
    """Weight of the members whose E is that of concrete or steel and whose section is usual [N]; 0 if the
    deck gives weights of members.
    """
    inside, total = frozenset(b.nodes), 0.0
    for e in model.elements.values():
        card = model.props[e.prop]
        if e.i not in inside or e.j not in inside or card.spec.name not in MEMBERS:
            continue
        if card["WGT"]:
            return 0.0
        long = length(model, e)
        if long and USUAL_DEPTHS[0] <= depth(card) / long <= 1.0:
            kind = (w for low, high, w in MATERIALS if low <= card["E"] * pascal <= high)
            total += card["A"] * long / metre**3 * next(kind, 0.0)
    return total


def _strain(model: Model, b: Building, weight: float) -> float:
    """Axial strain of the members on the base under the weight; 0 if other elements stand there too."""
    stiffness = 0.0
    for e in _lowest(model, b):
        card = model.props[e.prop]
        if card.spec.name not in MEMBERS or e.j is None:
            return 0.0
        stiffness += card["E"] * card["A"] * abs(model.nodes[e.i].y - model.nodes[e.j].y) / length(model, e)
    return weight / stiffness if stiffness else 0.0


def _lowest(model: Model, b: Building) -> list[Element]:
    """Elements that connect a building to its base or to the ground."""
    inside = frozenset(b.nodes)
    top = b.base + SAME_LEVEL * (max(model.nodes[n].y for n in b.nodes) - b.base)
    lowest = []
    for e in model.elements.values():
        if e.i not in inside or model.props[e.prop].spec.name == "CONTACT":
            continue
        low = e.j is None or model.nodes[e.j].y <= top
        if low != (model.nodes[e.i].y <= top):
            lowest.append(e)
    return lowest


def implausible_base_strengths(structure: Structure) -> list[Diagnostic]:
    """Report buildings on springs whose total strength is implausible for the weight that they carry."""
    model, problems = structure.model, list[Diagnostic]()
    along = {s.element: s for s in structure.laws if s.component == "X" and s.strengths is not None}
    for b in _standing(structure):
        lowest = _lowest(model, b)
        if not lowest or any(e.id not in along for e in lowest):
            continue
        pairs = [along[e.id].strengths or (math.inf, -math.inf) for e in lowest]
        strength, weight = sum(max(plus, -minus) for plus, minus in pairs), b.mass * model.gravity
        if (
            math.isfinite(strength)
            and not MIN_STRENGTH_RATIO * weight <= strength <= MAX_STRENGTH_RATIO * weight
        ):
            unit, card = model.units.force, model.props[lowest[0].prop]
            few = strength < MIN_STRENGTH_RATIO * weight
            message = (
                f"the springs below {b.name!r} yield at {strength:.4g} {unit} together, "
                f"{strength / weight:.2g} of its weight: {'0.02 is little' if few else '1 is much'}"
            )
            hint = f"FX and WEIGHTS are in {unit}; without FX and RULE a spring does not yield"
            problems.append(Diagnostic("P363", message, card.place("FX"), hint, "warning"))
    return problems


def far_yielding_springs(structure: Structure) -> list[Diagnostic]:
    """Report springs weaker than the weight that yield at a deformation beyond the height of their
    building.
    """
    model, problems = structure.model, dict[str, Diagnostic]()
    high = {n: b for b in _standing(structure) for n in b.nodes}
    for s in structure.laws:
        e = model.elements[s.element]
        b, card = high.get(e.i), model.props[e.prop]
        if (
            b is None
            or card.spec.name != "SPRING"
            or s.unit != "F"
            or s.yields is None
            or s.strengths is None
        ):
            continue
        at, strength = (max(map(abs, pair)) for pair in (s.yields, s.strengths))
        tall = max(model.nodes[n].y for n in b.nodes) - b.base
        if tall < at < math.inf and strength < b.mass * model.gravity:
            unit = model.units.length
            message = (
                f"springs of {card.label} yield at {at:.3g} {unit}; {b.name!r} is {tall:.3g} {unit} high"
            )
            item = f"F{s.component}" if card.values.get(f"F{s.component}") is not None else "RULE"
            hint = f"stiffnesses are in {model.units.text('F/L')}, strengths in {model.units.force}"
            problems.setdefault(e.prop, Diagnostic("P363", message, card.place(item), hint, "warning"))
    return list(problems.values())


def _standing(structure: Structure) -> Iterator[Building]:
    """Yield the buildings with height that the ground shakes along x."""
    if "X" in shaken(structure.model):
        yield from (b for b in buildings(structure) if stands(structure.model, b.nodes))
