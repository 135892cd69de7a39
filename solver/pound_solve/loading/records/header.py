"""Common parts of agencies' files: numbers and units in their headers, the choice of a component."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from typing import Final

from pound_deck.schema import Field, Kind
from pound_solve.loading.records.base import MAX_NUMBER, MIN_NUMBER, RecordError
from pound_solve.loading.records.text import parse
from pound_solve.numerics.types import Array

FIELDS: Final = (
    Field(
        "COMPONENT",
        Kind.TEXT,
        default=None,
        doc="1, 2, 3 or the name in the file, such as N28W, 90 or UP; omitted: the first horizontal one",
    ),
)

# longer numbers occur in no header and may overflow
_INTEGER: Final = re.compile(r"\d{1,9}")
_REAL: Final = re.compile(r"[+-]?(?:\d{1,12}\.?\d{0,12}|\.\d{1,12})(?:E[+-]?\d{1,2})?")
_DIVISION: Final = re.compile(r"/S(?:EC)?/S(?:EC)?\b")
_SQUARE: Final = re.compile(r"/S(?:EC)?(?:\*\*|\^)?2")
_VERTICAL: Final = frozenset(("UP", "DOWN", "VERT", "V", "Z", "U-D", "UD"))
_UNITS: Final = {"G": "G", "GAL": "CM/S2", "M/S2": "M/S2", "CM/S2": "CM/S2", "MM/S2": "MM/S2"}


def count(word: str, what: str, line: int) -> int:
    """Integer count stated in a header.

    Parameters
    ----------
    word : str
    what : str
        Name of the number, for the message.
    line : int
        1-based line of the file, for the message.

    Raises
    ------
    RecordError
        R402 for anything but an integer of at most nine digits.
    """
    if not _INTEGER.fullmatch(word.strip()):
        raise RecordError("R402", f"line {line}: {what} is '{word.strip()[:20]}', not a whole number")
    return int(word)


def printed(word: str) -> str:
    """A word of a header in a form that ``float`` accepts; empty if it is no number."""
    plain = word.strip().upper().replace("D", "E")
    return plain if _REAL.fullmatch(plain) else ""


def positive(word: str, what: str, line: int) -> float:
    """Positive quantity stated in a header, such as a step or a rate.

    Parameters
    ----------
    word, what, line
        As for `count`.

    Raises
    ------
    RecordError
        R402 for anything but a number from 1e-9 to 1e9.
    """
    plain = printed(word)
    if not plain or not MIN_NUMBER <= float(plain) <= MAX_NUMBER:
        raise RecordError(
            "R402",
            f"line {line}: {what} is '{word.strip()[:20]}', "
            f"not a number from {MIN_NUMBER:g} to {MAX_NUMBER:g}",
        )
    return float(plain)


def unit(words: str) -> str | None:
    """Unit of acceleration as `RawRecord.unit` names it, from the ways in which files write it.

    Parameters
    ----------
    words : str
        Such as ``cm/sec2``, ``CM/SEC/SEC``, ``M/S**2``, ``g`` or ``Gal``.

    Returns
    -------
    str or None
        None for an unknown unit.
    """
    plain = words.strip().rstrip(".").upper()
    return _UNITS.get(_SQUARE.sub("/S2", _DIVISION.sub("/S2", plain)))


def parts(lines: list[str], opens: Callable[[str], object]) -> Iterator[tuple[list[str], int]]:
    """Parts of a file of several components, each with the 1-based number of its first line.

    Parameters
    ----------
    lines : list of str
    opens : callable
        Whether a line is the first of a part.
    """
    starts = [k for k, line in enumerate(lines) if opens(line)]
    for start, stop in zip(starts, [*starts[1:], len(lines)]):
        yield lines[start:stop], start + 1


def filled(lines: Sequence[str], marks: str | None = None) -> tuple[str, ...]:
    """Lines of a title without blanks or other marks at their ends; those of nothing else are left out."""
    return tuple(stripped for line in lines if (stripped := line.strip(marks)))


def choose(names: Sequence[str], wanted: object) -> int:
    """0-based index of the component requested by a card.

    Parameters
    ----------
    names : sequence of str
        Components of the file in their order; one at least.
    wanted : object
        Number from 1, name, or None for the first that is not vertical.

    Raises
    ------
    RecordError
        R405, which lists the components.
    """
    if wanted is None:
        return next((k for k, there in enumerate(names) if there.upper() not in _VERTICAL), 0)
    name = str(wanted).strip().upper()
    if _INTEGER.fullmatch(name) and 1 <= int(name) <= len(names):
        return int(name) - 1
    for k, there in enumerate(names):
        if there.upper() == name:
            return k
    listed = ", ".join(f"{k} {there}" for k, there in enumerate(names, 1))
    raise RecordError("R405", f"no component '{wanted}' in the file", f"there are {listed}", "COMPONENT")


def side_by_side(lines: Sequence[str], first: int, names: Sequence[str], k: int) -> Array:
    """Samples of one component in a file with components in columns.

    Parameters
    ----------
    lines : sequence of str
        A row of numbers for each sample.
    first : int
        Line number of ``lines[0]``, for messages.
    names : sequence of str
        Components, from left to right.
    k : int
        0-based index of the requested component.

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    RecordError
        R402 for a row with a different number of samples.
    """
    values, counts = parse(lines, first)
    for number, columns in enumerate(counts, first):
        if columns not in (0, len(names)):
            raise RecordError("R402", f"line {number}: {columns} numbers, not {len(names)}")
    return values.reshape(-1, len(names))[:, k].copy()
