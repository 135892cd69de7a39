"""Every row of every validation case agrees or disagrees with the experiment as the manual's page says."""

from __future__ import annotations

import re

import pytest

from verification import validation

pytestmark = pytest.mark.full


@pytest.mark.parametrize("name", validation.CASES)
def test_outcomes(name: str) -> None:
    rows = validation.CASES[name].rows()
    assert rows
    wrong = [" | ".join(r.cells()) for r in rows if r.within != r.agrees]
    assert not wrong, "\n".join(wrong)


def test_some_cases_disagree_and_the_page_says_so() -> None:
    committed = validation.PAGE.read_text(encoding="utf-8")
    off = {name for name, c in validation.CASES.items() if not all(r.agrees for r in c.rows())}
    assert {"steel_bars", "rocking_block"} <= off
    for name in off:
        chapter = committed.split(f"### {validation.CASES[name].title}\n")[1].split("\n### ")[0]
        assert "disagrees**" in chapter.split("\n| ")[0]


def test_page_is_fresh() -> None:
    committed = validation.PAGE.read_text(encoding="utf-8")
    assert committed == validation.page(committed), "run: python tests/verification/validation.py"


def test_page_and_examples_name_each_other() -> None:
    committed = validation.PAGE.read_text(encoding="utf-8")
    decks = {p.relative_to(validation.DECKS).as_posix() for p in validation.DECKS.rglob("*.inp")}
    named = {d for c in validation.CASES.values() for d in c.decks}
    assert decks == named
    assert named <= set(re.findall(r"\(\.\./examples/validation/([^)]+)\)", committed))
    for folder in {d.split("/")[0] for d in decks}:
        assert (validation.DECKS / folder / "README.md").is_file(), folder
