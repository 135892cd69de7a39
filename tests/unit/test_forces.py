"""Forces in time, loads that are let go, turning and travelling ground motion: against closed forms."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from decks import results_of, scene_of
from pound_solve import run
from pound_solve.numerics.types import Array
from tiers import at_night
from verification.cases import Ran, run_text

pytestmark = pytest.mark.full

M, K, F = 10.0, 400.0, 50.0
W = math.sqrt(K / M)
OSCILLATOR = f"""
GRAVITY 10
PARAM c = 0
NODES
 1 0 0 FIX=XYR
 2 3 0 FIX=YR
ELEMENTS
 1 K 1 2
 2 C 1 2
PROPS
 K SPRING KX={K}
 C DASHPOT CX=c
WEIGHTS
 2 {10 * M}
{{}}
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 4 METHOD=EXACT
"""


def oscillator(more: str, xi: float = 0.0, **params: object) -> Ran:
    r = run_text(OSCILLATOR.format(more), {"c": 2 * xi * M * W, **params})
    assert r.status == "done" and r.check() < 1e-9
    return r


def step_response(t: Array, xi: float) -> Array:
    """Displacement under a unit force from t = 0 on, zero before (Chopra 2012, Eq. 4.3.5)."""
    t = np.maximum(t, 0.0)
    wd = W * math.sqrt(1 - xi**2)
    return (1 - np.exp(-xi * W * t) * (np.cos(wd * t) + xi * W / wd * np.sin(wd * t))) / K


def ramp_response(t: Array) -> Array:
    """Undamped displacement under a force that grows by one per time from t = 0 on."""
    t = np.maximum(t, 0.0)
    return (t - np.sin(W * t) / W) / K


def same(got: Array, want: Array, rel: float = 1e-11) -> None:
    np.testing.assert_allclose(got, want, rtol=0, atol=rel * np.abs(want).max())


# ---------------------------------------------------------------- histories of force


@pytest.mark.parametrize("xi", [0.0, 0.05, 0.6])
def test_a_step_force(xi: float) -> None:
    r = oscillator(f"FORCES\n TABLE 2 {F} POINTS=0,1,4,1", xi)
    same(r.u[:, 1, 0], F * step_response(r.time, xi))


def test_a_ramp_that_stays() -> None:
    rise = 0.35
    r = oscillator(f"FORCES\n TABLE 2 FX={-F} POINTS=0,0,{rise},1,9,1")
    same(r.u[:, 1, 0], -F / rise * (ramp_response(r.time) - ramp_response(r.time - rise)))


def test_a_pulse_that_begins_late_with_jumps() -> None:
    """A time that is given twice is a jump; nothing acts outside of the table."""
    r = oscillator(f"FORCES\n TABLE 2 {F} POINTS=0.503,1,1.1,1,1.1,-2,1.7,-2", 0.05)
    jumps = ((0.503, 1.0), (1.1, -3.0), (1.7, 2.0))
    same(r.u[:, 1, 0], F * sum(by * step_response(r.time - t, 0.05) for t, by in jumps))


def test_a_sine_from_a_start_to_an_end() -> None:
    w, start = 9.0, 0.6
    last = start + 2 * math.pi / w * 3
    r = oscillator(f"FORCES\n SINE 2 FX={F} OMEGA={w} START={start} DURATION={last - start}")
    t = r.time
    s = np.maximum(t - start, 0.0)

    def swing(s: Array) -> Array:
        return F / (K - M * w * w) * (np.sin(w * s) - w / W * np.sin(W * s))

    # after whole periods the same force with the other sign stops it
    same(r.u[:, 1, 0], swing(s) - swing(np.maximum(t - last, 0.0)))


def test_phase_and_period() -> None:
    """cos(w t) from t = 0: sine with PHASE = pi/2."""
    r = oscillator(f"FORCES\n SINE 2 {F} PERIOD=0.7 PHASE=pi/2")
    w = 2 * math.pi / 0.7
    same(r.u[:, 1, 0], F / (K - M * w * w) * (np.cos(w * r.time) - np.cos(W * r.time)))


def test_a_file_of_forces_is_base_motion_turned_into_forces(tmp_path: Path) -> None:
    """FX = -m g with the record as it stands is the record in g; the window is that of motions."""
    path = tmp_path / "a.csv"
    t = np.arange(120) * 0.02
    path.write_text("".join(f"{x:.2f},{math.sin(40 * x) * math.exp(-x):.6f}\n" for x in t))
    window = f'FILE="{path}" START=0.031 DURATION=1.77 TSCALE=1.3'
    base = oscillator(f"EQUAKE\n RECORD {window}", 0.05)
    push = oscillator(f"FORCES\n RECORD 2 FX={-M * 10} {window}", 0.05)
    same(push.u[:, 1, 0], base.u[:, 1, 0], 1e-13)


def test_forces_add_up_with_ground_motion_and_each_other() -> None:
    alone = [
        "FORCES\n SINE 2 30 PERIOD=0.3",
        "FORCES\n TABLE 2 -9 POINTS=0,0,1,2,4,0",
        "EQUAKE\n SINE AMPLITUDE=1 PERIOD=0.9",
    ]
    whole = "FORCES\n SINE 2 30 PERIOD=0.3\n TABLE 2 -9 POINTS=0,0,1,2,4,0\n" + alone[2]
    parts = sum(oscillator(x, 0.05).u for x in alone)
    same(oscillator(whole, 0.05).u, np.asarray(parts))


def test_the_report_tells_of_forces(tmp_path: Path) -> None:
    deck = tmp_path / "deck.inp"
    deck.write_text(OSCILLATOR.format("FORCES\n SINE 2 30 PERIOD=0.4\n TABLE 2 FX=-9 POINTS=0,0,1,-2,3,0"))
    with run(deck) as r:
        rows = r.table("forces").tolist()
        assert [row[:5] for row in rows] == [("1 SINE", "2", 30, 0, 0), ("2 TABLE", "2", -9, 0, 0)]
        assert rows[1][5:] == (-2.0, 1.0, 3.0)
        history = r.history("force")
        same(history[:, 0], np.sin(2 * math.pi / 0.4 * r.time), 1e-12)
        same(history[:, 1], np.interp(r.time, [0, 1, 3], [0, -2, 0]) * (r.time <= 3), 1e-12)
    assert "FORCES IN TIME" in deck.with_suffix(".rpt").read_text()


FRAME = """
GRAVITY 10
NODES
 1 0 0 FIX=XYR
 2 0 3
 3 4 3
 4 4 0 FIX=XY
 5 2 3
ELEMENTS
 1 COL 1 2
 2 BEAM 2 5
 3 BEAM 5 3
 4 COL 4 3
PROPS
 COL FRAME E=2e8 A=0.01 I=1e-4
 BEAM FRAME E=2e8 A=0.01 I=2e-4
WEIGHTS
 2 500 400 30
 3 700 600
{more}
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 1.5 METHOD=EXACT
"""
RAYLEIGH = "DAMPING\n RAYLEIGH ALPHA=0.4 BETA=0.002\n"


@pytest.mark.parametrize(
    ("damping", "kept"),
    # columns and beams of different beta meet at 3, which is kept; 5 is kept in what pushes it
    [("", 5), ("DAMPING\n RAYLEIGH BETA=0.004 PROPS=COL\n RAYLEIGH BETA=0.01 PROPS=BEAM\n", 8)],
)
def test_forces_on_massless_nodes_are_met_without_error(damping: str, kept: int) -> None:
    """Node 5 has no mass.  Harmonic response to a force on it: the reduced system as EXACT condenses it and
    the structure as assembled agree.  Without dashpots it is condensed; against them it lags.
    """
    place = scene_of(FRAME.format(more=damping + "FORCES\n TABLE 5 0 -10 4 POINTS=0,0,1,1\n"))
    s, n = place.structure, place.structure.n_free
    assert place.size == kept
    for w in (0.3, 4.0, 60.0, 900.0):
        whole = s.stiffness[:n, :n] + 1j * w * s.damping[:n, :n] - w**2 * s.mass[:n, :n]
        full = np.linalg.solve(whole, place.force_inputs[:, 0])
        small = place.stiffness + 1j * w * place.damping - w**2 * place.mass
        got = place.expand @ np.linalg.solve(small, place.inputs[:, 0]) + place.expand_inputs[:, 0]
        np.testing.assert_allclose(got, full, rtol=0, atol=1e-10 * np.abs(full).max())


def test_a_massless_node_on_a_dashpot_comes_after_its_force() -> None:
    """Spring and dashpot side by side under a step: u = F/k (1 - exp(-k t/c)); beside it an oscillator."""
    k, c = 200.0, 50.0
    deck = OSCILLATOR.replace(" 2 3 0 FIX=YR", " 2 3 0 FIX=YR\n 3 5 0 FIX=YR").replace(
        " 2 C 1 2", " 2 C 1 2\n 3 SLOW 3\n 4 DRAG 3"
    )
    deck = deck.replace("PROPS\n", f"PROPS\n SLOW SPRING KX={k}\n DRAG DASHPOT CX={c}\n")
    r = run_text(deck.format(f"FORCES\n TABLE 2,3 {F} POINTS=0,1,4,1"))
    same(r.u[:, 1, 0], F * step_response(r.time, 0.0))
    same(r.u[:, 2, 0], F / k * (1 - np.exp(-k / c * r.time)))
    assert r.check() < 1e-9


@pytest.mark.parametrize(
    ("every", "first", "moved"),
    # at an output time, just before it, and at 0.3, beyond which rounding puts the output time 3 * 0.1
    [(0.01, 0.1, False), (0.01, 0.1 - 1e-7, True), (0.1, 0.3, False)],
)
@pytest.mark.parametrize(("method", "bound"), [("EXACT", 1e-9), ("TAYLOR", 1e-9), ("LAGUERRE", 1e-6)])
def test_jumps_of_a_force_on_a_massless_node_keep_the_balance(
    every: float, first: float, moved: bool, method: str, bound: float
) -> None:
    """The node jumps with the force, which puts in half the product of both, to be taken out again.
    A sample at that instant has motion, forces and energies from just before it.
    """
    more = f"FORCES\n TABLE 5 0 -40 POINTS={first},1,0.4,1,0.4,-2,0.9,-2\nLOADS\n 5 0 -10\n"
    r = run_text(FRAME.replace("EVERY=0.01", f"EVERY={every}").format(more=more), method=method)
    energy, forces, *_ = (float(x) for x in r.tables["checks"]["value"])
    assert energy < bound and forces < bound
    at = round(first / every)
    assert (abs(r.u[at, 4, 1] - r.u[at - 1, 4, 1]) > 1e-5) == moved
    assert abs(r.u[at + 1, 4, 1] - r.u[at - 1, 4, 1]) > 1e-5


SERIES = """
GRAVITY 10
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
 3 2 0 FIX=YR
ELEMENTS
 1 A 1 2
 2 B 2 3
PROPS
 A SPRING KX=400 FX=40 RULE=BILINEAR R=0.1
 B SPRING KX=400
WEIGHTS
 3 100
{}
ANALYSIS
 HISTORY 1 METHOD=EXACT
"""


@pytest.mark.parametrize(
    "cards",
    [
        "LOADS\n 2 50 HELD=NO",
        "FORCES\n TABLE 2 50 POINTS=0,0,0.5,1,0.5,0.2,1,0",
        *at_night("FORCES\n TABLE 2 50 POINTS=0,1,1,1", "FORCES\n SINE 2 50 PERIOD=0.3 PHASE=1"),
    ],
)
def test_what_jumps_beside_a_spring_with_memory_needs_mass(cards: str) -> None:
    """Without mass nothing says along which path the spring yields or unloads; the run says so at once."""
    r = run_text(SERIES.format(cards))
    assert r.status == "stopped" and "A505" in r.message
    assert "node 2 ux, which has no mass, and deforms the spring 1 X instantly" in r.message
    for cure in (" 2 1\n", "DAMPING\n RAYLEIGH BETA=0.01\n"):
        assert run_text(SERIES.format(cure + cards)).status == "done"


def test_a_quick_change_of_a_force_on_a_massless_node_is_fine() -> None:
    """Let go within a microsecond: spring 1 unloads elastically, from 0.35 by half of F/k."""
    cards = "LOADS\n 2 50 HELD=NO\nFORCES\n TABLE 2 50 POINTS=0,1,1E-6,0"
    r = run_text(SERIES.format("LOADS\n 2 50\nFORCES\n TABLE 2 -50 POINTS=0,0,1E-6,1,1,1"))
    assert r.status == "done" and r.check() < 1e-9
    assert r.u[1, 1, 0] == pytest.approx(0.35 - 50 / 800, abs=1e-4)
    assert run_text(SERIES.format(cards)).status == "stopped"


def test_forces_on_a_slaved_node_turn_its_master() -> None:
    deck = """
GRAVITY 10
NODES
 1 0 0 FIX=XYR
 2 0 3
 3 1 3.5 SLAVED=XYR MASTER=2
ELEMENTS
 1 COL 1 2
PROPS
 COL FRAME E=2e6 A=0.01 I=1e-4
WEIGHTS
 2 50 50 5
FORCES
 {}
ANALYSIS
 HISTORY 1 METHOD=EXACT
"""
    history = "POINTS=0,1,0.3,-1,1,0.2"
    arm = run_text(deck.format(f"TABLE 3 2 -3 0.7 {history}"))
    own = run_text(deck.format(f"TABLE 2 2 -3 {0.7 - 3 * 1 - 2 * 0.5} {history}"))
    same(arm.u, own.u, 1e-12)


@pytest.mark.parametrize("supports", ["", "SUPPORTS=1,4"])
def test_energy_balances_with_forces_and_ground_motion(supports: str) -> None:
    """In the relative and in the total form, forces on nodes with and without mass."""
    more = (
        RAYLEIGH
        + f"""EQUAKE
 SINE AMPLITUDE=2 PERIOD=0.5 {supports}
FORCES
 SINE 2,3 100 -20 5 PERIOD=0.21
 TABLE 5 3 -40 POINTS=0,0,0.4,1,0.9,-1,1.2,0
LOADS
 3 20 -30
"""
    )
    r = run_text(FRAME.format(more=more))
    assert r.status == "done" and r.check() < 1e-9
    assert abs(float(r.tables["energy"][0][1])) > 0.1


def test_a_force_closes_a_contact_and_the_energy_balances() -> None:
    wall = f"""
GRAVITY 10
NODES
 1 0 0 FIX=XYR
 2 3 0 FIX=YR
ELEMENTS
 1 K 1 2
 2 W 2
PROPS
 K SPRING KX={K} FX=30 RULE=BILINEAR R=0.1
 W CONTACT GAP=0.05 LAW=KELVIN_VOIGT K=1E5 E=0.6
WEIGHTS
 2 {10 * M}
FORCES
 SINE 2 {F} OMEGA={0.8 * W}
ANALYSIS
 HISTORY 6 METHOD=EXACT
"""
    r = run_text(wall)
    assert len(r.tables["collisions"]) > 3 and r.check() < 1e-9


# ---------------------------------------------------------------- free vibration


def test_free_vibration_from_initial_displacement_and_velocity() -> None:
    u0, v0, xi = 0.02, -0.3, 0.05
    r = oscillator(f"INITIAL\n 2 UX={u0} VX={v0}", xi)
    wd = W * math.sqrt(1 - xi**2)
    t = r.time
    want = np.exp(-xi * W * t) * (u0 * np.cos(wd * t) + (v0 + xi * W * u0) / wd * np.sin(wd * t))
    same(r.u[:, 1, 0], want)


@pytest.mark.parametrize("xi", [0.0, 0.05])
def test_snap_back(xi: float) -> None:
    """Pulled by F and let go: what a step force of -F adds to the static displacement."""
    r = oscillator(f"LOADS\n 2 {F} HELD=NO", xi)
    same(r.u[:, 1, 0], F / K - F * step_response(r.time, xi))


def test_snap_back_of_a_spring_that_has_yielded() -> None:
    """Pulled to d beyond yield it unloads elastically, about the plastic deformation that is left,
    until it yields the other way at a force of F - 2 Fy.
    """
    fy, r = 40.0, 0.1
    deck = OSCILLATOR.replace(f"SPRING KX={K}", f"SPRING KX={K} FX={fy} RULE=BILINEAR R={r}")
    res = run_text(deck.format(f"LOADS\n 2 {F} HELD=NO"))
    d = fy / K + (F - fy) / (r * K)
    back = math.acos((F - 2 * fy) / F) / W
    early = res.time < back
    same(res.u[early, 1, 0], d - F / K * (1 - np.cos(W * res.time[early])))
    assert early.sum() > 10 and res.check() < 1e-9


def test_snap_back_about_what_is_held() -> None:
    """Loads on the same node, one held: it swings about the held one's displacement."""
    r = oscillator(f"LOADS\n 2 {F} HELD=NO\n 2 12")
    same(r.u[:, 1, 0], (12 + F * np.cos(W * r.time)) / K)


def test_snap_back_of_a_frame_is_its_modes() -> None:
    """From the static shape under a force on a massless node, each mode swings on its own."""
    more = "LOADS\n 3 30 HELD=NO\n 5 0 -80 HELD=NO\n 2 0 -20\n"
    r = run_text(FRAME.format(more=more))
    assert r.check() < 1e-9
    s = scene_of(FRAME.format(more=more)).structure
    n, modes = s.n_free, s.free_vibration
    k = s.stiffness[:n, :n]
    start, rest = np.linalg.solve(k, s.loads[:n]), np.linalg.solve(k, s.retained_loads[:n])
    # by the dynamic DOFs: massless ones follow at once, also from the start
    finite = np.isfinite(modes.omega) & (modes.omega < 1e6)
    shapes, omega = modes.shapes[:, finite], modes.omega[finite]
    amplitude = shapes.T @ s.mass[:n, :n] @ (start - rest)
    u = rest[:, None] + shapes @ (amplitude[:, None] * np.cos(omega[:, None] * r.time))
    for node in (2, 3, 5):
        for d in range(3):
            i = s.dofs.free.index((node, d))
            got = r.u[:, r.nodes.index(node), d]
            np.testing.assert_allclose(got, u[i], rtol=0, atol=1e-9 * np.abs(u[i]).max())


def test_loads_let_go_act_in_static_only() -> None:
    """FROM=REST never knew them; the static tables show them."""
    deck = OSCILLATOR.format(f"LOADS\n 2 {F} HELD=NO").replace("ANALYSIS", "ANALYSIS\n STATIC")
    r = run_text(deck.replace("METHOD=EXACT", "METHOD=EXACT FROM=REST"))
    assert r.tables["static_displacement"]["x"][1] == pytest.approx(F / K, rel=1e-14)
    assert not r.u.any()


def test_the_report_names_the_loads_that_are_let_go(tmp_path: Path) -> None:
    deck = tmp_path / "deck.inp"
    deck.write_text(OSCILLATOR.format("LOADS\n 2 50 HELD=NO\n 2 0 -3"))
    with results_of(deck) as r:
        assert len(r.table("loads")) == 2
        assert r.note("loads") == "Removed where the history starts (HELD=NO): 50 0 0 on 2."


# ---------------------------------------------------------------- ground that turns


TURN = "0,0,0.2,3,0.5,-2,0.5,1,1.1,0"  # with a jump [rad/T^2]


def test_a_turning_base_is_forces_of_inertia() -> None:
    """About (1, -0.5): a node at (x, y) gets FX = m (y + 0.5), FY = -m (x - 1), MZ = -J times the turn."""
    x0, y0 = 1.0, -0.5
    push = "".join(
        f" TABLE {node} {mx * (y - y0)} {-my * (x - x0)} {-j} POINTS={TURN}\n"
        for node, x, y, mx, my, j in ((2, 0, 3, 50, 40, 3), (3, 4, 3, 70, 60, 0))
    )
    forced = run_text(FRAME.format(more=RAYLEIGH + "FORCES\n" + push))
    stationary = run_text(
        FRAME.format(more=RAYLEIGH + f"EQUAKE\n TABLE DIRECTION=R ABOUT={x0},{y0} POINTS={TURN}")
    )
    same(stationary.u, forced.u, 1e-12)
    assert np.abs(stationary.u).max() > 1e-4
    # accelerations are total: those of the relative motion and of the ground
    alpha = np.interp(forced.time, [0, 0.2, 0.5], [0, 3, -2])
    early = forced.time < 0.5
    for i, (x, y) in enumerate([(0, 0), (0, 3), (4, 3), (4, 0), (2, 3)]):
        for d, arm in enumerate((-(y - y0), x - x0, 1.0)):
            difference = (stationary.a - forced.a)[early, i, d]
            np.testing.assert_allclose(difference, arm * alpha[early], rtol=0, atol=1e-9)


def test_a_turning_base_is_all_supports_on_one_rigid_body() -> None:
    """In the total form the supports move on circles about the point; less the rigid motion, the same."""
    x0, y0 = 1.0, -0.5
    card = f"EQUAKE\n TABLE DIRECTION=R ABOUT={x0},{y0} POINTS={TURN}"
    relative = run_text(FRAME.format(more=card).replace("4 4 0 FIX=XY", "4 4 0 FIX=XYR"))
    total = run_text(FRAME.format(more=card + " SUPPORTS=1,4").replace("4 4 0 FIX=XY", "4 4 0 FIX=XYR"))
    angle = total.u[:, 0, 2]
    assert np.abs(angle).max() > 0.05
    for i, (x, y) in enumerate([(0, 0), (0, 3), (4, 3), (4, 0), (2, 3)]):
        rigid = np.outer(angle, [-(y - y0), x - x0, 1.0])
        np.testing.assert_allclose(total.u[:, i] - rigid, relative.u[:, i], rtol=0, atol=1e-11)
    assert total.check() < 1e-9 and relative.check() < 1e-9


def test_only_fixed_directions_of_a_support_turn() -> None:
    """A pinned support moves along with the body and turns freely in it."""
    more = f"EQUAKE\n TABLE DIRECTION=R POINTS={TURN} SUPPORTS=1,4"
    r = run_text(FRAME.format(more=more))
    angle = r.u[:, 0, 2]
    same(r.u[:, 3, 1], 4 * angle)
    assert np.abs(r.u[:, 3, 2] - angle).max() > 1e-6


# ---------------------------------------------------------------- travelling waves


BRIDGE = """
GRAVITY 10
PARAM c = 250
NODES
 1 0 0 FIX=XYR
 2 30 0 FIX=XYR
 3 70 0 FIX=XYR
 11 0 8
 12 30 8
 13 70 8
ELEMENTS
 1 PIER 1 11
 2 PIER 2 12
 3 PIER 3 13
 4 DECK 11 12
 5 DECK 12 13
 6 GAP 11 12
PROPS
 PIER FRAME E=3e7 A=1 I=0.1
 DECK FRAME E=3e7 A=2 I=0.5
 GAP CONTACT GAP=0.02 LAW=LINEAR K=1e6
WEIGHTS
 11,12,13 800
DAMPING
 RAYLEIGH ALPHA=0.3 BETA=0.001
{}
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 2 METHOD=EXACT
"""


@pytest.fixture
def record(tmp_path: Path) -> str:
    path = tmp_path / "made_up.txt"
    t = np.arange(151) * 0.01
    path.write_text("".join(f"{x:.2f} {0.4 * math.sin(23 * x) * x * math.exp(-2 * x):.6f}\n" for x in t))
    return str(path)


@pytest.mark.parametrize("speed", [250.0, -400.0])
def test_a_wave_is_the_record_shifted_by_hand(record: str, speed: float) -> None:
    wave = run_text(BRIDGE.format(f'EQUAKE\n RECORD "{record}" SUPPORTS=1,2,3 WAVE={speed}'))
    reached = 0.0 if speed > 0 else 70.0
    cards = "".join(
        f' RECORD "{record}" SUPPORTS={node} START={-(x - reached) / speed!r}\n'
        for node, x in ((1, 0.0), (2, 30.0), (3, 70.0))
    )
    byhand = run_text(BRIDGE.format("EQUAKE\n" + cards))
    same(wave.u, byhand.u, 1e-12)
    # each support has moved as the first one did
    first, second, late = (0, 1, 12) if speed > 0 else (2, 1, 10)  # samples of 0.01 s
    same(wave.u[late:, second, 0], wave.u[:-late, first, 0], 1e-12)
    assert wave.check() < 1e-9
    assert len(wave.tables["motions"]) == 3


def test_a_fast_wave_moves_all_supports_at_once(record: str) -> None:
    """The difference from uniform motion falls as 1/c, over eleven decades, to rounding."""
    together = run_text(BRIDGE.format(f'EQUAKE\n RECORD "{record}" SUPPORTS=1,2,3')).u
    off = {}
    for speed in (1e4, 1e6, 1e15):
        wave = run_text(BRIDGE.format(f'EQUAKE\n RECORD "{record}" SUPPORTS=1,2,3 WAVE={speed}')).u
        off[speed] = np.abs(wave - together).max() * speed
    assert off[1e4] == pytest.approx(off[1e6], rel=0.01)
    assert off[1e15] == pytest.approx(off[1e6], rel=1e-3)
    assert off[1e15] / 1e15 < 1e-12 * np.abs(together).max()


def test_uniform_total_motion_is_the_relative_motion_and_the_ground(record: str) -> None:
    together = run_text(BRIDGE.format(f'EQUAKE\n RECORD "{record}" SUPPORTS=1,2,3'))
    relative = run_text(BRIDGE.format(f'EQUAKE\n RECORD "{record}"'))
    ground = together.u[:, :1, :]
    assert np.abs(together.u - ground - relative.u).max() < 1e-11 * np.abs(together.u).max()


def test_a_wave_of_a_moving_sine(record: str) -> None:
    """A ground that starts in motion goes on with it until the wave comes: no jump anywhere."""
    deck = BRIDGE.format("EQUAKE\n SINE AMPLITUDE=2 PERIOD=0.8 SUPPORTS=1,2,3 WAVE=100").replace(
        "EVERY=0.01", "EVERY=0.1"
    )
    r = run_text(deck)
    w = 2 * math.pi / 0.8
    for node, delay in ((1, 0.3), (2, 0.7)):
        s = r.time - delay
        want = np.where(s < 0, -2 / w * s, -2 / w**2 * np.sin(w * s))
        same(r.u[:, node, 0], want)


# ---------------------------------------------------------------- stepping methods


@pytest.mark.parametrize("method", ["NEWMARK", "CENTRAL"])
def test_steps_follow_a_force_at_their_order(method: str) -> None:
    """Against the closed form of a ramp that ends between two steps."""
    rise = 0.503
    deck, off = OSCILLATOR.format(f"FORCES\n TABLE 2 {F} POINTS=0,0,{rise},1,4,1"), []
    for dt in (0.01, 0.005, 0.0025):
        r = run_text(deck, method=method, dt=dt)
        want = F / rise * (ramp_response(r.time) - ramp_response(r.time - rise))
        off.append(np.abs(r.u[:, 1, 0] - want).max())
    assert np.log2(np.array(off[:-1]) / off[1:]) == pytest.approx(2.0, abs=0.05)


def test_steps_and_exact_agree_under_everything() -> None:
    """Ground motion, forces on nodes with and without mass, held loads."""
    more = (
        RAYLEIGH
        + """EQUAKE
 SINE AMPLITUDE=2 PERIOD=0.5
 TABLE DIRECTION=R ABOUT=1,0 POINTS=0,0,0.3,0.4,0.8,0
FORCES
 SINE 2,3 100 -20 5 PERIOD=0.21
 TABLE 5 3 -40 POINTS=0,0,0.4,1,0.9,-1,1.2,0
LOADS
 3 20 -30
"""
    )
    exact, steps = (
        run_text(FRAME.format(more=more), method=m, dt=d) for m, d in (("EXACT", None), ("NEWMARK", 1e-3))
    )
    np.testing.assert_allclose(steps.u, exact.u, rtol=0, atol=1e-4 * np.abs(exact.u).max())
    with_mass = np.s_[:, 1:3, 0]  # those of massless nodes ring under the average acceleration
    np.testing.assert_allclose(
        steps.a[with_mass], exact.a[with_mass], rtol=0, atol=1e-3 * np.abs(exact.a[with_mass]).max()
    )
