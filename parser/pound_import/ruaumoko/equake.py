"""EQUAKE: ``IBERG ISTART DELTAT ASCALE END VEL DIS TSCALE``, then the record, or a record in another
file.

Formats: 3 is a line START, then lines of counter, time and acceleration, of which that with the counter
ISTART acts at t = 0; 1 (Berg) pairs of time and acceleration; 0 (Caltech) and 6 accelerations at the step
DELTAT. Divided by ASCALE, the numbers are in units of gravity.

A file of its own may have any format that RECORD finds: its times, and its unit where it states one, then
take the place of IBERG, DELTAT and ASCALE.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from pound_deck.diagnostics import Mistake, mistake
from pound_import.draft import Draft, number, quoted
from pound_import.ruaumoko.lines import DataItem, DataLine, row

NAMES: Final = ("IBERG", "ISTART", "DELTAT", "ASCALE", "END", "VEL", "DIS", "TSCALE")
_COUNTED: Final = 3
_STEPS: Final = "accelerations at the step DELTAT, one a line"
#: items of a RECORD card by IBERG, and the layout
_FORMATS: Final[Mapping[int, tuple[Mapping[str, str | float], str]]] = {
    0: ({"FORMAT": "COLUMNS", "COLUMN": 0}, _STEPS),
    1: ({"FORMAT": "BERG"}, "pairs of time and acceleration"),
    3: (
        {"FORMAT": "COLUMNS", "TIMES": 2, "COLUMN": 3},
        "a line START, then lines of counter (one of them ISTART), time and acceleration",
    ),
    6: ({"FORMAT": "COLUMNS", "COLUMN": 0}, _STEPS),
}
_STEPPED: Final = (0, 6)  #: formats without times
_ASCALES: Final = {"G": 1.0, "M/S2": 9.80665, "CM/S2": 980.665, "MM/S2": 9806.65}  #: by unit


@dataclass(frozen=True, slots=True)
class Samples:
    """What a record's file states by itself.

    Attributes
    ----------
    format : str
        Of a RECORD card.
    unit : str or None
        ``G``, ``M/S2``, ``CM/S2`` or ``MM/S2``; None if the file states none.
    times : sequence of float, [s]
    """

    format: str
    unit: str | None
    times: Sequence[float]


@dataclass(frozen=True, slots=True)
class File:
    """A file with a record.

    Attributes
    ----------
    name : str
        In the new deck.
    text : str
    recognise : function (items) -> Samples or None
        Samples of a file that has a format of its own; None for one that has the format that `items` of a
        RECORD card state, which is the default. Raises Mistake if it has neither.
    """

    name: str
    text: str
    recognise: Callable[[Mapping[str, str | float]], Samples | None] = lambda items: None


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


@dataclass(frozen=True, slots=True)
class Record:
    """Items of a RECORD card: file, format and the part that acts; the unit where the file states it."""

    items: str
    unit: str | None


def record(
    options: DataLine, appended: Appended, separate: File | None, draft: Draft, notes: list[str]
) -> Record:
    """Items of a RECORD card.

    Raises
    ------
    Mistake
        The line is cut, the format is not known, or there is no record.
    """
    v = dict(zip(NAMES, options.reals(NAMES, 4)))
    code = options.items[0].whole("IBERG")
    if code not in _FORMATS:
        have = ", ".join(map(str, _FORMATS))
        what = f"is {code}, a format that is not known"
        raise options.items[0].mistake("L604", "IBERG", what, f"known are {have}")
    data = _data(appended, separate, options)
    samples = None if data.first else _recognised(data.file, code, v["DELTAT"])
    items = [data.items, "FORMAT=AUTO" if samples else _written(_FORMATS[code][0])]
    if samples:
        begin = _of_its_own(samples, v, data.file.name, options, draft, notes)
    elif code == _COUNTED:
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
            what = f"is {number(v['END'])}, not after the start at {number(begin)}"
            raise options.item(4).mistake("L604", "END", what, "-1 takes the whole record")
        items.append(f"DURATION={number(v['END'] - begin)}")
    if v["TSCALE"] not in (0.0, 1.0):
        notes.append(draft.doubt(options.item(7).span, "TSCALE multiplies the times of the record"))
        items.append(f"TSCALE={number(v['TSCALE'])}")
    if v["VEL"] or v["DIS"]:
        notes.append("VEL and DIS of the ground have no effect on the motion relative to it")
    return Record(" ".join(items), samples.unit if samples else None)


def _written(items: Mapping[str, str | float]) -> str:
    return " ".join(f"{name}={value}" for name, value in items.items())


def _recognised(file: File, code: int, step: float) -> Samples | None:
    """Samples of a file in a format of its own, None for one in the deck's; a Mistake names both."""
    items, layout = _FORMATS[code]
    # a step that is none is reported where it is used
    stepped = {"DT": step if step > 0.0 else 1.0} if code in _STEPPED else {}
    try:
        return file.recognise({**items, **stepped})
    except Mistake as error:
        if error.diagnostic is None:
            raise
        what, hint = error.diagnostic.message, error.diagnostic.hint
        text = f"no record as IBERG {code} states; {what}"
        if not hint or "=" in hint:  # items of a RECORD card cannot be given here
            hint = f"two columns of time and acceleration will do, or {layout}"
        raise Mistake(replace(error.diagnostic, message=text, hint=hint)) from None


def _of_its_own(
    samples: Samples, v: dict[str, float], name: str, options: DataLine, draft: Draft, notes: list[str]
) -> float:
    """Start time of a record in a format of its own, in its time."""
    code, first = int(v["IBERG"]), options.item(1).whole("ISTART")
    idle = f"IBERG {code}"
    if code in _STEPPED:
        idle += f" and DELTAT {number(v['DELTAT'])}"
    span = f"{len(samples.times)} samples from {samples.times[0]:.6g} to {samples.times[-1]:.6g} s"
    reading = f"{name} is read as {samples.format}, {span}: not by {idle}"
    notes.append(draft.doubt(options.items[0].span, reading))
    if first in (0, 1):
        return 0.0
    if not 1 < first < len(samples.times):
        what = f"is {first}, and {name} has {len(samples.times)} samples"
        raise options.item(1).mistake("L608", "ISTART", what, "1 for the first sample")
    begin = samples.times[first - 1]
    reading = f"ISTART {first}: the record begins with this sample, at {number(begin)} s"
    notes.append(draft.doubt(options.item(1).span, reading))
    return begin


def _plain(
    v: dict[str, float], code: int, options: DataLine, draft: Draft, notes: list[str], items: list[str]
) -> float:
    """Start time of a record without counters, which is zero; adds the step to `items`."""
    if code == 6:
        draft.rest("IBERG 6: accelerations at the step DELTAT in a file of their own")
    else:
        notes.append(draft.doubt(options.items[0].span, f"IBERG {code}: {_FORMATS[code][1]}"))
    start = options.item(1).whole("ISTART")
    if start not in (0, 1):
        hint = "take the first lines out, and write 1"
        raise options.items[1].mistake("L604", "ISTART", f"is {start}", hint)
    if code != 1:
        if v["DELTAT"] <= 0.0:
            raise options.items[2].mistake("L603", "DELTAT", "is not above zero", "the step of the record")
        items.append(f"DT={number(v['DELTAT'])}")
    return 0.0


def scale(options: DataLine, factor: float, unit: str | None, draft: Draft, notes: list[str]) -> float:
    """Factor that converts the numbers of the record into shares of gravity, or that on a record whose file
    states its unit.
    """
    divisor = options.item(3).real("ASCALE")
    if divisor == 0.0:
        hint = "1 for shares of gravity, 9810 for mm/s2"
        raise options.items[3].mistake("L603", "ASCALE", "is zero", hint)
    if unit:
        if abs(divisor / _ASCALES[unit] - 1.0) > 0.01:
            reading = f"ASCALE {number(divisor)} does not act: the file states its unit, {unit}"
            notes.append(draft.doubt(options.items[3].span, reading))
        return factor
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
    what = f"is {counter}, a counter that no line of the record has"
    hint = "format 3 is a line START, then counter, time, acceleration"
    raise options.item(1).mistake("L608", "ISTART", what, hint)


def _is(item: DataItem, counter: int) -> bool:
    return item.real("counter") == counter
