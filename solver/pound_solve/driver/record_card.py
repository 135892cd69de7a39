"""A RECORD card that stands in no deck: its items are written as a deck has them, and read as a deck is."""

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
    """Model of a small deck in kN, m and s whose one motion is the record, see `read_text`.

    Parameters
    ----------
    file : str
        FILE of the card.
    items : sequence of str
        ``NAME=value``, the other items of the card.
    source : str
        Name that the places of mistakes bear.
    """
    card = " ".join([f' RECORD "{file}"', *map(_item, items)])
    return read_text(f"{_AROUND}{card}\n", catalog(), name=source)


def _item(text: str) -> str:
    """An item as a deck writes it: a word with a slash, as of a unit, in quotes."""
    name, _, value = " ".join(text.split()).partition("=")
    return f'{name}="{value}"' if re.fullmatch(r"[A-Za-z]+/[A-Za-z]\w*", value) else f"{name}={value}"
