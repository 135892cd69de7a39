"""Solve a pound-solve model: from the checked Model to results, report and pictures."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING

from pound_solve.deck import PLACE
from pound_solve.deck import Deck as Deck
from pound_solve.version import __version__ as __version__

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from pound_solve.results import Results


def run(
    deck: str | Path | Deck | Mapping[str, object],
    params: Mapping[str, object] | None = None,
    *,
    out: str | Path | None = None,
    name: str | None = None,
    records: Sequence[str | Path] = (),
    method: str | None = None,
    dt: float | None = None,
    tol: float | None = None,
) -> Results:
    """Run a deck and return its results.

    Parameters
    ----------
    deck : str, Path, Deck or mapping
        Path of an input deck, or a deck that is no file: a `Deck`, or its sections as for
        `Deck.from_sections`.
    params : mapping, optional
        PARAM values that replace the deck's, by name.
    out : str or Path, optional
        Folder of ``<deck>.rpt`` and ``<deck>.h5``; the deck's own if left out.  Results of a deck that is
        no file then stand in a temporary folder, which goes with the returned object.
    name : str, optional
        Name of these files in place of the deck's, so that runs of one deck keep apart.
    records : sequence of str or Path, optional
        Folders where records are looked for, after the deck's.
    method : str, optional
        Replaces METHOD of HISTORY.
    dt : float, optional
        Replaces DT of HISTORY [T].
    tol : float, optional
        Replaces TOL of HISTORY.

    Returns
    -------
    Results
        The results file, opened; ``results.status`` is ``done`` or ``stopped``.  It stays as it is when
        another run writes its results under the same name.

    Raises
    ------
    ValueError
        The name is none for a file.
    DeckError
        The deck has mistakes; the text names file, line and column of each.
    OSError
        A file cannot be read or written.
    """
    # imported here: ``pound-solve --version`` must not wait for numpy
    from pathlib import Path

    from pound_solve.driver.run import Request, execute, in_temporary_folder

    texts = {name: str(value) for name, value in (params or {}).items()}
    folders = tuple(Path(r) for r in records)
    folder = None if out is None else Path(out)
    if isinstance(deck, Mapping):
        deck = Deck.from_sections(deck)
    if not isinstance(deck, Deck):
        return execute(Request(str(deck), texts, folder, folders, method, dt, tol, name=name))[1]
    unsaved = {os.path.realpath(PLACE): deck.text}
    stem = deck.name if name is None else name
    request = Request(PLACE, texts, folder, folders, method, dt, tol, unsaved=unsaved, name=stem)
    return in_temporary_folder(request) if folder is None else execute(request)[1]
