"""Solve a pound-solve model: compute results, report and pictures from the checked Model."""

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
        Path of an input deck, or a deck without a file: a `Deck`, or its sections as for
        `Deck.from_sections`.
    params : mapping, optional
        PARAM values that replace the deck's, keyed by name.
    out : str or Path, optional
        Folder of ``<deck>.rpt`` and ``<deck>.h5``; by default the deck's own.  Results of a deck without a
        file then go to a temporary folder, which is removed with the returned object.
    name : str, optional
        Name of these files instead of the deck's, to keep runs of one deck separate.
    records : sequence of str or Path, optional
        Folders to search for records, after the deck's.
    method : str, optional
        Replaces METHOD of HISTORY.
    dt : float, optional
        Replaces DT of HISTORY [T].
    tol : float, optional
        Replaces TOL of HISTORY.

    Returns
    -------
    Results
        The opened results file; ``results.status`` is ``done`` or ``stopped``.  It stays unchanged when
        another run writes its results under the same name.

    Raises
    ------
    ValueError
        The name is not a valid file name.
    DeckError
        The deck has mistakes; the message gives file, line and column of each.
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
