"""Outline of a file: PARAMs, cards and sections with their lines."""

from __future__ import annotations

from dataclasses import dataclass, field

from pound_deck.cards import ParsedLine
from pound_deck.model import Span
from pound_deck.sections import FAMILIES, NAMES
from pound_solve.editor.reading import Reading


@dataclass(slots=True)
class Symbol:
    """An entry of the outline.

    Attributes
    ----------
    name, detail : str
    sort : str
        ``section``, ``card``, ``PARAM`` or ``line``.
    span : Span
        Its name.
    last : int
        Last line of the entry.
    below : list of Symbol
    """

    name: str
    detail: str
    sort: str
    span: Span
    last: int
    below: list[Symbol] = field(default_factory=list)


def outline(reading: Reading, path: str) -> list[Symbol]:
    """Entries of one file, given by its real path."""
    names = reading.files_at(path)
    entries: list[Symbol] = []
    open_section: Symbol | None = None
    for section, row in reading.rows:
        if row.span.file not in names:
            continue
        last = row.line.number + row.line.text.count("\n")
        if row.word == "PARAM" and not section:
            entries += [
                Symbol(item.name, item.text, "PARAM", item.name_span, item.name_span.line)
                for item in (row.items or ())[1:]
                if item.name
            ]
        elif row.word in NAMES:
            open_section = Symbol(row.word, "", "section", row.span, last)
            entries.append(open_section)
        elif section:
            if open_section is None:  # lines that belong to a section of the file that includes this one
                open_section = Symbol(section, "", "section", row.span, last)
                entries.append(open_section)
            open_section.below += _line(row, section, last)
            open_section.last = last
        elif row.items:
            entries.append(Symbol(row.word, _rest(row), "card", row.span, last))
        elif row.word == "TITLE":
            entries.append(Symbol(row.word, row.line.text.strip()[5:].strip(), "card", row.span, last))
    return entries


def _line(row: ParsedLine, section: str, last: int) -> list[Symbol]:
    items = row.items or ()
    if not items:
        return []
    more = items[1:2] if section == "PROPS" else () if section in FAMILIES else items[1:3]
    detail = " ".join(item.text for item in more)
    name = items[0].text if not items[0].name else f"{items[0].name}={items[0].text}"
    return [Symbol(name, detail, "line", items[0].name_span, last)]


def _rest(row: ParsedLine) -> str:
    return " ".join(item.text for item in (row.items or ())[1:])
