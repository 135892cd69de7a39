"""The page on sweeps says what the program does."""

import re
import tomllib
from pathlib import Path

from pound_solve.sweep.study import study
from pound_solve.sweep.study.records import FILES, LEVELS, OSCILLATOR

PAGE = (Path(__file__).parents[2] / "manual/sweep.md").read_text("utf-8")


def test_every_item_of_a_study_is_on_the_page_and_no_other():
    first = re.findall(r"^\| (`.*?) \|", PAGE, re.M)
    told = {word for cell in first for word in re.findall(r"`\[*([a-z]+)\]*`", cell)}
    assert set(study.ITEMS) | {FILES, *LEVELS, *OSCILLATOR} - {"period", "damping"} <= told
    for block in re.findall(r"```toml\n(.*?)```", PAGE, re.S):
        assert set(tomllib.loads(block)) <= set(study.ITEMS)


def test_the_largest_values_are_on_the_page():
    for name, largest in study.LARGEST.items():
        (row,) = re.findall(rf"^\| .*`{name}`.* \|$", PAGE, re.M)
        assert f"up to {largest:,.0f}".replace(",", " ") in row
