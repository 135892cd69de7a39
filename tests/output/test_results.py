"""The results file: what is written is read, what is wrong is refused, what is killed stays readable."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from output import sample
from output.sample_layouts import LAYOUTS
from output.sample_rows import ROWS
from pound_solve import __version__
from pound_solve.results import Results, ResultsError, Writer
from pound_solve.results.contents import HISTORIES, TABLES
from pound_solve.results.writer import BLOCK


def test_every_table_and_history_has_a_sample() -> None:
    """To add one: rows in `output/sample_rows.py`, a layout in `output/sample_layouts.py`."""
    assert ROWS.keys() == TABLES.keys() and all(ROWS.values())
    assert LAYOUTS.keys() == HISTORIES.keys() - {"time"} and all(x.shape for x in LAYOUTS.values())


@pytest.mark.parametrize("name", TABLES)
def test_tables_come_back(done: Results, name: str) -> None:
    table, rows = done.table(name), sample.rows()[name]
    assert table.dtype.names == tuple(c.name for c in TABLES[name].columns)
    assert len(table) == len(rows)
    for got, given in zip(table.tolist(), rows):
        np.testing.assert_equal(got, tuple(given))
        assert [type(v) is str for v in got] == [type(v) is str for v in given]
    units = done.table_units(name)
    assert units == {c.name: sample.UNITS.text(c.unit) for c in TABLES[name].columns}


def test_head_and_texts_come_back(done: Results) -> None:
    assert (done.title, done.status, done.message) == (sample.TITLE, "done", "")
    assert (done.units.force, done.units.length, done.units.time) == ("kN", "m", "s")
    assert done.program_version == __version__
    assert done.texts == ("decks/two buildings.inp",)
    assert done.text("decks/two buildings.inp") == sample.DECK
    assert done.tables == tuple(TABLES)
    assert done.note("node_envelope") == "Accelerations are absolute."
    assert done.note("nodes") == ""


@pytest.mark.parametrize("name", ["../a.inp", "/abs/a.inp", ".", "50%2F.inp", "ü.inp", "C:\\a.inp"])
def test_any_file_name_will_do(writer: Writer, tmp_path: Path, name: str) -> None:
    writer.text(name, "old")
    writer.text(name, "x\0y \udcff")
    writer.finish("done")
    writer.close()
    with Results.open(tmp_path / "out.h5") as results:
        assert results.texts == (name,)
        assert results.text(name) == "x\N{REPLACEMENT CHARACTER}y ?"


def test_histories_come_back(done: Results) -> None:
    whole = sample.block(0, 300)
    assert done.histories == tuple(n for n in HISTORIES if n in whole and n != "spring/force")
    np.testing.assert_array_equal(done.time, whole["time"])
    assert done.last_time == whole["time"][-1]
    for name in done.histories:
        # blocks are computed apart: the last digit of a time may differ
        np.testing.assert_allclose(done.history(name), whole[name], rtol=1e-14)
        assert done.history(name).dtype == np.float64


def test_labels_and_units_of_histories(done: Results) -> None:
    assert done.labels("node/u")[:4] == ("1 X", "1 Y", "1 R", "2 X")
    assert done.history_units("node/v")[:3] == ("m/s", "m/s", "rad/s")
    assert len(done.labels("node/u")) == len(done.history_units("node/u")) == 3 * len(sample.NODES)
    assert done.labels("member/force") == ("101 axial", "101 moment I", "102 axial")
    assert done.history_units("member/force") == ("kN", "kN*m", "kN")
    assert done.history_units("drift") == ("m",)
    assert done.attributes("member/force")["element"] == [101, 101, 102]
    assert done.attributes("node/a")["nodes"] == list(sample.NODES)


def test_missing_names_say_what_there_is(done: Results) -> None:
    with pytest.raises(KeyError, match=r"no table 'mode'.*modes, mode_buildings, mode_shapes"):
        done.table("mode")
    with pytest.raises(KeyError, match=r"no history 'node/x'.*node/u"):
        done.history("node/x")
    with pytest.raises(KeyError, match=r"no text 'b.inp'.*two buildings"):
        done.text("b.inp")


def test_labels_of_a_large_model(writer: Writer, tmp_path: Path) -> None:
    """Attributes above 64 kB, which the oldest file format refuses."""
    n = 20_000
    force = {"element": range(n), "quantity": ["axial"] * n, "unit": "F"}
    writer.start_history({"member/force": ((n,), force)})
    writer.close()
    with Results.open(tmp_path / "out.h5") as results:
        assert results.labels("member/force")[-1] == "19999 axial"


def test_a_table_is_replaced(writer: Writer, tmp_path: Path) -> None:
    writer.table("size", [("a", "1"), ("b", "2")])
    writer.table("size", [("c", "3")])
    writer.table("checks", [])
    writer.close()
    with Results.open(tmp_path / "out.h5") as results:
        assert results.table("size").tolist() == [("c", "3")]
        assert len(results.table("checks")) == 0
        assert results.status == "killed"


@pytest.mark.parametrize(
    ("name", "row", "error", "words"),
    [
        ("nonsense", (), ValueError, "no table 'nonsense'"),
        ("size", ("a",), ValueError, "row 1: 1 values for 2 columns"),
        ("size", ("a", 1), TypeError, "column 'value': 1 is not str"),
        ("loads", (1.5, 0.0, 0.0, 0.0), TypeError, "column 'node': 1.5 is not int"),
        ("loads", (True, 0.0, 0.0, 0.0), TypeError, "column 'node'"),
        ("loads", (1, "0", 0.0, 0.0), TypeError, "column 'fx': '0' is not real"),
        ("loads", (1, None, 0.0, 0.0), TypeError, "column 'fx'"),
    ],
)
def test_wrong_rows_are_refused(
    writer: Writer, name: str, row: tuple[object, ...], error: type[Exception], words: str
) -> None:
    good = {"size": ("a", "b"), "loads": (np.int64(1), np.float64(0), 0, 0.0)}.get(name, ())
    with pytest.raises(error, match=words):
        writer.table(name, [good, row])


@pytest.mark.parametrize(
    ("layout", "words"),
    [
        ({"node/w": ((3,), {"labels": "xyz"})}, "no history 'node/w'"),
        ({"time": ((), {})}, "no history 'time'"),
        ({"drift": ((2,), {"labels": ("a",)})}, "2 labels"),
        ({"drift": ((2,), {})}, "2 labels"),
        ({"drift": ((2,), {"labels": ("a", "b"), "unit": ("L",)})}, "one unit or 2"),
        ({"node/u": ((2, 3), {"labels": "xyr"})}, "2 node numbers"),
    ],
)
def test_wrong_layouts_are_refused(writer: Writer, layout: dict, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        writer.start_history(layout)


def test_wrong_blocks_are_refused(writer: Writer, tmp_path: Path) -> None:
    writer.start_history({"drift": ((2,), {"labels": ("a", "b")})})
    with pytest.raises(ValueError, match="started already"):
        writer.start_history({})
    with pytest.raises(ValueError, match="never started: energy"):
        writer.append({"time": np.zeros(1), "drift": np.zeros((1, 2)), "energy": np.zeros((1, 7))})
    with pytest.raises(ValueError, match=r"'drift': shape \(1, 2\), not \(3, 2\)"):
        writer.append({"time": np.zeros(3), "drift": np.zeros((1, 2))})
    writer.append({"time": np.zeros(0), "drift": np.zeros((0, 2))})
    writer.close()
    with Results.open(tmp_path / "out.h5") as results:
        assert len(results.time) == 0
        assert np.isnan(results.last_time)


def test_status(writer: Writer, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="'over' is not one of done, stopped"):
        writer.finish("over")
    writer.finish("stopped", "element 12 at 3 s – why")
    writer.close()
    with Results.open(tmp_path / "out.h5") as results:
        assert (results.status, results.message) == ("stopped", "element 12 at 3 s – why")


def test_an_exception_stops_the_run(tmp_path: Path) -> None:
    path = tmp_path / "out.h5"
    writer = Writer(path, title="", units=sample.UNITS, program_version="")
    with pytest.raises(ArithmeticError), writer:
        raise ArithmeticError("negative stiffness")
    with Results.open(path) as results:
        assert (results.status, results.message) == ("stopped", "ArithmeticError: negative stiffness")


_ENVIRONMENT = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(__file__).parents[1]), *sys.path])}
_ENDLESS = """
import sys
from pathlib import Path
from output import sample
from pound_solve import __version__
from pound_solve.results import Writer
writer = Writer(Path(sys.argv[1]), title="killed", units=sample.UNITS, program_version="0")
writer.table("nodes", sample.rows()["nodes"])
writer.start_history(sample.layout())
number = 0
while True:
    writer.append(sample.block(100 * number, 100))
    number += 1
    print(number, flush=True)
    if number == int(sys.argv[2]):
        import os
        os._exit(9)
"""


@pytest.mark.parametrize("kill", [False, True], ids=["os._exit", "SIGKILL"])
def test_a_killed_run_leaves_a_readable_file(tmp_path: Path, kill: bool) -> None:
    path = tmp_path / "out.h5"
    command = [sys.executable, "-c", _ENDLESS, str(path), "1000000" if kill else "5"]
    child = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=_ENVIRONMENT)
    assert child.stdout is not None
    with child.stdout as lines:
        written = [int(next(lines)) for _ in range(5)]
        if kill:
            child.kill()
        child.wait()
    with Results.open(path) as results:
        count = len(results.time)
        assert count >= 100 * written[-1]
        assert results.status == "killed"
        assert len(results.table("nodes")) == len(sample.rows()["nodes"])
        whole = sample.block(0, count)
        for name in results.histories:
            assert len(results.history(name)) == count
            np.testing.assert_allclose(results.history(name)[:500], whole[name][:500], rtol=1e-12)


def test_chunks_hold_a_block_of_all_columns(done: Results) -> None:
    with h5py.File(done.path) as file:
        assert file["history/node/u"].chunks == (BLOCK, len(sample.NODES), 3)
        assert file["history/node/u"].dtype == np.float64
        assert list(file.attrs["format_version"]) == [2, 0]
        assert file.attrs["filetype"] == "pound-solve results"


def test_wrong_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ResultsError, match="no such file"):
        Results.open(tmp_path / "none.h5")
    with pytest.raises(ResultsError, match="no such file"):
        Results.open(tmp_path)
    text = tmp_path / "text.h5"
    text.write_text("TITLE this is a deck\n" * 100)
    with pytest.raises(ResultsError, match=r"text\.h5: not an HDF5 file"):
        Results.open(text)
    good = sample.write(tmp_path / "good.h5")
    cut = tmp_path / "cut.h5"
    cut.write_bytes(good.read_bytes()[:5000])
    with pytest.raises(ResultsError, match="ends too early"):
        Results.open(cut)
    with pytest.raises(ResultsError, match="cannot be written: No such file or directory"):
        Writer(tmp_path / "none" / "out.h5", title="", units=sample.UNITS, program_version="")


@pytest.mark.parametrize(
    ("attribute", "value", "words"),
    [
        ("filetype", "statepoint", "not one of pound-solve"),
        ("filetype", None, "not one of pound-solve"),
        ("format_version", [3, 3], r"format 3\.3, this version reads up to 2\.x; written by pound-solve"),
        ("title", None, "damaged results file"),
    ],
)
def test_foreign_and_newer_files_are_refused(
    tmp_path: Path, attribute: str, value: object, words: str
) -> None:
    path = sample.write(tmp_path / "out.h5")
    with h5py.File(path, "r+") as file:
        del file.attrs[attribute]
        if value is not None:
            file.attrs[attribute] = value
    with pytest.raises(ResultsError, match=words):
        Results.open(path)


def test_a_newer_minor_version_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pound_solve.results.writer.FORMAT_VERSION", (1, 7))
    path = sample.write(tmp_path / "out.h5")
    with h5py.File(path, "r+") as file:
        file.copy("tables/size", "tables/new_table")
        del file["tables/new_table"].attrs["digest"]
    with Results.open(path) as results:
        assert results.tables[-1] == "new_table"
        assert len(results.table("new_table")) == len(sample.rows()["size"])


def test_a_file_in_use_is_named_so(tmp_path: Path, writer: Writer) -> None:
    code = f"from pound_solve.results import Results; Results.open({str(tmp_path / 'out.h5')!r})"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=_ENVIRONMENT)
    assert "in use by another program" in run.stderr
