"""Rigid contacts in statics: closed forms, every set of closed contacts tried, and histories from there."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from decks import scene_of, solved, structure_of
from pound_solve.analyses import static
from pound_solve.analyses.contact_constraints import ContactConstraints
from pound_solve.analyses.tangent_solution import InstabilityError
from pound_solve.integrate.rigid.contacts import ACCELERATION_ROUNDING, RigidContacts, linear_forces
from pound_solve.numerics.types import Array
from verification.cases import run_text

LAWS = pytest.mark.parametrize("law", ["LAGRANGE", "STEREOMECHANICS E=0.5"])
BOTH = pytest.mark.parametrize("method", ["EXACT", "TAYLOR"])


def bar(loads: str, gap: float = 0.0, law: str = "LAGRANGE") -> str:
    """A bar of three springs of 300 between two walls, the right one `gap` away."""
    return f"""
NODES
 1 TO 4 0 TO 3 0 FIX=YR
ELEMENTS
 1 S 1 2
 2 S 2 3
 3 S 3 4
 4 LEFT 1
 5 RIGHT 4
PROPS
 S SPRING KX=300
 LEFT CONTACT GAP=0 ANGLE=180 LAW={law}
 RIGHT CONTACT GAP={gap!r} ANGLE=0 LAW={law}
WEIGHTS
 1 TO 4 1
LOADS
{loads}
"""


def contacts(text: str) -> list[float]:
    """Forces of the contacts."""
    return [value for (_, name), value in solved(text).force.items() if name == "contact"]


@LAWS
def test_a_bar_that_is_pushed_against_a_wall_leaves_the_other(law: str) -> None:
    s = solved(bar(" 2 6 0", law=law))
    assert [s.force[i, "contact"] for i in (4, 5)] == pytest.approx([0.0, 6.0], rel=1e-14)
    assert [s.u[i][0] for i in (1, 2, 3, 4)] == pytest.approx([0.04, 0.04, 0.02, 0.0], abs=1e-16)


def test_a_bar_that_is_stretched_between_walls_presses_both() -> None:
    """Loads P outwards at its thirds: u = P / 3k there, and the ends are pressed by k u."""
    s = solved(bar(" 2 -6 0\n 3 6 0"))
    assert [s.force[i, "contact"] for i in (4, 5)] == pytest.approx([2.0, 2.0], rel=1e-14)
    assert s.u[3][0] == pytest.approx(6.0 / 900.0, rel=1e-14)


def test_a_gap_closes_on_the_way() -> None:
    """Held on the left only, the right end moves by P / k; what is left of the gap is made up for by R."""
    gap, load, k = 0.01, 6.0, 300.0
    s = solved(bar(f" 1 -8 0\n 3 {load!r} 0", gap))
    right = (2.0 * load - k * gap) / 3.0  # from 2 P/k - 3 R/k = gap
    assert s.force[5, "contact"] == pytest.approx(right, rel=1e-13)
    assert s.force[4, "contact"] == pytest.approx(8.0 - load + right, rel=1e-13)
    assert s.u[4][0] == pytest.approx(gap, rel=1e-14)


FLOOR = "CONTACT GAP=0 ANGLE=-90 LAW=LAGRANGE"
CEILING = "CONTACT GAP=0 ANGLE=90 LAW=LAGRANGE"


@pytest.mark.parametrize(("first", "second"), [(FLOOR, CEILING), (CEILING, FLOOR)])
@pytest.mark.parametrize("load", [-7.0, 7.0])
def test_a_block_lies_on_the_floor_or_at_the_ceiling(first: str, second: str, load: float) -> None:
    s = solved(f"""
NODES
 1 0 0 FIX=XR
ELEMENTS
 1 A 1
 2 B 1
PROPS
 A {first}
 B {second}
WEIGHTS
 1 5
LOADS
 1 0 {load!r}
""")
    pressed = {FLOOR: max(-load, 0.0), CEILING: max(load, 0.0)}
    assert [s.force[i, "contact"] for i in (1, 2)] == [pressed[first], pressed[second]]
    assert s.u[1][1] == 0.0


BLOCK = """
NODES
 1 0 0 FIX=XR
ELEMENTS
 1 A 1
PROPS
 A CONTACT GAP={gap} ANGLE=-90 LAW={law}
WEIGHTS
 1 5
LOADS
 1 0 {load}
"""


@pytest.mark.parametrize("law", ["LAGRANGE", "LINEAR K=100"])
def test_a_contact_that_touches_holds_a_free_body(law: str) -> None:
    assert contacts(BLOCK.format(gap=0, law=law, load=-7)) == pytest.approx([7.0], rel=1e-12)


@pytest.mark.parametrize(("gap", "load"), [(0.1, -7), (0, 7)])
def test_what_nothing_stops_is_named(gap: float, load: float) -> None:
    with pytest.raises(InstabilityError, match=r"node 1 .*nothing holds it"):
        solved(BLOCK.format(gap=gap, law="LAGRANGE", load=load))


@LAWS
def test_three_blocks_one_upon_the_other(law: str) -> None:
    """Each contact carries what lies above it."""
    s = solved(f"""
NODES
 1 TO 3 0 0 TO 2 FIX=XR
ELEMENTS
 1 BED 1
 2 UPON 2 1
 3 UPON 3 2
PROPS
 BED CONTACT GAP=0 ANGLE=-90 LAW={law}
 UPON CONTACT GAP=0 ANGLE=-90 LAW={law}
WEIGHTS
 1 TO 3 1
LOADS
 1 0 -1
 2 0 -2
 3 0 -4
""")
    assert [s.force[i, "contact"] for i in (1, 2, 3)] == pytest.approx([7.0, 6.0, 4.0], rel=1e-14)


@pytest.mark.parametrize("geometry", ["", "GEOMETRY LARGE"])
@pytest.mark.parametrize("gap", [0.0, 0.001])
def test_a_cantilever_on_a_rigid_prop(gap: float, geometry: str) -> None:
    """P in the middle: R = 5 P / 16 - 3 E I g / L^3 at the end; small displacements, so LARGE agrees."""
    ei, length, load = 2e4, 4.0, 10.0
    scale = 1.0 if not geometry else 1e-3  # displacements go with it
    s = solved(f"""
{geometry}
NODES
 1 0 0 FIX=XYR
 2 2 0
 3 4 0
ELEMENTS
 1 B 1 2
 2 B 2 3
 3 STOP 3
PROPS
 B FRAME E={ei!r} A=10 I=1
 STOP CONTACT GAP={gap * scale!r} ANGLE=-90 LAW=LAGRANGE
WEIGHTS
 3 1 1
LOADS
 2 0 {-load * scale!r}
""")
    expected = 5.0 * load / 16.0 - 3.0 * ei * gap / length**3
    assert s.force[3, "contact"] / scale == pytest.approx(expected, rel=1e-6 if geometry else 1e-11)
    assert s.u[3][1] / scale == pytest.approx(-gap, abs=1e-15)


LEANING = """
NODES
 1 0 0 FIX=YR
 2 1 0 FIX=YR
ELEMENTS
 1 A 1
 2 B 2
 3 C 1 2
PROPS
 A SPRING KX=100 {yields}
 B SPRING KX=50
 C CONTACT GAP=0.02 LAW=LAGRANGE
WEIGHTS
 1 2
 2 3
LOADS
 1 {load!r} 0
"""


def test_a_frame_leans_on_its_neighbour() -> None:
    """R = k2 (P - k1 g) / (k1 + k2)."""
    s = solved(LEANING.format(load=8.0, yields=""))
    assert s.force[3, "contact"] == pytest.approx(50.0 * (8.0 - 2.0) / 150.0, rel=1e-14)
    assert s.u[1][0] - s.u[2][0] == pytest.approx(0.02, rel=1e-14)


def test_a_frame_that_yields_leans_more() -> None:
    s = solved(LEANING.format(load=8.0, yields="RULE=ELASTO_PLASTIC FX=3"))
    assert s.force[3, "contact"] == pytest.approx(8.0 - 3.0, rel=1e-13)


def test_a_curved_spring_leaves_the_rest_to_the_stop() -> None:
    """Of RAMBERG_OSGOOD, whose deformation follows from its force: d = f/k (1 + (f/fy)^(n-1))."""
    force, k, fy, n = 6.0, 100.0, 5.0, 5.0
    gap = force / k * (1.0 + (force / fy) ** (n - 1.0))
    s = solved(f"""
NODES
 1 0 0 FIX=YR
ELEMENTS
 1 A 1
 2 C 1
PROPS
 A SPRING KX={k!r} RULE=RAMBERG_OSGOOD FX={fy!r} N={n!r}
 C CONTACT GAP={gap!r} LAW=LAGRANGE
WEIGHTS
 1 2
LOADS
 1 20 0
""")
    assert s.force[2, "contact"] == pytest.approx(20.0 - force, rel=1e-9)


def test_a_pushover_opens_what_the_loads_have_closed() -> None:
    """The contact presses with 2; a pull f at mass 1 leaves it where k2 / (k1 + k2) f = 2."""
    text = LEANING.format(load=8.0, yields="")
    text += "ANALYSIS\n PUSHOVER 1 -0.1 PATTERN=FORCES NODES=1 FORCES=1\n"
    r = run_text(text)
    assert r.column("push_events", "factor") == pytest.approx([-6.0], rel=1e-13)


def least_energy(k: Array, p: Array, rows: Array, gaps: Array) -> Array:
    """Displacements of least energy: every set of closed contacts is tried."""
    n = len(p)
    for size in range(len(gaps) + 1):
        for closed in map(list, itertools.combinations(range(len(gaps)), size)):
            b = rows[closed]
            whole = np.block([[k, b.T], [b, np.zeros((size, size))]])
            x = np.linalg.lstsq(whole, np.append(p, gaps[closed]), rcond=None)[0]
            u, force = x[:n], x[n:]
            right = np.abs(whole @ x - np.append(p, gaps[closed])).max() < 1e-9
            if right and (force >= -1e-9).all() and (rows @ u <= gaps + 1e-12).all():
                return np.asarray(u)
    raise AssertionError("none is in equilibrium")


@pytest.mark.full
@settings(max_examples=60)
@given(st.integers(0, 10**6), st.integers(2, 5))
def test_any_row_of_masses_finds_its_equilibrium(seed: int, n: int) -> None:
    """Masses on springs, contacts between neighbours and walls at both ends, some of them touching."""
    rng = np.random.default_rng(seed)
    ground, load = rng.uniform(10.0, 100.0, n), rng.normal(size=n) * 5.0
    gaps = rng.uniform(0.0, 0.05, n + 1) * (rng.random(n + 1) < 0.6)
    lines = [f"NODES\n 1 TO {n} 1 TO {n} 0 FIX=YR\nELEMENTS"]
    lines += [f" {i} S{i} {i}" for i in range(1, n + 1)]
    lines += [f" {n + i} C{i} {i} {i + 1}" for i in range(1, n)]
    lines += [f" {2 * n} C{n} {n}", f" {2 * n + 1} C0 1", "PROPS"]
    lines += [f" S{i + 1} SPRING KX={k!r}" for i, k in enumerate(ground.tolist())]
    lines += [f" C{i} CONTACT GAP={g!r} LAW=LAGRANGE" for i, g in enumerate(gaps.tolist()) if i]
    lines += [f" C0 CONTACT GAP={gaps.tolist()[0]!r} ANGLE=180 LAW=LAGRANGE", f"WEIGHTS\n 1 TO {n} 1"]
    lines += ["LOADS", *(f" {i + 1} {p!r} 0" for i, p in enumerate(load.tolist()))]
    state = static.solve(structure_of("\n".join(lines)))
    rows = np.array(
        [-np.eye(n)[0], *(np.eye(n)[i] - np.eye(n)[i + 1] for i in range(n - 1)), np.eye(n)[-1]]
    )
    expected = least_energy(np.diag(ground), load, rows, gaps)
    assert state.u == pytest.approx(expected, abs=1e-12)


def test_ties_of_dependent_rows_share_evenly() -> None:
    rows = np.array([[1.0, -1.0, 0.0], [2.0, -2.0, 0.0], [0.0, 1.0, 0.0]])
    ties = ContactConstraints(np.arange(3), rows)
    assert ties.expand(np.array([0.3, 0.7, 2.0])) == pytest.approx([0.0, 0.0, 2.0])
    force = ties.forces(np.array([5.0, 1.0, 0.0]))
    assert force == pytest.approx([1.0, 2.0, 6.0], rel=1e-14)


# ---------------------------------------------------------------------- histories from such states


def pressed(law: str, more: str, t: float = 1.0, load: str = "1 8 0", gap: float = 0.01) -> str:
    """A mass of 4 on a spring of 100 that a load of 8 presses against a wall."""
    return f"""
UNITS N m s
GRAVITY 1
NODES
 1 0 0 FIX=YR
ELEMENTS
 1 S 1
 2 C 1
PROPS
 S SPRING KX=100
 C CONTACT GAP={gap!r} ANGLE=0 LAW={law}
WEIGHTS
 1 4
LOADS
 {load}
{more}
ANALYSIS
 HISTORY {t!r}
OUTPUT
 EVERY=0.01
"""


@pytest.mark.full
@BOTH
@LAWS
def test_a_history_takes_over_the_force_of_statics(method: str, law: str) -> None:
    """A ground acceleration of 1.5 sin 3t takes 6 sin 3t from the 7 that statics leaves."""
    r = run_text(pressed(law, "EQUAKE\n SINE PERIOD=2.0943951023931953 AMPLITUDE=1.5"), method=method)
    assert r.status == "done", r.message
    assert r.force[:, 0] == pytest.approx(7.0 - 4.0 * 1.5 * np.sin(3.0 * r.time), abs=1e-12)
    assert np.abs(r.u[:, 0, 0] - 0.01).max() < 1e-16
    assert len(r.tables["collisions"]) == 1


@pytest.mark.full
@BOTH
@LAWS
def test_it_parts_where_the_force_is_used_up(method: str, law: str) -> None:
    """A push of 14 t the other way takes the 7 away at half a second."""
    r = run_text(pressed(law, "FORCES\n TABLE 1 -14 POINTS=0,0,1,1"), method=method)
    assert r.status == "done", r.message
    late = np.maximum(r.time - 0.5, 0.0)
    away = -14.0 / 100.0 * (late - np.sin(5.0 * late) / 5.0)  # m u'' + k u = -14 t'
    assert r.u[:, 0, 0] == pytest.approx(0.01 + away, abs=1e-14)
    assert r.force[:, 0] == pytest.approx(np.maximum(7.0 - 14.0 * r.time, 0.0), abs=1e-12)


@BOTH
def test_a_load_that_is_let_go_parts_at_once(method: str) -> None:
    r = run_text(pressed("LAGRANGE", "", 0.6, "1 8 0 HELD=NO"), method=method)
    assert r.u[:, 0, 0] == pytest.approx(0.01 * np.cos(5.0 * r.time), abs=1e-15)
    assert np.abs(r.force[1:, 0]).max() == 0.0


@BOTH
@pytest.mark.parametrize(("v", "after"), [(-0.3, -0.3), (0.3, -0.15)])
def test_initial_velocities_part_or_strike(method: str, v: float, after: float) -> None:
    r = run_text(pressed("STEREOMECHANICS E=0.5", f"INITIAL\n 1 VX={v!r}", 0.05), method=method)
    w, away = 5.0, 0.01 - 0.08
    expected = 0.08 + away * np.cos(w * r.time) + after / w * np.sin(w * r.time)
    assert r.u[1:, 0, 0] == pytest.approx(expected[1:], abs=1e-14)


@BOTH
def test_an_initial_displacement_leaves_the_wall(method: str) -> None:
    r = run_text(pressed("LAGRANGE", "INITIAL\n 1 UX=-0.05", 0.05), method=method)
    assert r.u[:, 0, 0] == pytest.approx(0.08 - 0.12 * np.cos(5.0 * r.time), abs=1e-15)


def test_modes_after_statics_keep_closed_contacts_closed() -> None:
    """Two masses that lean move as one: (k1 + k2) / (m1 + m2)."""
    text = LEANING.format(load=8.0, yields="") + "ANALYSIS\n MODAL AFTER=STATIC\n"
    found = run_text("UNITS N m s\nGRAVITY 1\n" + text).column("modes", "omega")
    assert len(found) == 1 and found[0] == pytest.approx(np.sqrt(150.0 / 5.0), rel=1e-13)


@BOTH
def test_a_contact_that_statics_leaves_at_its_gap_does_not_overlap(method: str) -> None:
    """The rounding of its deformation is that of the loads on the rest."""
    text = LEANING.replace("GAP=0.02", "GAP=0").format(load=8.0, yields="")
    text = text.replace("PROPS\n", " 4 W 2\nPROPS\n W CONTACT GAP=0 ANGLE=180 LAW=LAGRANGE\n")
    r = run_text("UNITS N m s\nGRAVITY 1\n" + text + "ANALYSIS\n HISTORY 0.1\n", method=method)
    assert r.status == "done" and np.ptp(r.u[:, :, 0], axis=0).max() < 1e-15


def test_rounding_of_a_static_state_is_no_force() -> None:
    """Under gravity a body's place across is rounding of its settlement, and so is the spring's force."""
    system = scene_of("""UNITS N m s
GRAVITY 10
NODES
 1 0 0 FIX=R
ELEMENTS
 1 S 1
 2 C 1
PROPS
 S SPRING KX=1E6 KY=1E3
 C CONTACT GAP=0 ANGLE=0 LAW=LAGRANGE
WEIGHTS
 1 20
LOADS
 1 0 -20
INITIAL
 1 UX=-1 UY=-1
EQUAKE
 SINE AMPLITUDE=1 PERIOD=1
ANALYSIS
 HISTORY 1
""")
    contacts = RigidContacts(system)
    forces = linear_forces([s.branch(s.law.start()) for s in system.structure.laws])
    u = np.array([-3e-18, -0.02])
    inputs = np.zeros((3, system.inputs.shape[1]))
    free, size = contacts.free_accelerations(forces, u, np.zeros(2), inputs)
    assert free == pytest.approx([1.5e-12], rel=1e-12) and abs(free[0]) < ACCELERATION_ROUNDING * size[0]
