"""Faults that users meet in other programs, each as a test that this one passes; and a few of its own
that are known.

The list is from side-by-side runs with OpenSees: its impact materials do not touch at gap zero, add the
open part of the closing step to the force, pull at release, turn dashpots into energy sources, and
explicit runs above the stability limit end with "success".
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tiers import each_once
from verification.cases import DECKS, Oscillator, example, kelvin_voigt_xi, run_deck, run_text

pytestmark = pytest.mark.full

UNIT = DECKS / "unit_impact" / "unit_impact.inp"
WALL = DECKS / "sdof_on_wall" / "sdof_on_wall.inp"
METHODS = [("EXACT", None), ("NEWMARK", 0.01), ("NEWMARK", 0.003), ("CENTRAL", 0.01), ("CENTRAL", 0.003)]


@pytest.mark.parametrize(("method", "dt"), METHODS)
def test_zero_gap_touches_at_zero(method: str, dt: float | None) -> None:
    r = run_deck(UNIT, {"gap": 0}, method, dt)
    c = r.tables["collisions"]
    assert len(c) == 1
    assert c["t_start"][0] == pytest.approx(0.0, abs=1e-11)
    assert c["approach_velocity"][0] == pytest.approx(1.0, rel=1e-11)


@pytest.mark.parametrize(("method", "dt"), [*METHODS, ("NEWMARK", 0.1), ("CENTRAL", 0.1)])
def test_force_at_touch_does_not_depend_on_the_step(method: str, dt: float | None) -> None:
    """With e = 0.1 the jump 2 xi at touch is the largest force.  The gap is no multiple of any step."""
    gap = 0.3337
    r = run_deck(UNIT, {"gap": gap, "e": 0.1}, method, dt)
    c = r.tables["collisions"][0]
    assert c["t_start"] == pytest.approx(gap, abs=1e-11)
    assert c["peak_force"] == pytest.approx(2 * kelvin_voigt_xi(0.1, False), rel=1e-10)
    assert c["t_peak"] == pytest.approx(gap, abs=1e-11)


@pytest.mark.parametrize(("method", "dt"), METHODS)
@pytest.mark.parametrize("e", [0.1, 0.65, 0.95])
def test_no_tension_at_release(method: str, dt: float | None, e: float) -> None:
    text = (
        UNIT.read_text(encoding="utf-8")
        .replace("EVERY=0.1", "EVERY=0.004")
        .replace("HISTORY  t", "HISTORY  3.2")
    )
    r = run_text(text, {"e": e}, method, dt)
    assert r.force.max() > 0.5
    assert r.force.min() >= -1e-12
    end = float(r.tables["collisions"]["t_end"][0])
    if np.isfinite(end):
        assert np.all(r.force[r.time > end + 1e-12] == 0.0)


def test_tension_only_where_it_is_asked_for() -> None:
    text = UNIT.read_text(encoding="utf-8").replace("EVERY=0.1", "EVERY=0.004")
    r = run_text(text, {"e": 0.65, "tension": '"YES"'})
    assert r.force.min() < -0.17


@pytest.mark.parametrize(
    ("method", "dt"),
    [("NEWMARK", 0.01), ("NEWMARK", 0.005), ("NEWMARK", 0.002), ("CENTRAL", 0.01), ("CENTRAL", 0.004)],
)
def test_number_of_collisions_does_not_depend_on_the_step(method: str, dt: float) -> None:
    """A contact lasts 0.061 s, every 0.81 s: from 6 steps a contact on, the count is the exact one."""
    count = len(example("sdof_on_wall/sdof_on_wall.inp").tables["collisions"])
    r = run_deck(WALL, None, method, dt)
    assert len(r.tables["collisions"]) == count
    assert len(run_deck(DECKS / "sdnd101" / "sdnd101.inp", None, method, dt / 10).tables["collisions"]) == 2


@pytest.mark.parametrize("share", [0.99, 1.01])
def test_explicit_run_above_the_limit_is_refused(share: float) -> None:
    limit = 2 / np.sqrt(5050.0 / 2.0)
    r = run_deck(WALL, {"t": 2}, "CENTRAL", share * limit)
    if share < 1:
        assert r.status == "done" and np.abs(r.u).max() < 0.11
    else:
        assert r.status == "stopped" and r.message.startswith("A502")


def test_stiffness_proportional_damping_keeps_the_explicit_limit() -> None:
    """OpenSees' central difference with a diagonal solver explodes here at every step."""
    text = WALL.read_text(encoding="utf-8").replace(
        "INITIAL", "DAMPING\n   RAYLEIGH  ALPHA=0  BETA=0.05\nINITIAL"
    )
    limit = 2 / np.sqrt(5050.0 / 2.0)
    r = run_text(text, {"t": 5}, "CENTRAL", 0.9 * limit)
    assert r.status == "done"
    u, _ = Oscillator(5.0, 0.05 * 5.0 / 2, 0.0, 1.0).at(r.time, 0.0, -0.1, 0.0)
    before = r.time < 0.3
    assert np.abs(r.u[before, 1, 0] - u[before]).max() < 2e-3
    assert np.abs(r.u[-1, 1, 0]) < 0.05


FALL = """TITLE  Two masses in a row against a wall
UNITS  N m s
PARAM  e1 = 0.5   e2 = 0.5   k = 100   v = 1   push = 1
GRAVITY 1
NODES
   1   0   0   FIX=YR
   2   1   0   FIX=YR
ELEMENTS
   1   BETWEEN   1   2
   2   STOP      2
PROPS
   BETWEEN   CONTACT   GAP=0.1   LAW=KELVIN_VOIGT  K=k  E=e1
   STOP      CONTACT   GAP=0.02  LAW=KELVIN_VOIGT  K=k  E=e2
WEIGHTS
   1   1
   2   2
LOADS
   1   push
INITIAL
   1   VX=v
OUTPUT
   EVERY=0.01
ANALYSIS
   HISTORY  2  FROM=REST
"""


@settings(max_examples=8)
@given(
    e1=st.floats(0.05, 1.0),
    e2=st.floats(0.05, 1.0),
    v=st.floats(0.0, 3.0),
    method=st.sampled_from([("EXACT", None), ("NEWMARK", 0.005), ("CENTRAL", 0.005)]),
)
def test_contact_dashpots_never_create_energy(
    e1: float, e2: float, v: float, method: tuple[str, float | None]
) -> None:
    """What the contacts take only grows, and with the load's work nothing comes from nowhere."""
    r = run_text(FALL, {"e1": e1, "e2": e2, "v": v}, *method)
    assert r.status == "done"
    assert np.all(r.column("contact_summary", "energy_lost") >= -1e-12)
    speed = 0.5 * (r.v[:, 0, 0] ** 2 + 2 * r.v[:, 1, 0] ** 2)
    work = r.u[:, 0, 0] * 1.0
    gain = speed - 0.5 * v * v - work  # less what the contact springs hold
    scale = 0.5 * v * v + np.abs(work).max()
    tol = 1e-10 if method[0] == "EXACT" else 2e-2
    assert gain.max() <= tol * max(scale, 1e-3)


STEPS_BESIDE_BREAKS = """TITLE  Output times a rounding error beside the excitation's breaks
UNITS  N m s
GRAVITY 1
NODES
   1   0   0   FIX=XYR
   2   1   0   FIX=YR
ELEMENTS
   1   SPRING1   1   2
PROPS
   SPRING1   SPRING   KX=100
WEIGHTS
   2   1
EQUAKE
   SINE  AMPLITUDE=1  PERIOD=0.32
OUTPUT
   EVERY=0.05
ANALYSIS
   HISTORY  1
"""


@pytest.mark.parametrize("method", ["EXACT", "NEWMARK", "CENTRAL"])
def test_steps_of_rounding_length(method: str) -> None:
    """The sine's pieces end at 0.01 i, the samples stand at 0.05 j; some differ in the last bit."""
    r = run_text(STEPS_BESIDE_BREAKS, None, method, None if method == "EXACT" else 0.001)
    u, _ = Oscillator(10.0, 0.0, 1.0, 2 * np.pi / 0.32).at(r.time, 0.0, 0.0, 0.0)
    assert np.abs(r.u[:, 1, 0] - u).max() < 1e-3 * np.abs(u).max()


BOUNCE = """TITLE  A free mass that touches an elastic wall a hair before the end of a step
UNITS  N m s
PARAM  before = 0
GRAVITY 1
NODES
   1   0   0   FIX=YR
ELEMENTS
   1   WALL   1
PROPS
   WALL   CONTACT   GAP=0.3-before  K=100
WEIGHTS
   1   1
INITIAL
   1   VX=1
OUTPUT
   EVERY=0.1
ANALYSIS
   HISTORY  2  FROM=REST
"""

#: times between touch and the end of the step of 0.01 s
HAIRS = (0.0, 1e-13, 1e-11, 1e-9, 1e-7, 1e-5)


def bounce(method: str, before: float) -> tuple[float, float, float]:
    """Errors of largest force (10 N), duration (pi/10 s) and last velocity (-1 m/s)."""
    r = run_text(BOUNCE, {"before": before}, method, None if method == "EXACT" else 0.01)
    c = r.tables["collisions"]
    assert r.status == "done" and len(c) == 1
    return (
        abs(c["peak_force"][0] / 10 - 1),
        abs((c["t_end"] - c["t_start"])[0] / (np.pi / 10) - 1),
        abs(r.v[-1, 0, 0] + 1),
    )


@pytest.mark.parametrize("before", HAIRS)
def test_touch_at_the_end_of_a_step_exact(before: float) -> None:
    assert max(bounce("EXACT", before)) < 1e-12


@pytest.mark.parametrize("before", HAIRS)
def test_touch_at_the_end_of_a_step_central(before: float) -> None:
    assert max(bounce("CENTRAL", before)) < 2e-3


@pytest.mark.parametrize("before", HAIRS)
def test_touch_at_the_end_of_a_step_newmark(before: float) -> None:
    """Average acceleration keeps an elastic bounce's energy; its time is off by (omega h)^2/12 = 8e-4."""
    force, duration, speed = bounce("NEWMARK", before)
    assert speed < 1e-6
    assert force < 1e-5
    assert duration < 1e-3


def test_spring_force_envelope_is_exact() -> None:
    """After the blow the mass swings between +-fy; the smallest force lies between grid points."""
    s = example("sdof/yielding.inp").tables["spring_envelope"][0]
    assert s["force_max"] == pytest.approx(10.0, rel=1e-12)
    assert s["force_min"] == pytest.approx(-10.0, rel=1e-12)


PARTING = UNIT.read_text(encoding="utf-8").replace("1   VX=c-slide*s   VY=s+slide*c", "1   VX=-c   VY=-s")


def test_overlap_that_parts_at_once_does_not_pull() -> None:
    """k d + c v < 0 at the start: the contact is to be let go before it pulls."""
    r = run_text(PARTING, {"gap": -0.1, "e": 0.1})
    assert r.force.min() >= 0.0


def test_overlap_that_parts_at_once_leaves_the_motion_alone() -> None:
    r = run_text(PARTING, {"gap": -0.1, "e": 0.1})
    assert r.v[-1, 0, 0] == pytest.approx(-1.0, rel=1e-12)


AGAIN = """UNITS N m s
GRAVITY 1
NODES
   1 0 0 FIX=YR
ELEMENTS
   1 WALL 1
PROPS
   WALL CONTACT GAP=-1 LAW=KELVIN_VOIGT K=1 C=5
WEIGHTS
   1 1
LOADS
   1 3
INITIAL
   1 VX=-1
ANALYSIS
   HISTORY 10 FROM=REST
"""


def test_overlap_that_is_let_go_at_once_may_be_pressed_again() -> None:
    """It starts released, with no collision before: the pressing is its first one."""
    r = run_text(AGAIN)
    c = r.tables["collisions"]
    assert r.status == "done" and len(c) == 1
    # until then it moves under the load of 3 N alone: k d + c v = 1 + x + 5 v = 0 with v = -1 + 3 t
    t = (-14 + np.sqrt(14**2 + 4 * 1.5 * 4)) / (2 * 1.5)
    assert c["t_start"][0] == pytest.approx(t, rel=1e-10)


# ---------------------------------------------------------------------- the same in the other contact laws

CURVED = ["HERTZ", "JANKOWSKI", "HUNT_CROSSLEY", "HERTZDAMP", "POWER_LAW_DAMPED", "RUBBER_BUMPER"]
STOP = """UNITS kN m s
NODES
   1  0 0  FIX=YR
ELEMENTS
   1  WALL 1
   2  PUSH 1
PROPS
   WALL CONTACT GAP={gap} LAW={law}
   PUSH SPRING KX=1E-9
WEIGHTS
   1  9.81
{start}
ANALYSIS
   HISTORY {length} METHOD=NEWMARK DT={dt}
OUTPUT
   EVERY={length}/200
"""


def stop(law: str, dt: float, gap: float = 0.0, start: str = "INITIAL\n 1 VX=1", length: float = 0.4):
    card = f"{law} K=1E4" + ("" if law == "HERTZ" else " E=0.5")
    return run_text(STOP.format(law=card, dt=dt, gap=gap, start=start, length=length))


@each_once(("law", CURVED), at_most=3)
def test_other_laws_touch_at_zero_gap_with_the_speed_of_touch_whatever_the_step(law: str) -> None:
    """The approach speed is that of the located instant, so that the damping is none of the step's."""
    e = 1.0 if law == "HERTZ" else 0.5
    for gap in (0.0, 0.0337):
        coarse, fine = (stop(law, dt, gap) for dt in (2e-3, 5e-4))
        for r in (coarse, fine):
            (hit,) = r.tables["collisions"]
            assert hit["t_start"] == pytest.approx(gap, abs=1e-11)
            assert hit["approach_velocity"] == pytest.approx(1.0, rel=1e-9)
            assert hit["restitution"] == pytest.approx(e, abs=1e-2)
            assert r.force.min() >= 0.0
        peak = [r.tables["collisions"]["peak_force"][0] for r in (coarse, fine)]
        assert peak[0] == pytest.approx(peak[1], rel=2e-2)


@pytest.mark.parametrize("law", CURVED)
def test_other_laws_bear_an_overlap_from_the_start(law: str) -> None:
    """Pressed at rest, they push the mass off; it leaves with what their spring held, less the damping."""
    n = 2.65 if law == "RUBBER_BUMPER" else 1.5
    r = stop(law, 5e-4, gap=-0.02, start="", length=4.0)
    (hit,) = r.tables["collisions"]
    held = 1e4 * 0.02 ** (n + 1.0) / (n + 1.0)
    assert 0.0 < hit["separation_velocity"] <= np.sqrt(2.0 * held) * (1 + 1e-3)
    if law in ("HERTZ", "JANKOWSKI"):  # undamped in restitution
        assert hit["separation_velocity"] == pytest.approx(np.sqrt(2.0 * held), rel=2e-3)
    assert r.force.min() >= 0.0
    assert r.force[0] == pytest.approx(1e4 * 0.02**n)
    assert abs(r.check()) < 1e-2
