"""Masses that are missing, and masses that cannot move though the building around them does."""

from __future__ import annotations

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Card, Model
from pound_solve.structure.buildings import Building, buildings, parts, stands
from pound_solve.structure.structure import Structure
from pound_solve.structure.supports import shaken, some


def massless(structure: Structure) -> list[Diagnostic]:
    """Structures and buildings without mass, though modes or the motion under an earthquake are asked for.

    A part without height, such as the spring of a bumper, may have none.
    """
    model, cure = structure.model, "give the nodes of its floors WEIGHTS"
    asked = next((c for c in model.analyses if c.spec.name == "MODAL"), None)
    asked = next(iter(shaken(model).values()), asked)
    if asked is None:
        return []
    heavy = {n for (n, _), mass in structure.nodal_mass.items() if mass > 0.0}
    if not heavy:
        return [Diagnostic("P347", "nothing has mass, so that nothing swings", asked.span, cure, "warning")]
    names = {n: card.label for card in model.buildings for n in card["NODES"]}
    free = {owner for owner, _ in structure.dofs.free}
    out = []
    for nodes in parts(model):
        if heavy.isdisjoint(nodes) and not free.isdisjoint(nodes) and stands(model, nodes):
            name = next((names[n] for n in nodes if n in names), "")
            who = repr(name) if name else f"the building of nodes {some(nodes)}"
            message = f"{who} has no mass, so that the ground does not shake it"
            out.append(Diagnostic("P347", message, model.nodes[nodes[0]].span, cure, "warning"))
    return out


def immovable(structure: Structure) -> list[Diagnostic]:
    """Weights above the base of a building at nodes that are fixed along x alone, where others move."""
    model, out = structure.model, list[Diagnostic]()
    moved = {owner for owner, _ in structure.dofs.moved}
    swings = {n for n, d in structure.dofs.free if d == 0 and structure.nodal_mass.get((n, d))}
    for b in buildings(structure) if "X" in shaken(model) else ():
        if swings.isdisjoint(b.nodes):
            continue
        above = {n for n in b.nodes if n not in moved and _fixed_along_x(model, b, n)}
        for card in model.weights:
            held = [n for n in dict.fromkeys(card["NODES"]) if n in above]
            if held and card["WX"]:
                out.append(_held(b, card, held))
    return out


def _fixed_along_x(model: Model, b: Building, n: int) -> bool:
    node = model.nodes[n]
    return "X" in node.fixed and "Y" not in node.fixed and node.y > b.base


def _held(b: Building, card: Card, held: list[int]) -> Diagnostic:
    who = f"nodes {some(held)} of {b.name!r} are" if len(held) > 1 else f"node {held[0]} of {b.name!r} is"
    message = f"{who} fixed along X above the base: the weight there does not swing, and the floor is held"
    return Diagnostic("P343", message, card.place("NODES"), "take X out of FIX under NODES", "warning")
