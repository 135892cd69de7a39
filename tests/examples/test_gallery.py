"""The gallery: its first pages are those of runs."""

from __future__ import annotations

import re
from typing import Any

import pytest

from gallery import EXAMPLES, EXHIBITS, FOLDER, PAGE, first_page, shown_page
from pound_solve.report.text import render


@pytest.mark.parametrize("deck", EXHIBITS)
def test_the_first_page_is_that_of_a_run(run: Any, deck: str) -> None:
    _, results, _ = run(EXAMPLES / deck)
    assert words(shown_page(PAGE.read_text("utf-8"), deck)) == words(first_page(render(results)))


def words(page: str) -> list[str]:
    """Words of a page without rules, and without what the method and rounding decide: AUTO takes another
    exact method where the kernels are compiled.
    """
    page = re.sub(r"^[\d.]+  CHECKS OF THIS RUN\n.*?\n\n\n", "", page, flags=re.DOTALL | re.MULTILINE)
    lines = [x for x in page.splitlines() if not x.startswith(("  method ", "  error of the method "))]
    return [word for word in " ".join(lines).split() if not word.startswith("--")]


@pytest.mark.parametrize("deck", EXHIBITS)
def test_every_exhibit_has_its_picture(deck: str) -> None:
    assert f"](pictures/{EXHIBITS[deck]})" in PAGE.read_text("utf-8")
    assert (FOLDER / EXHIBITS[deck]).stat().st_size > 2000
