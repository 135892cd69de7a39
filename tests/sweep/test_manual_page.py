"""The page on sweeps says what the program does."""

import re
import tomllib
from pathlib import Path

from pound_solve.sensitivity import study as sensitivity
from pound_solve.statistics.distributions import FAMILIES
from pound_solve.statistics.optimum import METHODS
from pound_solve.statistics.replicates import SAMPLINGS
from pound_solve.sweep import calibrate, optimize, uncertainty
from pound_solve.sweep.study import measured, study
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


def test_items_of_the_verbs_with_variables_are_on_their_pages():
    """Each as code; the studies of the pages have no others."""
    names = {
        "uncertainty": (*uncertainty.ITEMS, "distribution", "mode", *FAMILIES, *SAMPLINGS),
        "sensitivity": (*sensitivity.ITEMS, *sensitivity.METHODS, "value", "motion"),
        "calibrate": (*calibrate.ITEMS, *measured.ITEMS, "scale", "log"),
        "optimize": (*optimize.ITEMS, *optimize.OBJECTIVE_ITEMS, *METHODS, *optimize.GOALS, "max", "log"),
    }
    for page, words in names.items():
        text = (Path(__file__).parents[2] / f"manual/{page}.md").read_text("utf-8")
        assert not [word for word in words if f"`{word}`" not in text and f'"{word}"' not in text], page
