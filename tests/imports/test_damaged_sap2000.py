"""Models of SAP2000 changed at random: each is read or refused with places; nothing else happens."""

from __future__ import annotations

import random

import pytest

from imports.damage import damaged
from imports.sap2000_models import EVERYTHING, PORTAL, SEVEN_STOREYS
from pound_deck.diagnostics import has_errors
from pound_deck.reader import read_text
from pound_import.sap2000.importer import translate
from pound_import.sap2000.recognise import is_sap2000
from pound_solve.catalog import catalog

CATALOG = catalog()
VALUES = (
    *(
        "0",
        "-1",
        "1e400",
        "nan",
        "1e30",
        "-1E-30",
        "x",
        "99999999999",
        '"',
        "_",
        "=",
        "é",
        "",
        "0.5",
        "1E9",
    ),
    *(
        "Yes",
        "No",
        "1",
        "2",
        "3",
        "B2",
        "M",
        "G",
        "X",
        "Y",
        "Z",
        "U1",
        "R3",
        "BEAM",
        "Gravity",
        "LIVE",
        "ULS",
    ),
)
PLANES = ("XZ", "YZ", "XY", "XZ@Y=0", "Y=7", "Z=3", "Q", "XZ@Y=1e400", "@")
LOADS = ("GRAVITY", "ULS", "TWICE", "dead,live", "LIVE", "nothing", ",", "LATERAL")


def check(rng: random.Random) -> bool:
    """Read one damaged model; return whether it becomes a deck."""
    model = rng.choice((PORTAL, SEVEN_STOREYS, EVERYTHING, EVERYTHING))
    text = damaged(model, rng, lambda item: f"{item.partition('=')[0]}={rng.choice(VALUES)}", gap="   ")
    is_sap2000(text)
    plane, load = (rng.choice(some) if rng.random() < 0.2 else "" for some in (PLANES, LOADS))
    new = translate("frame.s2k", text, CATALOG, plane, load)
    assert bool(new.text) != has_errors(new.report)
    for d in new.report:
        assert d.span and 1 <= d.span.line <= max(len(text.splitlines()), 1) and d.span.column >= 1
    if new.text:
        _, told, _ = read_text(new.text, CATALOG, name="new")
        assert all(d.span is None or d.span.file != "new" for d in new.moved(told, "new"))
    return bool(new.text)


@pytest.mark.parametrize("seed", range(4))
def test_a_damaged_model_is_read_or_refused(seed):
    rng = random.Random(seed)
    assert {check(rng) for _ in range(30)} == {True, False}
