"""Diagnostics: mistake, place and remedy; their format with the source line underlined.

The numbers of diagnostics are those of `pound_deck.messages`.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from itertools import islice
from typing import Final, Literal

from pound_deck.model import Span

_MANY_CHOICES, _MOST_CHOICES = 50, 500  #: to be looked through for the one that was meant
SHORT, FEW = 3, 4  #: letters of a short word, and most names suggested for one
_WIDTH: Final = 160  #: most characters of a source line in print


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One message to the user: its number (see `messages`), text, and place (None: the whole deck)."""

    code: str
    message: str
    span: Span | None
    hint: str = ""
    severity: Literal["error", "warning"] = "error"


class Mistake(Exception):
    """Raised to end the reading of an item; holds a Diagnostic, or None where one is already reported."""

    def __init__(self, diagnostic: Diagnostic | None = None) -> None:
        super().__init__(diagnostic.message if diagnostic else "already reported")
        self.diagnostic = diagnostic

    def keep(self, report: list[Diagnostic]) -> None:
        """Add the diagnostic, if there is one, to a report."""
        if self.diagnostic:
            report.append(self.diagnostic)


def mistake(code: str, message: str, span: Span, hint: str = "") -> Mistake:
    """Make a Mistake with a new Diagnostic."""
    return Mistake(Diagnostic(code, message, span, hint))


def has_errors(diagnostics: Iterable[Diagnostic]) -> bool:
    """Whether any of them is an error."""
    return any(d.severity == "error" for d in diagnostics)


def unsuppressed(diagnostics: Iterable[Diagnostic], meant: Container[str]) -> list[Diagnostic]:
    """Diagnostics without the warnings suppressed by MEANT."""
    return [d for d in diagnostics if d.severity == "error" or d.code not in meant]


def closest(word: str, choices: Iterable[str], cutoff: float = 0.6) -> str:
    """Choice most similar to a misspelt word, ignoring case; empty where none is similar."""
    known = {choice.upper(): choice for choice in islice(choices, _MOST_CHOICES)}
    word = word.upper()[:100]
    if len(known) > _MANY_CHOICES:  # a slip seldom changes both ends; comparing all is slow
        known = {k: c for k, c in known.items() if k[:1] == word[:1] or k[-1:] == word[-1:]}
    close = get_close_matches(word, known, n=1, cutoff=cutoff)
    return known[close[0]] if close else ""


def suggest(word: str, choices: Iterable[str]) -> str:
    """Hint ``did you mean X?`` with the closest choice, or for short words all of the same first letter
    and length; empty where there are none, or too many.
    """
    known = list(islice(choices, _MOST_CHOICES))
    near = closest(word, known)
    if not near and len(word) <= SHORT:
        alike = [x for x in known if x[:1] == word[:1].upper() and len(x) == len(word)]
        near = " or ".join(alike) if len(alike) <= FEW else ""
    return f"did you mean {near}?" if near else ""


def hints(*parts: str) -> str:
    """Join the parts that are not empty."""
    return "; ".join(part for part in parts if part).replace("?; ", "? ")


def caret(diagnostic: Diagnostic, files: Mapping[str, str]) -> str:
    """Format a diagnostic with its source line, its place underlined.

    Parameters
    ----------
    diagnostic : Diagnostic
    files : mapping of str to str
        Text of each file by its name in spans.

    Returns
    -------
    str
        One to four lines without a final line end.
    """
    span = diagnostic.span
    place = f"{span}: " if span else ""
    printed = [f"{place}{diagnostic.severity} {diagnostic.code}: {diagnostic.message}"]
    if span and span.file in files:
        lines = files[span.file].split("\n")
        if span.line <= len(lines):
            printed += _underlined(lines[span.line - 1], span)
    if diagnostic.hint:
        printed.append(f"  hint: {diagnostic.hint}")
    return "\n".join(printed)


def _underlined(line: str, span: Span) -> list[str]:
    start = max(0, span.column - 1 - _WIDTH // 2) if len(line) > _WIDTH else 0
    column = span.column - 1 - start
    # control characters could move the cursor, and then the caret would point elsewhere
    shown = "".join(c if c.isprintable() or c == "\t" else "?" for c in line[start : start + _WIDTH])
    blanks = "".join("\t" if c == "\t" else " " for c in shown[:column]).ljust(column)
    length = max(1, min(span.end - span.column, len(shown) - column))
    return [shown, blanks + "^" + "~" * (length - 1)] if shown.strip() else []


def render(diagnostics: Sequence[Diagnostic], files: Mapping[str, str], limit: int = 50) -> str:
    """Format up to `limit` diagnostics, errors before warnings, and how many more there are."""
    ordered = sorted(
        diagnostics, key=lambda d: d.severity != "error"
    )  # stable: the deck's order within each
    blocks = [caret(d, files) for d in ordered[:limit]]
    if len(ordered) > limit:
        blocks.append(f"and {len(ordered) - limit} more")
    return "\n".join(blocks)
