"""Checks of contacts: those that cannot close, miss the other body, or close as the bodies move apart."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

import numpy as np

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Element, Model, Node
from pound_solve.numerics.graph import components
from pound_solve.structure.buildings import parts, stands
from pound_solve.structure.checks.members import members_by_set
from pound_solve.structure.checks.supports import shaken
from pound_solve.structure.elements.base import LawSpring
from pound_solve.structure.structure import Structure

SAME_DISTANCE: Final = 1e-9  #: distance that counts as zero, as a fraction of that of the nodes
#: largest gap over the distance of the nodes.  The bodies lie between the nodes, so this ratio is below
#: one, but a parameter study may vary the gap and keep the coordinates
MAX_GAP_RATIO: Final = 3.0
ANGLE_TOLERANCE: Final = 1e-6  #: tolerance of the slope of a contact [degrees]
LEVEL_RATIO: Final = 0.1  #: fraction of a difference in height that counts as none
ALONG_COSINE: Final = 0.99  #: cosine of the angle between a member and a contact that lies along it


def wide_gaps(structure: Structure) -> list[Diagnostic]:
    """Report contacts whose gap exceeds the height of the adjacent buildings, or far exceeds the distance
    of the nodes, once per property set.

    A falling body may start above the ground by more than its height, so only shaken structures are
    checked.
    """
    model, problems = structure.model, dict[str, Diagnostic]()
    if not shaken(model):
        return []
    height: dict[int | None, float] = {}
    for nodes in parts(model):
        y = [model.nodes[n].y for n in nodes]
        height.update(dict.fromkeys(nodes, max(y) - min(y)))
    for spring in (s for s in structure.laws if s.role.collides):
        e = model.elements[spring.element]
        high, between = max(height[e.i], height.get(e.j, 0.0)), node_distance(model, spring)
        if spring.gap > high > 0.0:
            problem = _beyond(model, e, high)
        elif high and 0.0 < MAX_GAP_RATIO * between < spring.gap:
            problem = _between(model, e, between)
        else:
            continue
        problems.setdefault(e.prop, problem)
    return list(problems.values())


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


def misplaced_contacts(structure: Structure) -> list[Diagnostic]:
    """Report contacts between nodes of one floor, or with I and J exchanged."""
    model, problems = structure.model, list[Diagnostic]()
    floors, columns = _floors(model), _columns(model)
    collide = [s for s in structure.laws if s.role.collides and node_distance(model, s) > 0.0]
    forward = {frozenset((e.i, e.j)) for e in (model.elements[s.element] for s in collide)}
    for spring in structure.laws:
        e = model.elements[spring.element]
        if spring.role.collides and e.j is not None:
            within = floors[e.i] == floors[e.j] and abs(_way(spring)[0]) > ALONG_COSINE
            twin = frozenset((e.i, e.j)) in forward
            problems += [_within(e)] if within else _backwards(model, spring, e, twin)
            problems += _misaligned(model, columns, spring, e)
    return problems


def duplicate_contacts(structure: Structure) -> list[Diagnostic]:
    """Report contacts with the same nodes, direction and gap, and between two bodies also the same property
    set.
    """
    model, first, problems = structure.model, dict[tuple[object, ...], Element](), list[Diagnostic]()
    for spring in (s for s in structure.laws if s.role.collides):
        e, angle = model.elements[spring.element], round(spring.facts["angle"], 6) % 360.0
        kind = "" if e.j is None else e.prop  # contacts of different sets may act side by side
        other = first.setdefault((e.i, e.j, angle, spring.gap, kind), e)
        if other is not e:
            both = f"contacts {other.name or other.id} and {e.name or e.id}"
            message = f"{both} are the same: they close at {angle:g} degrees together"
            hint = "give one ANGLE=180 if it is that of the other side, or take it out"
            problems.append(Diagnostic("P354", message, e.span, hint, "warning"))
    return problems


def idle_contacts(structure: Structure) -> list[Diagnostic]:
    """Report contacts along X between buildings that an earthquake along Y alone shakes."""
    model = structure.model
    ways = shaken(model)
    of = {n: k for k, nodes in enumerate(parts(model)) if stands(model, nodes) for n in nodes}
    for spring in structure.laws if ways.keys() == {"Y"} else ():
        e = model.elements[spring.element]
        across = spring.role.collides and abs(_way(spring)[0]) > ALONG_COSINE and spring.gap > 0.0
        if across and e.j in of and e.i in of and of[e.i] != of[e.j]:
            card = ways["Y"]
            message = f"the ground moves along Y alone, but contact {e.name or e.id} closes along X"
            hint = "add a motion along X, or leave DIRECTION out, which is X"
            return [Diagnostic("P374", message, card.place("DIRECTION"), hint, "warning")]
    return []


def _columns(model: Model) -> dict[float, list[Node]]:
    """Nodes grouped by x coordinate."""
    columns = defaultdict[float, list[Node]](list)
    for n in model.nodes.values():
        columns[n.x].append(n)
    return columns


def _beside(model: Model, columns: Mapping[float, Sequence[Node]], e: Element) -> tuple[int, int] | None:
    """Node in the column of one end of a contact, at the height of the other end, and that first end; None
    if there is no such node.
    """
    nodes = model.nodes
    for one, other in ((e.i, e.j), (e.j, e.i)) if e.j is not None else ():
        assert one is not None and other is not None
        rise = abs(nodes[one].y - nodes[other].y)
        for n in columns[nodes[other].x] if rise else ():
            if abs(n.y - nodes[one].y) < LEVEL_RATIO * rise:
                return n.id, other
    return None


def _misaligned(
    model: Model, columns: Mapping[float, Sequence[Node]], spring: LawSpring, e: Element
) -> Iterator[Diagnostic]:
    """Yield a warning for a contact between floors of different heights, or for one that acts across the
    line between its nodes.
    """
    assert e.j is not None
    i, j = model.nodes[e.i], model.nodes[e.j]
    across, along = abs(i.x - j.x), abs(i.y - j.y)
    sloping = model.props[e.prop]["ANGLE"] is None
    if abs(_way(spring)[1]) > ALONG_COSINE and along < LEVEL_RATIO * across:
        message = (
            f"contact {e.name or e.id} acts along Y, but its nodes {e.i} and {e.j} lie beside each other: "
            "they pass without a collision"
        )
        yield Diagnostic("P368", message, e.span, "give it ANGLE=0, or leave ANGLE out", "warning")
    elif across and (sloping or abs(_way(spring)[1]) <= ALONG_COSINE):
        beside, angle = _beside(model, columns, e), spring.facts["angle"]
        if beside:
            n, other = beside
            message = (
                f"contact {e.name or e.id} joins node {e.i} at y = {i.y:g} with node {e.j} at y = {j.y:g}, "
                f"but node {n} faces it"
            )
            yield Diagnostic("P368", message, e.span, f"name node {n} in place of node {other}", "warning")
        elif sloping and abs(math.remainder(angle, 90.0)) > ANGLE_TOLERANCE:
            message = (
                f"contact {e.name or e.id} acts along the line between its nodes, at {angle:.4g} degrees"
            )
            hint = "correct its nodes or their heights, or give ANGLE: 0 for floors that meet along x"
            yield Diagnostic("P334", message, e.span, hint, "warning")


def _floors(model: Model) -> dict[int, int]:
    """Floor number of each node; horizontal members and slaving along x tie nodes to one floor."""
    number = {n: i for i, n in enumerate(model.nodes)}
    pairs = [(n.id, n.slaved["X"]) for n in model.nodes.values() if "X" in n.slaved]
    for e in (e for members in members_by_set(model).values() for e in members):
        assert e.j is not None
        i, j = model.nodes[e.i], model.nodes[e.j]
        if abs(i.x - j.x) > ALONG_COSINE * math.hypot(i.x - j.x, i.y - j.y):
            pairs.append((e.i, e.j))
    joined = components(len(number), groups=[np.array([number[i], number[j]]) for i, j in pairs])
    return dict(zip(number, joined.tolist()))


def _way(spring: LawSpring) -> tuple[float, float]:
    """Unit direction of a contact, from I towards J."""
    angle = math.radians(spring.facts["angle"])
    return math.cos(angle), math.sin(angle)


def _within(e: Element) -> Diagnostic:
    message = (
        f"contact {e.name or e.id} joins nodes {e.i} and {e.j}, which members or SLAVED hold together: "
        "it does not close"
    )
    hint = "name nodes of two buildings; nodes of two buildings are not slaved to each other"
    return Diagnostic("P358", message, e.span, hint, "warning")


def node_distance(model: Model, spring: LawSpring) -> float:
    """Distance of a contact's nodes along its direction [L]; negative if J is behind I, 0 for a wall."""
    e, (c, s) = model.elements[spring.element], _way(spring)
    i, j = model.nodes[e.i], model.nodes[e.i if e.j is None else e.j]
    distance = (j.x - i.x) * c + (j.y - i.y) * s
    return distance if abs(distance) > SAME_DISTANCE * math.hypot(j.x - i.x, j.y - i.y) else 0.0


def _backwards(model: Model, spring: LawSpring, e: Element, twin: bool) -> Iterator[Diagnostic]:
    """Yield a warning for a contact that closes as its nodes move apart, without a counterpart that closes
    as they approach.
    """
    if node_distance(model, spring) < 0.0 <= spring.gap and not twin:
        message = (
            f"contact {e.name or e.id} closes as nodes {e.i} and {e.j} move apart: "
            f"ANGLE points from {e.j} to {e.i}"
        )
        hint = "exchange I and J, or leave ANGLE out; leave it so if it is a hook"
        yield Diagnostic("P359", message, e.span, hint, "warning")
