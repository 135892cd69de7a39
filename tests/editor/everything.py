"""Every kind of help that an editor may ask for at one place of a deck, whatever the deck is."""

from pound_deck.layout import layout
from pound_deck.messages import MESSAGES
from pound_deck.model import Span
from pound_solve.catalog import catalog
from pound_solve.editor.complete import complete
from pound_solve.editor.definition import define, references
from pound_solve.editor.diagnose import MAX_DIAGNOSTICS, diagnose
from pound_solve.editor.hover import hover
from pound_solve.editor.reading import read
from pound_solve.editor.rename import RenameError, renamable, rename
from pound_solve.editor.symbols import outline


def ask_everything(path, text, place):
    """Every kind of help at one place of a text."""
    unsaved = {str(path): text}
    reading = read(str(path), catalog(), unsaved)
    found, files = diagnose(str(path), unsaved)
    assert {d.code for d in found} <= MESSAGES.keys() and len(found) <= MAX_DIAGNOSTICS
    for d in found:
        lines = files[d.span.file].split("\n") if d.span and d.span.file in files else None
        assert lines is None or (1 <= d.span.line <= len(lines) and 1 <= d.span.column < d.span.end)
    suggestions, start = complete(reading, text, place.line, place.column)
    assert start <= place.column and len({s.text for s in suggestions}) == len(suggestions)
    hover(reading, place)
    here = references(reading, place)
    assert set(define(reading, place)) <= set(here)
    name = renamable(reading, place)
    try:
        edits = rename(reading, str(path), place, "zz9" if name else "1")
        assert name in {span for span, _ in edits}
    except RenameError as error:
        assert str(error)
    lines = text.split("\n")
    for symbol in outline(reading, str(path)):
        assert symbol.span.line <= symbol.last <= len(lines)
    layout(text, str(path))


def place_in(path, text, at):
    before = text[:at]
    column = at - before.rfind("\n")
    return Span(str(path), before.count("\n") + 1, column, column + 1)
