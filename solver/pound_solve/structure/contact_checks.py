"""Contacts whose gap no motion closes, or that close as their bodies move apart."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

import numpy as np

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Element, Model
from pound_solve.numerics.graph import components
from pound_solve.structure.buildings import parts
from pound_solve.structure.elements.base import LawSpring
from pound_solve.structure.member_checks import kinds
from pound_solve.structure.structure import Structure
from pound_solve.structure.supports import shaken

SAME: Final = 1e-9  #: share of the distance of nodes that is none
#: gap over the distance of the nodes, which the bodies between them make less than one; coordinates may
#: stay as they are while a gap is varied
WIDEST: Final = 3.0
ALONG: Final = 0.99  #: cosine of the angle between a member and a contact that lies along it


def wide(structure: Structure) -> list[Diagnostic]:
    """Contacts whose gap exceeds the height of the buildings beside it, or by far the distance of its
    nodes: one for each property set.

    What falls may be further from the ground than it is high; no earthquake does that.
    """
    model, out = structure.model, dict[str, Diagnostic]()
    if not shaken(model):
        return []
    height: dict[int | None, float] = {}
    for nodes in parts(model):
        y = [model.nodes[n].y for n in nodes]
        height.update(dict.fromkeys(nodes, max(y) - min(y)))
    for spring in (s for s in structure.laws if s.role.collides):
        e = model.elements[spring.element]
        high, between = max(height[e.i], height.get(e.j, 0.0)), apart(model, spring)
        if spring.gap > high > 0.0:
            found = _beyond(model, e, high)
        elif high and 0.0 < WIDEST * between < spring.gap:
            found = _between(model, e, between)
        else:
            continue
        out.setdefault(e.prop, found)
    return list(out.values())


def _beyond(model: Model, e: Element, high: float) -> Diagnostic:
    card, length = model.props[e.prop], model.units.length
    message = (
        f"GAP is {card['GAP']:g} {length}, more than the {high:g} {length} that the buildings at "
        f"contact {e.name or e.id} are high: it does not close"
    )
    hint = f"GAP is a distance in {length}; leave the contact out if it is not to close"
    return Diagnostic("P351", message, card.place("GAP"), hint, "warning")


def _between(model: Model, e: Element, between: float) -> Diagnostic:
    card, length = model.props[e.prop], model.units.length
    message = (
        f"GAP is {card['GAP']:g} {length}, but the nodes of contact {e.name or e.id} are {between:.3g} "
        f"{length} apart"
    )
    hint = f"GAP is a distance in {length}: correct it, or the coordinates"
    return Diagnostic("P360", message, card.place("GAP"), hint, "warning")


def misplaced(structure: Structure) -> list[Diagnostic]:
    """Contacts between nodes of one floor, or with I and J exchanged."""
    model, out = structure.model, list[Diagnostic]()
    floors = _floors(model)
    for spring in structure.laws:
        e = model.elements[spring.element]
        if spring.role.collides and e.j is not None:
            within = floors[e.i] == floors[e.j] and abs(_way(spring)[0]) > ALONG
            out += [_within(e)] if within else _backwards(model, spring, e)
    return out


def _floors(model: Model) -> dict[int, int]:
    """By node, a number for what lies along x in one piece: members that lie, and nodes slaved along x."""
    number = {n: i for i, n in enumerate(model.nodes)}
    pairs = [(n.id, n.slaved["X"]) for n in model.nodes.values() if "X" in n.slaved]
    for e in (e for members in kinds(model).values() for e in members):
        assert e.j is not None
        i, j = model.nodes[e.i], model.nodes[e.j]
        if abs(i.x - j.x) > ALONG * math.hypot(i.x - j.x, i.y - j.y):
            pairs.append((e.i, e.j))
    joined = components(len(number), groups=[np.array([number[i], number[j]]) for i, j in pairs])
    return dict(zip(number, joined.tolist()))


def _way(spring: LawSpring) -> tuple[float, float]:
    """Direction of a contact, from I towards J."""
    angle = math.radians(spring.facts["angle"])
    return math.cos(angle), math.sin(angle)


def _within(e: Element) -> Diagnostic:
    message = (
        f"contact {e.name or e.id} joins nodes {e.i} and {e.j}, which members or SLAVED hold together: "
        "it does not close"
    )
    hint = "name nodes of two buildings; nodes of two buildings are not slaved to each other"
    return Diagnostic("P358", message, e.span, hint, "warning")


def apart(model: Model, spring: LawSpring) -> float:
    """Distance of the nodes of a contact along it [L]; negative where J is behind I, 0 to a wall."""
    e, (c, s) = model.elements[spring.element], _way(spring)
    i, j = model.nodes[e.i], model.nodes[e.i if e.j is None else e.j]
    found = (j.x - i.x) * c + (j.y - i.y) * s
    return found if abs(found) > SAME * math.hypot(j.x - i.x, j.y - i.y) else 0.0


def _backwards(model: Model, spring: LawSpring, e: Element) -> Iterator[Diagnostic]:
    """A contact that closes as its nodes move apart."""
    if apart(model, spring) < 0.0 <= spring.gap:
        message = (
            f"contact {e.name or e.id} closes as nodes {e.i} and {e.j} move apart: "
            f"ANGLE points from {e.j} to {e.i}"
        )
        hint = "exchange I and J, or leave ANGLE out; leave it so if it is a hook"
        yield Diagnostic("P359", message, e.span, hint, "warning")
