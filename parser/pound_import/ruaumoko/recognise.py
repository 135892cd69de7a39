"""Whether a text is a deck of Ruaumoko: a title, control lines of numbers alone, then NODES.

In a deck of this program no line of numbers precedes the first section.
"""

from __future__ import annotations

from itertools import islice
from typing import Final

from pound_import.ruaumoko.lines import DataLine, row

HEAD: Final = 20_000  #: characters examined
#: data lines examined: the title, up to six control lines and some that are out of place
_LINES = 14
_LEAST = 6  #: items of a control line
_CONTROL_2D = 4  #: control lines of a plane deck


def control_lines(text: str) -> list[DataLine]:
    """Control lines of an old deck; empty where the text is not one."""
    head = text[:HEAD].splitlines()
    rows = (line for number, raw in enumerate(head[1:], 2) if (line := row("", number, raw)))
    control: list[DataLine] = []
    for line in islice(rows, _LINES):
        if line.word == "NODES":
            long = sum(len(r.items) >= _LEAST and _mostly_numbers(r) for r in control)
            return control if long >= _CONTROL_2D - 1 and control[0].items[0].numeric else []
        control.append(line)
    return []


def is_legacy(text: str) -> bool:
    """Whether a text is an old deck, plane or in space."""
    return bool(control_lines(text))


def in_space(rows: list[DataLine]) -> bool:
    """Whether control lines are those of a 3-D deck, which has a line of six numbers for the view."""
    return len(rows) > _CONTROL_2D and len(rows[0].items) < 11


def _mostly_numbers(line: DataLine) -> bool:
    return 2 * sum(item.numeric for item in line.items) > len(line.items)
