"""Decks cut off and damaged anywhere: no help ends in an exception, and a rename keeps the meaning."""

import os
import re
from dataclasses import fields, is_dataclass
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from editor.everything import ask_everything, place_in
from pound_deck.model import Card, Element, Span
from pound_deck.reader import read_deck
from pound_deck.schema import Kind, Spec
from pound_solve.catalog import catalog
from pound_solve.editor.names import mentions
from pound_solve.editor.reading import read
from pound_solve.editor.rename import RenameError, applied, rename
from tiers import at_night

ROOT = Path(__file__).parents[2]
DECKS = sorted((ROOT / "examples").rglob("*.in[pc]"))
PIECES = [
    "",
    " ",
    "\n",
    "=",
    "&\n",
    "&",
    "!",
    '"',
    "'",
    "(",
    ")",
    ",",
    "TO ",
    "1E",
    "NODES",
    "PROPS\n",
    "*",
    "\t",
]
SORTS = ("node", "element", "property set", "PARAM")
quiet = settings(max_examples=40, suppress_health_check=[HealthCheck.too_slow])


@pytest.mark.full
@quiet
@given(st.sampled_from(DECKS), st.data())
def test_a_deck_cut_off_anywhere(path, data):
    text = path.read_text("utf-8")
    text = text[: data.draw(st.integers(0, len(text)))]
    ask_everything(path, text, place_in(path, text, len(text)))


@pytest.mark.full
@quiet
@given(st.sampled_from(DECKS), st.data())
def test_a_deck_damaged_anywhere(path, data):
    text = path.read_text("utf-8")
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(text)))
        cut = data.draw(st.integers(0, 20))
        text = text[:at] + data.draw(st.sampled_from(PIECES)) + text[at + cut :]
    at = data.draw(st.integers(0, len(text)))
    ask_everything(path, text, place_in(path, text, at))


@quiet
@given(st.text(st.characters(exclude_categories=["Cs"]), max_size=100), st.integers(0, 100))
def test_any_text(text, at):
    text = text.replace("\r", "")
    ask_everything("/deck.inp", text, place_in("/deck.inp", text, min(at, len(text))))


def bare(thing):
    """All that a model says, without places."""
    if isinstance(thing, Span):
        return None
    if isinstance(thing, Spec):
        return thing.family, thing.name
    if isinstance(thing, Card):
        specs = (thing.spec, *(s for laws in thing.laws.values() for s in laws))
        labels = {f.name for s in specs for f in s.fields if f.kind in (Kind.PROP, Kind.PROPS)}
        values = {k: of_label(v) if k in labels else v for k, v in thing.values.items()}
        return bare(thing.spec), values, of_label(thing.label)
    if isinstance(thing, Element):
        return thing.id, of_label(thing.prop), thing.i, thing.j, thing.name
    if is_dataclass(thing):
        names = [f.name for f in fields(thing) if f.name not in ("files", "spans", "params")]
        return {name: bare(getattr(thing, name)) for name in names}
    if isinstance(thing, dict):
        return {key: bare(value) for key, value in thing.items()}
    return tuple(map(bare, thing)) if isinstance(thing, tuple) else thing


def of_label(value):
    """Labels of property sets, told from all other texts."""
    return tuple(map(of_label, value)) if isinstance(value, tuple) else value and f"label {value}"


def replaced(thing, old, new):
    """The same with a label in place of another."""
    if isinstance(thing, dict):
        return {new if k == old else k: replaced(v, old, new) for k, v in thing.items()}
    if isinstance(thing, tuple):
        return tuple(replaced(v, old, new) for v in thing)
    return new if thing == old and isinstance(thing, str) else thing


def model_of(path, texts):
    model, found, _ = read_deck(
        str(path), catalog(), unsaved={os.path.realpath(n): t for n, t in texts.items()}
    )
    assert model is not None, found
    return bare(model) | {"props": {of_label(k): bare(v) for k, v in model.props.items()}}


WHOLE = [p for p in DECKS if p.suffix == ".inp" and p.parent.name != "open"]  # these wait for numbers


@pytest.mark.full
@pytest.mark.parametrize(
    "path", [*WHOLE[::4], *at_night(*(p for p in WHOLE if p not in WHOLE[::4]))], ids=lambda p: p.stem
)
def test_renaming_there_and_back_gives_the_same_text(path):
    """And between, the model of a PARAM is the same, that of a property set but for its label."""
    reading = read(str(path), catalog(), {})
    before = model_of(path, reading.files)
    defined = [m for m in mentions(reading) if m.defines and m.plain]
    assert len(defined) > 3
    for m in (m for sort in SORTS for m in [m for m in defined if m.sort == sort][::7]):
        old = reading.files[m.span.file].split("\n")[m.span.line - 1][m.span.column - 1 : m.span.end - 1]
        new = "987654" if m.sort in ("node", "element") else "ZZ9"
        try:
            edits = rename(reading, str(path), m.span, new)
        except RenameError as error:
            assert re.search("names it, too", str(error)), error
            continue
        texts = applied(reading.files, edits)
        after = model_of(path, texts)
        if m.sort == "PARAM":
            assert after == before
        elif m.sort == "property set":
            assert after == replaced(before, of_label(m.key), of_label(new))
        else:
            assert int(new) in after[m.sort + "s"] and m.key not in after[m.sort + "s"]
        again = read(str(path), catalog(), {os.path.realpath(n): t for n, t in texts.items()})
        back = rename(again, str(path), edits[[s for s, _ in edits].index(m.span)][0], old)
        assert [t.upper() for t in applied(texts, back).values()] == [
            t.upper() for t in reading.files.values()
        ]
