"""What an element hands to the assembler."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_deck.model import Card, Element, Node
from pound_solve.dofs import Freedom
from pound_solve.laws import Branch, Law, State

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Block:
    """A small symmetric matrix on some freedoms."""

    freedoms: tuple[Freedom, ...]
    matrix: Matrix


@dataclass(frozen=True)
class LawSpring:
    """A component whose force follows a piecewise-linear law.

    The deformation is ``sum(row * u[freedoms])``; the force acts back on the freedoms along `row`.

    Attributes
    ----------
    component : str
        ``X``, ``Y``, ``R`` or ``contact``.
    rule : str
        Name of the law's Spec.
    k0 : float
        Initial stiffness for modes and damping [F/L] or [F L]; 0 for a contact.
    beta : float
        Dashpot as a multiple of the present stiffness [T] (damping models set it).
    yields : tuple of float or None
        Deformations at first yield, positive and negative, for ductilities.
    facts : mapping
        For a contact: what the report says of it (xi, e_asked, e_given, note, reduced_mass, k, c, gap).
    """

    element: int
    component: str
    rule: str
    freedoms: tuple[Freedom, ...]
    row: tuple[float, ...]
    law: Law
    k0: float = 0.0
    yields: tuple[float, float] | None = None
    facts: Mapping[str, Any] = field(default_factory=dict)
    beta: float = 0.0

    @property
    def is_contact(self) -> bool:
        """Whether the component is a contact."""
        return self.component == "contact"

    def branch(self, state: State) -> Branch:
        """Linear piece that the law is on, the dashpot of `beta` included."""
        own = self.law.branch(state)
        return own._replace(damping=own.damping + self.beta * own.stiffness) if self.beta else own

    def force(self, state: State, d: float, v: float) -> float:
        """Force at deformation `d` and rate `v`."""
        f, k, _ = self.law.force(state, d, v)
        return f + self.beta * k * v


@dataclass(frozen=True)
class Output:
    """A quantity of an element that is linear in displacement and velocity.

    ``value = u_row . u + v_row . v + constant`` on `freedoms`; `unit` in dimensions.
    """

    element: int
    quantity: str
    unit: str
    freedoms: tuple[Freedom, ...]
    u_row: Matrix
    v_row: Matrix | None = None
    constant: float = 0.0


@dataclass
class Parts:
    """Everything one element adds to the structure."""

    stiffness: list[Block] = field(default_factory=list)
    damping: list[Block] = field(default_factory=list)
    mass: list[Block] = field(default_factory=list)
    loads: list[tuple[tuple[Freedom, ...], Matrix]] = field(default_factory=list)
    laws: list[LawSpring] = field(default_factory=list)
    outputs: list[Output] = field(default_factory=list)

    def internal(self) -> tuple[Freedom, ...]:
        """Freedoms of the element's own, beside those of its nodes."""
        touched = [b.freedoms for b in self.stiffness] + [s.freedoms for s in self.laws]
        used = [f for freedoms in touched for f in freedoms if f[1] > 2]
        return tuple(sorted(set(used)))


@dataclass(frozen=True)
class Site:
    """Where an element stands and what it may ask.

    Attributes
    ----------
    gravity : float
        [L/T^2]
    consistent : bool
        Consistent instead of lumped mass.
    member_loads : tuple of Card
        MEMBER_LOADS cards that name this element.
    self_weight : bool
        Whether member weight loads the structure.
    mass_along : callable
        ``mass_along(node, (nx, ny))``: translational mass [F T^2/L] of a node
        along a direction; contacts only.
    """

    element: Element
    prop: Card
    i: Node
    j: Node | None
    gravity: float
    consistent: bool
    member_loads: tuple[Card, ...]
    self_weight: bool
    mass_along: Callable[[int, tuple[float, float]], float]


class ElementError(Exception):
    """An element that cannot be built; `item` names the field of the card at fault."""

    def __init__(self, message: str, item: str = "") -> None:
        super().__init__(message)
        self.item = item


def axes(angle: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Unit vectors of local x and y at `angle` degrees, exact at right angles."""
    quarter, rest = divmod(angle, 90.0)
    if rest == 0.0:
        c, s = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(quarter) % 4]
    else:
        c, s = float(np.cos(np.radians(angle))), float(np.sin(np.radians(angle)))
    return (c, s), (-s, c)


def direction(dx: float, dy: float) -> tuple[float, float]:
    """Unit vector along (dx, dy); what coordinates miss a right angle by in rounding is none of it."""
    length = math.hypot(dx, dy)
    c, s = dx / length, dy / length
    return (0.0 if abs(c) < 1e-14 else c), (0.0 if abs(s) < 1e-14 else s)
