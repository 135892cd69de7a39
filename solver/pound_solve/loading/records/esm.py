"""Files of the Engineering Strong-Motion database and of AFAD's portal (``.ASC``, DYNA 1.2 and before).

Lines of a name in capitals, a colon and a value, then one sample a line.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, Final

from pound_deck.schema import Spec
from pound_solve.loading.records.base import Format, RawRecord, RecordError
from pound_solve.loading.records.header import count, positive, printed, unit
from pound_solve.loading.records.text import parse

_ENTRY: Final = re.compile(r"([A-Z][A-Z0-9_/^]*) *:(.*)")
_LONGEST: Final = 200
_STEP, _COUNT, _UNIT = "SAMPLING_INTERVAL_S", "NDATA", "UNITS"


def _entries(lines: list[str]) -> dict[str, tuple[str, int]]:
    """Values of the header by name, each with its line number."""
    entries: dict[str, tuple[str, int]] = {}
    for number, line in enumerate(lines[:_LONGEST], 1):
        if not (entry := _ENTRY.match(line)):
            break
        entries[entry[1]] = entry[2].strip(), number
    return entries


def sniff(head: str) -> bool:
    """The first line names the event, and step and count of the samples follow."""
    return head.startswith("EVENT_NAME") and {_STEP, _COUNT} <= _entries(head.splitlines()).keys()


def read(text: str, options: Mapping[str, Any]) -> RawRecord:
    """Samples of an ESM file.

    Raises
    ------
    RecordError
        R402 for a damaged header or another quantity than acceleration, R403.
    """
    lines = text.splitlines()
    entries = _entries(lines)
    if missing := [name for name in (_STEP, _COUNT, _UNIT) if name not in entries]:
        raise RecordError("R402", f"no {' and '.join(missing)} in the header", "leave FORMAT out")
    quantity, row = entries.get("DATA_TYPE", ("ACCELERATION", 0))
    if quantity.upper() != "ACCELERATION":
        raise RecordError("R402", f"line {row}: the file holds '{quantity[:40]}'", "get the acceleration")
    words, row = entries[_UNIT]
    if not (samples_in := unit(words)):
        raise RecordError("R402", f"line {row}: the unit '{words[:20]}' is no known one of acceleration")
    values, _ = parse(lines[len(entries) :], len(entries) + 1)
    return RawRecord(
        values,
        dt=positive(entries[_STEP][0], _STEP, entries[_STEP][1]),
        unit=samples_in,
        declared=count(entries[_COUNT][0], _COUNT, entries[_COUNT][1]),
        component=entries.get("STREAM", ("", 0))[0],
        title=tuple(f"{name}: {value}" for name, (value, _) in entries.items() if value),
        peak=printed(entries.get("PGA_CM/S^2", ("", 0))[0]) if samples_in == "CM/S2" else "",
        length=printed(entries.get("DURATION_S", ("", 0))[0]),
    ).checked()


SPEC: Final = Spec(
    "record",
    "ESM",
    "files of the Engineering Strong-Motion database and of AFAD's portal (DYNA)",
    reference="Luzi et al. 2016, The Engineering Strong-Motion Database, Seismol. Res. Lett. 87(4)",
    impl=Format(sniff, read),
)
