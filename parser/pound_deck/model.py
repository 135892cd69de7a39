"""The Model: the contents of a deck, typed and checked, each part with its place.

Nothing here is numerical.  A :class:`Card` carries the bound values of one Spec; the few parts that every
later stage needs by name (nodes, elements) have fields of their own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Final

from pound_deck.schema import Spec


@dataclass(frozen=True, slots=True)
class Span:
    """A place in a deck: file name as the user gave it, 1-based line and column, column after the end."""

    file: str
    line: int
    column: int
    end: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


@dataclass(frozen=True, slots=True)
class Card:
    """One card: its Spec, its bound values and their places.

    Attributes
    ----------
    spec : Spec
        The main Spec (for a property set: the element's).
    values : mapping of str to object
        Bound value of every field, defaults filled in; FAMILY fields bind to the chosen Spec's name.
    span : Span
        The whole card.
    label : str
        Name in the deck (property sets, drifts, limits, buildings), else empty.
    laws : mapping of str to tuple of Spec
        For each FAMILY field the Specs chosen (their fields are part of `values`).
    spans : mapping of str to Span
        Place of each item that the deck gives; a field without one was left to its default.
    """

    spec: Spec
    values: Mapping[str, Any]
    span: Span
    label: str = ""
    laws: Mapping[str, tuple[Spec, ...]] = field(default_factory=dict)
    spans: Mapping[str, Span] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Any:
        return self.values[name]

    def place(self, name: str) -> Span:
        """Span of an item, or of the card where the item was left to its default."""
        return self.spans.get(name, self.span)


@dataclass(frozen=True, slots=True)
class Node:
    """A node: number, coordinates [L], fixed directions (letters of XYR), masters of slaved directions."""

    id: int
    x: float
    y: float
    fixed: str
    span: Span
    slaved: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Element:
    """A member, spring, dashpot or contact: number, property label, end nodes.

    `j` is None for an element that ends at the ground or at a wall; `name` is a text or empty.
    """

    id: int
    prop: str
    i: int
    j: int | None
    span: Span
    name: str = ""


#: Name of the unit of mass F T^2/L by the units of force, length and time that make exactly that unit.
_MASSES: Final = MappingProxyType({("kN", "m", "s"): "t", ("N", "mm", "s"): "t", ("N", "m", "s"): "kg"})


@dataclass(frozen=True, slots=True)
class Units:
    """Names of the deck's units; nothing is converted."""

    force: str = "kN"
    length: str = "m"
    time: str = "s"
    stated: bool = False

    def text(self, dimension: str) -> str:
        """Text of a dimension (``F/L`` ...) in the deck's units (``kN/m`` ...).

        A mass has its own name where that is exactly the same unit: kN s^2/m is ``t``.  A modulus stays
        ``kN/m^2``, the form in which decks and codes of practice state it.
        """
        if dimension == "F*T^2/L" and (mass := _MASSES.get((self.force, self.length, self.time))):
            return mass
        unit = ""
        for ch in dimension:
            unit += {"F": self.force, "L": self.length, "T": self.time}.get(ch, ch)
        return unit


@dataclass(frozen=True, slots=True)
class Model:
    """Contents of a deck.

    Attributes
    ----------
    title : str
    units : Units
    gravity : float
        Acceleration of gravity [L/T^2]; weights are divided by it.
    mass : str
        ``LUMPED`` or ``CONSISTENT`` mass of FRAME members.
    geometry : str
        ``SMALL`` displacements, or the effect of axial forces on the stiffness: ``PDELTA``,
        ``PDELTA_MEMBER``, ``PDELTA_VARYING``, or ``LARGE`` displacements.
    params : mapping of str to float or str
        Values of all PARAM names, after ``--set``.
    nodes, elements, props : mappings by number or label
        `props` are Cards of the family ``element``.
    weights, loads, member_loads, initial, drifts, limits, buildings : tuples of Card
    damping, equake, forces, analyses : tuples of Card
    output : Card
        The OUTPUT card, all defaults where the deck has none.
    meant : frozenset of str
        Codes of the warnings suppressed by MEANT.
    files : mapping of str to str
        Text of the deck and of every included file, by the name in its Spans.
    defaults : frozenset of str
        Which of ``units``, ``gravity``, ``mass``, ``geometry`` were left to their defaults.
    """

    title: str
    units: Units
    gravity: float
    mass: str
    geometry: str
    params: Mapping[str, float | str]
    nodes: Mapping[int, Node]
    elements: Mapping[int, Element]
    props: Mapping[str, Card]
    weights: tuple[Card, ...]
    loads: tuple[Card, ...]
    member_loads: tuple[Card, ...]
    initial: tuple[Card, ...]
    drifts: tuple[Card, ...]
    limits: tuple[Card, ...]
    buildings: tuple[Card, ...]
    damping: tuple[Card, ...]
    equake: tuple[Card, ...]
    forces: tuple[Card, ...]
    analyses: tuple[Card, ...]
    output: Card
    files: Mapping[str, str]
    meant: frozenset[str] = frozenset()
    defaults: frozenset[str] = frozenset()
