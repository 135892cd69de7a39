"""Definition of a name, and all references to it."""

from __future__ import annotations

from pound_deck.model import Span
from pound_solve.editor.names import at, definitions, mentions
from pound_solve.editor.reading import Reading


def define(reading: Reading, place: Span) -> list[Span]:
    """Places that define the name at a place; a node of a range is defined by the range."""
    mentioned = mentions(reading)
    here = at(mentioned, place)
    return [m.span for m in definitions(mentioned, here)] if here else []


def references(reading: Reading, place: Span) -> list[Span]:
    """All places that mention the name at a place, its definition among them."""
    mentioned = mentions(reading)
    here = at(mentioned, place)
    return [m.span for m in mentioned if here and m.sort == here.sort and here.key in m.keys]
