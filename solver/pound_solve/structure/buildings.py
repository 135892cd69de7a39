"""Buildings: the connected parts of a structure, their floors and storeys.

Elements and slaving connect nodes; contacts, and the friction in them, do not. A part without mass is not a
building.  A building takes its name from a card of BUILDINGS; unnamed ones are ``building 1``, ``building
2``, ... in the order of their lowest node numbers.

The base of a building is its lowest support, or its lowest node if it has no support. Nodes with mass above
it make a level if their heights differ by no more than `SAME_LEVEL` of the height of the building.  Its
floors are the levels that FLOORS names; by default, the highest level and every level with at least
`MIN_FLOOR_MASS_RATIO` of the mass of the heaviest. This excludes joints within a column. A storey reaches
from the floor below, or the base, to its floor, and is cut at the middle of its height.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Card, Model
from pound_solve.numerics.graph import components
from pound_solve.numerics.types import Array, Index
from pound_solve.structure.dofs import Dof
from pound_solve.structure.structure import Structure

BEARING = 0.25  #: fraction of the height of the highest storey below which a storey is a layer of bearings
SAME_LEVEL = 1e-3  #: fraction of a building's height by which nodes of one level may differ in height
#: least mass of a floor, as a share of the mass of the building's heaviest level
MIN_FLOOR_MASS_RATIO = 0.1


@dataclass(frozen=True, eq=False)
class Floor:
    """A level of nodes with mass.

    Attributes
    ----------
    nodes : tuple of int
    shares : ndarray, shape (n_nodes,)
        Share of each node in the floor's mass along x; they sum to one.
    level : float
        Mean height of the nodes, weighted by their mass [L].
    mass : float
        Along x [F T^2/L].
    """

    nodes: tuple[int, ...]
    shares: Array
    level: float
    mass: float


@dataclass(frozen=True)
class Building:
    """A connected part of a structure, with its base, floors and storeys.

    Attributes
    ----------
    name : str
    nodes : tuple of int
    base : float
        Height of its base [L].
    axis : float
        x about which moments are taken: the middle of the supports at the base [L].
    feet : tuple of int
        The nodes at its base.
    floors : tuple of Floor
        From below.
    mass : float
        Of all its nodes along x, or along y if there is none along x [F T^2/L].
    reach : float
        Largest distance along x or y of its nodes from the middle of its base [L].
    bearings : frozenset of int
        Storeys, from 1, that are layers of bearings (see `bearing_layers`).
    """

    name: str
    nodes: tuple[int, ...]
    base: float
    axis: float
    feet: tuple[int, ...]
    floors: tuple[Floor, ...]
    mass: float
    reach: float
    bearings: frozenset[int] = frozenset()

    @property
    def levels(self) -> list[float]:
        """Heights of the base and of the floors [L]."""
        return [self.base, *(f.level for f in self.floors)]


def parts(model: Model) -> list[tuple[int, ...]]:
    """Nodes of each connected part, ordered by the lowest node number."""
    numbers = sorted(model.nodes)
    place = {n: i for i, n in enumerate(numbers)}
    pairs = joints(model)
    pairs += [(n.id, master) for n in model.nodes.values() for master in n.slaved.values()]
    joined = components(len(numbers), groups=[np.array([place[i], place[j]]) for i, j in pairs])
    by_label: dict[int, list[int]] = {}
    for n, label in zip(numbers, joined.tolist()):
        by_label.setdefault(label, []).append(n)
    return [tuple(nodes) for nodes in by_label.values()]


def stands(model: Model, nodes: Collection[int]) -> bool:
    """Whether a connected part has height and members, as a frame has; a ball, a floor or a horizontal bar
    does not.
    """
    inside = frozenset(nodes)
    joined = any(i in inside and j in inside for i, j in joints(model))
    return joined and len({model.nodes[n].y for n in inside}) > 1


def joints(model: Model) -> list[tuple[int, int]]:
    """Pairs of nodes that elements other than contacts join."""
    return [
        (e.i, e.j)
        for e in model.elements.values()
        if e.j is not None and model.props[e.prop].spec.name != "CONTACT"
    ]


def buildings(structure: Structure) -> list[Building]:
    """The buildings of a structure, in the order of their lowest nodes."""
    along, up = (own_mass(structure, d) for d in range(2))
    heavy = [p for p in parts(structure.model) if any(along[n] or up[n] for n in p)]
    named = {n: card for card in structure.model.buildings for n in card["NODES"]}
    ordered = []
    for i, nodes in enumerate(heavy, 1):
        card = next((named[n] for n in nodes if n in named), None)
        stack = Levels(structure.model, nodes, along)
        floors = stack.floors((card and card["FLOORS"]) or ())
        mass = sum(along[n] for n in nodes) or sum(up[n] for n in nodes)
        axis = float(np.mean([structure.model.nodes[n].x for n in stack.feet]))
        name = card.label if card else f"building {i}"
        points = (structure.model.nodes[n] for n in nodes)
        reach = max(max(abs(n.x - axis), abs(n.y - stack.base)) for n in points)
        levels = [stack.base, *(f.level for f in floors)]
        bearings = bearing_layers(structure.model, nodes, levels)
        ordered.append(Building(name, nodes, stack.base, axis, stack.feet, floors, mass, reach, bearings))
    return ordered


def bearing_layers(model: Model, nodes: Collection[int], levels: Sequence[float]) -> frozenset[int]:
    """Storeys of a building that are layers of bearings: those lower than `BEARING` of its highest storey,
    unless a SPRING in them has BEARING=NO, and those with a SPRING that has BEARING=YES.  They may move by
    more than their height: their drifts are stated as lengths.
    """
    heights = np.diff(levels)
    layers = {n for n, h in enumerate(heights, 1) if h < BEARING * heights.max()}
    for word, change in (("NO", layers.discard), ("YES", layers.add)):
        for i, j in marked_bearings(model, word):
            if i in nodes and j in nodes:
                middle = 0.5 * (model.nodes[i].y + model.nodes[j].y)
                change(sum(level < middle for level in levels))
    return frozenset(layers & set(range(1, len(levels))))


def marked_bearings(model: Model, word: str = "YES") -> list[tuple[int, int]]:
    """Nodes of the springs whose BEARING is the word."""
    return [
        (e.i, e.j)
        for e in model.elements.values()
        if e.j is not None and model.props[e.prop].values.get("BEARING") == word
    ]


class Levels:
    """The base of a building, and its levels of nodes with mass.

    Parameters
    ----------
    model : Model
    nodes : sequence of int
        Of the building.
    heavy : mapping of int to float
        Mass of every node along x [F T^2/L].

    Attributes
    ----------
    base : float
        Height of its base [L].
    feet : tuple of int
        The nodes at its base.
    """

    def __init__(self, model: Model, nodes: Sequence[int], heavy: Mapping[int, float]) -> None:
        held = [n for n in nodes if "X" in model.nodes[n].fixed] or list(nodes)
        self._height = height = {n: model.nodes[n].y for n in nodes}
        self._close = SAME_LEVEL * (max(height.values()) - min(height.values()))
        self.base = min(height[n] for n in held)
        self.feet = tuple(n for n in held if height[n] <= self.base + self._close)
        levels: list[list[int]] = []
        for n in sorted((n for n in nodes if heavy[n] > 0.0), key=lambda n: (height[n], n)):
            if height[n] <= self.base + self._close:
                continue
            if levels and height[n] <= height[levels[-1][0]] + self._close:
                levels[-1].append(n)
            else:
                levels.append([n])
        self._levels = [_floor(nodes, heavy, height) for nodes in levels]

    def floors(self, named: Collection[int]) -> tuple[Floor, ...]:
        """The levels that count as floors: those of the `named` nodes, or those with enough mass if none is
        named.
        """
        if named:
            at = [self.at(n) for n in named]
            return tuple(level for level in self._levels if level in at)
        heaviest = max((level.mass for level in self._levels), default=0.0)
        last = self._levels[-1:]
        return tuple(f for f in self._levels if f.mass >= MIN_FLOOR_MASS_RATIO * heaviest or f in last)

    def at(self, node: int) -> Floor | None:
        """The level at the height of a node of the building, if there is one."""
        height = self._height.get(node, np.nan)
        near = (f for f in self._levels if abs(height - f.level) <= self._close)
        return next(near, None)


def building(structure: Structure, name: str) -> Building:
    """Return the building of that name.

    Raises
    ------
    KeyError
        No building has this name; the message lists those that exist.
    """
    named = {b.name: b for b in buildings(structure)}
    if name not in named:
        there = ", ".join(named) or "none"
        raise KeyError(f"there is no building {name!r}; the buildings are {there}")
    return named[name]


def columns_of(model: Model, columns: Sequence[Dof], groups: Sequence[Collection[int]]) -> list[Index]:
    """Columns of each group of nodes, including internal DOFs of elements within the group."""
    places: dict[int, list[tuple[int, int]]] = {}
    for column, (owner, d) in enumerate(columns):
        i, j = (owner, owner) if d < 3 else (model.elements[owner].i, model.elements[owner].j)
        places.setdefault(i, []).append((column, j or i))
    by_group = []
    for nodes in groups:
        inside = frozenset(nodes)
        numbers = sorted(column for i in inside for column, j in places.get(i, ()) if j in inside)
        by_group.append(np.array(numbers, np.int64))
    return by_group


def misnamed_buildings(structure: Structure) -> list[Diagnostic]:
    """Report cards of BUILDINGS that match no building, several buildings, or one that is already named."""
    problems, names, of = list[Diagnostic](), set[str](), {}
    for i, nodes in enumerate(parts(structure.model)):
        of.update(dict.fromkeys(nodes, i))
    taken: dict[int, str] = {}
    for card in structure.model.buildings:
        touched = {of[n]: n for n in reversed(card["NODES"])}
        (first, node), *others = sorted(touched.items())
        if others:
            message = f"nodes {node} and {others[0][1]} of {card.label!r} are not connected"
            problems.append(Diagnostic("P338", message, card.place("NODES"), "name nodes of one building"))
        elif first in taken:
            message = f"{card.label!r} is the building {taken[first]!r}: node {node} belongs to it"
            problems.append(Diagnostic("P338", message, card.place("NODES"), "give it one name"))
        elif card.label in names:
            message = f"two buildings have the name {card.label!r}"
            problems.append(Diagnostic("P338", message, card.place("NAME"), "give another name"))
        else:
            problems += _no_floors(structure, card, [n for n in of if of[n] == first])
        taken.setdefault(first, card.label)
        names.add(card.label)
    return problems


def _no_floors(structure: Structure, card: Card, nodes: Sequence[int]) -> Iterator[Diagnostic]:
    """Yield warnings for nodes in FLOORS that lie at no floor of the building."""
    stack = Levels(structure.model, nodes, own_mass(structure, 0))
    for n in card["FLOORS"] or ():
        if n not in nodes:
            message = f"node {n} of FLOORS is no node of {card.label!r}"
            yield Diagnostic("P338", message, card.place("FLOORS"), "name nodes of this building")
        elif stack.at(n) is None:
            message = f"no node at the height of node {n} has mass along X above the base of {card.label!r}"
            yield Diagnostic("P338", message, card.place("FLOORS"), "name a node of each floor")


def own_mass(structure: Structure, d: int) -> dict[int, float]:
    """Mass of every node along direction `d`, excluding its slaves [F T^2/L]."""
    nodes, whole = structure.model.nodes, structure.nodal_mass
    mass = {n: whole.get((n, d), 0.0) for n in nodes}
    for n, x in nodes.items():
        if (master := x.slaved.get("XY"[d])) is not None:
            mass[master] -= whole.get((n, d), 0.0)
    return mass


def _floor(nodes: Sequence[int], heavy: Mapping[int, float], height: Mapping[int, float]) -> Floor:
    mass = np.array([heavy[n] for n in nodes])
    level = float(mass @ [height[n] for n in nodes] / mass.sum())
    return Floor(tuple(nodes), mass / mass.sum(), level, float(mass.sum()))
