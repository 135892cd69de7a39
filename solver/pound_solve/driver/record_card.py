"""A RECORD card outside any deck: its items are written and read like those of a deck."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from pound_deck.reader import Reading, read_text
from pound_solve.catalog import catalog

_AROUND: Final = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
ELEMENTS
 1 SPRING 1 2
PROPS
 SPRING SPRING KX=1
ANALYSIS
 STATIC
EQUAKE
"""


def read(file: str, items: Sequence[str], source: str) -> Reading:
    """Return the model of a small deck in kN, m and s whose only motion is the record; see `read_text`.

    Parameters
    ----------
    file : str
        FILE of the card.
    items : sequence of str
        The other items of the card, ``NAME=value``.
    source : str
        Source name in the places of mistakes.
    """
    card = " ".join([f' RECORD "{file}"', *map(_item, items)])
    return read_text(f"{_AROUND}{card}\n", catalog(), name=source)


def _item(text: str) -> str:
    """An item in deck syntax: a word with a slash, such as a unit, gets quotes."""
    name, _, value = " ".join(text.split()).partition("=")
    return f'{name}="{value}"' if re.fullmatch(r"[A-Za-z]+/[A-Za-z]\w*", value) else f"{name}={value}"
