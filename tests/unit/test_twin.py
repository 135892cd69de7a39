"""Whether a motion magnifies rounding is told by the twin of a run without steps."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from decks import results_of
from kernels import FAST
from pound_solve.check import Check, Subject
from pound_solve.integrate.closed_form import exact
from pound_solve.integrate.convergence import twin
from pound_solve.integrate.protocol import Stop
from pound_solve.integrate.series import taylor
from pound_solve.results import Results

pytestmark = FAST

# a mass on a spring beside a stop: with a period of 0.3 s its impacts never repeat (Shaw and Holmes 1983, A
# periodically forced piecewise linear oscillator, J. Sound Vib. 90: 129-155, describe such motions)
STOP = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
 3 1 3 FIX=XYR
ELEMENTS
 1 COLUMN 1 2
 2 STOP 2 3
PROPS
 COLUMN SPRING KX=1000
 STOP CONTACT GAP={gap} ANGLE=0 {law}
WEIGHTS
 2 98.1
DAMPING
 RAYLEIGH ALPHA=0.3 BETA=0
{moved}
OUTPUT
 EVERY=0.05
ANALYSIS
 HISTORY {end} METHOD={method}
"""
STIFF = "LAW=KELVIN_VOIGT K=1E5 E=0.8"
SHAKEN = "EQUAKE\n SINE AMPLITUDE=3 PERIOD=0.3 DURATION={end}"


def run(
    folder: Path, method: str, end: float, gap: float = 0.01, law: str = STIFF, moved: str = SHAKEN
) -> Results:
    deck = folder / "stop.inp"
    moved = moved.format(end=end)
    deck.write_text(STOP.format(method=method, end=end, gap=gap, law=law, moved=moved))
    return results_of(deck)


def told(results: Results) -> list[Check]:
    """The checks of the twin."""
    return [check for check in results.checks if check.subject is Subject.MAGNIFICATION]


def apart(folder: Path, end: float, **deck: Any) -> float:
    """Largest difference between EXACT and TAYLOR, over the largest displacement."""
    one, other = (run(folder, m, end, **deck).history("node/u")[:, 1, 0] for m in ("EXACT", "TAYLOR"))
    return float(np.abs(one - other).max() / np.abs(one).max())


def test_a_motion_that_magnifies_rounding_is_told(tmp_path: Path) -> None:
    """EXACT and TAYLOR part in the end, each with a balance of energies to rounding; AUTO says so."""
    assert apart(tmp_path, 25.0) > 0.1
    found = run(tmp_path, "AUTO", 25.0)
    (check,) = told(found)
    assert check.looks and check.value > check.allowed == 1e-4 and "magnifies rounding" in check.remark
    told_first = dict(found.table("overview").tolist())["error of the method"]
    assert told_first == "not known: the motion is one of several, see the checks"
    assert not any(c.looks for c in found.checks if c.subject is Subject.ENERGY)


@pytest.mark.parametrize("method", ["AUTO TOL=1e-4", "AUTO TOL=1e-7"])
def test_the_same_motion_is_right_for_a_while(tmp_path: Path, method: str) -> None:
    """What rounding does to it is no more than what the twin tells."""
    found = run(tmp_path, method, 5.0)
    (check,) = told(found)
    assert not check.looks and apart(tmp_path, 5.0) <= check.value < 1e-8


def test_a_method_that_is_asked_for_has_no_twin(tmp_path: Path) -> None:
    for method in ("EXACT", "TAYLOR", "NEWMARK DT=1e-3"):
        assert not told(run(tmp_path, method, 1.0))


def test_where_nothing_happens_there_is_no_twin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without events a linear motion magnifies nothing; a spring whose force is curved may."""
    repeated = []
    real = twin.again

    def again(*given: Any) -> Any:
        repeated.append(given)
        return real(*given)

    monkeypatch.setattr(twin, "again", again)
    assert not told(run(tmp_path, "AUTO", 1.0, gap=1.0)) and not repeated
    assert told(run(tmp_path, "AUTO", 1.0, gap=1.0, law="LAW=HERTZ K=1E5")) and len(repeated) == 1


@pytest.mark.parametrize(
    ("moved", "what"),
    [(SHAKEN, "excitation"), ("INITIAL\n 2 VX=1.0", "velocity"), ("INITIAL\n 2 UX=-0.05", "displacement")],
)
def test_the_twin_moves_otherwise(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, moved: str, what: str
) -> None:
    """Whatever moves the structure is changed, by a share of 1e-11."""
    seen = []
    for module in (exact, taylor):
        real = module.integrate

        def integrate(problem: Any, options: Any, real: Any = real) -> Any:
            start, excitation = problem.start, problem.system.excitation
            seen.append({"excitation": excitation.coefs, "velocity": start.v, "displacement": start.u})
            return real(problem, options)

        monkeypatch.setattr(module, "integrate", integrate)
    (check,) = told(run(tmp_path, "AUTO", 1.0, moved=moved))
    run_itself, other = seen
    assert run_itself[what].any()
    assert other[what] == pytest.approx((1.0 + 1e-11) * run_itself[what], rel=1e-15)
    assert (other[what] != run_itself[what]).any()
    assert not check.looks and 0.0 < check.value < 1e-9


def test_impacts_without_a_force_are_no_doubt(tmp_path: Path) -> None:
    """Those of a rigid contact have impulses; drifts and springs are compared."""
    (check,) = told(run(tmp_path, "AUTO", 2.0, law="LAW=LAGRANGE E=0.8"))
    assert not check.looks and 0.0 < check.value < 1e-9


@pytest.mark.parametrize("code", ["A503", "A506"])
def test_a_twin_that_stops_leaves_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, code: str
) -> None:
    """It is told; after an interrupt the run counts as stopped at its end."""

    def again(*given: Any) -> Any:
        raise Stop(code, 0.5, "stopped")

    whole = run(tmp_path, "AUTO", 1.0)
    rows = whole.history("node/u")
    monkeypatch.setattr(twin, "again", again)
    found = run(tmp_path, "AUTO", 1.0)
    assert (found.history("node/u") == rows).all()
    if code == "A506":
        assert found.status == "stopped" and found.message.startswith("A506 at t = 1 s: interrupted")
        assert not told(found)
    else:
        (check,) = told(found)
        assert found.status == "done" and check.looks and check.value == np.inf
        assert check.remark.startswith("it stops then: A503 at t = 0.5; ")
