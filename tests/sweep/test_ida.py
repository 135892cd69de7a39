"""Incremental analyses from a study's file: lines of a linear oscillator, resumed analyses, fragilities."""

import numpy as np
import pytest

from pound_solve.cli.main import main
from pound_solve.report.sweep import incremental
from pound_solve.results.sweep_file import Sweep
from pound_solve.statistics import fractiles
from pound_solve.statistics.curves import Asked, CurveError, curves
from pound_solve.statistics.fragility_of_sweep import fit
from pound_solve.sweep import ida
from pound_solve.sweep.execution.executors import Engine
from pound_solve.sweep.session import Session
from pound_solve.sweep.study.document import Document
from pound_solve.sweep.study.study import StudyError, read
from sweep.small import DECK, Here, folder

XI, OMEGA = 0.05, np.sqrt(4000 / 100.0)  # weight 981 kN
STUDY = """deck = "wall.inp"

[[motions]]
files = ["first.txt", "second.txt"]
unit = "M/S2"
sa = 0.05
period = {period}

[ida]
demand = "peak_drift"
step = 0.1
growth = 0.05
runs = 7
{more}
"""
#: nothing is met, and all motion is that of one oscillator
ALONE = DECK.replace("PARAM  k = 4000   gap = 0.01", "PARAM  k = 4000   gap = 9").replace(
    "DRIFT", f"DAMPING\n   MODAL XI={XI}\nDRIFT"
)
ALONE = ALONE.replace("HISTORY 1", "HISTORY 4")


def study(tmp_path, more="", deck=ALONE):
    return folder(tmp_path, STUDY.format(period=2 * np.pi / OMEGA, more=more), deck)


def analysed(path, executor=None, stop=None):
    """The table of an analysis, whose rounds may be interrupted after some runs."""
    document = Document.read(str(path))
    aim = ida.aim(document)
    own = executor or Here()
    session = Session(read(document, (ida.TABLE,)), Engine(lambda: own, 1, 1, 1, True))

    def report(state):
        if stop is not None and own.runs >= stop and not state.ending:
            raise KeyboardInterrupt

    ida.IncrementalAnalysis(session, aim).carry_out(report)
    return Sweep.open(session.write()), aim


def test_a_linear_oscillator_has_straight_lines(tmp_path):
    """Its demand is Sd(T1), of which the levels are shares: all lines have the slope g / omega^2."""
    sweep, aim = analysed(study(tmp_path))
    (one, other) = curves(sweep, aim.asked)
    assert (one.record, other.record) == ("first.txt", "second.txt")
    for curve in (one, other):
        assert [p.level for p in curve.points] == pytest.approx([0.05, 0.15, 0.3, 0.5, 0.75, 1.05, 1.4])
        for level, demand in curve.points:
            assert demand == pytest.approx(
                level * 9.81 / OMEGA**2, rel=2e-3
            )  # peaks after the end count too
            assert demand / level == pytest.approx(curve.points[0].demand / 0.05, rel=1e-9)
    assert [sweep["number" if "number" in sweep.variables else "run"][i] for i in range(14)] == [
        *range(1, 15)
    ]
    levels = np.linspace(0.1, 1.4, 5)
    found = fractiles.fractiles(fractiles.Analysis((one, other), aim.rules), levels)
    np.testing.assert_allclose(found[:, 1], levels * found[0, 1] / 0.1, rtol=1e-9)


@pytest.mark.full
def test_an_interrupted_analysis_goes_on_and_ends_the_same(tmp_path):
    whole, aim = analysed(
        study(tmp_path / "a" if (tmp_path / "a").mkdir() is None else tmp_path, "limit = 0.2")
    )
    (tmp_path / "b").mkdir()
    path, total = study(tmp_path / "b", "limit = 0.2"), 0
    for stop in (1, 4, 3, 100):
        count = Here()
        sweep, _ = analysed(path, count, stop)
        total += count.runs
    assert total == len(whole) == len(sweep)
    assert curves(sweep, aim.asked) == curves(whole, aim.asked)
    assert sweep["identity"].tolist() == whole["identity"].tolist()


def test_limits_end_the_analysis_and_give_fragilities(tmp_path):
    sweep, aim = analysed(study(tmp_path, "limit = 0.2"))
    slope = [c.points[0].demand / c.points[0].level for c in curves(sweep, aim.asked)]
    (found,) = fit(sweep, aim.asked, [0.1])
    capacities = 0.1 / np.array(slope)
    assert found.method == "capacities" and found.fragility.count == 2
    assert found.fragility.median == pytest.approx(np.exp(np.log(capacities).mean()), rel=1e-6)
    lines = list(incremental.report(sweep, aim.asked, aim.rules))
    assert any("beyond the limit" in line for line in lines)


def test_contact_is_a_demand_like_any_other(tmp_path):
    """A gap that closes at a level known from the linear motion towards the wall."""
    deck = ALONE.replace("gap = 9", "gap = 0.02")
    path = study(tmp_path, deck=deck)
    path.write_text(path.read_text().replace('demand = "peak_drift"', 'demand = "closures"'))
    sweep, _ = analysed(path)
    for curve in curves(sweep, Asked("closures")):
        assert curve.points[0].demand == 0.0 and curve.points[-1].demand >= 1.0
        met = next(p.level for p in curve.points if p.demand >= 1.0)
        assert met * 9.81 / OMEGA**2 > 0.02 * 0.9
    (found,) = fit(sweep, Asked("closures"), [1.0], "stripes")
    assert found.observed[0][1:] == (0, 2) and found.observed[-1][1:] == (2, 2)


@pytest.mark.parametrize(
    ("change", "code", "why"),
    [
        (('demand = "peak_drift"', 'demand = "drft"'), "S602", "no quantity drft"),
        (("step = 0.1", "step = -1"), "S603", "step is above zero"),
        (("step = 0.1\n", ""), "S604", "with step"),
        (("runs = 7", "runs = 1"), "S603", "two or more"),
        (("runs = 7", "rums = 7"), "S602", "no item rums"),
    ],
)
def test_mistakes_of_the_table_have_places(tmp_path, capsys, change, code, why):
    path = study(tmp_path)
    path.write_text(path.read_text().replace(*change))
    document = Document.read(str(path))
    with pytest.raises(StudyError) as told:
        ida.aim(document)
        read(document, (ida.TABLE,))
    (found,) = told.value.diagnostics
    assert found.code == code and why in found.message
    assert path.read_text().splitlines()[found.span.line - 1].lstrip()[:3] in (
        "[id",
        "ste",
        "run",
        "rum",
        "dem",
    )
    assert main(["ida", str(path)]) == 2 and why in capsys.readouterr().err


def test_a_sweep_tells_whose_table_it_is(tmp_path, capsys):
    assert main(["sweep", str(study(tmp_path))]) == 2
    err = capsys.readouterr().err
    assert "walls.toml:9:1: error S602: [ida] is a table of pound-solve ida" in err


def test_what_a_sweep_does_not_hold_is_told(tmp_path):
    sweep, _ = analysed(study(tmp_path))
    for asked, why in (
        (Asked("drift"), "there is no quantity drift"),
        (Asked("peak_drift", "roof"), "storey"),
    ):
        with pytest.raises(CurveError, match=why):
            curves(sweep, asked)
    with pytest.raises(CurveError, match="--limit"):
        fit(sweep, Asked("peak_drift"), [])


@pytest.mark.full
def test_the_verbs_print_tables(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("POUND_COMPILE", "0")
    path = study(tmp_path, "limit = 0.2")
    analysed(path)
    picture = tmp_path / "pictures/ida.svg"
    assert main(["ida", str(path), "--workers", "1", "--picture", str(picture)]) == 0
    assert "peak drift storey" not in picture.read_text() and "peak drift [m]" in picture.read_text()
    out = capsys.readouterr().out
    assert "highest level" in out and "84 %" in out and "14 of them before" in out
    file = str(tmp_path / "walls.sweep/sweep.h5")
    words = ["fragility", file, "--demand", "peak_drift"]
    picture = tmp_path / "pictures/fragility.svg"
    assert main([*words, "--limit", "0.05,0.1", "--at", "0.2,0.5", "--picture", str(picture)]) == 0
    assert "limit 0.1" in picture.read_text()
    out = capsys.readouterr().out
    assert "dispersion" in out and "fewer than 10 data" in out
    assert "Runs: 14 of the 14 in the sweep; sa " in out
    assert (tmp_path / "walls.sweep/fragility_peak_drift_0.05_0.1.rpt").is_file()
    assert main(words) == 2
    assert main(["fragility", file, "--limit", "x"]) == 2
