"""Mistakes of a deck as in ``pound-solve check``, for the text in the editor."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Final

from pound_deck.diagnostics import Diagnostic, has_errors
from pound_deck.reader import read_deck
from pound_solve.catalog import catalog
from pound_solve.driver.prepare import DeckError, assembled
from pound_solve.driver.request import Request

MANY: Final = 2000  #: nodes beyond which the structure is not assembled: a number may be half typed
MAX_DIAGNOSTICS: Final = 100  #: most messages of a deck


def diagnose(
    path: str, unsaved: Mapping[str, str], records: tuple[Path, ...] = ()
) -> tuple[list[Diagnostic], Mapping[str, str]]:
    """Mistakes and warnings of a deck.

    Parameters
    ----------
    path : str
    unsaved : mapping of str to str
        Texts of the editor by real path.
    records : tuple of Path
        Folders searched for records, after that of the deck.

    Returns
    -------
    diagnostics : list of Diagnostic
        At most `MAX_DIAGNOSTICS`, errors first.
    files : mapping of str to str
        Texts of the deck and of included files, by the name in spans.

    Raises
    ------
    OSError
        The deck cannot be read.
    """
    request = Request(path, records=records, unsaved=unsaved)
    model, diagnostics, files = read_deck(path, catalog(), unsaved=unsaved)
    if model is not None and not has_errors(diagnostics) and len(model.nodes) <= MANY:
        try:
            diagnostics = list(assembled(request, model, diagnostics, files).warnings)
        except DeckError as error:
            diagnostics = list(error.diagnostics)
    return sorted(diagnostics, key=lambda d: d.severity != "error")[:MAX_DIAGNOSTICS], files
