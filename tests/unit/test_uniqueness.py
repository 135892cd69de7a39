"""An answer that hangs on rounding is told: laws that give way at one instant between massless unknowns."""

from __future__ import annotations

from math import asin

import pytest

from pound_solve.check import Check, Subject
from pound_solve.integrate import auto
from tiers import each_once
from verification.cases import Ran, run_text

STOREYS = """UNITS kN m s
GRAVITY 9.81
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
 3 0 6 FIX=YR
 4 0 9 FIX=YR
ELEMENTS
 1 A 1 2
 2 B 2 3
 3 C 3 4
PROPS
 A SPRING KX=30000 RULE={a}
 B SPRING KX=30000 RULE={b}
 C SPRING KX={kc}
WEIGHTS
 4 300
{weights}
INITIAL
 4 VX={vx}
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 0.3
"""
PLASTIC = "ELASTO_PLASTIC FX=150"
METHODS = [
    ("EXACT", None),
    ("TAYLOR", None),
    ("LAGUERRE", None),
    ("LAPLACE", 2e-3),
    ("NEWMARK", 1e-3),
    ("HHT", 1e-3),
]
NAME = "elements of which any may give way: "


def storeys(a: str = PLASTIC, b: str = PLASTIC, kc: float = 5e4, weights: str = "", vx: float = 2.0) -> str:
    """A mass on three springs in series, over joints without mass."""
    return STOREYS.format(a=a, b=b, kc=kc, weights=weights, vx=vx)


def told(r: Ran) -> str:
    """Which elements the check names, and when; empty where there is no such check."""
    found = [check for check in map(Check.of, r.tables["checks"]) if check.subject is Subject.UNIQUENESS]
    assert all(check.looks and check.remark.startswith("not unique") for check in found)
    return "; ".join(check.name.removeprefix(NAME) for check in found)


@pytest.mark.full
@each_once(("method, dt", METHODS), ("vx", [2.0, -2.0]))
def test_two_equal_storeys_in_series(method: str, dt: float | None, vx: float) -> None:
    """Both come to their strength together: k v sin(w t) / w = 150 with w of three springs in series."""
    found = told(run_text(storeys(vx=vx), None, method, dt))
    k = 1.0 / (2.0 / 30000 + 1.0 / 5e4)
    w = (k * 9.81 / 300) ** 0.5
    when = asin(150 * w / (k * 2.0)) / w
    assert found.startswith("1, 2 at t = ")
    assert float(found.split()[5]) == pytest.approx(when, rel=1e-4 if dt else 1e-5)


@pytest.mark.full
def test_auto_tells_it_of_its_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(auto, "reason_not_linear", lambda system: "barred")
    monkeypatch.setattr(auto, "has_series", lambda system: False)
    r = run_text(storeys(), None, "AUTO")
    assert {x["item"]: x["value"] for x in r.tables["run"]}["method"].startswith("NEWMARK")
    assert told(r).startswith("1, 2 at t = ")


@pytest.mark.full
@each_once(
    ("method, dt", METHODS),
    (
        "own",
        {
            "other strength": {"b": "ELASTO_PLASTIC FX=150.001"},  # by far more than rounding
            "one hardens": {"b": "BILINEAR FX=150 R=0.01"},  # the rates are unique
            "both harden": {"a": "BILINEAR FX=150 R=0.01", "b": "BILINEAR FX=150 R=0.01"},
            "mass": {"weights": " 2 30"},  # inertia holds the joint
            "dashpots": {"b": f"{PLASTIC}\n D DASHPOT CX=1000\nELEMENTS\n 4 D 1 2\nPROPS"},
        },
    ),
)
def test_what_is_unique_is_not_told(method: str, dt: float | None, own: dict[str, str]) -> None:
    r = run_text(storeys(**own), None, method, dt)
    assert r.status == "done" and told(r) == ""
    assert r.tables["spring_envelope"]["yield_events"].max() > 0


PARALLEL = """UNITS kN m s
GRAVITY 9.81
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
 3 0 6 FIX=YR
ELEMENTS
 1 HALF 1 2
 2 HALF 1 2
 3 TOP 2 3
PROPS
 HALF SPRING KX=15000 FX=75 RULE=ELASTO_PLASTIC
 TOP SPRING KX=30000 FX={fx} RULE=ELASTO_PLASTIC
WEIGHTS
 3 300
INITIAL
 3 VX=2
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 0.3
"""


@pytest.mark.full
@pytest.mark.parametrize(("method", "dt"), METHODS)
def test_parallel_springs_that_yield_together(method: str, dt: float | None) -> None:
    """Both go on by the same deformation.  Against an equal storey it is open which storey does."""
    assert told(run_text(PARALLEL.format(fx=160), None, method, dt)) == ""
    assert told(run_text(PARALLEL.format(fx=150), None, method, dt)).startswith("1, 2, 3 at t = ")


SOFTENING = "IMK_BILINEAR FX=150 R=0.05 DP=0.001 DPC=0.5"


@pytest.mark.full
@pytest.mark.parametrize(("method", "dt"), METHODS)
def test_two_equal_springs_that_soften_together(method: str, dt: float | None) -> None:
    """Both harden together to their caps; there one goes on, the other unloads, or the other way round."""
    found = told(run_text(storeys(a=SOFTENING, b=SOFTENING), None, method, dt))
    assert found.startswith("1, 2 at t = ")
    other = SOFTENING.replace("FX=150", "FX=150.15")
    assert told(run_text(storeys(a=SOFTENING, b=other), None, method, dt)) == ""


BRITTLE = """UNITS kN m s
GRAVITY 9.81
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
 3 0 6 FIX=YR
 4 0 9 FIX=YR
ELEMENTS
 1 A 1 2
 2 B 2 3
 3 TOP 3 4
 4 HOLD 1 2
 5 HOLD 2 3
PROPS
 A SPRING KX=30000 FX=150 {rule} FU=200
 B SPRING KX=30000 FX=150 {rule} FU={ultimate}
 TOP SPRING KX=5E4
 HOLD SPRING KX=3000
WEIGHTS
 4 300
{damping}
INITIAL
 4 VX=4
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 0.1
"""
#: beyond its ultimate force it softens, less than HOLD is stiff, and then loses what is left at once
FALLING = "RULE=WAYNE_STEWART R=0.1 FI=10 PTRI=-0.05 RPINCH=0.09"
DAMPINGS = {"none": "", "little": "DAMPING\n RAYLEIGH XI=0.002 OMEGA=5,50"}


@each_once(("method, dt", METHODS), ("damping", DAMPINGS), at_most=2)
def test_two_equal_storeys_of_which_the_first_to_fail_relieves_the_other(
    method: str, dt: float | None, damping: str
) -> None:
    """With a dashpot at the joint, too, which then moves with a rate that has jumped."""

    def run(ultimate: float) -> Ran:
        given = {"rule": FALLING, "damping": damping, "ultimate": ultimate}
        return run_text(BRITTLE.format(**given), None, method, dt)

    if (
        method == "LAPLACE" and damping
    ):  # the dashpot of a joint without mass makes a mode that DT does not resolve
        assert run(200.0).message.startswith("A502 at t = 0 s: DT=0.002 does not resolve the fastest mode")
        return
    assert told(run(200.0)).startswith("1, 2 at t = 0.031")
    assert told(run(200.2)) == ""


def test_storeys_that_fail_together_are_told_only_if_one_relieves_the_other() -> None:
    """Dashpots that let the joint move slowly only let the other fail at the same instant."""
    damping = "DAMPING\n RAYLEIGH XI=0.05 OMEGA=5,50"
    r = run_text(BRITTLE.format(rule=FALLING, damping=damping, ultimate=200), None, "TAYLOR")
    assert told(r) == ""
    first, second = r.column("spring_envelope", "plastic_work")[:2]
    assert first == pytest.approx(second, rel=1e-9)
