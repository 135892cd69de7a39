"""K=ADJACENT: a contact takes the axial stiffness of its neighbours."""

import math
from pathlib import Path

import pytest

from decks import model_of, structure_of
from pound_deck.reader import read_deck
from pound_solve.catalog import catalog
from pound_solve.structure.assembly import AssemblyError, assemble

ROW = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 0 3
 3 4 3
 4 4 0 FIX=XYR
 5 4.01 3 {five}
 6 7.01 7
 7 4.01 0 FIX=XYR
ELEMENTS
 1 COL 1 2
 2 SLAB 2 3
 3 COL 3 4
 4 STRUT 5 6
 5 COL 5 7
 9 HIT {hit}
PROPS
 COL FRAME E=3E7 A=0.09 I=7E-4
 SLAB FRAME E=3E7 A=0.2 I=1E-3 {slab}
 STRUT FRAME E=2E8 A=0.01 I=1E-4
 HIT CONTACT GAP=0.01 ANGLE=0 LAW={law} K=ADJACENT {choice}
WEIGHTS
 2,3,5,6 100
"""
SLAB = 3e7 * 0.2 / 4.0  # E A / L
STRUT = 2e8 * 0.01 / 5.0 * 0.6**2  # inclined: times the squared cosine


def facts(hit="3 5", choice="", law="LINEAR", slab="", five=""):
    structure = structure_of(ROW.format(hit=hit, choice=choice, law=law, slab=slab, five=five))
    return next(s.facts for s in structure.laws if s.role.collides)


@pytest.mark.parametrize(
    ("choice", "k", "note"),
    [
        ("", STRUT, "K of element 4, the softer"),
        ("ADJACENT=SOFTER", STRUT, "K of element 4, the softer"),
        ("ADJACENT=STIFFER", SLAB, "K of element 2, the stiffer"),
        (
            "ADJACENT=HARMONIC",
            2 * SLAB * STRUT / (SLAB + STRUT),
            "K: harmonic mean of element 4 and element 2",
        ),
    ],
)
def test_softer_stiffer_or_between(choice, k, note):
    found = facts(choice=choice)
    assert found["k"] == pytest.approx(k, rel=1e-12)
    assert found["note"] == f"elastic; {note}"


def test_hinges_and_releases_do_not_change_the_axial_stiffness():
    hinged = facts(choice="ADJACENT=STIFFER", slab="RULE=BILINEAR MI=60 MJ=60 KH=2E5")
    assert hinged["k"] == pytest.approx(SLAB, rel=1e-12)


def test_a_wall_is_rigid():
    assert facts(hit="3")["k"] == pytest.approx(SLAB, rel=1e-12)
    wall = facts(hit="3", choice="ADJACENT=HARMONIC")
    assert wall["k"] == pytest.approx(2.0 * SLAB, rel=1e-12)
    assert wall["note"] == "elastic; K: harmonic mean of element 2 and the wall"


def test_both_sides_of_a_node_count():
    """Node 2 is met by the slab alone, node 3 here by two slabs."""
    text = ROW.format(hit="5 3", choice="ADJACENT=STIFFER", law="LINEAR", slab="", five="")
    text = text.replace(" 9 HIT", " 6 SLAB 3 8\n 9 HIT").replace("NODES\n", "NODES\n 8 9 3\n")
    found = next(s.facts for s in structure_of(text).laws if s.role.collides)
    assert found["k"] == pytest.approx(3e7 * 0.2 * (1 / 4 + 1 / 5), rel=1e-12)
    assert found["note"].endswith("K of elements 2, 6, the stiffer")


def test_a_spring_without_length_counts_along_the_direction():
    text = """NODES
 1 0 0 FIX=YR
 2 0 0 FIX=XYR
ELEMENTS
 1 S 2 1
 2 HIT 1
PROPS
 S SPRING KX=70 KY=900
 HIT CONTACT GAP=0 LAW=LINEAR K=ADJACENT
WEIGHTS
 1 1
"""
    assert structure_of(text).laws[0].facts["k"] == pytest.approx(70.0)


def test_restitution_uses_the_stiffness_found():
    found = facts(law="KELVIN_VOIGT E=0.6")
    m = found["reduced_mass"]
    assert found["c"] == pytest.approx(2.0 * found["xi"] * math.sqrt(STRUT * m), rel=1e-12)


def test_the_word_may_stand_in_a_parameter():
    text = 'PARAM k = "adjacent"\n' + ROW.replace("K=ADJACENT", "K=k").format(
        hit="3 5", choice="", law="LINEAR", slab="", five=""
    )
    assert model_of(text).props["HIT"]["K"] == "ADJACENT"


@pytest.mark.parametrize("n", [1, 5, 20])
def test_distributed_diaphragms_of_the_paper(tmp_path, n):
    """n times the softer diaphragm's stiffness, as the deck has it by hand."""
    deck = Path(__file__).parents[2] / "examples" / "cole2011" / "distributed.inp"
    own = tmp_path / "distributed.inp"
    text = deck.read_text("utf-8").replace("K=kc ", "K=ADJACENT ")
    assert "K=ADJACENT" in text
    own.write_text(text)
    model, found, _ = read_deck(str(own), catalog(), {"n": str(n)})
    assert model is not None and not found
    contacts = [s for s in assemble(model).laws if s.role.collides]
    assert [s.facts["k"] for s in contacts] == pytest.approx([752520.0 * n] * 2, rel=1e-12)
    assert [s.facts["note"].split("; ")[1] for s in contacts] == [
        "K of element 3001, the softer",
        "K of element 4001, the softer",
    ]


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"hit": "1"}, "nothing that it joins can move"),
        ({"hit": "3 7"}, "no element that meets node 7 is stiff axially"),
        ({"hit": "3", "choice": "ADJACENT=STIFFER"}, "the wall, which is rigid"),
    ],
)
def test_neighbours_that_are_not_there(values, words):
    with pytest.raises(AssemblyError, match=words):
        facts(**values)
