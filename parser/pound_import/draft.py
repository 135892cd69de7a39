"""Draft of the new deck: its lines, the basis of each, and the mistakes of the model that is read."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Final

from pound_deck.diagnostics import Diagnostic, Mistake
from pound_deck.model import Span

#: of the new deck, in order; lines of the first belong to no section
ORDER: Final = (
    "",
    "NODES",
    "DRIFT",
    "ELEMENTS",
    "PROPS",
    "WEIGHTS",
    "LOADS",
    "MEMBER_LOADS",
    "INITIAL",
    "DAMPING",
    "FORCES",
    "EQUAKE",
    "ANALYSIS",
    "OUTPUT",
)
CONVENTION: Final = "BY CONVENTION"  #: mark in the new deck of items that no source confirms


@dataclass(frozen=True, slots=True)
class DraftLine:
    """A line of the new deck, its comments, and the place that it comes from."""

    text: str
    span: Span
    notes: tuple[str, ...] = ()


@dataclass(slots=True)
class Draft:
    """Lines of the new deck by section, and the diagnostics about them.

    Attributes
    ----------
    check : str
        Where the user can confirm what is read by convention.
    report : list of Diagnostic
        Mistakes; readings by convention and losses are warnings.
    evidence : list of str
        Items that decks of others confirm.
    """

    check: str
    report: list[Diagnostic] = field(default_factory=list)
    sections: dict[str, list[DraftLine]] = field(default_factory=lambda: {name: [] for name in ORDER})
    evidence: list[str] = field(default_factory=list)

    def add(self, section: str, text: str, span: Span, notes: Iterable[str] = ()) -> None:
        """Add a line."""
        self.sections[section].append(DraftLine(text, span, tuple(notes)))

    def doubt(self, span: Span, reading: str) -> str:
        """Warn that an item is read by convention; return the comment that marks it."""
        self.report.append(Diagnostic("L605", f"by convention, {reading}", span, self.check, "warning"))
        return f"{CONVENTION}: {reading}"

    def lose(self, span: Span, what: str, remedy: str = "add it to the new deck by hand") -> str:
        """Warn that something is not carried over; return the comment that marks it."""
        self.report.append(Diagnostic("L609", f"not carried over: {what}", span, remedy, "warning"))
        return f"NOT CARRIED OVER: {what}"

    @contextmanager
    def keeping(self) -> Iterator[None]:
        """Add the Mistake that ends the block to the report."""
        try:
            yield
        except Mistake as mistake:
            mistake.keep(self.report)

    def rest(self, reading: str) -> None:
        """Record that decks of others confirm a reading."""
        if reading not in self.evidence:
            self.evidence.append(reading)


def number(value: float) -> str:
    """Number as a deck writes it, with all its digits."""
    return str(int(value)) if value == int(value) and abs(value) < 1e15 else repr(value)


def numbers(values: Iterable[float]) -> str:
    """Values of one item as a deck writes them, joined by commas."""
    return ",".join(map(number, values))


def quoted(text: str) -> str:
    """Text in quotes, of the kind that it does not contain."""
    bare = "".join(c for c in text if c.isprintable())
    return f'"{bare}"' if '"' not in bare else "'" + bare.replace("'", " ") + "'"
