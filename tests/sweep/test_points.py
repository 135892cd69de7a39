"""Runs at points of variables: values, the factor on the records, mistakes, interruption and resumption."""

import numpy as np
import pytest

from pound_solve.statistics.over_records import EACH, MEAN, OverRecords
from pound_solve.sweep.execution.executors import Engine
from pound_solve.sweep.points import Interrupted, Points
from pound_solve.sweep.session import Session
from pound_solve.sweep.study.document import Document
from pound_solve.sweep.study.study import StudyError, read
from pound_solve.sweep.study.variables import TABLE, StudyVariable
from sweep.small import Here, folder, swept

STUDY = """deck = "wall.inp"

[variables]
gap = {}
k = { value = 4200, low = 1 }
motion = {}

[[motions]]
files = ["first.txt", "second.txt"]
unit = "M/S2"
"""
POINTS = ((0.01, 4200.0, 1.0), (0.011, 4200.0, 1.0), (0.01, 4200.0, 1.1))


def points(path, executor, retry=False):
    study = read(Document.read(str(path)), (TABLE,))
    return Points(Session(study, Engine(lambda: executor, 1, 1, 1, True), retry=retry))


def at(path, executor, stop=None):
    """Results at `POINTS`, one point after another; interrupted before a run if asked for."""

    def report(state):
        if stop is not None and executor.runs >= stop and not state.ending:
            raise KeyboardInterrupt

    asked = points(path, executor)
    with asked.conducted(report):
        results = [asked.results([point])[0] for point in POINTS]
    return asked, results


def test_runs_at_points_are_those_of_a_sweep(tmp_path):
    """Each run equals that of a sweep with these PARAMs and this factor, to the last digit."""
    executor = Here()
    asked, results = at(folder(tmp_path, STUDY), executor)
    assert asked.nominal == POINTS[0]
    assert asked.variables[1] == StudyVariable("k", 4200.0, 1.0)
    assert executor.runs == 6 and all(r.done for r in results)
    study = STUDY.split("[variables]")[0] + (
        "[grid]\ngap = [0.01, 0.011]\nk = [4200.0]\n" + STUDY[STUDY.index("[[") :] + "scale = [1, 1.1]\n"
    )
    (tmp_path / "sweep").mkdir()
    session = swept(folder(tmp_path / "sweep", study))
    by_identity = dict(session.journal.values(session.entries))
    for result in results:
        for run, values in zip(result.runs, result.values):
            assert by_identity[run.identity] == values
    assert [run.number for run in asked.session.study.runs] == [1, 2, 3, 4, 5, 6]
    assert asked.session.write().is_file()


@pytest.mark.parametrize("stop", [1, 3, 5])
def test_an_interrupted_call_is_continued(tmp_path, stop):
    """No run is executed twice, and the results are those of a call without interruption."""
    path, executor = folder(tmp_path, STUDY), Here()
    with pytest.raises(Interrupted):
        at(path, executor, stop)
    before = executor.runs
    assert 0 < before < 6
    _, results = at(path, executor)
    assert executor.runs == 6
    _, again = at(path, executor)
    assert executor.runs == 6
    assert [r.values for r in again] == [r.values for r in results]


def test_a_failed_run_is_repeated_once_on_demand(tmp_path):
    path, executor = folder(tmp_path, STUDY.replace("value = 4200, low = 1", "value = 4200")), Here()
    wrong = (0.01, -1.0, 1.0)
    for retry, runs in ((False, 2), (False, 2), (True, 4)):
        asked = points(path, executor, retry)
        with asked.conducted(lambda state: None):
            for _ in range(2):
                (result,) = asked.results([wrong])
                assert not result.done and result.values == ({}, {})
        assert executor.runs == runs


MISTAKES = (
    ("gapp = {}", "S604", "did you mean"),
    ("record = {}", "S605", "is a text"),
    ("gap = 3", "S603", "is a table"),
    ("gap = { values = 1 }", "S602", "did you mean value"),
    ("gap = { low = 3, high = 2 }", "S605", "low is below high"),
    ("k = { low = 5000 }", "S605", "outside of its bounds"),
    ("motion = {}", "S604", "the study has none"),
    ("gap = {}\nGAP = {}", "S605", "has values here"),
    ("", "S604", "names no variables"),
)


@pytest.mark.parametrize("line, code, text", MISTAKES)
def test_a_mistake_is_reported_at_its_line(tmp_path, line, code, text):
    path = folder(tmp_path, f'deck = "wall.inp"\n[variables]\n{line}\n')
    with pytest.raises(StudyError) as raised:
        read(Document.read(str(path)), (TABLE,))
    errors = [d for d in raised.value.diagnostics if d.severity == "error"]
    assert [d.code for d in errors] == [code]
    assert text in str(raised.value)
    assert errors[0].span.file == str(path)


def test_a_value_out_of_the_decks_limits_is_reported_before_any_run(tmp_path):
    path = folder(tmp_path, STUDY.replace("value = 4200, low = 1", "value = -1"))
    with pytest.raises(StudyError, match="P217: KX"):
        read(Document.read(str(path)), (TABLE,))


def test_a_study_with_variables_has_one_deck_and_no_grid(tmp_path):
    more = 'deck = "wall.inp"\nzip = {}\n[grid]\nk = [1, 2]\n[variables]\ngap = {}\n'
    with pytest.raises(StudyError, match="gives several cases") as raised:
        read(Document.read(str(folder(tmp_path, more))), (TABLE,))
    assert len(raised.value.diagnostics) == 2


def test_a_sweep_refuses_variables(tmp_path):
    path = folder(tmp_path, 'deck = "wall.inp"\n[variables]\ngap = {}\n')
    with pytest.raises(StudyError, match="is a table of pound-solve sensitivity, optimize"):
        read(Document.read(str(path)))


def test_a_variable_that_changes_only_the_motion_is_a_mistake(tmp_path):
    path = folder(tmp_path, STUDY.replace("motion = {}", "scale = {}"))
    with pytest.raises(StudyError, match="scale changes nothing in"):
        read(Document.read(str(path)), (TABLE,))


@pytest.mark.parametrize(
    "how, values", [(EACH, [4, 1, 3, 2]), (MEAN, [2.5]), (0.5, [2]), (0.84, [4]), (0.25, [1]), (0.26, [2])]
)
def test_values_of_all_records(how, values):
    assert OverRecords(how).of(np.array([4.0, 1.0, 3.0, 2.0])).tolist() == values


def test_one_study_serves_several_verbs(tmp_path):
    """The tables and items of other verbs are no mistakes beside [variables]."""
    more = "k = {}\n[uncertainty]\nruns = 64\n[calibrate]\n[sensitivity]\n"
    line = 'gap = { distribution = "uniform", low = 0.001, high = 0.02, scale = "log" }\n'
    path = folder(tmp_path, f'deck = "wall.inp"\n[variables]\n{line}{more}')
    study = read(Document.read(str(path)), (TABLE, "sensitivity"))
    assert [v.name for v in study.variables] == ["gap", "k"]
