"""Checks of static loads against the weights of the buildings that bear them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from typing import Final, NamedTuple

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Card, Model
from pound_solve.structure.buildings import SAME_LEVEL, Building, buildings, stands
from pound_solve.structure.checks.members import length, members_by_set
from pound_solve.structure.checks.supports import shaken, some
from pound_solve.structure.structure import Structure

#: ratio of loads along x to the weight; a pushover load left in the deck may exceed it
MAX_PUSH_RATIO: Final = 0.5
#: ratio of downward loads to the weight, outside of which they have other units; columns that lean on the
#: building may bear several times its loads
MIN_LOAD_RATIO, MAX_LOAD_RATIO = 0.01, 8.0
MAX_UPLIFT_RATIO: Final = 0.3  #: ratio of upward loads to downward loads
#: ratio of loads to the weight below which P-Delta covers only part of the weight
MIN_PDELTA_LOAD_RATIO: Final = 0.3
#: range of this ratio in which the loads repeat a weight that acts already
REPEATED_WEIGHT_RATIOS: Final = (0.7, 1.4)
MIN_FLOORS: Final = 3  #: least number of floors of a building in which one without load is reported
MIN_FLOOR_LOAD_RATIO: Final = 0.1  #: least ratio of loads to the weight of the other floors


class Load(NamedTuple):
    """A force on a node [F], with the card that gives it and the item of its component along y."""

    node: int
    x: float
    y: float
    card: Card
    item: str


def loads_on_nodes(model: Model) -> Iterator[Load]:
    """Yield loads on nodes: those of LOADS that stay, and half of each of MEMBER_LOADS at either end."""
    for c in model.loads:
        if c.spec.name == "LOADS" and c["HELD"] == "YES":  # excludes the loads made from weights
            yield from (Load(n, c["FX"], c["FY"], c, "FY") for n in c["NODES"])
    for c in model.member_loads:
        item = "WY" if c["WY"] else "PY"
        for e in (model.elements[k] for k in c["ELEMENTS"]):
            long = length(model, e)
            x, y = c["PX"] + c["WX"] * long, c["PY"] + c["WY"] * long
            yield from (Load(n, x / 2.0, y / 2.0, c, item) for n in (e.i, e.j) if n is not None)


def gravity_acts(model: Model) -> bool:
    """Whether STATIC applies the weights as loads."""
    return any(c.values.get("GRAVITY") == "YES" for c in model.analyses)


def unloaded_buildings(structure: Structure) -> list[Diagnostic]:
    """Report buildings whose members take P-Delta into account but bear no load."""
    model, problems = structure.model, list[Diagnostic]()
    if not model.geometry.startswith("PDELTA") or not model.analyses or gravity_acts(model):
        return problems
    bent = {model.elements[g.element].i for g in structure.geometric}
    loaded = {n for c in (*model.loads, *model.forces) for n in c["NODES"]}
    loaded |= {load.node for load in loads_on_nodes(model)}
    for e in model.elements.values():
        card = model.props[e.prop]
        if card.values.get("N0") or (structure.self_weight and card.values.get("WGT")):
            loaded.add(e.i)
    affected = [b for b in buildings(structure) if bent & set(b.nodes)]
    idle = [b for b in affected if loaded.isdisjoint(b.nodes)]
    place = next((c for c in model.analyses if c.spec.name == "STATIC"), model.analyses[0]).span
    for b in idle:
        who = "the columns" if len(idle) == len(affected) else f"the columns of {b.name!r}"
        message = f"GEOMETRY {model.geometry}, but nothing loads {who}: their axial forces are zero"
        hint = "add STATIC GRAVITY=YES, which lets the WEIGHTS press, or LOADS"
        problems.append(Diagnostic("P340", message, place, hint, "warning"))
        if len(idle) == len(affected):
            break
    return problems + [d for b in affected if b not in idle for d in _lightly_loaded(structure, b)]


def _lightly_loaded(structure: Structure, b: Building) -> list[Diagnostic]:
    """Report loads that are so small a part of the weight that P-Delta has hardly any effect."""
    model = structure.model
    inside, weight = set(b.nodes), b.mass * model.gravity
    loads = [load for load in loads_on_nodes(model) if load.node in inside]
    press = -sum(load.y for load in loads)
    for e in (e for members in members_by_set(model).values() for e in members if e.i in inside):
        press += structure.self_weight * model.props[e.prop]["WGT"] * length(model, e)
    if (
        not 0.0 <= press < MIN_PDELTA_LOAD_RATIO * weight
        or not shaken(model)
        or any(load.y > 0.0 for load in loads)
    ):
        return []
    unit, kind = model.units.force, model.geometry
    finding = f"loads press {b.name!r}, which weighs {weight:.4g} {unit}, by {press:.4g} {unit}"
    message = f"GEOMETRY {kind}, but {finding}"
    hint = "add STATIC GRAVITY=YES, which lets the WEIGHTS press, or LOADS of their size"
    place = model.analyses[0].span
    return [Diagnostic("P340", message, place, hint, "warning")]


def misloaded_buildings(structure: Structure) -> list[Diagnostic]:
    """Report buildings whose loads contradict their weight, with the first contradiction of each."""
    model, problems = structure.model, list[Diagnostic]()
    if not shaken(model):
        return problems
    loads = defaultdict[int, list[Load]](list)
    for load in loads_on_nodes(model):
        loads[load.node].append(load)
    for b in buildings(structure):
        acting = [load for n in b.nodes for load in loads[n]]
        if acting and b.mass and stands(model, b.nodes):
            problems += next(filter(None, (look(structure, b, acting) for look in LOOKS)), [])
    return problems


def _lifted(structure: Structure, b: Building, loads: list[Load]) -> list[Diagnostic]:
    """Report upward loads that exceed a fraction of the downward ones."""
    unit = structure.model.units.force
    up = sum(load.y for load in loads if load.y > 0.0)
    press = -sum(load.y for load in loads if load.y < 0.0)
    press += b.mass * structure.model.gravity if gravity_acts(structure.model) else 0.0
    if up <= MAX_UPLIFT_RATIO * press:
        return []
    load = max(loads, key=lambda load: load.y)
    message = f"loads pull {b.name!r} upwards by {up:.4g} {unit}, others press by {press:.4g} {unit}"
    hint = f"loads that press are negative: Y and {load.item} point upwards"
    return [Diagnostic("P364", message, load.card.place(load.item), hint, "warning")]


def _sideways(structure: Structure, b: Building, loads: list[Load]) -> list[Diagnostic]:
    """Report loads along x of the size of the weight."""
    model, push = structure.model, sum(load.x for load in loads)
    weight, unit = b.mass * model.gravity, model.units.force
    if abs(push) < MAX_PUSH_RATIO * weight:
        return []
    card = max(loads, key=lambda load: abs(load.x)).card
    message = f"loads push {b.name!r} sideways by {push:.4g} {unit}; it weighs {weight:.4g} {unit}"
    hint = f"loads that press act along Y: {'FY' if card.spec.name == 'LOADS' else 'WY or PY'} below zero"
    return [Diagnostic("P370", message, card.span, hint, "warning")]


def _again(structure: Structure, b: Building, loads: list[Load]) -> list[Diagnostic]:
    """Report loads that repeat the weight, or seem to be in other units."""
    model, press = structure.model, -sum(load.y for load in loads)
    weight, unit = b.mass * model.gravity, model.units.force
    if not press or not weight:
        return []
    load = min(loads, key=lambda load: load.y)
    finding = f"loads press {b.name!r} by {press:.4g} {unit}"
    if gravity_acts(model) and REPEATED_WEIGHT_RATIOS[0] <= press / weight <= REPEATED_WEIGHT_RATIOS[1]:
        message = f"{finding}, and STATIC GRAVITY=YES by its weight, {weight:.4g} {unit}, once more"
        hint = "leave one of them out: GRAVITY=YES turns WEIGHTS into loads"
    elif not MIN_LOAD_RATIO <= press / weight <= MAX_LOAD_RATIO and not gravity_acts(model):
        message = f"{finding}, {press / weight:.2g} of its weight, {weight:.4g} {unit}"
        hint = f"loads are in {model.units.text('F')}, loads by length in {model.units.text('F/L')}"
    else:
        return []
    return [Diagnostic("P370", message, load.card.place(load.item), hint, "warning")]


def _forgotten(structure: Structure, b: Building, loads: list[Load]) -> list[Diagnostic]:
    """Report a floor without load if the other floors bear loads of the size of their weights."""
    model = structure.model
    if gravity_acts(model) or len(b.floors) < MIN_FLOORS:
        return []
    close = SAME_LEVEL * (b.levels[-1] - b.base)
    at = [[load for load in loads if abs(model.nodes[load.node].y - f.level) <= close] for f in b.floors]
    press = [-sum(load.y for load in a) / (f.mass * model.gravity) for a, f in zip(at, b.floors)]
    bare = [f for f, p in zip(b.floors, press) if not p]
    if len(bare) != 1 or any(0.0 < p < MIN_FLOOR_LOAD_RATIO for p in press):
        return []
    message = f"no load presses nodes {some(bare[0].nodes)} of {b.name!r}, as loads press its other floors"
    hint = "load them, too, or their beams"
    return [Diagnostic("P370", message, loads[0].card.span, hint, "warning")]


LOOKS: Final = (_lifted, _sideways, _again, _forgotten)
