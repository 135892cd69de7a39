"""Optima of studies: known ones, active limits, the deck of the best point, mistakes, resumption."""

import json
import math
from pathlib import Path

import pytest

from pound_solve.cli.main import main
from pound_solve.report.sweep.optimum import OptimumReport
from pound_solve.results import Results
from pound_solve.results.sweep_file import Sweep
from pound_solve.sweep import optimize
from pound_solve.sweep.execution import executors
from pound_solve.sweep.execution.executors import Engine
from pound_solve.sweep.points import Interrupted, Points
from pound_solve.sweep.session import Session
from pound_solve.sweep.study.document import Document
from pound_solve.sweep.study.study import StudyError, read
from standing import Standing
from sweep.small import Here, folder
from sweep.test_uncertainty import LINEAR
from tiers import at_night

#: the least sum of two factors on the motion whose peak is at least 2
STUDY = """deck = "wall.inp"

[variables]
a = { low = 0.5, high = 3 }
b = { low = 0.5, high = 3 }

[objective]
expression = "a + b"

[constraint]
peak_drift = { min = 2 }

[optimize]
starts = 2
runs = 60
"""
WALL = """deck = "wall.inp"

[variables]
k = { low = 1000, high = 20000, scale = "log" }
gap = { low = 0.005, high = 0.1 }

[objective]
expression = "k/1000 + 200*gap"
records = "max"

[constraint]
contact_force = 5000

[optimize]
starts = 2
runs = 40

[[motions]]
files = ["first.txt", "second.txt"]
unit = "M/S2"
"""


def searched(path, executor=None, stop=None):
    """Report of a search, which may be interrupted after some runs; and the analysis."""
    document = Document.read(str(path))
    aim = optimize.aim(document)
    study = read(document, optimize.TABLES)
    lane = executor or Here()
    analysis = optimize.OptimumAnalysis(Points(Session(study, Engine(lambda: lane, 1, 1, 1, True))), aim)

    def report(state):
        if stop is not None and lane.runs >= stop and not state.ending:
            raise KeyboardInterrupt

    with analysis.points.conducted(report):
        search = analysis.carry_out()
    sweep = Sweep.open(analysis.points.session.write())
    return OptimumReport(sweep, analysis.problem, search, analysis.before), analysis


@pytest.fixture(scope="module")
def linear(tmp_path_factory):
    return searched(folder(tmp_path_factory.mktemp("linear"), STUDY, LINEAR))


def test_the_optimum_of_a_linear_oscillator_is_known(linear):
    """Its peak is c * (a + 2*b): b alone is raised, a stays at its bound, the limit is active."""
    report, _ = linear
    c = report.before.limited[0] / 3.0
    a, b = report.values
    assert a == pytest.approx(0.5, abs=0.01)
    assert b == pytest.approx((2.0 / c - 0.5) / 2.0, rel=2e-3)
    assert report.best.is_feasible and report.best.excess >= -2e-3
    ((_, _, before, after, kind, limit, remark),) = (r for r in report.of_results() if r[0] == "limit")
    assert (kind, limit, remark) == ("at least", 2.0, "active")
    assert before == pytest.approx(3.0 * c) and after == pytest.approx(c * (a + 2.0 * b), rel=1e-6)
    assert [row[-1] for row in report.of_variables()] == ["at its lower bound", ""]
    assert any("All 2 starts that ended agree" in line for line in report.report())


@pytest.mark.parametrize(
    "method, goal, records, bound",
    [
        ("smooth", "minimize", '"mean"', 0),
        ("rough", "maximize", "0.5", 1),
        ("smooth", "maximize", '"max"', 1),
    ],
)
def test_a_monotone_quantity_has_its_optimum_at_a_bound(tmp_path, method, goal, records, bound):
    study = STUDY.replace(
        'expression = "a + b"', f'quantity = "peak_drift"\ngoal = "{goal}"\nrecords = {records}'
    )
    study = study.replace("peak_drift = { min = 2 }\n", "").replace(
        "starts = 2", f'starts = 1\nmethod = "{method}"'
    )
    report, _ = searched(folder(tmp_path, study, LINEAR))
    assert report.values == pytest.approx((0.5, 0.5) if bound == 0 else (3.0, 3.0), abs=0.15)
    ((*_, before, after, _, _, _),) = report.of_results()
    assert (after > before) == (goal == "maximize")


def test_every_point_is_in_the_table(linear):
    report, _ = linear
    table = {name: v.values for name, v in report.table().items()}
    assert list(table) == ["start", "a", "b", "objective", "peak_drift min", "feasible", "best"]
    assert table["objective"] == pytest.approx(table["a"] + table["b"])
    assert (table["feasible"] == (table["peak_drift min"] >= 2.0)).all()
    assert table["best"][-1] == pytest.approx(sum(report.values))
    assert len(report.sweep) == len(table["a"]) > 4


def test_the_deck_of_the_optimum_has_its_results(tmp_path, capsys, monkeypatch):
    """From any folder, also where the PARAMs are in an included file."""
    executor = Here()
    monkeypatch.setattr(executors, "engine", lambda *_: Engine(lambda: executor, 1, 1, 1, True))
    path = folder(tmp_path, STUDY.replace("runs = 60", "runs = 12"), LINEAR)
    deck = tmp_path / "wall.inp"
    lines = deck.read_text().splitlines(keepends=True)
    params = [line for line in lines if line.startswith("PARAM  k")]
    (tmp_path / "params.inc").write_text("".join(params))
    deck.write_text("".join("INCLUDE params.inc\n" if line in params else line for line in lines))
    assert main(["optimize", str(path), "--picture", str(tmp_path / "path.svg")]) == 0
    assert "Deck of the best point: walls.optimum.inp" in capsys.readouterr().out
    (tmp_path / "other").mkdir()
    monkeypatch.chdir(tmp_path / "other")
    assert main([str(tmp_path / "walls.optimum.inp"), "-o", "."]) == 0
    sweep = Sweep.open(tmp_path / "walls.sweep/sweep.h5")
    table = (tmp_path / "walls.sweep/optimize.csv").read_text().splitlines()
    assert table[0] == "start,a,b,objective,peak_drift min,feasible,best"
    with Results.open("walls.optimum.h5") as results:
        row = results.table("drift_envelope")[0]
    peak = max(abs(row["max"]), abs(row["min"]))
    assert any(peak == pytest.approx(x, rel=1e-9) for x in sweep["peak_drift"][:, 0])
    assert peak >= 2.0
    assert main(["optimize", str(path), "--quiet"]) == 0  # its own deck may be written again
    (tmp_path / "walls.optimum.inp").write_text("TITLE  mine\n")
    assert main(["optimize", str(path), "--quiet"]) == 2
    assert "is in the way" in capsys.readouterr().err


@pytest.mark.parametrize("stop", [9, *at_night(1, 20)])
def test_an_interrupted_search_goes_on_and_ends_the_same(tmp_path, stop):
    """No run is lost or executed twice, and the reports are the same byte by byte."""
    reports = []
    for name, stops in (("whole", ()), ("stopped", (stop,))):
        (tmp_path / name).mkdir()
        path, executor = folder(tmp_path / name, WALL), Here()
        for at in stops:
            with pytest.raises(Interrupted):
                searched(path, executor, at)
        report, _ = searched(path, executor)
        assert executor.runs == len(report.sweep)
        reports.append("\n".join(report.report()))
        reports.append((path.parent / "walls.sweep/sweep.rpt").read_text())
        assert len(report.tried) <= 40
    assert reports[:2] == reports[2:]
    assert "largest of the records" in reports[0]


def test_a_search_without_runs_left_tells_it(tmp_path):
    report, _ = searched(folder(tmp_path, WALL.replace("runs = 40", "runs = 3")))
    told = "\n".join(report.report())
    assert "used up its share of the runs" in told and "No point satisfies all limits" in told
    assert not report.is_solved and len(report.tried) <= 3
    assert all(math.isnan(x) for x in report.table()["best"].values)


MISTAKES = (
    ("a = { low = 0.5, high = 3 }", "a = { low = 0.5 }", "S604", "a needs low and high"),
    ("a = { low = 0.5, high = 3 }", 'a = { low = 0.5, high = 3, scale = "lg" }', "S603", "scale is no lg"),
    ("a = { low = 0.5, high = 3 }", 'a = { low = 0, high = 3, scale = "log" }', "S605", "low above zero"),
    ("a = { low = 0.5, high = 3 }", "a = { low = 1.5, high = 3 }", "S605", "outside of its bounds"),
    ('expression = "a + b"', "", "S604", "no objective"),
    ('expression = "a + b"', 'expression = "a + c"', "S605", "c in a + c is no number and no variable"),
    ('expression = "a + b"', 'expression = "a +"', "S605", "a formula of a, b"),
    ('expression = "a + b"', 'quantity = "drift"', "S602", "no quantity drift"),
    ('expression = "a + b"', 'expression = "a"\nquantity = "closures"', "S604", "beside"),
    (
        'expression = "a + b"',
        'expression = "a"\nrecords = "each"',
        "S603",
        "records is mean, max, or a share",
    ),
    ('expression = "a + b"', 'expression = "a"\nrecords = 84', "S603", "a share between 0 and 1"),
    ('expression = "a + b"', 'expression = "a"\ngoal = "minimise"', "S603", "goal is no minimise"),
    ("{ min = 2 }", "{ mn = 2, max = 3 }", "S602", "no item mn"),
    ("{ min = 2 }", "{ }", "S604", "has no limit"),
    ("{ min = 2 }", '"2"', "S603", "is a number"),
    ("runs = 60", "runs = 0", "S603", "runs is 1 to 100000"),
    ("runs = 60", "tolerance = 1", "S603", "1e-8 to 0.1"),
    ("runs = 60", "seed = -1", "S603", "zero or above"),
    ("runs = 60", 'method = "slsqp"', "S603", "method is no slsqp"),
)


@pytest.mark.parametrize("old, new, code, text", MISTAKES)
def test_a_mistake_is_reported_at_its_line(tmp_path, old, new, code, text):
    assert STUDY.count(old) == 1
    path = folder(tmp_path, STUDY.replace(old, new), LINEAR)
    document = Document.read(str(path))
    optimize.aim(document)
    with pytest.raises(StudyError) as raised:
        read(document, optimize.TABLES)
    (told,) = raised.value.diagnostics
    assert told.code == code and text in str(raised.value)
    assert told.span.file == str(path) and told.span.line >= 3


def test_what_the_runs_lack_is_told_before_the_search(tmp_path, capsys, monkeypatch):
    executor = Here()
    monkeypatch.setattr(executors, "engine", lambda *_: Engine(lambda: executor, 1, 1, 1, True))
    path = folder(tmp_path, STUDY.replace("peak_drift", "storey_drift"), LINEAR)
    assert main(["optimize", str(path)]) == 2
    assert "its runs have no storey_drift" in capsys.readouterr().err
    path.write_text(STUDY.replace("a + b", "b/(a - 1)"))
    assert main(["optimize", str(path)]) == 2
    assert "has no value at those of the study" in capsys.readouterr().err
    assert executor.runs == 1


@pytest.mark.full
def test_a_search_that_is_killed_goes_on_where_it_was(tmp_path):
    pytest.importorskip("fcntl", reason="kills by signals")
    path = folder(tmp_path, WALL)
    words = ["optimize", str(path), "--workers", "2", "--quiet"]
    for calls in (3, 11):
        run = Standing("pound_solve.sweep.execution.conduct Conductor _count", calls, words)
        assert run.stands()
        run.kill()
    status, errors = Standing("pound_solve.sweep.plan lines", 1, words).end()
    assert status == 0, errors
    journals = Path(tmp_path, "walls.sweep/runs").glob("*.jsonl")
    identities = [
        json.loads(line)["identity"] for file in journals for line in file.read_text().splitlines()
    ]
    sweep = Sweep.open(tmp_path / "walls.sweep/sweep.h5")
    assert sorted(identities) == sorted(sweep["identity"].tolist())
    assert (tmp_path / "walls.sweep/optimize.rpt").is_file()


def test_a_factor_on_the_records_is_no_part_of_the_deck(tmp_path):
    """It is told in the deck's first line; alone it leads to no deck."""
    both = WALL.replace("gap = {", "motion = {").replace("200*gap", "200*motion").replace("0.005", "0.5")
    both = both.replace("high = 0.1", "high = 2")
    alone = both.replace('k = { low = 1000, high = 20000, scale = "log" }\n', "").replace("k/1000 + ", "")
    for study, written in ((both, True), (alone, False)):
        path = folder(tmp_path, study)
        document = Document.read(str(path))
        aim = optimize.aim(document)
        points = Points(Session(read(document, optimize.TABLES), None))
        deck = optimize.OptimumAnalysis(points, aim).deck(points.nominal)
        assert (deck is not None) == written
        if deck:
            assert deck[0] == tmp_path / "walls.optimum.inp"
            assert deck[1].startswith(
                "! Optimum of walls.toml: pound-solve walls.optimum.inp; motion = 1.0\n"
            )
