"""Completion: sections, kinds, items, their values, and the names in use."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import combinations, islice
from typing import Final

from pound_deck.expressions import FUNCTIONS
from pound_deck.schema import REQUIRED, Field, Kind
from pound_deck.sections import CARDS, FAMILIES, NAMES, SECTIONS
from pound_deck.source import without_comment
from pound_solve.editor.fields import Fields, fields
from pound_solve.editor.hover import describe, explain
from pound_solve.editor.names import SORTS, Mention, mentions
from pound_solve.editor.reading import Reading

MAX_PROPOSALS: Final = 1000  #: nodes or elements
_CARDS: Final = frozenset(spec.name for spec in CARDS)
#: kinds that take expressions
_NUMBERS: Final = (Kind.REAL, Kind.INT, Kind.NODE, Kind.NODES, Kind.ELEMENTS)
_PIECE: Final = re.compile(r"""(?:"[^"]*"?|'[^']*'?|[^\s"'])+""")
_TIGHT: Final = re.compile(r"\s*=\s*")
_OPEN: Final = re.compile(r"""[^"']*("[^"]*|'[^']*)$""")
_LAST: Final = re.compile(r"[A-Za-z0-9_.]*$")


@dataclass(frozen=True, slots=True)
class Suggestion:
    """A completion.

    Attributes
    ----------
    text : str
        Replaces the word being typed.
    sort : str
        ``section``, ``kind``, ``item``, ``word``, ``name`` or ``function``.
    detail : str
        One line.
    more : str
        Markdown.
    """

    text: str
    sort: str
    detail: str = ""
    more: str = ""


def complete(reading: Reading, text: str, line: int, column: int) -> tuple[list[Suggestion], int]:
    """Suggest completions at a place of a text.

    Parameters
    ----------
    reading : Reading
        The deck, for the names in use; the line at the place need not follow the grammar.
    text : str
        Text of the file in the editor.
    line, column : int
        Place from 1.

    Returns
    -------
    suggestions : list of Suggestion
        All completions at that place; the editor filters them by the typed text.
    column : int
        Column at which the replaced word begins.
    """
    lines = text.split("\n")
    before = lines[line - 1][: column - 1] if line <= len(lines) else ""
    start = column - len(_match(_LAST, before))
    if without_comment(before) != before:
        return [], start
    typed = _begun(lines[: line - 1]) + before
    if not typed.strip() or (typed.strip().isidentifier() and not typed[-1:].isspace()):
        here = _first(reading, _section(lines[: line - 1]))
    elif _OPEN.fullmatch(re.sub(r""""[^"]*"|'[^']*'""", "", typed)):
        here = []  # within a quoted text
    else:
        here = _within(reading, _section(lines[: line - 1]), typed)
    return list({s.text: s for s in here}.values()), start


def _match(pattern: re.Pattern[str], text: str) -> str:
    match = pattern.search(text)
    return match[0] if match else ""


def _begun(above: list[str]) -> str:
    """Text of the lines above that are continued by the line at the place."""
    begun = ""
    for raw in reversed(above):
        code = without_comment(raw).rstrip()
        if not code.endswith("&"):
            break
        begun = code[:-1] + " " + begun
    return begun


def _section(above: list[str]) -> str:
    """Name of the section that the last of some lines belongs to; empty without one."""
    for raw in reversed(above):
        word = without_comment(raw).split()[:1]
        if word and word[0].upper() in NAMES:
            return word[0].upper()
    return ""


def _first(reading: Reading, section: str) -> list[Suggestion]:
    """Suggestions for the first word of a line."""
    words = _within(reading, section, "") if section else []
    words += [Suggestion(spec.name, "section", spec.title) for spec in (*SECTIONS, *CARDS)]
    return words + [Suggestion(name, "section", f"lines of the family {f}") for name, f in FAMILIES.items()]


def _within(reading: Reading, section: str, typed: str) -> list[Suggestion]:
    """Suggestions within a line: an item, or the value of one."""
    words, current = _pieces(typed)
    card = words[0][1].upper() if words and not words[0][0] else ""
    name, equal, _ = current.partition("=")
    if card == "PARAM":
        return list(_numbers(reading)) if equal else []
    if card in _CARDS:
        section = ""
    elif not section:
        return []
    known = fields(words, section, reading.catalog, reading.params)
    if equal:
        return list(_values(known.known.get(name.upper()), reading))
    if len(words) <= known.kind_at:
        return _kinds(known, reading) if len(words) == known.kind_at and known.family else []
    named = any(name for name, _ in words)
    f = None if named else known.next()
    return [*_values(f, reading), *_items(known, words, reading)]


def _pieces(typed: str) -> tuple[list[tuple[str, str]], str]:
    """Complete items of a partly typed line as (name, value), and the item that is being typed."""
    typed = _TIGHT.sub("=", typed)
    pieces = _PIECE.findall(typed)
    current = pieces.pop() if pieces and not typed[-1:].isspace() else ""
    parted = (piece.partition("=") for piece in pieces)
    return [(name.upper(), value) if equal else ("", name) for name, equal, value in parted], current


def _kinds(known: Fields, reading: Reading) -> list[Suggestion]:
    members = reading.catalog.family(known.family).values()
    return [Suggestion(spec.name, "kind", spec.title, describe(spec)) for spec in members]


def _items(known: Fields, words: Iterable[tuple[str, str]], reading: Reading) -> Iterator[Suggestion]:
    """Suggestions of items that the line does not have yet, required ones first."""
    present = {f.name for f in known.matched if f} | {name for name, _ in words}
    left = [f for f in known.known.values() if f.name not in present]
    for f in sorted(left, key=lambda f: f.default is not REQUIRED):
        unit = f" [{reading.units.text(f.unit)}]" if f.unit else ""
        yield Suggestion(f"{f.name}=", "item", f"{f.doc}{unit}", explain(f, reading.units))


def _values(f: Field | None, reading: Reading) -> Iterator[Suggestion]:
    """Suggestions of values of a field."""
    if f is None:
        return
    for word in f.words if f.kind is not Kind.FLAGS else ():
        yield Suggestion(word, "word", f.doc)
    if f.kind is Kind.FAMILY:
        for spec in reading.catalog.family(f.family).values():
            yield Suggestion(spec.name, "kind", spec.title, describe(spec))
    elif f.kind is Kind.FLAGS:
        yield from (Suggestion(letters, "word", f.doc) for letters in _flags(f.words[0]))
    elif f.kind is Kind.TEXT:
        texts = {name: v for name, v in reading.params.items() if isinstance(v, str)}
        yield from (Suggestion(_written(reading, name), "name", f'"{v}"') for name, v in texts.items())
    elif f.kind in SORTS:
        yield from _names(reading, SORTS[f.kind])
    if f.kind in _NUMBERS:
        yield from _numbers(reading)


def _flags(letters: str) -> Iterator[str]:
    """Every combination of one or more letters."""
    for n in range(1, len(letters) + 1):
        yield from map("".join, combinations(letters, n))


def _names(reading: Reading, sort: str) -> Iterator[Suggestion]:
    """Suggestions of names that the deck defines."""
    defined = (m for m in mentions(reading) if m.defines and m.sort == sort)
    keys = ((key, m) for m in defined for key in m.keys)
    for key, m in islice(keys, MAX_PROPOSALS):
        yield Suggestion(_text(key, m, reading), "name", sort)


def _text(key: int | str, m: Mention, reading: Reading) -> str:
    """Name as the deck writes it."""
    if not m.plain:
        return str(key)
    line = reading.files[m.span.file].split("\n")[m.span.line - 1]
    return line[m.span.column - 1 : m.span.end - 1]


def _numbers(reading: Reading) -> Iterator[Suggestion]:
    """Suggestions of PARAMs and functions."""
    for name, value in reading.params.items():
        shown = f"{value:.10g}" if isinstance(value, float) else f'"{value}"' if value is not None else ""
        yield Suggestion(_written(reading, name), "name", f"PARAM = {shown}")
    for name in FUNCTIONS:
        yield Suggestion(name.lower(), "function", "function")
    yield Suggestion("pi", "function", "3.14159...")


def _written(reading: Reading, name: str) -> str:
    """Name of a PARAM as its definition writes it."""
    d = reading.definitions.get(name)
    if d is None or d.span.file not in reading.files:
        return name
    line = reading.files[d.span.file].split("\n")[d.span.line - 1]
    return line[d.span.column - 1 : d.span.end - 1]
