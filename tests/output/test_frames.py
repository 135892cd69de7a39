"""Tables as DataFrame, histories as DataArray, by us and by xarray alone; numbers by their coordinates."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from output import sample
from pound_solve.results import Results, Writer
from pound_solve.results.contents import HISTORIES, TABLES

#: what numbers of a history are found by
NAMED = {
    "node/u": {"node", "component"},
    "node/v": {"node", "component"},
    "node/a": {"node", "component"},
    "member/force": {"member", "component"},
    "reaction": {"support", "action"},
    "building/base": {"building", "component"},
    "contact/gap": {"contact"},
    "contact/force": {"contact"},
    "spring/deformation": {"spring", "component"},
    "storey/shear": {"building", "storey"},
}


def test_a_number_is_found_by_its_coordinates(done: Results) -> None:
    u = done.history("node/u")
    at = sample.NODES.index(101)
    np.testing.assert_array_equal(done.history("node/u", node=101, component="Y"), u[:, at, 1])
    np.testing.assert_array_equal(done.history("node/u", node=101), u[:, at])
    np.testing.assert_array_equal(done.history("node/u", component="R"), u[:, :, 2])
    force = done.history("member/force")
    np.testing.assert_array_equal(
        done.history("member/force", member=101, component="moment I"), force[:, 1]
    )
    np.testing.assert_array_equal(done.history("member/force", component="axial"), force[:, [0, 2]])
    drift = done.history("storey/drift", building="A", storey=2)
    np.testing.assert_array_equal(drift, done.history("storey/drift")[:, 1])
    gap = done.history("contact/gap", contact="902")
    np.testing.assert_array_equal(gap, done.history("contact/gap")[:, 1])


@pytest.mark.parametrize("name", [h for h in HISTORIES if h != "spring/force"])
def test_coordinates_name_every_number(done: Results, name: str) -> None:
    own = done.coordinates(name)
    assert all(len(values) == len(done.labels(name)) for values in own.values())
    if name in NAMED:
        assert own.keys() == NAMED[name]
    flat = done.history(name).reshape(len(done.time), -1)
    for column, at in enumerate(zip(*own.values())):
        np.testing.assert_array_equal(done.history(name, **dict(zip(own, at))), flat[:, column])


def test_what_is_not_there_is_told_with_what_is(done: Results) -> None:
    with pytest.raises(KeyError, match=r"'node/u' has no number of node=5; it has: 1, 2, 3"):
        done.history("node/u", node=5)
    with pytest.raises(KeyError, match=r"'node/u' has no 'member'; it has: node, component"):
        done.history("node/u", member=1)
    with pytest.raises(KeyError, match=r"no number of component='moment I'; it has: axial$"):
        done.history("member/force", member=102, component="moment I")


def test_the_repr_tells_what_is_inside(done: Results, tmp_path: Path) -> None:
    told = repr(done)
    assert sample.TITLE in told and "done; units kN, m, s" in told
    assert f"nodes ({len(sample.rows()['nodes'])})" in " ".join(told.split())
    assert (
        f"  node/u               300 instants x {len(sample.NODES)} node x 3 component [m, rad]\n" in told
    )
    assert "member/force         300 instants x 3 member_component [kN, kN*m]" in told
    with Results.open(
        sample.write(tmp_path / "s.h5", status="stopped", message="A501 it moves")
    ) as stopped:
        assert "stopped: A501 it moves" in repr(stopped)
    assert repr(stopped) == f"<Results {str(tmp_path / 's.h5')!r}, closed>"


def test_the_repr_of_a_real_run_names_the_method(tmp_path: Path) -> None:
    import pound_solve

    deck = pound_solve.Deck.from_text(WALL)
    assert "method: EXACT" in repr(pound_solve.run(deck, out=tmp_path, method="EXACT"))


@pytest.mark.parametrize("name", TABLES)
def test_tables_as_frames(done: Results, name: str) -> None:
    pytest.importorskip("pandas")
    frame, table = done.to_pandas(name), done.table(name)
    assert list(frame.columns) == list(table.dtype.names or ())
    for column in frame.columns:
        np.testing.assert_array_equal(frame[column].to_numpy(), table[column])
    assert frame.attrs == {"title": TABLES[name].title, "units": done.table_units(name)}


@pytest.mark.parametrize("name", [h for h in HISTORIES if h != "spring/force"])
def test_histories_as_arrays(done: Results, name: str) -> None:
    pytest.importorskip("xarray")
    array = done.to_xarray(name)
    own = done.coordinates(name)
    assert array.dims == ("time", *own)
    flat = done.history(name).reshape(len(done.time), -1)
    for column, at in enumerate(zip(*own.values())):
        np.testing.assert_array_equal(array.sel(dict(zip(own, at))), flat[:, column])
    there = len(done.labels(name)) * len(done.time)
    assert int(array.notnull().sum()) == there, "only pairs that there are have numbers"
    units = dict.fromkeys(done.history_units(name))
    assert all(unit in array.attrs["units"] for unit in units)
    assert array.attrs["long_name"] == HISTORIES[name].doc


def test_units_of_components_that_differ(done: Results) -> None:
    pytest.importorskip("xarray")
    assert done.to_xarray("node/u").attrs["units"] == "X: m, Y: m, R: rad"
    assert done.to_xarray("member/force").attrs["units"] == "axial: kN, moment I: kN*m"
    assert done.to_xarray("contact/force").attrs["units"] == "kN"


def test_all_histories_as_a_tree(done: Results) -> None:
    pytest.importorskip("xarray")
    tree = done.to_xarray()
    for name in done.histories:
        np.testing.assert_array_equal(tree[name], done.to_xarray(name) if name != "time" else done.time)
    assert tree.attrs["title"] == sample.TITLE


@pytest.mark.full
def test_xarray_opens_the_file_by_itself(tmp_path: Path) -> None:
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("h5netcdf")
    path = sample.write(tmp_path / "s.h5")
    with Results.open(path) as results:
        for name in results.histories:
            group, _, leaf = f"history/{name}".rpartition("/")
            with xarray.open_dataset(path, group=group, engine="h5netcdf") as opened:
                np.testing.assert_array_equal(opened[leaf], results.history(name))
                np.testing.assert_array_equal(opened["time"], results.time)
                for key, values in results.coordinates(name).items():
                    assert key in opened[leaf].coords
                    assert set(opened[key].values.tolist()) == set(values)
                assert opened[leaf].dims[0] == "time" and not any(
                    d.startswith("phony") for d in opened.dims
                )


def test_every_axis_of_a_history_has_a_scale_of_its_length(tmp_path: Path) -> None:
    with h5py.File(sample.write(tmp_path / "s.h5"), "r") as file:
        assert file["history/node/u"].dims[1]["node"][()].tolist() == list(sample.NODES)
        for name in HISTORIES:
            if name in ("time", "spring/force"):
                continue
            dataset = file["history"][name]
            for axis, length in zip(dataset.dims, dataset.shape, strict=True):
                assert [scale.shape for scale in axis.values()] == [(length,)], name


def test_histories_of_one_group_share_their_axes(tmp_path: Path) -> None:
    with (
        Writer(tmp_path / "out.h5", title="t", units=sample.UNITS, program_version="0") as writer,
        pytest.raises(ValueError, match="other labels on the axis 'contact'"),
    ):
        own = {name: ((1,), {"labels": [name], "unit": "F"}) for name in ("contact/gap", "contact/force")}
        writer.start_history(own)


def test_a_file_of_format_1_is_read(tmp_path: Path) -> None:
    """It has no scales, and buildings, storeys and springs have labels only."""
    path = sample.write(tmp_path / "s.h5")
    with h5py.File(path, "r+") as file:
        file.attrs["format_version"] = [1, 1]
        file.attrs["digest"] = ""
        for name in HISTORIES:
            dataset = file["history"].get(name)
            for key in ("DIMENSION_LIST", "CLASS", "REFERENCE_LIST", "building", "storey", "digest"):
                if dataset is not None and key in dataset.attrs:
                    del dataset.attrs[key]
        for scale in ("node/node", "node/time", "storey/building", "storey/time", "part"):
            del file[f"history/{scale}"]
    with Results.open(path) as results:
        assert results.histories[0] == "time" and len(results.history("time")) == 300
        assert results.coordinates("node/u").keys() == {"node", "component"}
        assert results.coordinates("storey/drift") == {"drift_label": ("A storey 1", "A storey 2")}
        assert results.history("storey/drift", drift_label="A storey 2").shape == (300,)


@pytest.mark.full
@pytest.mark.parametrize(("package", "call"), [("pandas", "to_pandas('size')"), ("xarray", "to_xarray()")])
def test_without_the_extra_all_but_its_calls_works(tmp_path: Path, package: str, call: str) -> None:
    path = sample.write(tmp_path / "s.h5")
    code = f"""
import sys
sys.modules[{package!r}] = None
from pound_solve.results import Results
with Results.open({str(path)!r}) as results:
    assert len(results.table("size")) and "node/u" in repr(results)
    try:
        results.{call}
    except ImportError as err:
        print(err)
assert "pandas" not in sys.modules or sys.modules["pandas"] is None
"""
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert (done.stdout, done.stderr) == (f'this needs {package}: pip install "pound-solve[data]"\n', "")


WALL = """TITLE A mass that meets a wall
UNITS kN m s
NODES
  1 0 0 FIX=XYR
  2 3 0 FIX=YR
ELEMENTS
  1 COLUMN 1 2
  2 WALL 2
PROPS
  COLUMN SPRING KX=4000
  WALL CONTACT GAP=0.01 LAW=KELVIN_VOIGT K=1E6 E=0.65
WEIGHTS
  2 981
EQUAKE
  SINE AMPLITUDE=2 PERIOD=1 DURATION=1
ANALYSIS
  HISTORY 1
"""
