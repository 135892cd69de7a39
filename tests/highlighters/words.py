"""Words of decks by what they are, for highlighting; all from the catalog."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from pound_deck.expressions import FUNCTIONS
from pound_deck.schema import Kind
from pound_deck.sections import CARDS, FAMILIES, NAMES, SECTIONS
from pound_solve.catalog import specs

EXTENSIONS = ("inp", "inc")  #: of decks and of what they include


@dataclass(frozen=True, slots=True)
class Words:
    """Words of one sort each, in capitals and sorted.

    Attributes
    ----------
    sections : tuple of str
    cards : tuple of str
        Those that stand in no section.
    elements : tuple of str
        Kinds that follow a label.
    kinds : tuple of str
        Kinds that begin a line.
    members : tuple of str
        Rules, laws, methods and formats.
    items : tuple of str
        What stands before ``=``.
    choices : tuple of str
        Words that an item takes.
    functions : tuple of str
    """

    sections: tuple[str, ...]
    cards: tuple[str, ...]
    elements: tuple[str, ...]
    kinds: tuple[str, ...]
    members: tuple[str, ...]
    items: tuple[str, ...]
    choices: tuple[str, ...]
    functions: tuple[str, ...]


def words() -> Words:
    """Return the words of the catalog."""
    every = (*CARDS, *SECTIONS, *specs())
    fields = [f for spec in every for f in spec.fields]
    choices = {w for f in fields if f.kind in (Kind.WORD, Kind.REAL) for w in f.words}
    begins = {*FAMILIES.values()} - {"element"}
    return Words(
        _sorted(NAMES),
        _sorted(spec.name for spec in CARDS),
        _sorted(s.name for s in specs() if s.family == "element"),
        _sorted(s.name for s in specs() if s.family in begins),
        _sorted(s.name for s in specs() if s.family not in {"element", *begins}),
        _sorted(f.name for f in fields),
        _sorted(choices),
        _sorted(FUNCTIONS),
    )


def _sorted(some: Iterable[str]) -> tuple[str, ...]:
    return tuple(sorted(set(some)))
