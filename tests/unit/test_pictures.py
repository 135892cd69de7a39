"""Pictures of the manual: as fresh as the laws they show, small, and well-formed."""

from pathlib import Path
from xml.etree import ElementTree

import pytest

from gallery import ALL_FILES
from pound_solve.assess.law_test import AXES
from pound_solve.catalog import specs
from refresh_manual import pictures

FOLDER = Path(__file__).parents[2] / "manual" / "pictures"
DRAWN = pictures()


def test_every_law_has_its_picture_and_no_picture_is_left_over():
    """To renew them: ``python tests/refresh_manual.py``."""
    assert {p.name for p in FOLDER.glob("*")} == set(DRAWN) | ALL_FILES
    none = {"ELASTIC", "STEREOMECHANICS", "LAGRANGE"}
    names = {s.name for s in specs() if s.family in AXES} - none
    assert {x.removesuffix(".svg").split("_", 1)[1].upper() for x in DRAWN} == names


@pytest.mark.parametrize("name", DRAWN)
def test_the_picture_is_fresh(name):
    assert (FOLDER / name).read_text("utf-8") == DRAWN[name]


@pytest.mark.parametrize("name", DRAWN)
def test_the_picture_is_small_labelled_and_well_formed(name):
    text = DRAWN[name]
    assert len(text) < 8000
    root = ElementTree.fromstring(text)
    texts = [t.text for t in root.iter("{http://www.w3.org/2000/svg}text")]
    assert texts[0].split()[0] == name.removesuffix(".svg").split("_", 1)[1].upper()
    assert {"deformation", "force"} <= set(texts) or {"closure", "contact force"} <= set(texts)
    # every text and every corner of the curve lies within the picture
    curve = root.findall("{http://www.w3.org/2000/svg}path")[-1].get("d")
    points = [tuple(map(float, p.split())) for p in curve.removeprefix("M").split("L")]
    assert len(points) > 3
    assert all(58 <= x <= 466 and 46 <= y <= 304 for x, y in points)
