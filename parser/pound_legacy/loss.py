"""The loss of strength: ILOS and the line ``DUCT1 DUCT2 RDUCT DUCT3 RCYC``."""

from __future__ import annotations

from typing import Final

from pound_deck.diagnostics import mistake
from pound_deck.model import Span
from pound_legacy.draft import Draft, number
from pound_legacy.lines import Rows

NAMES: Final = ("DUCT1", "DUCT2", "RDUCT", "DUCT3", "RCYC")
_WORDS: Final = {1: "EACH", 3: "LARGEST"}


def read(code: int, rows: Rows, place: Span, draft: Draft, notes: list[str]) -> str:
    """Items of the new deck.

    Raises
    ------
    Mistake
        The line is missing, or this loss cannot be carried over.
    """
    found = rows.next("the loss of strength: " + " ".join(NAMES))
    begin, end, left, gone, cycle = found.reals(NAMES, 3)
    if code not in _WORDS or gone or cycle:
        text = f"ILOS {code} with DUCT3 {number(gone)} and RCYC {number(cycle)}"
        raise mistake("L604", text, place, "ILOS 1 and 3 without DUCT3 and RCYC are carried over")
    notes.append(
        draft.doubt(found.span, "the line of the loss of strength stands before those of the rule")
    )
    return f"ILOS={_WORDS[code]} DUCT1={number(begin)} DUCT2={number(end)} RDUCT={number(left)}"
