"""Results are never lost: older ones stand until the new ones are complete, on a full disk too."""

import errno
import os
import re
import shutil
import signal
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

import pound_solve
from imports.ruaumoko_decks import STICK
from pound_deck.model import Units
from pound_solve.analyses.envelopes import ResponseEnvelopes
from pound_solve.analyses.recorder import EnergyBalance, HistoryRecorder
from pound_solve.cli.main import main
from pound_solve.driver.run import DeckError
from pound_solve.interruption import Interruption
from pound_solve.results import Results, ResultsError, Writer, place, safe_file
from pound_solve.results.place import digest_in
from pound_solve.results.whole_file import partial, write_text
from pound_solve.sweep.execution.journal import Journal, JournalEntry
from sweep.small import folder, swept
from tiers import each_once

DECK = """UNITS N m s
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
ELEMENTS
 1 S 1 2
PROPS
 S SPRING KX=200 FX={strength} RULE=BILINEAR R=0.1
WEIGHTS
 2 2
INITIAL
 2 VX=2
{motion}ANALYSIS
 HISTORY {end} METHOD=EXACT {more}
OUTPUT
 EVERY=0.001
"""
QUAKE = "EQUAKE\n SINE AMPLITUDE={a} PERIOD=0.5 DURATION=1\n"


def write(folder, name="model", end=1.0, more="", strength=10, motion=""):
    deck = folder / f"{name}.inp"
    deck.write_text(DECK.format(end=end, more=more, strength=strength, motion=motion))
    return deck


def bytes_of(deck):
    return [deck.with_suffix(suffix).read_bytes() for suffix in (".h5", ".rpt")]


@pytest.fixture
def small_disk(monkeypatch):
    """A disk with room for some bytes of each results file."""

    def limit(size):
        allocate = safe_file._allocate

        def bounded(disk, start, count):
            if start + count > size:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            allocate(disk, start, count)

        monkeypatch.setattr(safe_file, "_allocate", bounded)

    return limit


@pytest.mark.full
@pytest.mark.parametrize("size", [0, *range(safe_file.RESERVE, safe_file.RESERVE + 400_000, 24_001)])
def test_a_full_disk_ends_in_words_with_a_readable_file(tmp_path, small_disk, capsys, size):
    deck = write(tmp_path)
    small_disk(size)
    status, told = main([str(deck), "--quiet"]), capsys.readouterr().err
    if status == 0:
        assert size > safe_file.RESERVE + 100_000 and not told
        return
    assert status == 3 and "no room on the disk" in told and "fault" not in told
    if deck.with_suffix(".h5").exists():
        with Results.open(deck.with_suffix(".h5")) as results:
            assert results.status == "stopped" and results.message.startswith("A508")
            for name in results.histories:
                assert len(results.history(name)) == len(results.time)
    else:
        assert size < safe_file.RESERVE + 40_000


def test_a_run_without_room_leaves_the_older_results(tmp_path, small_disk):
    deck = write(tmp_path)
    pound_solve.run(deck).close()
    whole = bytes_of(deck)
    small_disk(safe_file.RESERVE + 80_000)
    with pound_solve.run(deck) as results:
        assert results.path == partial(deck.with_suffix(".h5"))
        assert results.message.startswith("A508") and len(results.tables) > 3
    assert bytes_of(deck) == whole


def test_the_histories_up_to_a_full_disk_are_those_of_the_whole_run(tmp_path, small_disk):
    whole, deck = pound_solve.run(write(tmp_path, "whole")), write(tmp_path)
    small_disk(safe_file.RESERVE + 250_000)
    with pound_solve.run(deck) as part:
        assert 0 < len(part.time) < len(whole.time)
        for name in part.histories:
            assert (part.history(name) == whole.history(name)[: len(part.time)]).all()


def test_two_runs_at_one_output(tmp_path, capsys):
    deck = write(tmp_path)
    pound_solve.run(deck).close()
    whole = bytes_of(deck)
    results = Results.open(deck.with_suffix(".h5"))
    with Writer(partial(deck.with_suffix(".h5")), title="", units=results.units, program_version="0"):
        assert main([str(deck)]) == 3
        assert "another run writes it" in capsys.readouterr().err
    assert bytes_of(deck) == whole
    assert main([str(deck), "--quiet"]) == 0


def test_an_open_file_that_is_being_written_and_one_whose_run_was_killed(tmp_path):
    path = tmp_path / "a.h5"
    units = pound_solve.run(write(tmp_path)).units
    writer = Writer(path, title="", units=units, program_version="0")
    with writer, pytest.raises(ResultsError, match="in use by another program"):
        Results.open(path)
    assert Results.open(path).status == "killed"


@pytest.mark.full
def test_report_and_results_tell_that_they_belong_together(tmp_path, capsys):
    deck, other = write(tmp_path), write(tmp_path, "other", strength=11)
    with pound_solve.run(deck) as results, pound_solve.run(other) as others:
        assert results.digest == digest_in(deck.with_suffix(".rpt"))
        assert others.digest == digest_in(other.with_suffix(".rpt")) != results.digest
    before = results.digest
    with pound_solve.run(deck) as again:
        assert again.digest == before  # what differs from run to run is not part of it
    assert main(["report", str(deck.with_suffix(".h5"))]) == 0
    assert not capsys.readouterr().err
    shutil.copy(other.with_suffix(".rpt"), deck.with_suffix(".rpt"))
    assert main(["report", str(deck.with_suffix(".h5"))]) == 0
    assert "is the report of another run" in capsys.readouterr().err


@pytest.mark.full
@pytest.mark.parametrize("at", range(3))
def test_a_kill_amid_the_renaming_leaves_no_report_of_other_results(tmp_path, monkeypatch, at):
    deck, calls, replace = write(tmp_path), [], os.replace
    pound_solve.run(deck).close()
    write(tmp_path, strength=11)

    def killed(*names):
        calls.append(names)
        if len(calls) > at:
            raise KeyboardInterrupt
        replace(*names)

    with monkeypatch.context() as patch, suppress(KeyboardInterrupt):
        patch.setattr("pound_solve.results.place.os.replace", killed)
        pound_solve.run(deck).close()
    with Results.open(deck.with_suffix(".h5")) as results:
        assert digest_in(deck.with_suffix(".rpt")) in ("", results.digest)


@pytest.fixture
def interrupt(monkeypatch):
    """Send a signal to another thread, as the system may, and wait until the program has heard of it."""
    over, heard, hear = threading.Event(), [], Interruption._take
    other = threading.Thread(target=over.wait)
    other.start()

    def noted(self, number, frame):
        heard.append(number)
        hear(self, number, frame)

    def send():
        signal.pthread_kill(other.ident, signal.SIGTERM)
        while not heard:
            time.sleep(0.001)

    monkeypatch.setattr(Interruption, "_take", noted)
    yield send
    over.set()
    other.join()


@pytest.mark.full
@pytest.mark.skipif(os.name != "posix", reason="signals")
@pytest.mark.parametrize(
    ("owner", "name", "at", "status"),
    [
        (safe_file.SafeFile, "write", 400, "stopped"),
        (safe_file.SafeFile, "commit", 60, "stopped"),
        (ResponseEnvelopes, "take", 9, "stopped"),
        (EnergyBalance, "take", 9, "stopped"),
        (HistoryRecorder, "closeups", 0, "done"),
        (Writer, "finish", 0, "done"),
        (place.os, "replace", 0, "done"),
    ],
)
def test_an_interrupted_run_loses_nothing(tmp_path, monkeypatch, interrupt, owner, name, at, status):
    """A signal in a write of HDF5, amid the record of samples, in the last tables, at the end, between two
    renames.
    """
    deck, calls, own = write(tmp_path, end=20.0), [], getattr(owner, name)

    def disturbed(*given, **options):
        calls.append(name)
        if len(calls) == at + 1:
            interrupt()
        return own(*given, **options)

    monkeypatch.setattr(owner, name, disturbed)
    code = main([str(deck), "--quiet"])
    assert len(calls) > at
    with Results.open(deck.with_suffix(".h5")) as results:
        assert results.status == status and results.message[:4] == ("A506" if status == "stopped" else "")
        assert code == (status == "stopped")
        assert digest_in(deck.with_suffix(".rpt")) == results.digest
        assert "node_envelope" in results.tables and len(results.time) > 1
        assert (np.diff(results.time) > 0.0).all()  # no block twice


def test_an_open_older_result_stays_readable(tmp_path):
    deck = write(tmp_path)
    with pound_solve.run(deck) as first:
        own = first.history("node/u")
        pound_solve.run(write(tmp_path, strength=5)).close()
        assert (first.history("node/u") == own).all()


@pytest.mark.full
def test_runs_in_a_loop_leave_open_results_alone_where_open_files_cannot_be_removed(tmp_path, monkeypatch):
    """As on Windows: no locks, and an open file cannot be removed or replaced."""
    held = set()

    def guarded(own):
        def call(*paths, **options):
            if held & {str(p) for p in paths}:
                raise PermissionError(errno.EACCES, "in use", str(paths[-1]))
            return own(*paths, **options)

        return call

    monkeypatch.setattr(safe_file, "fcntl", None)
    monkeypatch.setattr(Path, "unlink", guarded(Path.unlink))
    monkeypatch.setattr(os, "replace", guarded(os.replace))
    deck = write(tmp_path)
    with pound_solve.run(deck) as first:
        held.add(str(first.path))
        own = first.history("node/u")
        with pytest.raises(ResultsError, match="the results of this run are in"):
            pound_solve.run(write(tmp_path, strength=5))
        with Results.open(partial(first.path)) as second:
            held.add(str(second.path))
            other = second.history("node/u")
            with pytest.raises(ResultsError, match=r"open in another run, or in a program that reads it"):
                pound_solve.run(write(tmp_path, strength=6))
            with pound_solve.run(deck, name="third") as third:
                assert third.path.name == "third.h5" and third.path.with_suffix(".rpt").exists()
            assert (second.history("node/u") == other).all()
        assert (first.history("node/u") == own).all() and (own != other).any()


@pytest.mark.full
def test_runs_of_one_deck_keep_apart_by_name(tmp_path, capsys):
    deck = write(tmp_path)
    for name in ("a", "b.2"):
        assert main([str(deck), "--name", name, "--quiet"]) == 0
        assert {p.name for p in tmp_path.glob(f"{name}.*")} == {f"{name}.h5", f"{name}.rpt"}
    assert not deck.with_suffix(".h5").exists()
    with pytest.raises(SystemExit):
        main([str(deck), "--name", "sub/a"])
    assert "--name: sub/a is a path" in capsys.readouterr().err
    with pytest.raises(ValueError, match="is a path"):
        pound_solve.run(deck, name="../a")


@pytest.mark.parametrize("name", ["..", ".", "", " ", "---", "_", "a\0b", "a\n"])
def test_a_name_that_names_no_file_is_refused_before_the_run(tmp_path, capsys, name):
    deck = write(tmp_path)
    with pytest.raises(SystemExit) as end:
        main([str(deck), f"--name={name}"])
    cure = "names no file: give characters that can be printed, a letter or a digit among them"
    assert end.value.code == 2 and f"--name: {name!r} {cure}" in capsys.readouterr().err
    with pytest.raises(ValueError, match="names no file"):
        pound_solve.run(deck, name=name)
    assert list(tmp_path.iterdir()) == [deck]


@pytest.fixture
def pipe(tmp_path):
    """Makes pipes that nobody writes; what waits for one ends."""
    if not hasattr(os, "mkfifo"):
        pytest.skip("pipes")

    def made(name):
        os.mkfifo(tmp_path / name)
        return str(tmp_path / name)

    def waits(*_):
        raise AssertionError("it waits for a pipe")

    before = signal.signal(signal.SIGALRM, waits)
    signal.alarm(600)  # ends a hang; no test takes that long, however busy the machine
    yield made
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize(
    ("words", "status"),
    [
        ("run {pipe}.inp", 3),
        ("check {pipe}.inp", 3),
        ("check including.inp", 2),
        ("format {pipe}.inp", 3),
        ("import {pipe}.inp", 3),
        ("import {deck} --record {pipe}.txt", 3),
        ("sweep {pipe}.toml", 3),
        ("sweep cases.toml", 2),
        ("ida {pipe}.toml", 3),
        ("separation {pipe}.h5", 3),
        ("report {pipe}.h5", 3),
        ("loop BILINEAR --file {pipe}.txt", 3),
        ("spectrum {pipe}.at2", 2),
        ("plot {deck} --style {pipe}.mplstyle", 3),
        ("format {deck} -o {pipe}.inp", 3),
        ("loop BILINEAR --svg {pipe}.svg", 3),
        ("run {deck} --name {pipe}", 2),
    ],
)
def test_a_pipe_is_no_file(tmp_path, monkeypatch, capsys, pipe, words, status):
    monkeypatch.chdir(tmp_path)
    deck = write(tmp_path)
    for ending in (".inp", ".txt", ".toml", ".h5", ".at2", ".mplstyle", ".svg"):
        pipe(f"pipe{ending}")
    Path("including.inp").write_text('INCLUDE "pipe.inp"\n')
    Path("cases.toml").write_text(f'deck = "{deck.name}"\ncases = "pipe.txt"\n')
    try:
        found = main([word.format(pipe="pipe", deck=deck.name) for word in words.split()])
    except SystemExit as end:
        found = end.code
    assert found == status
    told = capsys.readouterr().err
    assert re.search("a pipe or a device, not a file|no such file|not found|no file of this program", told)


@pytest.mark.parametrize("name", ["lock", "runs/local-1.jsonl"])
def test_a_pipe_in_the_folder_of_a_sweep_is_refused(tmp_path, capsys, pipe, name):
    study = folder(tmp_path, STUDY)
    (tmp_path / "walls.sweep/runs").mkdir(parents=True)
    pipe(f"walls.sweep/{name}")
    assert main(["sweep", str(study)]) == 3
    assert f"{name}: a pipe or a device, not a file" in capsys.readouterr().err


def test_a_partial_file_follows_no_link_and_waits_for_no_pipe(tmp_path, pipe):
    others, text, results = (tmp_path / name for name in ("others.txt", "a.rpt", "a.h5"))
    others.write_text("of others")
    for made in (lambda path: path.symlink_to(others), lambda path: pipe(path.name)):
        for path in (text, results):
            made(partial(path))
        write_text(text, "own")
        with Writer(partial(results), title="", units=Units("kN", "m", "s"), program_version="") as writer:
            writer.finish("done")
        assert text.read_text() == "own" and others.read_text() == "of others"
        assert not partial(results).is_symlink()
        partial(results).unlink()


@pytest.mark.full
def test_histories_may_be_packed_or_left_out(tmp_path):
    """The tables are the same; packed histories are so to the last bit."""
    deck = write(tmp_path, motion=QUAKE.format(a=3))
    found = {}
    for word in ("YES", "PACKED", "NO"):
        own = tmp_path / word / "model.inp"
        own.parent.mkdir()
        own.write_text(f"{deck.read_text()} HISTORIES={word}\n".replace("0.001\n HIST", "0.001 HIST"))
        found[word] = pound_solve.run(own)
    whole, packed, none = found.values()
    assert none.histories == ("time",) and len(none.time) == len(whole.time)
    for name in whole.histories:
        assert (whole.history(name) == packed.history(name)).all()
    for name in set(whole.tables) - {"run_figures", "arrays", "imports", "options", "warnings"}:
        for other in (packed, none):
            assert repr(whole.table(name)) == repr(other.table(name)), name
    sizes = [results.path.stat().st_size for results in found.values()]
    assert sizes[0] > 1.2 * sizes[1] and sizes[1] > 1.5 * sizes[2]
    for results in found.values():
        results.close()


@pytest.mark.parametrize("suffix", [".h5", ".rpt", ".partial.rpt"])
def test_the_deck_is_never_an_output(tmp_path, suffix):
    deck = write(tmp_path).rename(tmp_path / f"model{suffix}")
    text = deck.read_text()
    with pytest.raises(DeckError, match="R407"):
        pound_solve.run(deck)
    assert deck.read_text() == text


def test_a_record_is_never_an_output(tmp_path):
    record = tmp_path / "model.rpt"
    record.write_text("\n".join("0.1" for _ in range(100)))
    deck = write(
        tmp_path, motion='EQUAKE\n RECORD FILE="model.rpt" FORMAT=COLUMNS DT=0.01 COLUMN=1 UNIT=G\n'
    )
    text = record.read_text()
    with pytest.raises(DeckError, match=r"(?s)R407.*model\.rpt is both read and written"):
        pound_solve.run(deck)
    assert record.read_text() == text


@pytest.mark.full
@pytest.mark.parametrize("suffix", [".h5", ".rpt"])
def test_a_file_of_another_program_is_never_replaced(tmp_path, suffix):
    deck, own = write(tmp_path), tmp_path / f"model{suffix}"
    own.write_bytes(b"measured by hand\n" * 9000)
    with pytest.raises(DeckError, match=rf"(?s)R411.*model\{suffix} is no file of this program"):
        pound_solve.run(deck)
    assert own.read_bytes() == b"measured by hand\n" * 9000
    own.write_bytes(b"")
    pound_solve.run(deck).close()
    pound_solve.run(deck).close()  # its own are replaced


@pytest.mark.full
def test_a_restart_in_place_takes_the_older_results_and_replaces_them(tmp_path):
    whole = pound_solve.run(write(tmp_path, "whole", end=2, more="SAVE=1"))
    deck = write(tmp_path, end=1)
    pound_solve.run(deck).close()
    with pound_solve.run(write(tmp_path, end=2, more='RESTART="model.h5"')) as results:
        late = whole.time >= 1
        assert (results.history("node/u") == whole.history("node/u")[late]).all()


def test_a_refused_restart_in_place_leaves_the_older_results(tmp_path):
    deck = write(tmp_path)
    pound_solve.run(deck).close()
    whole = bytes_of(deck)
    with pound_solve.run(write(tmp_path, end=0.5, more='RESTART="model.h5"')) as results:
        assert results.message.startswith("A505")
    assert bytes_of(deck) == whole


def test_a_restart_from_its_own_partial_results_is_refused(tmp_path):
    deck = write(tmp_path)
    pound_solve.run(deck).path.rename(tmp_path / "model.partial.h5")
    with pytest.raises(DeckError, match="R407"):
        pound_solve.run(write(tmp_path, end=2, more='RESTART="model.partial.h5"'))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"strength": 12}, r"property set S is not that of .*FX=12.0 here, FX=10.0 there"),
        ({"motion": QUAKE.format(a=1)}, r"(?s)motion 1 is not that of .*NEW=MOTION"),
    ],
)
def test_a_state_of_another_deck_is_refused_and_the_difference_named(tmp_path, change, words):
    pound_solve.run(write(tmp_path, "first")).close()
    with pytest.raises(DeckError, match=words):
        pound_solve.run(write(tmp_path, end=2, more='RESTART="first.h5"', **change))


@pytest.mark.full
def test_another_earthquake_follows_from_time_zero(tmp_path):
    first = pound_solve.run(write(tmp_path, "first", motion=QUAKE.format(a=1)))
    more = 'RESTART="first.h5" NEW=MOTION'
    second = pound_solve.run(write(tmp_path, more=more, motion=QUAKE.format(a=3)))
    assert second.time[0] == 0 and second.time[-1] == 1
    assert second.history("node/u")[0] == pytest.approx(first.history("node/u")[-1], abs=1e-15)
    # the same as one long motion with the second after the first
    both = (
        "EQUAKE\n SINE AMPLITUDE=1 PERIOD=0.5 DURATION=1\n SINE AMPLITUDE=3 PERIOD=0.5 DURATION=1 START=1\n"
    )
    whole = pound_solve.run(write(tmp_path, "whole", end=2, more="SAVE=1", motion=both))
    late = whole.time >= 1
    assert second.history("node/u") == pytest.approx(whole.history("node/u")[late], abs=1e-12)


def test_a_new_motion_without_a_restart_is_a_mistake(tmp_path):
    with pytest.raises(DeckError, match="NEW stands beside RESTART only"):
        pound_solve.run(write(tmp_path, more="NEW=MOTION"))


MOTION = """GRAVITY 9.81
NODES
 1 0 0 FIX=YR
ELEMENTS
 1 S 1
PROPS
 S SPRING KX=40
WEIGHTS
 1 9.81
EQUAKE
 SINE AMPLITUDE=1 PERIOD=0.5 DURATION=5
ANALYSIS
 HISTORY 5
"""
#: verbs that write files, and the ends of the names of those that they write first
WRITERS = {
    "export model.h5 -o out": ".csv",
    "export model.h5 --history node/u -o out": "out/histories.csv",
    "export model.h5 --vtk -o out": "model.vtkhdf",
    "plot model.h5 frame -o out": "frame.svg",
    "plot model.h5 frame --as png -o out": "frame.png",
    "plot model.h5 frame --as pdf -o out": "frame.pdf",
    "plot model.h5 animation --as html -o out": "animation.html",
    "plot model.h5 animation --as gif --between 0 0.002 -o out": "animation.gif",
    "plot model.h5 animation --as mp4 --between 0 0.002 -o out": "animation.mp4",
    "report model.h5 --html": "model.html",
    "motions sine.inp --dt 0.01 -o out": ".at2",
    "example 01_two_oscillators -o out": "",
    "loop BILINEAR R=0.1 --svg loop.svg": "loop.svg",
    "loop BILINEAR R=0.1 --png loop.png": "loop.png",
    "spectrum sine.inp --periods 0.1:1:9 -o spectrum.csv": "spectrum.csv",
    "spectrum sine.inp --periods 0.1,1 --picture spectrum.pdf": "spectrum.pdf",
    "import old.inp -o new.inp": "new.inp",
    "format model.inp": "model.inp",
    "format model.inp -o laid.inp": "laid.inp",
    "separation sweep.h5": "separation.csv",
    "fragility sweep.h5 --demand peak_drift --limit 0.001": "fragility_peak_drift_0.001.rpt",
}
#: stands for the program ffmpeg, which writes what it reads
FFMPEG = """#!/bin/sh
for last; do :; done
cat > "$last" || { echo "$last: no space" >&2; exit 1; }
"""


STUDY = """deck = "wall.inp"
[grid]
gap = [1]
[[motions]]
files = ["first.txt", "second.txt"]
unit = "M/S2"
scale = [1, 2]
"""


@pytest.mark.full
@each_once(("words", [*WRITERS]), at_most=11)
def test_a_file_that_finds_no_room_is_named_and_not_there(tmp_path, monkeypatch, capsys, words):
    """No file becomes longer than 200 bytes: what a full disk does, with another number."""
    resource = pytest.importorskip("resource", reason="limits of the system")
    if any(name in words for name in ("animation", " frame", "png", "picture")):
        pytest.importorskip("matplotlib")
    if "--html" in words:
        pytest.importorskip("plotly")
    monkeypatch.chdir(tmp_path)
    deck = write(tmp_path, end=0.2)
    if "model.h5" in words:
        pound_solve.run(deck).close()
    if "sweep.h5" in words:
        shutil.copy(swept(folder(tmp_path, STUDY)).write(), tmp_path / "sweep.h5")
    if "mp4" in words:
        (tmp_path / "ffmpeg").write_text(FFMPEG)
        (tmp_path / "ffmpeg").chmod(0o755)
        monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    (tmp_path / "sine.inp").write_text(MOTION)
    (tmp_path / "old.inp").write_text(STICK)
    # Python 3.11 keeps what was cut short of a module's bytecode, and every later process fails by it
    monkeypatch.setattr(sys, "dont_write_bytecode", True)

    def ends_in_words(before):
        soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (200, hard))
        try:
            status = main(words.split())
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        told = capsys.readouterr().err
        assert status == 3 and "fault" not in told, told
        left = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
        assert left.items() >= before.items(), told
        others = left.keys() - before.keys()  # short ones that a verb wrote before
        assert all(0 < len(left[p]) <= 200 and ".partial" not in p.name for p in others), others
        return told

    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    told = ends_in_words(before)
    named = re.search(r"^pound-solve: (\S+?): .*(too large|no space)", told, re.MULTILINE)
    assert named and named[1].endswith(WRITERS[words]), told
    path = tmp_path / named[1]
    if path not in before:
        assert not path.exists()
        path.write_bytes(b"older")
        ends_in_words({**before, path: b"older"})


def test_nothing_stays_of_a_report_or_of_histories_that_find_no_room(tmp_path):
    """No file becomes longer than 200 bytes."""
    resource = pytest.importorskip("resource", reason="limits of the system")
    results = tmp_path / "model.h5"
    partial(results).write_bytes(b"results")
    histories = {"time": np.arange(100.0)}
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (200, hard))
    try:
        with pytest.raises(ResultsError, match=r"model\.rpt: .*; the results of this run are in"):
            place.put_in_place(results, "report\n" * 100, whole=True)
        with pytest.raises(OSError, match=r"model\.npz"):
            Journal(tmp_path).add(JournalEntry("model", "done", histories=histories))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert [path.name for path in tmp_path.iterdir()] == ["model.partial.h5"]
