"""Checks of unsupported ends of members: free column feet, and coincident nodes that nothing joins."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

import numpy as np

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Element, Model, Span
from pound_solve.numerics.graph import components
from pound_solve.structure.buildings import SAME_LEVEL, parts
from pound_solve.structure.structure import Structure

SAME_PLACE = 1e-6  #: tolerance for coincident nodes, as a fraction of the structure's size


def loose_ends(structure: Structure) -> list[Diagnostic]:
    """Report ends of members that hang free or miss the node they should end at, one for each line of the
    deck.
    """
    ends = Ends(structure.model)
    problems: dict[Span, Diagnostic] = {}
    for n, d in (*_apart(ends), *_feet(ends)):
        problems.setdefault(structure.model.nodes[n].span, d)
    return list(problems.values())


class Ends:
    """Members, other elements, masses and loads at each node, and groups of coincident nodes.

    Attributes
    ----------
    model : Model
    members : mapping of int to list of Element
        Elements at every node that lead to another place, except contacts.
    used : set of int
        Nodes with a contact, a zero-length element, an element to the ground, or slaving.
    loaded : set of int
        Nodes that have mass or load.
    groups : list of list of int
        Groups of coincident nodes.
    joined : mapping of int to int
        One label for all nodes that slaving and zero-length elements, including contacts, join.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        groups, at = places(model)
        self.groups = [group for group in groups if len(group) > 1]
        self.members: dict[int, list[Element]] = defaultdict(list)
        pairs = [(n.id, master) for n in model.nodes.values() for master in n.slaved.values()]
        self.used = {n for pair in pairs for n in pair}
        cards = (*model.weights, *model.loads, *model.forces, *model.initial)
        self.loaded = {n for card in cards for n in card["NODES"]}
        for e in model.elements.values():
            i, j = e.i, e.i if e.j is None else e.j
            if at[i] == at[j]:
                pairs.append((i, j))
            if at[i] == at[j] or model.props[e.prop].spec.name == "CONTACT":
                self.used.update((i, j))
            else:
                self.members[i].append(e)
                self.members[j].append(e)
        number = {n: k for k, n in enumerate(model.nodes)}
        tied = components(len(number), groups=[np.array([number[i], number[j]]) for i, j in pairs])
        self.joined = dict(zip(model.nodes, tied.tolist()))

    def free(self, n: int) -> bool:
        """Whether exactly one member and nothing else ends at a node."""
        alone = len(self.members[n]) == 1 and n not in self.used
        return alone and n not in self.loaded and not self.held(n)

    def held(self, n: int) -> bool:
        """Whether a support fixes a node along x or y."""
        return bool({"X", "Y"} & set(self.model.nodes[n].fixed))

    def reach(self, n: int) -> tuple[float, float]:
        """Heights of the lowest and the highest end of the members at a node [L]."""
        nodes = self.model.nodes
        y = [nodes[n].y, *(nodes[m].y for e in self.members[n] for m in (e.i, e.j) if m is not None)]
        return min(y), max(y)

    def down(self, n: int) -> bool:
        """Whether a member leads down from a node."""
        return self.reach(n)[0] < self.model.nodes[n].y


def places(model: Model) -> tuple[list[list[int]], dict[int, int]]:
    """Groups of coincident nodes, and the group number of each node."""
    x, y = np.array([(n.x, n.y) for n in model.nodes.values()]).T
    unit = SAME_PLACE * max(np.ptp(x), np.ptp(y)) or 1.0
    by_place: dict[tuple[float, float], list[int]] = defaultdict(list)
    for n, a, b in zip(model.nodes, np.round(x / unit).tolist(), np.round(y / unit).tolist()):
        by_place[a, b].append(n)
    groups = list(by_place.values())
    return groups, {n: i for i, group in enumerate(groups) for n in group}


def _feet(ends: Ends) -> Iterator[tuple[int, Diagnostic]]:
    """Yield the free lower ends of members at or below the supports of their building, with warnings.

    A structure that hangs from its supports is intended.
    """
    model = ends.model
    grounded = {e.i for e in model.elements.values() if e.j is None}
    for part in parts(model):
        y = [model.nodes[n].y for n in part]
        supports = [n for n in part if ends.held(n) or n in grounded]
        if not supports:
            continue
        base, close = min(model.nodes[n].y for n in supports), SAME_LEVEL * (max(y) - min(y))
        columns = {e.prop for n in supports if model.nodes[n].y <= base + close for e in ends.members[n]}
        for n in part:
            alone = len(ends.members[n]) == 1 and n not in ends.used and "Y" not in model.nodes[n].fixed
            # a heavy free end unlike any other foot may be a pendulum
            alone = alone and (n not in ends.loaded or ends.members[n][0].prop in columns)
            if alone and model.nodes[n].y <= base + close < ends.reach(n)[1]:
                message = f"the foot of member {ends.members[n][0].id}, node {n}, hangs free"
                hint = "give it FIX, or join it to the ground by an element"
                yield n, Diagnostic("P348", message, model.nodes[n].span, hint, "warning")


def _apart(ends: Ends) -> Iterator[tuple[int, Diagnostic]]:
    """Yield coincident nodes that nothing joins although one needs the other, with warnings.

    A node without a column, such as a beam end, needs the node that has one; a free end needs any. Adjacent
    frames have columns on both sides and are not reported.
    """
    for group in ends.groups:
        for n in group:
            alone = ends.free(n)
            if not ends.members[n] or ends.held(n) or (ends.down(n) and not alone):
                continue
            for other in group:
                stands = ends.held(other) or ends.down(other)
                if ends.joined[other] != ends.joined[n] and (stands or (alone and ends.members[other])):
                    yield n, _beside(ends, n, other)
                    break


def _beside(ends: Ends, n: int, other: int) -> Diagnostic:
    node, member = ends.model.nodes[n], ends.members[n][0].id
    message = f"nodes {n} and {other} are both at x = {node.x:g}, y = {node.y:g}, but nothing joins them"
    hint = f"let element {member} end at node {other}, or join the nodes by SLAVED, a spring or a contact"
    return Diagnostic("P349", message, node.span, hint, "warning")
