"""Sweeps: their numbers are those of single runs, and nothing is run twice or lost."""

import csv
import errno
import json
import math
import multiprocessing
import os
from concurrent.futures import Executor, Future
from concurrent.futures.process import BrokenProcessPool
from itertools import pairwise
from pathlib import Path

import h5py
import numpy as np
import pytest

from decks import results_of
from pound_solve.cli.main import main
from pound_solve.loading.piecewise import Piecewise
from pound_solve.loading.spectrum import response_spectrum
from pound_solve.results import ResultsError
from pound_solve.results.sweep_file import OF_THE_DAY, Sweep
from pound_solve.sweep import run_study
from pound_solve.sweep import session as sessions
from pound_solve.sweep.execution import executors
from pound_solve.sweep.execution.executors import Engine
from pound_solve.sweep.execution.journal import Journal, JournalEntry
from pound_solve.sweep.execution.limits import within
from pound_solve.sweep.execution.work import prepared
from sweep.small import DECK, STUDY, Here, folder, record, session, swept


def same(a, b):
    """Whether two sweeps hold the same but for times."""
    assert list(a.variables) == list(b.variables) and a.labels == b.labels
    for name, own in a.variables.items():
        if name not in OF_THE_DAY:
            np.testing.assert_array_equal(own.values, b[name], err_msg=name)
    return True


@pytest.mark.full
def test_every_run_has_the_numbers_of_a_single_run(tmp_path):
    path = folder(tmp_path)
    found = Sweep.open(swept(path).write())
    assert len(found) == 16 and set(found["status"]) == {"done"}
    for i in range(0, 16, 3):  # every value of every axis
        params = {"gap": found["gap"][i], "k": found["k"][i], "scale": found["scale"][i]}
        (tmp_path / "one.inp").write_text(DECK.replace("RECORD record", "RECORD record UNIT=M/S2"))
        with results_of(tmp_path / "one.inp", {**params, "record": found["record"][i]}) as one:
            contact, drift = one.table("contact_summary")[0], one.table("drift_envelope")[0]
            assert found["contact_force"][i, 0] == contact["peak_force"]
            assert found["closures"][i, 0] == contact["closures"]
            assert found["impulse"][i, 0] == contact["impulse"]
            assert found["peak_drift"][i, 0] == max(drift["max"], -drift["min"])
            assert found["period"][i] == one.table("modes")[0]["period"]
            assert found["reached"][i] == 1.0
    assert len(set(found["contact_force"][:, 0])) > 8  # the cases differ


@pytest.mark.full
@pytest.mark.parametrize(
    ("more", "nodes", "members"),
    [
        ("", [2], []),
        ('histories = ["node/u", "member/force"]\n', None, None),
        ('histories = ["drift"]\n', [2], []),
    ],
)
def test_a_run_records_what_a_quantity_or_a_kept_history_needs(tmp_path, more, nodes, members):
    done = swept(folder(tmp_path, more + STUDY))
    case = done.study.runs[0]
    output = prepared(case.case, case.first, done.study.histories)[0].structure.model.output
    assert (output["NODES"], output["MEMBERS"]) == (nodes, members)
    assert set(Sweep.open(done.write()).variables) >= {"needed_gap", "peak_i", "peak_drift"}


@pytest.mark.full
@pytest.mark.parametrize(
    ("method", "nodes", "members"),
    [("TOL_MEMBER=0.01", [2], None), ("PEAKS=ALL", None, None), ("TOL_ACCELERATION=0.01", None, [])],
)
def test_a_run_records_what_auto_compares(tmp_path, method, nodes, members):
    deck = DECK.replace("HISTORY 1", f"HISTORY 1 METHOD=AUTO {method}")
    done = swept(folder(tmp_path, deck=deck))
    case = done.study.runs[0]
    output = prepared(case.case, case.first, ())[0].structure.model.output
    assert (output["NODES"], output["MEMBERS"]) == (nodes, members)


@pytest.mark.full
def test_runs_that_share_a_structure_do_not_depend_on_their_order(tmp_path):
    one, other = swept(folder(tmp_path)), session(tmp_path / "walls.toml")
    before = one.write()
    first = Sweep.open(before)
    for path in (tmp_path / "walls.sweep/runs").iterdir():
        path.unlink()
    other = session(tmp_path / "walls.toml")
    other.carry_out(other.agenda.ahead[::-1], lambda state: None)
    assert same(first, Sweep.open(other.write()))


@pytest.mark.full
def test_what_is_done_is_not_run_again_and_what_has_changed_is(tmp_path):
    path, count = folder(tmp_path), Here()
    swept(path, executor=count)
    assert count.runs == 16
    swept(path, executor=count)
    assert count.runs == 16
    record(tmp_path / "second.txt", 2.0, 0.8)
    swept(path, executor=count)
    assert count.runs == 24
    path.write_text(STUDY.replace("0.01, 0.02", "0.01, 0.02, 0.03"))
    assert len(session(path).agenda.ahead) == 8


def test_a_run_that_fails_is_told_with_its_reason_and_tried_again_when_asked(tmp_path, capsys):
    path = folder(tmp_path, STUDY.replace("5000.5", "-1"))
    done = swept(path)
    text = "\n".join(done.summary())
    assert done.ends.count("failed") == 8 and not done.whole
    assert "16 runs: 8 done, 8 failed" in text and "KX" in text
    assert not session(path).agenda.ahead and len(session(path, retry=True).agenda.ahead) == 8
    found = Sweep.open(done.write())
    bad = found["status"] == "failed"
    assert bad.sum() == 8 and np.isnan(found["peak_drift"][bad]).all()
    assert all("wall.inp:12" in m for m in found["message"][bad])


@pytest.mark.full
def test_pieces_make_the_same_table_as_the_whole(tmp_path):
    whole = Sweep.open(swept(folder(tmp_path)).write())
    (tmp_path / "b").mkdir()
    path = folder(tmp_path / "b")
    sizes = [len(swept(path, piece=(k, 3)).runs) for k in (3, 1, 2)]
    assert sorted(sizes) == [5, 5, 6]
    merged = session(path)
    assert not merged.agenda.ahead and same(whole, Sweep.open(merged.write()))


def test_a_journal_line_that_was_cut_short_is_a_run_that_was_not_made(tmp_path):
    path = folder(tmp_path)
    swept(path)
    (journal,) = (tmp_path / "walls.sweep/runs").glob("*.jsonl")
    text = journal.read_bytes()
    journal.write_bytes(text[:-40])
    again = session(path)
    assert len(again.agenda.ahead) == 1
    again.carry_out(again.agenda.ahead, lambda state: None)
    assert not session(path).agenda.ahead
    assert len([line for line in journal.read_text().splitlines() if _whole(line)]) == 16


def _whole(line):
    try:
        return bool(json.loads(line))
    except ValueError:
        return False


def test_records_are_scaled_to_a_peak_or_a_spectral_acceleration(tmp_path):
    study = 'deck = "wall.inp"\n[[motions]]\nfiles = "*t.txt"\nunit = "M/S2"\npga = [0.1, 0.3]\n'
    runs = session(folder(tmp_path, study)).runs
    peak = max(abs(float(line.split()[1])) for line in (tmp_path / "first.txt").read_text().splitlines())
    assert [r.shaking.scale for r in runs] == pytest.approx(
        [0.1 * 9.81 / peak, 0.3 * 9.81 / peak], rel=1e-3
    )
    (tmp_path / "walls.toml").write_text(
        study.replace("pga = [0.1, 0.3]", "sa = 0.2\nperiod = 0.4\ndamping = 0.02")
    )
    (run_,) = session(tmp_path / "walls.toml").runs
    t, a = np.loadtxt(tmp_path / "first.txt").T
    scaled = response_spectrum(Piecewise.from_samples(t, a * run_.shaking.scale), 0.4, 0.02).psa[0, 0]
    gravity = scaled / 0.2
    assert gravity == pytest.approx(9.81, rel=1e-3)
    found = Sweep.open(swept(tmp_path / "walls.toml").write())
    assert found["sa"].tolist() == [0.2] and found["scale"].tolist() == [run_.shaking.scale]


def test_the_csv_holds_what_the_file_holds(tmp_path):
    path = swept(folder(tmp_path)).write()
    found = Sweep.open(path)
    with path.with_suffix(".csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["contact_force 2"]) for row in rows] == found["contact_force"][:, 0].tolist()
    assert [row["record"] for row in rows] == found["record"].tolist()
    assert [name for name, _ in found.columns()] == list(rows[0])


def test_the_file_opens_in_xarray_and_pandas(tmp_path):
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("h5netcdf")
    path = swept(folder(tmp_path)).write()
    found = Sweep.open(path)
    with xarray.open_dataset(path, engine="h5netcdf") as direct:
        own = found.to_xarray()
        assert direct["contact_force"].dims == own["contact_force"].dims == ("run", "contact")
        np.testing.assert_array_equal(direct["peak_drift"], own["peak_drift"])
        assert direct["contact_force"].attrs["units"] == "kN" and list(direct["contact"].values) == ["2"]
        assert float(direct["gap"].sel(run=16)) == 0.02
    frame = found.to_pandas()
    assert frame.groupby("gap")["contact_force 2"].max().index.tolist() == [0.01, 0.02]
    assert frame.index.name == "run" and len(frame) == 16


@pytest.mark.full
def test_histories_are_kept_on_demand(tmp_path):
    path = folder(tmp_path, 'histories = ["drift", "contact/force"]\n' + STUDY)
    written = swept(path).write()
    found = Sweep.open(written)
    (tmp_path / "one.inp").write_text(DECK.replace("RECORD record", "RECORD record UNIT=M/S2"))
    with results_of(
        tmp_path / "one.inp", {"gap": 0.01, "k": 4000, "scale": 2.5, "record": "second.txt"}
    ) as one:
        t, rows, labels = found.history(4, "contact/force")
        np.testing.assert_array_equal(t, one.time)
        np.testing.assert_array_equal(rows, one.history("contact/force"))
        assert labels == one.labels("contact/force")
    with pytest.raises(ResultsError, match="no history member/force of run 4"):
        found.history(4, "member/force")
    assert not list((tmp_path / "walls.sweep/runs").glob("*.part"))


def test_a_foreign_or_damaged_file_is_told(tmp_path):
    with pytest.raises(ResultsError, match="no such file"):
        Sweep.open(tmp_path / "none.h5")
    with h5py.File(tmp_path / "other.h5", "w"):
        pass
    with pytest.raises(ResultsError, match="not one of a sweep"):
        Sweep.open(tmp_path / "other.h5")
    (tmp_path / "bad.h5").write_bytes(b"nothing" * 100)
    with pytest.raises(ResultsError, match="damaged"):
        Sweep.open(tmp_path / "bad.h5")


@pytest.mark.full
def test_processes_give_the_same_bits_as_this_one(tmp_path, capsys):
    path = folder(tmp_path)
    here = Sweep.open(swept(path).write())
    out = tmp_path / "by two"
    assert main(["sweep", str(path), "--workers", "2", "-o", str(out)]) == 0
    assert "16 runs: 16 done" in capsys.readouterr().out
    assert same(here, Sweep.open(out / "sweep.h5"))
    assert not multiprocessing.active_children()


def test_limits_of_time_and_memory_end_a_run_with_its_reason(tmp_path):
    told_often = DECK.replace("HISTORY 1", "HISTORY 1 METHOD=EXACT")
    found = swept(folder(tmp_path, "seconds = 1E-9\n" + STUDY, told_often))
    entry = found.entries[found.runs[0].identity]
    assert entry.status == "failed" and "more than 1e-09 s of CPU time" in entry.message
    assert math.isnan(entry.reached)


@pytest.mark.full
def test_memory_is_bounded_within_a_run_and_free_after_it():
    resource = pytest.importorskip("resource")
    if not Path("/proc/self/statm").exists():
        pytest.skip("the system tells no process what it holds")
    before = resource.getrlimit(resource.RLIMIT_AS)
    with within(None, 100.0):
        assert len(np.ones(2**20))
        with pytest.raises(MemoryError):
            np.ones(2**26)
    assert resource.getrlimit(resource.RLIMIT_AS) == before and len(np.ones(2**26))


class Fragile(Here):
    """Breaks with one run, and the first time with the run before it, which it has held back till then."""

    def __init__(self, culprit, died):
        super().__init__()
        self.culprit, self.died, self.held, self.broken = culprit, died, [], False

    def submit(self, function, /, *args):
        number = args[0].number
        if self.broken:
            raise BrokenProcessPool
        if number == self.culprit or (number == self.culprit - 1 and not self.died):
            self.held.append((number, Future()))
            if number == self.culprit:
                self.broken = True
                self.died.append([n for n, _ in self.held])
                for _, future in self.held:
                    future.set_exception(BrokenProcessPool())
            return self.held[-1][1]
        return super().submit(function, *args)


def test_a_run_whose_process_dies_is_found_among_others_and_told(tmp_path):
    path, died = folder(tmp_path), []
    out = session(path)
    out.engine = Engine(lambda: Fragile(5, died), 1, 1, 3, True)
    out.carry_out(out.agenda.ahead, lambda state: None)
    failed = [r.number for r in out.runs if out.entries[r.identity].status == "failed"]
    assert failed == [5] and "process died" in out.entries[out.runs[4].identity].message
    assert died == [[4, 5], [5], [5]]


class DiesLate(Here):
    """Its process dies when a run is noted and before it is told."""

    def submit(self, function, /, *args):
        future = super().submit(function, *args)
        if self.runs < 3:
            return future
        broken = Future()
        broken.set_exception(BrokenProcessPool())
        return broken


def test_a_run_that_was_noted_before_its_process_died_is_not_run_again(tmp_path):
    out, had = session(folder(tmp_path)), []

    def begin():
        had.append(DiesLate() if not had else Here())
        return had[-1]

    out.engine = Engine(begin, 1, 1, 1, True)
    done = out.carry_out(out.agenda.ahead, lambda state: None)
    assert [e.status for e in done] == ["done"] * 16 and [own.runs for own in had] == [3, 13]
    lines = [line for f in out.journal.folder.glob("*.jsonl") for line in f.read_text().splitlines()]
    assert len(lines) == 16


class Numbered(Here):
    """Tells which executor had which runs."""

    def __init__(self, had):
        super().__init__()
        self.own = []
        had.append(self.own)

    def submit(self, function, /, *args):
        self.own.append(args[0])
        return super().submit(function, *args)


@pytest.mark.full
@pytest.mark.parametrize("lanes", [2, 3])
def test_a_process_keeps_to_its_case(tmp_path, lanes):
    """Every process prepares as few structures as there can be: cases are shared at the end only."""
    had, out = [], session(folder(tmp_path))
    out.engine = Engine(lambda: Numbered(had), lanes, lanes, 2, True)
    out.carry_out(out.agenda.ahead, lambda state: None)
    assert len(had) == lanes and sorted(r.number for own in had for r in own) == list(range(1, 17))
    turns = [[a.case for a, b in pairwise(own) if a.case != b.case] for own in had]
    assert all(len(cases) == len(set(cases)) for cases in turns)  # none comes back to an earlier case
    assert sum(len({r.case for r in own}) for own in had) <= 4 + lanes - 1


def test_processes_stay_between_the_rounds_of_a_study(tmp_path):
    had, out = [], session(folder(tmp_path))
    out.engine = Engine(lambda: Numbered(had), 1, 1, 1, True)
    with out.conductor(lambda state: None) as conductor:
        for begin in (0, 5, 10):
            assert len(out.carry_on(conductor, out.agenda.ahead[begin : begin + 5])) == 5
    assert len(had) == 1 and len(had[0]) == 15


def test_two_sweeps_do_not_write_one_folder(tmp_path, capsys):
    pytest.importorskip("fcntl")
    from pound_solve.sweep.execution.lock import FolderBusyError, locked

    with (
        locked(tmp_path / "out"),
        pytest.raises(FolderBusyError, match="another sweep"),
        locked(tmp_path / "out"),
    ):
        pass
    with locked(tmp_path / "out", "1-of-2"), locked(tmp_path / "out", "2-of-2"):
        for piece in ("1-of-2", ""):
            with pytest.raises(FolderBusyError), locked(tmp_path / "out", piece):
                pass
    with locked(tmp_path / "out"):
        pass


@pytest.mark.full
def test_the_plan_tells_what_is_ahead(tmp_path, capsys):
    path = folder(tmp_path)
    assert main(["sweep", str(path), "--plan"]) == 0
    out = capsys.readouterr().out
    assert "16 runs: 1 deck, 4 cases of PARAMs, 2 records, 2 factors" in out and "to be run: 16" in out
    assert "trial: 3 runs" in out and "the other 13: about" in out
    assert main(["sweep", str(path), "--plan", "--task", "1/2"]) == 0
    assert "done before, skipped: 1" in capsys.readouterr().out
    assert not (tmp_path / "walls.sweep/sweep.h5").exists()


class Foreseen(Executor):
    """Runs take the CPU time that is foreseen for their tolerance, and meet it with steps or without."""

    def __init__(self, cpu, stepped=True):
        self.cpu, self.values, self.ran = cpu, {"error_estimate": {"": 1e-5}} if stepped else {}, []

    def submit(self, function, run, settings):
        self.ran.append((run.number, run.case.tol))
        entry = JournalEntry(run.identity, "done", cpu=self.cpu[run.case.tol], values=self.values)
        Journal(settings.journal).add(entry)
        future = Future()
        future.set_result(entry)
        return future


@pytest.mark.parametrize(
    ("study", "executor", "ran", "told"),
    [
        (STUDY, Foreseen({None: 1.0}), [(10, None), (1, None), (16, None)], ["13: about 13 s"]),
        (STUDY, Foreseen({None: 30.0}), [(10, None)], ["15: about 7.5 min"]),
        (
            STUDY,
            Foreseen({None: 1000.0, 1e-3: 500.0, 1e-2: 30.0}),
            [(10, None), (10, 1e-3), (10, 1e-2)],
            [
                "15: about 4.17 h",
                "all 16 with --tol 0.001: about 2.22 h",
                "16 with --tol 0.01: about 8 min",
            ],
        ),
        (
            STUDY,
            Foreseen({None: 60.0, 1e-3: 20.0}),
            [(10, None), (10, 1e-3)],
            ["15: about 15 min", "16 with --tol 0.001: about 5.33 min"],
        ),
        (STUDY, Foreseen({None: 60.0}, stepped=False), [(10, None)], ["15: about 15 min"]),
        (f"tol = 1e-2\n{STUDY}", Foreseen({1e-2: 60.0}), [(10, 1e-2)], ["15: about 15 min"]),
        (f'method = "TAYLOR"\n{STUDY}', Foreseen({None: 60.0}), [(10, None)], ["15: about 15 min"]),
    ],
)
def test_a_plan_costs_little_and_names_the_tolerance_that_fits(tmp_path, study, executor, ran, told):
    """One run where runs take long; the same one with looser tolerances, until all take ten minutes."""
    out = session(folder(tmp_path, study), executor=executor)
    lines = list(out.estimate(out.trial(lambda state: None)))
    assert executor.ran == ran and len(lines) == 1 + len(told)
    assert all(part in line for part, line in zip(told, lines[1:]))


def test_an_interruption_ends_a_plan_with_what_it_has(tmp_path):
    def interrupted(state):
        if not state.ending and not state.done:
            raise KeyboardInterrupt

    executor = Foreseen({None: 1.0})
    out = session(folder(tmp_path), executor=executor)
    trial = out.trial(interrupted)
    assert len(executor.ran) == 1 and trial.left == 15
    assert list(out.estimate(trial))[1].startswith("the other 15: about 15 s")


def test_runs_that_go_on_from_a_state_are_made_anew_where_it_changes(tmp_path):
    path = folder(
        tmp_path, 'deck = "wall.inp"\n', DECK.replace("HISTORY 1", 'HISTORY 2 RESTART="first.h5"')
    )
    (tmp_path / "first.inp").write_text(DECK.replace("HISTORY 1", "HISTORY 1.5 SAVE=1"))
    assert main([str(tmp_path / "first.inp"), "-o", str(tmp_path)]) == 0
    assert [e.status for e in swept(path).entries.values()] == ["done"]
    assert not session(path).agenda.ahead
    (tmp_path / "first.inp").write_text(DECK.replace("HISTORY 1", "HISTORY 1.5 SAVE=0.5"))
    assert main([str(tmp_path / "first.inp"), "-o", str(tmp_path)]) == 0
    assert len(session(path).agenda.ahead) == 1


@pytest.mark.parametrize("name", ["wall.inp", "second.txt"])
def test_a_file_that_changes_while_the_sweep_runs_fails_the_runs_that_need_it(tmp_path, name):
    out = session(folder(tmp_path))
    out.carry_out(out.agenda.ahead[:1], lambda state: None)
    file = tmp_path / name
    file.write_text(file.read_text().replace("0", "0.0", 1) if name[0] == "s" else DECK + "! later\n")
    prepared.cache_clear()
    out.carry_out(out.agenda.ahead[1:], lambda state: None)
    told = {r.shaking.record.name: out.entries[r.identity] for r in out.runs[1:]}
    assert told["second.txt"].status == "failed"
    assert f"{name} was changed while the sweep ran" in told["second.txt"].message
    assert (told["first.txt"].status == "done") == (name == "second.txt")


def test_a_disk_that_is_full_ends_the_sweep_in_words_and_loses_nothing(tmp_path, monkeypatch, capsys):
    path = folder(tmp_path)
    add, noted = Journal.add, []

    def full(self, entry):
        if len(noted) == 5:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(self.folder))
        add(self, entry)
        noted.append(entry)

    here = Here()
    monkeypatch.setattr(executors, "engine", lambda name, workers: Engine(lambda: here, 1, 1, 1, True))
    monkeypatch.setattr(Journal, "add", full)
    assert main(["sweep", str(path)]) == 3
    assert "No space left on device" in capsys.readouterr().err
    monkeypatch.setattr(Journal, "add", add)
    assert main(["sweep", str(path)]) == 0
    assert "16 done; 5 of them before" in capsys.readouterr().out and here.runs == 17


def test_a_line_that_the_disk_takes_in_part_is_taken_back(tmp_path):
    journal = Journal(tmp_path)
    journal.add(JournalEntry("first", "done"))
    (path,) = tmp_path.iterdir()
    path.write_bytes(path.read_bytes() + b'{"identity": "sec')
    journal.add(
        JournalEntry("third", "stopped", "A503", values={"drift": {"a": float("nan"), "b": 0.1 + 0.2}})
    )
    found = journal.entries()
    assert list(found) == ["first", "third"] and found["third"].message == "A503"
    (_, (identity, values)) = journal.values(found)
    assert identity == "third" and values["drift"]["b"] == 0.1 + 0.2 and math.isnan(values["drift"]["a"])


def test_histories_that_are_asked_for_later_are_made(tmp_path):
    path = folder(tmp_path)
    swept(path)
    path.write_text('histories = "drift"\n' + STUDY)
    assert len(session(path).agenda.ahead) == 16


def test_warnings_about_the_deck_are_told_once(tmp_path, capsys, monkeypatch):
    path = folder(
        tmp_path, STUDY.replace("scale = [1, 2.5]", "scale = [1]"), DECK.replace("GAP=gap", "GAP=-gap")
    )
    here = Here()
    monkeypatch.setattr(executors, "engine", lambda name, workers: Engine(lambda: here, 1, 1, 1, True))
    main(["sweep", str(path)])
    assert capsys.readouterr().err.count("warning P") == 1


def test_a_study_is_carried_out_from_python(tmp_path, monkeypatch):
    here = Here()
    monkeypatch.setattr(sessions, "engine", lambda name, workers: Engine(lambda: here, 1, 1, 1, True))
    found = run_study(folder(tmp_path))
    assert isinstance(found, Sweep) and len(found) == here.runs == 16
