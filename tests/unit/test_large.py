"""Members that turn with their nodes (LARGE) and P-Delta with the present axial force (PDELTA_VARYING)."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk, ellipkinc

from decks import results_of, structure_of
from kernels import FAST
from pound_solve.analyses import static
from pound_solve.analyses.equilibrium import SupportReactions
from pound_solve.results import Results
from tiers import each_once

pytestmark = pytest.mark.full

KINDS = ("LARGE", "PDELTA_VARYING")


def results(deck: str, folder: Path, name: str = "deck") -> Results:
    path = folder / f"{name}.inp"
    path.write_text(deck)
    return results_of(path, out=folder)


# ---------------------------------------------------------------------- the member

EXTRAS = (
    "",
    "PIN=I",
    "PIN=BOTH",
    "FJ=1e-5,2e-5",
    "RULE=BILINEAR R=0.02 KH=1e5 MI=50 MJ=60",
    "RULE=BILINEAR R=0.02 LP=0.2 MJ=60",
)
SECTIONS = [f"FRAME E=2e8 A=0.01 I=1e-4 G=8e7 AS=0.004 {x}" for x in EXTRAS]
SECTIONS.append("BEAM_COLUMN E=2e8 A=0.01 I=1e-4 PY=2000 MP=300 LP=0.2")


def member(kind: str, section: str, more: str = "") -> str:
    return f"""
GEOMETRY {kind}
NODES
 1 0 0
 2 3 1
ELEMENTS
 1 B 1 2
PROPS
 B {section} END1=0.3 END2=0.2 {more}
"""


@settings(max_examples=40)
@given(
    section=st.sampled_from(SECTIONS),
    turn=st.floats(-9.0, 9.0),
    shift=st.tuples(st.floats(-5, 5), st.floats(-5, 5)),
)
def test_a_member_that_moves_as_a_whole_has_no_forces(section, turn, shift):
    """To rounding of E A, for turns of more than a whole circle."""
    s = structure_of(member("LARGE", section))
    c, z = math.cos(turn), math.sin(turn)
    nodes = {1: np.zeros(2), 2: np.array([3.0, 1.0])}
    u = {}
    for node, at in nodes.items():
        u[node, 0], u[node, 1] = np.array([[c, -z], [z, c]]) @ at - at + shift
        u[node, 2] = turn
    along = nodes[2] / np.linalg.norm(nodes[2])
    for d, node in ((5, 1), (6, 2)):  # closed hinges that stretch
        u[1, d] = along @ [u[node, 0], u[node, 1]]
    u[1, 3] = u[1, 4] = turn
    full = np.array([u[f] for f in s.dofs.free])
    assert np.abs(s.law_rows @ full).max(initial=0.0) < 1e-13
    size = 2e6 * max(np.abs(full).max(), 1.0)
    assert np.abs(s.stiffness @ full + s.corotational.forces(full)).max() < 1e-14 * size
    assert np.abs(s.member_forces(full)).max() < 1e-14 * size


@settings(max_examples=40)
@given(section=st.sampled_from(SECTIONS), seed=st.integers(0, 2**32 - 1))
def test_forces_are_the_gradient_of_the_potential_and_the_tangent_that_of_the_forces(section, seed):
    s = structure_of(member("LARGE", section, "N0=100 M0=20,30"))
    c = s.corotational
    u = 0.4 * np.random.default_rng(seed).normal(size=s.n_free)
    if np.abs(c.quantities(u)[0, 2:4]).max() > 2.0:  # near to no length at all differences mean nothing
        u *= 0.3

    def potential(x):
        return float(c.actions(c.quantities(x)[None])[0, 0, 0])

    steps = 1e-5 * np.eye(len(u))
    slope = np.array([potential(u + e) - potential(u - e) for e in steps]) / 2e-5
    assert np.abs(slope - c.forces(u)).max() < 1e-7 * np.abs(slope).max()
    change = np.array([c.forces(u + e) - c.forces(u - e) for e in steps]) / 2e-5
    tangent = c.stiffness(u)
    assert np.abs(change - tangent).max() < 1e-7 * np.abs(change).max()
    assert np.abs(tangent - tangent.T).max() < 1e-14 * np.abs(tangent).max()


def test_the_string_pushes_across_by_its_present_force():
    """N y / L with N of linear theory and the whole length between the nodes."""
    s = structure_of(member("PDELTA_VARYING", SECTIONS[0], "N0=100"))
    along, length = np.array([3.0, 1.0]) / math.sqrt(10), math.sqrt(10)
    across = np.array([-along[1], along[0]])
    u = np.random.default_rng(1).normal(size=6) * 1e-2
    d = u[3:5] - u[:2]
    n = 100.0 + 2e8 * 0.01 / (length - 0.5) * (along @ d)
    expected = np.zeros(6)
    expected[3:5] = n * (across @ d) / length * across
    expected[:2] = -expected[3:5]
    assert s.corotational.forces(u) == pytest.approx(expected, rel=1e-12, abs=1e-12)


# ---------------------------------------------------------------------- statics


def beam(n: int, loads: str, more: str = "", area: float = 1e6) -> str:
    """A cantilever of length 1 and EI = 1 along x, hardly extensible."""
    return f"""
GEOMETRY LARGE
NODES
 1 0 0 FIX=XYR
 2 TO {n + 1} {1 / n!r} TO 1 0
ELEMENTS
 1 TO {n} B 1 TO {n} 2 TO {n + 1}
PROPS
 B FRAME E=1 A={area} I=1
LOADS
 {n + 1} {loads}
{more}
"""


def tip(deck: str) -> np.ndarray:
    s = structure_of(deck)
    return static.solve(s).u[-3:]


@pytest.mark.parametrize("turns", [0.5, 1.0])
def test_a_cantilever_rolls_into_a_circle(turns):
    """End moment 2 pi EI / L: a whole circle.  The chords of n members are those of n equal arcs with
    the length of the arcs.
    """
    n, a = 10, 2 * math.pi * turns
    x, y, r = tip(beam(n, f"0 0 {a!r}", area=1e4))
    angles = (np.arange(n) + 0.5) * a / n
    assert r == pytest.approx(a, rel=1e-10)
    assert (1 + x, y) == pytest.approx((np.cos(angles).mean(), np.sin(angles).mean()), abs=1e-9)


def test_a_cantilever_under_a_tip_load_that_keeps_its_direction():
    """Bisshopp & Drucker 1945, Quart. Appl. Math. 3: 272-275, by elliptic integrals; order 2."""
    p = 4.0  # P L^2 / EI

    def length(k2):  # of the elastica, less 1
        start = math.asin(1 / math.sqrt(2 * k2))
        return (ellipk(k2) - ellipkinc(start, k2)) / math.sqrt(p) - 1.0

    k2 = brentq(length, 0.5 + 1e-12, 1 - 1e-12, xtol=1e-15)
    end = math.asin(2 * k2 - 1)  # slope of the tip
    down = quad(lambda f: math.sin(f) / math.sqrt(2 * p * (math.sin(end) - math.sin(f))), 0, end)[0]
    across = math.sqrt(2 * math.sin(end) / p)
    assert down == pytest.approx(0.66996, abs=1e-5)  # as printed there
    errors = []
    for n in (8, 16):
        x, y, r = tip(beam(n, f"0 {-p}"))
        errors.append(np.abs([1 + x - across, -y - down, -r - end]).max())
    assert errors[1] < 1e-3 and 3.8 < errors[0] / errors[1] < 4.2


def test_a_column_after_buckling():
    """Elastica of a clamped column under 1.2 times Euler's load (Timoshenko & Gere 1961, section 2.7)."""
    share = 1.2
    m = brentq(lambda m: 2 / math.pi * ellipk(m) - math.sqrt(share), 1e-9, 0.99, xtol=1e-15)
    k, e = ellipk(m), ellipe(m)
    press = share * math.pi**2 / 4
    errors = []
    for n in (8, 16):
        x, y, _ = tip(beam(n, f"{-press!r} {1e-6 * press!r}"))
        errors.append(np.abs([1 + x - (2 * e / k - 1), y - 2 * math.sqrt(m) / k]).max())
    assert errors[1] < 5e-3 and 3.5 < errors[0] / errors[1] < 4.5


TOGGLE = """
GEOMETRY LARGE
NODES
 1 0 0 FIX=XYR
 2 10 1 FIX=R
 3 20 0 FIX=XYR
ELEMENTS
 1 B 1 2
 2 B 2 3
PROPS
 B FRAME E=1000 A=1
ANALYSIS
 {analysis}
"""


def test_two_bars_snap_through(tmp_path):
    """P = 2 EA (l0 - l)/l0 (h - w)/l, the height h - w and the length l from the geometry (von Mises)."""
    analysis = "PUSHOVER 2 -2.5 DIRECTION=Y PATTERN=FORCES NODES=2 FORCES=-1 STEPS=50"
    with results(TOGGLE.format(analysis=analysis), tmp_path) as r:
        assert r.status == "done", r.message
        curve = r.table("capacity_curve")
        w, p = -curve["displacement"], curve["factor"]
    l0, height = math.sqrt(101.0), 1.0 - w
    now = np.sqrt(100.0 + height**2)
    expected = 2 * 1000.0 * (l0 - now) / l0 * height / now
    assert len(w) >= 51 and p == pytest.approx(expected, abs=1e-9)
    assert p.max() > 0.3 and p.min() < -0.3


def test_reactions_balance_on_the_displaced_structure():
    """Forces and moment of a frame with rigid ends and hinges, about its displaced points."""
    s = structure_of("""
GEOMETRY LARGE
NODES
 1 0 0 FIX=XYR
 2 0 4
 3 5 4
ELEMENTS
 1 COL 1 2
 2 BEAM 2 3
PROPS
 COL FRAME E=2e5 A=0.1 I=1e-3 END2=0.3 RULE=BILINEAR R=0.1 KH=3000 MI=100 MJ=100
 BEAM FRAME E=2e5 A=0.1 I=1e-3 END1=0.2 M0=2 N0=-5
LOADS
 3 3 -15 4
""")
    state = static.solve(s)
    at = dict(zip(s.dofs.free, state.u))
    assert abs(at[3, 1]) > 1.0
    r = SupportReactions(s, state.axial).reactions(state.u, state.states)
    x, y = 5 + at[3, 0], 4 + at[3, 1]
    assert (r[1, 0], r[1, 1]) == pytest.approx((-3.0, 15.0), rel=1e-9)
    assert r[1, 2] == pytest.approx(-(4 + x * -15 - y * 3), rel=1e-9)
    # end forces of the column along and across its chord, which ends where the rigid end begins
    turn = at[2, 2]
    foot = np.array([at[2, 0] + 0.3 * math.sin(turn), 4 + at[2, 1] - 0.3 * math.cos(turn)])
    along = foot / np.linalg.norm(foot)
    force = {(o.element, o.quantity): f for o, f in zip(s.outputs, s.member_forces(state.u))}
    n, v = force[1, "axial I"], force[1, "shear I"]
    found = -n * along + v * np.array([-along[1], along[0]])
    assert found == pytest.approx([r[1, 0], r[1, 1]], rel=1e-9)
    assert force[1, "moment I"] == pytest.approx(r[1, 2], rel=1e-9)


def test_modes_of_what_hangs(tmp_path):
    """A pendulum has no stiffness but that of its weight: omega^2 = g / l."""
    for kind, length in (("LARGE", 2.0 * (1 + 9.81 / 1e4)), ("PDELTA_VARYING", 2.0)):
        with results(pendulum(kind, 0.0, "STATIC\n MODAL", "E=1e4 A=1"), tmp_path) as r:
            assert r.table("modes")[0]["omega"] == pytest.approx(math.sqrt(9.81 / length), rel=1e-9)


# ---------------------------------------------------------------------- motion


def pendulum(kind: str, angle: float, analysis: str, section: str, more: str = "") -> str:
    x, y = 2 * math.sin(angle), 2 - 2 * math.cos(angle)
    return f"""
GEOMETRY {kind}
NODES
 1 0 0 FIX=XYR
 2 0 -2 FIX=R
ELEMENTS
 1 BAR 1 2
PROPS
 BAR FRAME {section}
WEIGHTS
 2 9.81
LOADS
 2 0 -9.81
{f"INITIAL{chr(10)} 2 UX={x!r} UY={y!r}" if angle else ""}
ANALYSIS
 {analysis}
OUTPUT
 EVERY=0.05 NODES=2
{more}
"""


def test_the_period_of_a_pendulum_that_swings_over_the_top_half(tmp_path):
    """4 sqrt(l/g) K(sin(theta/2)): it passes the lowest point after a quarter; order 2."""
    quarter = math.sqrt(2 / 9.81) * float(ellipk(math.sin(1.0) ** 2))
    off, residual = [], []
    for n in (50, 100):
        how = f"HISTORY {quarter!r} METHOD=NEWMARK DT={quarter / n!r} FROM=REST"
        with results(pendulum("LARGE", 2.0, how, "E=1e6 A=10"), tmp_path, f"p{n}") as r:
            assert r.status == "done", r.message
            off.append(float(r.history("node/u")[-1, 0, 0]))
            energy = r.history("energy")
            residual.append(np.abs(energy[:, -1]).max() / np.abs(energy).max())
    assert abs(off[1]) < 2e-3 and 3.5 < off[0] / off[1] < 4.5
    assert residual[1] < 1e-3


COLUMN = """
GEOMETRY {kind}
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 TO 5 0 1.25 TO 5
ELEMENTS
 1 TO 4 B 1 TO 4 2 TO 5
PROPS
 B FRAME E=2e8 A=0.01 I=1e-4
WEIGHTS
 2 TO 4 0.5 0.5 1e-9
 5 20 20 1e-9
LOADS
 5 0 -180
EQUAKE
{equake}
ANALYSIS
 STATIC
 HISTORY 2 METHOD={method}
OUTPUT
 EVERY=0.01 NODES=5
"""
SINE = " SINE AMPLITUDE=6 PERIOD=1.3"


@pytest.mark.parametrize(
    ("kind", "peaks", "moment"),
    [
        (
            "LARGE",
            [[0.8553737974, -1.264714087], [-0.000153746843, -0.1950325781], [0.3869741661, -0.2592430363]],
            3042.384496,
        ),
        (
            "PDELTA_VARYING",
            [[0.8640410428, -1.292148128], [-0.00045, -0.00045], [0.3885664128, -0.259829028]],
            3067.166402,
        ),
    ],
)
def test_a_heavy_column_as_opensees_has_it(kind, peaks, moment, tmp_path):
    """OpenSees 3.7.1, geomTransf Corotational and PDelta, the same steps; its iterations end at 1e-9 kN."""
    deck = COLUMN.format(kind=kind, method="NEWMARK DT=0.01", equake=SINE)
    with results(deck, tmp_path) as r:
        assert r.status == "done", r.message
        u = r.history("node/u")[:, 0]
        got = np.array([u.max(axis=0), u.min(axis=0)]).T
        at = r.attributes("member/force")
        foot = [e == 1 and q == "moment I" for e, q in zip(at["element"], at["quantity"])]
        most = np.abs(r.history("member/force")[:, foot]).max()
    # the state at the start is none of that program's steps
    assert got.ravel() == pytest.approx(np.array(peaks).ravel(), abs=1e-8 if kind == "LARGE" else 1e-9)
    assert most == pytest.approx(moment, rel=1e-8)


@each_once(("kind", KINDS), ("method", ["NEWMARK", "HHT", "GENERALISED_ALPHA"]))
def test_what_energy_is_lost_falls_with_the_square_of_the_step(kind, method, tmp_path):
    off = []
    for dt in (0.01, 0.005):
        how = f"{method} DT={dt}"
        with results(COLUMN.format(kind=kind, method=how, equake=SINE), tmp_path, f"c{dt}") as r:
            assert r.status == "done", r.message
            energy = r.history("energy")
            off.append(np.abs(energy[:, -1]).max() / np.abs(energy).max())
    assert off[1] < 1e-3 and off[0] / off[1] > 3.0


def test_explicit_steps_come_to_the_same_motion(tmp_path):
    u = []
    for method in ("CENTRAL", "NEWMARK"):
        deck = pendulum("LARGE", 1.0, f"HISTORY 0.5 METHOD={method} DT=2e-4 FROM=REST", "E=1e4 A=1")
        with results(deck, tmp_path, method) as r:
            assert r.status == "done", r.message
            u.append(r.history("node/u")[:, 0])
            energy = r.history("energy")
            assert np.abs(energy[:, -1]).max() < 1e-5 * np.abs(energy).max()
    assert np.abs(u[0] - u[1]).max() < 1e-5 * np.abs(u[1]).max()


def test_what_moves_the_whole_base_may_as_well_move_its_supports(tmp_path):
    """Total displacements less the ground's are relative ones; the supports' power closes the energy."""
    drift = []
    for more in ("", " SUPPORTS=1 VELOCITY0=0"):
        deck = COLUMN.format(kind="LARGE", method="NEWMARK DT=0.005", equake=SINE + more)
        with results(deck + "DRIFT\n roof 1 5\n", tmp_path, f"s{len(more)}") as r:
            assert r.status == "done", r.message
            drift.append(r.history("drift")[:, 0])
            energy = r.history("energy")
            assert np.abs(energy[:, -1]).max() < 5e-4 * np.abs(energy).max()
    # the forms differ by the error of the steps, 1.2e-4
    assert np.abs(drift[1] - drift[0]).max() < 2e-4 * np.abs(drift[0]).max()


FRAME = """
GEOMETRY {kind}
NODES
 1 0 0 FIX=XYR
 2 0 4
 3 6 4
 4 6 0 FIX=XYR
ELEMENTS
 1 COL 1 2
 2 BEAM 2 3
 3 COL 4 3
PROPS
 COL FRAME E=2e8 A=0.01 I=1e-4 END2=0.2 RULE=BILINEAR R=0.02 LP=0.3 MI=120 MJ=120
 BEAM FRAME E=2e8 A=0.01 I=2e-4 END1=0.2 END2=0.2
WEIGHTS
 2,3 400 400 0
LOADS
 2,3 0 -400
EQUAKE
 SINE AMPLITUDE=5 PERIOD=0.9
ANALYSIS
 HISTORY 1.5 METHOD={method}
OUTPUT
 EVERY=0.05
DRIFT
 roof 1 2
"""


@pytest.mark.parametrize("kind", KINDS)
def test_hinges_yield_and_turn_back_within_the_steps(kind, tmp_path):
    """With events located the motion is of order 2 over them, with massless rotations and rigid ends."""
    u = []
    for dt in (0.01, 0.005, 0.0025):
        deck = FRAME.format(kind=kind, method=f"NEWMARK DT={dt}")
        with results(deck, tmp_path, f"f{dt}") as r:
            assert r.status == "done", r.message
            u.append(r.history("drift")[:, 0])
            assert r.table("spring_envelope")["yield_events"].max() >= 2
            energy = r.history("energy")
            assert np.abs(energy[:, -1]).max() < 2e-2 * (dt / 0.01) ** 2 * np.abs(energy).max()
    a, b = np.abs(u[0] - u[1]).max(), np.abs(u[1] - u[2]).max()
    assert b < 2e-3 * np.abs(u[2]).max() and 3.0 < a / b < 5.5


def test_exact_says_that_it_cannot_and_auto_takes_steps(tmp_path):
    with results(FRAME.format(kind="LARGE", method="EXACT"), tmp_path, "e") as r:
        assert r.status == "stopped" and "GEOMETRY LARGE" in r.message and "AUTO" in r.message
    with results(FRAME.format(kind="LARGE", method="AUTO TOL=1E-2"), tmp_path, "a") as r:
        assert r.status == "done", r.message
        assert any("GEOMETRY LARGE" in row["why"] for row in r.table("scene"))


@FAST
def test_auto_takes_series_of_strings(tmp_path):
    with results(FRAME.format(kind="PDELTA_VARYING", method="AUTO"), tmp_path, "a") as r:
        assert r.status == "done", r.message
        assert any(row["value"].startswith("TAYLOR") for row in r.table("run"))
