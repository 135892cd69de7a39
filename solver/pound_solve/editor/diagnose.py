"""Mistakes of a deck as ``pound-solve check`` tells them, of the text that the editor holds."""

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
MOST: Final = 100  #: messages of a deck


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
        Folders where records are looked for, after the deck's own.

    Returns
    -------
    diagnostics : list of Diagnostic
        At most `MOST`, errors first.
    files : mapping of str to str
        Texts by the name in spans: those of the deck and of all that it includes.

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
    return sorted(diagnostics, key=lambda d: d.severity != "error")[:MOST], files
