"""BERG files (``.EQB`` of Ruaumoko): time and acceleration in turn, four pairs a line."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from pound_deck.schema import Spec
from pound_solve.loading.records.base import Format, RawRecord, RecordError
from pound_solve.loading.records.text import is_data, parse, split_head

_PER_LINE: Final = 8


def sniff(head: str) -> bool:
    """Return whether lines have eight numbers, of which every other one increases from line to line too."""
    _, data, _ = split_head(head.splitlines())
    rows = [line for line in data if line.strip()]
    if not rows or not all(map(is_data, rows)):
        return False
    try:
        values, counts = parse(rows)
    except RecordError:
        return False
    full = all(n == _PER_LINE for n in counts[:-1]) and counts[-1] <= _PER_LINE and counts[-1] % 2 == 0
    # one short line may be a row of a table
    return full and counts[0] == _PER_LINE and bool((np.diff(values[::2]) > 0).all())


def read(text: str, options: Mapping[str, Any]) -> RawRecord:
    """Samples of a BERG file.

    Raises
    ------
    RecordError
        R402, R403 for a time without an acceleration.
    """
    title, data, first = split_head(text.splitlines())
    values, _ = parse(data, first)
    if len(values) % 2:
        raise RecordError("R403", f"{len(values)} numbers are no whole pairs of time and acceleration")
    return RawRecord(values[1::2].copy(), times=values[::2].copy(), title=tuple(title)).checked()


SPEC: Final = Spec(
    "record",
    "BERG",
    "time-acceleration pairs, four per line (Ruaumoko .EQB)",
    code=1,
    reference="Carr, Ruaumoko manual: earthquake records",
    impl=Format(sniff, read, greedy=True),
)
