"""Checks that a run does not overwrite files that it reads, or files of other programs."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Final

from pound_deck.diagnostics import Diagnostic
from pound_deck.files import opened
from pound_deck.model import Model, Span
from pound_solve.driver.request import Request
from pound_solve.loading.motions.base import LoadingContext
from pound_solve.loading.records.base import RecordError
from pound_solve.loading.records.known import find
from pound_solve.results.form import FILETYPE
from pound_solve.results.whole_file import partial

START: Final = 2**16  #: leading bytes of a file that contain our mark
#: marks of our files, keyed by ending
MARKS: Final = {".h5": FILETYPE.encode(), ".rpt": b"POUND-SOLVE"}


def overwritten(model: Model, request: Request, context: LoadingContext) -> list[Diagnostic]:
    """Report a deck, an included file, a record or a saved state that an output would overwrite.

    Results may replace those from which a RESTART continues: the run reads these first and keeps them until
    its end.
    """
    results, report = request.path(".h5"), request.path(".rpt")
    outputs = {path.resolve() for path in (results, report, partial(results), partial(report))}
    return [
        Diagnostic(
            "R407", f"{path} is both read and written by this run", span, "rename one of them, or use -o"
        )
        for path, span in _read(model, request, context)
        if path.resolve() in outputs
    ]


def taken(request: Request) -> list[Diagnostic]:
    """Report files of other programs at the paths of results and report."""
    marks = {request.path(suffix): mark for suffix, mark in MARKS.items()}
    return [
        Diagnostic(
            "R411",
            f"{path} is no file of this program, and has the name of one that this run writes",
            None,
            "rename it, or use -o",
        )
        for path, mark in marks.items()
        if _of_others(path, mark)
    ]


def _of_others(path: Path, mark: bytes) -> bool:
    """Whether a path is a non-empty file without our mark, a folder, a pipe or a device."""
    if not path.is_file():
        return path.exists()
    with suppress(OSError), opened(path) as file:
        start = file.read(START)
        return bool(start) and mark not in start
    return False


def _read(model: Model, request: Request, context: LoadingContext) -> Iterator[tuple[Path, Span | None]]:
    """Yield the files that the run reads, with the places where the deck names them."""
    for name in model.files:
        yield Path(name), None
    for card in (*model.equake, *model.forces):
        if card.values.get("FILE"):
            with suppress(RecordError):  # reported on reading
                yield find(str(card["FILE"]), context.search_path), card.place("FILE")
    for card in model.analyses:
        path = Path(request.deck).parent / str(card.values.get("RESTART") or "")
        if card.values.get("RESTART") and path.resolve() != request.path(".h5").resolve():
            yield path, card.place("RESTART")
