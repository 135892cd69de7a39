"""Rows of springs, tendons, gaps and hooks, footings: against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from decks import solved, structure_of
from pound_solve.analyses import static
from pound_solve.numerics.types import Array
from pound_solve.structure.assembly import AssemblyError
from pound_solve.structure.elements.foundation import radiation, stiffness
from pound_solve.structure.elements.multispring import lobatto
from pound_solve.structure.structure import Structure
from verification.cases import run_text


def at_node(structure: Structure, node: int, matrix: Array) -> Array:
    """Part of a matrix for the three DOFs of a node, the others following, shape (3, 3)."""
    free = structure.dofs.free
    own = [free.index((node, d)) for d in range(3)]
    rest = [i for i in range(len(free)) if i not in own and matrix[i].any()]
    follow = np.linalg.solve(matrix[np.ix_(rest, rest)], matrix[np.ix_(rest, own)])
    return matrix[np.ix_(own, own)] - matrix[np.ix_(own, rest)] @ follow


# ---------------------------------------------------------------------- MULTISPRING


@given(count=st.integers(2, 50), power=st.integers(0, 97))
def test_lobatto_points_integrate_polynomials(count, power):
    """Exactly up to the power 2 n - 3; both ends are points."""
    x, w = lobatto(count)
    assert (x[0], x[-1]) == (-1.0, 1.0) and np.all(np.diff(x) > 0) and np.all(w > 0)
    if power <= 2 * count - 3:
        assert (w * x**power).sum() == pytest.approx(
            0 if power % 2 else 1 / (power + 1), rel=1e-12, abs=1e-14
        )


def row(items: str, load: str, more: str = "", loads: str = "LOADS\n") -> str:
    """Node 2 on a row of upright springs, held sideways."""
    return f"""
NODES
 1 0 -6 FIX=XYR
 2 0 0 FIX=X
ELEMENTS
 5 S 2
PROPS
 S MULTISPRING {items}
{more}
{loads} 2 {load}
"""


def test_an_elastic_row():
    k, b = 3e5, 2.4
    s = solved(row(f"KX={k} WIDTH={b}", "0 -90 40"))
    assert s.u[2] == pytest.approx([0, -90 / k, 40 / (k * b**2 / 12)], rel=1e-12)
    assert s.force[5, "axial"] == pytest.approx(-90) and s.force[5, "moment"] == pytest.approx(40)
    assert not s.structure.laws


@pytest.mark.parametrize("angle", [0, 90, 200])
def test_springs_where_they_are_put(angle):
    """Bars at y = -0.2, 0.1, 0.3 of shares 1, 1, 2 along any direction; elastic and yielding agree."""
    y, share, k = np.array([-0.2, 0.1, 0.3]), np.array([0.25, 0.25, 0.5]), 4e4
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    deck = f"""
NODES
 1 0 0 FIX=XYR
 2 0 0
ELEMENTS
 5 S 1 2
 6 T 1 2
PROPS
 S MULTISPRING KX={k} ANGLE={angle} Y=-0.2,0.1,0.3 SHARE=1,1,2 {{}}
 T SPRING KY=1e3 ANGLE={angle}
LOADS
 2 {30 * c!r} {30 * s!r} 4
"""
    stiff = np.array([[k, -k * share @ y], [-k * share @ y, k * share @ y**2]])
    along, turn = np.linalg.solve(stiff, [30, 4])
    a, b = solved(deck.format("")), solved(deck.format("FX=1e6 RULE=ELASTO_PLASTIC"))
    for got in (a, b):
        assert got.u[2] == pytest.approx([along * c, along * s, turn], rel=1e-10, abs=1e-15)
    assert a.force[5, "moment"] == pytest.approx(4)
    forces = [b.force[5, f"force spring {n}"] for n in (1, 2, 3)]
    assert forces == pytest.approx(k * share * (along - y * turn), rel=1e-10)


def test_rocking_on_two_corners():
    """Two springs at the corners: one lifts off at M = P b / 2, and then the wall falls."""
    p, b = 200.0, 3.0
    items = f"KX=1e6 WIDTH={b} COUNT=2 TENSION=NO"
    assert solved(row(items, f"0 {-p} {0.999 * p * b / 2}")).state.events == 0
    with pytest.raises(static.InstabilityError, match="mechanism"):
        solved(row(items, f"0 {-p} {1.001 * p * b / 2}"))


def test_a_wall_with_a_tendon_rocks_by_the_closed_form():
    """After lift-off all of N = P + T goes through one corner, and the axis rises by theta b/2 - N/k:
    N (1 + kt/k) = P + N0 + kt theta b/2, M = N b/2; the tendon yields at T = PY.
    """
    p, b, k, area, n0, py, r = 200.0, 3.0, 4e5, 1e-3, 300.0, 500.0, 0.05
    kt = 2e8 * area / 6
    more = f" T TENDON E=2e8 A={area} N0={n0} PY={py} R={r}"
    deck = row(f"KX={2 * k} WIDTH={b} COUNT=2 TENSION=NO", "0 {} {}", more).replace(
        "5 S 2", "5 S 2\n 6 T 1 2"
    )
    s = solved(deck.format(-p, 0))
    rise = -(p + n0) / (2 * k + kt)  # both corners and the tendon share weight and prestress
    assert s.u[2] == pytest.approx([0, rise, 0], rel=1e-10, abs=1e-15)
    assert s.force[6, "force axial"] == pytest.approx(n0 + kt * rise, rel=1e-12)
    for moment in (800.0, 1000.0):
        s = solved(deck.format(-p, moment))
        n = 2 * moment / b
        turn = (n * (1 + kt / k) - p - n0) / (kt * b / 2)
        assert s.force[6, "force axial"] == pytest.approx(n - p, rel=1e-10) and n - p < py
        assert s.u[2] == pytest.approx([0, turn * b / 2 - n / k, turn], rel=1e-10)
    s = solved(deck.format(-p, 1100))
    n = 2 * 1100 / b
    rise = (py - n0) / kt + (n - p - py) / (r * kt)
    assert s.u[2] == pytest.approx([0, rise, (rise + n / k) * 2 / b], rel=1e-10)


def test_many_springs_come_near_to_an_elastic_bed():
    """Bed of k per length, no tension: M = P (b/2 - c/3), contact over the length c = (2P/k theta)^1/2."""
    p, b, k = 200.0, 3.0, 1e5
    worst = {}
    for count in (6, 12, 24, 48):
        off = []
        for c in (0.8 * b, 0.5 * b, 0.3 * b):
            moment, turn = p * (b / 2 - c / 3), 2 * p / (k * c**2)
            s = solved(row(f"KX={k * b} WIDTH={b} COUNT={count} TENSION=NO", f"0 {-p} {moment!r}"))
            off.append(abs(s.u[2][2] / turn - 1))
        worst[count] = max(off)
    assert worst[48] < 0.002 and worst[24] < 0.011 and worst[48] < worst[24] < worst[12] < worst[6]


def test_crushed_soil():
    """Strength Q in all: the largest moment under P is P b/2 (1 - P/Q), as of a strip that is pressed to
    its strength over the length b P/Q.
    """
    p, q, b = 200.0, 800.0, 3.0
    items = f"KX=1e6 WIDTH={b} COUNT=50 TENSION=NO FX={q}"
    most = p * b / 2 * (1 - p / q)
    solved(row(items, f"0 {-p} {0.995 * most}"))
    with pytest.raises(static.InstabilityError):
        solved(row(items, f"0 {-p} {1.01 * most}"))
    with pytest.raises(static.InstabilityError):
        solved(row(items, f"0 {-1.001 * q} 0"))


def test_bars_and_concrete_side_by_side():
    """Two rows between the same nodes: bars carry both ways, concrete only compression."""
    deck = """
NODES
 1 0 0 FIX=XYR
 2 0 0 FIX=X
ELEMENTS
 5 BARS 1 2
 6 CONC 1 2
PROPS
 BARS MULTISPRING KX=2e6 FX=600 Y=-0.17,0,0.17 SHARE=3,2,3 RULE=ELASTO_PLASTIC
 CONC MULTISPRING KX=9e6 FX=3200 WIDTH=0.4 TENSION=NO
LOADS
 2 0 {} {}
"""
    for sign, strength in ((1, 600.0), (-1, 3800.0)):
        solved(deck.format(sign * 0.999 * strength, 0))
        with pytest.raises(static.InstabilityError):
            solved(deck.format(sign * 1.001 * strength, 0))
    # tension bars 225 at 0.17 each way and the middle ones, concrete at the edge: bounds of M at N = 0
    low, high = 2 * 225 * 0.17, 2 * 225 * 0.17 + 375 * 0.2
    solved(deck.format(0, low))
    with pytest.raises(static.InstabilityError):
        solved(deck.format(0, high))


@pytest.mark.parametrize(
    ("items", "at", "message"),
    [
        ("KX=1", "", "WIDTH or as Y"),
        ("KX=1 WIDTH=1 Y=1", "Y", "WIDTH or as Y"),
        ("KX=1 WIDTH=1 SHARE=1", "SHARE", "SHARE goes with Y"),
        ("KX=1 Y=0,1 SHARE=1", "SHARE", "SHARE has 1 values, Y has 2"),
        ("KX=1 WIDTH=1 FX=2", "FX", "no effect with RULE=ELASTIC"),
        ("KX=1 WIDTH=1 RULE=BILINEAR", "RULE", "needs the yield force FX"),
        ("KX=1 WIDTH=1 FX=1 RULE=BILINEAR TENSION=NO", "RULE", "a rule of its own"),
        ("KX=1 WIDTH=1 FX=1,1 RULE=BILINEAR", "FX", "a positive value, then a negative one"),
    ],
)
def test_rows_that_do_not_fit_together(items, at, message):
    deck = row(items, "0 0 0")
    with pytest.raises(AssemblyError, match=message) as caught:
        structure_of(deck)
    place = caught.value.diagnostics[0].span
    assert deck.splitlines()[place.line - 1][: place.column - 1].endswith(f"{at}=" if at else " ")


# ---------------------------------------------------------------------- TENDON


def stay(items: str, load: str, angle: float = 30.0) -> str:
    """Node 2 on a spring 500 both ways, with a tendon of 5 from the ground."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return f"""
NODES
 1 0 0 FIX=XYR
 2 {5 * c!r} {5 * s!r} FIX=R
ELEMENTS
 3 T 1 2
 4 S 2
PROPS
 T TENDON E=2e8 A=1e-5 {items}
 S SPRING KX=500 KY=500
LOADS
 2 {load}
"""


@pytest.mark.parametrize("angle", [0, 30, 135, 270])
def test_a_tendon_pulls_along_its_line_and_hangs_slack(angle):
    c, s, k = math.cos(math.radians(angle)), math.sin(math.radians(angle)), 2e8 * 1e-5 / 5
    for items, load, elongation, force in (
        ("", 30, 30 / (500 + k), 30 * k / (500 + k)),
        ("", -30, -30 / 500, 0),
        ("SLACK=0.04", 15, 0.03, 0),
        ("SLACK=0.04", 65, 0.04 + 45 / (500 + k), 45 * k / (500 + k)),
        ("PY=10 R=0.1", 65, 10 / k + (65 - 10 - 500 * 10 / k) / (500 + 0.1 * k), None),
        ("N0=40", 0, -40 / (500 + k), 40 * 500 / (500 + k)),
        ("N0=40", -60, -60 / 500, 0),
        ("N0=40 PY=60", 20, 20 / (500 + k) - 40 / (500 + k), 40 - 20 * k / (500 + k)),
        ("N0=40 PY=50", 90, (90 - 50) / 500, 50),
    ):
        got = solved(stay(items, f"{load * c!r} {load * s!r}", angle))
        assert [c, s] @ got.u[2][:2] == pytest.approx(elongation, rel=1e-10)
        if force is not None:
            assert got.force[3, "force axial"] == pytest.approx(force, rel=1e-10, abs=1e-12)
            reaction = got.reaction[1][:2]
            assert reaction == pytest.approx([-force * c, -force * s], rel=1e-9, abs=1e-12)


def test_in_modes_a_tendon_counts_where_it_is_taut():
    for items, k in (("", 500), ("N0=1", 900), ("SLACK=0.1", 500)):
        s = structure_of(stay(items, "0 0", 0.0))
        assert s.initial_stiffness[0, 0] == pytest.approx(k)


@pytest.mark.full
def test_a_braced_mass_in_time():
    """Two prestressed tendons against each other that yield: EXACT balances the energy, no force is
    negative, and what yield took off the prestress is gone.
    """
    r = run_text("""
NODES
 1 0 0 FIX=XYR
 2 4 0 FIX=YR
 3 8 0 FIX=XYR
ELEMENTS
 1 T 1 2
 2 T 2 3
 3 S 2
PROPS
 T TENDON E=2e8 A=2e-5 N0=40 PY=70 R=0.02
 S SPRING KX=300
WEIGHTS
 2 200
EQUAKE
 SINE DIRECTION=X AMPLITUDE=3 PERIOD=0.7
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 5 METHOD=EXACT
""")
    assert r.status == "done" and r.check() < 1e-9
    table = r.tables["spring_envelope"]
    assert list(table["component"]) == ["axial", "axial"] and set(table["unit"]) == {"kN"}
    assert table["force_min"] == pytest.approx([0, 0], abs=1e-12) and np.all(table["force_max"] > 70)
    assert np.all(table["plastic_work"] > 0) and np.all(table["yield_events"] > 0)


@pytest.mark.parametrize(
    ("items", "message"),
    [("N0=5 SLACK=0.1", "slack or prestressed, not both"), ("N0=5 PY=5", "no less than the yield force")],
)
def test_tendons_that_do_not_fit_together(items, message):
    with pytest.raises(AssemblyError, match=message):
        structure_of(stay(items, "0 0"))


def test_a_tendon_needs_two_nodes():
    deck = stay("", "0 0")
    with pytest.raises(AssemblyError, match="needs two nodes"):
        structure_of(deck.replace("3 T 1 2", "3 T 2"))


# ---------------------------------------------------------------------- gaps and hooks


def pair(prop: str, load: float) -> str:
    return f"""
NODES
 1 0 0 FIX=XYR
 2 2 0 FIX=YR
ELEMENTS
 3 P 1 2
 4 S 2
PROPS
 P {prop}
 S SPRING KX=100
LOADS
 2 {load}
"""


def test_a_spring_may_name_a_rule_twice():
    """Three rules for x, y, rotation, two of them the same; two rules are none."""
    deck = """
NODES
 1 0 0
ELEMENTS
 4 S 1
PROPS
 S SPRING KX=1 KY=2 KR=3 MR=4 RULE={}
"""
    s = structure_of(deck.format("ELASTIC,ELASTIC,BILINEAR"))
    assert [(x.component, x.rule, x.unit) for x in s.laws] == [("R", "BILINEAR", "F*L")]
    with pytest.raises(AssemblyError, match="one rule for all components, or three"):
        structure_of(deck.format("ELASTIC,BILINEAR"))


@pytest.mark.parametrize(
    ("prop", "way"),
    [
        ("CONTACT GAP=0.1 LAW=LINEAR K=400", -1),  # a gap: node 1 and 2 come together
        ("CONTACT GAP=0.1 ANGLE=180 LAW=LINEAR K=400", 1),  # a hook: they move apart
        ("SPRING KX=400 FX=1E9 RULE=BILINEAR_SLACK SLACK=1E9,-0.1", -1),
        ("SPRING KX=400 FX=1E9 RULE=BILINEAR_SLACK SLACK=0.1,-1E9", 1),
    ],
)
def test_gaps_and_hooks(prop, way):
    assert solved(pair(prop, 60.0 * way)).u[2][0] == pytest.approx(way * (0.1 + 50 / 500), rel=1e-12)
    assert solved(pair(prop, -60.0 * way)).u[2][0] == pytest.approx(-way * 0.6, rel=1e-12)
    assert solved(pair(prop, 9.0 * way)).u[2][0] == pytest.approx(way * 0.09, rel=1e-12)


# ---------------------------------------------------------------------- FOUNDATION

SOIL = "G=45e3 NU=0.3 WGT=18"


def footing(items: str, more: str = "", loads: str = "") -> str:
    return f"""
NODES
 1 0 0
ELEMENTS
 5 F 1
PROPS
 F FOUNDATION {items}
{more}
{loads}
"""


def test_square_and_round_footings():
    """Published for a square of half width B: 9 GB/(2 - nu), 4.54 GB/(1 - nu), 3.6 GB^3/(1 - nu)
    (Gazetas 1991, table 15.1); a disc of the same area and inertia has 8 Gr/(2 - nu), 4 Gr/(1 - nu),
    8 Gr^3/3(1 - nu), which are exact.
    """
    g, nu, b = 3.0, 0.3, 1.5
    got = stiffness(g, nu, b, b)
    assert got == pytest.approx(
        (9 * g * b / (2 - nu), 4.54 * g * b / (1 - nu), 3.6 * g * b**3 / (1 - nu)), rel=2e-3
    )
    r, s = 2 * b / math.sqrt(math.pi), (16 * b**4 / (3 * math.pi)) ** 0.25
    disc = (8 * g * r / (2 - nu), 4 * g * r / (1 - nu), 8 * g * s**3 / (3 * (1 - nu)))
    assert got[:2] == pytest.approx(disc[:2], rel=0.01) and got[2] == pytest.approx(disc[2], rel=0.11)


def test_long_footings():
    """By hand for 2 x 8, nu = 0.3, G = 1: the short way and the long way; the long way slides softer by
    0.2 G L (1 - B/L) / (0.75 - nu).
    """
    along, across = stiffness(1.0, 0.3, 4.0, 1.0), stiffness(1.0, 0.3, 1.0, 4.0)
    assert along[1] == pytest.approx(across[1]) and along[1] == pytest.approx(
        8 / 0.7 * (0.73 + 1.54 * 0.25**0.75)
    )
    assert across[0] - along[0] == pytest.approx(0.2 * 4 * 0.75 / 0.45)
    assert across[0] == pytest.approx(8 / 1.7 * (2 + 2.5 * 0.25**0.85))
    ratio = 0.25  # by hand, with the inertias 4 L B^3 / 3
    assert along[2] == pytest.approx(3 / 0.7 * (4 * 64 / 3) ** 0.75 * 4**0.15)
    assert across[2] == pytest.approx(1 / 0.7 * (4 * 4 / 3) ** 0.75 * 4**0.25 * (2.4 + 0.5 * ratio))


@pytest.mark.parametrize("nu", [0.0, 0.25, 0.45])
@pytest.mark.parametrize("shape", [(1.2, 1.2), (1.0, 2.5), (2.5, 1.0)])
def test_the_dynamic_stiffness_is_that_of_the_cones(nu, shape):
    """Translation K + i w C; rocking K (1 - b^2 / 3(1 + b^2)) + i w C b^2 / (1 + b^2), b = w z0 / c
    (Wolf and Deeks 2004): the wave equation of a cone.
    """
    g, gamma, (b, across) = 45e3, 18.0, shape
    s = structure_of(f"GRAVITY 10\n{footing(f'G={g} NU={nu} WGT={gamma} B={b} L={across}')}")
    kx, ky, kr = stiffness(g, nu, b, across)
    rho, area, inertia = gamma / 10, 4 * b * across, 4 * across * b**3 / 3
    shear = math.sqrt(g / rho)
    press = shear * min(math.sqrt(2 * (1 - nu) / (1 - 2 * nu)), 2.0)
    for w in (1e-3, 20.0, 200.0, 5e3):
        whole = s.initial_stiffness + 1j * w * s.damping - w**2 * s.mass
        got = at_node(s, 1, whole)
        z0 = 3 * rho * press**2 * inertia / kr
        x = w * z0 / press
        wanted = [
            kx + 1j * w * rho * shear * area,
            ky + 1j * w * rho * press * area,
            kr * (1 - x**2 / (3 * (1 + x**2))) + 1j * w * rho * press * inertia * x**2 / (1 + x**2),
        ]
        assert np.abs(got - np.diag(wanted)).max() <= 1e-12 * np.abs(wanted).max()
        assert np.diag(got) == pytest.approx(wanted, rel=1e-11)
    assert radiation(s.model.props["F"], 10.0, kr)[3] == pytest.approx(rho * inertia * z0)


def test_without_weight_there_is_no_radiation():
    s = structure_of(footing("G=45e3 NU=0.3 B=1 L=1"))
    assert not s.damping.any() and not s.mass.any() and len(s.dofs.free) == 3


def test_period_of_a_building_on_soil():
    """T^2 = T0^2 (1 + k/kx + k h^2/kr) (Veletsos and Meek 1974, massless footing)."""
    k, h, b = 2e4, 6.0, 1.5
    kx, _, kr = stiffness(45e3, 0.3, b, b)
    r = run_text(f"""
NODES
 1 0 0
 2 0 {h}
ELEMENTS
 5 F 1
 6 C 1 2
PROPS
 F FOUNDATION {SOIL} B={b} L={b}
 C FRAME E={k * h**3 / 3!r} A=1e3 I=1
WEIGHTS
 2 981 0 0
ANALYSIS
 MODAL 1
""")
    assert r.status == "done"
    period = 2 * math.pi * math.sqrt(100 / k * (1 + k / kx + k * h**2 / kr))
    assert r.tables["modes"]["period"][0] == pytest.approx(period, rel=1e-9)


@pytest.mark.parametrize("shape", [(1.0, 1.0), (1.0, 6.0), (4.0, 1.0)])
def test_uplift_starts_from_the_same_stiffness(shape):
    b, across = shape
    items = f"{SOIL} B={b} L={across}"
    a, u = (structure_of(footing(items + more)) for more in ("", " UPLIFT=YES"))
    for s in (a, u):
        k = np.diag(stiffness(45e3, 0.3, b, across))
        assert at_node(s, 1, s.initial_stiffness) == pytest.approx(k, rel=1e-11, abs=1e-9 * k.max())
    full = solved(footing(items + " UPLIFT=YES", loads="LOADS\n 1 20 -500 30"))
    assert full.u[1] == pytest.approx(solved(footing(items, loads="LOADS\n 1 20 -500 30")).u[1], rel=1e-10)
    assert full.force[5, "force Y"] == pytest.approx(-500)


@pytest.mark.parametrize(("strength", "share"), [("", 1.0), (" QU=2000", 1 - 500 / 2000)])
def test_uplift_ends_at_the_overturning_moment(strength, share):
    """M = P B (1 - P/Q): about the corner, or about the middle of what is pressed to its strength."""
    b, p = 1.5, 500.0
    deck = footing(f"{SOIL} B={b} L=1 UPLIFT=YES COUNT=40" + strength, loads="LOADS\n 1 0 {} {}")
    most = p * b * share
    solved(deck.format(-p, 0.99 * most))
    with pytest.raises(static.InstabilityError):
        solved(deck.format(-p, 1.015 * most))


@pytest.mark.full
def test_a_rocking_pier_in_time():
    """A pier on a footing that lifts off, with radiation: EXACT balances the energy."""
    r = run_text(f"""
NODES
 1 0 0
 2 0 7
ELEMENTS
 5 F 1
 6 C 1 2
PROPS
 F FOUNDATION {SOIL} B=1.2 L=1.2 UPLIFT=YES QU=9000 COUNT=6
 C FRAME E=3e7 A=1 I=0.08
WEIGHTS
 1 100 100 10
 2 900
LOADS
 1 0 -100
 2 0 -900
EQUAKE
 SINE DIRECTION=X AMPLITUDE=2.5 PERIOD=0.8
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 3 METHOD=EXACT
""")
    assert r.status == "done" and r.check() < 1e-9
    table = r.tables["spring_envelope"]
    assert list(table["component"]) == [f"spring {n}" for n in range(1, 7)]
    assert table["force_max"].max() == pytest.approx(0, abs=1e-9) and table["deformation_max"].max() > 1e-4


def test_footings_that_do_not_fit_together():
    for items, message in ((" QU=5", "needs UPLIFT=YES"), (" UPLIFT=YES", "less slender")):
        shape = "B=1 L=1" if "QU" in items else "B=100 L=1"
        with pytest.raises(AssemblyError, match=message):
            structure_of(footing(f"{SOIL} {shape}{items}"))
