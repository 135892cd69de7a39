"""EQUAKE: ``IBERG ISTART DELTAT ASCALE END VEL DIS TSCALE``, then the record, or a record in another
file.

Formats: 3 is a line START, then lines of counter, time and acceleration, of which that with the counter
ISTART acts at t = 0; 1 (Berg) pairs of time and acceleration; 0 (Caltech) and 6 accelerations at the step
DELTAT. Divided by ASCALE, the numbers are in units of gravity.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from pound_deck.diagnostics import mistake
from pound_import.draft import Draft, number, quoted
from pound_import.ruaumoko.lines import DataItem, DataLine, row

NAMES: Final = ("IBERG", "ISTART", "DELTAT", "ASCALE", "END", "VEL", "DIS", "TSCALE")
_COUNTED: Final = 3
_FORMATS: Final = {
    0: "FORMAT=COLUMNS COLUMN=0",
    1: "FORMAT=BERG",
    3: "FORMAT=COLUMNS TIMES=2 COLUMN=3",
    6: "FORMAT=COLUMNS COLUMN=0",
}


@dataclass(frozen=True, slots=True)
class File:
    """A file with a record: its name in the new deck, and its text."""

    name: str
    text: str


@dataclass(frozen=True, slots=True)
class Appended:
    """Record that may follow the lines of EQUAKE in the deck: the deck's file, and the number of the first
    line that may hold the record.
    """

    file: File
    first: int


@dataclass(frozen=True, slots=True)
class _Data:
    """Location of a record: its file, its first and last line (0: the whole file)."""

    file: File
    first: int = 0
    last: int = 0

    @property
    def items(self) -> str:
        return f"FILE={quoted(self.file.name)}" + (f" LINES={self.first},{self.last}" if self.first else "")

    def rows(self) -> Sequence[str]:
        lines = self.file.text.splitlines()
        return lines[self.first - 1 : self.last] if self.first else lines


def record(
    options: DataLine, appended: Appended, separate: File | None, draft: Draft, notes: list[str]
) -> str:
    """Text of the items of a RECORD card: the file, its format and the part of it that acts.

    Raises
    ------
    Mistake
        The line is cut, the format is not known, or there is no record.
    """
    v = dict(zip(NAMES, options.reals(NAMES, 4)))
    code, place = options.item(0).whole("IBERG"), options.items[0].span
    if code not in _FORMATS:
        have = ", ".join(map(str, _FORMATS))
        raise mistake("L604", f"IBERG {code}: a format that is not known", place, f"known are {have}")
    data = _data(appended, separate, options)
    items = [data.items, _FORMATS[code]]
    if code == _COUNTED:
        begin = _time_of_counter(options.item(1).whole("ISTART"), data, options)
    else:
        begin = _plain(v, code, options, draft, notes, items)
    if begin:
        items.append(f"START={number(begin)}")
    if v["END"] > 0.0:
        notes.append(
            draft.doubt(options.item(4).span, f"END {number(v['END'])}: the record is cut at this time")
        )
        if v["END"] <= begin:
            raise mistake(
                "L604", "END comes before the start", options.item(4).span, "-1 takes the whole record"
            )
        items.append(f"DURATION={number(v['END'] - begin)}")
    if v["TSCALE"] not in (0.0, 1.0):
        notes.append(draft.doubt(options.item(7).span, "TSCALE multiplies the times of the record"))
        items.append(f"TSCALE={number(v['TSCALE'])}")
    if v["VEL"] or v["DIS"]:
        notes.append("VEL and DIS of the ground have no effect on the motion relative to it")
    return " ".join(items)


def _plain(
    v: dict[str, float], code: int, options: DataLine, draft: Draft, notes: list[str], items: list[str]
) -> float:
    """Start time of a record without counters, which is zero; adds the step to `items`."""
    reading = {0: "one step DELTAT from number to number", 1: "pairs of time and acceleration", 6: "as 0"}[
        code
    ]
    if code == 6:
        draft.rest("IBERG 6: accelerations at the step DELTAT in a file of their own")
    else:
        notes.append(draft.doubt(options.items[0].span, f"IBERG {code}: {reading}"))
    start = options.item(1).whole("ISTART")
    if start not in (0, 1):
        raise mistake(
            "L604", f"ISTART {start}", options.items[1].span, "take the first lines out, and write 1"
        )
    if code != 1:
        if v["DELTAT"] <= 0.0:
            raise mistake(
                "L603", "DELTAT is not above zero", options.items[2].span, "the step of the record"
            )
        items.append(f"DT={number(v['DELTAT'])}")
    return 0.0


def scale(options: DataLine, factor: float, draft: Draft) -> float:
    """Factor that converts the numbers of the record into shares of gravity."""
    divisor = options.item(3).real("ASCALE")
    if divisor == 0.0:
        raise mistake(
            "L603", "ASCALE is zero", options.items[3].span, "1 for shares of gravity, 9810 for mm/s2"
        )
    if divisor != 1.0:
        draft.rest("ASCALE divides the record into shares of gravity")
    return factor / divisor


def _data(appended: Appended, separate: File | None, options: DataLine) -> _Data:
    """Location of the record: behind the line of EQUAKE, or in the file that the user names."""
    lines = appended.file.text.splitlines()
    first = last = 0
    for k in range(appended.first, len(lines) + 1):
        line = row("", k, lines[k - 1])
        if line is None or (not first and line.word == "START"):
            continue
        if line.word:
            break
        first, last = first or k, k
    if first:
        return _Data(appended.file, first, last)
    if separate is None:
        text = "no record follows, so it stands in a file of its own"
        raise mistake("L611", text, options.span, "pound-solve import DECK --record FILE names it")
    return _Data(separate)


def _time_of_counter(counter: int, data: _Data, options: DataLine) -> float:
    """Time on the line of the record that has a counter."""
    name = options.span.file if data.first else data.file.name
    for k, raw in enumerate(data.rows(), data.first or 1):
        line = row(name, k, raw)
        if line and not line.word and len(line.items) > 2 and _is(line.items[0], counter):
            return line.items[1].real("time")
    text = f"no line of the record has the counter {counter} (ISTART)"
    raise mistake(
        "L608", text, options.item(1).span, "format 3 is a line START, then counter, time, acceleration"
    )


def _is(item: DataItem, counter: int) -> bool:
    return item.real("counter") == counter
