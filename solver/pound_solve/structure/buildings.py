"""Buildings: the connected parts of a structure, their floors and storeys.

Elements and slaving connect nodes; contacts, and the friction in them, do not.  A part without mass is no
building.  A building bears the name that a card of BUILDINGS gives it, or ``building 1``, ``building 2``,
... in the order of their lowest numbers of nodes.

The base of a building is its lowest support, or its lowest node where it has none.  Its floors are the
levels above the base at which nodes have mass: nodes belong to one floor if their heights differ by no more
than `SAME_LEVEL` of the height of the building.  A storey reaches from the floor below, or the base, to its
floor, and is cut at the middle of its height.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Model
from pound_solve.numerics.graph import components
from pound_solve.numerics.types import Array, Flags
from pound_solve.structure.dofs import Dof
from pound_solve.structure.structure import Structure

SAME_LEVEL = 1e-3  #: share of a building's height by which nodes of one floor may differ in height


@dataclass(frozen=True)
class Floor:
    """A level of nodes with mass.

    Attributes
    ----------
    nodes : tuple of int
    shares : ndarray, shape (n_nodes,)
        Of each node in the floor's mass along x; they sum to one.
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
    """A connected part.

    Attributes
    ----------
    name : str
    nodes : tuple of int
    base : float
        Height of its base [L].
    axis : float
        x about which moments count: the middle of the supports at the base [L].
    feet : tuple of int
        The nodes at its base.
    floors : tuple of Floor
        From below.
    mass : float
        Of all its nodes along x, or along y where there is none [F T^2/L].
    """

    name: str
    nodes: tuple[int, ...]
    base: float
    axis: float
    feet: tuple[int, ...]
    floors: tuple[Floor, ...]
    mass: float

    @property
    def levels(self) -> list[float]:
        """Heights of the base and of the floors [L]."""
        return [self.base, *(f.level for f in self.floors)]


def parts(model: Model) -> list[tuple[int, ...]]:
    """Nodes of the connected parts, by their lowest numbers."""
    numbers = sorted(model.nodes)
    place = {n: i for i, n in enumerate(numbers)}
    pairs = [
        (e.i, e.j)
        for e in model.elements.values()
        if e.j is not None and model.props[e.prop].spec.name != "CONTACT"
    ]
    pairs += [(n.id, master) for n in model.nodes.values() for master in n.slaved.values()]
    joined = components(len(numbers), groups=[np.array([place[i], place[j]]) for i, j in pairs])
    found: dict[int, list[int]] = {}
    for n, own in zip(numbers, joined.tolist()):
        found.setdefault(own, []).append(n)
    return [tuple(nodes) for nodes in found.values()]


def buildings(structure: Structure) -> list[Building]:
    """The buildings of a structure, in the order of their lowest nodes."""
    along, up = (own_mass(structure, d) for d in range(2))
    found = [p for p in parts(structure.model) if any(along[n] or up[n] for n in p)]
    named = {n: card.label for card in structure.model.buildings for n in card["NODES"]}
    out = []
    for i, nodes in enumerate(found, 1):
        name = next((named[n] for n in nodes if n in named), f"building {i}")
        out.append(_building(structure.model, name, nodes, along, up))
    return out


def building(structure: Structure, name: str) -> Building:
    """The building of a name.

    Raises
    ------
    KeyError
        There is none; its text tells what there is.
    """
    found = {b.name: b for b in buildings(structure)}
    if name not in found:
        there = ", ".join(found) or "none"
        raise KeyError(f"there is no building {name!r}; the buildings are {there}")
    return found[name]


def columns_of(model: Model, columns: Sequence[Dof], nodes: Collection[int]) -> Flags:
    """Which columns belong to some nodes, or to what is inside the elements between them."""
    own, elements = frozenset(nodes), model.elements
    return np.array(
        [
            owner in own
            if d < 3
            else elements[owner].i in own and (elements[owner].j or elements[owner].i) in own
            for owner, d in columns
        ],
        bool,
    )


def misnamed(structure: Structure) -> list[Diagnostic]:
    """Cards of BUILDINGS that name no building, several, or one that has a name."""
    out, names, of = list[Diagnostic](), set[str](), {}
    for i, nodes in enumerate(parts(structure.model)):
        of.update(dict.fromkeys(nodes, i))
    taken: dict[int, str] = {}
    for card in structure.model.buildings:
        own = {of[n]: n for n in reversed(card["NODES"])}
        (first, node), *others = sorted(own.items())
        if others:
            message = f"nodes {node} and {others[0][1]} of {card.label!r} are not connected"
            out.append(Diagnostic("P338", message, card.place("NODES"), "name nodes of one building"))
        elif first in taken:
            message = f"{card.label!r} is the building {taken[first]!r}: node {node} belongs to it"
            out.append(Diagnostic("P338", message, card.place("NODES"), "give it one name"))
        elif card.label in names:
            message = f"two buildings have the name {card.label!r}"
            out.append(Diagnostic("P338", message, card.place("NAME"), "give another name"))
        taken.setdefault(first, card.label)
        names.add(card.label)
    return out


def _building(
    model: Model, name: str, nodes: tuple[int, ...], along: dict[int, float], up: dict[int, float]
) -> Building:
    held = [n for n in nodes if "X" in model.nodes[n].fixed] or list(nodes)
    height = {n: model.nodes[n].y for n in nodes}
    base = min(height[n] for n in held)
    close = SAME_LEVEL * (max(height.values()) - min(height.values()))
    feet = tuple(n for n in held if height[n] <= base + close)
    heavy = {n: along[n] for n in nodes}
    mass = sum(heavy.values()) or sum(up[n] for n in nodes)
    floors: list[list[int]] = []
    for n in sorted((n for n in nodes if heavy[n] > 0.0), key=lambda n: (height[n], n)):
        if height[n] <= base + close:
            continue
        if floors and height[n] <= height[floors[-1][0]] + close:
            floors[-1].append(n)
        else:
            floors.append([n])
    axis = float(np.mean([model.nodes[n].x for n in feet]))
    return Building(name, nodes, base, axis, feet, tuple(_floor(f, heavy, height) for f in floors), mass)


def own_mass(structure: Structure, d: int) -> dict[int, float]:
    """Mass of every node along direction `d`, without that of its slaves [F T^2/L]."""
    nodes, whole = structure.model.nodes, structure.nodal_mass
    out = {n: whole.get((n, d), 0.0) for n in nodes}
    for n, x in nodes.items():
        if (master := x.slaved.get("XY"[d])) is not None:
            out[master] -= whole.get((n, d), 0.0)
    return out


def _floor(nodes: list[int], heavy: dict[int, float], height: dict[int, float]) -> Floor:
    own = np.array([heavy[n] for n in nodes])
    level = float(own @ [height[n] for n in nodes] / own.sum())
    return Floor(tuple(nodes), own / own.sum(), level, float(own.sum()))
