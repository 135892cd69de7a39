"""VTKHDF: the file follows the published layout, and VTK reads from it what the results hold."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np
import pytest

from pound_solve import Deck, run
from pound_solve.cli.main import main
from pound_solve.results import Results, ResultsError
from pound_solve.results.vtkhdf import LINE, MOTIONS, VERTEX, write_vtkhdf

DECK = """TITLE Two frames that meet, and a wall
UNITS kN m s
NODES
  1  0 0  FIX=XYR
  2  0 3
  3  4 3
  4  4 0  FIX=XYR
  11 6 0  FIX=XYR
  12 6 3
ELEMENTS
  101 COLUMN 1 2
  102 BEAM   2 3
  103 COLUMN 4 3
  111 COLUMN 11 12
  120 BASE   2
  901 POUND  3 12  NAME="the gap"
  902 WALL   12
PROPS
  COLUMN FRAME E=2E8 A=0.01 I=1E-4
  BEAM   FRAME E=2E8 A=0.01 I=1E-4
  BASE   SPRING KX=500 RULE=BILINEAR R=0.1 FX=2
  POUND  CONTACT GAP=0.002 LAW=KELVIN_VOIGT K=1E5 E=0.65
  WALL   CONTACT GAP=0.004 LAW=KELVIN_VOIGT K=1E5 E=0.65
WEIGHTS
  2,3 100
  12 60
EQUAKE
  SINE AMPLITUDE=4 PERIOD=0.4 DURATION=1
ANALYSIS
  HISTORY 1
"""
STORED = "OUTPUT\n  NODES=1,2,3,4\n"


@pytest.fixture(scope="module")
def results() -> Iterator[Results]:
    with run(Deck(DECK)) as found:
        assert found.status == "done" and found.history("contact/force").max() > 0.0
        yield found


@pytest.fixture(scope="module")
def path(results: Results, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("vtk") / "deck.vtkhdf"
    assert write_vtkhdf(results, out) == []
    return out


def test_the_head_and_the_grid_follow_the_format(results: Results, path: Path) -> None:
    with h5py.File(path, "r") as file:
        root = file["VTKHDF"]
        assert root.attrs["Version"].tolist() == [2, 0]
        assert root.attrs["Type"] == b"UnstructuredGrid"
        kind = root.attrs.get_id("Type").get_type()
        assert not kind.is_variable_str() and kind.get_cset() == h5py.h5t.CSET_ASCII
        assert root["NumberOfPoints"][()].tolist() == [6]
        assert root["NumberOfCells"][()].tolist() == [7]
        assert root["Types"][()].tolist() == [LINE, LINE, LINE, LINE, VERTEX, LINE, VERTEX]
        assert root["Types"].dtype == np.uint8
        assert root["Offsets"][()].tolist() == [0, 2, 4, 6, 8, 9, 11, 12]
        assert root["NumberOfConnectivityIds"][()].tolist() == [12]
        assert root["Connectivity"][()].tolist() == [0, 1, 1, 2, 3, 2, 4, 5, 1, 2, 5, 5]
        assert root["Points"][()].tolist()[2] == [4.0, 3.0, 0.0]
        n = len(results.time)
        assert root["Steps"].attrs["NSteps"] == n
        assert root["Steps/CellOffsets"].shape == root["Steps/ConnectivityIdOffsets"].shape == (n, 1)
        for name, items in (("PointData", 6), ("CellData", 7)):
            for field, values in root[name].items():
                begins = root[f"Steps/{name}Offsets/{field}"]
                assert len(begins) == n and begins[-1] + items == len(values), field


def test_values_of_a_step_begin_where_the_steps_say(results: Results, path: Path) -> None:
    with h5py.File(path, "r") as file:
        root = file["VTKHDF"]
        np.testing.assert_array_equal(root["Steps/Values"], results.time)
        for step in (0, 17, len(results.time) - 1):

            def own(kind: str, name: str, size: int, at: int = step, root: h5py.Group = root) -> np.ndarray:
                start = root[f"Steps/{kind}Offsets/{name}"][at]
                return root[f"{kind}/{name}"][start : start + size]

            np.testing.assert_array_equal(
                own("PointData", "displacement", 6)[:, :2], results.history("node/u")[step, :, :2]
            )
            cells = own("CellData", "element", 7).tolist()
            moment = results.history("member/force", member=103, component="moment J")[step]
            assert own("CellData", "moment J", 7)[cells.index(103)] == moment
            assert np.isnan(own("CellData", "moment J", 7)[cells.index(901)])
            force = results.history("contact/force", contact="the gap")[step]
            assert own("CellData", "contact force", 7)[cells.index(901)] == force
            spring = results.history("spring/force", spring=120, component="X")[step]
            assert own("CellData", "force X", 7)[cells.index(120)] == spring


def test_vtk_reads_what_the_results_hold(results: Results, path: Path) -> None:
    vtk = pytest.importorskip("vtkmodules.vtkIOHDF")
    numbers = pytest.importorskip("vtkmodules.util.numpy_support").vtk_to_numpy
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == len(results.time)
    force = results.history("contact/force", contact="the gap")
    for step in (0, int(force.argmax()), len(force) - 1):
        reader.SetStep(step)
        reader.Update()
        grid = reader.GetOutputDataObject(0)
        assert grid.GetClassName() == "vtkUnstructuredGrid" and grid.GetNumberOfCells() == 7
        assert reader.GetTimeValue() == results.time[step]
        places = [tuple(n)[1:3] for n in results.table("nodes").tolist()]
        np.testing.assert_array_equal(numbers(grid.GetPoints().GetData())[:, :2], places)
        for history, name in MOTIONS:
            found = numbers(grid.GetPointData().GetArray(name))[:, :2]
            np.testing.assert_array_equal(found, results.history(history)[step, :, :2])
        assert numbers(grid.GetCellData().GetArray("contact force"))[5] == force[step]


def test_nodes_that_are_not_stored_are_left_out_and_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run(Deck(DECK + STORED, "model"), out=tmp_path).close()
    assert main(["export", str(tmp_path / "model.h5"), "--vtk"]) == 0
    told = capsys.readouterr()
    assert told.out == f"{tmp_path / 'model.vtkhdf'}\n"
    assert "left out with their elements, because OUTPUT does not store them: nodes 11, 12\n" in told.err
    with h5py.File(tmp_path / "model.vtkhdf", "r") as file:
        assert file["VTKHDF/CellData/element"][()].tolist()[:4] == [101, 102, 103, 120]


def test_without_a_history_there_is_nothing_to_show(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run(Deck(DECK.replace("HISTORY 1", "MODAL 2"), "model"), out=tmp_path).close()
    assert main(["export", str(tmp_path / "model.h5"), "--vtk", "-o", str(tmp_path)]) == 3
    assert "no history of nodes" in capsys.readouterr().err
    assert not (tmp_path / "model.vtkhdf").exists()


def test_a_file_that_cannot_be_written_is_told(results: Results, tmp_path: Path) -> None:
    with pytest.raises(ResultsError, match="cannot be written"):
        write_vtkhdf(results, tmp_path / "none" / "model.vtkhdf")
