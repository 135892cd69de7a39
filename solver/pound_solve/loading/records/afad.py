"""Text files of AFAD, Turkiye, of the older archive (``.txt``): three components side by side, in gal.

Lines of a name, a colon and a value; a line with the names of the components; a row for each sample.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, Final

from pound_deck.schema import Spec
from pound_solve.loading.records.base import Format, RawRecord, RecordError
from pound_solve.loading.records.header import (
    FIELDS,
    choose,
    count,
    filled,
    positive,
    printed,
    side_by_side,
)
from pound_solve.loading.records.text import is_data

_OPENING: Final = re.compile(r"\s*STRONG GROUND MOTION RECORDS OF (?:TURKIYE|TURKEY)", re.IGNORECASE)
_COUNT: Final = re.compile(r"NUMBER OF DATA\s*:\s*(\S+)")
_STEP: Final = re.compile(r"SAMPLING INTERVAL \(sec\)\s*:\s*(\S+)")
_PEAKS: Final = re.compile(r"\((.-.)\) *(\S+)")
_LONGEST: Final = 40


def sniff(head: str) -> bool:
    """The first line names the archive."""
    return bool(_OPENING.match(head))


def read(text: str, options: Mapping[str, Any]) -> RawRecord:
    """Samples of one component.

    Parameters
    ----------
    text : str
    options : mapping
        ``COMPONENT``: number from 1, name such as ``E-W``, or None for the first horizontal one.

    Raises
    ------
    RecordError
        R402 for a damaged header, R403, R405 for an unknown component.
    """
    lines = text.splitlines()
    start = next((k for k, line in enumerate(lines[:_LONGEST]) if is_data(line)), 0)
    names = lines[start - 1].split() if start else []
    npts, step = _line(lines[:start], _COUNT), _line(lines[:start], _STEP)
    if not sniff(text) or not names or not npts or not step:
        raise RecordError(
            "R402",
            "no header of AFAD: NUMBER OF DATA, SAMPLING INTERVAL (sec) and a line with the components",
            "leave FORMAT out",
        )
    k = choose(names, options.get("COMPONENT"))
    stated = dict(_PEAKS.findall(next((line for line in lines[:start] if "PGA VALUES (gal)" in line), "")))
    return RawRecord(
        side_by_side(lines[start:], start + 1, names, k),
        dt=positive(*step),
        unit="CM/S2",
        declared=count(*npts),
        component=names[k],
        title=filled(lines[: start - 1]),
        peak=printed(stated.get(names[k], "")),
    ).checked()


def _line(lines: list[str], pattern: re.Pattern[str]) -> tuple[str, str, int] | None:
    """Match of a pattern, its meaning and its line number."""
    matches = ((m, number) for number, line in enumerate(lines, 1) if (m := pattern.search(line)))
    return next(((m[1], m[0].partition(":")[0].strip().lower(), number) for m, number in matches), None)


SPEC: Final = Spec(
    "record",
    "AFAD",
    "three-column text files of AFAD's older archive, Turkiye",
    FIELDS,
    reference="Disaster and Emergency Management Presidency, Turkish strong-motion network",
    impl=Format(sniff, read),
)
