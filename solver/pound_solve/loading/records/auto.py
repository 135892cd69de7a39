"""AUTO: recognise the format of a file by its first lines, and read it as such."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from pound_deck.schema import Spec
from pound_solve.loading.records import columns, foreign, formats, header
from pound_solve.loading.records.base import Format, RawRecord, RecordError, head


def sniff(head: str) -> bool:
    """Return False: AUTO tries the other formats."""
    return False


def read(text: str, options: Mapping[str, Any]) -> RawRecord:
    """Samples of a file of any known format.

    Raises
    ------
    RecordError
        R402 if no format matches the file, else any error of the format's reader.
    """
    if not text.strip():
        raise RecordError("R402", "the file is empty")
    start = head(text.lstrip())  # LINES leaves blank ones
    if foe := foreign.unread(start):
        raise foe
    known = formats()
    for spec in sorted(known.values(), key=lambda s: (s.impl.greedy, s.name)):
        if spec.impl.sniff(start):
            asked = {f.name for f in SPEC.fields if options.get(f.name, f.default) != f.default}
            if odd := sorted(asked - {f.name for f in spec.fields}):
                raise RecordError(
                    "R405", f"the file is {spec.name}, which takes no {', '.join(odd)}", "leave it out"
                )
            raw: RawRecord = spec.impl.read(text, options)
            return raw.named(spec.name)
    names = ", ".join(name for name in sorted(known) if name != SPEC.name)
    try:
        # rows of uneven length look like no format, but COLUMN=0 makes sense of them
        return columns.read(text, options).named(columns.SPEC.name)
    except RecordError as why:
        raise RecordError(
            "R402",
            f"the format of the file is not recognised ({names} were tried; COLUMNS: {why.message})",
            "name it with FORMAT=, or turn the file into two columns of time and acceleration",
        ) from None


SPEC: Final = Spec(
    "record", "AUTO", "recognised by content", columns.FIELDS + header.FIELDS, impl=Format(sniff, read)
)
