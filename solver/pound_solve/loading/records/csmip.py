"""CSMIP and CDMG files of California, volume 2 (``.V2``): corrected components one after another.

A component has 25 lines of text, 7 of 16 integers in columns of 5, 13 of eight reals in columns of 10, then
a line with count and step and the accelerations below it, the same for velocities and displacements, and a
line that begins with ``/&``.  Of the reals, the 61st is the step of these samples and the 66th their peak.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from pound_deck.schema import Spec
from pound_solve.loading.records.base import Format, RawRecord, RecordError
from pound_solve.loading.records.header import FIELDS, choose, count, filled, parts, positive, printed, unit
from pound_solve.loading.records.text import fixed, parse

_OPENING: Final = re.compile(r"\s*corrected accelerogram\b", re.IGNORECASE)
_COMPONENT: Final = re.compile(r"\bchan\s*\d+\s*:\s*(\S+)", re.IGNORECASE)
_SAMPLES: Final = re.compile(
    r"\s*(\d+)\s+points of accel data equally spaced at\s+(\S+)\s+sec"
    r"[.,]?\s+(?:in\s+|\(units:\s*)([a-z0-9/^*]+)(?:.*\(\d+[fe](\d+)\.)?",
    re.IGNORECASE,
)
_END: Final = re.compile(r"\s*\d+\s+points of (?:veloc|displ)|\s*/&", re.IGNORECASE)
_TEXT, _REAL_LINES, _REALS, _WIDTH = 25, 13, 100, 10
_STEP, _PEAK = 60, 65


@dataclass(frozen=True, slots=True)
class _CsmipBlock:
    """Lines of one component and the 1-based line number of the first."""

    lines: list[str]
    first: int

    @property
    def component(self) -> str:
        """Azimuth from north or ``UP``."""
        return next((m[1] for line in self.lines[:_TEXT] if (m := _COMPONENT.search(line))), "")


def sniff(head: str) -> bool:
    """The first lines say that a corrected accelerogram comes from uncorrected data."""
    first, _, rest = head.lstrip().partition("\n")
    return bool(_OPENING.match(first)) and rest.lstrip()[:24].upper() == "UNCORRECTED ACCELEROGRAM"


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
        R402 for a damaged header, R403, R405 for an unknown component.
    """
    blocks = [_CsmipBlock(*part) for part in parts(text.splitlines(), _OPENING.match)]
    if not blocks:
        raise RecordError("R402", "no line 'Corrected accelerogram' in the file", "leave FORMAT out")
    block = blocks[choose([b.component for b in blocks], options.get("COMPONENT"))]
    at, samples = next(
        ((k, m) for k, line in enumerate(block.lines) if (m := _SAMPLES.match(line))), (0, None)
    )
    if not samples:
        raise RecordError(
            "R402",
            f"component {block.component}, from line {block.first} on: no line such as "
            "'1000 points of accel data equally spaced at .010 sec, in cm/sec2'",
            "the file may be cut short; get it again",
        )
    row = block.first + at
    unit_of_samples = unit(samples[3])
    if not unit_of_samples:
        raise RecordError(
            "R402", f"line {row}: the unit '{samples[3][:20]}' is no known one of acceleration"
        )
    reals = " ".join(fixed(block.lines[max(at - _REAL_LINES, 0) : at], _WIDTH)).split()
    if len(reals) != _REALS:
        raise RecordError("R402", f"lines before {row}: the header has {len(reals)} reals, not {_REALS}")
    rest = block.lines[at + 1 :]
    stop = next((k for k, line in enumerate(rest) if _END.match(line)), len(rest))
    values, _ = parse(fixed(rest[:stop], int(samples[4] or _WIDTH)), row + 1)
    return RawRecord(
        values,
        dt=_step(reals[_STEP], samples[2], row),
        unit=unit_of_samples,
        declared=count(samples[1], "the count of samples", row),
        component=block.component,
        title=filled(block.lines[:_TEXT]),
        peak=printed(reals[_PEAK]),
    ).checked()


def _step(in_reals: str, in_line: str, row: int) -> float:
    """Step [s]: the reals have more digits of it than the line above the samples."""
    shown = positive(in_line, "the step [s]", row)
    if not printed(in_reals) or float(printed(in_reals)) <= 0:
        return shown
    exact = positive(in_reals, "the step [s] of the reals", row)
    if abs(exact - shown) > 0.5000001 * 10.0 ** -len(in_line.partition(".")[2]):
        raise RecordError(
            "R402",
            f"line {row}: the step is {shown:g} s, in the header above it {exact:g} s",
            "correct the one that is wrong",
        )
    return exact


SPEC: Final = Spec(
    "record",
    "CSMIP",
    "corrected CSMIP and CDMG files of California (.V2)",
    FIELDS,
    reference="Shakal and Huang 1985, Standard tape format for CSMIP strong-motion data tapes, OSMS 85-03",
    impl=Format(sniff, read),
)
