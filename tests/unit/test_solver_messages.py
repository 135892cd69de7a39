"""Messages of the model that only the solver can tell: one bad deck each, at its place."""

import re
from pathlib import Path

import pytest

from pound_deck.diagnostics import caret, has_errors
from pound_deck.messages import MESSAGES, WARNINGS
from pound_solve.driver.run import DeckError, Request, prepare

BAD = Path(__file__).parents[1] / "parser" / "bad"
EXPECT = re.compile(r"! expect ([PR]\d+) (\d+):(\d+) solver\n")
DECKS = sorted(path for path in BAD.glob("*.inp") if EXPECT.match(path.read_text("utf-8")))


@pytest.mark.parametrize("path", DECKS, ids=lambda p: p.stem)
def test_one_mistake_one_message_at_its_place(path):
    code, line, column = EXPECT.match(path.read_text("utf-8")).groups()
    try:
        ready = prepare(Request(str(path)))
        found, files = ready.warnings, ready.files
    except DeckError as error:
        found, files = error.diagnostics, error.files
    assert [d.code for d in found] == [code], found
    assert has_errors(found) != (code in WARNINGS) and path.name.startswith(code)
    place = found[0].span
    assert (place.line, place.column) == (int(line), int(column)), found
    assert caret(found[0], files).count("\n") >= 2  # the message, the line, the caret


def test_every_message_of_assembly_has_a_deck():
    decks = {path.name[:4] for path in DECKS if path.name.startswith("P33")}
    assert decks == {code for code in MESSAGES if code.startswith("P33")}


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("1 0 0 FIX=YR", "1 0 0 FIX=XYR", False),
        ("2 3 0 FIX=YR", "2 3 0 SLAVED=XYR MASTER=1", True),
        ("2 981", "2 981\nINITIAL\n 2 VX=1", False),
        ("2 981", "2 981\nFORCES\n SINE 2 FX=1 PERIOD=1", False),
        ("AMPLITUDE", "DIRECTION=Y AMPLITUDE", False),  # along which nothing can move
        ("HISTORY 5", "MODAL 1", False),
        (" 1 C 1 2", " 1 C 1 2\n 2 C 1", False),
        (" 1 C 1 2", " 1 C 1 2\n 2 D 1", False),
        (" 1 C 1 2", " 1 C 1 2\n 2 D 1 2", True),
        (" 1 C 1 2", " 1 C 1 2\n 2 P 2", False),  # a wall in the way
        (" 1 C 1 2", " 1 C 1 2\n 2 P 1 2", True),
        (" 1 C 1 2", " 1 F 1 2\nGEOMETRY LARGE", True),
        (" 1 C 1 2", " 1 F 1 2\n 2 F 9 1\nNODES\n 9 -3 0 FIX=XYR\nGEOMETRY LARGE", False),
        (" C SPRING KX=4000", " C SPRING KX=4000 FX=3 RULE=TAKEDA", True),
    ],
)
def test_a_structure_that_nothing_ties_to_the_ground(tmp_path, old, new, told):
    text = (BAD / "P337_base_that_slides.inp").read_text("utf-8")
    text = text.replace(
        "WEIGHTS",
        " F FRAME E=2E8 A=0.7 I=0.3\n D DASHPOT CX=1\n P CONTACT GAP=1 LAW=LINEAR K=1E5 ANGLE=0\nWEIGHTS",
    )
    assert old in text
    deck = tmp_path / "slides.inp"
    deck.write_text(text.replace(old, new))
    found = prepare(Request(str(deck))).warnings
    assert [d.code for d in found if d.code != "P313"] == ["P337"] * told


def test_a_mistake_of_a_property_set_is_told_once(tmp_path):
    deck = tmp_path / "columns.inp"
    deck.write_text(
        "NODES\n 1 TO 4 0 0 TO 9\nELEMENTS\n 1 TO 3 COL 1 TO 3 2 TO 4\n"
        "PROPS\n COL FRAME E=1 A=1 RULE=TAKEDA MI=1 LP=0.1\nANALYSIS\n MODAL 1\n"
    )
    with pytest.raises(DeckError) as caught:
        prepare(Request(str(deck)))
    (told,) = caught.value.diagnostics
    assert told.code == "P330" and told.message.startswith("element 1 and 2 more (COL): ")
