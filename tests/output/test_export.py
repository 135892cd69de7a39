"""CSV: every number comes back to its last bit."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from output import sample
from pound_solve.cli.main import main
from pound_solve.report.export import export_csv
from pound_solve.results import Results, Writer
from pound_solve.results.contents import TABLES


@pytest.fixture(scope="module")
def files(done: Results, tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[list[str]]]:
    paths = export_csv(done, tmp_path_factory.mktemp("csv") / "new" / "folder")
    return {path.name: list(csv.reader(path.read_text("utf-8").splitlines())) for path in paths}


def test_one_file_for_each(done: Results, files: dict[str, list[list[str]]]) -> None:
    histories = [f"history_{n.replace('/', '_')}.csv" for n in done.histories if n != "time"]
    assert list(files) == [*(f"{n}.csv" for n in TABLES), *histories]


def test_heads(files: dict[str, list[list[str]]]) -> None:
    assert files["loads.csv"][0] == ["node", "fx [kN]", "fy [kN]", "mz [kN*m]"]
    assert files["history_node_v.csv"][0][:4] == ["time [s]", "1 X [m/s]", "1 Y [m/s]", "1 R [rad/s]"]
    assert files["history_energy.csv"][0][1] == "input [kN*m]"


@pytest.mark.parametrize("name", TABLES)
def test_tables(files: dict[str, list[list[str]]], name: str) -> None:
    lines, rows = files[f"{name}.csv"][1:], sample.rows()[name]
    assert len(lines) == len(rows)
    for line, row in zip(lines, rows):
        for cell, value in zip(line, row, strict=True):
            if isinstance(value, str):
                assert cell == value
            else:
                np.testing.assert_equal(float(cell or "nan"), value)


def test_histories(done: Results, files: dict[str, list[list[str]]]) -> None:
    for name in done.histories[1:]:
        numbers = np.array(files[f"history_{name.replace('/', '_')}.csv"][1:], dtype=float)
        np.testing.assert_array_equal(numbers[:, 0], done.time)
        np.testing.assert_array_equal(numbers[:, 1:], done.history(name).reshape(len(done.time), -1))


def test_again(done: Results, tmp_path: Path) -> None:
    assert export_csv(done, tmp_path) == export_csv(done, tmp_path)


def test_no_text_of_a_deck_is_a_formula_of_a_spreadsheet(tmp_path: Path) -> None:
    with Writer(tmp_path / "f.h5", title="t", units=sample.UNITS, program_version="0") as writer:
        texts = ["=1+2", "@x", "-2", "-cmd|' /C calc'!A0", "+a", "plain"]
        writer.table("size", [(text, "-") for text in texts])
        writer.finish("done")
    with Results.open(tmp_path / "f.h5") as results:
        paths = export_csv(results, tmp_path)
    with paths[0].open(encoding="utf-8") as file:
        cells = [row[0] for row in csv.reader(file)][1:]
    assert cells == ["'=1+2", "'@x", "-2", "'-cmd|' /C calc'!A0", "'+a", "plain"]


# ---------------------------------------------------------------------- chosen columns


def test_chosen_columns_stand_side_by_side_in_the_order_asked(done: Results, tmp_path: Path) -> None:
    """The sample's components and contacts say in their heads where they stand."""
    contact = done.coordinates("contact/force")["contact"][0]
    asked = [
        "--history",
        "node/u",
        "node=2",
        "component=Y",
        "--history",
        "contact/force",
        f"contact={contact}",
    ]
    whole = ["--history", "energy"]
    assert main(["export", str(done.path), "-o", str(tmp_path / "new"), *asked, *whole]) == 0
    (path,) = (tmp_path / "new").iterdir()
    heads, *rows = csv.reader(path.read_text("utf-8").splitlines())
    parts = [f"energy {label} [kN*m]" for label in done.labels("energy")]
    assert heads == ["time [s]", "node/u 2 Y [m]", f"contact/force {contact} [kN]", *parts]
    columns = [
        done.time,
        done.history("node/u", node=2, component="Y"),
        done.history("contact/force", contact=contact),
        *done.history("energy").T,
    ]
    np.testing.assert_array_equal(np.array(rows, dtype=float), np.transpose(columns))


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        (["node/u", "node=99"], "history 'node/u' has no number of node='99'; it has: 1, "),
        (["node/u", "knot=2"], "history 'node/u' has no 'knot'; it has: node, component"),
        (["node/q"], "no history 'node/q' in this file; it has: "),
        (["node/u", "2"], "--history: 2 is no KEY=VALUE, such as node=12"),
        (
            ["node/u", "node=1", "node=2"],
            "--history: node is given twice; repeat --history for further columns",
        ),
    ],
)
def test_columns_that_there_are_not(
    done: Results, tmp_path: Path, capsys: pytest.CaptureFixture[str], asked: list[str], says: str
) -> None:
    try:
        status = main(["export", str(done.path), "-o", str(tmp_path / "new"), "--history", *asked])
    except SystemExit as stop:
        status = int(stop.code or 0)
    assert status == 2
    assert says in capsys.readouterr().err
    assert not (tmp_path / "new").exists()
