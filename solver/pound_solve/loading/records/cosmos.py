"""COSMOS files, format 1.20 (``.V1``, ``.V2``, ``.V1c``, ``.V2c``): components one after another.

A component has lines of text, whose number the first one gives, then integers, reals and comments, each
after a line that gives their number, lines and columns, then samples after a line that gives their number,
unit and columns.  Of the integers, the 54th is the azimuth from north or a code; of the reals, the 62nd is
the step in ms, the 63rd the length in s and the 64th the peak; -999 marks unknown values.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

from pound_deck.schema import Spec
from pound_solve.loading.records.base import Format, RawRecord, RecordError
from pound_solve.loading.records.header import FIELDS, choose, count, filled, parts, positive, printed
from pound_solve.loading.records.text import fixed, parse

_OPENING: Final = re.compile(r".{4,60}\(format v\s*\S+ with +\d+ text lines\)", re.IGNORECASE)
_NUMBERS: Final = re.compile(
    r"\s*\d+ +(integer|real)-header values follow on +(\d+) +lines.*=\s*\(\d+[IFE](\d+)", re.IGNORECASE
)
_SAMPLES: Final = re.compile(
    r"\s*(\d+) +(.{3,20}?) *pts.*units\s*=\s*([^(,]*)\(\s*(\d+)\s*\).*=\s*\(\d+[IFE](\d+)", re.IGNORECASE
)
_LONGEST: Final = 200  # characters of a line that announces numbers; damaged ones can be a whole file
_END: Final = re.compile(r"\s*(?:end-of-data|/&)", re.IGNORECASE)
#: units of accelerations by their code, with the factor from samples to `RawRecord.unit`
_UNITS: Final = {2: ("G", 1.0), 4: ("CM/S2", 1.0), 7: ("CM/S2", 2.54), 10: ("CM/S2", 1.0), 11: ("G", 0.001)}
_DIRECTIONS: Final = {
    "400": "UP",
    "401": "DOWN",
    "402": "VERT",
    "500": "RADIAL",
    "501": "TRANSVERSE",
    "600": "LONG",
    "601": "TANG",
    "700": "H1",
    "701": "H2",
}
_AZIMUTH, _STEP, _LENGTH, _PEAK = 53, 61, 62, 63
_UNKNOWN: Final = -999.0


@dataclass(frozen=True, slots=True)
class _CosmosBlock:
    """Lines of one component, the 1-based number of the first, and the numbers of its header."""

    lines: list[str]
    first: int
    integers: list[str]
    reals: list[str]

    @property
    def component(self) -> str:
        """Azimuth from north, or the word of its code."""
        code = self.integers[_AZIMUTH]
        return _DIRECTIONS.get(code, code if _known(code) else "")


def sniff(head: str) -> bool:
    """The first line gives the version of the format and its lines of text."""
    return bool(_OPENING.match(head.lstrip()))


def read(text: str, options: Mapping[str, Any]) -> RawRecord:
    """Samples of one component.

    Parameters
    ----------
    text : str
    options : mapping
        ``COMPONENT``: number from 1, azimuth or ``UP``, or None for the first horizontal one.

    Raises
    ------
    RecordError
        R402 for a damaged header, counts of an instrument or no acceleration, R403, R405.
    """
    blocks = list(_blocks(text.splitlines()))
    if not blocks:
        raise RecordError("R402", "no line '(Format v01.20 with 13 text lines)'", "leave FORMAT out")
    block = blocks[choose([b.component for b in blocks], options.get("COMPONENT"))]
    headings = [(k, m) for k, line in enumerate(block.lines) if (m := _SAMPLES.match(line[:_LONGEST]))]
    at, samples = next(((k, m) for k, m in headings if "accel" in m[2].lower()), (0, None))
    if not samples:
        raise RecordError(
            "R402",
            f"component {block.component}, from line {block.first} on: no line such as "
            "'1000 acceleration pts, approx 10 secs, units=cm/sec2(04),Format=(8F10.5)'",
            "get the file of the acceleration; this one may hold another quantity or be cut short",
        )
    row = block.first + at
    if not (known := _UNITS.get(int(samples[4][:9]))):
        raise RecordError(
            "R402",
            f"line {row}: the unit is '{samples[3].strip()}', code {samples[4][:9]}, none of acceleration",
            "get the file in physical units (.V1 or .V2)",
        )
    rest = block.lines[at + 1 :]
    stop = next(
        (k for k, line in enumerate(rest) if _END.match(line) or _SAMPLES.match(line[:_LONGEST])), len(rest)
    )
    values, _ = parse(fixed(rest[:stop], int(samples[5][:3]) or 1), row + 1)
    step, length, peak = (block.reals[k] for k in (_STEP, _LENGTH, _PEAK))
    return RawRecord(
        values * known[1],
        dt=positive(step, "the step [ms], the 62nd real,", block.first) / 1000,
        unit=known[0],
        declared=count(samples[1], "the count of samples", row),
        component=block.component,
        title=filled(block.lines[:13]),
        peak=printed(peak) if _known(peak) and known[1] == 1 else "",
        length=printed(length) if _known(length) else "",
    ).checked()


def _known(word: str) -> bool:
    """Whether a number of the header is a value, not the mark for an unknown one."""
    plain = printed(word)
    return bool(plain) and float(plain) != _UNKNOWN


def _blocks(lines: list[str]) -> Iterator[_CosmosBlock]:
    """Components of the file with the numbers of their headers.

    Raises
    ------
    RecordError
        R402 if integers or reals are missing.
    """
    for part, first in parts(lines, _OPENING.match):
        numbers = {
            m[1].lower(): " ".join(fixed(part[k + 1 : k + 1 + int(m[2][:3])], int(m[3][:3]) or 1)).split()
            for k, line in enumerate(part)
            if (m := _NUMBERS.match(line[:_LONGEST]))
        }
        integers, reals = numbers.get("integer", []), numbers.get("real", [])
        if len(integers) <= _AZIMUTH or len(reals) <= _PEAK:
            raise RecordError(
                "R402",
                f"line {first}: the header has {len(integers)} integers and {len(reals)} reals; "
                f"{_AZIMUTH + 1} and {_PEAK + 1} are needed",
            )
        yield _CosmosBlock(part, first, integers, reals)


SPEC: Final = Spec(
    "record",
    "COSMOS",
    "COSMOS files, versions 1 and 2 (.V1, .V2, .V1c, .V2c)",
    FIELDS,
    reference="Consortium of Organizations for Strong-Motion Observation Systems, Strong Motion Data "
    "Format 1.20, 2001",
    impl=Format(sniff, read),
)
