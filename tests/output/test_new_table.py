"""A new table with its history is one new file: file, report, export and manual follow from it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import pound_solve

MODULE = '''"""Table ``storeys``."""

import numpy as np

from pound_solve.results.columns import NODE
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, History, HistoryLayout, Row, Stage, Table


def rows(run: RunRecord) -> list[Row]:
    """One row for each node."""
    return [(node.id, 2.0 * node.y) for node in run.model.nodes.values()]


TABLE = Table(
    name="storeys",
    title="Twice the height",
    place=25,
    stages=(Stage.INPUT,),
    columns=(NODE, Column("height", "height", "L", "num", doc="twice the ordinate")),
    rows=rows,
)
HISTORY = History(
    name="twice",
    place=35,
    row="nodes",
    doc="twice the displacement in X",
    layout=lambda items: HistoryLayout(
        (len(items.nodes),), {"labels": [f"{node} 2X" for node in items.nodes], "unit": "L"}
    ),
    values=lambda block: 2.0 * block.nodes["u"][::3].T,
)
'''
RUN = """
import sys
import manual_pages
import pound_solve
from pound_solve.report.export import export_csv
from pound_solve.report.text import render
with pound_solve.run(sys.argv[2]) as results:
    text = render(results)
    assert text.index(".2  NODES") < text.index(".3  TWICE THE HEIGHT") < text.index(".4  ELEMENTS")
    assert results.table("storeys").tolist() == [(1, 0.0), (2, 6.0)]
    assert results.labels("twice") == ("1 2X", "2 2X")
    assert (results.history("twice") == 2.0 * results.history("node/u")[:, :, 0]).all()
    assert {"storeys.csv", "history_twice.csv"} <= {path.name for path in export_csv(results, sys.argv[1])}
page = "\\n".join(manual_pages.tables())
assert "#### `storeys`: twice the height" in page and "| `/history/twice` | nodes |" in page
"""
DECK = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 0 3
ELEMENTS
 1 M 1 2
PROPS
 M FRAME E=2E8 A=0.01 I=1E-4
WEIGHTS
 2 100
EQUAKE
 SINE AMPLITUDE=1 PERIOD=0.5 DURATION=0.5
ANALYSIS
 HISTORY 0.5
"""


@pytest.mark.full
def test_a_new_table_is_one_new_file(tmp_path: Path) -> None:
    package = tmp_path / "pound_solve"
    shutil.copytree(
        Path(pound_solve.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__")
    )
    (package / "results" / "tables" / "input" / "storeys.py").write_text(MODULE)
    (tmp_path / "deck.inp").write_text(DECK)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])}
    command = [sys.executable, "-c", RUN, str(tmp_path / "csv"), str(tmp_path / "deck.inp")]
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
