"""The loss of strength: ILOS and the line ``DUCT1 DUCT2 RDUCT DUCT3 RCYC``."""

from __future__ import annotations

from typing import Final

from pound_deck.schema import Spec
from pound_import.draft import Draft, number
from pound_import.ruaumoko.lines import DataItem, DataLines

NAMES: Final = ("DUCT1", "DUCT2", "RDUCT", "DUCT3", "RCYC")
_WORDS: Final = {
    1: "EACH",
    2: "CYCLES",
    3: "LARGEST",
    4: "EACH_RCYC",
    5: "EACH_SUDDEN",
    6: "LARGEST_RCYC",
    7: "LARGEST_SUDDEN",
}
_SUDDEN: Final = (5, 7)
_COUNTING: Final = 4  #: the first code with RCYC


def read(code: int, rule: Spec, rows: DataLines, item: DataItem, draft: Draft, notes: list[str]) -> str:
    """Text of the items of the loss of strength in the new deck.

    Parameters
    ----------
    code : int
        ILOS, above zero.
    rule : Spec
        The hysteresis rule.
    item : DataItem
        The code.

    Raises
    ------
    Mistake
        The line is missing, the code is not known, or the rule takes no loss.
    """
    row = rows.next("the loss of strength: " + " ".join(NAMES))
    begin, end, left, gone, cycle = row.reals(NAMES, 3)
    if code not in _WORDS:
        raise item.mistake("L604", "ILOS", f"is {code}, which is not known", "0 to 7")
    forms = rule.field("ILOS")
    if forms is None:
        what = f"is {code}, and {rule.name} has no loss of strength"
        raise item.mistake("L604", "ILOS", what, "write 0, or take rule 1, 2, 4, 7, 10, 11 or 12")
    if _WORDS[code] not in forms.words:
        what = f"is {code}, and {rule.name} loses strength by the ductility of each direction only"
        raise item.mistake("L604", "ILOS", what, "write 0 or 1")
    notes.append(draft.doubt(row.span, "the line of the loss of strength stands before those of the rule"))
    if code in _SUDDEN and not gone:  # the loss never occurs
        code -= 1
    items = [f"ILOS={_WORDS[code]}", f"DUCT1={number(begin)}", f"DUCT2={number(end)}"]
    items.append(f"RDUCT={number(left)}")
    if gone:
        items.append(f"DUCT3={number(gone)}")
    if code >= _COUNTING:
        items.append(f"RCYC={number(cycle)}")
    elif cycle:
        notes.append(f"RCYC {number(cycle)} has no effect with ILOS {code}")
    return " ".join(items)
