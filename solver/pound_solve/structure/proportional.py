"""Damping in proportion to the initial stiffness of chosen elements."""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

from pound_deck.model import Element


class Chosen(NamedTuple):
    """A choice of elements: of property sets (None: of all) that end at some nodes (None: at any)."""

    props: Collection[str] | None
    nodes: Collection[int] | None

    def has(self, element: Element) -> bool:
        """Whether an element belongs to the choice."""
        of_these = self.props is None or element.prop in self.props
        return of_these and (self.nodes is None or element.i in self.nodes)


class Proportional(NamedTuple):
    """Damping `beta` [T] times the initial stiffness of elements; `laws` False: without that of hysteretic
    laws.
    """

    elements: Chosen
    beta: float
    laws: bool
