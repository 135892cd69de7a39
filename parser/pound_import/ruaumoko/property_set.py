"""Input of the readers of property sets."""

from __future__ import annotations

from dataclasses import dataclass

from pound_deck.schema import Catalog
from pound_import.draft import Draft
from pound_import.ruaumoko.lines import DataLines
from pound_import.ruaumoko.nodes import LegacyNode


@dataclass(frozen=True, slots=True)
class PropertySet:
    """A property set: its number, its lines from the second on, the ends of its members.

    Attributes
    ----------
    elastic : bool
        The deck asks for elastic members (IPLAS 0).
    """

    number: int
    rows: DataLines
    ends: list[tuple[LegacyNode, LegacyNode]]
    elastic: bool
    catalog: Catalog
    draft: Draft

    @property
    def lengths(self) -> list[float]:
        """Lengths of its members [L]."""
        return [((b.x - a.x) ** 2 + (b.y - a.y) ** 2) ** 0.5 for a, b in self.ends]
