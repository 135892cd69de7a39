"""Tables of a model: rows of ``Key=Value``, values of several words in quotes, `` _`` at the end of a line
that goes on in the next one.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Final

from pound_deck.diagnostics import Diagnostic, mistake
from pound_deck.model import Span

_HEAD: Final = re.compile(r'\s*TABLE\s*:\s*"?([^"]*?)"?\s*', re.I)
_END: Final = re.compile(r"\s*END\s+TABLE\s+DATA\s*", re.I)
_ITEM: Final = re.compile(r'([^\s="]+)=(?:"((?:[^"]|"")*)"|([^\s"]*))(?=\s|$)')
_WORD: Final = re.compile(r"\S+")
_NUMBER: Final = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[Ee][+-]?\d+)?")
MOST: Final = 1e30  #: magnitude of a number
_ONWARD: Final = "_"  #: last item of a line that goes on in the next one


@dataclass(frozen=True, slots=True)
class SapItem:
    """A value, and the place of its item."""

    text: str
    span: Span


@dataclass(frozen=True, slots=True)
class SapRow:
    """A row: its items by key in capitals, and its place."""

    table: str
    items: Mapping[str, SapItem]
    span: Span

    def has(self, key: str) -> bool:
        """Whether the row gives a value."""
        return bool(self.get(key))

    def get(self, key: str, default: str = "") -> str:
        """Value as text, or `default` where the row has none."""
        item = self.items.get(key.upper())
        return item.text if item and item.text else default

    def word(self, key: str, default: str = "") -> str:
        """Value in capitals, or `default`."""
        return self.get(key, default).upper()

    def text(self, key: str) -> str:
        """Value as text.

        Raises
        ------
        Mistake
            The row has none.
        """
        if not self.has(key):
            text = f"{self.table}: the row has no {key}"
            raise mistake("L642", text, self.span, f"write {key}=...")
        return self.get(key)

    def real(self, key: str, default: float | None = None) -> float:
        """Value as a number, or `default`.

        Raises
        ------
        Mistake
            The row has none and there is no default, or it is no number of a usual magnitude.
        """
        if default is not None and not self.has(key):
            return default
        text, place = self.text(key), self.place(key)
        if not _NUMBER.fullmatch(text):
            raise mistake("L643", f"{key} is {text[:40]!r}, not a number", place, "such as 0.5 or 1E-3")
        value = float(text)
        if value and not 1.0 / MOST <= abs(value) <= MOST:
            what = f"{key} is {text[:40]}: its magnitude is not within {1.0 / MOST:g} and {MOST:g}"
            raise mistake("L643", what, place, "check the units")
        return value

    def count(self, key: str, default: int, most: int) -> int:
        """Value as a whole number from 0 to `most`, or `default`.

        Raises
        ------
        Mistake
            It is none.
        """
        value = self.real(key, default)
        if value != int(value) or not 0 <= value <= most:
            what = f"{key} is {self.get(key)[:40]}, not a whole number from 0 to {most}"
            raise mistake("L643", what, self.place(key), "check the row")
        return int(value)

    def yes(self, key: str, default: bool = False) -> bool:
        """Value of a switch, or `default`.

        Raises
        ------
        Mistake
            It is neither Yes nor No.
        """
        word = self.word(key, "YES" if default else "NO")
        if word not in ("YES", "NO"):
            raise mistake("L643", f"{key} is {word[:40]}", self.place(key), "Yes or No")
        return word == "YES"

    def key(self, *names: str) -> str:
        """First of the names that the row gives: versions of the program differ in them."""
        return next((name for name in names if self.has(name)), names[0])

    def place(self, key: str) -> Span:
        """Place of an item, or of the row where it has none."""
        item = self.items.get(key.upper())
        return item.span if item else self.span


@dataclass(slots=True)
class SapTables:
    """Tables by name in capitals.

    Attributes
    ----------
    heads : dict of str to Span
        Places of all tables that hold a line.
    """

    file: str
    rows: dict[str, list[SapRow]] = field(default_factory=dict)
    heads: dict[str, Span] = field(default_factory=dict)

    def __getitem__(self, name: str) -> list[SapRow]:
        return self.rows.get(name, [])

    @property
    def here(self) -> Span:
        """Place of messages about the whole file."""
        return Span(self.file, 1, 1, 2)


def read(file: str, text: str, wanted: Collection[str], report: list[Diagnostic]) -> SapTables:
    """Read the tables whose names are `wanted`; of the others only their places.

    Parameters
    ----------
    file : str
        Name in places of messages.
    text : str
    wanted : collection of str
    report : list of Diagnostic
        Takes the mistakes.
    """
    tables, name, items = SapTables(file), "", dict[str, SapItem]()
    for number, line in enumerate(text.splitlines(), 1):
        if head := _HEAD.fullmatch(line):
            name, items = head[1].upper(), {}
            continue
        if _END.fullmatch(line):
            break
        if not name or not line.strip():
            continue
        tables.heads.setdefault(name, Span(file, number, 1, len(line) + 1))
        if name not in wanted:
            continue
        if not items:
            row = SapRow(name, items, _span(file, number, line))
            tables.rows.setdefault(name, []).append(row)
        items = items if _scan(file, number, line, items, report) else {}
    return tables


def _scan(file: str, number: int, line: str, items: dict[str, SapItem], report: list[Diagnostic]) -> bool:
    """Add the items of a line; return whether its row goes on in the next one."""
    at, onward = 0, False
    while word := _WORD.search(line, at):
        at, onward = word.end(), word[0] == _ONWARD
        if onward:
            continue
        match = _ITEM.match(line, word.start())
        end = match.end() if match else at
        span = Span(file, number, word.start() + 1, end + 1)
        if not match:
            what = f"{word[0][:40]!r} is not Key=Value"
            report.append(Diagnostic("L641", what, span, "put a value of several words in quotes"))
            continue
        at, key = end, match[1].upper()
        if key in items:
            what = f"{match[1][:40]} is given twice in a row"
            report.append(Diagnostic("L641", what, span, "keep one of them"))
            continue
        quoted = match[2]
        items[key] = SapItem(match[3] if quoted is None else quoted.replace('""', '"').strip(), span)
    return onward and bool(items)


def _span(file: str, number: int, line: str) -> Span:
    return Span(file, number, len(line) - len(line.lstrip()) + 1, len(line.rstrip()) + 1)
