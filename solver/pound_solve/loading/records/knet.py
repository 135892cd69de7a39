"""K-NET and KiK-net files of NIED, Japan (``.NS``, ``.EW1`` and so on): one component as integers.

Seventeen lines, each a name in 18 columns and its value, are followed by integers, eight per line.
Multiplied by the ``Scale Factor`` they are accelerations in gal, including the offset of the instrument:
their mean is subtracted, as for the ``Max. Acc.`` of the header.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, Final

from pound_deck.schema import Spec
from pound_solve.loading.records.base import Format, RawRecord, RecordError
from pound_solve.loading.records.header import positive, printed
from pound_solve.loading.records.text import parse

_OPENING: Final = re.compile(r"\s*Origin Time\s+\S.*\n\s*Lat\.", re.IGNORECASE)
_LINES: Final = 17
_NAME: Final = 18
_SCALE: Final = re.compile(r"([\d.]+)\s*\(gal\)\s*/\s*([\d.]+)", re.IGNORECASE)
_RATE: Final = re.compile(r"([\d.]+)\s*Hz", re.IGNORECASE)
_RATE_LINE, _LENGTH_LINE, _DIRECTION_LINE, _SCALE_LINE, _PEAK_LINE = 11, 12, 13, 14, 15
#: KiK-net numbers its sensors: in the borehole, then at the surface
_SENSORS: Final = {
    "1": "N-S borehole",
    "2": "E-W borehole",
    "3": "U-D borehole",
    "4": "N-S",
    "5": "E-W",
    "6": "U-D",
}


def sniff(head: str) -> bool:
    """The first two lines give the time and the latitude of the event."""
    return bool(_OPENING.match(head))


def read(text: str, options: Mapping[str, Any]) -> RawRecord:
    """Samples of a K-NET or KiK-net file, mean removed.

    Raises
    ------
    RecordError
        R402 for a damaged header, R403.
    """
    lines = text.splitlines()
    if not sniff(text) or len(lines) <= _LINES:
        raise RecordError(
            "R402", f"no header of K-NET: {_LINES} lines from 'Origin Time' to 'Memo.'", "leave FORMAT out"
        )
    entries = ["", *(line[_NAME:].strip() for line in lines[:_LINES])]  # counted from 1 as lines are
    rate, scale = _RATE.fullmatch(entries[_RATE_LINE]), _SCALE.fullmatch(entries[_SCALE_LINE])
    if not rate:
        raise RecordError("R402", f"line {_RATE_LINE}: no sampling rate such as 100Hz")
    if not scale:
        raise RecordError("R402", f"line {_SCALE_LINE}: no scale factor such as 3920(gal)/6182761")
    hertz = positive(rate[1], "the rate [Hz]", _RATE_LINE)
    length = positive(entries[_LENGTH_LINE], "the duration [s]", _LENGTH_LINE)
    gal = positive(scale[1], "the full scale", _SCALE_LINE) / positive(scale[2], "its count", _SCALE_LINE)
    readings, _ = parse(lines[_LINES:], _LINES + 1)
    direction = entries[_DIRECTION_LINE]
    return RawRecord(
        (readings - readings.mean()) * gal,
        dt=1 / hertz,
        unit="CM/S2",
        declared=round(hertz * length),
        component=f"{_SENSORS.get(direction, direction)}, mean removed",
        title=tuple(" ".join(line.split()) for line in lines[:_LINES]),
        peak=printed(entries[_PEAK_LINE]),
    ).checked()


SPEC: Final = Spec(
    "record",
    "KNET",
    "K-NET and KiK-net files of NIED, Japan; the mean is removed",
    reference="National Research Institute for Earth Science and Disaster Resilience, K-NET ASCII format",
    impl=Format(sniff, read),
)
