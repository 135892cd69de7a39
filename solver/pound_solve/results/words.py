"""Texts of the deck's values and of the names of its parts in tables."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pound_deck.model import Card, Model
    from pound_deck.schema import Field


def text_of(value: Any) -> str:
    """Value of an item as text."""
    if value is None:
        return "-"
    if isinstance(value, tuple):
        return (
            ", ".join(text_of(v) for v in value)
            if len(value) <= 12
            else f"{text_of(value[:10])}, ... ({len(value)})"
        )
    return f"{value:.10g}" if isinstance(value, float) else str(value)


def fields_of(card: Card) -> Iterator[Field]:
    """Fields of a card and of the laws it chose, each once."""
    seen: set[str] = set()
    for spec in (card.spec, *(s for specs in card.laws.values() for s in specs)):
        for f in spec.fields:
            if f.name not in seen:
                seen.add(f.name)
                yield f


def contact_name(model: Model, element: int) -> str:
    """Name of a contact in the report: its own, or its number."""
    return model.elements[element].name or str(element)


def damped_part(card: Card) -> str:
    """Part of the structure that a card of DAMPING is for."""
    names = [f.name for f in card.spec.fields if f.name in ("BUILDING", "NODES", "PROPS") and card[f.name]]
    return "; ".join(f"{name.lower()} {text_of(card[name])}" for name in names) or "all"
