"""The gallery: its first pages are those of runs."""

from __future__ import annotations

import re
from typing import Any, Final

import pytest

from gallery import EXAMPLES, EXHIBITS, FOLDER, PAGE, first_page, shown_page
from pound_solve.report.text import render

ROUNDING: Final = re.compile(r"\d(\.\d+)?[eE]-1\d")


@pytest.mark.parametrize("deck", EXHIBITS)
def test_the_first_page_is_that_of_a_run(run: Any, deck: str) -> None:
    _, results, _ = run(EXAMPLES / deck)
    assert words(shown_page(PAGE.read_text("utf-8"), deck)) == words(first_page(render(results)))


def words(page: str) -> list[str]:
    """Words of a page without rules and without digits of rounding errors, which machines differ in."""
    return [ROUNDING.sub("tiny", word) for word in page.split() if not word.startswith("--")]


@pytest.mark.parametrize("deck", EXHIBITS)
def test_every_exhibit_has_its_picture(deck: str) -> None:
    assert f"](pictures/{EXHIBITS[deck]})" in PAGE.read_text("utf-8")
    assert (FOLDER / EXHIBITS[deck]).stat().st_size > 2000
