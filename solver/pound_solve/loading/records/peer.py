"""PEER strong-motion files (``.AT2``): a short header with NPTS and DT, then the samples row by row, in g.

Two headers occur: ``NPTS=   7995, DT=   .0050 SEC`` (NGA) and ``7995   .0050   NPTS, DT`` (older).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, Final

from pound_deck.schema import Spec
from pound_solve.loading.records.base import Format, RawRecord, RecordError
from pound_solve.loading.records.header import count, filled, positive, unit
from pound_solve.loading.records.text import parse
from pound_solve.numerics.types import Array

_REAL: Final = r"([+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[ED][+-]?\d+)?)"
_NEW: Final = re.compile(rf"NPTS\s*=\s*(\d+)\s*,?\s*DT\s*=\s*{_REAL}", re.IGNORECASE)
_OLD: Final = re.compile(rf"^\s*(\d+)[\s,]+{_REAL}[\s,]+NPTS\s*,\s*DT\b", re.IGNORECASE)
_QUANTITY: Final = re.compile(r"\b(VELOCITY|DISPLACEMENT)\s+TIME", re.IGNORECASE)
_UNIT: Final = re.compile(r"UNITS?\s+OF\s+([A-Z]+(?:/[A-Z0-9^*/]+)?)", re.IGNORECASE)
_HEADER_LINES: Final = 12
_PER_ROW: Final = 5


def _counts(line: str) -> tuple[str, str] | None:
    """NPTS and DT of a header line as they are written, or None."""
    match = _NEW.search(line) or _OLD.search(line)
    return (match[1], match[2]) if match else None


def sniff(head: str) -> bool:
    """One of the first lines gives NPTS and DT."""
    return any(_counts(line) for line in head.splitlines()[:_HEADER_LINES])


def read(text: str, options: Mapping[str, Any]) -> RawRecord:
    """Samples of a PEER file.

    Raises
    ------
    RecordError
        R402 (no NPTS and DT in the header, or a velocity or displacement too), R403.
    """
    lines = text.splitlines()
    row, counts = next(
        ((k, c) for k, line in enumerate(lines[:_HEADER_LINES]) if (c := _counts(line))), (0, None)
    )
    if counts is None:
        raise RecordError(
            "R402", "no line with NPTS and DT at the head of the file", "leave FORMAT out, or try COLUMNS"
        )
    npts, dt = count(counts[0], "NPTS", row + 1), positive(counts[1], "the step DT [s]", row + 1)
    title = filled(lines[:row])
    about = " ".join(title)
    if wrong := _QUANTITY.search(about):
        raise RecordError(
            "R402", f"the file holds a {wrong[1].lower()}, not an acceleration", "take its .AT2 companion"
        )
    stated = _UNIT.search(about)
    values, _ = parse(lines[row + 1 :], row + 2)
    return RawRecord(
        values,
        dt=dt,
        unit=unit(stated[1]) if stated else None,
        declared=npts,
        component=title[1].rsplit(",", 1)[-1].strip() if len(title) > 1 and "," in title[1] else "",
        title=title,
    ).checked()


def written(title: str, values: Array, dt: float) -> str:
    """A file of this format.

    Parameters
    ----------
    title : str
        One line.
    values : ndarray, shape (n,), [gravity]
    dt : float, [s]
    """
    head = (title, title, "ACCELERATION TIME SERIES IN UNITS OF G", f"NPTS= {len(values)}, DT= {dt!r} SEC")
    rows = (values[k : k + _PER_ROW] for k in range(0, len(values), _PER_ROW))
    return "\n".join([*head, *("".join(f"{x:18.10E}" for x in row) for row in rows), ""])


SPEC: Final = Spec(
    "record",
    "PEER",
    "PEER .AT2 file, both header styles",
    reference="PEER strong-motion database, University of California, Berkeley",
    impl=Format(sniff, read),
)
