"""Layout of decks: the same meaning, the same comments, and a second time changes nothing."""

import re
from dataclasses import fields, is_dataclass
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pound_deck.cards import parse
from pound_deck.layout import arranged, layout
from pound_deck.model import Span
from pound_deck.reader import read_text
from pound_deck.schema import Spec
from pound_deck.source import DeckSource, without_comment
from pound_solve.catalog import catalog as solver_catalog
from verification.generated.decks import deck

ROOT = Path(__file__).parents[2]
DECKS = [*sorted((ROOT / "examples").rglob("*.in[pc]")), *sorted((ROOT / "tests").rglob("*.inp"))]
#: what stands between two items; a line that goes on may hold comments
GAPS = ["  ", "\t", "       ", " &\n", "  &  ! goes on\n\n! between\n   "]
quiet = settings(max_examples=100, suppress_health_check=[HealthCheck.too_slow])


def text_of(path):
    return DeckSource().decode(str(path), path.read_bytes(), Span("", 1, 1, 2))


def bare(thing):
    """All that a model says, without places."""
    if isinstance(thing, Span):
        return None
    if isinstance(thing, Spec):
        return thing.family, thing.name
    if is_dataclass(thing):
        return {
            f.name: bare(getattr(thing, f.name)) for f in fields(thing) if f.name not in ("files", "spans")
        }
    if isinstance(thing, dict):
        return {key: bare(value) for key, value in thing.items()}
    return tuple(map(bare, thing)) if isinstance(thing, tuple) else thing


def meaning(text, name):
    """The bound model, and the numbers of all messages."""
    model, found, _ = read_text(text, solver_catalog(), name=str(name))
    return bare(model), sorted(d.code for d in found)


def items(text):
    """Section-blind contents of every line of a text."""
    out = []
    for row in parse(DeckSource().logical("deck.inp", text), []):
        title = row.line.text.split() if row.word == "TITLE" else None
        out.append((row.word, title, [(i.name, i.text) for i in row.items]))
    return out


def comments(text):
    return [line[len(without_comment(line)) :].rstrip() for line in text.split("\n") if "!" in line]


def check(text, name="deck.inp"):
    """The contract of a layout; True where the text follows the grammar."""
    new, found = layout(text, str(name))
    if new is None:
        assert found and all(re.match("P10|P20|P239", d.code) for d in found)
        return False
    assert layout(new) == (new, found)
    assert comments(new) == comments(text)
    assert meaning(new, name) == meaning(text, name)
    return True


@pytest.mark.full
@pytest.mark.parametrize("path", DECKS, ids=lambda p: "-".join(p.parts[-2:]))
def test_a_deck_means_the_same_and_keeps_its_comments(path):
    good = check(text_of(path), path)
    assert good or path.name.startswith(("P10", "P20", "P239"))


@pytest.mark.full
@settings(quiet, max_examples=40)
@given(st.sampled_from([p for p in DECKS if "examples" in p.parts]), st.data())
def test_blanks_and_lines_that_go_on_change_nothing_but_the_layout(path, data):
    out = []
    for line in text_of(path).split("\n"):
        code = without_comment(line)
        if not re.match(r"\s*(TITLE|INCLUDE)\b", line) and "TO" not in code:
            gap = data.draw(st.sampled_from(GAPS))
            texts = re.split(r"""("[^"]*"|'[^']*')""", code)
            texts[::2] = [re.sub(r"(?<=[^\s=]) +(?=[^\s=])", lambda m, g=gap: g, t) for t in texts[::2]]
            line = "".join(texts) + line[len(code) :]
        out.append(line)
    assert check("\n".join(out), path)


@pytest.mark.full
@quiet
@given(st.sampled_from(DECKS), st.data())
def test_a_damaged_deck_is_left_alone_or_laid_out(path, data):
    text = text_of(path)
    at = data.draw(st.integers(0, len(text)))
    cut = data.draw(st.integers(0, 30))
    more = data.draw(
        st.sampled_from(["", "&", "&\n", "!", '"', "(", "=", "\n", " END\n", "\t", "NODES", "'"])
    )
    check(text[:at] + more + text[at + cut :], path)


@pytest.mark.full
@pytest.mark.parametrize("seed", range(0, 40, 5))
def test_generated_decks_mean_the_same(seed):
    assert check(deck(seed, None))


@quiet
@given(
    st.text(st.characters(exclude_categories=["Cs"]) | st.sampled_from(list(' =!&\n1ab()"')), max_size=200)
)
def test_any_text_is_left_alone_or_keeps_its_items(text):
    text = text.replace("\r", "")
    new, found = layout(text)
    assert (new is None) == any(d.severity == "error" for d in found)
    if new is not None:
        assert layout(new)[0] == new
        assert items(new) == items(text)


UNTIDY = """TITLE   Two   words  ! kept
UNITS kN m s
PARAM n=4 gap = 0.008
PARAM  wide=n*2   b=1 ! why
NODES ! number x y
1 0 0 FIX=XYR ! the ground
  100 to 100+n 0 TO 20  ( 3 + 0.5 ) FIX=YR
INCLUDE more.inc
PROPS
COL1 SPRING KX=420000/2 FX=2400/2,5 &  ! strength
   RULE=ELASTO_PLASTIC
C2 SPRING KX=1 FX=2
POUND CONTACT gap = gap LAW=LINEAR K=1
 X SPRING KX= &
  5
  ! a remark
OUTPUT
 EVERY = 0.1
END
  what follows   is no deck
"""
TIDY = """TITLE   Two   words  ! kept
UNITS  kN m s
PARAM  n = 4        gap = 0.008
PARAM  wide = n*2   b = 1  ! why
NODES  ! number x y
   1              0         0             FIX=XYR  ! the ground
   100 TO 100+n   0 TO 20   ( 3 + 0.5 )   FIX=YR
INCLUDE more.inc
PROPS
   COL1    SPRING    KX=420000/2  FX=2400/2,5  &  ! strength
      RULE=ELASTO_PLASTIC
   C2      SPRING    KX=1         FX=2
   POUND   CONTACT   gap=gap  LAW=LINEAR  K=1
 X SPRING KX= &
  5
  ! a remark
OUTPUT
   EVERY=0.1
END
  what follows   is no deck
"""


def test_the_layout_as_it_looks():
    assert layout(UNTIDY)[0] == TIDY


def test_line_ends_and_encodings_are_kept():
    plain = "TITLE x\nNODES\n1 0 0 ! größer\n"
    for encoding in ("utf-8", "utf-8-sig", "latin-1"):
        for end in ("\n", "\r\n"):
            new, found, _ = arranged("deck.inp", plain.replace("\n", end).encode(encoding))
            assert new == plain.replace("1 0 0 ", "   1   0   0  ").replace("\n", end).encode(encoding)
            assert [d.code for d in found] == ["P101"] * (encoding == "latin-1")


@pytest.mark.parametrize("data", [b"NODES\n1 0 (0\n", b"NODES\n\0", b"<html>", b"NODES\n 1 0 &\n"])
def test_what_cannot_be_read_is_not_laid_out(data):
    new, found, _ = arranged("deck.inp", data)
    assert new is None and found[0].severity == "error"
