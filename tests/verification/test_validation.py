"""Every row of every validation case agrees or disagrees with the experiment as the manual's page says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from pound_solve.driver.prepare import DeckError
from pound_solve.driver.run import Request, prepare
from verification import validation

pytestmark = pytest.mark.full

OPEN = sorted(validation.OPEN.glob("*.inp"))
#: values that a test gives to what is missing; they describe no experiment
ANY = {"e": "0.5", "xi": "0.02", "xi1": "0.02", "xi2": "0.03", "gap": "0.01", "ri": "0.1", "h": "3"}


@pytest.mark.parametrize("name", validation.CASES)
def test_outcomes(name: str) -> None:
    rows = validation.CASES[name].rows()
    assert rows
    wrong = [" | ".join(r.cells()) for r in rows if r.within != r.agrees]
    assert not wrong, "\n".join(wrong)


def test_the_page_explains_each_disagreement() -> None:
    committed = validation.PAGE.read_text(encoding="utf-8")
    off = set()
    for name, c in validation.CASES.items():
        text, *rows = committed.split(f"### {c.title}\n")[1].split("\n#")[0].split("\n| ")
        if any(row.rstrip().endswith("| **disagrees** |") for row in rows):
            off.add(name)
            assert re.search(r"\*\*[A-Z][^*]* disagrees?\*\*", text), name
    assert {"steel_bars", "rocking_block"} <= off < validation.CASES.keys()


@pytest.mark.slow  # it computes all rows again
def test_page_is_fresh() -> None:
    committed = validation.PAGE.read_text(encoding="utf-8")
    assert committed == validation.page(committed), "run: python tests/verification/validation.py"


def test_page_and_examples_name_each_other() -> None:
    committed = validation.PAGE.read_text(encoding="utf-8")
    decks = {p.relative_to(validation.DECKS).as_posix() for p in validation.DECKS.rglob("*.inp")}
    named = {d for c in validation.CASES.values() for d in c.decks}
    assert decks == named | {f"open/{path.name}" for path in OPEN}
    assert decks == set(re.findall(r"\(\.\./examples/validation/([^)]+\.inp)\)", committed))
    for folder in {d.split("/")[0] for d in decks}:
        assert (validation.DECKS / folder / "README.md").is_file(), folder


def missing(deck: Path) -> list[str]:
    """Names of the PARAMs that a deck leaves to the user."""
    return re.findall(r'(\w+) = "?MISSING', deck.read_text(encoding="utf-8"))


@pytest.fixture
def given(tmp_path: Path) -> dict[str, str]:
    """A record beside the values."""
    record = tmp_path / "record.txt"
    record.write_text("".join(f"{0.01 * i:g} {0.1 * (-1) ** i}\n" for i in range(100)), encoding="utf-8")
    return ANY | {"record": str(record), "last": "0.5", "drop": "0.1"}


@pytest.mark.parametrize("deck", OPEN, ids=lambda d: d.stem)
def test_an_open_deck_is_sound_once_all_numbers_are_given(deck: Path, given: dict[str, str]) -> None:
    values = {name: given.get(name, "3" if name[0] == "m" else "300") for name in missing(deck)}
    assert len(values) > 1
    prepared = prepare(Request(str(deck), values))
    assert {w.code for w in prepared.warnings} == set()


@pytest.mark.parametrize("deck", OPEN, ids=lambda d: d.stem)
def test_an_open_deck_is_refused_at_each_missing_number(deck: Path, given: dict[str, str]) -> None:
    values = {name: given.get(name, "3" if name[0] == "m" else "300") for name in missing(deck)}
    lines = deck.read_text(encoding="utf-8").splitlines()
    for name in values:
        with pytest.raises(DeckError) as refused:
            prepare(Request(str(deck), {n: v for n, v in values.items() if n != name}))
        (error,) = (d for d in refused.value.diagnostics if d.severity == "error")
        if name == "record":
            assert error.code == "R401" and "'MISSING'" in str(refused.value)
        else:
            assert error.span is not None
            place = lines[error.span.line - 1][: error.span.column - 1]
            assert error.code == "P222" and place.endswith(f" {name} = ")
