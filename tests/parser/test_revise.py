"""Decks with other values of PARAMs, and formulas of variables."""

import math

import pytest

from pound_deck.formula import Formula, FormulaError
from pound_deck.revise import with_params

DECK = """TITLE  PARAM k = 1 of a title stays
PARAM  k = 4000   gap = 2*(1+3)   ! PARAM k = 5
PARAM  other = k, &
       long = 7
INCLUDE "parts/nodes.inc"   ! and more
"""


def test_only_the_values_change(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts/nodes.inc").write_text("NODES\n  1 0 0\nEND\nPARAM k = 3\n")
    path = tmp_path / "deck.inp"
    path.write_text(DECK.replace("k, &", "k &"))
    text = with_params(str(path), {"K": "5.5", "gap": "0.25", "LONG": "8.0"})
    expected = DECK.replace("k, &", "k &").replace("k = 4000", "k = 5.5")
    assert text == expected.replace("2*(1+3)", "0.25").replace("long = 7", "long = 8.0")


def test_included_files_are_written_into_it_if_they_define_a_param(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts/one.inc").write_text("PARAM a = 1\nINCLUDE two.inc\n! end of one\n")
    (tmp_path / "parts/two.inc").write_text("PARAM b = 2\nEND\nPARAM b = 3\n")
    path = tmp_path / "deck.inp"
    path.write_text("PARAM c = 3\nINCLUDE 'parts/one.inc'\nNODES\n")
    text = with_params(str(path), {"b": "9"})
    assert text.split("\n") == [
        "PARAM c = 3",
        "PARAM a = 1",
        "PARAM b = 9",
        "! end of one",
        "",
        "NODES",
        "",
    ]


def test_formulas():
    f = Formula("2*k + sqrt(gap) - pi", ["k", "GAP"])
    assert f.value({"K": 3.0, "gap": 4.0}) == pytest.approx(8.0 - math.pi)
    for text in ("", "k +", "k gap", "k, gap", "x = k", "2*l", '"k"', "nan", "k TO gap", "sqrt(k"):
        with pytest.raises(FormulaError):
            Formula(text, ["k", "gap"])
    with pytest.raises(FormulaError, match="zero"):
        Formula("1/k", ["k"]).value({"k": 0.0})
