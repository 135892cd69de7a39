"""``pound-solve format``: in place, beside, or only asked; a deck with mistakes is left as it is."""

import os
import stat
from pathlib import Path

import pytest

from pound_deck.layout import layout
from pound_solve.cli.main import main

UNTIDY = "NODES\n1 0 0 FIX=XYR\n2 3.5 0\n"
TIDY = layout(UNTIDY)[0]


@pytest.fixture
def path(tmp_path):
    deck = tmp_path / "deck.inp"
    deck.write_text(UNTIDY)
    return deck


def test_check_tells_and_writes_nothing(path, capsys):
    assert main(["format", str(path), "--check"]) == 1
    assert path.read_text() == UNTIDY
    assert main(["format", str(path)]) == 0
    assert path.read_text() == TIDY != UNTIDY
    assert main(["format", str(path), "--check"]) == 0
    assert capsys.readouterr().out.splitlines() == [f"{path}: would change", f"{path}: is in columns"]


def test_the_deck_keeps_its_permissions_and_a_link_stays_one(path, tmp_path):
    path.chmod(0o640)
    link = tmp_path / "link.inp"
    link.symlink_to(path)
    assert main(["format", str(link)]) == 0
    assert link.is_symlink() and path.read_text() == TIDY
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert sorted(os.listdir(tmp_path)) == ["deck.inp", "link.inp"]


def test_a_deck_in_columns_is_not_written_again(path):
    path.write_text(TIDY)
    before = path.stat().st_ino, path.stat().st_mtime_ns
    assert main(["format", str(path)]) == 0
    assert (path.stat().st_ino, path.stat().st_mtime_ns) == before


def test_another_file_is_written_and_the_deck_stays(path, tmp_path):
    assert main(["format", str(path), "-o", str(tmp_path / "new.inp")]) == 0
    assert path.read_text() == UNTIDY and (tmp_path / "new.inp").read_text() == TIDY


def test_an_interrupted_write_leaves_the_deck_and_no_other_file(path, monkeypatch, tmp_path):
    def stop(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", stop)
    assert main(["format", str(path)]) == 3
    assert path.read_text() == UNTIDY and os.listdir(tmp_path) == ["deck.inp"]


@pytest.mark.parametrize("words", [[], ["--check"], ["-o", "new.inp"]])
def test_a_deck_with_mistakes_of_syntax_is_left_as_it_is(path, capsys, words, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    bad = UNTIDY + "3 (0\n"
    path.write_text(bad)
    assert main(["format", str(path), *words]) == 2
    err = capsys.readouterr().err
    assert f"{path}:4:3: error P203" in err and "left as it is" in err
    assert path.read_text() == bad and not Path("new.inp").exists()


def test_a_deck_that_is_not_there_is_told(tmp_path, capsys):
    assert main(["format", str(tmp_path / "none.inp")]) == 3
    assert "No such file" in capsys.readouterr().err
