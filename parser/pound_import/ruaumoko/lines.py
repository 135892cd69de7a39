"""Data lines of an old deck: blanks separate the items, ``!`` starts a comment, blank lines are skipped."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from pound_deck.diagnostics import Mistake, mistake
from pound_deck.model import Span
from pound_deck.source import without_comment

_ITEM: Final = re.compile(r"""'[^']*'|"[^"]*"|[^\s,]+""")
_NUMBER: Final = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][+-]?\d+)?")
MOST: Final = 1e30  #: magnitude of a number
MOST_ITEMS: Final = 200  #: most items of a line


@dataclass(frozen=True, slots=True)
class DataItem:
    """One item, its place, and its number in the line, from 1 on."""

    text: str
    span: Span
    number: int

    @property
    def numeric(self) -> bool:
        """Whether it is a number."""
        return is_number(self.text)

    def mistake(self, code: str, name: str, what: str, hint: str) -> Mistake:
        """Make a Mistake about the item called `name`; `what` begins with a verb."""
        return mistake(code, f"{name}, item {self.number} of the line, {what}", self.span, hint)

    def real(self, name: str) -> float:
        """Value of the item called `name`.

        Raises
        ------
        Mistake
            It is no number, or beyond all magnitudes.
        """
        if not self.numeric:
            raise self.mistake("L603", name, f"is {self.text[:40]!r}, not a number", "write a number")
        value = float(self.text.translate(_D_EXPONENT))
        if value == 0.0 or 1.0 / MOST <= abs(value) <= MOST:
            return value
        what = f"is {self.text[:40]}: its magnitude is not within {1.0 / MOST:g} and {MOST:g}"
        raise self.mistake("L603", name, what, "check the columns")

    def whole(self, name: str) -> int:
        """Value of an item as a whole number; ``1.0`` is one, too.

        Raises
        ------
        Mistake
            It is no whole number.
        """
        value = self.real(name)
        if value != round(value) or abs(value) > 1e9:
            what = f"is {self.text[:40]}, not a whole number"
            raise self.mistake("L603", name, what, "check the columns")
        return int(value)


_D_EXPONENT: Final = str.maketrans("Dd", "EE")


def is_number(text: str) -> bool:
    """Whether a text is one number, with an exponent of E or D."""
    return _NUMBER.fullmatch(text) is not None


@dataclass(frozen=True, slots=True)
class DataLine:
    """A data line: its items and its place."""

    items: tuple[DataItem, ...]
    span: Span

    @property
    def word(self) -> str:
        """First item in capitals; empty where it is a number."""
        first = self.items[0]
        return "" if first.numeric else first.text.upper()

    def item(self, k: int) -> DataItem:
        """Item by position; a zero where the line is shorter."""
        return self.items[k] if k < len(self.items) else DataItem("0", self.span, k + 1)

    def reals(self, names: Sequence[str], least: int = 0) -> list[float]:
        """Values of the items called `names`; those left out at the end are zero.

        Raises
        ------
        Mistake
            The line has fewer items than `least`, or one is no number.
        """
        self.need(names, least)
        return [self.item(k).real(name) for k, name in enumerate(names)]

    def wholes(self, names: Sequence[str], least: int = 0) -> list[int]:
        """Values as of `reals`, as whole numbers."""
        self.need(names, least)
        return [self.item(k).whole(name) for k, name in enumerate(names)]

    def need(self, names: Sequence[str], least: int) -> None:
        """Raise a Mistake where the line has fewer items than `least`."""
        if len(self.items) < least:
            missing = ", ".join(names[len(self.items) : least])
            what = f"the line holds {len(self.items)} of at least {least} items: {missing} missing"
            raise mistake("L602", what, self.span, f"the line is {' '.join(names)}")


def row(file: str, number: int, raw: str) -> DataLine | None:
    """Parse a physical line as a data line; None where it has no data."""
    code = without_comment(raw)
    if not code or code.isspace():
        return None
    items: list[DataItem] = []
    for match in _ITEM.finditer(code):
        place = Span(file, number, match.start() + 1, match.end() + 1)
        items.append(DataItem(match[0], place, len(items) + 1))
        if len(items) == MOST_ITEMS:
            break
    if not items:
        return None
    return DataLine(tuple(items), Span(file, number, items[0].span.column, items[-1].span.end))


class DataLines:
    """The data lines of a section, read in sequence.

    Parameters
    ----------
    rows : sequence of DataLine
    here : Span
        Place of the section's head, for messages about missing lines.
    """

    def __init__(self, rows: Sequence[DataLine], here: Span) -> None:
        self.rows, self.here, self.at = list(rows), here, 0

    def __iter__(self) -> Iterator[DataLine]:
        while self.more:
            yield self.next("a line")

    @property
    def more(self) -> bool:
        """Whether there is another line."""
        return self.at < len(self.rows)

    def peek(self) -> DataLine:
        """Return the next line without taking it."""
        return self.rows[self.at]

    def next(self, what: str) -> DataLine:
        """Take and return the next line.

        Raises
        ------
        Mistake
            The section ends before it.
        """
        if not self.more:
            raise mistake(
                "L602", f"the section ends before {what}", self.here, "add the lines that are missing"
            )
        row = self.rows[self.at]
        self.here, self.at = row.span, self.at + 1
        return row
