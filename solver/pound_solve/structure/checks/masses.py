"""Checks for missing masses, and for masses that are fixed within a moving building."""

from __future__ import annotations

from collections import defaultdict

from pound_deck.diagnostics import Diagnostic
from pound_solve.structure.buildings import buildings, parts, stands
from pound_solve.structure.checks.ends import places
from pound_solve.structure.checks.members import is_horizontal, members_by_set
from pound_solve.structure.checks.supports import shaken, some
from pound_solve.structure.structure import Structure


def massless_buildings(structure: Structure) -> list[Diagnostic]:
    """Report structures and buildings without mass if the deck requires modes or the motion under an
    earthquake.

    A part without height, such as a bumper's spring, may be massless.
    """
    model, remedy = structure.model, "give the nodes of its floors WEIGHTS"
    asked = next((c for c in model.analyses if c.spec.name == "MODAL"), None)
    asked = next(iter(shaken(model).values()), asked)
    if asked is None:
        return []
    movable = {*structure.dofs.free, *structure.dofs.moved}
    heavy = {n for (n, d), mass in structure.nodal_mass.items() if mass > 0.0 and (n, d) in movable}
    if not heavy:
        return [Diagnostic("P347", "nothing has mass, so nothing can swing", asked.span, remedy, "warning")]
    names = {n: card.label for card in model.buildings for n in card["NODES"]}
    free = {owner for owner, _ in structure.dofs.free}
    problems = []
    for nodes in parts(model):
        if heavy.isdisjoint(nodes) and not free.isdisjoint(nodes) and stands(model, nodes):
            name = next((names[n] for n in nodes if n in names), "")
            who = repr(name) if name else f"the building of nodes {some(nodes)}"
            message = f"{who} has no mass, so the ground does not shake it"
            problems.append(Diagnostic("P347", message, model.nodes[nodes[0]].span, remedy, "warning"))
    return problems


def massless_roof(structure: Structure) -> list[Diagnostic]:
    """Report buildings whose highest beams end at nodes without mass while others end at masses."""
    model, problems = structure.model, list[Diagnostic]()
    group, at = places(model)
    own_mass = {n for (n, d), mass in structure.nodal_mass.items() if d == 0 and mass > 0.0}
    heavy = {n for m in own_mass for n in group[at[m]]}  # a joint may lie between a beam and its mass
    beams = [e for members in members_by_set(model).values() for e in members if is_horizontal(model, e)]
    for b in buildings(structure) if "X" in shaken(model) else ():
        inside, levels = set(b.nodes), defaultdict[float, set[int]](set)
        for e in beams:
            if e.i in inside and model.nodes[e.i].y > b.base:
                levels[model.nodes[e.i].y].update((e.i, e.j or e.i))
        highest = levels.pop(max(levels)) if levels else set()
        masters = {m for n in highest for m in model.nodes[n].slaved.values()}
        if heavy.isdisjoint(highest | masters) and any(heavy & level for level in levels.values()):
            message = (
                f"the highest beams of {b.name!r} have no mass at their nodes, {some(sorted(highest))}"
            )
            remedy, place = "give the nodes of each floor WEIGHTS", model.nodes[min(highest)].span
            problems.append(Diagnostic("P347", message, place, remedy, "warning"))
    return problems


def immovable_weights(structure: Structure) -> list[Diagnostic]:
    """Report weights above the base of a building at nodes that are fixed along x while others move."""
    model, problems = structure.model, list[Diagnostic]()
    moved = {owner for owner, _ in structure.dofs.moved}
    swings = {n for n, d in structure.dofs.free if d == 0 and structure.nodal_mass.get((n, d))}
    held: dict[int, str] = {}
    for b in buildings(structure) if "X" in shaken(model) else ():
        if not swings.isdisjoint(b.nodes):
            above = (model.nodes[n] for n in b.nodes if n not in moved)
            stuck = (n.id for n in above if "X" in n.fixed and "Y" not in n.fixed and n.y > b.base)
            held.update(dict.fromkeys(stuck, b.name))
    for card in model.weights:
        fixed = [n for n in dict.fromkeys(card["NODES"]) if n in held]
        if fixed and card["WX"]:
            who = (
                f"nodes {some(fixed)} are"
                if len(fixed) > 1
                else f"node {fixed[0]} of {held[fixed[0]]!r} is"
            )
            message = (
                f"{who} fixed along X above the base: the weight does not swing, and the floor is held"
            )
            place, hint = card.place("NODES"), "take X out of FIX under NODES"
            problems.append(Diagnostic("P343", message, place, hint, "warning"))
    return problems
