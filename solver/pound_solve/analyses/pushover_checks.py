"""Checks of PUSHOVER cards before the run."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Final

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Card
from pound_solve.analyses.load_pattern import LoadPattern
from pound_solve.analyses.pushover import control_row, of_one_building, pushed_nodes, targets
from pound_solve.structure.buildings import building, buildings
from pound_solve.structure.structure import Structure

FURTHEST: Final = 0.2  #: largest target as a fraction of the height of the control node above its base


def mistaken_cards(structure: Structure) -> list[Diagnostic]:
    """Return the errors in the PUSHOVER cards of a deck: at most one for each."""
    errors = list[Diagnostic]()
    for card in _cards(structure):
        if wrong := _wrong(structure, card):
            message, item, hint = wrong
            errors.append(Diagnostic("P335", message, card.place(item), hint))
    return errors


def distant_targets(structure: Structure) -> list[Diagnostic]:
    """Return a message if the target of a PUSHOVER exceeds what the height of its control node allows."""
    model, warnings = structure.model, list[Diagnostic]()
    for card in _cards(structure):
        if card["TARGET"] is None or card["DIRECTION"] != "X":
            continue
        b = next((b for b in buildings(structure) if card["NODE"] in b.nodes), None)
        high = model.nodes[card["NODE"]].y - b.base if b else 0.0
        target = max(card["TARGET"], key=abs)
        if abs(target) > FURTHEST * high > 0.0:
            unit = model.units.length
            message = f"TARGET is {target:g} {unit}, node {card['NODE']} {high:.4g} {unit} above its base"
            hint = f"TARGET is a displacement in {unit}: buildings fall at a tenth of their height"
            warnings.append(Diagnostic("P377", message, card.place("TARGET"), hint, "warning"))
    return warnings


def _cards(structure: Structure) -> Iterator[Card]:
    """Yield the PUSHOVER cards of a deck."""
    return (card for card in structure.model.analyses if card.spec.name == "PUSHOVER")


def _wrong(structure: Structure, card: Card) -> tuple[str, str, str] | None:
    """Return the message, the invalid item of the card, and a hint, or None."""
    if wrong := _wrong_building(structure, card) or _wrong_control(structure, card) or _wrong_items(card):
        return wrong
    if wrong := _wrong_performance(structure, card):
        return wrong
    pattern = LoadPattern(structure, card, pushed_nodes(structure, card))
    if not (pattern.mass if pattern.by_mode else pattern.forces.any()):
        hint = "the nodes that are pushed need forces, loads or WEIGHTS, and must be able to move so"
        return f"PATTERN={card['PATTERN']} has no force along {card['DIRECTION']}", "PATTERN", hint
    return None


def _wrong_building(structure: Structure, card: Card) -> tuple[str, str, str] | None:
    """Return the error in the pushed building, or in the nodes that must belong to it."""
    name = card["BUILDING"]
    if not name and card["NEIGHBOURS"] == "YES":
        return None
    if not name:
        return "NEIGHBOURS=NO needs a building", "NEIGHBOURS", 'add BUILDING="name" of the one that is left'
    try:
        nodes = building(structure, name).nodes
    except KeyError as err:
        return str(err.args[0]), "BUILDING", "buildings have the names of the section BUILDINGS"
    for item, numbers in (("NODE", (card["NODE"],)), ("NODES", card["NODES"]), ("BASE", card["BASE"])):
        for node in numbers or ():
            if node not in nodes:
                return f"node {node} is not of building {name!r}", item, "name nodes of this building"
    return None


def _wrong_control(structure: Structure, card: Card) -> tuple[str, str, str] | None:
    """Return the error in the end of the pushover or in its control node."""
    by_displacement = card["CONTROL"] == "DISPLACEMENT"
    if card["TARGET"] is None and (card["FACTOR"] is None or by_displacement):
        needs = "TARGET" if by_displacement else "TARGET or FACTOR"
        return f"PUSHOVER has no end: it needs {needs}", "CONTROL", "add TARGET=displacement"
    if wrong := _wrong_turn(card):
        return wrong
    if card["FACTOR"] == 0.0:
        return "FACTOR is zero", "FACTOR", "give the load factor to go to, with its sign"
    if not control_row(structure, card).any():
        message = f"the control node {card['NODE']} cannot move along {card['DIRECTION']}"
        return message, "NODE", "name a node that is not fixed so"
    return None


def _wrong_turn(card: Card) -> tuple[str, str, str] | None:
    """Return the error in the targets between which the control displacement turns."""
    if card["CYCLES"] and card["TARGET"] is None:
        return "CYCLES needs TARGET", "CYCLES", "give the amplitudes of the cycles: TARGET=0.02,0.04"
    path = targets(card)
    if len(path) == 1:
        return None
    if card["CONTROL"] == "FORCE":
        hint = "leave out CONTROL=FORCE, or give one TARGET"
        return "only a displacement can turn at several targets", "CONTROL", hint
    if card["FACTOR"] is not None:
        return "FACTOR does not go with several targets", "FACTOR", "leave it out"
    if card["TC"] is not None:
        hint = "leave TC out, and write a second PUSHOVER to one TARGET"
        return "the performance point belongs to one TARGET", "TC", hint
    for one, other in pairwise(path):
        if one == other:
            hint = "CYCLES goes to the opposite of each TARGET too: give amplitudes of one sign, above zero"
            hint = hint if card["CYCLES"] else "give targets that differ"
            return f"TARGET {one:g} follows itself", "TARGET", hint
    return None


def _wrong_performance(structure: Structure, card: Card) -> tuple[str, str, str] | None:
    """Return the error in TC, which takes one building, its whole base shear, and a ground motion."""
    if card["TC"] is None:
        return None
    if all(m["DIRECTION"] != card["DIRECTION"] for m in structure.model.equake):
        message = f"TC gives the performance point under a ground motion along {card['DIRECTION']}"
        return message, "TC", "add the motion under EQUAKE, or leave TC out"
    if card["BASE"] is not None:
        return "TC takes the whole base shear", "BASE", "leave out BASE, or TC"
    if not of_one_building(structure, card):
        named = ", ".join(f'"{b.name}"' for b in buildings(structure))
        hint = f"add BUILDING, one of {named}" if named else "give the nodes WEIGHTS"
        return "the performance point is that of one building with mass", "TC", hint
    return None


def _wrong_items(card: Card) -> tuple[str, str, str] | None:
    """Return the error in the items that belong to one pattern only."""
    pattern, nodes, forces = card["PATTERN"], card["NODES"], card["FORCES"] or ()
    if pattern == "FORCES" and (not forces or len(nodes or ()) != len(forces)):
        hint = "PATTERN=FORCES takes one force for each node: NODES=3,5 FORCES=10,20"
        return f"{len(nodes or ())} NODES, but {len(forces)} FORCES", "FORCES", hint
    if pattern != "FORCES" and forces:
        hint = "write PATTERN=FORCES, or leave them out"
        return f"FORCES do not go with PATTERN={pattern}", "FORCES", hint
    if pattern == "LOADS" and nodes is not None:
        hint = "the loads stand where they are: leave NODES out"
        return "NODES do not go with PATTERN=LOADS", "NODES", hint
    if card["ADAPTIVE"] == "YES" and pattern != "MODE":
        return f"PATTERN={pattern} cannot adapt", "ADAPTIVE", "ADAPTIVE=YES goes with PATTERN=MODE"
    return None
