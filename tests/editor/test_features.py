"""Each kind of help on small decks: what stands at a place, what may follow, where a name comes from."""

import pytest

from pound_solve.editor import diagnose
from pound_solve.editor.complete import complete
from pound_solve.editor.definition import define, references
from pound_solve.editor.hover import hover
from pound_solve.editor.rename import RenameError, applied, renamable, rename
from pound_solve.editor.symbols import outline

DECK = """TITLE  Two masses
UNITS  N mm s
PARAM  n = 4   k = 10*n   soft = "COL"
NODES
   1  0 0  FIX=XYR
   11 TO 10+n  0 TO 9  3  FIX=YR
   99 9 3  SLAVED=X MASTER=14
ELEMENTS
   1  COL  1 11
   2  soft 1 12
   901  POUND  11 99  NAME=COL
PROPS
   COL  SPRING  KX=k  FX=2  RULE=BILINEAR  R=0.1
   POUND  CONTACT  GAP=0.1  LAW=KELVIN_VOIGT  K=1E3  E=0.6
WEIGHTS
   11,12 TO 13  5
DAMPING
   RAYLEIGH  ALPHA=0.1  PROPS=COL
MASS LUMPED
ANALYSIS
   HISTORY  T=1
"""


def texts(found):
    return [s.text for s in found[0]]


def completed(at, text):
    reading, text, place = at(text)
    return complete(reading, text, place.line, place.column)


@pytest.mark.parametrize(
    "line, within, without",
    [
        ("^", ["NODES", "PROPS", "PARAM"], ["KX=", "SPRING"]),
        ("EL^", ["ELEMENTS"], ["KX="]),
        ("PROPS\n  A ^", ["SPRING", "FRAME", "CONTACT"], ["KX="]),
        ("PROPS\n  A SPR^", ["SPRING"], ["NODES"]),
        ("PROPS\n  A SPRING ^", ["KX=", "RULE="], ["GAP=", "SPRING"]),
        ("PROPS\n  A SPRING KX=1 ^", ["KY="], ["KX="]),
        ("PROPS\n  A SPRING RULE=^", ["TAKEDA", "BILINEAR"], ["KELVIN_VOIGT"]),
        ("PROPS\n  A SPRING RULE=BILINEAR ^", ["R="], ["ALFA="]),
        ("PROPS\n  A SPRING RULE=BILINEAR,TAKEDA &\n KX=1 ^", ["R=", "ALFA="], ["KX="]),
        ("PROPS\n  A SPRING KX=^", ["n", "k", "sqrt"], ["TAKEDA"]),
        ("PROPS\n  A SPRING KX=2*^", ["n", "k"], ["KY="]),
        ("PROPS\n  A CONTACT LAW=KELVIN_VOIGT TENSION = ^", ["YES", "NO"], []),
        ("DAMPING\n  ^", ["RAYLEIGH", "MODAL"], ["KX="]),
        ("DAMPING\n RAYLEIGH PROPS=COL,^", ["COL", "POUND"], ["11"]),
        ("ELEMENTS\n 7 ^", ["COL", "POUND", "PROP="], ["1"]),
        ("ELEMENTS\n 7 COL ^", ["1", "11", "14", "99", "n"], ["COL"]),
        ("WEIGHTS\n 1,^", ["11", "99"], ["POUND"]),
        ("NODES\n 7 0 0 FIX=^", ["XY", "XYR"], ["11"]),
        ("ANALYSIS\n HISTORY T=1 METHOD=^", ["EXACT", "AUTO"], []),
        ("MASS ^", ["LUMPED", "CONSISTENT"], ["SMALL"]),
        ("PARAM m = ^", ["n", "cos"], ["KX="]),
        ("EQUAKE\n RECORD ^", ["soft", "FILE=", "SCALE="], ["n"]),
    ],
)
def test_what_may_follow(at, line, within, without):
    found = texts(completed(at, DECK + line))
    assert set(within) <= set(found) and not set(without) & set(found)


@pytest.mark.parametrize("line", ["! ^", "PROPS\n A SPRING ! ^", 'TITLE "^', 'EQUAKE\n RECORD FILE="a ^'])
def test_nothing_follows_in_comments_and_texts(at, line):
    assert texts(completed(at, DECK + line)) == []


def test_items_that_must_stand_come_first_and_the_word_begun_is_replaced(at):
    found, start = completed(at, DECK + "PROPS\n  A CONTACT LAW=LINEAR GA^")
    assert [s.text for s in found][:2] == ["GAP=", "K="] and start == len("  A CONTACT LAW=LINEAR ") + 1
    assert found[1].detail.endswith("[N/mm]")


@pytest.mark.parametrize(
    "mark, told",
    [
        ("K^X=k", ["**KX** [N/mm]", "default: 0"]),
        ("KX=^k", ["**KX**", "PARAM **K** = 40"]),
        ("RULE=BIL^INEAR", ["**RULE**", "**BILINEAR**: "]),
        ("SPR^ING", ["**SPRING**: ", "[KX=]"]),
        ("1 ^12", ["**J**", "node **12**", "11 TO 10+n"]),
        ("R=0^.1", ["**R**"]),
        ("PRO^PS\n", ["family element"]),
        ("NO^DES\n", ["**NODES**: nodes"]),
        ("MASS L^UMPED", ["**MASS**"]),
        ("ALPHA=^0.1", ["**ALPHA** [1/s]"]),
        ("POU^ND  11", ["**PROP**", "property set **POUND**", "GAP=0.1"]),
    ],
)
def test_hover_tells_units_defaults_and_meaning(at, mark, told):
    reading, _, place = at(DECK.replace(mark.replace("^", ""), mark, 1))
    text, span = hover(reading, place)
    assert span.line == place.line and all(t in text for t in told), text


def test_hover_has_nothing_to_say_of_titles_and_comments(at):
    for deck in (DECK.replace("Two m", "Tw^o m"), DECK + "! re^mark\n"):
        reading, _, place = at(deck)
        assert hover(reading, place) is None


@pytest.mark.parametrize(
    "mark, expected",
    [
        ("COL  1 ^11", [(6, 4)]),
        ("MASTER=1^4", [(6, 4)]),
        ("1  C^OL", [(13, 4)]),
        ("so^ft 1", [(3, 27)]),
        ("KX=^k", [(3, 16)]),
        ("10*^n", [(3, 8)]),
        ("PROPS=^COL", [(13, 4)]),
        ("9^9 9 3", [(7, 4)]),
        ("RULE=^BI", []),
        ("TI^TLE", []),
    ],
)
def test_definitions(at, mark, expected):
    reading, _, place = at(DECK.replace(mark.replace("^", ""), mark, 1))
    assert [(s.line, s.column) for s in define(reading, place)] == expected


def test_references_hold_ranges_and_texts_of_params(at):
    reading, _, place = at(DECK.replace("COL  1 11", "COL  1 1^1"))
    assert {s.line for s in references(reading, place)} == {6, 9, 11, 16}
    reading, _, place = at(DECK.replace("   COL  SPR", "   C^OL  SPR"))
    assert {s.line for s in references(reading, place)} == {9, 10, 13, 18}


def renamed(at, mark, new):
    reading, text, place = at(DECK.replace(mark.replace("^", ""), mark, 1))
    return applied({"/deck.inp": text}, rename(reading, "/deck.inp", place, new))["/deck.inp"]


def test_rename_changes_every_place_and_nothing_else(at):
    new = renamed(at, "POU^ND  11", "HIT")
    assert new == DECK.replace("POUND", "HIT")
    assert renamed(at, "9^9 9", "7") == DECK.replace("99", "7")
    assert renamed(at, "10*^n", "count") == DECK.replace("n = 4", "count = 4").replace(
        "*n", "*count"
    ).replace("10+n", "10+count")
    assert renamed(at, "9^01", "5") == DECK.replace("901", "5")
    assert renamed(at, "PO^UND  CONT", "a b") == DECK.replace("POUND", '"a b"')


@pytest.mark.parametrize(
    "mark, new, why",
    [
        ("COL  1 1^1", "5", "names it, too"),  # by the range that defines it
        ("   CO^L  SPR", "HIT", "names it, too"),  # by the text of a PARAM
        ("POU^ND  11", "COL", "already"),
        ("POU^ND  11", "soft", "something else"),  # a PARAM that stands for another property set
        ("POU^ND  CONT", "NODES", "something else"),  # a heading
        ("POU^ND  CONT", 'a"b', "needed"),
        ("10*^n", "k", "already"),
        ("10*^n", "sin", "needed"),
        ("10*^n", "2m", "needed"),
        ("9^9 9", "1", "already"),
        ("9^9 9", "0", "needed"),
        ("9^9 9", "x", "needed"),
        ("RULE=^BI", "x", "stands here"),
    ],
)
def test_rename_is_refused_where_the_deck_would_change(at, mark, new, why):
    with pytest.raises(RenameError, match=why):
        renamed(at, mark, new)


def test_rename_is_refused_while_a_line_cannot_be_read(at):
    reading, _, place = at(DECK.replace("POUND  CONT", "POU^ND  CONT") + "WEIGHTS\n (1\n")
    with pytest.raises(RenameError, match=r"line 23 of /deck\.inp has a mistake"):
        rename(reading, "/deck.inp", place, "HIT")


def test_a_name_that_is_not_defined_is_not_renamed(at):
    reading, _, place = at(DECK + "LOADS\n 5^5 1\n")
    with pytest.raises(RenameError, match="node 55 is not defined"):
        rename(reading, "/deck.inp", place, "56")


def test_only_plain_names_can_be_renamed(at):
    reading, _, place = at(DECK.replace("11 TO 10+n", "1^1 TO 10+n", 1))
    assert renamable(reading, place) is None
    reading, _, place = at(DECK.replace("99 9", "9^9 9", 1))
    assert (renamable(reading, place).line, renamable(reading, place).end) == (7, 6)


def test_outline_has_sections_with_their_lines(at):
    reading, _, _ = at(DECK + "^")
    found = outline(reading, "/deck.inp")
    assert [(s.name, s.detail) for s in found if s.sort == "PARAM"] == [
        ("N", "4"),
        ("K", "10*n"),
        ("SOFT", '"COL"'),
    ]
    below = {s.name: [(b.name, b.detail) for b in s.below] for s in found if s.sort == "section"}
    assert list(below) == ["NODES", "ELEMENTS", "PROPS", "WEIGHTS", "DAMPING", "ANALYSIS"]
    assert below["PROPS"] == [("COL", "SPRING"), ("POUND", "CONTACT")]
    assert below["NODES"][1] == ("11 TO 10+n", "0 TO 9 3")
    assert [(s.name, s.detail) for s in found if s.sort == "card"] == [
        ("TITLE", "Two masses"),
        ("UNITS", "N mm s"),
        ("MASS", "LUMPED"),
    ]


UNUSED = DECK.replace("RULE=BILINEAR  R=0.1", "")  # a strength that an elastic rule does not use


def test_the_structure_is_left_out_of_a_deck_with_many_nodes(monkeypatch):
    codes = [d.code for d in diagnose.diagnose("/deck.inp", {"/deck.inp": UNUSED})[0]]
    assert "P330" in codes
    monkeypatch.setattr(diagnose, "MANY", 5)  # one less than the deck has
    fewer = [d.code for d in diagnose.diagnose("/deck.inp", {"/deck.inp": UNUSED})[0]]
    assert fewer == [code for code in codes if code != "P330"]


def test_errors_come_first_where_there_are_too_many_messages():
    bad = DECK.replace("NODES\n", "NODES\n" + "".join(f"   {k}  0 0\n" for k in range(200, 350)))
    found, _ = diagnose.diagnose("/deck.inp", {"/deck.inp": bad + "   HISTORY T=oops\n"})
    assert len(found) == diagnose.MAX_DIAGNOSTICS
    assert [d.severity for d in found] == ["error"] + ["warning"] * (diagnose.MAX_DIAGNOSTICS - 1)
