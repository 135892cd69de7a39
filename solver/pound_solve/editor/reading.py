"""Tolerant reading of a deck with mistakes: rows with sections, PARAM values, units."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from pound_deck.build import units_of
from pound_deck.cards import ParsedLine, parse
from pound_deck.diagnostics import Diagnostic
from pound_deck.expressions import Definition, Value, resolve
from pound_deck.model import Units
from pound_deck.outline import Outline
from pound_deck.schema import Catalog
from pound_deck.sections import CARDS, NAMES
from pound_deck.source import DeckSource

_CARDS: Final = frozenset(spec.name for spec in CARDS)


@dataclass(frozen=True, slots=True)
class Reading:
    """Rows of a deck and of the files that it includes.

    Attributes
    ----------
    catalog : Catalog
    rows : tuple of (str, ParsedLine)
        Every row with the name of its section; empty for headings and for cards outside sections.
    definitions : mapping of str to Definition
        PARAMs by upper-case name.
    params : mapping of str to float, str or None
        Their values; None for one with a mistake.
    units : Units
    files : mapping of str to str
        Texts by the name in spans.
    """

    catalog: Catalog
    rows: tuple[tuple[str, ParsedLine], ...]
    definitions: Mapping[str, Definition]
    params: Mapping[str, Value | None]
    units: Units
    files: Mapping[str, str]

    def files_at(self, path: str) -> set[str]:
        """Names in spans of a file, given by its real path."""
        return {name for name in self.files if os.path.realpath(name) == path}


def read(path: str, catalog: Catalog, unsaved: Mapping[str, str]) -> Reading:
    """Read a deck.

    Parameters
    ----------
    path : str
    catalog : Catalog
    unsaved : mapping of str to str
        Texts of the editor by real path.

    Raises
    ------
    OSError
        The deck cannot be read; included files may be missing.
    """
    ignored: list[Diagnostic] = []
    source = DeckSource(unsaved=unsaved)
    rows = list(parse(source.read(path), ignored))
    outline = Outline(catalog, ignored)
    for row in sorted(rows, key=lambda row: row.word != "PARAM"):
        outline.add(row)
    placed, section = [], ""
    for row in rows:
        section = row.word if row.word in NAMES else section
        placed.append(("" if row.word in NAMES or row.word in _CARDS else section, row))
    params = resolve(outline.definitions, ignored, outline.lost)
    units = units_of(outline.single.get("UNITS"), ignored)
    return Reading(catalog, tuple(placed), outline.definitions, params, units, source.files)
