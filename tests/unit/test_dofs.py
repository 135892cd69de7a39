"""DOFs: numbering, slaving with rigid arms, prescribed supports."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from decks import model_of, solved, structure_of
from pound_deck.model import Node, Span
from pound_solve.numerics.matrices import dense
from pound_solve.results.tables.reduced_system import size
from pound_solve.structure.dofs import number

SPAN = Span("test", 1, 1, 2)


def node(n, x, y, fixed="", **slaved):
    return Node(n, x, y, fixed, SPAN, slaved)


def numbered(*nodes, moved=()):
    return number({n.id: n for n in nodes}, moved)


def test_unknowns_come_in_the_order_of_the_nodes():
    f = numbered(node(9, 0, 0), node(2, 1, 0, "XYR"), node(5, 2, 0, "Y"))
    assert f.free == ((9, 0), (9, 1), (9, 2), (5, 0), (5, 2))
    assert f.terms[2, 0] == () and f.terms[5, 1] == ()
    assert f.terms[5, 2] == ((4, 1.0),)


def test_moved_supports_come_last_and_are_no_unknowns():
    f = numbered(node(1, 0, 0, "XYR"), node(2, 0, 1, "R"), moved=[(1, 1), (1, 0)])
    assert f.free == ((2, 0), (2, 1)) and f.moved == ((1, 0), (1, 1)) and f.size == 4
    assert f.terms[1, 0] == ((2, 1.0),) and f.terms[1, 2] == ()


@settings(max_examples=50)
@given(x=st.floats(-5, 5), y=st.floats(-5, 5), u=st.tuples(*[st.floats(-1, 1)] * 3))
def test_a_slave_moves_as_a_rigid_body_with_its_master(x, y, u):
    """The slave stands before its master in the deck: order must not matter."""
    f = numbered(node(1, 1 + x, 2 + y, X=2, Y=2, R=2), node(2, 1, 2))
    ux, uy, turn = u
    assert f.matrix([(1, d) for d in range(3)]) @ np.array(u) == pytest.approx(
        [ux - turn * y, uy + turn * x, turn]
    )


def test_only_the_slaved_directions_follow():
    """A floor that moves along x only keeps its own uy and rz, and its arm turns
    with the master's rotation.
    """
    f = numbered(node(1, 0, 0), node(2, 3, 0.5, X=1))
    assert f.free == ((1, 0), (1, 1), (1, 2), (2, 1), (2, 2))
    assert f.terms[2, 0] == ((0, 1.0), (2, -0.5))


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 0, 2), (1, 2, 0)])
def test_the_arm_turns_with_a_master_that_follows_another_in_rotation(order):
    nodes = (node(1, 0, 0), node(2, 1, 0, R=1), node(3, 1, 2, X=2))
    f = numbered(*(nodes[i] for i in order))
    column = {free: i for i, free in enumerate(f.free)}
    assert dict(f.terms[3, 0]) == {column[2, 0]: 1.0, column[1, 2]: -2.0}


@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 2, 1, 0), (2, 0, 3, 1)])
def test_each_arm_turns_with_the_master_of_its_direction(order):
    """X follows node 1 with an arm of 2, Y follows node 2 with an arm of 3, R follows node 4."""
    nodes = (node(1, 0, 0), node(2, 1, 0), node(3, 4, 2, X=1, Y=2, R=4), node(4, 9, 9))
    f = numbered(*(nodes[i] for i in order))
    column = {free: i for i, free in enumerate(f.free)}
    assert len(column) == 9
    assert dict(f.terms[3, 0]) == {column[1, 0]: 1.0, column[1, 2]: -2.0}
    assert dict(f.terms[3, 1]) == {column[2, 1]: 1.0, column[2, 2]: 3.0}
    assert dict(f.terms[3, 2]) == {column[4, 2]: 1.0}


def test_a_slave_of_a_fixed_master_is_fixed():
    f = numbered(node(1, 0, 0, "XYR"), node(2, 1, 1, X=1, Y=1, R=1))
    assert f.free == () and all(f.terms[2, d] == () for d in range(3))


def test_slaves_on_arms_are_one_rigid_body():
    """Five slaved nodes, loaded and sprung all over, against the same sums done by hand at the master."""
    places = {2: (1.0, 0.0), 3: (1.0, 2.0), 4: (-1.5, 0.5), 5: (0.0, -3.0), 6: (2.0, 2.0)}
    loads = {2: (1.0, 2.0, 3.0), 4: (-2.0, 0.5, 0.0), 6: (0.3, -1.0, -4.0)}
    springs = {3: (300.0, 200.0, 50.0), 5: (500.0, 0.0, 0.0), 4: (10.0, 700.0, 0.0)}
    props = "\n".join(f" S{n} SPRING KX={k[0]} KY={k[1]} KR={k[2]}" for n, k in springs.items())
    s = solved(f"""
NODES
 1 0 0
{chr(10).join(f" {n} {x} {y} SLAVED=XYR MASTER=1" for n, (x, y) in places.items())}
ELEMENTS
{chr(10).join(f" {n} S{n} {n}" for n in springs)}
PROPS
{props}
LOADS
{chr(10).join(f" {n} {a} {b} {c}" for n, (a, b, c) in loads.items())}
WEIGHTS
 2 TO 6  9.81 19.62 4.905
""")
    k, f, m = np.zeros((3, 3)), np.zeros(3), np.zeros((3, 3))
    for n, (x, y) in places.items():
        arm = np.array([[1, 0, -y], [0, 1, x], [0, 0, 1]])
        k += arm.T @ np.diag(springs.get(n, (0, 0, 0))) @ arm
        f += arm.T @ loads.get(n, (0, 0, 0))
        m += arm.T @ np.diag([1.0, 2.0, 0.5]) @ arm
    u = np.linalg.solve(k, f)
    assert s.u[1] == pytest.approx(u, rel=1e-12)
    for n, (x, y) in places.items():
        assert s.u[n] == pytest.approx([u[0] - u[2] * y, u[1] + u[2] * x, u[2]], rel=1e-12)
    assert s.structure.mass == pytest.approx(m, rel=1e-13)


#: two columns, a floor that moves along x as one, and a beam with a hinge at its right end, above the joint
HINGED = """
NODES
 1 0 0 FIX=XYR
 2 6 0 FIX=XYR
 3 0 3
 4 6 3 {floor}
 5 6 3.2 {hinge}
ELEMENTS
 1 COLUMN 1 3
 2 COLUMN 2 4
 3 BEAM 3 5
 4 HINGE 4 5
PROPS
 COLUMN FRAME E=2E8 A=0.01 I=1E-4
 BEAM FRAME E=2E8 A=0.008 I=1.5E-4
 HINGE SPRING KR=6E3
WEIGHTS
 3,4 98.1 98.1 9.81
 5 49.05 49.05 4.905
LOADS
 3 10 -20 5
 4 0 -3 0
 5 7 -50 3
"""


def test_a_hinge_at_a_joint_that_follows_its_floor():
    """Node 5 follows node 3 along x, node 4 along y; against the same frame with its ties done by hand."""
    tied = solved(HINGED.format(floor="SLAVED=X MASTER=3", hinge="SLAVED=YX MASTER=4,3"))
    loose = structure_of(HINGED.format(floor="", hinge=""))
    at = {dof: i for i, dof in enumerate(loose.dofs.free)}
    t = np.zeros((9, 6))  # all unknowns from ux, uy, rz of node 3, uy and rz of node 4, rz of node 5
    kept = [(3, 0), (3, 1), (3, 2), (4, 1), (4, 2), (5, 2)]
    for column, dof in enumerate(kept):
        t[at[dof], column] = 1.0
    t[at[4, 0], 0] = 1.0
    t[at[5, 0], 0], t[at[5, 0], 2] = 1.0, -0.2  # the arm turns with node 3, the master along x
    t[at[5, 1], 3] = 1.0
    k, m = (t.T @ dense(matrix) @ t for matrix in (loose.initial_stiffness, loose.mass))
    p = np.zeros(9)
    for n, *forces in ((3, 10, -20, 5), (4, 0, -3, 0), (5, 7, -50, 3)):
        p[[at[n, d] for d in range(3)]] = forces
    u = t @ np.linalg.solve(k, t.T @ p)
    for n in (3, 4, 5):
        assert tied.u[n] == pytest.approx([u[at[n, d]] for d in range(3)], rel=1e-12)
    assert tied.structure.dofs.free == tuple(kept)
    assert dense(tied.structure.mass) == pytest.approx(m, rel=1e-13)
    squares = scipy.linalg.eigh(k, m, eigvals_only=True)
    assert tied.structure.free_vibration.omega == pytest.approx(np.sqrt(squares), rel=1e-12)


def test_the_deck_fills_nodes():
    model = model_of(
        "NODES\n 1 0 0 FIX=XYR\n 2 1 0 FIX=R\n 3 1 1 FIX=Y SLAVED=XR MASTER=2\n"
        "ELEMENTS\n 1 S 1 2\nPROPS\n S SPRING KX=1"
    )
    assert model.nodes[3].slaved == {"X": 2, "R": 2} and model.nodes[3].fixed == "Y"


def test_ground_moves_what_rides_on_a_slave():
    """Mass on arms: the ground's pull has a moment about the master; a turn about the origin
    moves the mass on a circle.
    """
    s = structure_of("""
NODES
 1 0 0
 2 3 4 SLAVED=XYR MASTER=1
ELEMENTS
 1 S 1
PROPS
 S SPRING KX=1 KY=1 KR=1
WEIGHTS
 2 9.81
""")
    assert s.ground == pytest.approx(np.array([[1, 0, -4], [0, 1, 3], [-4, 3, 25]]), abs=1e-14)


def test_the_report_s_dofs_add_up_to_the_unknowns():
    deck = """
GRAVITY 10
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=R SLAVED=X MASTER=4
 3 4 0 FIX=XYR
 4 4 3
ELEMENTS
 1 COLUMN 1 2
 2 COLUMN 3 4
 3 BEAM   2 4
PROPS
 COLUMN FRAME E=2E8 A=0.01 I=1E-4
 BEAM   FRAME E=2E8 A=0.01 I=1E-4 RULE=BILINEAR LP=0.2,0.2 MI=100 MJ=100
"""
    structure = structure_of(deck, moved=[(1, 0)])
    counts = {item: int(value) for item, value in size.rows(SimpleNamespace(structure=structure))}
    assert counts == {
        "nodes": 4,
        "elements": 3,
        "degrees of freedom of nodes": 12,
        "less fixed": 6,  # node 1 Y and R, node 2 R, node 3 X, Y and R
        "less prescribed at moved supports": 1,
        "less slaved": 1,
        "plus internal of elements (hinges)": 2,
        "unknowns before reduction": 12 - 6 - 1 - 1 + 2,
        "hysteretic components": 2,
        "contacts": 0,
    }
