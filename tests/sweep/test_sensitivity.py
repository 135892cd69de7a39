"""Sensitivities: homogeneous functions, missing derivatives, records, resumption, mistakes."""

import math
from pathlib import Path

import pytest

from pound_solve.cli.main import main
from pound_solve.results.sweep_file import Sweep
from pound_solve.sensitivity import study as sensitivity
from pound_solve.statistics.over_records import MEAN, OverRecords
from pound_solve.sweep.execution.executors import Engine
from pound_solve.sweep.points import Interrupted, Points
from pound_solve.sweep.session import Session
from pound_solve.sweep.study.document import Document
from pound_solve.sweep.study.study import StudyError, read
from pound_solve.sweep.study.variables import TABLE
from sweep.small import DECK, Here, folder
from tiers import at_night

#: a hinge that yields, before a wall
YIELDS = DECK.replace("scale = 1", "fy = 120   kc = 1E6   w = 981   xi = 0.05")
YIELDS = YIELDS.replace("KX=k", "RULE=BILINEAR KX=k FX=fy R=0.1").replace("2 981", "2 w")
YIELDS = YIELDS.replace("LAW=KELVIN_VOIGT K=1E6 E=0.65", "LAW=LINEAR K=kc").replace(" SCALE=scale", "")
YIELDS = YIELDS.replace("DRIFT\n", "DAMPING\n   MODAL XI=xi\nDRIFT\n").replace("HISTORY 1", "HISTORY 3")
STUDY = """deck = "wall.inp"

[variables]
{variables}

[[motions]]
files = ["first.txt", "second.txt"]
unit = "M/S2"

[sensitivity]
quantities = {quantities}
{more}
"""
ALL = "\n".join(f"{name} = {{}}" for name in ("gap", "k", "fy", "kc", "w", "xi", "motion"))


def study(
    tmp_path, variables=ALL, quantities='["contact_force", "peak_drift storey"]', more="", deck=YIELDS
):
    text = STUDY.format(variables=variables, quantities=quantities, more=more)
    return folder(tmp_path, text, deck)


def analysed(path, executor=None, stop=None):
    """Sensitivities of a study, and its session."""
    executor = executor or Here()

    def report(state):
        if stop is not None and executor.runs >= stop and not state.ending:
            raise KeyboardInterrupt

    document = Document.read(str(path))
    aim = sensitivity.aim(document)
    read_study = read(document, (TABLE, sensitivity.TABLE), check=sensitivity.check_steps)
    session = Session(read_study, Engine(lambda: executor, 1, 1, 1, True))
    points = Points(session)
    with points.conducted(report):
        return sensitivity.SensitivityAnalysis(aim).carry_out(points), session


def by_name(analysis, record=None):
    """Sensitivities by quantity and variable."""
    return {(s.asked.quantity, s.variable): s for s in analysis.lines if record in (None, s.record)}


@pytest.mark.parametrize("record", ["first.txt", "second.txt"])
def test_elasticities_of_a_homogeneous_response_add_up(tmp_path, record):
    """A peak force is of the first degree in all stiffnesses, strengths and masses, and in the motion with
    gap and strength; a drift of degree zero and one (Euler's theorem): the elasticities add up to it.
    """
    analysis, _ = analysed(study(tmp_path))
    lines = by_name(analysis, record)
    assert not any(line.derivative.reason for line in lines.values())
    for quantity, scaled, driven in (("contact_force", 1.0, 1.0), ("peak_drift", 0.0, 1.0)):
        e = {
            name: lines[quantity, name].elasticity for name in ("gap", "k", "fy", "kc", "w", "xi", "motion")
        }
        error = {name: lines[quantity, name].elasticity_error for name in e}
        assert max(error.values()) < 1e-4
        for names, degree in ((("k", "kc", "fy", "w"), scaled), (("motion", "gap", "fy"), driven)):
            total, bound = sum(e[n] for n in names), sum(error[n] for n in names)
            assert abs(total - degree) <= bound
        if quantity == "contact_force":
            assert min(abs(e["gap"]), abs(e["fy"]), abs(e["kc"])) > 1e-3


def test_exact_derivatives_lie_within_the_bounds_of_differences(tmp_path):
    """All kinds of variables, the factor on the records among them; two kinds of derivatives."""
    quantities = '["contact_force", "peak_drift", "impulse", "contact_loss"]'
    exact, session = analysed(study(tmp_path, ALL, quantities, 'method = "exact"'))
    other = tmp_path / "differences"
    other.mkdir()
    differences, _ = analysed(study(other, ALL, quantities))
    for one, two in zip(exact.lines, differences.lines, strict=True):
        assert one.derivative.exact == (one.asked.quantity != "contact_loss")
        assert not two.derivative.exact and one[:4] == two[:4]
        error = abs(one.derivative.slope - two.derivative.slope)
        assert error <= two.derivative.error + 1e-12 * abs(two.derivative.value / two.at)
        assert one.derivative.error <= 1e-4 * abs(one.derivative.value / one.at)
    assert not exact.remarks
    assert all(run.variables == () for run in session.study.runs)


def test_a_run_without_exact_derivatives_has_those_of_differences(tmp_path, capsys):
    deck = YIELDS.replace("LAW=LINEAR K=kc", "LAW=HERTZ K=kc")
    path = study(tmp_path, "kc = {}", '["contact_force"]', 'method = "exact"', deck)
    assert main(["sensitivity", str(path), "--workers", "1"]) == 0
    printed = capsys.readouterr().out
    assert "no exact derivatives: EXACT needs straight branches, and HERTZ" in " ".join(printed.split())
    analysis, _ = analysed(path)
    assert not any(s.derivative.exact or s.derivative.reason for s in analysis.lines)


def test_exact_derivatives_that_disagree_are_replaced(tmp_path, monkeypatch):
    """As a fault of the program would make them."""
    slopes_of = sensitivity.slopes_of

    def wrong(values, quantity, label, names):
        slopes = slopes_of(values, quantity, label, names)
        return slopes and [1.001 * slopes[0], *slopes[1:]]

    monkeypatch.setattr(sensitivity, "slopes_of", wrong)
    analysis, _ = analysed(study(tmp_path, "gap = {}\nk = {}", '["contact_force"]', 'method = "exact"'))
    assert not any(s.derivative.exact for s in analysis.lines)
    assert {text for _, text in analysis.remarks} == {"contact_force disagrees with differences"}


def test_an_elastic_response_is_proportional_to_its_motion(tmp_path):
    deck = YIELDS.replace("gap = 0.01", "gap = 9").replace("fy = 120", "fy = 3E9")
    analysis, _ = analysed(
        study(tmp_path, "motion = {}", '["peak_drift", "base_shear", "period"]', deck=deck)
    )
    for line in analysis.lines:
        expected = 0.0 if line.asked.quantity == "period" else 1.0
        assert line.elasticity == pytest.approx(expected, abs=1e-9)
        assert abs(line.elasticity - expected) <= line.elasticity_error


def test_a_collision_that_appears_leaves_no_derivative(tmp_path):
    """The gap is the peak of the free motion: a little less, and there is a collision."""
    free, _ = analysed(
        study(tmp_path, "k = {}", '["needed_gap"]', deck=YIELDS.replace("gap = 0.01", "gap = 9"))
    )
    peak = free.lines[0].derivative.value
    sub = tmp_path / "grazing"
    sub.mkdir()
    deck = YIELDS.replace("gap = 0.01", f"gap = {peak!r}")
    analysis, _ = analysed(
        study(sub, "gap = {}\nmotion = {}", '["contact_force", "peak_drift"]', deck=deck)
    )
    for line in analysis.lines:
        if line.record == "first.txt":
            assert math.isnan(line.derivative.slope) and math.isnan(line.derivative.error)
            assert line.derivative.reason


def test_the_steps_shrink_until_the_events_stay_the_same(tmp_path):
    """A gap 1e-4 of itself above the peak: only steps below have no collision."""
    free, _ = analysed(
        study(tmp_path, "k = {}", '["needed_gap"]', deck=YIELDS.replace("gap = 0.01", "gap = 9"))
    )
    peak = max(line.derivative.value for line in free.lines)
    sub = tmp_path / "near"
    sub.mkdir()
    deck = YIELDS.replace("gap = 0.01", f"gap = {peak * (1 + 3e-4)!r}")
    analysis, _ = analysed(study(sub, "gap = {}", '["peak_drift"]', deck=deck))
    steps = {line.record: line.derivative.step / line.at for line in analysis.lines}
    assert steps == {"first.txt": pytest.approx(1e-3), "second.txt": pytest.approx(1e-4)}
    assert all(line.derivative.slope == 0.0 for line in analysis.lines)


def test_the_mean_and_a_fractile_of_records(tmp_path):
    each, _ = analysed(study(tmp_path, "gap = {}", '["contact_force"]'))
    parts = [line.derivative for line in each.lines]
    mean, _ = analysed(study(tmp_path, "gap = {}", '["contact_force"]', 'records = "mean"'))
    (line,) = mean.lines
    assert line.record == OverRecords(MEAN).text
    assert line.derivative.slope == pytest.approx(sum(p.slope for p in parts) / 2, rel=1e-14)
    assert line.derivative.error == pytest.approx(sum(p.error for p in parts) / 2, rel=1e-14)
    upper, _ = analysed(study(tmp_path, "gap = {}", '["contact_force"]', "records = 0.84"))
    assert upper.lines[0].derivative == max(parts, key=lambda p: p.value)


@pytest.mark.parametrize("stop", [4, *at_night(1, 11)])
def test_an_interrupted_analysis_ends_with_the_same_lines(tmp_path, stop):
    path, executor = study(tmp_path, "gap = {}\nk = {}"), Here()
    with pytest.raises(Interrupted):
        analysed(path, executor, stop)
    analysis, _ = analysed(path, executor)
    total = executor.runs
    other = tmp_path / "whole"
    other.mkdir()
    whole, _ = analysed(study(other, "gap = {}\nk = {}"), count := Here())
    assert analysis.lines == whole.lines and total == count.runs


def test_the_command_writes_report_and_tables(tmp_path, capsys):
    path = study(tmp_path, "gap = {}\nk = {}")
    assert main(["sensitivity", str(path), "--workers", "1"]) == 0
    printed = capsys.readouterr().out
    out = tmp_path / "walls.sweep"
    text = (out / "sensitivity.rpt").read_text()
    assert "contact_force, largest of all [kN]" in printed and "peak_drift, storey [m]" in text
    assert str(out / "sensitivity.csv") in printed
    rows = (out / "sensitivity.csv").read_text().splitlines()
    assert len(rows) == 1 + 2 * 2 * 2 and rows[0].startswith("quantity,label,unit,record,variable,at,value")
    sweep = Sweep.open(out / "sweep.h5")
    assert len(sweep) == 18
    before = [(out / f"sensitivity.{ending}").read_bytes() for ending in ("rpt", "csv")]
    assert main(["sensitivity", str(path), "--workers", "1"]) == 0
    assert [(out / f"sensitivity.{ending}").read_bytes() for ending in ("rpt", "csv")] == before


MISTAKES = (
    ("gap = {}", '["contact_forces"]', "", "S602", "did you mean contact_force"),
    ("gap = {}", "[]", "", "S603", "empty list"),
    ("gap = {}", "3", "", "S603", "takes a text"),
    ("gap = { value = 0.0 }", '["closures"]', "", "S605", "a fraction of it is no step"),
    ("gap = { low = 0.01 }", '["closures"]', "", "S605", "at one of its bounds"),
    ("gap = {}", '["closures"]', 'method = "saltation"', "S603", "method is differences or exact"),
    ("gap = {}", '["closures"]', "step = 1.0", "S603", "step is a fraction"),
    ("gap = {}", '["closures"]', 'records = "all"', "S603", "records is each, mean, or a share"),
    ("gap = {}", '["closures"]', "steps = 3", "S602", "did you mean step"),
)


@pytest.mark.parametrize("variables, quantities, more, code, text", MISTAKES)
def test_a_mistake_is_reported_at_its_line(tmp_path, variables, quantities, more, code, text):
    path = study(tmp_path, variables, quantities, more)
    with pytest.raises(StudyError, match=text) as raised:
        analysed(path)
    assert [d.code for d in raised.value.diagnostics if d.severity == "error"] == [code]


def test_steps_of_unknown_error_are_told(tmp_path, capsys):
    deck = YIELDS.replace("HISTORY 3", "HISTORY 3 METHOD=NEWMARK DT=0.002")
    path = study(tmp_path, "k = {}", '["peak_drift"]', deck=deck)
    assert main(["sensitivity", str(path), "--workers", "1"]) == 0
    assert "steps whose error is not known" in capsys.readouterr().out
    analysis, _ = analysed(study(tmp_path, "gap = {}", '["peak_drift"]'))
    assert not analysis.unknown_error


def test_a_label_that_is_not_there_is_named(tmp_path, capsys):
    assert main(["sensitivity", str(study(tmp_path, "gap = {}", '["contact_force floor"]'))]) == 2
    assert "contact_force has no label floor: there are 2" in capsys.readouterr().err


def test_all_mistakes_come_in_one_pass(tmp_path):
    path = study(tmp_path, "gap = { low = 0.01 }\nkk = {}", '["force"]', "step = 2.0")
    with pytest.raises(StudyError) as raised:
        analysed(path)
    assert [d.code for d in raised.value.diagnostics] == ["S605", "S604", "S602", "S603"]


def test_a_study_without_the_table_asks_for_quantities(tmp_path, capsys):
    path = study(tmp_path)
    Path(path).write_text('deck = "wall.inp"\n[variables]\ngap = {}\n')
    assert main(["sensitivity", str(path)]) == 2
    assert "[sensitivity] names no quantities" in capsys.readouterr().err
