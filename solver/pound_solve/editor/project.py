"""Open files of the editor: their texts, the deck that each belongs to, and the mistakes last sent."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from pound_deck.diagnostics import Diagnostic
from pound_deck.source import DeckSource
from pound_solve.catalog import catalog
from pound_solve.editor.diagnose import diagnose
from pound_solve.editor.reading import Reading, read

Found = dict[str, list[Diagnostic]]  #: by real path


@dataclass(slots=True)
class Project:
    """The open files of an editor, by real path.

    Attributes
    ----------
    records : tuple of Path
        Folders searched for records, after that of the deck.
    texts : dict of str to str
        Texts in the editor, saved or not; line ends are ``\\n``.
    """

    records: tuple[Path, ...] = ()
    texts: dict[str, str] = field(default_factory=dict)
    _diagnostics: dict[str, Found] = field(default_factory=dict)  # by deck
    _published: Found = field(default_factory=dict)
    _decks: dict[str, str] = field(default_factory=dict)
    _readings: dict[str, Reading] = field(default_factory=dict)

    def put(self, path: str, text: str) -> None:
        """Store the present text of a file in the editor."""
        if path not in self.texts:
            self._decks.clear()
        self.texts[path] = text.replace("\r\n", "\n").replace("\r", "\n")
        self._readings.clear()

    def drop(self, path: str) -> None:
        """Remove a file that the editor has closed."""
        self.texts.pop(path, None)
        self._published.pop(path, None)
        self._decks.clear()
        self._readings.clear()

    def text(self, path: str) -> str:
        """Text of a file: the editor's, or that of the deck that includes it."""
        if path in self.texts:
            return self.texts[path]
        read_now = (r.files[n] for r in self._readings.values() for n in r.files_at(path))
        return next(read_now, "")

    def reading(self, path: str) -> Reading:
        """Reading of the deck that a file belongs to, with the present texts of the editor."""
        deck = self.deck(path)
        if deck not in self._readings:
            self._readings[deck] = read(deck, catalog(), self.texts)
        return self._readings[deck]

    def deck(self, path: str) -> str:
        """Path of the deck that a file belongs to.

        A file with ANALYSIS is a deck.  Another one belongs to an open deck that includes it, or to the
        first deck of its folder that does; else it counts as a deck.
        """
        if path not in self._decks:
            self._decks[path] = next(self._including(path), path)
        return self._decks[path]

    def _including(self, path: str) -> Iterator[str]:
        lines = DeckSource().logical(path, self.texts.get(path, ""))
        if any(line.text.split()[0].upper() == "ANALYSIS" for line in lines):
            return
        folder = Path(path).parent
        beside = sorted(str(p) for p in folder.glob("*.inp")) if folder.is_dir() else []
        for other in dict.fromkeys((*self.texts, *beside)):
            if other != path and path in _files(other, self.texts):
                yield other

    def check(self, path: str) -> Found:
        """Check the decks that a file belongs to; return its mistakes, and those of files that changed."""
        decks = {self.deck(p) for p in self.texts}
        own_deck = self.deck(path) if path in self.texts else ""
        changed = {deck for deck in decks if deck == own_deck or path in self._diagnostics.get(deck, {})}
        touched = {
            name
            for deck in [*self._diagnostics]
            if deck not in decks
            for name in self._diagnostics.pop(deck)
        }
        for deck in sorted(changed):
            touched |= set(self._diagnostics.get(deck, {}))
            self._diagnostics[deck] = self._diagnosed(deck)
            touched |= set(self._diagnostics[deck])
        now = {name: self._of_file(name) for name in sorted(touched)}
        news = {
            name: notes for name, notes in now.items() if name == path or notes != self._published.get(name)
        }
        self._published.update(now)
        return news

    def _diagnosed(self, deck: str) -> Found:
        try:
            diagnostics, files = diagnose(deck, self.texts, self.records)
        except OSError:  # deleted while open
            return {}
        by_file: Found = {os.path.realpath(name): [] for name in files if not name.startswith("--")}
        for d in diagnostics:
            by_file.setdefault(os.path.realpath(d.span.file) if d.span else deck, []).append(d)
        return by_file

    def _of_file(self, name: str) -> list[Diagnostic]:
        return list(dict.fromkeys(d for notes in self._diagnostics.values() for d in notes.get(name, ())))


def _files(deck: str, texts: dict[str, str]) -> set[str]:
    """Real paths of a deck and of the files that it includes."""
    source = DeckSource(unsaved=texts)
    try:
        source.read(deck)
    except OSError:
        return set()
    return {os.path.realpath(name) for name in source.files}
