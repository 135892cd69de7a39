"""The list of tables, and the manual's page that is made from it."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace

import pytest

from decks import structure_of
from pound_solve.results import Results, tables
from pound_solve.results.contents import HISTORIES, SECTIONS, TABLES
from pound_solve.results.schema import FORMATS, Stage
from pound_solve.results.tables.input import properties

PAGE = Path(__file__).parents[2] / "manual" / "results.md"


def test_every_table_stands_in_one_section() -> None:
    assert [name for _, names in SECTIONS for name in names] == list(TABLES)
    assert len({table.title for table in TABLES.values()}) == len(TABLES)
    # what differs between two runs of a deck comes last
    assert SECTIONS[-2] == ("Run figures", ("run_figures", "imports"))
    assert SECTIONS[-1][0] == "Error against time"


def test_a_table_is_a_module_of_its_name() -> None:
    folder = Path(tables.__file__).parent
    assert {path.stem for path in folder.glob("*/*.py")} - {"__init__"} == TABLES.keys()
    assert all(set(table.stages) <= set(Stage) and table.stages for table in TABLES.values())
    assert len({history.place for history in HISTORIES.values()}) == len(HISTORIES)


def test_columns_are_sound() -> None:
    for table in TABLES.values():
        names = [c.name for c in table.columns]
        assert len(set(names)) == len(names)
        assert not table.group or table.group in names
        for column in table.columns:
            assert column.fmt in FORMATS
            assert column.title.isascii()
            assert re.fullmatch(r"deg|[-%FLT*/^\d1rad.]*", column.unit)


def test_the_page_lists_what_a_file_holds(done: Results) -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert all(f"`{name}`" in page for name in done.tables)
    assert all(f"`/history/{name}`" in page for name in done.histories)
    assert set(done.histories) <= HISTORIES.keys()


@pytest.mark.parametrize(
    ("strengths", "unit"),
    [("KX=5 FX=60", "m"), ("KR=5 MR=60", "rad"), ("KX=5 FX=60 KR=5 MR=60", "m or rad")],
)
def test_the_echo_gives_deformations_of_moments_in_radians(strengths: str, unit: str) -> None:
    deck = (
        "UNITS kN m s\nNODES\n 1 0 0 FIX=XYR\n 2 1 0 FIX=Y\nELEMENTS\n 1 COL 1 2\nPROPS\n"
        f" COL SPRING {strengths} RULE=IMK_BILINEAR DP=0.02 DPC=0.05\n"
        "WEIGHTS\n 2 100 0 100\nANALYSIS\n MODAL 1\n"
    )
    rows = list(properties.rows(SimpleNamespace(model=structure_of(deck).model)))
    assert {row[4] for row in rows if row[2] in ("DP", "DPC")} == {unit}
