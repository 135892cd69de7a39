"""SMC files of the US Geological Survey (``.smc``): one component, corrected or uncorrected [cm/s2].

Eleven lines of text, six of eight integers in columns of 10, ten of five reals in columns of 15, lines that
begin with ``|``, then samples, eight a line in columns of 10.  Of the integers, the 13th is the angle from
the vertical, the 14th the azimuth from north, the 16th counts the ``|`` lines and the 17th the numbers of
the data.  Of the reals, the 2nd is the rate, and the 30th and 32nd are the largest and the least sample.
Film digitised at uneven times has no rate: its data are alternating times and accelerations.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from pound_deck.schema import Spec
from pound_solve.loading.records.base import Format, RawRecord, RecordError
from pound_solve.loading.records.header import count, filled, positive, printed
from pound_solve.loading.records.text import fixed, parse

_OPENING: Final = re.compile(
    r"\s*\d +((?:UN)?CORRECTED ACCELEROGRAM|.{0,40}(?:VELOCITY|DISPLACEMENT|SPECTR\w*))", re.IGNORECASE
)
_TEXT, _INTEGERS, _REALS = 11, 6, 10
_FIRST_REAL, _BODY = _TEXT + _INTEGERS, _TEXT + _INTEGERS + _REALS
_INTEGER_WIDTH, _REAL_WIDTH, _WIDTH = 10, 15, 10
_PER_LINE: Final = 8
_NOT_GIVEN: Final = "-32768"
_NO_REAL: Final = 1e38  # 1.7e38 marks a missing number


def sniff(head: str) -> bool:
    """The first line names the kind of the file, and the twelfth holds the first integers."""
    lines = head.splitlines()
    return bool(_OPENING.match(head)) and len(lines) > _TEXT and len(lines[_TEXT].split()) == _PER_LINE


def read(text: str, options: Mapping[str, Any]) -> RawRecord:
    """Samples of an SMC file.

    Raises
    ------
    RecordError
        R402 for another quantity than acceleration or a damaged header, R403.
    """
    lines = text.rstrip("\0 \r\n").splitlines()  # old files are padded with NULs to whole blocks
    opening = _OPENING.match(text)
    if not opening or len(lines) <= _BODY:
        raise RecordError(
            "R402",
            "no header of SMC: a line such as '2 CORRECTED ACCELEROGRAM' and 10 more of text, 6 of "
            "integers, 10 of reals",
            "leave FORMAT out",
        )
    if "ACCELEROGRAM" not in opening[1].upper():
        raise RecordError("R402", f"line 1: the file holds '{opening[1]}'", "get the accelerogram")
    integers = " ".join(fixed(lines[_TEXT:_FIRST_REAL], _INTEGER_WIDTH)).split()
    reals = " ".join(fixed(lines[_FIRST_REAL:_BODY], _REAL_WIDTH)).split()
    if len(integers) != _INTEGERS * 8 or len(reals) != _REALS * 5:
        raise RecordError(
            "R402",
            f"lines {_TEXT + 1} to {_BODY}: {len(integers)} integers and {len(reals)} reals, not 48 and 50",
        )
    start = _BODY + count(integers[15], "the count of comments", _TEXT + 2)
    declared = count(integers[16], "the count of numbers", _TEXT + 3)
    values, _ = parse(fixed(lines[start:], _WIDTH), start + 1)
    times, dt = None, None
    if _given(reals[1]):
        dt = 1 / positive(reals[1], "the rate [1/s]", _FIRST_REAL + 1)
    else:
        # some writers left a line of their buffer after the last pair
        if len(values) - declared in range(1, _PER_LINE + 1):
            values = values[:declared]
        if len(values) % 2:
            raise RecordError("R403", f"{len(values)} numbers are no whole pairs of time and acceleration")
        times, values, declared = values[::2].copy(), values[1::2].copy(), declared // 2
        if (np.diff(times) <= 0).any():
            raise RecordError(
                "R402",
                "the film was read at times that coincide in the digits printed",
                "get the corrected file of the same trace",
            )
    return RawRecord(
        values,
        dt=dt,
        times=times,
        unit="CM/S2",
        declared=declared,
        component=_component(integers),
        title=filled(lines[:_TEXT], "* "),
        peak=max(filter(_given, (reals[29], reals[31])), key=lambda word: abs(float(word)), default=""),
    ).checked()


def _component(integers: list[str]) -> str:
    """``UP`` for a sensor without a tilt from the vertical, else the azimuth from north."""
    if integers[12] == "0":
        return "UP"
    return "" if integers[13] == _NOT_GIVEN else integers[13]


def _given(word: str) -> bool:
    """Whether a real of the header is a value, not the mark for a missing one."""
    plain = printed(word)
    return bool(plain) and abs(float(plain)) < _NO_REAL


SPEC: Final = Spec(
    "record",
    "SMC",
    "SMC file of the USGS",
    reference="US Geological Survey, National Strong-Motion Program: SMC-format data files",
    impl=Format(sniff, read),
)
