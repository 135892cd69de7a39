"""Whether a run would write over what it reads."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Model, Span
from pound_solve.driver.request import Request
from pound_solve.loading.motions.base import LoadingContext
from pound_solve.loading.records.base import RecordError
from pound_solve.loading.records.known import find
from pound_solve.results.place import partial


def overwritten(model: Model, request: Request, context: LoadingContext) -> list[Diagnostic]:
    """The deck, an included file, a record or a saved state that an output file would replace.

    Results may replace those that a RESTART goes on from: these are read before and stand until the end.
    """
    results, report = request.path(".h5"), request.path(".rpt")
    own = {path.resolve() for path in (results, report, partial(results), partial(report))}
    return [
        Diagnostic(
            "R407", f"{path} is both read and written by this run", span, "rename one of them, or use -o"
        )
        for path, span in _read(model, request, context)
        if path.resolve() in own
    ]


def _read(model: Model, request: Request, context: LoadingContext) -> Iterator[tuple[Path, Span | None]]:
    """Files that the run reads, and where the deck names them."""
    for name in model.files:
        yield Path(name), None
    for card in (*model.equake, *model.forces):
        if card.values.get("FILE"):
            with suppress(RecordError):  # told where it is read
                yield find(str(card["FILE"]), context.search_path), card.place("FILE")
    for card in model.analyses:
        path = Path(request.deck).parent / str(card.values.get("RESTART") or "")
        if card.values.get("RESTART") and path.resolve() != request.path(".h5").resolve():
            yield path, card.place("RESTART")
