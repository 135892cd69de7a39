"""The deck of this program that a reader has made of another program's model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Span
from pound_import.draft import CONVENTION, ORDER, Draft


@dataclass(frozen=True, slots=True)
class Translation:
    """A model that was read.

    Attributes
    ----------
    text : str
        The new deck, empty where the model has mistakes.
    origins : tuple of Span or None
        For each line of `text`, from the first, its line in the file that was read.
    report : tuple of Diagnostic
        Mistakes, what was read by convention, what was not carried over, with spans in the files read.
    """

    text: str
    origins: tuple[Span | None, ...]
    report: tuple[Diagnostic, ...]

    def moved(self, diagnostics: Sequence[Diagnostic], name: str) -> list[Diagnostic]:
        """Diagnostics of the new deck, called `name`, moved to the lines that were read."""
        return [
            replace(d, span=self._origin(d.span)) if d.span and d.span.file == name else d
            for d in diagnostics
        ]

    def _origin(self, span: Span) -> Span:
        return next((place for place in reversed(self.origins[: span.line]) if place), span)


def written(title: str, source: str, draft: Draft) -> Translation:
    """Write the new deck.

    Parameters
    ----------
    title : str
    source : str
        Sentence that says what the deck was read from.
    draft : Draft
        Without errors in its report.

    Returns
    -------
    Translation
    """
    lines: list[tuple[str, Span | None]] = [
        (f"TITLE {_plain(title)}", None),
        (f"! {_plain(source)}", None),
        (f"! No source confirms what is marked {CONVENTION}: compare it with a manual or a listing.", None),
    ]
    for section in ORDER:
        entries = draft.sections[section]
        if not entries:
            continue
        lines += [("", None), *([(section, None)] if section else [])]
        for entry in entries:
            lines += [(f"   ! {_plain(note)}", entry.span) for note in entry.notes]
            if entry.text:
                lines.append((f"   {entry.text}" if section else entry.text, entry.span))
    return Translation(
        "\n".join(text for text, _ in lines) + "\n", tuple(span for _, span in lines), tuple(draft.report)
    )


def _plain(text: str) -> str:
    """Text without line ends and other characters that cannot be printed."""
    return "".join(c for c in text if c.isprintable())
