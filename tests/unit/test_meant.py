"""Structures that nobody can intend cause a warning with a remedy; those that somebody may do not."""

from pathlib import Path

import pytest

from decks import results_of, structure_of
from pound_deck.reader import read_deck, read_text
from pound_solve.catalog import catalog
from pound_solve.driver.preflight import preflight
from pound_solve.structure.assembly import assemble

#: all but the one that takes half a second to assemble, which tests of the examples check, and those that
#: wait for numbers
EXAMPLES = sorted(
    p
    for p in (Path(__file__).parents[2] / "examples").rglob("*.inp")
    if p.stem != "steel_20x6" and p.parent.name != "open"
)

#: two buildings that stand beside each other, a portal frame and a column
DECK = """NODES
 1 0 0 FIX=XYR
 2 0 3.5
 3 6 0 FIX=XYR
 4 6 3.5
 5 6.5 0 FIX=XYR
 6 6.5 3.5 FIX=YR
ELEMENTS
 1 COL 1 2
 2 COL 3 4
 3 BEAM 2 4
 4 SPR 5 6
 5 POUND 4 6
PROPS
 COL FRAME E=25E6 A=0.25 I=0.0026
 BEAM FRAME E=25E6 A=0.18 I=0.0025
 SPR SPRING KX=20000
 POUND CONTACT GAP=0.02 K=1E6
WEIGHTS
 2,4 500
 6 800
EQUAKE
 SINE AMPLITUDE=1 PERIOD=1 DURATION=1
ANALYSIS
 HISTORY 1
"""


def changed(*changes):
    """The deck with some of its lines replaced."""
    text = DECK
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return text


def remarks(text):
    """What the checks of the assembled structure say, cures included."""
    return [f"{d.code} {d.message}: {d.hint}" for d in preflight(structure_of(text))]


def test_a_deck_that_can_be_meant_has_no_remark():
    assert not remarks(DECK)


@pytest.mark.parametrize("deck", EXAMPLES, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_examples_have_no_remark(deck):
    """Their records apart, which are not read here."""
    model, found, _ = read_deck(str(deck), catalog())
    assert not found and not preflight(assemble(model))


ONE_FREE, OTHER_FREE = (" 1 0 0 FIX=XYR", " 1 0 0"), (" 3 6 0 FIX=XYR", " 3 6 0")
A_PIN, A_ROLLER = (" 3 6 0 FIX=XYR", " 3 6 0 FIX=XY"), (" 3 6 0 FIX=XYR", " 3 6 0 FIX=Y")


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ([ONE_FREE, OTHER_FREE], "nothing keeps 'building 1' from moving along X as one body"),
        ([(" 1 0 0 FIX=XYR", " 1 0 0 FIX=YR"), A_ROLLER], "'building 1' from moving along X"),
        ([ONE_FREE, A_PIN], "from turning about x = 6, y = 0 as one body: fix its base (1, 3)"),
        ([(" 5 6.5 0 FIX=XYR", " 5 6.5 0 FIX=YR")], "'building 2' from moving along X"),
        ([(" 1 0 0 FIX=XYR", " 1 0 0 FIX=Y"), A_PIN], ""),
    ],
)
def test_a_building_that_could_move_as_one_body(changes, told):
    """Contacts do not count while they are open."""
    found = [r for r in remarks(changed(*changes)) if r.startswith("P337")]
    assert len(found) == bool(told) and all(told in r for r in found)


@pytest.mark.parametrize(
    "hinges",
    [
        ("COL FRAME", "COL FRAME RULE=TAKEDA R=0.03 LP=0.3 MI=300 MJ=300"),
        ("BEAM FRAME", "BEAM BEAM_COLUMN LP=0.3 PY=4000 MP=300"),
    ],
)
@pytest.mark.parametrize("far", [A_PIN, OTHER_FREE])
def test_hinges_do_not_hold_a_building(hinges, far):
    """What is inside a member goes with its nodes."""
    found = [r for r in remarks(changed(ONE_FREE, far, hinges)) if r.startswith("P337")]
    assert len(found) == 1 and ("turning about x = 6, y = 0" if far == A_PIN else "along X") in found[0]


BED = """ 6 BED 1
 7 BED 3
 8 SLIDE 1
PROPS
 BED CONTACT GAP=0 K=1E6 ANGLE=-90
 SLIDE DASHPOT CX=1
"""


@pytest.mark.parametrize(
    "change",
    [
        ("EQUAKE", "INITIAL\n 2 VX=1\nEQUAKE"),
        ("HISTORY 1", "MODAL 1"),
        ("PROPS\n", " 6 SOIL 1\n 7 SOIL 3\nPROPS\n SOIL SPRING KX=1 KY=1\n"),
        ("PROPS\n", BED),
    ],
    ids=["thrown", "not shaken", "on springs", "on a bed"],
)
def test_a_body_that_may_move_is_not_told(change):
    assert not [r for r in remarks(changed(ONE_FREE, OTHER_FREE, change)) if r.startswith("P337")]


def test_a_ball_between_contacts_may_fly():
    ball = "NODES\n 7 8 3.5 FIX=YR\nELEMENTS\n 7 POUND 6 7\nWEIGHTS\n 7 100\nEQUAKE"
    assert not remarks(changed(("EQUAKE", ball)))


WEIGHTS = "WEIGHTS\n 2,4 500\n 6 800\n"


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ([(WEIGHTS, "")], "nothing has mass, so nothing can swing: give the nodes of its floors WEIGHTS"),
        ([(WEIGHTS, ""), ("HISTORY 1", "MODAL 1")], "nothing has mass"),
        ([(" 6 800\n", "")], "the building of nodes 5, 6 has no mass"),
        ([(" 6 800\n", " 6 0\n")], "the building of nodes 5, 6 has no mass"),
        ([(" 6 800\n", 'BUILDINGS\n "B" NODES=6\n')], "'B' has no mass"),
        ([(" 2,4 500\n", "")], "the building of nodes 1, 2, 3, 4 has no mass"),
        ([(" 2,4 500\n", ""), ("BEAM FRAME", "BEAM FRAME WGT=25")], ""),
        ([(WEIGHTS, ""), ("HISTORY 1", "STATIC")], ""),
        ([(" 6 800\n", ""), (" 6 6.5 3.5", " 6 7.5 0")], ""),  # a bumper
    ],
)
def test_a_building_without_mass(changes, told):
    found = [r for r in remarks(changed(*changes)) if r.startswith("P347")]
    assert len(found) == bool(told) and all(told in r for r in found)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ([(" 2 0 3.5", " 2 0 3.5 FIX=X")], "node 2 of 'building 1' is fixed along X above the base"),
        ([(" 2 0 3.5", " 2 0 3.5 FIX=XR"), (" 2,4 500", " 4 500")], ""),
        ([(" 1 0 0 FIX=XYR", " 1 0 0 FIX=XR"), ("2,4 500", "1,2,4 500")], ""),  # a footing
        ([(" 2 0 3.5", " 2 0 3.5 FIX=X"), (" 4 6 3.5", " 4 6 3.5 FIX=X")], ""),  # it moves upwards only
        ([(" 2 0 3.5", " 2 0 3.5 FIX=X"), ("DURATION=1", "DURATION=1 SUPPORTS=1,2,3,5")], ""),
        ([(" 2 0 3.5", " 2 0 3.5 FIX=X"), ("DURATION=1", "DURATION=1 DIRECTION=Y")], ""),
    ],
)
def test_a_floor_that_is_fixed(changes, told):
    found = [r for r in remarks(changed(*changes)) if r.startswith("P343")]
    assert len(found) == bool(told) and all(told in r and "take X out of FIX" in r for r in found)


ROD = "PROPS\n ROD FRAME E=200E6 A=1E-3\n"
UPPER = ("ELEMENTS\n", "NODES\n 8 0 7\n 9 6 7\nELEMENTS\n 11 COL 2 8\n 12 COL 4 9\n 13 BEAM 8 9\n")
JOINT = ("ELEMENTS\n", "NODES\n 7 6 3.5\nELEMENTS\n")
BEAM = (" 3 BEAM 2 4", " 3 BEAM 2 7")


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ([ONE_FREE], "P348 the foot of member 1, node 1, hangs free: give it FIX"),
        ([(" 1 0 0 FIX=XYR", " 1 0 0 FIX=R")], "P348 the foot of member 1, node 1"),
        ([(" 1 0 0 FIX=XYR", " 1 0 -1 FIX=R")], "P348"),
        ([ONE_FREE, ("PROPS\n", " 6 SOIL 1\nPROPS\n SOIL SPRING KX=9 KY=9 KR=9\n")], ""),
        ([ONE_FREE, ("2,4 500", "1,2,4 500")], "P348 the foot of member 1, node 1"),
        (
            [ONE_FREE, ("2,4 500", "1,2,4 500"), (" 1 COL 1 2", " 1 ROD 1 2"), ("PROPS\n", ROD)],
            "",  # a pendulum, perhaps
        ),
        ([ONE_FREE, OTHER_FREE], ""),  # P337 says more
        ([ONE_FREE, OTHER_FREE, (" 4 6 3.5", " 4 6 3.5 FIX=XYR")], ""),  # it hangs
        ([("ELEMENTS\n", "NODES\n 7 -2 3.5\nELEMENTS\n 9 BEAM 7 2\n")], ""),  # a balcony
        (
            [JOINT, BEAM],
            "7 and 4 are both at x = 6, y = 3.5, but nothing joins them: let element 3 end at node 4",
        ),
        ([JOINT, BEAM, ("2,4 500", "2,7 500")], "P349 nodes 7 and 4"),
        ([JOINT, BEAM, ("4 6\nPROPS", "7 6\nPROPS")], "P349 nodes 7 and 4"),
        ([UPPER, JOINT, (" 12 COL 4 9", " 12 COL 7 9")], "P349 nodes 7 and 4"),
        ([JOINT, BEAM, ("4 6\nPROPS", "4 6\n 6 SPR 4 7\nPROPS")], ""),
        ([JOINT, BEAM, ("4 6\nPROPS", "4 6\n 6 HIT 4 7\nPROPS\n HIT CONTACT GAP=1 K=1 ANGLE=0")], ""),
        ([("ELEMENTS\n", "NODES\n 7 6 3.5 SLAVED=XY MASTER=4\nELEMENTS\n"), BEAM], ""),
        ([JOINT, (" 1 COL", " 6 COL 5 7\n 1 COL")], "P349 nodes 7 and 4"),
    ],
)
def test_ends_of_members_that_nothing_holds(changes, told):
    found = [r for r in remarks(changed(*changes)) if r[:4] in ("P348", "P349")]
    assert len(found) == bool(told) and all(told in r for r in found)


def test_frames_that_touch_may_share_their_places():
    """Drawn without a gap; contacts join their roofs, not their feet and first floors."""
    frame = "".join(
        f" {k}1 {x} 0 FIX=XYR\n {k}2 {x} 3\n {k}3 {x} 6\n {k}4 {y} 0 FIX=XYR\n {k}5 {y} 3\n {k}6 {y} 6\n"
        for k, x, y in ((1, 0, 6), (2, 6, 12))
    )
    elements = "".join(
        f" {k}1 C {k}1 {k}2\n {k}2 C {k}2 {k}3\n {k}3 C {k}4 {k}5\n {k}4 C {k}5 {k}6\n"
        f" {k}5 C {k}2 {k}5\n {k}6 C {k}3 {k}6\n"
        for k in (1, 2)
    )
    assert not remarks(
        f"NODES\n{frame}ELEMENTS\n{elements} 99 P 16 23\nPROPS\n C FRAME E=2E7 A=0.2 I=1E-3\n"
        " P CONTACT GAP=0.05 K=1E6 ANGLE=0\nWEIGHTS\n 12,13,15,16,22,23,25,26 100\n"
    )


@pytest.mark.parametrize(
    ("names", "told"),
    [
        (("gap", "gap"), 'P350 elements 5, 6 have one name, "gap": name each on a line of its own'),
        (("gap", "upper gap"), ""),
        (("", ""), ""),
    ],
)
def test_elements_of_one_name(names, told):
    first, second = names
    text = changed((" 5 POUND 4 6", f' 5 POUND 4 6 NAME="{first}"\n 6 POUND 2 6 NAME="{second}"'))
    found = [f"{d.code} {d.message}: {d.hint}" for d in read_text(text, catalog())[1]]
    assert len(found) == bool(told) and all(told in r for r in found)


@pytest.mark.parametrize(
    ("gap", "more", "told"),
    [
        ("20", ("", ""), "GAP is 20 m, more than the 3.5 m that the buildings at contact 5 are high"),
        ("20", ("5 POUND 4 6", '5 POUND 4 6 NAME="roof"\n 6 POUND 2 6'), "at contact roof are high"),
        ("20", ("5 POUND 4 6", "5 POUND 4"), "it does not close: GAP is a distance in m"),
        ("3.4", ("", ""), ""),
        ("20", ("EQUAKE", "INITIAL\n 6 VX=-30\nEQUAKE"), ""),  # it is thrown
        ("5", (" 2 0 3.5", " 2 0 6"), ""),
    ],
)
def test_a_gap_above_the_height_of_the_buildings(gap, more, told):
    found = [r for r in remarks(changed(("GAP=0.02", f"GAP={gap}"), more)) if r.startswith("P351")]
    assert len(found) == bool(told) and all(told in r for r in found)


def test_a_ball_has_no_height():
    ball = "NODES\n 1 0 3 FIX=YR\nELEMENTS\n 1 P 1\nPROPS\n P CONTACT GAP=9 K=1E6\nWEIGHTS\n 1 9\nEQUAKE\n"
    assert not remarks(f"{ball} SINE AMPLITUDE=1 PERIOD=1 DURATION=1\nANALYSIS\n HISTORY 1\n")


@pytest.mark.parametrize(
    ("one", "other", "told"),
    [
        ("LP=0.3 MI=0.1 MJ=0.1", "LP=0.3 MI=200 MJ=200", True),
        ("LP=0.3 MI=0.1 MJ=0.1 DUCTU=1E6", "KH=1E11 MI=1 MJ=1", False),  # rigid until it yields
    ],
)
def test_hinges_beyond_the_ductility_of_members(tmp_path, one, other, told):
    rule = "I=0.0026 RULE=BILINEAR R=0.03"
    text = changed(
        ("I=0.0026", f"{rule} {one}\n OTHER FRAME E=25E6 A=0.25 {rule} {other}"),
        (" 2 COL", " 2 OTHER"),
        ("DURATION=1", "DURATION=0.1"),
        ("HISTORY 1", "HISTORY 0.2"),
    )
    deck = tmp_path / "model.inp"
    deck.write_text(text)
    results = results_of(deck)
    springs = results.table("spring_envelope")
    assert [bool(x > 50.0) for x in springs["ductility"]] == [True, True, not told, not told]
    found = [check for check in results.checks if check.name.startswith("ductility of")]
    assert len(found) == told
    for check in found:
        assert check.name.startswith("ductility of 2 hinges, largest hinge ") and "element 1" in check.name
        assert (check.value, check.allowed) == (max(springs["ductility"]), 50.0)
        assert check.looks and check.remark.startswith("check yield moments")
