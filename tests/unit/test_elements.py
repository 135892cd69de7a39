"""Springs, dashpots and contacts: components, signs, directions, colliding masses, mistakes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from decks import model_of, solved, structure_of
from pound_solve.structure.assembly import AssemblyError, assemble
from pound_solve.structure.elements.base import axes, direction


@pytest.mark.parametrize("turns", [-2, -1, 0, 1, 5])
def test_axes_are_exact_at_right_angles(turns):
    for quarter, wanted in enumerate(
        (((1, 0), (0, 1)), ((0, 1), (-1, 0)), ((-1, 0), (0, -1)), ((0, -1), (1, 0)))
    ):
        assert axes(360.0 * turns + 90.0 * quarter) == wanted


@given(st.floats(-1e4, 1e4))
def test_axes_are_orthonormal_and_anticlockwise(angle):
    (a, b), (c, d) = axes(angle)
    assert a * a + b * b == pytest.approx(1) and (c, d) == (-b, a)
    assert (a, b) == pytest.approx(
        (math.cos(math.radians(angle)), math.sin(math.radians(angle))), abs=1e-11
    )


def test_directions_drop_what_is_rounding_of_coordinates():
    assert direction(2.0, 3 * 1.1 - 3.3) == (1.0, 0.0)
    assert direction(3.5 * math.cos(math.pi / 2), 3.5) == (0.0, 1.0)
    assert direction(3.0, -4.0) == (0.6, -0.8)


@settings(max_examples=40)
@given(
    angle=st.floats(-180, 180),
    f=st.tuples(st.floats(-9, 9), st.floats(-9, 9), st.floats(-9, 9)),
    both=st.booleans(),
)
def test_components_of_a_spring(angle, f, both):
    """u = (fx/KX, fy/KY) along the turned axes; forces positive where J moves ahead of I."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    turn = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    ends = "2 1" if both else "1"
    r = solved(f"""
NODES
 1 0 0
 2 3 1 FIX=XYR
ELEMENTS
 4 S {ends}
PROPS
 S SPRING KX=100 KY=300 KR=50 ANGLE={angle!r}
LOADS
 1 {f[0]!r} {f[1]!r} {f[2]!r}
""")
    force = turn @ np.array(f)
    assert turn @ r.u[1] == pytest.approx(force / [100, 300, 50], rel=1e-9, abs=1e-13)
    names = ("force X", "force Y", "moment R")
    assert [r.force[4, x] for x in names] == pytest.approx(force, rel=1e-9, abs=1e-12)


def test_hysteretic_and_elastic_components_take_the_same_signs():
    deck = """
NODES
 1 0 0 FIX=XYR
 2 3 1
ELEMENTS
 4 S 1 2
PROPS
 S SPRING KX=100 KY=300 KR=50 ANGLE=25 {}
LOADS
 2 3 -4 2
"""
    a, b = solved(deck.format("")), solved(deck.format("FX=1e6 FY=1e6 MR=1e6 RULE=ELASTO_PLASTIC"))
    assert b.u[2] == pytest.approx(a.u[2], rel=1e-12)
    assert {k: pytest.approx(v, rel=1e-12) for k, v in a.force.items()} == b.force
    assert not a.structure.laws and len(b.structure.laws) == 3
    assert b.structure.initial_stiffness == pytest.approx(a.structure.stiffness, rel=1e-13)
    assert not b.structure.stiffness.any()
    assert b.structure.laws[0].yields == (1e4, -1e4)


def test_a_rule_for_each_component():
    s = structure_of("""
NODES
 1 0 0
ELEMENTS
 4 S 1
PROPS
 S SPRING KX=1 KY=2 KR=3 FX=1 MR=4 RULE=BILINEAR,ELASTIC,ELASTO_PLASTIC R=0.1
""")
    assert [(x.component, x.rule) for x in s.laws] == [("X", "BILINEAR"), ("R", "ELASTO_PLASTIC")]
    assert s.stiffness[1, 1] == 2


def test_yield_forces_are_signed():
    with pytest.raises(AssemblyError, match="a positive value, then a negative one"):
        structure_of("NODES\n 1 0 0\nELEMENTS\n 4 S 1\nPROPS\n S SPRING KX=1 FX=5,5 RULE=ELASTO_PLASTIC")


@settings(max_examples=30)
@given(angle=st.floats(-180, 180))
def test_dashpot_is_a_spring_on_velocities(angle):
    head = "NODES\n 1 0 0\n 2 1 0.5\nELEMENTS\n 4 S 1 2\nPROPS\n S "
    d = structure_of(head + f"DASHPOT CX=100 CY=300 CR=50 ANGLE={angle!r}")
    k = structure_of(head + f"SPRING KX=100 KY=300 KR=50 ANGLE={angle!r}")
    assert not d.stiffness.any() and np.array_equal(d.damping, k.stiffness)
    assert np.array_equal(d.damping, d.damping.T)
    for a, b in zip(d.outputs, k.outputs):
        assert np.array_equal(a.v_row, b.u_row) and not np.any(a.u_row) and a.quantity == b.quantity


CONTACT = """
GRAVITY 10
NODES
 1 0 0 {fix1}
 2 3 4 {fix2}
 3 9 9 {fix3}
ELEMENTS
 4 S 1
 5 S 2
 8 F 1 3
 9 C {ends}
PROPS
 S SPRING KX=100 KY=100 KR=1
 F FRAME E=1 A=1 I=1 WGT=0
 C CONTACT GAP=0.1 LAW=KELVIN_VOIGT K=300 E=0.5 {angle}
WEIGHTS
 1 20 30
 2 40 80
 3 50
"""


def contact(ends="1 2", angle="", fix1="", fix2="", fix3="FIX=XYR"):
    s = structure_of(CONTACT.format(ends=ends, angle=angle, fix1=fix1, fix2=fix2, fix3=fix3))
    (spring,) = s.laws
    return s, spring


def test_the_normal_points_from_i_to_j():
    _, spring = contact()
    assert dict(zip(spring.dofs, spring.row)) == pytest.approx(
        {(1, 0): 0.6, (1, 1): 0.8, (2, 0): -0.6, (2, 1): -0.8}
    )
    _, spring = contact("2 1")
    assert dict(zip(spring.dofs, spring.row)) == pytest.approx(
        {(2, 0): -0.6, (2, 1): -0.8, (1, 0): 0.6, (1, 1): 0.8}
    )
    assert contact("1")[1].row == (1.0,)
    assert contact("1", "ANGLE=90")[1].dofs == ((1, 1),)
    assert contact(angle="ANGLE=180")[1].row == (-1.0, 1.0)


@pytest.mark.parametrize(
    ("kwargs", "wanted"),
    [
        ({"angle": "ANGLE=0"}, 2 * 4 / 6),
        ({"angle": "ANGLE=-90"}, 3 * 8 / 11),
        ({"ends": "1"}, 2.0),  # a wall is infinitely heavy
        ({"angle": "ANGLE=0", "fix2": "FIX=X"}, 2.0),  # so is a held node
        ({}, 1 / (0.36 / 2 + 0.64 / 3 + 0.36 / 4 + 0.64 / 8)),  # 1/m = sum n^2/m_d for each node
        ({"fix2": "FIX=Y"}, 1 / (0.36 / 2 + 0.64 / 3 + 0.36 / 4)),
        (
            {"angle": "ANGLE=0", "fix3": "SLAVED=X MASTER=2"},
            2 * 9 / 11,
        ),  # what follows a node strikes with it
        ({"angle": "ANGLE=0", "fix2": "SLAVED=X MASTER=3"}, 2.0),  # a slave of a held node is held
        ({"angle": "ANGLE=0 MASSES=3"}, 3.0),
        ({"angle": "ANGLE=0 MASSES=3,6"}, 2.0),
    ],
)
def test_colliding_masses(kwargs, wanted):
    assert contact(**kwargs)[1].facts["reduced_mass"] == pytest.approx(wanted, rel=1e-13)


def test_a_slave_strikes_with_its_master():
    _, spring = contact(ends="1 3", angle="ANGLE=0", fix3="SLAVED=X MASTER=2")
    assert spring.facts["reduced_mass"] == pytest.approx(2 * 9 / 11)


def test_members_count_into_colliding_masses():
    for mass in ("LUMPED", "CONSISTENT"):
        s = structure_of(
            f"""
GRAVITY 10
MASS {mass}
NODES
 1 0 0 FIX=XYR
 2 0 4
ELEMENTS
 9 C 2
 1 F 1 2
PROPS
 F FRAME E=1 A=1 I=1 WGT=10
 C CONTACT LAW=KELVIN_VOIGT K=300 E=0.5
WEIGHTS
 2 30
""".replace("CONTACT LAW", "CONTACT GAP=0 LAW")
        )
        # a consistent member gives the row sum of its matrix: half of it, were both ends to move
        assert s.laws[0].facts["reduced_mass"] == pytest.approx(3 + 2, rel=1e-12)


def test_coinciding_nodes_need_an_angle():
    deck = CONTACT.format(ends="1 2", angle="", fix1="", fix2="", fix3="FIX=XYR").replace("2 3 4", "2 0 0")
    with pytest.raises(AssemblyError, match="ANGLE"):
        structure_of(deck)


def test_mistakes_name_the_card():
    deck = """
NODES
 1 0 0 FIX=XYR
 2 0 4
 3 0 5
ELEMENTS
 1 F 1 2
 2 G 2 3
 3 S 2 3
PROPS
 F FRAME E=1 A=1 I=1 END1=3 END2=1
 G FRAME E=1 A=1 I=1 AS=0.1
 S SPRING KX=1
MEMBER_LOADS
 3 WX=1
"""
    with pytest.raises(AssemblyError) as caught:
        structure_of(deck)
    found = {(d.code, d.span.line, d.span.column) for d in caught.value.diagnostics}
    assert found == {("P330", 11, 27), ("P330", 12, 25), ("P331", 15, 2)}


def test_members_need_two_nodes():
    with pytest.raises(AssemblyError, match="two nodes"):
        structure_of("NODES\n 1 0 0\nELEMENTS\n 1 F 1\nPROPS\n F FRAME E=1 A=1 I=1")


def test_weights_are_divided_by_gravity_and_default_to_both_directions():
    s = structure_of(
        "GRAVITY 4\nNODES\n 1 0 0\n 2 1 0\nELEMENTS\n 1 S 1 2\n"
        "PROPS\n S SPRING KX=1\n"
        "WEIGHTS\n 1 8\n 2 8 12 2"
    )
    assert np.diag(s.mass).tolist() == [2, 2, 0, 2, 3, 0.5]


def test_assembly_does_not_change_the_model():
    model = model_of(CONTACT.format(ends="1 2", angle="", fix1="", fix2="", fix3="FIX=XYR"))
    a, b = assemble(model), assemble(model)
    assert np.array_equal(a.stiffness, b.stiffness) and np.array_equal(a.mass, b.mass)


INCLINED = """
NODES
 1 1 2
 2 4 6
ELEMENTS
 1 S 1 2
PROPS
 S {kind} ANGLE=MEMBER {items}
"""


@pytest.mark.parametrize(
    ("kind", "x", "y", "r"), [("SPRING", "KX", "KY", "KR"), ("DASHPOT", "CX", "CY", "CR")]
)
def test_components_along_the_member_and_across_it(kind, x, y, r):
    """A line of length 5 with the direction (0.6, 0.8): x along it, y to its left."""
    s = structure_of(INCLINED.format(kind=kind, items=f"{x}=10 {y}=20 {r}=30"))
    k = np.asarray(s.stiffness if kind == "SPRING" else s.damping)
    u = np.zeros(6)
    u[3:] = 0.6, 0.8, 0.0
    assert k @ u == pytest.approx([-6.0, -8.0, 0.0, 6.0, 8.0, 0.0])
    u[3:] = -0.8, 0.6, 0.0
    assert k @ u == pytest.approx([16.0, -12.0, 0.0, -16.0, 12.0, 0.0])


@pytest.mark.parametrize("arm", [0.0, 0.3, 1.0])
def test_a_spring_on_rigid_arms_carries_its_couple(arm):
    """No force by a motion as a rigid body, and forces in equilibrium: the moments are those about ARM."""
    k = np.asarray(structure_of(INCLINED.format(kind="SPRING", items=f"KX=10 KY=20 ARM={arm}")).stiffness)
    for rigid in ([1, 0, 0, 1, 0, 0], [0, 1, 0, 0, 1, 0], [-2, 1, 1, -6, 4, 1]):
        assert k @ np.array(rigid, float) == pytest.approx(np.zeros(6), abs=1e-12)
    f = k @ np.array([0, 0, 0, -0.8, 0.6, 0.0])  # across the line, to its left
    assert f == pytest.approx([16, -12, -100 * arm, -16, 12, -100 * (1 - arm)])


@pytest.mark.parametrize("items", ["ARM=0.5", "ANGLE=MEMBER"])
def test_a_spring_without_a_line_has_no_axis_and_no_arm(items):
    text = INCLINED.format(kind="SPRING", items="KX=1").replace("ANGLE=MEMBER", items)
    for changed in (text.replace(" 2 4 6", " 2 1 2"), text.replace(" 1 S 1 2", " 1 S 1")):
        with pytest.raises(AssemblyError, match=r"the nodes coincide|needs a node J"):
            structure_of(changed)
