"""Tables of numbers: a column of samples, or time and acceleration, or many columns.

Without DT the first column, or that of TIMES, is the time [s]; with DT no column is.  Blanks, tabs, commas
or semicolons separate the numbers.  Lines at the head that are not all numbers are titles; text after
``#`` is a comment.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from pound_deck.schema import Field, Kind, Spec
from pound_solve.loading.records.base import Format, RawRecord, RecordError
from pound_solve.loading.records.text import is_data, parse, split_head

FIELDS: Final = (
    Field(
        "DT",
        Kind.REAL,
        "T",
        default=None,
        above=0,
        doc="step of evenly spaced samples; omitted: column 1 is the time",
    ),
    Field(
        "COLUMN",
        Kind.INT,
        default=None,
        lo=0,
        doc="column of the acceleration, counted from 1; 0: all numbers in turn; omitted: the only one",
    ),
    Field("TIMES", Kind.INT, default=1, lo=1, doc="column of the times, counted from 1, if DT is omitted"),
)


def sniff(head: str) -> bool:
    """Return whether all lines after the titles have the same count of numbers (the last may be short)."""
    _, data, _ = split_head(head.splitlines())
    rows = [line for line in data if line.strip()]
    if not rows or not all(map(is_data, rows)):
        return False
    counts = _counts(rows)
    return all(n == counts[0] for n in counts[:-1]) and counts[-1] <= counts[0]


def _counts(rows: list[str]) -> list[int]:
    """Count of numbers in each row; all zero if a row cannot be read."""
    try:
        return parse(rows)[1]
    except RecordError:
        return [0] * len(rows)  # damaged numbers: still this format, and reading it reports the line


def read(text: str, options: Mapping[str, Any]) -> RawRecord:
    """Samples of one column.

    Parameters
    ----------
    text : str
    options : mapping
        ``DT`` [s] and ``COLUMN``, each a number or None, and ``TIMES``.

    Raises
    ------
    RecordError
        R402, R405 where DT and COLUMN do not fit the table.
    """
    dt, column = options.get("DT"), options.get("COLUMN")
    title, data, first = split_head(text.splitlines())
    values, counts = parse(data, first)
    head = tuple(title)
    if column == 0:
        if dt is None:
            raise RecordError("R405", "COLUMN=0 reads samples without times, so it needs DT=")
        return RawRecord(values, dt=float(dt), title=head).checked()

    width = counts[0]
    if ragged := next((k for k, n in enumerate(counts) if n not in (0, width)), None):
        raise RecordError(
            "R402",
            f"line {first + ragged} holds {counts[ragged]} numbers, line {first} holds {width}",
            "put # before lines that are no data; samples that fill the lines one after another: COLUMN=0",
        )
    table = values.reshape(-1, width)
    timed = 0 if dt is not None else options.get("TIMES", 1)
    k = _column(width, timed, column)
    if dt is not None:
        return RawRecord(table[:, k].copy(), dt=float(dt), title=head, component=_label(column)).checked()
    return RawRecord(
        table[:, k].copy(), times=table[:, timed - 1].copy(), title=head, component=_label(column)
    ).checked()


def _label(column: int | None) -> str:
    return "" if column is None else f"column {column}"


def _column(width: int, timed: int, column: int | None) -> int:
    """0-based column of the acceleration in a table of `width` columns, of which `timed` is the time."""
    if timed and width == 1:
        raise RecordError("R405", "the file has one column and no times", "give the step with DT=")
    if timed > width:
        raise RecordError("R405", f"TIMES={timed}, but the file has {width} columns", item="TIMES")
    least = 2 if timed == 1 else 1
    if column is None:
        if width != (2 if timed else 1):
            raise RecordError(
                "R405", f"the file has {width} columns", f"say with COLUMN={least}..{width} which one acts"
            )
        column = 3 - timed if timed else 1
    if column > width:
        raise RecordError("R405", f"COLUMN={column}, but the file has {width} columns")
    if column == timed:
        raise RecordError(
            "R405",
            f"COLUMN={timed} is the time",
            "take another column, or give DT= if no column is the time",
        )
    return column - 1


SPEC: Final = Spec(
    "record", "COLUMNS", "number columns, also CSV", FIELDS, impl=Format(sniff, read, greedy=True)
)
