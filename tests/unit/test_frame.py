"""FRAME against statics that use none of its interpolation: the force method with flexibilities."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from decks import Solved, model_of, solve, solved, structure_of

E, A, IZ, G, AS = 2.1e8, 0.011, 1.7e-4, 8.0e7, 0.004
angles = st.one_of(st.sampled_from([0.0, 90.0, 180.0, -90.0, 45.0]), st.floats(-180.0, 180.0))


def close(got, wanted, rel=1e-10, scale=None):
    """Components of one kind agree to `rel` of the largest."""
    got, wanted = np.atleast_1d(got), np.atleast_1d(wanted)
    size = scale if scale is not None else np.abs(wanted).max()
    assert np.abs(got - wanted).max() <= rel * size, f"{got} instead of {wanted}"


@dataclass
class Beam:
    """Deflection v, slope and end forces of a straight beam, I at x = 0,
    by the force method (unit-load theorem).

    `loads` are transverse (w uniform, points (P, a)), positive along local y.
    """

    length: float
    shear: bool = False

    @property
    def ga(self) -> float:
        return G * AS if self.shear else math.inf

    def cantilever(self, w=0.0, points=(), tip=0.0, moment=0.0):
        """Tip deflection and slope of the beam clamped at x = 0."""
        n, ei = self.length, E * IZ
        v = w * n**4 / (8 * ei) + w * n**2 / (2 * self.ga)
        v += tip * n**3 / (3 * ei) + tip * n / self.ga + moment * n**2 / (2 * ei)
        turn = w * n**3 / (6 * ei) + tip * n**2 / (2 * ei) + moment * n / ei
        for p, a in points:
            v += p * a**2 * (3 * n - a) / (6 * ei) + p * a / self.ga
            turn += p * a**2 / (2 * ei)
        return np.array([v, turn])

    def end_forces(self, pin: str, w=0.0, points=()):
        """Forces on the beam (shear I, moment I, shear J, moment J), ends clamped but for `pin`."""
        n = self.length
        whole = w * n + sum(p for p, _ in points)
        about_i = w * n**2 / 2 + sum(p * a for p, a in points)
        if pin == "BOTH":
            at_j = np.array([-about_i / n, 0.0])
        elif pin == "I":
            mirrored = Beam(n, self.shear).end_forces("J", w, [(p, n - a) for p, a in points])
            return np.array([mirrored[2], 0.0, mirrored[0], -mirrored[1]])
        else:
            flexibility = np.array([self.cantilever(tip=1.0), self.cantilever(moment=1.0)])
            d = self.cantilever(w, points)
            if pin == "J":
                at_j = np.array([-d[0] / flexibility[0, 0], 0.0])
            else:
                at_j = np.linalg.solve(flexibility, -d)
        shear_i = -whole - at_j[0]
        return np.array([shear_i, -about_i - n * at_j[0] - at_j[1], at_j[0], at_j[1]])


def member(length, angle, extra="", fix_j="", loads="", member_loads="", shear=False, head=""):
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return f"""
{head}
NODES
 1  1.5  -0.7  FIX=XYR
 2  {1.5 + length * c!r}  {-0.7 + length * s!r}  {fix_j}
ELEMENTS
 7 M 1 2
PROPS
 M FRAME E={E!r} A={A!r} I={IZ!r} {f"G={G!r} AS={AS!r}" if shear else ""} {extra}
{"LOADS" if loads else ""}
{loads}
{"MEMBER_LOADS" if member_loads else ""}
{member_loads}
"""


def stationary(angle, x, y):
    """Global components of a vector given along the member and to its left."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return c * x - s * y, s * x + c * y


def local(angle, vector):
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return np.array([c * vector[0] + s * vector[1], -s * vector[0] + c * vector[1], vector[2]])


def balanced(s: Solved, force, moment):
    """Reactions against loads: resultant force and moment about the origin."""
    r = s.total()
    close(r[:2], [-force[0], -force[1]], scale=max(1.0, *map(abs, force)))
    close(r[2], -moment, scale=max(1.0, abs(moment), *map(abs, force)))


@pytest.mark.parametrize("shear", [False, True])
@settings(max_examples=25)
@given(angle=angles, n=st.floats(0.5, 20.0), px=st.floats(-9, 9), py=st.floats(-9, 9), m=st.floats(-9, 9))
def test_cantilever_with_tip_loads(shear, angle, n, px, py, m):
    fx, fy = stationary(angle, px, py)
    s = solved(member(n, angle, shear=shear, loads=f" 2 {fx!r} {fy!r} {m!r}"))
    u = local(angle, s.u[2])
    beam, size = Beam(n, shear), max(abs(px), abs(py), abs(m), 1e-300)
    v, turn = beam.cantilever(tip=py, moment=m)
    close(u[0], px * n / (E * A), scale=size * n / (E * A) + 1e-2 * abs(v))
    close(u[1], v, scale=size * abs(beam.cantilever(tip=1.0)[0]) + size * n**2 / (E * IZ))
    close(u[2], turn, scale=size * (n + n**2) / (E * IZ))
    arm = size * (1 + n)
    close(
        [s.force[7, q] for q in ("axial I", "axial J", "shear I", "moment I", "shear J", "moment J")],
        [px, px, -py, -m - n * py, py, m],
        scale=arm,
    )
    close(local(angle, s.reaction[1]), [-px, -py, -m - n * py], scale=arm)


@pytest.mark.parametrize("shear", [False, True])
@settings(max_examples=25)
@given(
    angle=angles,
    n=st.floats(0.5, 20.0),
    wx=st.floats(-9, 9),
    wy=st.floats(-9, 9),
    p=st.floats(-9, 9),
    at=st.floats(0, 1),
)
def test_cantilever_with_member_loads(shear, angle, n, wx, wy, p, at):
    """Loads are given along the global axes; two cards on one member add up."""
    w, q = stationary(angle, wx, wy), stationary(angle, 0.0, p)
    cards = f" 7 WX={w[0]!r} WY={w[1]!r}\n 7 PX={q[0]!r} PY={q[1]!r} AT={at!r}"
    s = solved(member(n, angle, shear=shear, member_loads=cards))
    u, beam = local(angle, s.u[2]), Beam(n, shear)
    v, turn = beam.cantilever(wy, [(p, at * n)])
    size = max(abs(wx) * n, abs(wy) * n, abs(p), 1e-300)
    close(u[0], wx * n**2 / (2 * E * A), scale=size * n / (E * A) + 1e-2 * abs(v))
    close(u[1], v, scale=size * beam.cantilever(tip=1.0)[0])
    close(u[2], turn, scale=size * n**2 / (E * IZ))
    close(
        [s.force[7, k] for k in ("shear I", "moment I", "shear J", "moment J")],
        [-wy * n - p, -wy * n**2 / 2 - p * at * n, 0.0, 0.0],
        scale=size * (1 + n),
    )
    close(local(angle, s.reaction[1])[:2], [-wx * n, -wy * n - p], scale=size)


@pytest.mark.parametrize("pin", ["NONE", "I", "J", "BOTH"])
@pytest.mark.parametrize("shear", [False, True])
@settings(max_examples=15)
@given(angle=angles, n=st.floats(0.5, 20.0), w=st.floats(-9, 9), p=st.floats(-9, 9), at=st.floats(0, 1))
def test_clamped_member_with_pins(pin, shear, angle, n, w, p, at):
    """Both nodes clamped, the pins in the member: end forces and reactions by the force method."""
    (wx, wy), (px, py) = stationary(angle, 0.0, w), stationary(angle, 0.0, p)
    s = solved(
        member(
            n,
            angle,
            f"PIN={pin}",
            "FIX=XYR",
            shear=shear,
            member_loads=f" 7 WX={wx!r} WY={wy!r} PX={px!r} PY={py!r} AT={at!r}",
        )
    )
    size = max(abs(w) * n, abs(p), 1e-300)
    wanted = Beam(n, shear).end_forces(pin, w, [(p, at * n)])
    got = np.array([s.force[7, k] for k in ("shear I", "moment I", "shear J", "moment J")])
    close(got[::2], wanted[::2], scale=size)
    close(got[1::2], wanted[1::2], scale=size * n)
    r = np.concatenate([local(angle, s.reaction[1])[1:], local(angle, s.reaction[2])[1:]])
    close(r, wanted, scale=size * (1 + n))


def test_known_end_moments():
    """Textbook numbers: w L^2/12, w L^2/8, P a b^2/L^2, P L/8, 3 P L/16
    (loads downwards, left end first).
    """

    def ends(pin, loads):
        s = solved(member(6.0, 0.0, f"PIN={pin}", "FIX=XYR", member_loads=loads))
        return [s.force[7, "moment I"], s.force[7, "moment J"]]

    close(ends("NONE", " 7 WY=-10"), [30.0, -30.0])
    close(ends("J", " 7 WY=-10"), [45.0, 0.0])
    close(ends("I", " 7 WY=-10"), [0.0, -45.0])
    close(ends("NONE", " 7 PY=-18 AT=1/3"), [18 * 2 * 16 / 36, -18 * 4 * 4 / 36])
    close(ends("NONE", " 7 PY=-18"), [13.5, -13.5])
    close(ends("J", " 7 PY=-16"), [18.0, 0.0])


@pytest.mark.parametrize("angle", [0.0, 90.0, 37.0, 180.0])
def test_self_weight_is_a_load_and_can_be_switched_off(angle):
    n, weight = 4.0, 2.5
    deck = member(n, angle, f"WGT={weight}")
    s = solved(deck)
    balanced(s, (0.0, -weight * n), -weight * n * (1.5 + n / 2 * math.cos(math.radians(angle))))
    across = -weight * math.cos(math.radians(angle))
    close(local(angle, s.u[2])[1], across * n**4 / (8 * E * IZ), scale=weight * n**4 / (8 * E * IZ))
    off = solved(deck, self_weight=False)
    assert not np.any(off.u[2]) and off.structure.mass.any()


@settings(max_examples=30)
@given(
    angle=angles,
    n=st.floats(1.0, 20.0),
    a=st.floats(0, 0.4),
    b=st.floats(0, 0.4),
    shear=st.booleans(),
    pin=st.sampled_from(["NONE", "I", "J", "BOTH"]),
)
def test_end_blocks_are_a_shorter_member_on_rigid_arms(angle, n, a, b, shear, pin):
    """The same member built from slaved nodes, springs at the tip, uniform, point and self-weight loads."""
    a, b = a * n, b * n
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    w, p, weight, at = (0.7, -1.3), (2.0, 1.1), 0.9, 0.3
    down = (w[0], w[1] - weight)
    section = f"E={E!r} A={A!r} I={IZ!r} PIN={pin} WGT={weight!r}" + (
        f" G={G!r} AS={AS!r}" if shear else ""
    )
    loads = f" 7 WX={w[0]!r} WY={w[1]!r} PX={p[0]!r} PY={p[1]!r} AT={at!r}"

    def point(x):
        return f"{x * c!r} {x * s!r}"

    common = "SPRING KX=1300 KY=1700 KR=900"
    short = solved(f"""
NODES
 1 0 0
 2 {point(n)}
ELEMENTS
 7 M 1 2
 8 TO 9 S 1 TO 2
PROPS
 M FRAME {section} END1={a!r} END2={b!r}
 S {common}
MEMBER_LOADS
{loads}
""")
    arms = solved(f"""
NODES
 1 0 0
 2 {point(n)}
 3 {point(a)}  SLAVED=XYR MASTER=1
 4 {point(n - b)}  SLAVED=XYR MASTER=2
 5 {point(a / 2)}  SLAVED=XYR MASTER=1
 6 {point(n - b / 2)}  SLAVED=XYR MASTER=2
ELEMENTS
 7 M 3 4
 8 TO 9 S 1 TO 2
PROPS
 M FRAME {section}
 S {common}
MEMBER_LOADS
{loads}
LOADS
 5 {down[0] * a!r} {down[1] * a!r}
 6 {down[0] * b!r} {down[1] * b!r}
""")
    for node in (1, 2):
        close(short.u[node], arms.u[node])
    for key, value in arms.force.items():
        close(short.force[key], value, scale=max(abs(x) for x in arms.force.values()))


def test_cantilever_with_end_blocks_in_closed_form():
    n, a, b, p = 5.0, 0.6, 0.4, 3.0
    s = solved(member(n, 0.0, f"END1={a} END2={b}", loads=f" 2 0 {p} 0"))
    f = n - a - b
    end, turn = Beam(f).cantilever(tip=p, moment=p * b)
    close(s.u[2][1:], [end + b * turn, turn])
    # end forces are those at the faces of the blocks, reactions those at the node
    close([s.force[7, "moment I"], s.force[7, "moment J"]], [-p * (f + b), p * b])
    close(s.reaction[1], [0.0, -p, -p * n])


@settings(max_examples=25)
@given(angle=angles, px=st.floats(-5, 5), py=st.floats(-5, 5))
def test_rotating_the_model_changes_no_scalar(angle, px, py):
    """A bent with shear deformation, end blocks, a pin and springs, turned as a whole with its loads."""

    def deck(turn):
        def point(x, y):
            return "{!r} {!r}".format(*stationary(turn, x, y))

        def pair(names, x, y):
            return "{}={!r} {}={!r}".format(*(k for z in zip(names, stationary(turn, x, y)) for k in z))

        return f"""
NODES
 1 {point(0, 0)} FIX=XYR
 2 {point(0.3, 4)}
 3 {point(6, 4.5)}
 4 {point(6, 0)} FIX=XYR
 5 {point(3, 2)}
 6 {point(6.4, 4.9)} SLAVED=XYR MASTER=3
ELEMENTS
 1 COL 1 2
 2 BEAM 2 3
 3 COL 4 3
 4 S 5 2
 5 S 5 6
 6 W 5
PROPS
 COL FRAME E={E!r} A={A!r} I={IZ!r} G={G!r} AS={AS!r} END2=0.3
 BEAM FRAME E={E!r} A={A!r} I={IZ!r} PIN=J
 S SPRING KX=3e3 KY=5e3 KR=100 ANGLE={20 + turn!r}
 W SPRING KX=3e3 KY=1e3 KR=700 ANGLE={-35 + turn!r}
LOADS
 2 {pair(("FX", "FY"), px, py)} MZ=1
 6 {pair(("FX", "FY"), 1, 1)} MZ=2
MEMBER_LOADS
 2 {pair(("WX", "WY"), 1, -2)} {pair(("PX", "PY"), px, -3)} AT=0.2
"""

    still, other = solved(deck(0.0)), solved(deck(angle))
    size = max(abs(x) for x in still.force.values())
    for key, value in still.force.items():
        close(other.force[key], value, scale=size)
    for node, u in still.u.items():
        close(
            local(angle, other.u[node]), u, rel=1e-10, scale=max(np.abs(x).max() for x in still.u.values())
        )


def test_order_of_nodes_and_elements_does_not_matter():
    nodes = [" 1 0 0 FIX=XYR", " 2 0 3", " 3 5 3.3", " 4 5 0 FIX=XY", " 6 5.2 3.5 SLAVED=XYR MASTER=3"]
    elements = [" 1 COL 1 2", " 2 BEAM 2 3", " 3 COL 4 3", " 4 W 6"]
    tail = f"""
PROPS
 COL FRAME E={E!r} A={A!r} I={IZ!r} WGT=1
 BEAM FRAME E={E!r} A={A!r} I={IZ!r} PIN=I WGT=2
 W SPRING KX=50
LOADS
 2,6 3 -2 1
"""

    def run(order_n, order_e):
        text = (
            "NODES\n"
            + "\n".join(nodes[i] for i in order_n)
            + "\nELEMENTS\n"
            + "\n".join(elements[i] for i in order_e)
        )
        return solved(text + tail)

    first = run(range(5), range(4))
    for order_n, order_e in (((4, 3, 2, 1, 0), (3, 2, 1, 0)), ((2, 4, 0, 3, 1), (1, 3, 0, 2))):
        other = run(order_n, order_e)
        for node in first.u:
            close(other.u[node], first.u[node])
            if node in first.reaction:
                close(other.reaction[node], first.reaction[node])
        for key in first.force:
            close(other.force[key], first.force[key], scale=1.0)
        close(other.structure.free_vibration.omega, first.structure.free_vibration.omega, rel=1e-9)
    # swapping I and J turns the local axes by 180 degrees: end forces change ends, axial force stays
    swapped = list(elements)
    swapped[0] = " 1 COL 2 1"
    text = "NODES\n" + "\n".join(nodes) + "\nELEMENTS\n" + "\n".join(swapped)
    other = solved(text + tail)
    close(other.u[6], first.u[6])
    close(other.force[1, "moment J"], first.force[1, "moment I"])
    close(other.force[1, "shear J"], -first.force[1, "shear I"])


@settings(max_examples=20)
@given(angle=angles, at=st.floats(0, 1))
def test_axial_bar_hands_on_loads_without_moments(angle, at):
    """I = 0: half of a uniform load to each end, a point load by the lever rule, no moment on any node."""
    n, w, p = 4.0, -2.0, 3.0
    deck = member(n, angle, "WGT=1", "FIX=XYR", member_loads=f" 7 WY={w!r} PX={p!r} AT={at!r}")
    s = solved(deck.replace(f"I={IZ!r}", "I=0"))
    close(s.reaction[1], [-p * (1 - at), (1 - w) * n / 2, 0.0])
    close(s.reaction[2], [-p * at, (1 - w) * n / 2, 0.0])
    assert (7, "moment I") not in s.force


def test_axial_bar_under_its_weight_on_a_truss_node():
    """The node of a truss that no member holds against turning carries no moment of the bars' weight."""
    s = solved("""
NODES
 1 0 0 FIX=XYR
 2 3 0 FIX=XYR
 3 1.5 2
ELEMENTS
 1 BAR 1 3
 2 BAR 2 3
PROPS
 BAR FRAME E=2e8 A=1e-3 WGT=2
LOADS
 3 0 -10 0
""")
    length = 2.5
    close(s.u[3], [0.0, -(10 + 2 * length) / (2 * 2e5 / length * (2 / length) ** 2), 0.0])
    close(s.reaction[1][1] + s.reaction[2][1], 10 + 2 * 2 * length)


@settings(max_examples=40)
@given(
    angle=angles,
    n=st.floats(1.0, 9.0),
    a=st.floats(0, 0.4),
    b=st.floats(0, 0.4),
    shear=st.booleans(),
    pin=st.sampled_from(["NONE", "I", "J", "BOTH", "BAR"]),
    motion=st.tuples(st.floats(-2, 2), st.floats(-2, 2), st.floats(-2, 2)),
)
def test_consistent_mass_has_the_kinetic_energy_of_rigid_motions(angle, n, a, b, shear, pin, motion):
    m, g = 0.8, 9.81
    extra = f"WGT={m * g!r} END1={a * n!r} END2={b * n!r}" + ("" if pin == "BAR" else f" PIN={pin}")
    deck = member(n, angle, extra, shear=shear, head=f"MASS CONSISTENT\nGRAVITY {g}").replace(
        "1.5  -0.7  FIX=XYR", "1.5  -0.7"
    )
    if pin == "BAR":
        deck = deck.replace(f"I={IZ!r}", "I=0")
    s = structure_of(deck)
    vx, vy, turn = motion
    c, sn = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    # about node 1; pinned ends without a block turn at will, so the nodes' own rotations
    # are those of the motion
    v = np.array([vx, vy, turn, vx - turn * n * sn, vy + turn * n * c, turn])
    centre = (vx - turn * n / 2 * sn, vy + turn * n / 2 * c)
    wanted = 0.5 * m * n * (centre[0] ** 2 + centre[1] ** 2) + 0.5 * m * n**3 / 12 * turn**2
    close(0.5 * v @ s.mass @ v, wanted, scale=max(wanted, m * n))
    close(s.mass, s.mass.T)
    assert np.linalg.eigvalsh(s.mass)[0] > -1e-12 * np.abs(s.mass).max()
    # no force from a rigid motion
    assert np.abs(s.stiffness @ v).max() <= 1e-12 * np.abs(s.stiffness).max() * max(1.0, np.abs(v).max())


@pytest.mark.parametrize("mass", ["LUMPED", "CONSISTENT"])
def test_total_mass_is_m_l(mass):
    deck = member(5.0, 30.0, "WGT=9.81 END1=0.5 END2=0.25", head=f"MASS {mass}\nGRAVITY 9.81").replace(
        "FIX=XYR", ""
    )
    s = structure_of(deck)
    for d in range(2):
        r = np.array([1.0 if f[1] == d else 0.0 for f in s.dofs.free])
        close(r @ s.mass @ r, 5.0)
        close(s.ground[d] @ r, 5.0)
    if mass == "LUMPED":  # the flexible half and the block stay with their node
        close(np.diag(s.mass), [2.625, 2.625, 0.0, 2.375, 2.375, 0.0])


def test_reactions_of_the_program_are_those_of_the_test_helper(tmp_path):
    """The report's table of reactions, end to end."""
    from pound_solve.driver.run import Request, execute

    deck = (
        member(4.0, 25.0, "WGT=1 PIN=J", "FIX=XY", member_loads=" 7 WY=-3 PX=2 AT=0.25")
        + "\nANALYSIS\n STATIC\n"
    )
    path = tmp_path / "beam.inp"
    path.write_text(deck)
    _, results, _ = execute(Request(str(path)))
    wanted = solve(model_of(deck)).reaction
    rows = [[float(x) for x in row] for row in results.table("reactions")]
    for row in rows:
        close(row[1:], wanted[int(row[0])], scale=10.0)
    assert [int(r[0]) for r in rows] == [1, 2]


def test_a_column_under_its_weight_is_pressed_more_at_its_foot():
    s = solved(
        "NODES\n 1 0 0 FIX=XYR\n 2 0 4\nELEMENTS\n 7 C 1 2\nPROPS\n C FRAME E=2E7 A=0.1 I=0.001 WGT=3\n"
        "LOADS\n 2 0 -5\nANALYSIS\n STATIC\n"
    )
    close([s.force[7, "axial I"], s.force[7, "axial J"]], [-17.0, -5.0])
