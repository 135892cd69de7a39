"""AUTO by LAGUERRE: estimates hold, smaller tolerances follow, other methods where it stops."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kernels import FAST
from pound_solve.check import Subject
from pound_solve.integrate import auto
from pound_solve.integrate.convergence import tolerance_refinement
from pound_solve.integrate.convergence.compared import RESPONSES, ComparedPeaks
from pound_solve.integrate.protocol import Stop
from pound_solve.integrate.series import laguerre
from pound_solve.results import Results
from pounding_frames import figures, run
from unit.test_auto import error_against, estimated

pytestmark = FAST


@pytest.fixture(autouse=True)
def implicit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep AUTO from EXACT and, as far as LAGUERRE does not stop, from TAYLOR."""
    monkeypatch.setattr(auto, "by_trial", lambda *given: None)
    monkeypatch.setattr(auto, "cost_of_series", lambda *given: 1e9)


def decision(results: Results) -> tuple[str, str]:
    """The method that AUTO took, and why."""
    (row,) = [d for d in results.table("scene") if d["subject"] == "method"]
    return row["decision"], row["why"]


def tolerances(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Tolerances of the runs that follow."""
    out, real = list[float](), laguerre.integrate

    def integrate(problem: Any, options: Any) -> Any:
        out.append(options["TOL"])
        return real(problem, options)

    monkeypatch.setattr(laguerre, "integrate", integrate)
    return out


@pytest.mark.parametrize("tol", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("every", [0.1, 0.004])
def test_the_tolerance_is_met_and_the_estimate_holds(tmp_path: Path, tol: float, every: float) -> None:
    truth = figures(run(tmp_path, "TAYLOR"))
    found = run(tmp_path, f"AUTO TOL={tol}", every=every)
    assert decision(found)[0] == "LAGUERRE"
    assert int(dict(found.table("run").tolist())["runs"]) >= 2
    assert error_against(found, truth) <= estimated(found) <= tol


def test_envelopes_are_those_of_a_run_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """They are found in the last run, and what the first has seen does not count."""
    tried = tolerances(monkeypatch)
    found = run(tmp_path, "AUTO TOL=1e-3")
    envelopes = found.table("node_envelope"), found.table("member_envelope")
    alone = run(tmp_path, f"LAGUERRE TOL={tried[-1]!r}")
    assert len(tried) > 1
    for own, other in zip(envelopes, (alone.table("node_envelope"), alone.table("member_envelope"))):
        for name in ("max", "min"):
            assert own[name] == pytest.approx(other[name], rel=1e-9, abs=1e-9 * np.abs(other[name]).max())


def test_accelerations_and_members_are_compared_where_that_is_asked_for(tmp_path: Path) -> None:
    truth = run(tmp_path, "TAYLOR")
    found = run(tmp_path, "AUTO TOL=2e-3 PEAKS=ALL")
    checks = [c for c in found.checks if c.subject is Subject.ERROR]
    assert len(checks) == 3 and not any(c.looks for c in checks)
    for name, size in (("node/a", 2), ("member/force", None)):
        a, b = (np.abs(r.history(name)[..., :size]).max(axis=0) for r in (found, truth))
        assert np.abs(a - b).max() <= max(c.value for c in checks) * b.max()


def made_up(monkeypatch: pytest.MonkeyPatch, values: list[float]) -> None:
    """Let the peaks of the runs be some numbers."""
    left = iter(values)
    monkeypatch.setattr(
        tolerance_refinement,
        "figures",
        lambda *given: ComparedPeaks(np.array([next(left)]), np.ones(1), np.array([RESPONSES])),
    )


def test_smaller_tolerances_follow_the_differences(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A difference five times TOL asks for a fiftieth of the tolerance; one far above for a thousandth."""
    for second, share in ((1.05, 0.02), (2.0, 1e-3)):
        tried = tolerances(monkeypatch)
        made_up(monkeypatch, [1.0, second, second, second, second, second])
        found = run(tmp_path, "AUTO TOL=1e-2")
        assert tried[:3] == pytest.approx([1e-5, 1e-6, share * 1e-6])
        assert estimated(found) <= 1e-2
        found.close()
        monkeypatch.undo()
        implicit.__wrapped__(monkeypatch)


def test_two_runs_that_agree_by_chance_are_not_believed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The third is as the second: what they both differ from the first by counts, and a fourth follows."""
    tried = tolerances(monkeypatch)
    made_up(monkeypatch, [1.0, 1.02, 1.02, 1.02, 1.02])
    found = run(tmp_path, "AUTO TOL=1e-3")
    assert len(tried) == 4
    assert estimated(found) == pytest.approx(0.02 * (tried[-2] / tried[0]) ** 0.5)


@pytest.mark.parametrize(("tol", "least"), [(1e-5, 1e-6), (1e-4, 1e-5), (1e-3, 5e-5), (0.1, 5e-3)])
def test_a_difference_of_nothing_is_no_estimate(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, tol: float, least: float
) -> None:
    """The tolerance of the first run counts, and a share of what was asked for."""
    tried = tolerances(monkeypatch)
    made_up(monkeypatch, [1.0, 1.0, 1.0, 1.0, 1.0, 1.0])
    assert estimated(run(tmp_path, f"AUTO TOL={tol}")) == pytest.approx(least, rel=1e-12)
    assert tried[0] <= 1e-5


def test_it_ends_where_no_smaller_tolerance_brings_nearer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried = tolerances(monkeypatch)
    made_up(monkeypatch, [1.0, 1.5] * 3)
    found = run(tmp_path, "AUTO TOL=1e-2")
    (check,) = [c for c in found.checks if c.subject is Subject.ERROR]
    assert len(tried) <= tolerance_refinement.MAX_RUNS and check.looks and check.value >= 0.5
    assert f"not shown with TOL={tried[-1]:.2g} of LAGUERRE" in check.remark and found.status == "done"


@pytest.mark.parametrize(
    "code, method, why",
    [("A503", "NEWMARK", "LAGUERRE stops: A503 at t = 0.25"), ("A502", "TAYLOR", "power series")],
)
def test_another_method_follows_where_it_stops(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, code: str, method: str, why: str
) -> None:
    """Steps pass over changes without end; where its steps are too many, series cost less."""

    def stops(*given: Any) -> None:
        raise Stop(code, 0.25, "it stops")

    truth = figures(run(tmp_path, "EXACT"))
    monkeypatch.setattr(laguerre, "integrate", stops)
    found = run(tmp_path, "AUTO TOL=1e-2")
    chosen, reason = decision(found)
    assert found.status == "done" and chosen == method and why in reason
    assert error_against(found, truth) <= 1e-2


def test_a_run_dearer_than_series_is_given_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No more steps are allowed than series cost, beside those that are expected."""
    allowed, real = list[float](), laguerre.integrate

    def integrate(problem: Any, options: Any) -> Any:
        allowed.append(options["STEPS"])
        return real(problem, options)

    monkeypatch.setattr(laguerre, "integrate", integrate)
    monkeypatch.setattr(auto, "cost_of_series", lambda *given: 2.0)
    run(tmp_path, "AUTO TOL=1e-2")
    assert 1e4 < allowed[0] < 1e6


def test_an_interrupt_leaves_the_last_whole_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    runs = []

    class Interrupted(tolerance_refinement.Replay):
        def __init__(self, *given: Any) -> None:
            super().__init__(*given)
            runs.append(self)

        def sample(self, t: Any, *motion: Any) -> None:
            if len(runs) == at and t[-1] > 0.5:
                raise KeyboardInterrupt
            super().sample(t, *motion)

    made_up(monkeypatch, [1.0, 2.0, 3.0] * 2)
    monkeypatch.setattr(tolerance_refinement, "Replay", Interrupted)
    for at, checked in ((1, 0), (3, 1)):
        runs.clear()
        found = run(tmp_path, "AUTO TOL=1e-6")
        assert len(runs) == at and found.status == "stopped" and found.message.startswith("A506 at t = ")
        checks = [c for c in found.checks if c.subject is Subject.ERROR]
        assert len(checks) == checked and all(c.remark.endswith("interrupted") for c in checks)
        if checked:
            assert found.time[-1] == runs[1].samples[-1][0][-1] > 0.5
        found.close()
