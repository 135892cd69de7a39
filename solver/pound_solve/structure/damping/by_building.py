"""Check that cards of DAMPING that name buildings damp every building exactly once."""

from __future__ import annotations

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Card
from pound_solve.structure.buildings import Building, buildings
from pound_solve.structure.structure import Structure


def unevenly_damped_buildings(structure: Structure) -> list[Diagnostic]:
    """Report buildings damped by several cards, one of them by name, and undamped buildings if others are
    damped by name.

    A card for some NODES or PROPS only is expected to combine with others.
    """
    cards, problems = structure.model.damping, _apart(structure)
    named = [c for c in cards if c["BUILDING"]]
    for b in buildings(structure) if named else ():
        whole = [c for c in cards if _of_whole(c, b)]
        if len(whole) > 1 and any(c in named for c in whole):
            first, again = whole[:2]
            message = f"building {b.name!r} has two dampings: this one and that of line {first.span.line}"
            hint = "they add up; leave one out, or give each its BUILDING"
            problems.append(Diagnostic("P339", message, again.span, hint, "warning"))
        if not any(_touches(c, b) for c in cards):
            message = f"building {b.name!r} has no damping"
            hint = f'add a line with BUILDING="{b.name}", or leave BUILDING out for all'
            problems.append(Diagnostic("P339", message, named[0].place("BUILDING"), hint, "warning"))
    return problems


def _apart(structure: Structure) -> list[Diagnostic]:
    """Report cards whose NODES and PROPS have nothing in common, so that K is damped elsewhere than M."""
    model, problems = structure.model, list[Diagnostic]()
    for card in model.damping:
        props, nodes = card.values.get("PROPS"), card.values.get("NODES")
        chosen = [e for e in model.elements.values() if props and e.prop in props]
        if props and chosen and nodes and all({e.i, e.j}.isdisjoint(nodes) for e in chosen):
            message = f"no element of PROPS={','.join(props)} ends at one of these NODES"
            hint = "NODES are those of the building whose members PROPS names"
            problems.append(Diagnostic("P339", message, card.place("NODES"), hint, "warning"))
    return problems


def _touches(card: Card, b: Building) -> bool:
    """Whether a card damps a part of a building."""
    if card["BUILDING"]:
        return bool(card["BUILDING"] == b.name)
    return card["NODES"] is None or bool(set(card["NODES"]) & set(b.nodes))


def _of_whole(card: Card, b: Building) -> bool:
    """Whether a card damps all of a building."""
    part = card.values.get("PROPS") is not None
    part |= card.spec.name == "RAYLEIGH" and card["NODES"] is not None
    return _touches(card, b) and not part
