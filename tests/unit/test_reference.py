"""The catalog as text: ``pound-solve list`` and the page of the manual."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from pound_deck.expressions import FUNCTIONS
from pound_deck.reader import read_text
from pound_deck.schema import REQUIRED, Field, Kind, Spec
from pound_solve.catalog import catalog
from pound_solve.cli.main import main
from pound_solve.report.listing import WIDTH, listing, takes, usage, vocabulary

PAGE = (Path(__file__).parents[2] / "manual" / "deck-reference.md").read_text("utf-8")
SPECS = [spec for family in vocabulary().families() for spec in vocabulary().family(family).values()]


def chapter(page: str, spec: Spec) -> str:
    """Part of the page on one Spec; two families have a MODAL, so the family's part is cut out first."""
    start = {
        "section": "Sections",
        "element": "Elements",
        "hysteresis": "Hysteresis rules",
        "contact": "Contact laws",
        "damping": "Damping",
        "motion": "Ground motions",
        "force": "Forces in time",
        "damper": "Damper laws",
        "record": "Record formats",
        "analysis": "Analyses",
        "method": "Methods of integration",
    }.get(spec.family, spec.family.capitalize())
    part = re.split(r"^## ", page, flags=re.M)
    own = next(p for p in part if p.startswith(start + "\n"))
    return next(c for c in re.split(r"^### ", own, flags=re.M) if c.startswith(spec.name + "\n"))


@pytest.mark.parametrize("spec", SPECS, ids=lambda s: f"{s.family} {s.name}")
def test_every_spec_and_field_appears(spec: Spec):
    text = chapter(PAGE, spec)
    sheet = listing(spec.family, spec.name)
    joined = " ".join(sheet.split())
    for f in spec.fields:
        row = next(line for line in text.splitlines() if line.startswith(f"| `{f.name}` |"))
        assert f.doc.replace("|", "\\|") in row
        assert (f.default is REQUIRED) == ("| must |" in row)
        assert re.search(rf"^{f.name}\b", sheet, re.M)
    assert spec.reference in " ".join(text.split())
    assert spec.reference in joined
    assert usage(spec) in text
    assert all(len(line) <= WIDTH for line in sheet.splitlines())
    assert f"   {spec.name}" in listing(spec.family)
    assert f"   {spec.name}" in listing()


def test_all_specs_of_the_solver_are_there():
    assert {(s.family, s.name) for s in SPECS if s.family != "section"} == {
        (family, name) for family in catalog().families() for name in catalog().family(family)
    }


def test_the_page_names_all_functions():
    listed = re.search(r"`(sqrt [a-z0-9 \n]+)`", PAGE)
    assert listed and set(listed[1].split()) == {name.lower() for name in FUNCTIONS}


def test_the_page_gives_the_gravity_of_each_unit():
    sentence = re.search(r"value of gravity: ([^.]|\.(?=\d))*\.", PAGE)
    assert sentence
    found = re.findall(r"([\d.]+) for (\w+)", sentence[0])
    assert len(found) == 5
    for value, unit in found:
        model, _, _ = read_text(f"UNITS kN {unit} s\n" + MINIMAL, catalog())
        assert model is not None and model.gravity == float(value)


@pytest.mark.parametrize(
    "text, meaning",
    [
        ("-2^2", -4.0),
        ("2^3^2", 512.0),
        ("(3 / 2)", 1.5),
        ("2**3", 8.0),
        ("1D-3", 0.001),
        ("round(-2.5)", -3.0),
        ("int(-2.5)", -2.0),
        ("log(exp(1))", 1.0),
        ("sin(pi/2)", 1.0),
    ],
)
def test_expressions_mean_what_the_page_says(text: str, meaning: float):
    model, found, _ = read_text(f"PARAM x = {text}\n" + MINIMAL, catalog())
    assert model is not None, found
    assert model.params["X"] == pytest.approx(meaning, rel=1e-15)


def test_the_range_of_the_page():
    model, found, _ = read_text("NODES\n 11 TO 15  0 TO 8  3.5\n" + MINIMAL, catalog())
    assert model is not None, found
    assert [(n, model.nodes[n].x, model.nodes[n].y) for n in range(11, 16)] == [
        (11, 0.0, 3.5), (12, 2.0, 3.5), (13, 4.0, 3.5), (14, 6.0, 3.5), (15, 8.0, 3.5)
    ]  # fmt: skip


@pytest.mark.parametrize("n, weights", [(0, 1), (1, 2)])
def test_the_empty_range_of_the_page(n: int, weights: int):
    deck = f"PARAM n = {n}\nNODES\n 11 TO 10+n  0  0\n" + MINIMAL.replace(
        "   2   1\n", "   2,11 TO 10+n   1\n"
    )
    model, found, _ = read_text(deck, catalog())
    assert model is not None, found
    assert len(model.nodes) == 2 + n
    assert len(model.weights[0]["NODES"]) == weights


@pytest.mark.parametrize(
    "words, said",
    [
        (("contacts",), "did you mean contact?"),
        (("KELVIN_VOIGT", "K"), "list contact KELVIN_VOIGT"),
        (("modal",), "list damping MODAL or list analysis MODAL"),
        (("zzz",), "there are section, element"),
        (("contact", "kelvin"), "did you mean KELVIN_VOIGT?"),
        (("contact", "zzz"), f"there are {', '.join(catalog().family('contact'))}"),
        (("contact", "77"), f"there are {', '.join(catalog().family('contact'))}"),
    ],
)
def test_an_unknown_name_gets_help(words: tuple[str, ...], said: str):
    with pytest.raises(KeyError) as error:
        listing(*words)
    assert said in error.value.args[0]


def test_a_member_of_one_family_needs_no_family():
    assert listing("kelvin_voigt") == listing("contact", "KELVIN_VOIGT")


def test_names_in_any_case_and_old_codes():
    assert listing("HYSTERESIS", "bilinear") == listing("hysteresis", "2")


@pytest.mark.parametrize(
    "f, text",
    [
        (Field("A", Kind.REAL), "number"),
        (Field("A", Kind.REAL, above=0, hi=1), "> 0, <= 1"),
        (Field("A", Kind.REAL, lo=0, below=1), ">= 0, < 1"),
        (Field("A", Kind.INT, lo=1), "whole number >= 1"),
        (Field("A", Kind.INT), "whole number"),
        (Field("A", Kind.REAL, count=(2, 2)), "2 values, number"),
        (Field("A", Kind.REAL, count=(1, 2), above=0), "1 to 2 values, > 0"),
        (Field("A", Kind.WORD, words=("NO", "YES"), codes={"YES": 1}), "NO, YES (1)"),
        (Field("A", Kind.FLAGS, words=("XYR",)), "letters of XYR"),
        (Field("A", Kind.FAMILY, family="contact"), "one of contact"),
        (Field("A", Kind.NODES), "nodes"),
        (Field("A", Kind.NODE, varies=True), "node, or range"),
    ],
)
def test_what_an_item_takes(f: Field, text: str):
    assert takes(f) == text


def test_on_the_command_line(capsys: pytest.CaptureFixture[str]):
    assert main(["list"]) == 0
    assert capsys.readouterr().out.rstrip("\n") == listing()
    assert main(["list", "section", "nodes"]) == 0
    assert capsys.readouterr().out.rstrip("\n") == listing("section", "NODES")
    assert main(["list", "contacts"]) == 2
    assert "did you mean contact?" in capsys.readouterr().err


MINIMAL = """
NODES
   1   0   0   FIX=XYR
   2   0   3   FIX=YR
ELEMENTS
   1   K   1   2
PROPS
   K   SPRING   KX=1
WEIGHTS
   2   1
ANALYSIS
   MODAL
"""
