"""Format of a record's file that is named beside an old deck."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from pound_deck.diagnostics import mistake
from pound_deck.model import Span

if TYPE_CHECKING:
    from pound_import.ruaumoko.equake import Samples

_RISING: Final = 0.75  #: share of rises in a column of times; it is a half in accelerations


def recognise(path: Path, stated: Mapping[str, Any]) -> Samples | None:
    """Samples of a record's file in a format of its own; None for one in the format of an old deck.

    Parameters
    ----------
    path : Path
    stated : mapping
        Items of a RECORD card: the format that the deck states.

    Raises
    ------
    Mistake
        L613 at its line in the file: it is neither.
    """
    from pound_import.ruaumoko.equake import Samples
    from pound_solve.loading.records import formats
    from pound_solve.loading.records.base import RecordError, head
    from pound_solve.loading.records.known import load

    known = formats()

    def is_table(text: str) -> bool:
        """Whether a file can be read as stated; one with a header is read by that header only."""
        if any(s.impl.sniff(head(text.lstrip())) for s in known.values() if not s.impl.greedy):
            return False
        try:
            known[stated["FORMAT"]].impl.read(text, stated)
        except RecordError:
            return False
        return stated.get("COLUMN") != 0 or not _timed(text)  # COLUMN=0 takes times for accelerations

    try:
        text, _ = load(path)
        if is_table(text):
            return None
        raw = known["AUTO"].impl.read(text, {})
        return Samples(raw.format, raw.unit, raw.t.tolist())
    except RecordError as error:
        line = re.search(r"\bline (\d+)", error.message)
        place = Span(str(path), int(line[1]) if line else 1, 1, 2)
        raise mistake("L613", error.message, place, error.hint) from None


def _timed(text: str) -> bool:
    """Whether lines of several numbers begin with rising ones, but for slips: these are times."""
    from pound_solve.loading.records.text import parse, split_head

    _, data, first = split_head(text.splitlines())
    values, counts = parse(data, first)
    lengths = [n for n in counts if n]
    rises = np.diff(values[np.cumsum([0, *lengths[:-1]])]) > 0.0
    return max(lengths) > 1 and rises.size > 0 and bool(rises.mean() > _RISING)
