"""Results files that are not as they were written: each is told, none is read as if it were whole."""

import random
import struct
import zlib
from contextlib import nullcontext, suppress
from io import BytesIO

import h5py
import numpy as np
import pytest

from output import sample
from pound_solve.cli.main import main
from pound_solve.results import Results, ResultsError, Writer, seal
from pound_solve.results.safe_file import SafeFile
from tiers import at_night


def everything(path):
    """All that a reader can ask of a file, as comparable values."""
    with Results.open(path) as results:
        return [
            (results.status, results.message, results.title, results.units),
            [(name, results.text(name)) for name in results.texts],
            [
                (name, repr(results.table(name).tolist()), results.note(name), results.table_units(name))
                for name in results.tables
            ],
            [
                (name, results.history(name).tobytes(), results.labels(name), results.history_units(name))
                for name in results.histories
            ],
        ]


@pytest.mark.full
@pytest.mark.parametrize("seed", range(4))
def test_a_flipped_bit_is_told_before_hdf5_reads_the_file(tmp_path, seed, monkeypatch):
    path = sample.write(tmp_path / "whole.h5")
    whole, draw = path.read_bytes(), random.Random(seed)
    monkeypatch.setattr("h5py.File", lambda *_: pytest.fail("HDF5 reads it"))
    for _ in range(40):
        data = bytearray(whole)
        data[draw.randrange(len(data) - seal.LENGTH)] ^= 1 << draw.randrange(8)
        path.write_bytes(data)
        with pytest.raises(ResultsError, match="damaged results file: its bytes are not those"):
            Results.open(path)


@pytest.mark.full
@pytest.mark.parametrize("seed", [0, *at_night(1, 2, 3)])
def test_without_a_seal_a_flipped_bit_is_told_or_changes_nothing(tmp_path, seed):
    path = sample.write(tmp_path / "whole.h5")
    whole, good, draw = path.read_bytes()[: -seal.LENGTH], everything(path), random.Random(seed)
    for _ in range(10):
        data = bytearray(whole)
        data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
        path.write_bytes(data)
        with suppress(ResultsError):
            assert everything(path) == good


def drop(file):
    del file["tables/nodes"]


def drop_of_the_day(file):
    del file["tables/run_figures"]


def swap(file):
    file.move("tables/nodes", "tables/x")
    file.move("tables/elements", "tables/nodes")
    file.move("tables/x", "tables/elements")


def link(file):
    with h5py.File(str(file.filename) + ".other", "w") as other:
        other["nodes"] = np.zeros(3)
    del file["tables/nodes"]
    file["tables/nodes"] = h5py.ExternalLink(str(file.filename) + ".other", "nodes")


def change(file):
    rows = file["tables/nodes"][()]
    rows["x"] += 1.0
    file["tables/nodes"][...] = rows


def relabel(file):
    file["history/drift"].attrs["labels"] = ["x"] * len(file["history/drift"].attrs["labels"])


def cut(file):
    for name in ("time", "drift"):
        file[f"history/{name}"].resize(5, axis=0)


def retitle(file):
    file.attrs["title"] = "another"


def undigested(file):
    file.attrs["digest"] = ""


def other_columns(file):
    del file["tables/nodes"]
    file["tables/nodes"] = np.zeros(3, [("x", float)])
    file["tables/nodes"].attrs["columns"] = file["tables/nodes"].attrs["units"] = ["x"]
    file["tables/nodes"].attrs["note"] = ""
    killed(file)


def narrower(file):
    labels = file["history/drift"].attrs["labels"]
    del file["history/drift"]
    file["history/drift"] = np.zeros((len(file["history/time"]), len(labels) + 1))
    file["history/drift"].attrs["labels"] = file["history/drift"].attrs["unit"] = labels
    killed(file)


def killed(file):
    """Say that the run was killed: the digest of the whole is not known."""
    file.attrs["status"] = "running"
    file.attrs["digest"] = ""


def end_otherwise(file):
    file.attrs["status"] = "done" if file.attrs["status"] == "stopped" else "stopped"


ATTACKS = (retitle, end_otherwise, undigested, other_columns, narrower, drop, drop_of_the_day, swap, link)


@pytest.mark.full
@pytest.mark.parametrize("attack", [*ATTACKS, change, relabel, cut])
def test_parts_that_are_missing_changed_or_elsewhere_end_in_damaged(tmp_path, capsys, attack):
    path = sample.write(tmp_path / "a.h5")
    with h5py.File(path, "r+") as file:
        attack(file)
    with pytest.raises(ResultsError, match="damaged results file"):
        everything(path)
    for verb in ("report", "export"):
        main([verb, str(path)])
        assert "fault of the program" not in capsys.readouterr().err


@pytest.mark.parametrize("version", [(2, 0), (2, 1)])
def test_a_table_under_the_name_of_another_is_told_in_this_version_only(tmp_path, version):
    """The digest of a killed run names no tables; in other versions a table may have other columns."""
    path = sample.write(tmp_path / "a.h5", status="running")
    with h5py.File(path, "r+") as file:
        file.attrs["format_version"] = version
        swap(file)
    told = pytest.raises(ResultsError, match="nodes does not have the columns")
    with Results.open(path) as results, told if version == (2, 0) else nullcontext():
        results.table("nodes")


def test_a_table_of_another_version_without_a_column_of_this_one_is_not_drawn(tmp_path, capsys):
    path = tmp_path / "a.h5"
    sample.write(path)
    with h5py.File(path, "r+") as file:
        names = [name for name in file["tables/nodes"].dtype.names if name != "x"]
        fewer = file["tables/nodes"][()][names]
        del file["tables/nodes"]
        file["tables/nodes"] = fewer
        file.attrs["format_version"] = [1, 1]
    with Results.open(path) as results:
        assert not results.holds("nodes") and results.holds("elements")
    assert main(["plot", str(path), "frame", "-o", str(tmp_path / "p")]) == 2
    assert "nothing to draw: frame (no nodes)" in capsys.readouterr().err


def test_a_table_that_a_verb_needs_and_a_file_lacks_is_named(tmp_path, capsys):
    path = tmp_path / "a.h5"
    sample.write(path)
    with h5py.File(path, "r+") as file:
        del file["tables/nodes"]
        file.attrs["format_version"] = [1, 1]
    assert main(["plot", str(path), "frame", "-o", str(tmp_path / "p")]) == 2
    assert "lacks what the picture frame needs: nodes" in capsys.readouterr().err


def test_the_seal_is_the_crc_32_of_those_of_all_pages(tmp_path):
    data = sample.write(tmp_path / "a.h5").read_bytes()
    size, crc = struct.unpack("<QI", data[-12:])
    pages = [zlib.crc32(data[i : min(i + 2**15, size)]) for i in range(0, size, 2**15)]
    assert len(pages) > 3 and size == len(data) - seal.LENGTH
    assert crc == zlib.crc32(np.array(pages, "<u4").tobytes())


def test_the_file_of_a_killed_run_is_sealed_too(tmp_path, monkeypatch):
    """At every commit, whatever was written before; what lies behind the data is room, not data."""
    path, rng = tmp_path / "a.h5", random.Random(1)
    file = SafeFile(path)
    for _ in range(60):
        file.seek(rng.randrange(4 * file._size // 3 + 1))
        file.write(memoryview(rng.randbytes(rng.choice([10, 1000, 100_000]))))
        if rng.random() < 0.2:
            file.truncate(rng.randrange(file._size))
        file.commit()
        data = bytearray(path.read_bytes())
        assert seal.holds(BytesIO(data))
        data[rng.randrange(file._size)] ^= 1 << rng.randrange(8)
        assert seal.holds(BytesIO(data)) is False
    file.end()
    assert seal.holds(BytesIO(path.read_bytes()))
    file.close()


def test_a_file_whose_pages_are_being_laid_down_has_no_seal(tmp_path, monkeypatch):
    """Killed amid a commit: the file is neither sealed nor told to be damaged."""
    path = tmp_path / "a.h5"
    file = SafeFile(path)
    file.write(memoryview(bytes(range(256)) * 1000))
    file.commit()
    file.seek(0)
    file.write(memoryview(b"again"))
    seen = []
    lay = SafeFile._lay
    monkeypatch.setattr(
        SafeFile,
        "_lay",
        lambda self, place, data: (
            lay(self, place, data),
            seen.append(seal.holds(BytesIO(path.read_bytes()))),
        ),
    )
    file.commit()
    assert seen == [None, None, True]
    file.close()


def test_what_a_user_adds_by_hdf5_is_no_damage_but_told(tmp_path, capsys):
    path = sample.write(tmp_path / "a.h5")
    good = everything(path)
    with Results.open(path) as results:
        assert not results.changed
    with h5py.File(path, "r+") as file:
        file.attrs["mine"] = "a remark"
        file["mine"] = np.arange(3.0)
    with Results.open(path) as results:
        assert results.changed
    assert everything(path) == good
    assert main(["report", str(path)]) == 0
    assert "was changed after the run" in capsys.readouterr().out


def test_the_parts_of_a_damaged_file_that_hold_are_read_if_asked_for(tmp_path):
    path = sample.write(tmp_path / "a.h5")
    with h5py.File(path) as file:
        at = file["history/drift"].id.get_chunk_info(0).byte_offset
    data = bytearray(path.read_bytes())
    data[at] ^= 1
    path.write_bytes(data)
    with pytest.raises(ResultsError, match="damaged=True"):
        Results.open(path)
    with Results.open(path, damaged=True) as results:
        assert len(results.table("nodes")) and len(results.time)
        with pytest.raises(ResultsError, match="damaged"):
            results.history("drift")


def test_a_saved_state_that_was_changed_is_refused(tmp_path):
    path = tmp_path / "a.h5"
    with Writer(path, title="", units=sample.UNITS, program_version="") as writer:
        writer.restart({"q": np.arange(3.0)}, {})
        writer.finish("done")
    with h5py.File(path, "r+") as file:
        file["restart/q"][1] = 7.0
    with Results.open(path) as results, pytest.raises(ResultsError, match="q is not as it was written"):
        results.restart()


@pytest.mark.parametrize("version", [(1, 0), (1, 1)])
def test_files_of_versions_without_a_seal_are_read(tmp_path, version):
    """Their digest did not know the head."""
    path = sample.write(tmp_path / "a.h5")
    with h5py.File(path, "r+") as file:
        file.attrs["format_version"] = np.array(version)
    with Results.open(path) as results:
        assert not results.changed and results.table("nodes").size


def test_a_file_without_anything_to_draw_is_told(tmp_path, capsys):
    path = tmp_path / "a.h5"
    with Writer(path, title="", units=sample.UNITS, program_version="") as writer:
        writer.finish("done")
    assert main(["plot", str(path)]) == 2
    assert "holds nothing that a picture shows" in capsys.readouterr().err
