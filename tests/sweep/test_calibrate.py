"""Calibrations: a synthetic test is recovered, intervals, peaks, starts, resumption, mistakes."""

import math

import numpy as np
import pytest

from pound_solve.cli.main import main
from pound_solve.results.sweep_file import Sweep
from pound_solve.statistics.curves import CurveError
from pound_solve.sweep import calibrate
from pound_solve.sweep.execution.executors import Engine
from pound_solve.sweep.points import Interrupted, Points
from pound_solve.sweep.session import Session
from pound_solve.sweep.study import measured
from pound_solve.sweep.study.document import Document
from pound_solve.sweep.study.study import StudyError, read
from pound_solve.sweep.study.variables import TABLE
from sweep.small import DECK, Here, folder, swept
from tiers import at_night

PLAIN = DECK.replace("scale = 1", "kc = 1E6   e = 0.65").replace("K=1E6 E=0.65", "K=kc E=e")
PLAIN = PLAIN.replace(" SCALE=scale", "").replace("ANALYSIS", "OUTPUT\n   EVERY=0.002\nANALYSIS")
TRUE = {"kc": 1e6, "e": 0.65}
SD = 40.0  #: of the errors of the synthetic measurement [kN]; the peak is near 5000 kN
STUDY = """deck = "wall.inp"

[variables]
kc = {{ value = 6E5, low = 1E5, high = 1E7, scale = "log" }}
e = {{ value = 0.8, low = 0.3, high = 0.95 }}

{measured}

[calibrate]
{more}
"""
HISTORY = """[[measured]]
history = "contact/force"
label = "2"
file = "test.csv"
"""


def test_file(path, seed, sd=SD, every=1):
    """Write the force of the true run with errors to a file."""
    where = path / "true"
    if not where.is_dir():
        where.mkdir()
        study = 'deck = "wall.inp"\nhistories = ["contact/force"]\n[grid]\nkc = [1E6]\n'
        swept(folder(where, study, PLAIN)).write()
    time, rows, _ = Sweep.open(where / "walls.sweep" / "sweep.h5").history(1, "contact/force")
    force = rows[:, 0] + np.random.default_rng(seed).normal(0.0, sd, len(time)) * (sd > 0.0)
    lines = [f"{t:.6f}, {f!r}" for t, f in zip(time.tolist(), force.tolist())][::every]
    (path / "test.csv").write_text("time, force\n[s], [kN]\n" + "\n".join(lines) + "\n")


test_file.__test__ = False


def study(tmp_path, items=HISTORY, more="", deck=PLAIN):
    return folder(tmp_path, STUDY.format(measured=items, more=more), deck)


def calibrated(path, executor=None, stop=None):
    """Result of a calibration."""
    executor = executor or Here()

    def report(state):
        if stop is not None and executor.runs >= stop and not state.ending:
            raise KeyboardInterrupt

    document = Document.read(str(path))
    aim = calibrate.aim(document)
    tables = (TABLE, measured.TABLE, calibrate.TABLE)
    points = Points(Session(read(document, tables), Engine(lambda: executor, 1, 1, 1, True)))
    with points.conducted(report):
        return calibrate.CalibrationAnalysis(points, aim).carry_out()


def test_a_history_without_errors_gives_the_true_values(tmp_path):
    path = study(tmp_path)
    test_file(tmp_path, 0, sd=0.0)
    result = calibrated(path)
    for v in result.variables:
        assert v.value == pytest.approx(TRUE[v.name], rel=1e-7)
        assert v.low <= v.value <= v.high and v.high - v.low < 1e-6 * v.value
    (m,) = result.fits
    assert m.scatter < 1e-4 and m.unit == "kN" and not m.is_peak


def test_the_true_values_lie_in_the_intervals(tmp_path):
    path = study(tmp_path, HISTORY + f"sd = {SD}\n")
    test_file(tmp_path, 1)
    result = calibrated(path)
    for v in result.variables:
        assert v.low < TRUE[v.name] < v.high
        assert 0.0 < v.high - v.low < 0.05 * v.value
    assert result.scatter == pytest.approx(1.0, abs=0.15) and result.known
    assert result.fits[0].scatter == pytest.approx(SD, rel=0.15)


@pytest.mark.slow
def test_of_synthetic_tests_95_percent_are_recovered_within_their_intervals(tmp_path):
    """Of 50 intervals of 95 % at least 44, the fractile of 1 % of a binomial."""
    path, inside = study(tmp_path), 0
    for seed in range(25):
        test_file(tmp_path, seed)
        inside += sum(v.low <= TRUE[v.name] <= v.high for v in calibrated(path).variables)
    assert inside >= 44


def test_peaks_with_known_deviations(tmp_path):
    (tmp_path / "peaks").mkdir()
    true = swept(folder(tmp_path / "peaks", 'deck = "wall.inp"\n[grid]\nkc = [1E6]\n', PLAIN))
    ((_, values),) = true.journal.values(true.entries)
    items = "".join(
        f'[[measured]]\nquantity = "{name} 2"\nvalue = {value!r}\nsd = {0.01 * value!r}\n'
        for name in ("contact_force", "impulse", "penetration")
        for value in [values[name]["2"]]
    )
    result = calibrated(study(tmp_path, items))
    for v in result.variables:
        assert v.value == pytest.approx(TRUE[v.name], rel=1e-5)
        assert 0.005 * v.value < v.high - v.low < 0.5 * v.value
    assert [m.is_peak for m in result.fits] == [True] * 3


def test_starts_that_agree(tmp_path):
    path = study(tmp_path, more="starts = 2", deck=PLAIN)
    test_file(tmp_path, 2)
    result = calibrated(path)
    assert len(result.starts) == 2
    assert max(s.cost for s in result.starts) == pytest.approx(min(s.cost for s in result.starts), rel=1e-6)


def test_a_variable_at_its_bound(tmp_path):
    path = study(tmp_path)
    test_file(tmp_path, 2)
    path.write_text(path.read_text().replace("high = 0.95", "high = 0.5").replace("0.8", "0.4"))
    kc, e = calibrated(path).variables
    assert e.remark == "at its upper bound" and math.isnan(e.low) and e.value == pytest.approx(0.5)
    assert kc.remark == ""


def test_a_variable_without_effect_has_no_interval(tmp_path):
    deck = PLAIN.replace("e = 0.65", "e = 0.65   other = 3")
    path = study(tmp_path, deck=deck)
    lines = [line for line in path.read_text().splitlines() if not line.startswith("kc")]
    path.write_text("\n".join(lines).replace("[variables]", "[variables]\nother = { low = 1, high = 4 }"))
    test_file(tmp_path, 2)
    assert {v.remark for v in calibrated(path).variables} == {"the measured values do not determine it"}


@pytest.mark.parametrize("stop", [13, *at_night(1)])
def test_an_interrupted_calibration_ends_with_the_same_result(tmp_path, stop):
    path, executor = study(tmp_path), Here()
    test_file(tmp_path, 3)
    with pytest.raises(Interrupted):
        calibrated(path, executor, stop)
    result = calibrated(path, executor)
    (tmp_path / "whole").mkdir()
    other = study(tmp_path / "whole")
    test_file(tmp_path / "whole", 3)
    whole = calibrated(other, count := Here())
    assert executor.runs == count.runs
    assert result.variables == whole.variables and result.starts == whole.starts


def test_the_command_writes_report_and_tables(tmp_path, capsys):
    path = study(tmp_path)
    test_file(tmp_path, 1)
    assert main(["calibrate", str(path), "--workers", "1"]) == 0
    printed = capsys.readouterr().out
    out = tmp_path / "walls.sweep"
    assert "95 % interval" in printed and "pound-solve wall.inp --set kc=" in printed
    text = (out / "calibrate.rpt").read_text()
    assert "CALIBRATION" in text and "contact/force 2" in text
    rows = (out / "calibrate.csv").read_text().splitlines()
    assert rows[0] == "measured,record,unit,time,value,fitted" and len(rows) == 502


MISTAKES = (
    (HISTORY.replace("contact/force", "contact/forces"), "", "S602", "did you mean contact/force"),
    (HISTORY.replace("test.csv", "tests.csv"), "", "S604", "tests.csv cannot be read"),
    (HISTORY + "value = 3\n", "", "S605", "value belongs to a quantity"),
    (HISTORY + "columns = [1]\n", "", "S603", "columns are two numbers"),
    (HISTORY + "columns = [1, 3]\n", "", "S605", "no lines of numbers"),
    (HISTORY + "sd = -1.0\n", "", "S603", "sd is above zero"),
    ('[[measured]]\nquantity = "contact_force"\n', "", "S604", "has no value"),
    ("[[measured]]\nsd = 3.0\n", "", "S605", "of a quantity or of a history"),
    ("", "", "S604", "the study has no measured values"),
    (HISTORY + '[[measured]]\nquantity = "impulse"\nvalue = 3\nsd = 1\n', "", "S604", "sd tells how much"),
    (HISTORY, "starts = 0", "S603", "starts is a number from 1"),
    (HISTORY, "confidence = 1.0", "S603", "confidence is between 0 and 1"),
    (HISTORY, "start = 3", "S602", "did you mean starts"),
)


@pytest.mark.parametrize("items, more, code, text", MISTAKES)
def test_a_mistake_is_reported_at_its_line(tmp_path, items, more, code, text):
    path = study(tmp_path, items, more)
    test_file(tmp_path, 1)
    with pytest.raises(StudyError, match=text) as raised:
        calibrated(path)
    assert [d.code for d in raised.value.diagnostics if d.severity == "error"] == [code]


@pytest.mark.parametrize(
    "line, text",
    [
        ("1, 2\n1, 3\n", "line 2: times increase"),
        ("1, 2\n2, x\n", "line 2: no numbers"),
        ("1, 2\n2\n", "line 2: no numbers"),
        ("1, 2\n2, nan\n", "line 2: times increase"),
    ],
)
def test_a_damaged_line_of_the_file_is_named(tmp_path, line, text):
    path = study(tmp_path)
    (tmp_path / "test.csv").write_text(line)
    with pytest.raises(StudyError, match=text):
        calibrated(path)


@pytest.mark.parametrize("low, text", [("", "needs low and high"), ("low = 0.0, ", "needs low above zero")])
def test_bounds_are_needed_and_fit_the_scale(tmp_path, low, text):
    path = study(tmp_path)
    test_file(tmp_path, 1)
    path.write_text(path.read_text().replace("low = 1E5, ", low))
    with pytest.raises(StudyError, match=text):
        calibrated(path)


def test_a_label_or_a_record_that_is_not_there_is_named(tmp_path):
    path = study(tmp_path, HISTORY.replace('"2"', '"3"'))
    test_file(tmp_path, 1)
    with pytest.raises(CurveError, match="no label 3: there are 2"):
        calibrated(path)
    path = study(tmp_path, HISTORY + 'record = "x"\n')
    with pytest.raises(CurveError, match="no record x: the motion is that of the deck"):
        calibrated(path)
