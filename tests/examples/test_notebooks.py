"""Every notebook runs from its first cell to its last, shows what it is for, and is stored empty."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

FOLDER = Path(__file__).parents[2] / "examples" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
#: pictures and tables that the cells of each show
SHOWN = {"first_run": (2, 1), "gap_study": (1, 1), "storeys": (3, 1)}


def cells(path: Path) -> list[dict[str, Any]]:
    return [c for c in json.loads(path.read_text("utf-8"))["cells"] if c["cell_type"] == "code"]


@pytest.fixture
def beside(tmp_path: Path) -> Path:
    """A copy of the notebooks beside the examples whose decks they run."""
    texts = "".join(path.read_text("utf-8") for path in NOTEBOOKS)
    for name in {"notebooks", *re.findall(r"\.\./(\w+)/", texts)}:
        shutil.copytree(FOLDER.parent / name, tmp_path / name)
    return tmp_path / "notebooks"


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "MPLBACKEND": "Agg"}


def test_every_notebook_is_in_the_readme() -> None:
    listed = re.findall(r"^\| \[(\w+)\]\(\1\.ipynb\)", (FOLDER / "README.md").read_text("utf-8"), re.M)
    assert sorted(listed) == [path.stem for path in NOTEBOOKS] == sorted(SHOWN)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_they_are_small_and_stored_without_output(path: Path) -> None:
    assert path.stat().st_size < 8_000
    for cell in cells(path):
        assert cell["outputs"] == [] and cell["execution_count"] is None


def test_a_run_a_table_a_history_and_a_plot_take_ten_lines() -> None:
    lines = [line for cell in cells(FOLDER / "first_run.ipynb") for line in cell["source"] if line.strip()]
    assert len(lines) <= 10
    text = "".join(lines)
    assert all(word in text for word in ("run(", "to_pandas(", "to_xarray(", ".plot"))


@pytest.mark.full
@pytest.mark.parametrize(
    "path",
    [
        pytest.param(p, id=p.stem, marks=() if p.stem == "first_run" else pytest.mark.slow)
        for p in NOTEBOOKS
    ],
)
def test_the_cells_run_as_a_program(path: Path, beside: Path) -> None:
    for package in ("pandas", "xarray", "matplotlib"):
        pytest.importorskip(package)
    program = "\n".join("".join(cell["source"]) for cell in cells(path))
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", program],
        cwd=beside,
        env=environment(),
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_jupyter_runs_them(path: Path, beside: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(sys.path))
    notebook = nbformat.read(beside / path.name, as_version=4)
    nbclient.NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(beside)}}).execute()
    outputs = [o for cell in notebook.cells if cell.cell_type == "code" for o in cell.outputs]
    assert all(o.output_type in ("execute_result", "display_data") for o in outputs), outputs
    kinds = [kind for o in outputs for kind in o.data]
    tables = sum("dataframe" in o.data.get("text/html", "") for o in outputs)
    assert (kinds.count("image/png"), tables) == SHOWN[path.stem]
    if path.stem == "first_run":
        assert outputs[0].data["text/plain"].startswith("<Results ")
