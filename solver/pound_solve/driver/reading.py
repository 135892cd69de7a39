"""From the file of a deck, of this program or of Ruaumoko-2D, to its model."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

from pound_deck.diagnostics import Diagnostic, Mistake, has_errors
from pound_deck.model import Model, Span
from pound_deck.reader import read_deck, read_text
from pound_import.ruaumoko.files import recognised, text_of
from pound_solve.catalog import catalog
from pound_solve.driver.request import Request

if TYPE_CHECKING:
    from pound_import.ruaumoko.equake import File
    from pound_import.translation import Translation

#: endings of models that only `import` reads, with their programs
OF_OTHERS: Final = {".tcl": "OpenSees", ".py": "OpenSees", ".s2k": "SAP2000", ".$2k": "SAP2000"}
AS_READ: Final = " as read"  #: suffix of the name of a deck converted from an old one


class ReadDeck(NamedTuple):
    """A deck as read.

    Attributes
    ----------
    model : Model or None
        None if there are mistakes.
    diagnostics : list of Diagnostic
    files : dict of str to str
        Texts, keyed by the names in spans.
    translation : Translation or None
        The translation of an old deck.
    """

    model: Model | None
    diagnostics: list[Diagnostic]
    files: dict[str, str]
    translation: Translation | None = None

    def moved(self, diagnostics: Sequence[Diagnostic], name: str) -> list[Diagnostic]:
        """Return diagnostics with lines of the user's file `name`, if that is an old deck."""
        return (
            self.translation.moved(diagnostics, name + AS_READ) if self.translation else list(diagnostics)
        )


def is_deck(name: str) -> bool:
    """Whether a file is a deck (by its ending) or an old one (by its first lines)."""
    return name.endswith(".inp") or (os.path.isfile(name) and recognised(name))


def read(request: Request) -> ReadDeck:
    """Read the deck of a request.

    Raises
    ------
    OSError
        The deck cannot be read.
    """
    name = request.deck
    if Path(name).suffix.lower() in OF_OTHERS:
        what = f"{Path(name).name} is a model of {OF_OTHERS[Path(name).suffix.lower()]}, not a deck"
        hint = f"pound-solve import {Path(name).name} -o model.inp makes a deck of it"
        return ReadDeck(None, [Diagnostic("L626", what, Span(name, 1, 1, 2), hint)], {})
    if os.path.realpath(name) in request.unsaved or not recognised(name):
        return ReadDeck(*read_deck(name, catalog(), request.params, request.unsaved))
    text, old = ruaumoko(name, shown=Path(name).name, run=True)
    files = {name: text}
    if has_errors(old.report):
        return ReadDeck(None, list(old.report), files, old)
    model, diagnostics, more = read_text(old.text, catalog(), request.params, name + AS_READ)
    deck = ReadDeck(model, diagnostics, more | files, old)
    return deck._replace(diagnostics=[*old.report, *deck.moved(diagnostics, name)])


def ruaumoko(
    name: str, records: Sequence[File] = (), shown: str = "", run: bool = False
) -> tuple[str, Translation]:
    """Return the text of an old deck, and its translation; see `translate`.

    Raises
    ------
    OSError
        A file cannot be read.
    """
    from pound_import.ruaumoko.importer import translate  # only old decks need it
    from pound_import.translation import Translation

    try:
        text = text_of(name)
    except Mistake as error:
        return "", Translation("", (), tuple([error.diagnostic] if error.diagnostic else []))
    return text, translate(name, text, catalog(), records, shown, run)
