"""Uncertain variables of a study: statistics of known functions, mistakes, interruption and resumption."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from pound_solve.cli.main import main
from pound_solve.report.sweep.uncertainty import Evaluation
from pound_solve.results.sweep_file import Sweep
from pound_solve.sweep import uncertainty
from pound_solve.sweep.execution import executors
from pound_solve.sweep.execution.executors import Engine
from pound_solve.sweep.points import Interrupted, Points
from pound_solve.sweep.session import Session
from pound_solve.sweep.study.document import Document
from pound_solve.sweep.study.study import StudyError, read
from standing import Standing
from sweep.small import DECK, Here, folder
from tiers import at_night

#: an oscillator that meets nothing: its peak is proportional to the factor on its motion
LINEAR = (
    DECK.replace("PARAM  k = 4000   gap = 0.01", "PARAM  k = 4000   gap = 9   a = 1   b = 1")
    .replace("SCALE=scale", "SCALE=a+2*b")
    .replace("DRIFT", "DAMPING\n   MODAL XI=0.05\nDRIFT")
)
STUDY = """deck = "wall.inp"

[variables]
a = { distribution = "uniform", low = 0.5, high = 1.5 }
b = { distribution = "uniform", low = 0.5, high = 1.5 }

[uncertainty]
quantities = ["peak_drift"]
runs = 64
"""
#: with contact, under two records
WALL = """deck = "wall.inp"

[variables]
k = { distribution = "lognormal", mean = 4000, cov = 0.3 }
motion = { distribution = "normal", mean = 1, sd = 0.2, low = 0.2 }

[correlation]
k.motion = 0.4

[uncertainty]
runs = 64
limits = { "contact_force" = 6000 }

[[motions]]
files = ["first.txt", "second.txt"]
unit = "M/S2"
"""


def analysed(path, executor=None, stop=None):
    """Evaluation of a study, which may be interrupted after some runs."""
    document = Document.read(str(path))
    aim = uncertainty.aim(document)
    study = read(document, uncertainty.TABLES)
    lane = executor or Here()
    points = Points(Session(study, Engine(lambda: lane, 1, 1, 1, True)))

    def report(state):
        if stop is not None and lane.runs >= stop and not state.ending:
            raise KeyboardInterrupt

    with points.conducted(report):
        runs = uncertainty.UncertaintyAnalysis(points, aim).carry_out()
    sweep = Sweep.open(points.session.write())
    return Evaluation(sweep, {v.name: v.value for v in points.variables}, aim, runs)


def values(evaluation, statistic):
    """Rows of the table of one statistic: by their variable and place, value and ends."""
    t = {name: v.values.tolist() for name, v in evaluation.table().items()}
    return {
        (variable, at if at == at else ""): (value, low, high)
        for what, variable, at, value, low, high in zip(
            t["statistic"], t["variable"], t["at"], t["value"], t["low"], t["high"]
        )
        if what == statistic
    }


@pytest.fixture(scope="module")
def linear(tmp_path_factory):
    study = STUDY + "indices = true\nlimits = { peak_drift = 2 }\n"
    return analysed(folder(tmp_path_factory.mktemp("linear"), study, LINEAR))


def inside(row, true):
    value, low, high = row
    return low <= true <= high and low < value < high


def test_a_linear_oscillator_has_known_statistics(linear):
    """Its peak is c * (a + 2*b): moments, indices, tornado and the probability of a limit follow."""
    c = float(linear.runs.nominal[linear.shown[0]][0]) / 3.0
    assert inside(values(linear, "mean")["", ""], 3.0 * c)
    assert inside(values(linear, "standard deviation")["", ""], c * math.sqrt(5.0 / 12.0))
    for order in ("first order", "total"):
        shares = values(linear, order)
        assert inside(shares["a", ""], 0.2) and inside(shares["b", ""], 0.8)
    tornado = values(linear, "tornado")
    for name, factor in (("a", 1.0), ("b", 2.0)):
        swing = tornado[name, 0.84][0] - tornado[name, 0.16][0]
        assert swing == pytest.approx(0.68 * factor * c, rel=1e-9)
    assert [row[1] for row in linear.of_tornado()] == ["b", "a"]
    at = next(at for _, at in values(linear, "probability") if at == 2.0)
    samples = np.random.default_rng(0).uniform(0.5, 1.5, (2, 200_000))
    assert inside(values(linear, "probability")["", at], (c * (samples[0] + 2 * samples[1]) >= at).mean())
    assert inside(values(linear, "fractile")["", 0.5], 3.0 * c)


def test_statistics_are_those_of_points_and_records(tmp_path):
    evaluation = analysed(folder(tmp_path, WALL))
    sweep = evaluation.sweep
    assert len(sweep) == 2 * (1 + 64 + 5)
    force = sweep["contact_force"][2:130, 0]  # the first two runs are those of the study's values
    (row,) = (r for r in evaluation.of_quantities() if r[0].startswith("contact_force"))
    assert row[2] == pytest.approx(force.mean(), rel=1e-12)
    events = {event: (count, runs) for event, count, runs, *_ in evaluation.of_limits()}
    assert events["contact_force [kN] >= 6000"] == (int((force >= 6000).sum()), 128)
    assert events["contact"] == (int((sweep["closures"][2:130, 0] >= 1).sum()), 128)
    k, motion = sweep["k"][2:130:2], sweep["scale"][2:130:2]
    assert motion.min() >= 0.2 and 0.15 < np.corrcoef(np.log(k), motion)[0, 1] < 0.65
    lines = "\n".join(evaluation.report())
    assert "Gaussian copula" in lines and "under all 2 records" in lines


@pytest.mark.parametrize("stop", [40, *at_night(1, 139)])
def test_an_interrupted_analysis_goes_on_and_ends_the_same(tmp_path, stop):
    """No run is lost or executed twice, and the reports are the same byte by byte."""
    reports = []
    for name, stops in (("whole", ()), ("stopped", (stop,))):
        (tmp_path / name).mkdir()
        path, executor = folder(tmp_path / name, WALL), Here()
        for at in stops:
            with pytest.raises(Interrupted):
                analysed(path, executor, at)
            assert 0 < executor.runs < 140
        evaluation = analysed(path, executor)
        assert executor.runs == 140
        reports.append("\n".join(evaluation.report()))
        reports.append((path.parent / "walls.sweep/sweep.rpt").read_text())
    assert reports[:2] == reports[2:]


@pytest.mark.full
def test_runs_that_fail_are_left_out_and_told(tmp_path):
    """A stiffness below zero has no runs: others give the moments, the intervals take them as either."""
    study = WALL.replace('"lognormal", mean = 4000, cov = 0.3', '"normal", mean = 4000, cov = 0.7')
    study = study.replace("[correlation]\nk.motion = 0.4\n", "")
    evaluation = analysed(folder(tmp_path, study.replace("runs = 64", "runs = 64\nindices = true")))
    failed = int((evaluation.sweep["status"] == "failed").sum())
    assert failed > 0
    (row,) = (r for r in evaluation.of_quantities() if r[0].startswith("contact_force"))
    assert "runs failed" in row[-1] and np.isfinite(row[2])
    told = "\n".join(evaluation.report())
    assert "has no indices: 0 of its runs stopped and" in told
    contact = [x for x in evaluation.of_limits() if x[0] == "contact"]
    ((_, count, runs, _, low, high),) = contact
    assert runs < 256 and low <= count / 256 and high >= (count + 256 - runs) / 256


MISTAKES = (
    ('distribution = "uniform", low = 0.5, high = 1.5 }\nb', "}\nb", "S604", "a has no distribution"),
    ('"uniform", low = 0.5, high = 1.5 }\nb', '"unifrm" }\nb', "S604", "there is no distribution unifrm"),
    ("low = 0.5, high = 1.5 }\nb", "low = 0.5 }\nb", "S604", "uniform needs high"),
    ("low = 0.5, high = 1.5 }\nb", "low = 0.5, high = 1.5, sd = 1 }\nb", "S605", "does not take sd"),
    ('"uniform", low = 0.5, high = 1.5 }\nb', '"normal", mean = 1 }\nb', "S604", "needs sd or cov"),
    ('"uniform", low = 0.5, high = 1.5 }\nb', '"normal", mean = 1, sd = 1, cov = 1 }\nb', "S605", "beside"),
    ('"uniform", low = 0.5, high = 1.5 }\nb', '"gamma", mean = -1, sd = 1 }\nb', "S605", "above zero"),
    ('"uniform", low = 0.5, high = 1.5 }\nb', '"normal", mean = 1, sd = 0 }\nb', "S605", "above zero"),
    ("low = 0.5, high = 1.5 }\nb", "low = 0.5, high = 0.2 }\nb", "S605", "low is below high"),
    ("runs = 64", "runs = 100", "S603", "power of 2"),
    ("runs = 64", 'runs = 100\nsampling = "latin"', "S603", "multiple of 8"),
    ("runs = 64", "runs = 32", "S603", "64 or more"),
    ("runs = 64", "runs = 2097152", "S603", "more than 1000000"),
    ("runs = 64", 'runs = 64\nsampling = "sobl"', "S603", "no sampling sobl"),
    ("runs = 64", "runs = 64\nconfidence = 95", "S603", "between 0 and 1"),
    ("runs = 64", "runs = 64\nseed = -1", "S603", "zero or above"),
    ("runs = 64", "rums = 64", "S602", "no item rums"),
    ("peak_drift", "peak_drft", "S602", "no quantity peak_drft"),
    ("runs = 64", "limits = { drift = 1 }", "S602", "no quantity drift"),
    ("runs = 64", "indices = true\n[correlation]\na.b = 0.5", "S605", "independent variables"),
    ("runs = 64", "[correlation]\na.c = 0.5", "S602", "there is no variable c"),
    ("runs = 64", "[correlation]\na.b = 1", "S603", "between -1 and 1"),
    ("runs = 64", "[correlation]\na.a = 0.1", "S605", "beside itself"),
    ("runs = 64", "[correlation]\na.b = 0.1\nb.a = 0.1", "S605", "two correlations"),
)


@pytest.mark.parametrize("old, new, code, text", MISTAKES)
def test_a_mistake_is_reported_at_its_line(tmp_path, old, new, code, text):
    assert STUDY.count(old) == 1
    path = folder(tmp_path, STUDY.replace(old, new), LINEAR)
    document = Document.read(str(path))
    uncertainty.aim(document)
    with pytest.raises(StudyError) as raised:
        read(document, uncertainty.TABLES)
    (told,) = raised.value.diagnostics
    assert told.code == code and text in str(raised.value)
    assert told.span.file == str(path) and told.span.line >= 4


def test_all_mistakes_are_reported_at_once(tmp_path):
    """Correlations that no three variables have, a deck's mistake, and one of a table."""
    more = 'gap = { distribution = "normal", mean = 9, cov = 0.1 }\nc = {}\n\n[correlation]\n'
    study = STUDY.replace("\n[uncertainty]", more + "a.b = 0.9\na.gap = 0.9\nb.gap = -0.9\n\n[uncertainty]")
    path = folder(tmp_path, study.replace("runs = 64", "runs = 65"), LINEAR)
    document = Document.read(str(path))
    uncertainty.aim(document)
    with pytest.raises(StudyError) as raised:
        read(document, uncertainty.TABLES)
    text = str(raised.value)
    assert "smallest eigenvalue of their matrix is -0.8" in text
    assert "no PARAM c" in text and "c has no distribution" in text and "power of 2" in text


def test_a_quantity_that_the_runs_lack_is_told_before_the_sample(tmp_path, capsys, monkeypatch):
    executor = Here()
    monkeypatch.setattr(executors, "engine", lambda *_: Engine(lambda: executor, 1, 1, 1, True))
    path = folder(tmp_path, STUDY.replace("peak_drift", "storey_drift"), LINEAR)
    assert main(["uncertainty", str(path)]) == 2
    assert "its runs have no storey_drift: they have" in capsys.readouterr().err
    assert executor.runs == 1


def test_the_verb_writes_its_files(tmp_path, capsys, monkeypatch):
    pytest.importorskip("matplotlib")
    executor = Here()
    monkeypatch.setattr(executors, "engine", lambda *_: Engine(lambda: executor, 1, 1, 1, True))
    path, picture = folder(tmp_path, WALL), tmp_path / "pictures/tornado.svg"
    assert main(["uncertainty", str(path), "--picture", str(picture)]) == 0
    out = capsys.readouterr().out
    assert "84 %" in out and "140 runs: 140 done" in out
    assert "contact force [kN]" in picture.read_text()
    results = path.parent / "walls.sweep"
    report = (results / "uncertainty.rpt").read_text()
    assert "UNCERTAINTY" in report and "event" in report
    table = (results / "uncertainty.csv").read_text().splitlines()
    assert table[0] == "quantity,unit,statistic,variable,at,value,low,high"
    assert main(["uncertainty", str(path), "--quiet"]) == 0
    assert executor.runs == 140 and (results / "uncertainty.rpt").read_text() == report
    assert main(["sweep", str(path)]) == 2
    assert "is a table of pound-solve uncertainty" in capsys.readouterr().err


@pytest.mark.full
def test_an_analysis_that_is_killed_goes_on_where_it_was(tmp_path):
    pytest.importorskip("fcntl", reason="kills by signals")
    path = folder(tmp_path, WALL)
    words = ["uncertainty", str(path), "--workers", "2", "--quiet"]
    for calls in (5, 60):
        run = Standing("pound_solve.sweep.execution.conduct Conductor _count", calls, words)
        assert run.stands()
        run.kill()
    status, errors = Standing("pound_solve.sweep.plan lines", 1, words).end()
    assert status == 0, errors
    lines = [
        line
        for file in Path(tmp_path, "walls.sweep/runs").glob("*.jsonl")
        for line in file.read_text().splitlines()
    ]
    identities = [json.loads(line)["identity"] for line in lines]
    assert len(identities) == len(set(identities)) == 140
    assert (tmp_path / "walls.sweep/uncertainty.rpt").is_file()
