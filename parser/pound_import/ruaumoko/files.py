"""Old decks as files: their text, and whether one is such a deck."""

from __future__ import annotations

from typing import Final

from pound_deck.diagnostics import Diagnostic, Mistake
from pound_deck.files import opened
from pound_deck.model import Span
from pound_import.ruaumoko.recognise import HEAD, is_legacy

MAX_BYTES: Final = 256_000_000  #: of a deck with its record


def text_of(name: str) -> str:
    """Text of a file, its line ends ``\\n``.

    Raises
    ------
    OSError
        It cannot be read.
    Mistake
        It is too large.
    """
    with opened(name) as stream:
        data = stream.read(MAX_BYTES + 1)
    if len(data) > MAX_BYTES:
        raise Mistake(
            Diagnostic("L612", f"{name} exceeds 256 MB", Span(name, 1, 1, 2), "part deck and record")
        )
    return "\n".join(_decoded(data).splitlines())


def recognised(name: str) -> bool:
    """Whether a file is an old deck, judged by its first lines.

    Raises
    ------
    OSError
        It cannot be read.
    """
    with opened(name) as stream:
        return is_legacy(_decoded(stream.read(HEAD)))


def _decoded(data: bytes) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")
