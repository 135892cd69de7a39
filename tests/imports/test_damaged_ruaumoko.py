"""Old decks changed at random: each is read or told, with places that exist; nothing else happens."""

from __future__ import annotations

import random

import pytest

from imports.damage import damaged
from imports.ruaumoko_decks import IN_SPACE, OSCILLATOR, PORTAL, STICK
from pound_deck.diagnostics import has_errors
from pound_deck.reader import read_text
from pound_import.ruaumoko.equake import File
from pound_import.ruaumoko.importer import translate
from pound_import.ruaumoko.recognise import is_legacy
from pound_solve.catalog import catalog

CATALOG = catalog()
RECORD = File("quake.txt", "0.1\n" * 50)
ITEMS = (
    *("0", "-1", "1e400", "nan", "NODES", "PROPS", "EQUAKE", "START", "x", "99999999999", "1D3", "52", "'"),
    *('"', "\0", "é", "!", "1e-320", "-0", "&", "SPRING", "FRAME", "4.5", "1000000", "100000"),
)


@pytest.mark.parametrize("seed", range(4))
def test_a_damaged_deck_is_read_or_told(seed):
    rng = random.Random(seed)
    ends = set()
    for _ in range(60):
        deck = rng.choice((STICK, OSCILLATOR, PORTAL, IN_SPACE))
        text = damaged(deck, rng, lambda word: rng.choice(ITEMS))
        is_legacy(text)
        records = [RECORD] if rng.random() < 0.7 else []
        old = translate("old.dat", text, CATALOG, records, run=rng.random() < 0.3)
        assert bool(old.text) != has_errors(old.report)
        ends.add(bool(old.text))
        for d in old.report:
            assert d.span and 1 <= d.span.line <= max(len(text.splitlines()), 1)
        if old.text:
            _, found, _ = read_text(old.text, CATALOG, name="new")
            assert all(d.span is None or d.span.file != "new" for d in old.moved(found, "new"))
    assert ends == {True, False}
