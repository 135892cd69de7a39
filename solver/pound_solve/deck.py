"""A deck without a file: its text, or its sections as a dictionary."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Integral, Real
from pathlib import PurePath
from typing import Any, Final, Self

PLACE: Final = "<text>"  #: name of a deck without a file in messages


@dataclass(frozen=True, slots=True)
class Deck:
    """The text of a deck, for `pound_solve.run`.

    Paths of INCLUDE and of records are relative to the working folder.

    Parameters
    ----------
    text : str
        Lines of the deck.
    name : str
        Stem of the names of its report and its results file.
    """

    text: str
    name: str = "deck"

    @classmethod
    def from_text(cls, text: str, name: str = "deck") -> Self:
        """Make a deck from a text; messages give its lines and columns under ``<text>``."""
        return cls(text, name)

    @classmethod
    def from_sections(cls, sections: Mapping[str, Any], name: str = "deck") -> Self:
        """Make a deck from a dictionary.

        Parameters
        ----------
        sections : mapping of str to object
            Sections and single cards by name, in the order of the deck.  A text or a number follows the
            name on its line: ``{"TITLE": "Two frames"}``.  A mapping gives named items there:
            ``{"PARAM": {"gap": 0.02}}``.  A list contains the lines of a section; each line is a text or a
            list of items, in which a mapping gives the named ones:
            ``{"NODES": [(1, 0, 0, {"FIX": "XYR"}), "2 0 3"]}``.
        name : str
            Stem of the names of its report and its results file.

        Raises
        ------
        TypeError
            A value is not a text, number, list or mapping.
        """
        lines: list[str] = []
        for head, content in sections.items():
            if isinstance(content, list | tuple):
                lines += [head, *("  " + _line(row) for row in content)]
            else:
                lines.append(f"{head} {_line(content)}")
        return cls("\n".join(lines) + "\n", name)


def _line(content: object) -> str:
    """Text of one line of a deck from one item, a list of items, or a mapping of named ones."""
    if isinstance(content, Mapping):
        return " ".join(f"{key}={_item(value)}" for key, value in content.items())
    if isinstance(content, list | tuple):
        return "  ".join(_line(item) if isinstance(item, Mapping) else _item(item) for item in content)
    return _item(content)


def _item(value: object) -> str:
    """Value in deck syntax: several joined by commas, a path in quotes."""
    if isinstance(value, str):
        return value
    if isinstance(value, PurePath):
        return f'"{value}"'
    if isinstance(value, list | tuple):
        return ",".join(map(_item, value))
    if isinstance(value, Integral) and not isinstance(value, bool):
        return str(int(value))
    if isinstance(value, Real) and not isinstance(value, bool):
        return repr(float(value))
    raise TypeError(f"{value!r} means nothing in a deck: it takes texts, numbers, and lists of them")
