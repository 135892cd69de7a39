"""All messages: the number of each, its title, its meaning and remedy; the manual's page is made from them.

``messages.txt`` holds them: a line of number and title, and the meaning, indented, below it.  Numbers: P1xx
source text, P2xx cards and values, P3xx the model, R4xx records, A5xx stops of an analysis, S6xx studies of
many runs, L6xx models of other programs.  The number of a message never changes.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from importlib.resources import files
from types import MappingProxyType
from typing import Final


def _read() -> Mapping[str, tuple[str, str]]:
    text = files("pound_deck").joinpath("messages.txt").read_text("utf-8")
    entries = (entry.partition("\n") for entry in re.split(r"\n(?=\S)", text))
    heads = ((head.split(" ", 1), " ".join(meaning.split())) for head, _, meaning in entries)
    return MappingProxyType({code: (title, meaning) for (code, title), meaning in heads})


MESSAGES: Final = _read()
#: codes of warnings, which a card MEANT may name
WARNINGS: Final = tuple(c for c, (title, _) in MESSAGES.items() if "warning)" in title and c[0] in "PR")
