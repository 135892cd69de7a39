"""Damping in proportion to masses and initial stiffnesses, and modal damping of all modes.

The factors are those of the deck's cards; OpenSees computes the modes of modal damping itself.
"""

from __future__ import annotations

from pound_deck.model import Card
from pound_solve.opensees.script import Script
from pound_solve.structure.damping import modal, rayleigh
from pound_solve.structure.damping.assembly import DampingSources
from pound_solve.structure.proportional import Chosen

STIFF = ("FRAME", "SPRING")  #: elements that have a stiffness to be damped


def damping(script: Script) -> None:
    """Write the damping of all cards."""
    sources = DampingSources(script.structure, script.structure)
    alphas: dict[int, float] = {}
    betas: dict[int, float] = {}
    modal_cards = [card for card in script.model.damping if card.spec.name == "MODAL"]
    for card in script.model.damping:
        if card.values.get("AFTER") == "STATIC":
            script.refuse("damping by modes of the loaded structure", card.place("AFTER"))
        elif card.spec.name == "RAYLEIGH":
            _rayleigh(script, card, sources, alphas, betas)
        elif card.spec.name == "MODAL":
            _modal(script, card, first=card is modal_cards[0])
        else:
            script.refuse(f"damping by {card.spec.name}", card.span)
    _regions(script, alphas, betas)


def _rayleigh(
    script: Script, card: Card, sources: DampingSources, alphas: dict[int, float], betas: dict[int, float]
) -> None:
    """Add the factors of a card to those of nodes and elements."""
    context = sources.context(lambda message, item: None)
    alpha, beta, _ = rayleigh.factors(card, context)
    nodes = context.nodes(card)
    structure = script.structure
    massive = {node for block in structure.mass_blocks if block.matrix.any() for node in block.nodes}
    for node in massive if nodes is None else massive & set(nodes):
        alphas[node] = alphas.get(node, 0.0) + alpha
    chosen = Chosen(card["PROPS"], nodes if card["BUILDING"] else None)
    for element in script.model.elements.values():
        if script.model.props[element.prop].spec.name not in STIFF or not chosen.has(element):
            continue
        if beta and card["STIFFNESS"] != "INITIAL" and structure.parts[element.id].laws:
            what = f"damping by the {card['STIFFNESS'].lower()} stiffness of elements that yield"
            script.refuse(what, card.place("STIFFNESS"))
            return
        betas[element.id] = betas.get(element.id, 0.0) + beta


def _modal(script: Script, card: Card, first: bool) -> None:
    """Write modal damping by a list of ratios."""
    for item in ("OMEGA", "MODES", "NODES", "BUILDING"):
        if card[item]:
            script.refuse(f"modal damping with {item}", card.place(item), "give XI alone: a list by mode")
            return
    if not first or script.model.geometry != "SMALL":
        what = "a second MODAL" if not first else f"modal damping with GEOMETRY {script.model.geometry}"
        script.refuse(what, card.span)
        return
    omega = script.structure.free_vibration.omega
    xi, _ = modal.listed(card, omega)
    script.call("damping", "eigen", "-fullGenLapack", len(omega))
    script.call("damping", "modalDamping", *xi.tolist())


def _regions(script: Script, alphas: dict[int, float], betas: dict[int, float]) -> None:
    """Write one region for each factor: a region takes nodes or elements, not both."""
    for option, factors, at in (("-node", alphas, 0), ("-eleOnly", betas, 2)):
        for factor in sorted({x for x in factors.values() if x}):
            members = [tag for tag, x in factors.items() if x == factor]
            row = [0.0] * 4
            row[at] = factor
            script.call("damping", "region", script.tag(), option, *members, "-rayleigh", *row)
