"""What holds for any input: no exception, right arithmetic, no meaning in blanks and case."""

import math
import re

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pound_deck.cards import parse_items
from pound_deck.diagnostics import render
from pound_deck.messages import MESSAGES
from pound_deck.reader import read_text
from pound_deck.source import LogicalLine

DECK = """TITLE  Two towers
UNITS  kN m s
PARAM  n = 4    gap = 0.008    rec = "el centro.at2"
NODES
   1                 0          0     FIX=XYR
   100 TO 100+n      0 TO 20    3.5   FIX=YR
   300               20         3.5   SLAVED=X MASTER=1
ELEMENTS
   11                COL1       1                100
   101 TO 100+n      SLAB       100 TO 99+n      101 TO 100+n
   901               POUND      100+n            300
PROPS
   COL1   SPRING     KX=420000/2  FX=2400/2,5  RULE=ELASTO_PLASTIC,BILINEAR  R=0.1
   SLAB   FRAME      E=25.084E6  A=(1 + 0.5)
   POUND  CONTACT    LAW=KELVIN_VOIGT  K=752520*n  E=1  GAP=gap  TENSION=NO
WEIGHTS
   100,100+n         1600/(2*n)
   101 TO 99+n BY 1  1600/n
DAMPING
   RAYLEIGH  ALPHA=0.1  NODES=1,100 TO 100+n  PROPS=COL1,SLAB
DRIFT
   "B1 storey 1"   1  100  DIRECTION=X
EQUAKE
   RECORD FILE=rec  FORMAT=PEER
ANALYSIS
   MODAL    4
   HISTORY  T=10  METHOD=NEWMARK  DT=0.01
OUTPUT
   EVERY=0.002  NODES=100,100+n
"""
WORDS = (
    DECK.split()
    + list("()=,+-*/^'\"!&#\n\n\n ")
    + ["TO", "BY", "END", "1e999", "nan", "INCLUDE", "&\n", "\t"]
)
quiet = settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])


def check_reading(text, catalog):
    model, found, files = read_text(text, catalog)
    assert render(found, files) or not found
    assert {d.code for d in found} <= MESSAGES.keys()
    assert (model is None) == any(d.severity == "error" for d in found)
    for d in found:
        lines = files[d.span.file].split("\n") if d.span else []
        assert not d.span or (1 <= d.span.line <= len(lines) and 1 <= d.span.column < d.span.end), d


@quiet
@given(st.text(st.characters(), max_size=200))
def test_any_text_gives_diagnostics_only(catalog, text):
    check_reading(text, catalog)


@quiet
@given(st.lists(st.sampled_from(WORDS), max_size=60))
def test_any_words_give_diagnostics_only(catalog, words):
    check_reading("NODES\n" + " ".join(words), catalog)


@quiet
@given(st.integers(0, len(DECK)), st.integers(0, 30), st.sampled_from(WORDS), st.sampled_from(["", " "]))
def test_a_damaged_deck_gives_diagnostics_only(catalog, at, length, word, blank):
    check_reading(DECK[:at] + blank + word + blank + DECK[at + length :], catalog)


def test_the_deck_of_these_tests_is_good(catalog):
    model, found, files = read_text(DECK, catalog)
    assert model is not None and not found, render(found, files)


@pytest.mark.full
@quiet
@given(st.lists(st.sampled_from([line for line in DECK.split("\n") if line]), min_size=1), st.data())
def test_known_shapes_change_nothing(lines, data):
    def other(match):
        return data.draw(
            st.sampled_from({"0": ["7", "31.5"], "a": ["b", "xyz_1"]}["0a"[match[0].isalpha()]])
        )

    shapes = {}
    for line in lines:
        card = LogicalLine("deck.inp", 1, line)
        same_kinds = LogicalLine(
            "deck.inp", 2, re.sub(r"(?<![\w.])(\d+|(?!TO\b|BY\b)[A-Za-z]+)(?![\w.])", other, line)
        )
        for one in (card, same_kinds):
            if not one.text.startswith("TITLE"):
                assert parse_items(one, shapes) == parse_items(one)


# any text can be given to a PARAM that holds one

bare = st.text(st.characters(exclude_categories=["Cs"]), max_size=40).map(str.strip)
plain = bare.filter(lambda t: not (len(t) > 1 and t[0] == t[-1] and t[0] in "\"'"))


@pytest.mark.full
@quiet
@given(plain, st.sampled_from(["", '"', "'"]))
def test_a_text_is_set_to_any_text(catalog, text, quote):
    given = text if quote in text else quote + text + quote
    model, found, files = read_text(DECK, catalog, {"rec": given})
    assert model is not None, render(found, files)
    assert model.params["REC"] == model.equake[0]["FILE"] == text


def test_texts_set_from_the_command_line(catalog):
    for text in (
        "a b.at2",
        "../x-y/el centro.at2",
        "5",
        "2*n",
        "it's",
        '"a" b "c"',
        "C:\\r\\a",
        "! no comment",
    ):
        assert read_text(DECK, catalog, {"Rec": text})[0].params["REC"] == text


# every number with a decimal point: Python's whole numbers grow without end
numbers = st.floats(0, 1e6).map(lambda x: f"{x:.6e}") | st.integers(0, 9).map(lambda k: f"{k}.")
formulas = st.recursive(
    numbers | st.sampled_from(["pi", "n"]),
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from(["+", "-", "*", "/", "**"]), inner).map("".join),
        st.tuples(inner, st.sampled_from([" + ", " - "]), inner).map(lambda t: f"({''.join(t)})"),
        inner.map(lambda x: f"-{x}"),
        inner.map(lambda x: f"({x})"),
        st.tuples(st.sampled_from(["sqrt", "sin", "exp", "log", "abs", "floor"]), inner).map(
            lambda t: f"{t[0]}({t[1]})"
        ),
        st.tuples(st.sampled_from(["min", "max"]), inner, inner).map(lambda t: f"{t[0]}({t[1]}, {t[2]})"),
    ),
    max_leaves=12,
)


def python_value(formula):
    names = {name: getattr(math, name) for name in ("sqrt", "sin", "exp", "log", "pi")}
    names |= {"abs": abs, "min": min, "max": max, "n": 3.0, "floor": lambda x: float(math.floor(x))}
    try:
        value = eval(formula, {"__builtins__": {}}, names)
        return float(value) if not isinstance(value, complex) and math.isfinite(value) else None
    except (ArithmeticError, ValueError, TypeError):
        return None


@pytest.mark.full
@quiet
@given(formulas)
def test_formulas_agree_with_python(catalog, formula):
    model, found, _ = read_text(f"PARAM n = 3  a = {formula}\n" + DECK.replace("n = 4", "m = 4"), catalog)
    expected = python_value(formula)
    if expected is None:
        assert {d.code for d in found} <= {"P223", "P224", "P225"} and found
    elif model is not None:  # Python may pass through an infinity that is a mistake in a deck
        assert math.isclose(model.params["A"], expected, rel_tol=1e-9, abs_tol=1e-300)
    else:
        assert {d.code for d in found} <= {"P223", "P224", "P225"}


def content(model):
    """All that a Model says, without places."""
    groups = (
        model.props.values(),
        model.weights,
        model.drifts,
        model.damping,
        model.equake,
        model.analyses,
        [model.output],
    )
    return (
        model.params,
        [(n.id, n.x, n.y, n.fixed, n.slaved) for n in model.nodes.values()],
        [(e.id, e.prop, e.i, e.j) for e in model.elements.values()],
        [(c.spec.name, c.label, c.values, list(c.laws)) for group in groups for c in group],
    )


@pytest.mark.full
@settings(quiet, max_examples=60)
@given(st.data())
def test_blanks_and_case_have_no_meaning(catalog, data):
    out = []
    for line in DECK.split("\n"):
        texts = line.split('"')
        case = data.draw(st.sampled_from([str.upper, str.lower, str.swapcase, str]))
        # what stands in quotes is literal, and UNITS keeps its letters
        change = str if line.startswith("UNITS") else case
        line = '"'.join(t if k % 2 else change(t) for k, t in enumerate(texts))
        line = line.replace("=", data.draw(st.sampled_from(["=", " = ", "= ", "\t="])))
        line = (
            line.replace("   ", data.draw(st.sampled_from([" ", "\t", "     ", "   &\n"])))
            if line[:1].isspace()
            else line
        )
        line += data.draw(st.sampled_from(["", "  ", "! it's a comment", "\n", "\n  ! more"]))
        out.append(line)
    text = data.draw(st.sampled_from(["\n", "\r\n", "\r"])).join(out)
    model, found, files = read_text(text, catalog)
    assert model is not None and not found, render(found, files)
    assert content(model) == content(read_text(DECK, catalog)[0])
