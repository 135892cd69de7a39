"""The report of a sweep: counts, failures, fractiles by hand, worst runs, the same text whoever ran it."""

import math

import numpy as np
import pytest

from pound_solve.check import COLUMNS, Subject, at_most
from pound_solve.report.sweep import summary
from pound_solve.results.sweep_file import Sweep, Variable
from pound_solve.sweep.study import quantities
from sweep.small import folder, swept


def made(drift, status, doubt=("",) * 6, message=("",) * 6):
    """Two gaps under three records; the drift of two storeys."""
    n = len(drift)
    texts = {"status": status, "message": message, "doubt": doubt, "deck": ["pair.inp"] * n}
    texts["record"] = [f"{i}.at2" for i in (1, 2, 3)] * 2
    variables = {
        "run": Variable(np.arange(1, n + 1)),
        **{name: Variable(np.array(own, object)) for name, own in texts.items()},
        "scale": Variable(np.ones(n)),
        "gap": Variable(np.repeat([0.01, 0.02], 3), doc="PARAM gap"),
        "reached": Variable(np.array([20.0] * n)),
        "drift_ratio": Variable(np.array(drift), "drift", "-", "largest"),
        "energy_residual": Variable(np.array([1e-14, 2e-14, np.nan, 5e-14, 1e-15, 1e-15])),
    }
    about = {"study": "gaps.toml", "program_version": "9.9", "units": "kN m s"}
    return Sweep(variables, {"drift": ("left", "right")}, about)


DRIFT = [[0.01, 0.02], [0.05, 0.01], [math.nan] * 2, [0.03, 0.04], [0.02, 0.02], [0.06, -0.09]]
STATUS = ["done", "done", "failed", "done", "stopped", "done"]


def test_fractiles_take_the_largest_label_and_stopped_runs_as_infinite():
    rows = {row[1]: row[2:] for row in summary.fractiles(made(DRIFT, STATUS))}
    assert rows == {
        "gap=0.01, scale 1": (2, 0.02, 0.02, 0.05),
        "gap=0.02, scale 1": (3, 0.04, 0.09, math.inf),
    }


def test_the_largest_of_several_estimates_is_kept():
    values = {"drifts": 2e-4, "accelerations": math.nan, "forces": 1e-5}
    checks = [at_most(Subject.ERROR, kind, value, 1e-3, "not shown") for kind, value in values.items()]
    rows = [dict(zip(COLUMNS, check.row())) for check in checks]
    assert quantities.taken({"checks": rows}) == {"error_estimate": {"": 2e-4}}
    assert quantities.doubts({"checks": rows}) == "accelerations: nan, at most 0.001; not shown"


def test_groups_are_as_fine_as_the_runs_allow():
    """Each record at a level of its own, as in an incremental analysis: the runs of a case go together."""
    own = made(DRIFT, STATUS)
    levels = {**own.variables, "scale": Variable(np.array([1.0, 1.0, 2.0, 1.0, 1.0, 3.0]))}
    rows = [row[1] for row in summary.fractiles(Sweep(levels, own.labels, own.about))]
    assert rows == ["gap=0.01", "gap=0.02"]
    alone = {**levels, "gap": Variable(np.arange(6.0), doc="PARAM gap")}
    assert [row[1] for row in summary.fractiles(Sweep(alone, own.labels, own.about))] == ["all runs"]


def test_the_text_tells_what_was_run_what_failed_and_where_to_look():
    message = ["", "", "R401 no such record\nmore", "", "A502 at t = 4 s", ""]
    doubt = ["", "", "", "residual: 2e-2, look: energy is made", "", ""]
    text = summary.text(made(DRIFT, STATUS, doubt, message), "sweep", ["what was made of it"])
    assert text.isascii() and max(map(len, text.splitlines())) <= 132
    flat = " ".join(text.split())
    for told in (
        "Study gaps.toml",
        "6: 4 done, 1 failed, 1 stopped",
        "gap 0.01, 0.02",
        "records 1.at2, 2.at2, 3.at2",
        "3 gap=0.01, 3.at2, scale 1 failed R401 no such record 5",
        "5 gap=0.02, 2.at2, scale 1 stopped A502 at t = 4 s",
        "drift_ratio 0.09 right 6 gap=0.02, 3.at2, scale 1",
        "of its run: 5.0e-14, run 4",
        "call for a look: 1 of 6",
        "residual: 2e-2, look: energy is made",
        "3 SWEEP",
        "what was made of it",
    ):
        assert told in flat, told
    assert "more:" not in flat and "inf" in flat


def test_many_failures_are_cut(tmp_path):
    n = summary.ROWS + 7
    own = {
        "run": Variable(np.arange(1, n + 1)),
        **{
            name: Variable(np.array([value] * n, object))
            for name, value in (("status", "failed"), ("message", "why"), ("doubt", ""), ("deck", "a.inp"))
        },
        "reached": Variable(np.full(n, np.nan)),
    }
    sweep = Sweep(own, {}, {"study": "s", "program_version": "1", "units": "kN m s"})
    assert len(summary.failures(sweep)) == summary.ROWS + 1
    assert "and 7 more" in summary.text(sweep, "sweep") and "FRACTILES" not in summary.text(sweep, "sweep")


@pytest.mark.full
def test_a_sweep_leaves_its_report_and_pieces_leave_the_same(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    whole = swept(folder(tmp_path / "a")).write().with_suffix(".rpt").read_bytes()
    path = folder(tmp_path / "b")
    for k in (2, 1):
        swept(path, piece=(k, 2))
    assert swept(path).write().with_suffix(".rpt").read_bytes() == whole
    assert b"contact_force" in whole and b"16:" in whole
