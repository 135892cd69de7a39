"""Rigid contacts: impacts by Eqs 1-2, rows of masses, bounces until rest, forces of closed contacts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from decks import scene_of, structure_of
from pound_solve.catalog import catalog
from pound_solve.integrate.closed_form.decomposition import make_propagator
from pound_solve.integrate.propagators.state_space import held_space, state_space
from pound_solve.integrate.rigid.contacts import RigidContacts
from pound_solve.integrate.rigid.instants import NO_REBOUND, REBOUND_ROUNDING
from pound_solve.integrate.tolerances import EVENT_TOLERANCE
from pound_solve.numerics import polynomial
from pound_solve.numerics.types import Array
from pound_solve.structure.assembly import AssemblyError
from tiers import each_once
from unit.test_taylor import HINGE, LOADS, frames
from verification.cases import Ran, run_text

pytestmark = pytest.mark.full
BOTH = pytest.mark.parametrize("method", ["EXACT", "TAYLOR"])


def row(
    masses: list[float],
    speeds: list[float],
    e: float | list[float],
    gap: float = 0.0,
    t: float = 1.0,
    more: str = "",
) -> str:
    """Free masses in a row along x, a contact between each and the next."""
    n = len(masses)
    es = [e] * (n - 1) if isinstance(e, float | int) else e
    lines = [f"UNITS N m s\nGRAVITY 1\nNODES\n 1 TO {n} 1 TO {n} 0 FIX=YR\nELEMENTS"]
    lines += [f" {i} C{i} {i} {i + 1}" for i in range(1, n)]
    lines += ["PROPS"]
    lines += [f" C{i + 1} CONTACT GAP={gap!r} LAW=STEREOMECHANICS E={x!r}" for i, x in enumerate(es)]
    lines += ["WEIGHTS", *(f" {i + 1} {m!r}" for i, m in enumerate(masses))]
    lines += ["INITIAL", *(f" {i + 1} VX={v!r}" for i, v in enumerate(speeds)), more]
    return "\n".join([*lines, f"ANALYSIS\n HISTORY {t!r} FROM=REST"])


def speeds(r: Ran) -> Array:
    return np.asarray(r.v[-1, :, 0])


# ---------------------------------------------------------------------- impacts


@BOTH
@settings(max_examples=8)
@given(
    st.floats(0.01, 100.0),
    st.floats(0.01, 100.0),
    st.floats(-3.0, 3.0),
    st.floats(0.01, 10.0),
    st.floats(0.0, 1.0),
)
def test_two_masses_part_by_equations_1_and_2(
    method: str, m1: float, m2: float, share: float, approach: float, e: float
) -> None:
    v2 = share * approach
    v1, gap = v2 + approach, 0.1
    r = run_text(row([m1, m2], [v1, v2], e, gap, 2 * gap / approach), method=method)
    after = [
        v1 - (1 + e) * m2 / (m1 + m2) * (v1 - v2),
        v2 - (1 + e) * m1 / (m1 + m2) * (v2 - v1),
    ]  # Cole et al. 2011, Eqs 1-2
    assert speeds(r) == pytest.approx(after, abs=1e-12 * (abs(v1) + abs(v2)))
    c = r.tables["collisions"]
    m = m1 * m2 / (m1 + m2)
    assert c["t_start"] == pytest.approx([gap / approach], rel=1e-12)
    assert c["approach_velocity"] == pytest.approx([approach], rel=1e-12)
    assert c["impulse"] == pytest.approx([(1 + e) * m * approach], rel=1e-12)
    if e > 1e-3:
        assert c["separation_velocity"] == pytest.approx([e * approach], rel=1e-9)
        assert np.isnan(c["peak_force"]).all()  # no number can be
    lost = float(r.column("contact_summary", "energy_lost")[0])
    assert lost == pytest.approx(0.5 * m * approach**2 * (1 - e * e), abs=1e-12 * m * approach**2)
    assert r.check() < 1e-12


@BOTH
@pytest.mark.parametrize("gap", [0.0, 0.01])
@pytest.mark.parametrize("n", [3, 5])
def test_a_row_of_equal_masses_hands_the_impact_through(method: str, n: int, gap: float) -> None:
    """Newton's cradle, touching or not."""
    r = run_text(row([2.0] * n, [1.0] + [0.0] * (n - 1), 1.0, gap), method=method)
    assert speeds(r) == pytest.approx([0.0] * (n - 1) + [1.0], abs=1e-14)
    assert r.column("collisions", "impulse") == pytest.approx([2.0] * (n - 1), rel=1e-13)


@BOTH
def test_two_masses_arrive_two_leave(method: str) -> None:
    r = run_text(row([1.0] * 5, [1.0, 1.0, 0.0, 0.0, 0.0], 1.0), method=method)
    assert speeds(r) == pytest.approx([0, 0, 0, 1, 1], abs=1e-14)


@BOTH
def test_what_is_symmetric_stays_symmetric(method: str) -> None:
    """A mass that is hit from both sides at once stays where it is."""
    r = run_text(row([1.0, 3.0, 1.0], [1.0, 0.0, -1.0], 0.7, 0.1), method=method)
    assert speeds(r) == pytest.approx([-0.7, 0.0, 0.7], abs=1e-14)
    assert len(r.tables["collisions"]) == 2


@settings(max_examples=25)
@given(st.integers(2, 6), st.integers(0, 10**6))
def test_impacts_keep_momentum_and_never_win_energy(n: int, seed: int) -> None:
    """Rows of any masses that all touch, each contact with an E of its own."""
    rng = np.random.default_rng(seed)
    masses, v = 10.0 ** rng.uniform(-2, 2, n), rng.normal(size=n)
    es = rng.choice([0.0, 0.3, 0.8, 1.0], n - 1).tolist()
    r = RigidContacts(scene_of(row(masses.tolist(), v.tolist(), es)))
    rates = r.rows @ v
    impulse, lost, after = r.impact(rates, np.ones(n - 1, bool), NO_REBOUND * np.abs(rates))
    w = v - r.velocity_change @ impulse
    scale = float(masses @ v**2)
    assert np.all(impulse >= 0.0) and lost.sum() >= -1e-14 * scale
    assert after == pytest.approx(r.rows @ w, abs=1e-10 * np.abs(w).max())
    assert np.all(after <= 1e-10 * np.abs(w).max())
    assert masses @ w == pytest.approx(masses @ v, abs=1e-11 * masses @ np.abs(v))
    assert 0.5 * scale - 0.5 * masses @ w**2 == pytest.approx(lost.sum(), abs=1e-10 * scale)


@pytest.mark.parametrize("e", [0.0, 0.5])
def test_impacts_end_where_nothing_has_moved_before(e: float) -> None:
    """Each passes on a share of what is left, down to the least of all numbers."""
    r = RigidContacts(scene_of(row([900 / 9.81] * 6, [3e-14, 0.0, 0.0, 0.0, 0.0, 0.0], e)))
    v = np.array([3e-14, 0.0, 0.0, 0.0, 0.0, 0.0])
    impulse, _, after = r.impact(r.rows @ v, np.ones(5, bool), np.zeros(5))
    assert np.all(after <= 1e-12 * v[0]) and np.all(impulse > 0.0)
    assert (v - r.velocity_change @ impulse).sum() == pytest.approx(v[0], rel=1e-12)


@BOTH
def test_redundant_contacts_share(method: str) -> None:
    """Two contacts between the same two masses act as one."""
    deck = row([1.0, 2.0], [1.0, 0.0], 0.0, more="LOADS\n 1 1 0").replace("PROPS", " 9 C1 1 2\nPROPS")
    r = run_text(deck, method=method)
    # then the load of 1 pushes 3: the second gets two thirds of it
    assert speeds(r) == pytest.approx([2 / 3, 2 / 3], rel=1e-12)
    assert r.force[-1] == pytest.approx([1 / 3, 1 / 3], rel=1e-12)
    assert r.check() < 1e-12


# ---------------------------------------------------------------------- bounces and rest

BALL = """UNITS N m s
PARAM e = 0.5   h = 0.5   g = 10   t = 12
GRAVITY g
NODES
 1 0 0 FIX=XR
ELEMENTS
 1 FLOOR 1
PROPS
 FLOOR CONTACT GAP=h ANGLE=-90 LAW=STEREOMECHANICS E=e
WEIGHTS
 1 2*g
LOADS
 1 0 -2*g
OUTPUT
 EVERY=0.1
ANALYSIS
 HISTORY t FROM=REST
"""


@BOTH
@pytest.mark.parametrize("e", [0.0, 0.05, 0.5, 0.9])
def test_a_ball_bounces_by_the_closed_form_until_it_rests(method: str, e: float) -> None:
    """Impact n at t0 + 2 v0/g (e + ... + e^n), v0 e^n; rest where that comes to an end, sooner by what
    approaches below the threshold would have taken."""
    r = run_text(BALL, {"e": e}, method=method)
    g, h = 10.0, 0.5
    t0, v0 = math.sqrt(2 * h / g), math.sqrt(2 * h * g)
    c = r.tables["collisions"]
    flights = 2 * v0 / g * e ** np.arange(1, len(c))
    off = np.abs(c["t_start"] - t0 - np.append(0.0, np.cumsum(flights)))
    assert np.all(
        off <= 1e-13 + 1e-15 / (1 - e) / c["approach_velocity"]
    )  # the rounding of a place is a time
    few = c["approach_velocity"] > 1e-2
    assert c["approach_velocity"][few] == pytest.approx(v0 * e ** np.arange(few.sum()), rel=1e-10)
    assert np.isnan(c["t_end"][-1]) and (c["t_end"][:-1] == c["t_start"][:-1]).all()
    zeno = t0 + 2 * v0 / g * e / (1 - e)
    slow = max(NO_REBOUND * v0, math.sqrt(2 * g * REBOUND_ROUNDING * EVENT_TOLERANCE * 2 * h))
    assert -1e-14 <= zeno - c["t_start"][-1] < 2 * slow * 2 / g / (1 - e) + 1e-14
    assert r.force[-1, 0] == c["peak_force"][-1] == pytest.approx(20.0, rel=1e-14)
    assert r.u[-1, 0, 1] == pytest.approx(-h, rel=1e-15) and r.v[-1, 0, 1] == 0.0
    # all the impulse is the weight's
    assert c["impulse"].sum() == pytest.approx(20.0 * 12.0, rel=1e-12)
    assert float(r.column("contact_summary", "energy_lost")[0]) == pytest.approx(20.0 * h, rel=1e-12)
    assert r.check() < 1e-12


@BOTH
def test_a_stack_rests_and_each_contact_bears_what_lies_on_it(method: str) -> None:
    deck = """UNITS N m s
GRAVITY 10
NODES
 1 0 1 FIX=XR
 2 0 2 FIX=XR
 3 0 3 FIX=XR
ELEMENTS
 1 A 1
 2 B 2 1
 3 B 3 2
PROPS
 A CONTACT GAP=0.02 ANGLE=-90 LAW=STEREOMECHANICS E=0.4
 B CONTACT GAP=0.01 LAW=STEREOMECHANICS E=0.4
WEIGHTS
 1 10
 2 20
 3 40
LOADS
 1 0 -10
 2 0 -20
 3 0 -40
ANALYSIS
 HISTORY 3 FROM=REST
"""
    r = run_text(deck, method=method)
    assert r.status == "done"
    assert r.force[-1] == pytest.approx([70.0, 60.0, 40.0], rel=1e-12)
    assert r.u[-1, :, 1] == pytest.approx([-0.02, -0.03, -0.04], rel=1e-12)
    assert r.column("contact_summary", "impulse") == pytest.approx([210.0, 180.0, 120.0], rel=1e-9)
    assert r.check() < 1e-12


WALL = """UNITS N m s
PARAM e = 1   w = 5   gap = 0   x0 = -1   v0 = 0   t = 10   xi = 0
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
ELEMENTS
 1 K 1 2
 2 STOP 2
PROPS
 K SPRING KX=w^2
 STOP CONTACT GAP=gap LAW=STEREOMECHANICS E=e
WEIGHTS
 2 1
DAMPING
 RAYLEIGH XI=xi OMEGA=w,3*w
INITIAL
 2 UX=x0 VX=v0
ANALYSIS
 HISTORY t
"""


@BOTH
@pytest.mark.parametrize("gap", [0.0, 0.4, -0.0, 0.9])
def test_an_oscillator_against_a_wall_is_periodic(method: str, gap: float) -> None:
    """E = 1: the wall mirrors the motion; from one impact to the next the phase goes from -p to p.  Energy
    1/2 w^2 is kept for all of 10 s."""
    r = run_text(WALL, {"gap": gap}, method=method)
    w = 5.0
    phase = math.acos(-gap)  # of cos, from x = -1 on to x = gap
    c = r.tables["collisions"]
    expected = (phase + 2 * phase * np.arange(len(c))) / w
    assert len(c) == int((10 * w / phase + 1) / 2)
    assert c["t_start"] == pytest.approx(expected, rel=1e-12)
    assert c["approach_velocity"] == pytest.approx(w * math.sqrt(1 - gap * gap), rel=1e-12)
    assert r.check() < 1e-12


@BOTH
def test_a_damped_oscillator_against_a_wall(method: str) -> None:
    """At gap 0 every half period of the damped oscillation; each loses e and the damping of that time."""
    e, xi, w = 0.8, 0.05, 5.0
    c = run_text(WALL, {"e": e, "xi": xi, "x0": 0, "v0": -2, "t": 6}, method=method).tables["collisions"]
    half = math.pi / (w * math.sqrt(1 - xi * xi))
    n = np.arange(1, len(c) + 1)
    assert len(c) == int(6 / half)
    assert c["t_start"] == pytest.approx(half * n, rel=1e-12)
    expected = 2 * e ** (n - 1) * np.exp(-xi * w * half * n)
    assert c["approach_velocity"] == pytest.approx(expected, rel=1e-11)


def test_a_stiff_spring_tends_to_an_elastic_impact() -> None:
    """The contact time of a LINEAR contact falls with its stiffness' root, and with it the delay of the
    second impact."""
    rigid = run_text(WALL, {"gap": 0.5, "t": 2}).column("collisions", "t_start")[1]
    off = []
    for k in (1e4, 1e6, 1e8):
        deck = WALL.replace("STEREOMECHANICS E=e", f"LINEAR K={k!r}")
        off.append(run_text(deck, {"gap": 0.5, "t": 2}).column("collisions", "t_start")[1] - rigid)
    assert off[0] / off[1] == pytest.approx(10.0, rel=0.1)
    assert off[1] / off[2] == pytest.approx(10.0, rel=0.02)


# ---------------------------------------------------------------------- closed contacts


def random_block(seed: int, light: int = 0) -> tuple[Array, Array, Array, Array]:
    rng = np.random.default_rng(seed)
    n = 6
    x, y = rng.normal(size=(2, n, n))
    m = np.diag(rng.uniform(0.5, 2.0, n))
    m[n - light :, n - light :] = 0.0
    rows = np.zeros((2, n))
    rows[0, :2], rows[1, 1:4] = (1.0, -1.0), (0.6, 0.0, -0.8)
    return m, 0.1 * y @ y.T, x @ x.T + 0.2 * np.eye(n), rows


@pytest.mark.parametrize("light", [0, 1, 2])
def test_what_is_held_stays_held_and_the_rest_balances(light: int) -> None:
    """``M a + C v + K u - p`` is made of the rows alone, ``rows u = x(t)``, at any time."""
    m, c, k, rows = random_block(3, light)
    n = len(m)
    rng = np.random.default_rng(light)
    p, x = rng.normal(size=(3, n)), rng.normal(size=(3, 2))
    first, second = np.array([x[1], 2 * x[2], 0 * x[2]]), np.array([2 * x[2], 0 * x[2], 0 * x[2]])
    whole = np.hstack([p, x, first, second])
    propagator = make_propagator(m, c, k, np.zeros((n, 1)), rows)
    g, q0 = propagator.load_forcing(whole), propagator.state_of(*rng.normal(size=(2, n)))
    u_p, v_p = propagator.u_p, propagator.v_p
    assert u_p is not None and v_p is not None
    for t in (0.0, 0.3, 2.0):
        q = propagator.at(q0, g, t)
        rate = propagator.rate_rows(np.eye(len(q), dtype=q.dtype)) @ q + polynomial.value(g, t)
        f, df = whole[0] + t * whole[1] + t * t * whole[2], whole[1] + 2 * t * whole[2]
        ddf = 2 * whole[2]
        u = (propagator.u_q @ q).real + u_p @ f
        v = (propagator.v_q @ q).real + v_p @ f + u_p @ df
        a = (propagator.v_q @ rate).real + v_p @ df + u_p @ ddf
        assert rows @ u == pytest.approx(x[0] + t * x[1] + t * t * x[2], abs=1e-12)
        assert rows @ v == pytest.approx(x[1] + 2 * t * x[2], abs=1e-12)
        rest = m @ a + c @ v + k @ u - f[:n]
        assert np.abs(rest - np.linalg.pinv(rows) @ (rows @ rest)).max() < 1e-11
        assert np.abs(rest).max() > 0.1


def test_nothing_held_is_no_constraint() -> None:
    m, c, k, _ = random_block(1)
    free, held = state_space(m, c, k), held_space(m, c, k, np.eye(6)[:1])
    assert len(held.a) == len(free.a) - 2


@BOTH
def test_a_mass_is_carried_by_a_moving_support_until_that_slows_down(method: str) -> None:
    """The support accelerates as sin, the mass touches it and is pushed by m a; they part at half the
    period with the velocity reached."""
    deck = """UNITS N m s
PARAM w = 2*pi
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 0 0 FIX=YR
ELEMENTS
 1 PUSH 2 1
PROPS
 PUSH CONTACT GAP=0 ANGLE=180 LAW=LAGRANGE
WEIGHTS
 2 3
EQUAKE
 SINE AMPLITUDE=5 PERIOD=1 VELOCITY0=0 SUPPORTS=1
OUTPUT
 EVERY=0.05
ANALYSIS
 HISTORY 0.8
"""
    r = run_text(deck, method=method)
    w, t = 2 * math.pi, r.time
    assert r.status == "done", r.message
    mass = r.nodes.index(2)
    pushed = t <= 0.5
    assert r.force[pushed, 0] == pytest.approx(15.0 * np.sin(w * t[pushed]), abs=1e-9)
    assert (r.force[t > 0.51, 0] == 0.0).all()
    v = np.where(pushed, 5 / w * (1 - np.cos(w * t)), 10 / w)
    assert r.v[:, mass, 0] == pytest.approx(v, abs=1e-9)
    c = r.tables["collisions"]
    assert c["t_end"][-1] == pytest.approx(0.5, rel=1e-9)
    assert c["impulse"].sum() == pytest.approx(3 * 10 / w, rel=1e-9)
    assert r.check() < 1e-11


@BOTH
def test_a_spring_lifts_its_foot_off_where_the_floor_would_have_to_pull(method: str) -> None:
    """Two masses joined by a spring, the lower one on the floor: it leaves where the spring pulls its
    weight, at a time of the upper one's oscillation."""
    deck = """UNITS N m s
GRAVITY 10
NODES
 1 0 1 FIX=XR
 2 0 2 FIX=XR
ELEMENTS
 1 FLOOR 1
 2 S 1 2
PROPS
 FLOOR CONTACT GAP=0 ANGLE=-90 LAW=LAGRANGE
 S SPRING KY=100
WEIGHTS
 1 10
 2 10
LOADS
 1 0 -10
 2 0 -10
INITIAL
 2 VY=5
ANALYSIS
 HISTORY 0.3 FROM=REST
"""
    r = run_text(deck, method=method)
    c = r.tables["collisions"]
    # upper: y = -0.1 + 0.1 cos wt + v/w sin wt, w = 10; the floor opens at y = 0.1
    size, phase = math.hypot(0.1, 0.5), math.atan2(0.5, 0.1)
    transition = (phase - math.acos(0.2 / size)) / 10
    assert c["t_end"][0] == pytest.approx(transition, rel=1e-12)
    assert c["peak_force"][0] == pytest.approx(10.0, rel=1e-12)
    assert r.check() < 1e-12


BARS = """UNITS kN m s
PARAM n = 20   v = 1   t = 0.06
GRAVITY 9.81
NODES
 100 TO 100+n 0 TO 20 0 FIX=YR
 1000 TO 1000+n 20 TO 70 0 FIX=YR
ELEMENTS
 101 TO 100+n D1 100 TO 99+n 101 TO 100+n
 1001 TO 1000+n D2 1000 TO 999+n 1001 TO 1000+n
 900 C 100+n 1000
PROPS
 D1 SPRING KX=1881300*n
 D2 SPRING KX=752520*n
 C CONTACT GAP=0 ANGLE=0 LAW=LAGRANGE
WEIGHTS
 100,100+n 1600/(2*n)
 101 TO 99+n 1600/n
 1000,1000+n 3000/(2*n)
 1001 TO 999+n 3000/n
INITIAL
 100 TO 100+n VX=v
OUTPUT
 EVERY=1e-3
ANALYSIS
 HISTORY t
"""


@BOTH
def test_bars_converge_to_the_theory_of_waves(method: str) -> None:
    """The paper's diaphragms (Table IV) at 1 m/s: plateau F0 = Z1 Z2/(Z1 + Z2), contact until T2,
    restitution 0.52664; what their end nodes lose at touch falls with 1/n."""
    m1, m2, f0 = 1600 / 9.81, 3000 / 9.81, 8129.6
    m = m1 * m2 / (m1 + m2)
    off, lost = [], []
    for n in (5, 20, 50):
        r = run_text(BARS, {"n": n}, method=method)
        c = r.tables["collisions"]
        off.append(abs(c["impulse"].sum() / m - 1 - 0.52664))
        before = c[c["t_start"] < 0.0403]
        assert before["impulse"].sum() == pytest.approx(c["impulse"].sum())
        first = m1 * m2 / (m1 + m2) / (2 * n)
        lost.append(float(r.column("contact_summary", "energy_lost")[0]))
        assert lost[-1] >= 0.5 * first * (1 - 1e-9)
        plateau = r.force[(r.time > 0.004) & (r.time < 0.016), 0]
        assert plateau.mean() == pytest.approx(f0, rel=0.5 / n + 1e-3)
        assert r.check() < 1e-12
    assert off[0] > 4 * off[1] > 4 * off[2] and off[2] < 5e-4
    assert lost[0] / lost[1] > 3.0 and lost[1] / lost[2] > 2.0


# ---------------------------------------------------------------------- refusals


def test_other_methods_refuse_in_words() -> None:
    for method in ("NEWMARK", "CENTRAL", "HHT"):
        r = run_text(WALL, {"gap": 0.5}, method, 0.001)
        assert r.status == "stopped" and f"A505 at t = 0 s: {method} knows no rigid contact" in r.message
    assert run_text(WALL, {"gap": 0.5}).status == "done"  # AUTO takes EXACT


def test_no_method_is_advised_where_none_takes_it() -> None:
    """A rigid contact beside a law that has no power series."""
    light = "\n L SPRING KX=10\n D CONTACT GAP=9 ANGLE=0 LAW=HERTZ K=1"
    curved = WALL.replace("\nPROPS", "\n 3 L 2 3\n 4 D 3\nPROPS" + light)
    curved = curved.replace("\nELEMENTS", "\n 3 1 0 FIX=YR\nELEMENTS")
    for method in catalog().family("method"):
        dt = 0.001 if catalog().family("method")[method].field("DT") else None
        r = run_text(curved, {"gap": 0.5}, method, dt)
        assert r.status == "stopped" and r.message.startswith(
            "A505 at t = 0 s: no method takes a rigid contact, which STEREOMECHANICS of element 2 is, "
            "where the law HERTZ of element 4 is curved and meets a node without mass: give"
        ), r.message


def test_weightless_nodes_and_overlaps_are_refused() -> None:
    with pytest.raises(AssemblyError, match="give its nodes weight"):
        structure_of(WALL.replace("WEIGHTS\n 2 1", ""))
    with pytest.raises(AssemblyError, match="do not overlap"):
        structure_of(WALL, {"gap": -0.1})
    r = run_text(WALL.replace("WEIGHTS\n 2 1", "").replace("E=e", "E=e MASSES=1"))
    assert r.status == "stopped" and "touches a degree of freedom without mass" in r.message
    r = run_text(WALL, {"gap": 0.5, "x0": 0.6})
    assert r.status == "stopped" and "overlaps by 0.1 at the start" in r.message


@BOTH
def test_a_support_hits_a_mass_at_rest(method: str) -> None:
    """The mass leaves at (1 + e) times the support's velocity; what the support put in balances."""
    deck = """UNITS N m s
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 0 0 FIX=YR
ELEMENTS
 1 PUSH 2 1
PROPS
 PUSH CONTACT GAP=0 ANGLE=180 LAW=STEREOMECHANICS E=0.5
WEIGHTS
 2 3
EQUAKE
 SINE AMPLITUDE=5 PERIOD=1 SUPPORTS=1
ANALYSIS
 HISTORY 0.8
"""
    r = run_text(deck, method=method)
    # -5/w at t = 0, back in its place at half the period with 5/w
    assert r.v[-1, r.nodes.index(2), 0] == pytest.approx(1.5 * 5 / (2 * math.pi), rel=1e-12)
    assert r.column("collisions", "t_start") == pytest.approx([0.5], rel=1e-12)
    assert r.check() < 1e-12


BAR = """UNITS N m s
GRAVITY 1
MASS LUMPED
PARAM n = 13
NODES
 1 TO n+1 0 TO 0.2 0 FIX=YR
ELEMENTS
 1 TO n B 1 TO n 2 TO n+1
 9999 WALL n+1
PROPS
 B FRAME E=2E11 A=4E-4 WGT=3.2
 WALL CONTACT GAP=0.002 ANGLE=0 LAW={law}
INITIAL
 1 TO n+1 VX=100
OUTPUT
 EVERY=2E-6
ANALYSIS
 HISTORY 2.5E-4 METHOD=EXACT FROM=REST
"""


@each_once(
    ("method", ["EXACT", "TAYLOR"]), ("law", ["LAGRANGE", "STEREOMECHANICS E=0"]), ("n", [5, 13, 16, 25])
)
def test_an_elastic_bar_meets_a_rigid_wall(method: str, law: str, n: int) -> None:
    """Its wave runs to the free end and back, at 5000 m/s: contact lasts 2 L / c.  At touch the bar moves
    as one, and the rounding of its displacements is no force that opens the contact.
    """
    r = run_text(BAR.format(law=law), {"n": n}, method)
    assert r.status == "done", r.message
    (summary,) = r.tables["contact_summary"]
    assert summary["closures"] == 1
    assert summary["time_closed"] == pytest.approx(0.4 / 5000.0, rel=0.5 / n)
    mass = 3.2 * 0.2
    speed = float(r.v[-1, :, 0].mean())
    assert summary["impulse"] == pytest.approx(mass * 100.0 + mass * abs(speed), rel=0.1)
    assert r.check() < 1e-9


@each_once(
    ("load", ["one motion of the ground", "supports apart", "forces"]),
    ("law", ["LAGRANGE", "STEREOMECHANICS E=0.5"]),
    at_most=1,
)
def test_frames_with_hinges_come_to_rest_on_each_other(law: str, load: str) -> None:
    """The last hops of a body that comes to rest are below rounding; EXACT and TAYLOR lose the same ones.
    An impact turns rates, and laws that are beyond yield turn back at once.
    """
    deck = frames(hinge=HINGE, load=LOADS[load]).replace("LAW=KELVIN_VOIGT K=60000 E=0.6", f"LAW={law}")
    deck = deck.replace("RAYLEIGH ALPHA=0.4 BETA=0.001", "RAYLEIGH ALPHA=0.4 BETA=0")
    r, e = (run_text(deck, None, method) for method in ("TAYLOR", "EXACT"))
    assert np.abs(r.u - e.u).max() < 1e-11 * np.abs(e.u).max()
    assert np.abs(r.force - e.force).max() <= 1e-9 * np.abs(e.force).max()
    assert len(r.tables["collisions"]) == len(e.tables["collisions"])
    assert r.check() < 1e-11 and e.check() < 1e-11


@BOTH
def test_the_report_tells_impacts_from_forces_and_rigid_bodies_do_not_overlap(method: str) -> None:
    """A mass bounces on a wall and then is pressed to it, by a force that can be told by hand."""
    deck = row([1e9, 2.0], [0.0, -3.0], 0.5, t=8.0, more="LOADS\n 2 FX=-5")
    r = run_text(deck, None, method)
    assert r.status == "done", r.message
    told = dict(r.tables["overview"].tolist())["collisions"]
    (summary,) = r.tables["contact_summary"]
    lasting = np.isfinite(r.tables["collisions"]["peak_force"])
    assert lasting.sum() == 1
    start = f"{len(lasting)}, {len(lasting) - 1} of them instantaneous impacts without a force, "
    assert told.startswith(start + "largest force while closed 5 N at ")
    assert summary["peak_penetration"] == summary["min_gap"] == 0.0
