"""GeoNet / GNS Science accelerograms of New Zealand (``.V1A`` uncorrected, ``.V2A`` corrected).

Three blocks, one a component.  A block has 16 lines of text, 4 of ten integers and 6 of ten reals, all in
columns of 8, then accelerations [mm/s2], velocities and displacements, ten a line in columns of 8 too.
Of the integers, the 34th to 36th count the three kinds of samples; of the reals the 25th is the step of the
raw samples and the 26th that of the ones in the file.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from pound_deck.schema import Spec
from pound_solve.loading.records.base import Format, RawRecord, RecordError
from pound_solve.loading.records.header import FIELDS, choose, filled, parts, positive
from pound_solve.loading.records.text import fixed, parse
from pound_solve.numerics.types import Array

_OPENING: Final = re.compile(r"\b(?:un)?corrected accelerogram\b", re.IGNORECASE)
_COMPONENT: Final = re.compile(r"^\s*Component\s+(\S+)", re.IGNORECASE)
_READING: Final = re.compile(r"in units of\s+([\d.]+)\s*mm/s", re.IGNORECASE)
_TEXT, _INTEGERS, _REALS = 16, 4, 6
_WIDTH: Final = 8


@dataclass(frozen=True, slots=True)
class _GeonetBlock:
    """Lines of one component and the line number of the first."""

    lines: list[str]
    first: int

    @property
    def component(self) -> str:
        """Name of the component, e.g. ``N28W``."""
        return next((m[1] for line in self.lines[:_TEXT] if (m := _COMPONENT.match(line))), "")

    def numbers(self, start: int, stop: int | None = None) -> Array:
        """Numbers of some of the lines; columns of eight characters, which need no blank between."""
        return parse(fixed(self.lines[start:stop], _WIDTH), self.first + start)[0]


def sniff(head: str) -> bool:
    """Return whether the first line names an accelerogram of GNS Science."""
    line = head.lstrip().partition("\n")[0]
    return bool(_OPENING.search(line)) and "gns" in line.lower()


def read(text: str, options: Mapping[str, Any]) -> RawRecord:
    """Samples of one component.

    Parameters
    ----------
    text : str
    options : mapping
        ``COMPONENT``: number from 1, name, or None for the first horizontal one.

    Raises
    ------
    RecordError
        R402, R403 where a block does not hold what its integers count, R405 for an unknown component.
    """
    # the words occur again in the text of a header, but not on its first line
    blocks = [_GeonetBlock(*part) for part in parts(text.splitlines(), _OPENING.search)]
    if not blocks:
        raise RecordError(
            "R402", "no line 'Corrected accelerogram' or 'Uncorrected accelerogram' in the file"
        )
    block = blocks[choose([b.component for b in blocks], options.get("COMPONENT"))]
    body = _TEXT + _INTEGERS + _REALS
    if len(block.lines) <= body:
        raise RecordError("R403", f"the file ends in the header of component {block.component or 1}")
    integers = block.numbers(_TEXT, _TEXT + _INTEGERS)
    reals = block.numbers(_TEXT + _INTEGERS, body)
    if len(integers) != 10 * _INTEGERS or len(reals) != 10 * _REALS:
        raise RecordError(
            "R403",
            f"line {block.first + _TEXT}: the header has {len(integers)} integers and {len(reals)} reals, "
            f"not {10 * _INTEGERS} and {10 * _REALS}",
        )
    acceleration, velocity, displacement = (int(n) for n in integers[33:36])
    numbers = block.numbers(body)
    total = acceleration + velocity + displacement
    if len(numbers) != total:
        raise RecordError(
            "R403",
            f"component {block.component}: the header declares {total} values "
            f"({acceleration} accelerations, {velocity} velocities, {displacement} displacements), "
            f"the file holds {len(numbers)}",
        )
    dt = float(reals[25] or reals[24])
    if dt <= 0:
        raise RecordError(
            "R402", f"line {block.first + _TEXT + _INTEGERS + 2}: the step is {dt:g} s, not above zero"
        )
    title = filled(block.lines[:_TEXT])
    reading = _READING.search(" ".join(title))
    factor = positive(reading[1], "the unit of the readings", block.first) if reading else 1.0
    return RawRecord(
        numbers[:acceleration] * factor,
        dt=dt,
        unit="MM/S2",
        declared=acceleration,
        component=block.component,
        title=title,
    ).checked()


SPEC: Final = Spec(
    "record",
    "GEONET",
    "GeoNet .V1A and .V2A files of New Zealand",
    FIELDS,
    reference="GNS Science, Accelerogram data files: standard format, 2012",
    impl=Format(sniff, read),
)
