"""STUDY: errors, orders and extrapolation by hand; advice that holds for motions it has not seen."""

import itertools
import math
import sys
import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from kernels import steps_alone
from pound_solve.assess import advice, study
from pound_solve.assess.advice import MethodStudyError
from pound_solve.assess.study import Plan
from pound_solve.cli.main import main
from pound_solve.driver import run
from pound_solve.results import Results
from pound_solve.results.study_record import MethodTrial, Reference, order
from tiers import at_night

pytestmark = pytest.mark.full

EXAMPLES = Path(__file__).parents[2] / "examples"
TWO = (
    (EXAMPLES / "01_two_oscillators/two_oscillators.inp").read_text().replace("HISTORY   5", "HISTORY   3")
)
SHAKE = "SINE      AMPLITUDE=1  PERIOD=0.6  DURATION=3"
#: motions that close the gap, unlike each other in period, strength and number of collisions
OTHERS = (
    "SINE AMPLITUDE=1.5 PERIOD=0.45 DURATION=2",
    "SINE AMPLITUDE=-1 PERIOD=0.7 DURATION=3",
    "SYNTHETIC PGA=4 SEED=2 DURATION=4",
)
NONE = {"drift": math.nan, "member": math.nan, "contact": math.nan}


def write(folder, motion=SHAKE):
    """Write the two oscillators under a motion; return what to ask for."""
    path = folder / "two.inp"
    path.write_text(TWO.replace(SHAKE, motion))
    return run.Request(str(path), out=folder)


@pytest.fixture
def two(tmp_path):
    return write(tmp_path)


LADDER = Plan(("EXACT", "NEWMARK", "CENTRAL"), steps=tuple(0.005 / 2**k for k in range(7)), repeat=1)


@pytest.fixture(scope="module")
def studied(tmp_path_factory):
    """The study of the two oscillators under the motion of the example."""
    return study.run(write(tmp_path_factory.mktemp("study")), LADDER)[0]


def trial(steps, error, seconds=0.1, method="NEWMARK", stopped=""):
    found = {} if stopped else {**NONE, "drift": error}
    return MethodTrial(
        method, f"DT={1 / steps if steps else 0:g}", (seconds,), steps, errors=found, stopped=stopped
    )


EXACTLY = Reference({("drift", ""): np.array([1.0])}, {**NONE, "drift": 0.0}, "by hand")


def test_an_error_is_the_largest_difference_over_the_largest_extreme_of_its_kind_and_unit():
    true = {
        ("drift", ""): np.array([0.1, -0.2]),
        ("member", "kN"): np.array([100.0, 1.0]),
        ("member", "kN*m"): np.array([4.0]),
        ("contact", ""): np.array([0.0]),
    }
    found = {
        ("drift", ""): np.array([0.11, -0.2]),
        ("member", "kN"): np.array([100.0, 2.0]),
        ("member", "kN*m"): np.array([4.4]),
        ("contact", ""): np.array([0.0]),
    }
    assert advice.errors(found, true) == pytest.approx(
        {"drift": 0.05, "member": 0.1, "contact": math.nan}, rel=1e-12, nan_ok=True
    )
    found["contact", ""] += 3.0  # a collision that the reference does not have
    assert advice.errors(found, true)["contact"] == math.inf


def test_extrapolation_finds_the_limit_of_what_shrinks_with_the_square_of_the_step():
    def rung(n, cubic=0.0):
        values = np.array([2.0 + 3.0 / n**2 + cubic / n**3, -1.0 + 1.0 / n**2])
        return MethodTrial("NEWMARK", f"DT={1 / n}", steps=n, peaks={("drift", ""): values})

    found = advice.extrapolated("NEWMARK", [rung(10), rung(20), rung(45)])
    assert found.peaks["drift", ""] == pytest.approx([2.0, -1.0], abs=1e-14)
    assert found.doubt < 1e-14
    # where higher powers take part, the limit is off by less than the estimate
    rough = advice.extrapolated("NEWMARK", [rung(n, 20.0) for n in (10, 20, 40)])
    off = advice.errors(rough.peaks, {("drift", ""): np.array([2.0, -1.0])})["drift"]
    assert 0.1 * rough.doubt < off < rough.doubt


def test_a_reference_needs_three_runs():
    rungs = [trial(10, 0.1), trial(20, 0.0, stopped="A503 no equilibrium"), trial(40, 0.1)]
    with pytest.raises(MethodStudyError, match="A503"):
        advice.extrapolated("NEWMARK", rungs)


def test_the_order_is_that_between_two_rungs_by_the_steps_they_took():
    assert order(trial(10, 0.09), trial(30, 0.01)) == pytest.approx(2.0)
    assert math.isnan(order(trial(10, 0.0), trial(20, 0.01)))
    assert math.isnan(order(trial(10, 0.1), trial(10, 0.01)))


def test_a_tolerance_has_no_order():
    """It shortens some steps and not those that end with the record's."""
    rungs = trial(3726, 3.7e-4), trial(3743, 8.5e-5)
    by_tolerance = tuple(replace(t, method="LAGUERRE", setting=f"TOL={t.error:g}") for t in rungs)
    orders = study.MethodStudy(rungs + by_tolerance, EXACTLY, ()).orders
    assert [math.isnan(x) for x in orders] == [True, False, True, True]


def test_advice_does_not_trust_an_error_that_happens_to_be_small():
    smooth = [trial(10 * 2**k, 0.01 / 4**k) for k in range(4)]
    assert advice.allowed(smooth, EXACTLY) == pytest.approx([advice.MARGIN * t.error for t in smooth])
    lucky = [smooth[0], replace(smooth[1], errors={**NONE, "drift": 1e-9}), *smooth[2:]]
    # its neighbours say what it would have been without luck
    assert advice.allowed(lucky, EXACTLY)[1] == pytest.approx(advice.MARGIN * smooth[1].error)
    # finer steps that do worse spoil all coarser ones
    bad = [*smooth, trial(10 * 2**4, 0.5)]
    assert min(advice.allowed(bad, EXACTLY)) >= advice.MARGIN * 0.5
    doubtful = replace(EXACTLY, error={**NONE, "drift": 1e-3})
    assert advice.allowed(smooth, doubtful)[3] > 1e-3


def test_advice_takes_the_least_time_that_meets_the_target():
    trials = [
        trial(0, 0.0, 0.5, "EXACT"),
        trial(100, 1e-3, 0.1),
        trial(200, 2.5e-4, 0.2),
        trial(400, 6e-5, 0.9),
        trial(100, 0.0, math.nan, "CENTRAL", "A502 too long a step"),
    ]
    one, tenth, fine = advice.advise(trials, EXACTLY)
    assert (one.trial, tenth.trial, fine.trial) == (trials[1], trials[0], trials[0])
    assert str(one).startswith("1 %: NEWMARK DT=0.01") and str(fine).startswith("1e-6: EXACT")
    assert advice.advise(trials[1:], EXACTLY)[2].trial is None
    # a fifth of the time more is no reason to take the larger error
    alike = [trial(0, 0.0, 0.12, "EXACT"), *trials[1:]]
    assert advice.advise(alike, EXACTLY)[0].trial == alike[0]
    apart = [trial(0, 0.0, 0.13, "EXACT"), *trials[1:]]
    assert advice.advise(apart, EXACTLY)[0].trial == apart[1]


def test_no_step_is_named_where_no_contact_closed(tmp_path):
    request = write(tmp_path, "SINE AMPLITUDE=0.01 PERIOD=0.6 DURATION=1")
    found, _ = study.run(request, Plan(("EXACT", "NEWMARK"), steps=(0.005, 0.0025), repeat=1))
    assert found.reference.unseen
    assert {a.trial.method for a in found.advice} == {"EXACT"} and "no step is named" in found.sentence
    found, _ = study.run(request, Plan(("NEWMARK",), steps=(0.005, 0.0025, 0.00125), repeat=1))
    assert {a.trial for a in found.advice} == {None} and "stronger motion" in found.sentence


def test_errors_fall_with_the_order_of_the_methods_and_both_references_agree(two, studied):
    for method in ("NEWMARK", "CENTRAL"):
        rungs = [t for t in studied.trials if t.method == method]
        orders = [order(a, b) for a, b in zip(rungs[-3:], rungs[-2:])]
        assert orders == pytest.approx([2.0, 2.0], abs=0.05)
        assert len({t.collisions for t in rungs}) == 1
    assert studied.trials[0].error < 1e-13  # EXACT: no finer grid changes it
    alone, _ = study.run(two, replace(LADDER, methods=("NEWMARK",)))
    own = advice.errors(alone.reference.peaks, studied.reference.peaks)
    assert max(own.values()) < alone.reference.doubt < 1e-4
    # the rungs that made the reference are not judged by it
    assert [t.setting for t in alone.trials] == [t.setting for t in studied.trials[1:6]]


@pytest.mark.parametrize("motion", [OTHERS[0], *at_night(*OTHERS[1:])])
def test_the_step_that_the_advice_names_meets_its_error_under_another_motion(tmp_path, studied, motion):
    sure = list(zip(studied.trials, advice.allowed(studied.trials, studied.reference)))
    # the longest step of each method that the rule lets pass, whether it is the fastest here or not
    advised = {
        (method, target): next(t.setting for t, error in sure if t.method == method and error <= target)
        for method in ("NEWMARK", "CENTRAL")
        for target in (1e-2, 1e-3)
    }
    steps = tuple(sorted({float(s.removeprefix("DT=")) for s in advised.values()}, reverse=True))
    other, _ = study.run(write(tmp_path, motion), replace(LADDER, steps=steps))
    assert not other.reference.unseen
    found = {(t.method, t.setting): t.error for t in other.trials}
    for (method, target), setting in advised.items():
        assert found[method, setting] <= target


@pytest.mark.parametrize("leaping", ["perf_counter", "process_time"])
def test_only_cpu_time_breaks_a_run_off(two, monkeypatch, leaping):
    """A clock that leaps by an hour at each reading: the clock on the wall breaks nothing off, that of
    the process does.
    """
    hours = itertools.count(0.0, 3600.0)
    clocks = {name: getattr(time, name) for name in ("perf_counter", "process_time")}
    clocks[leaping] = lambda: next(hours)
    monkeypatch.setattr(study, "time", SimpleNamespace(**clocks))
    plan = Plan(("NEWMARK", "CENTRAL"), steps=(0.005, 0.0025, 0.00125), repeat=1)
    if leaping == "perf_counter":
        found, _ = study.run(two, plan)
        assert [t.stopped for t in found.trials] == [""] * 4  # two of NEWMARK made the reference
    else:
        with pytest.raises(MethodStudyError, match="longer than --longest"):
            study.run(two, plan)


def test_a_run_that_stops_is_a_row_and_two_studies_differ_in_times_only(two, capsys):
    tables = []
    for _ in range(2):
        words = ["study", two.deck, "--methods", "central", "--steps", "0.5,0.0025,0.00125,0.000625"]
        assert main([*words, "--repeat", "1", "-o", str(two.out)]) == 0
        out, err = capsys.readouterr()
        assert "A502" in out and "Least time for errors up to 1 %" in out
        assert "\r" not in err  # no progress in a pipe
        with Results.open(two.path(".study.h5")) as results:
            table = results.table("study")
            rest = [name for name in table.dtype.names if name != "seconds"]
            tables.append([tuple(map(str, row)) for row in table[rest].tolist()])
            assert [row["setting"] for row in results.table("study_stops")] == ["DT=0.5"]
            assert np.isnan(table["seconds"][0]) and table["seconds"][1] > 0
    assert tables[0] == tables[1] and len(tables[0]) == 2
    assert two.path(".study.rpt").exists() and not two.path(".h5").exists()


def test_another_method_gives_the_reference_where_the_first_cannot_follow(tmp_path):
    two = write(tmp_path, "SINE AMPLITUDE=1 PERIOD=6")  # a slow one cuts no step below the limit of CENTRAL
    deck = Path(two.deck)
    deck.write_text(deck.read_text() + "\nOUTPUT\n  EVERY=0.1\n")
    for steps, method in (((0.05, 0.01, 0.005, 0.0025), "CENTRAL"), ((0.1, 0.05, 0.025), "NEWMARK")):
        found, _ = study.run(two, Plan(("CENTRAL", "NEWMARK"), steps, repeat=1))
        assert found.reference.how.startswith(f"{method} extrapolated")
    # CENTRAL with all of its steps, NEWMARK but for the two that made the reference
    assert [(t.method, t.stopped[:4]) for t in found.trials] == [("CENTRAL", "A502")] * 3 + [
        ("NEWMARK", "")
    ]


def test_laguerre_gives_the_reference_without_exact(tmp_path):
    two = write(tmp_path, OTHERS[2])
    found, _ = study.run(two, Plan(("TAYLOR", "LAGUERRE", "NEWMARK"), (0.005, 0.0025, 0.00125), repeat=1))
    assert found.reference.how == "LAGUERRE with TOL=1e-10"
    taylor = found.trials[0]  # knows no tolerance, so that it tells the reference's error
    assert taylor.method == "TAYLOR" and taylor.error <= found.reference.doubt < 1e-7
    steps = [t for t in found.trials if t.method == "NEWMARK"]
    assert len(steps) == 3  # none is left out for a reference
    assert found.orders[-1] == pytest.approx(2.0, abs=0.1)


def test_a_method_that_does_not_take_the_model_is_tried_with_one_step_only(tmp_path):
    two = write(tmp_path, OTHERS[2])
    deck = Path(two.deck)
    deck.write_text(
        deck.read_text().replace("  2,4  ", "  2    ").replace("E=0.65", "C=100")
    )  # no mass at 4
    found, _ = study.run(two, Plan(("LAGUERRE", "CENTRAL"), tols=(1e-6,), repeat=1))
    assert [t.stopped[:4] for t in found.trials] == ["", "A505"]


def test_where_exact_cannot_go_the_tolerances_of_auto_are_met(tmp_path, monkeypatch):
    steps_alone(monkeypatch)
    two = write(tmp_path, OTHERS[2])
    deck = Path(two.deck)
    curved = "RULE=BOUC_WEN N=2 FX=100 KX="
    deck.write_text(deck.read_text().replace("KX=", curved))
    plan = Plan(("EXACT", "NEWMARK", "AUTO"), tuple(0.005 / 2**k for k in range(6)), (1e-2, 1e-3), repeat=1)
    found, _ = study.run(two, plan)
    assert found.trials[0].stopped and "NEWMARK extrapolated" in found.reference.how
    tols = [t for t in found.trials if t.method == "AUTO"]
    assert [t.setting for t in tols] == ["TOL=0.01", "TOL=0.001"]
    assert all(t.error <= tol for t, tol in zip(tols, (1e-2, 1e-3)))


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--methods", "GUESS"], "known methods are"),
        (["--methods", "AUTO"], "needs a method with steps"),
        (["--steps", "0.1,x"], "x is no number"),
        (["--repeat", "0"], "above zero"),
    ],
)
def test_what_cannot_be_studied_is_said_in_a_line(two, capsys, words, told):
    assert main(["study", two.deck, *words]) == 2
    assert told in capsys.readouterr().err


@pytest.mark.parametrize("verb", ["study", "loop"])
def test_a_picture_of_no_known_format_is_refused(verb, tmp_path, capsys):
    option = {"study": "--picture", "loop": "--png"}[verb]
    with pytest.raises(SystemExit) as end:
        main([verb, "LINEAR", option, str(tmp_path / "x.foo")])
    assert end.value.code == 2 and "ends in .svg, .png, .pdf" in capsys.readouterr().err


def test_a_picture_that_cannot_be_drawn_is_told_before_anything_runs(two, capsys, monkeypatch):
    def never(*_):
        raise AssertionError("the study ran")

    monkeypatch.setattr(study, "run", never)
    pytest.importorskip("matplotlib")
    (two.out / "file").touch()
    assert main(["study", two.deck, "--picture", str(two.out / "file/folder/x.png")]) == 3
    assert "file/folder: Not a directory" in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    assert main(["study", two.deck, "--picture", str(two.out / "x.png")]) == 2
    assert "needs matplotlib" in capsys.readouterr().err


def test_a_deck_without_history_has_nothing_to_study(two, capsys):
    deck = Path(two.deck)
    deck.write_text(deck.read_text().replace("   HISTORY   3", ""))
    assert main(["study", str(deck)]) == 2
    assert "no HISTORY" in capsys.readouterr().err
