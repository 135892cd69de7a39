"""Results files that are not as they were written: each is told, none is read as if it were whole."""

import random
from contextlib import suppress

import h5py
import numpy as np
import pytest

from output import sample
from pound_solve.cli.main import main
from pound_solve.results import Results, ResultsError


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


@pytest.mark.parametrize("seed", range(4))
def test_a_flipped_bit_is_told_or_changes_nothing(tmp_path, seed):
    path = sample.write(tmp_path / "whole.h5")
    whole, good, draw = path.read_bytes(), everything(path), random.Random(seed)
    for _ in range(40):
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


@pytest.mark.parametrize("attack", [drop, drop_of_the_day, swap, link, change, relabel, cut])
def test_parts_that_are_missing_changed_or_elsewhere_end_in_damaged(tmp_path, capsys, attack):
    path = sample.write(tmp_path / "a.h5")
    with h5py.File(path, "r+") as file:
        attack(file)
    with pytest.raises(ResultsError, match="damaged results file"):
        everything(path)
    for verb in ("report", "export"):
        main([verb, str(path)])
        assert "fault of the program" not in capsys.readouterr().err


def test_a_table_that_a_verb_needs_and_a_file_lacks_is_named(tmp_path, capsys):
    path = tmp_path / "a.h5"
    sample.write(path)
    with h5py.File(path, "r+") as file:
        del file["tables/nodes"]
        file.attrs["digest"] = ""
    assert main(["plot", str(path), "-o", str(tmp_path / "p")]) == 3
    assert "no table 'nodes' in this file" in capsys.readouterr().err
