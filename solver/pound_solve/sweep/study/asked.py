"""Quantities that a study asks for: the name of a quantity of a sweep, and one of its labels or none."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from pound_deck.diagnostics import suggest
from pound_solve.statistics.curves import Asked
from pound_solve.statistics.over_records import OverRecords
from pound_solve.sweep.study.document import Document, Path_
from pound_solve.sweep.study.quantities import QUANTITIES

NAMES = tuple(q.name for q in QUANTITIES)


def asked(document: Document, path: Path_, text: str, more: tuple[str, ...] = ()) -> Asked:
    """Quantity of a text such as ``contact_force floor 1``; a wrong name adds a diagnostic.

    Parameters
    ----------
    document : Document
    path : tuple
        Path of the item that has the text.
    text : str
        Name, and label after a blank; the largest value of all labels without one.
    more : tuple of str
        Names that the item takes beside `NAMES`.
    """
    name, _, label = text.strip().partition(" ")
    if name not in (*NAMES, *more):
        hint = suggest(name, [*NAMES, *more]) or f"there are {', '.join((*more, *NAMES))}"
        document.mistake("S602", f"there is no quantity {name}", path, hint)
    return Asked(name, label.strip())


def all_asked(document: Document, path: Path_) -> Iterator[Asked]:
    """Yield the quantities of an item that takes one text or a list."""
    for text in document.listed(path, (str,)):
        yield asked(document, path, text)


def over_records(document: Document, path: Path_, words: Mapping[str, OverRecords]) -> OverRecords:
    """How the values of all records become one: a word of the verb, the first of which is the default, or
    a share such as 0.84.
    """
    value, default = document.at(path), next(iter(words.values()))
    if isinstance(value, float) and 0.0 < value < 1.0:
        return OverRecords(value)
    if isinstance(value, str) and value in words:
        return words[value]
    if value is not None:
        hint = "0.84 is the value that 84 % of the records do not exceed"
        document.mistake(
            "S603", f"{path[-1]} is {', '.join(words)}, or a share between 0 and 1", path, hint
        )
    return default
