"""Decks of the editor's tests and the place of a word in them."""

from pathlib import Path

import pytest

from pound_deck.model import Span
from pound_solve.catalog import catalog
from pound_solve.editor.reading import read

ROOT = Path(__file__).parents[2]


def example_decks():
    return sorted((ROOT / "examples").rglob("*.inp"))


def reading_of(text, path="/deck.inp"):
    return read(str(path), catalog(), {str(path): text})


@pytest.fixture
def at():
    """Reading of a text without its mark ``^``, that text, and the place of the mark."""

    def found(text):
        before = text[: text.index("^")]
        column = len(before) - before.rfind("\n")
        text = text.replace("^", "", 1)
        return reading_of(text), text, Span("/deck.inp", before.count("\n") + 1, column, column + 1)

    return found
