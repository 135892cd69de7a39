"""The text of a deck with other values of its PARAMs."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping

from pound_deck.cards import parse
from pound_deck.expressions import Expression
from pound_deck.model import Span
from pound_deck.source import INCLUDE, DeckSource, is_end, without_comment


def with_params(path: str, values: Mapping[str, str]) -> str:
    """Text of a deck with other values of PARAMs; all else of it, comments too, stays.

    If an included file defines one of them, all included files are written into the text.

    Parameters
    ----------
    path : str
        File of a deck without mistakes.
    values : mapping of str to str
        Values by name, in any case.

    Raises
    ------
    OSError
        The deck cannot be read.
    """
    source = DeckSource()
    texts = {name.upper(): text for name, text in values.items()}
    edits: dict[Span, str] = {}
    for row in parse(source.read(path), []):
        for item in row.items or () if row.word == "PARAM" else ():
            value = item.parts[0] if item.parts else None
            if item.name.upper() in texts and isinstance(value, Expression):
                edits[value.span] = texts[item.name.upper()]
    lines = {name: text.split("\n") for name, text in source.files.items()}
    for span, text in sorted(edits.items(), key=lambda e: (e[0].line, e[0].column), reverse=True):
        line = lines[span.file][span.line - 1]
        lines[span.file][span.line - 1] = line[: span.column - 1] + text + line[span.end - 1 :]
    if {span.file for span in edits} <= {path}:
        return "\n".join(lines[path])
    return "\n".join(_whole(path, lines)).rstrip("\n") + "\n"


def _whole(name: str, lines: Mapping[str, list[str]]) -> Iterator[str]:
    """Yield the lines of a file, those of included files in the place of their INCLUDE."""
    for raw in lines[name]:
        code = without_comment(raw)
        include = INCLUDE.match(code)
        if is_end(code):
            return
        if include:
            inner = os.path.join(os.path.dirname(name), include[1].strip().strip("\"'"))
            yield from _whole(inner, lines)
        else:
            yield raw
