"""What may follow: sections, kinds, items, their values, and the names in use."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain, combinations, islice
from typing import Final

from pound_deck.expressions import FUNCTIONS
from pound_deck.schema import REQUIRED, Field, Kind
from pound_deck.sections import CARDS, FAMILIES, NAMES, SECTIONS
from pound_deck.source import without_comment
from pound_solve.editor.fields import Fields, fields
from pound_solve.editor.hover import describe, explain
from pound_solve.editor.names import Mention, mentions
from pound_solve.editor.reading import Reading

MOST: Final = 1000  #: nodes or elements
_PIECE: Final = re.compile(r"""(?:"[^"]*"?|'[^']*'?|[^\s"'])+""")
_TIGHT: Final = re.compile(r"\s*=\s*")
_OPEN: Final = re.compile(r"""[^"']*("[^"]*|'[^']*)$""")
_LAST: Final = re.compile(r"[A-Za-z0-9_.]*$")


@dataclass(frozen=True, slots=True)
class Suggestion:
    """What may stand at the place.

    Attributes
    ----------
    text : str
        To be inserted in place of the word that is begun.
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
    """What may stand at a place of a text.

    Parameters
    ----------
    reading : Reading
        The deck, for the names in use; the line at the place need not follow the grammar.
    text : str
        The file as the editor holds it.
    line, column : int
        Place from 1.

    Returns
    -------
    suggestions : list of Suggestion
        All that may stand there; the editor narrows them down by what is typed.
    column : int
        Where the word begins that they replace.
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
        here = []  # within a text
    else:
        here = _within(reading, _section(lines[: line - 1]), typed)
    return list({s.text: s for s in here}.values()), start


def _match(pattern: re.Pattern[str], text: str) -> str:
    found = pattern.search(text)
    return found[0] if found else ""


def _begun(above: list[str]) -> str:
    """Lines above that go on in the next one."""
    out = ""
    for raw in reversed(above):
        code = without_comment(raw).rstrip()
        if not code.endswith("&"):
            break
        out = code[:-1] + " " + out
    return out


def _section(above: list[str]) -> str:
    """Name of the section that lines stand in."""
    for raw in reversed(above):
        word = without_comment(raw).split()[:1]
        if word and word[0].upper() in NAMES:
            return word[0].upper()
    return ""


def _first(reading: Reading, section: str) -> list[Suggestion]:
    """A line's first word."""
    out = _within(reading, section, "") if section else []
    out += [Suggestion(spec.name, "section", spec.title) for spec in (*SECTIONS, *CARDS)]
    return out + [Suggestion(name, "section", f"lines of the family {f}") for name, f in FAMILIES.items()]


def _within(reading: Reading, section: str, typed: str) -> list[Suggestion]:
    """An item of a line, or its value."""
    typed = _TIGHT.sub("=", typed)
    pieces = _PIECE.findall(typed)
    current = pieces.pop() if pieces and not typed[-1:].isspace() else ""
    words = [
        (name.upper(), value) if eq else ("", name)
        for name, eq, value in (p.partition("=") for p in pieces)
    ]
    card = words[0][1].upper() if words and not words[0][0] else ""
    if card == "PARAM":
        return list(_numbers(reading)) if "=" in current or typed.rstrip().endswith("=") else []
    if any(card == spec.name for spec in CARDS):
        section = ""
    elif not section:
        return []
    known = fields([*words], section, reading.catalog, reading.params)
    name, equal, _ = current.partition("=")
    if equal:
        f = known.known.get(name.upper())
        return list(_values(f, reading)) if f else list(_numbers(reading))
    if len(words) <= known.kind_at:
        return _kinds(known, reading) if len(words) == known.kind_at and known.family else []
    named = any(name for name, _ in words)
    f = None if named else known.next()
    return [*(_values(f, reading) if f else ()), *_items(known, words, reading)]


def _kinds(known: Fields, reading: Reading) -> list[Suggestion]:
    members = reading.catalog.family(known.family).values()
    return [Suggestion(spec.name, "kind", spec.title, describe(spec)) for spec in members]


def _items(known: Fields, words: Iterable[tuple[str, str]], reading: Reading) -> Iterator[Suggestion]:
    """Items that are not there yet, those that must be first."""
    given = {f.name for f in known.matched if f} | {name for name, _ in words}
    left = [f for f in known.known.values() if f.name not in given]
    for f in sorted(left, key=lambda f: f.default is not REQUIRED):
        unit = f" [{reading.units.text(f.unit)}]" if f.unit else ""
        yield Suggestion(f"{f.name}=", "item", f"{f.doc}{unit}", explain(f, reading.units))


def _values(f: Field, reading: Reading) -> Iterator[Suggestion]:
    """Values of a field."""
    for word in f.words if f.kind is not Kind.FLAGS else ():
        yield Suggestion(word, "word", f.doc)
    match f.kind:
        case Kind.FAMILY:
            for spec in reading.catalog.family(f.family).values():
                yield Suggestion(spec.name, "kind", spec.title, describe(spec))
        case Kind.FLAGS:
            letters = f.words[0]
            sets = chain.from_iterable(combinations(letters, n) for n in range(1, len(letters) + 1))
            yield from (Suggestion("".join(some), "word", f.doc) for some in sets)
        case Kind.NODE | Kind.NODES:
            yield from _names(reading, "node")
        case Kind.ELEMENTS:
            yield from _names(reading, "element")
        case Kind.PROP | Kind.PROPS:
            yield from _names(reading, "property set")
        case Kind.TEXT:
            texts = {name: v for name, v in reading.params.items() if isinstance(v, str)}
            yield from (Suggestion(_written(reading, name), "name", f'"{v}"') for name, v in texts.items())
    if f.kind in (Kind.REAL, Kind.INT, Kind.NODE, Kind.NODES, Kind.ELEMENTS):
        yield from _numbers(reading)


def _names(reading: Reading, sort: str) -> Iterator[Suggestion]:
    """Names that the deck defines."""
    found = (m for m in mentions(reading) if m.defines and m.sort == sort)
    keys = ((key, m) for m in found for key in m.keys)
    for key, m in islice(keys, MOST):
        yield Suggestion(_text(key, m, reading), "name", sort)


def _text(key: int | str, m: Mention, reading: Reading) -> str:
    """A name as the deck writes it."""
    if not m.plain:
        return str(key)
    line = reading.files[m.span.file].split("\n")[m.span.line - 1]
    return line[m.span.column - 1 : m.span.end - 1]


def _numbers(reading: Reading) -> Iterator[Suggestion]:
    """PARAMs and functions."""
    for name, value in reading.params.items():
        shown = f"{value:.10g}" if isinstance(value, float) else f'"{value}"' if value is not None else ""
        yield Suggestion(_written(reading, name), "name", f"PARAM = {shown}")
    for name in FUNCTIONS:
        yield Suggestion(name.lower(), "function", "function")
    yield Suggestion("pi", "function", "3.14159...")


def _written(reading: Reading, name: str) -> str:
    """Name of a PARAM as its definition has it."""
    d = reading.definitions.get(name)
    if d is None or d.span.file not in reading.files:
        return name
    line = reading.files[d.span.file].split("\n")[d.span.line - 1]
    return line[d.span.column - 1 : d.span.end - 1]
