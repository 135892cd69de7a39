"""Rename nodes, elements, property sets and PARAMs without a change of the deck's meaning."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from pound_deck.expressions import RESERVED
from pound_deck.model import Span
from pound_solve.editor.names import Mention, at, definitions, mentions
from pound_solve.editor.reading import Reading, read

Edits = list[tuple[Span, str]]

_KEYWORDS: Final = ("TO", "BY")  #: of ranges; labels of these names need quotes
_WORD: Final = re.compile(r"[A-Za-z_][A-Za-z0-9_.]*")


class RenameError(Exception):
    """Raised if a name cannot be changed as requested; the text states why."""


def renamable(reading: Reading, place: Span) -> Span | None:
    """Span of the name at a place; None without a replaceable name."""
    here = at(mentions(reading), place)
    return here.span if here and here.plain else None


def rename(reading: Reading, path: str, place: Span, new: str) -> Edits:
    """Edits that rename all mentions of the name at a place.

    Parameters
    ----------
    reading : Reading
        The deck.
    path : str
        Its file.
    place : Span
        Place of the name.
    new : str
        New name.

    Raises
    ------
    RenameError
        The name is not replaceable everywhere, the new name is in use or invalid, or the meaning of the
        deck would change.
    """
    mentioned = mentions(reading)
    same = _same(reading, mentioned, place)
    here = same[0]
    text, key = _checked(new, here)
    if any(m.sort == here.sort and key in m.keys for m in mentioned):
        raise RenameError(f"there is a {here.sort} {key} already")
    edits = [(m.span, text) for m in same]
    _verify(reading, path, mentioned, same, key, edits)
    return edits


def _same(reading: Reading, all_mentions: Sequence[Mention], place: Span) -> list[Mention]:
    """All mentions of the name at a place; raise RenameError where one cannot be replaced."""
    unread = next((row for _, row in reading.rows if row.items is None), None)
    if unread:
        raise RenameError(f"line {unread.span.line} of {unread.span.file} has a mistake of syntax")
    here = at(all_mentions, place)
    if here is None or not here.plain:
        raise RenameError("no name of a node, element, property set or PARAM stands here")
    if not definitions(all_mentions, here):
        raise RenameError(f"{here.sort} {here.key} is not defined")
    same = [m for m in all_mentions if m.sort == here.sort and here.key in m.keys]
    for m in same:
        if not m.plain:
            raise RenameError(f"an expression or a range names it, too: {m.span}")
    return same


def applied(files: Mapping[str, str], edits: Iterable[tuple[Span, str]]) -> dict[str, str]:
    """Apply edits to texts, each within one line."""
    lines = {name: text.split("\n") for name, text in files.items()}
    for span, text in sorted(set(edits), key=lambda e: (e[0].line, e[0].column), reverse=True):
        line = lines[span.file][span.line - 1]
        lines[span.file][span.line - 1] = line[: span.column - 1] + text + line[span.end - 1 :]
    return {name: "\n".join(texts) for name, texts in lines.items()}


def _checked(new: str, here: Mention) -> tuple[str, int | str]:
    """New name as text to write, and as a key of mentions; raise RenameError where it is not valid."""
    new = new.strip()
    if here.sort in ("node", "element"):
        if new.isascii() and new.isdecimal() and 0 < int(new[:20]) < 10**15:
            return new, int(new)
        raise RenameError("a number from 1 on is needed")
    if here.sort == "property set":
        return _label(new), new.upper()
    if _WORD.fullmatch(new) and new.upper() not in RESERVED:
        return new, new.upper()
    raise RenameError(f"{new[:60]} is no name for a PARAM: a word that starts with a letter is needed")


def _label(new: str) -> str:
    """Label of a property set as a deck writes it, in quotes if needed."""
    word = _WORD.fullmatch(new) and new.upper() not in _KEYWORDS
    if word or (new.isascii() and new.isdecimal()):
        return new
    if new and not set(new) & set("\"'\n\r!"):
        return f'"{new}"'
    raise RenameError(f"{new[:60]} is no name for a property set: a word, a number or a text is needed")


def _verify(
    reading: Reading,
    path: str,
    before: Sequence[Mention],
    same: Sequence[Mention],
    key: int | str,
    edits: Edits,
) -> None:
    """Read the edited deck; raise RenameError where its mentions change by more than the new name."""
    texts = applied(reading.files, edits)
    unsaved = {os.path.realpath(name): text for name, text in texts.items()}
    after = mentions(read(path, reading.catalog, unsaved))
    renamed = set(map(id, same))
    expected = [(m.sort, (key,) if id(m) in renamed else m.keys, m.defines) for m in before]
    if [(m.sort, m.keys, m.defines) for m in after] != expected:
        raise RenameError("with that name the deck would mean something else")
