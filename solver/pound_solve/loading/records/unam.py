"""Standard acceleration files of the UNAM, Mexico: channels side by side, in gal.

Lines of a name, a colon and a value, which has a slash before each channel; a line that announces the
accelerations, the names of the channels between two rules, and a row for each sample.
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
    unit,
)
from pound_solve.loading.records.text import fixed

_OPENING: Final = re.compile(r"ARCHIVO ESTANDAR DE ACELERACION", re.IGNORECASE)
_DATA: Final = re.compile(r"DATOS DE ACELERACION", re.IGNORECASE)
_ENTRY: Final = re.compile(r"(.{39}):(.*)")
_NAMES, _STEP, _COUNT, _PEAK, _UNIT, _THINNED, _LAYOUT = (
    "ORIENTACION C",
    "INTERVALO DE MUESTREO, C",
    "NUM. TOTAL DE MUESTRAS, C",
    "ACEL. MAX.(GAL), C",
    "UNIDADES DE LOS DATOS",
    "FACTOR DE DECIMACION",
    "FORMATO DATOS",
)
_LONGEST: Final = 200
_RULED: Final = 5  # lines from the announcement to the first row


def sniff(head: str) -> bool:
    """One of the first lines names the kind of the file."""
    return any(_OPENING.match(line) for line in head.splitlines()[:12])


def read(text: str, options: Mapping[str, Any]) -> RawRecord:
    """Samples of one channel.

    Parameters
    ----------
    text : str
    options : mapping
        ``COMPONENT``: number from 1, name such as ``N90E``, or None for the first horizontal one.

    Raises
    ------
    RecordError
        R402 for a damaged header, R403, R405 for an unknown channel.
    """
    lines = text.splitlines()
    at = next((k for k, line in enumerate(lines[:_LONGEST]) if _DATA.match(line)), None)
    if at is None:
        raise RecordError("R402", "no line 'DATOS DE ACELERACION' in the header", "leave FORMAT out")
    matched = ((number, _ENTRY.match(line)) for number, line in enumerate(lines[:at], 1))
    entries = [(m[1].upper(), m[2], number) for number, m in matched if m]
    names, steps, counts, peaks = (_channels(entries, key) for key in (_NAMES, _STEP, _COUNT, _PEAK))
    if not names or not len(names) == len(steps) == len(counts):
        raise RecordError(
            "R402",
            f"the header has {len(names)} channels, {len(steps)} steps and {len(counts)} counts of samples",
        )
    thinned = _value(entries, _THINNED)
    if thinned not in ("", "1"):
        raise RecordError(
            "R402", f"{_THINNED} is {thinned}, not 1", "give FORMAT=COLUMNS with COLUMN, DT and UNIT=GAL"
        )
    words = _value(entries, _UNIT)
    if not (samples_in := unit(words.partition("(")[0])):
        raise RecordError("R402", f"the unit '{words[:20]}' is no known one of acceleration")
    k = choose([name for name, _ in names], options.get("COMPONENT"))
    layout = re.search(r"F(\d{1,2})\.", _value(entries, _LAYOUT))
    start = at + _RULED
    rows = fixed(lines[start:], int(layout[1]) or 1) if layout else lines[start:]
    return RawRecord(
        side_by_side(rows, start + 1, [name for name, _ in names], k),
        dt=positive(steps[k][0], "the step [s]", steps[k][1]),
        unit=samples_in,
        declared=count(counts[k][0], "the count of samples", counts[k][1]),
        component=names[k][0],
        title=filled(lines[:at], "*= "),
        peak=printed(peaks[k][0]) if len(peaks) == len(names) and samples_in == "CM/S2" else "",
    ).checked()


def _channels(entries: list[tuple[str, str, int]], key: str) -> list[tuple[str, int]]:
    """Words of all channels in the entries whose names begin so, each with its line number."""
    # ACEL. MAX. is given twice: the peaks, and the samples at which they occur
    chosen = [(value, line) for name, value, line in entries if name.startswith(key)]
    return [(word.strip(), line) for value, line in chosen for word in value.split("/")[1:]]


def _value(entries: list[tuple[str, str, int]], key: str) -> str:
    """Value of the first entry whose name begins so, or empty."""
    return next((value.strip() for name, value, _ in entries if name.startswith(key)), "")


SPEC: Final = Spec(
    "record",
    "UNAM",
    "standard acceleration files of the UNAM, Mexico",
    FIELDS,
    reference="Instituto de Ingenieria, UNAM, RAII-UNAM accelerogram database: standard file 2.0",
    impl=Format(sniff, read),
)
