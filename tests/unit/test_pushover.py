"""Pushover: ladders and capacity curves by hand, softening, contacts, patterns, ends."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from decks import hinged_frame, model_of
from pound_solve import run
from pound_solve.analyses import pushover, pushover_checks, static
from pound_solve.analyses.tangent_solution import InstabilityError
from pound_solve.catalog import catalog
from pound_solve.laws.automaton import BranchKind, Law, Rule, above, drive, linear
from pound_solve.structure.assembly import assemble

pytestmark = pytest.mark.full


def pushed(text: str, card: str, swap=lambda s: s) -> pushover.PushoverResult:
    """Pushover of a deck by a card."""
    s = swap(assemble(model_of(f"{text}\nANALYSIS\n STATIC\n PUSHOVER {card}\n")))
    state = static.solve(s)
    (own,) = (c for c in s.model.analyses if c.spec.name == "PUSHOVER")
    assert not pushover_checks.mistaken_cards(s)
    return pushover.push(s.stressed(state.axial), state, own)


def ladder(p: pushover.PushoverResult) -> list[tuple[float, float]]:
    """Displacements and base shears of the events."""
    return [(x.displacement, x.shear) for x, _ in p.ladder]


def at(p: pushover.PushoverResult, displacement: float) -> float:
    """Base shear at a displacement, interpolated on the curve."""
    d, v = zip(*((x.displacement, x.shear) for x in p.curve))
    return float(np.interp(displacement, d, v))


# one and two storeys

STOREYS = """
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
 3 0 6 FIX=YR
ELEMENTS
 1 A 1 2
 2 B 2 3
PROPS
 A SPRING KX=100 FX={fa} RULE=BILINEAR R={ra}
 B SPRING KX=80 FX={fb} RULE=BILINEAR R={rb}
WEIGHTS
 2 19.62
 3 9.81
"""


def test_two_storeys_by_hand():
    """Forces 1 and 2: shears 3 f and 2 f.

    Storey 2 (80, 3, R 0.1) yields at f = 1.5: u2 = 4.5/100, u3 = u2 + 3/80.
    Storey 1 (100, 5, R 0.2) at f = 5/3: u2 = 0.05, u3 = u2 + 3/80 + (1/3)/8.
    From there du3/df = 3/20 + 2/8.
    """
    p = pushed(
        STOREYS.format(fa=5, ra=0.2, fb=3, rb=0.1), "3 0.5 PATTERN=FORCES NODES=2,3 FORCES=1,2 STEPS=7"
    )
    u1, u2 = 0.045 + 3 / 80, 0.05 + 3 / 80 + 1 / 24
    assert ladder(p) == [pytest.approx((u1, 4.5), rel=1e-12), pytest.approx((u2, 5.0), rel=1e-12)]
    assert [(c.law, c.before, c.after) for _, c in p.ladder] == [
        (1, "elastic", "yielding +"),
        (0, "elastic", "yielding +"),
    ]
    last = p.curve[-1]
    assert last.displacement == pytest.approx(0.5, rel=1e-14)
    assert last.factor == pytest.approx(5 / 3 + (0.5 - u2) / 0.4, rel=1e-12)
    assert last.shear == pytest.approx(3 * last.factor, rel=1e-12)
    assert p.end == "the target displacement is reached" and p.unbalanced < 1e-14
    # the seven stations and the two events, in order
    found = [x.displacement for x in p.curve]
    assert found == pytest.approx(sorted([*(0.5 * k / 7 for k in range(8)), u1, u2]), rel=1e-12)
    assert [x.changes for x in p.curve] == [0, 0, 1, 2, 2, 2, 2, 2, 2, 2]


@pytest.mark.parametrize("target", [0.3, -0.3])
def test_a_perfectly_plastic_storey(target):
    """Elastic up to 5/100, then flat; to the left as to the right."""
    p = pushed(STOREYS.format(fa=5, ra=0, fb=9, rb=0), f"2 {target} PATTERN=UNIFORM STEPS=3")
    side = math.copysign(1.0, target)
    assert ladder(p) == [pytest.approx((0.05 * side, 5.0 * side), rel=1e-12)]
    assert p.curve[-1].shear == pytest.approx(5 * side, rel=1e-12)


def test_patterns():
    """Masses 2 and 1 at heights 3 and 6; first mode of k = 100, 80."""
    k = np.array([[180.0, -80.0], [-80.0, 80.0]])
    values, shapes = np.linalg.eig(np.diag([0.5, 1.0]) @ k)
    mode = shapes[:, np.argmin(values)]
    deck = STOREYS.format(fa=50, ra=0, fb=30, rb=0)
    for card, shape in (
        ("UNIFORM", [2, 1]),
        ("TRIANGULAR", [6, 6]),
        ("MODE", [2 * mode[0], mode[1]]),
        ("UNIFORM NODES=3", [0, 1]),
    ):
        p = pushed(deck, f"3 0.1 PATTERN={card}")
        assert p.first == pytest.approx(np.array(shape) / sum(shape), rel=1e-12)
        assert p.curve[-1].shear == pytest.approx(p.curve[-1].factor, rel=1e-12)
    p = pushed(deck + "LOADS\n 2 3\n 3 -1\n", "3 0.1 PATTERN=LOADS")
    assert p.first == pytest.approx([3, -1]) and p.curve[0].shear == pytest.approx(2, rel=1e-14)
    assert p.curve[-1].shear == pytest.approx(2 * (1 + p.curve[-1].factor), rel=1e-12)


def test_mass_on_a_slave_pushes_its_master():
    deck = STOREYS.format(fa=50, ra=0, fb=30, rb=0).replace(
        " 3 0 6 FIX=YR", " 3 0 6 FIX=YR\n 4 5 6 SLAVED=X MASTER=3"
    )
    p = pushed(deck + " 4 29.43\n", "3 0.1 PATTERN=UNIFORM")
    assert p.first[:2] == pytest.approx([2 / 6, 4 / 6])


# controls and ends


def test_by_force_and_by_displacement_are_one_path():
    deck = STOREYS.format(fa=5, ra=0.2, fb=3, rb=0.1)
    one = pushed(deck, "3 0.5 PATTERN=TRIANGULAR")
    two = pushed(deck, "3 0.5 PATTERN=TRIANGULAR CONTROL=FORCE")
    assert ladder(one) == [pytest.approx(x, rel=1e-12) for x in ladder(two)]
    assert two.curve[-1].displacement == pytest.approx(0.5, rel=1e-13)
    three = pushed(deck, f"3 CONTROL=FORCE FACTOR={one.curve[-1].factor!r} STEPS=5")
    assert three.curve[-1].displacement == pytest.approx(0.5, rel=1e-12)
    assert three.end == "the load factor is reached"
    assert [x.factor for x in three.curve if x.changes == 0] == pytest.approx(
        [one.curve[-1].factor * k / 5 for k in range(3)], rel=1e-12
    )  # 1.8 and 3.6 of 5.x are elastic still
    four = pushed(deck, "3 -0.5 PATTERN=TRIANGULAR CONTROL=FORCE")
    assert four.curve[-1].shear == pytest.approx(-one.curve[-1].shear, rel=1e-12)
    five = pushed(deck, "3 0.5 FACTOR=2.5")
    assert five.curve[-1].factor == pytest.approx(2.5, rel=1e-14)


def test_user_forces_backwards():
    """FORCES to the left and a target to the right: by force the factor falls."""
    p = pushed(
        STOREYS.format(fa=5, ra=0.2, fb=3, rb=0.1), "3 0.2 PATTERN=FORCES NODES=3 FORCES=-1 CONTROL=FORCE"
    )
    assert p.curve[-1].factor < 0 and p.curve[-1].displacement == pytest.approx(0.2)


def test_collapse_by_force_is_a_result():
    p = pushed(STOREYS.format(fa=5, ra=0, fb=9, rb=0), "3 CONTROL=FORCE FACTOR=100 PATTERN=UNIFORM")
    assert p.failed is None and "node 2 ux" in p.end and p.end.endswith("at load factor 5")
    assert p.curve[-1].shear == pytest.approx(5.0, rel=1e-13)


# frames


def portal(heights=4.0, span=8.0) -> str:
    """Clamped portal with places for five hinges of 100, stiff until they yield."""
    return f"""
NODES
 1 0 0 FIX=XYR
 2 {span} 0 FIX=XYR
 3 0 0 SLAVED=XY MASTER=1
 4 {span} 0 SLAVED=XY MASTER=2
 5 0 {heights}
 6 0 {heights} SLAVED=XY MASTER=5
 7 {span / 2} {heights}
 8 {span / 2} {heights} SLAVED=XY MASTER=7
 9 {span} {heights}
 10 {span} {heights} SLAVED=XY MASTER=9
ELEMENTS
 1 BAR 3 5
 2 BAR 6 7
 3 BAR 8 9
 4 BAR 4 10
 11 HINGE 1 3
 12 HINGE 5 6
 13 HINGE 7 8
 14 HINGE 10 9
 15 HINGE 2 4
PROPS
 BAR FRAME E=2e8 A=1 I=1e-4
 HINGE SPRING KR=1e9 MR=100 RULE=ELASTO_PLASTIC
"""


def test_plastic_collapse_of_a_portal():
    """Neal's portal, h = 4, l = 8, M = 100 everywhere, H = V = P: sway 4 M/h = 100, beam 8 M/l = 100,
    both together P (h + l/2) = 6 M, P = 75: hinges at both feet, under the load and at the lee corner.
    """
    deck = portal() + "LOADS\n 5 1\n 7 0 -1\n"
    p = pushed(deck, "5 2 PATTERN=LOADS CONTROL=FORCE FACTOR=1000")
    assert p.curve[-1].factor == pytest.approx(74.0, rel=1e-9)  # one is in the static state
    assert sorted(c.law for _, c in p.ladder) == [0, 2, 3, 4]
    assert "mechanism" in p.end and p.failed is None
    # by displacement the plateau is followed
    p = pushed(deck, "5 0.5 PATTERN=LOADS")
    assert p.curve[-1].shear == pytest.approx(75.0, rel=1e-9)


def test_sway_ladder_of_a_portal():
    """Rigid beam: clamped legs, end moments 6 EI/h^2 u; all four yield together at 100.

    An elastic-plastic foot of 80 by a weaker spring: feet first at 80/7500, then tops 20/3750 later,
    where the shear is 2 (80 + 100)/4 = 90.
    """
    deck = (
        portal().replace("I=1e-4", "I=1e-4").replace(" 2 BAR 6 7\n 3 BAR 8 9", " 2 STIFF 6 7\n 3 STIFF 8 9")
    )
    deck = deck.replace(" 11 HINGE 1 3", " 11 FOOT 1 3").replace(" 15 HINGE 2 4", " 15 FOOT 2 4")
    deck += " STIFF FRAME E=2e8 A=1 I=10\n FOOT SPRING KR=1e9 MR=80 RULE=ELASTO_PLASTIC\n"
    p = pushed(deck, "5 0.05 PATTERN=FORCES NODES=5,9 FORCES=1,1")
    u1, u2 = 80 / 7500, 80 / 7500 + 20 / 3750
    v1 = 2 * (80 + 80) / 4
    expected = [(u1, v1), (u1, v1), (u2, 90.0), (u2, 90.0)]
    assert [x[1] for x in ladder(p)] == pytest.approx([x[1] for x in expected], rel=2e-4)
    assert [x[0] for x in ladder(p)] == pytest.approx([x[0] for x in expected], rel=1e-3)
    assert [c.law for _, c in p.ladder] in ([0, 4, 1, 3], [4, 0, 1, 3], [0, 4, 3, 1], [4, 0, 3, 1])
    assert p.curve[-1].shear == pytest.approx(90.0, rel=1e-7)  # the beam's own strain


def test_p_delta_after_yield():
    """A stiff column of 4 m on a hinge of 120 under P = 20: V = (M - P u)/h falls after the hinge yields,
    to nothing at u = 6 and below it.
    """
    deck = """
GEOMETRY PDELTA
NODES
 1 0 0 FIX=XYR
 2 0 0 SLAVED=XY MASTER=1
 3 0 4
ELEMENTS
 1 FOOT 1 2
 2 COL 2 3
PROPS
 FOOT SPRING KR=2000 MR=120 RULE=ELASTO_PLASTIC
 COL FRAME E=2e8 A=1 I=0.1
LOADS
 3 0 -20
"""
    p = pushed(deck, "3 7 PATTERN=FORCES NODES=3 FORCES=1 STEPS=7")
    first = 120 / 2000 * 4
    assert ladder(p)[0] == pytest.approx((first, (120 - 20 * first) / 4), rel=1e-3)
    for x in p.curve[2:]:
        assert x.shear == pytest.approx((120 - 20 * x.displacement) / 4, rel=1e-9, abs=1e-9)
    assert p.curve[-1].shear == pytest.approx(-5.0, rel=1e-9)
    top = max(p.curve, key=lambda x: x.shear)
    by_force = pushed(deck, "3 PATTERN=FORCES NODES=3 FORCES=1 CONTROL=FORCE FACTOR=100")
    assert by_force.curve[-1].shear == pytest.approx(top.shear, rel=1e-10)
    assert "negative" in by_force.end


# softening

ROW = """
NODES
 1 0 0 FIX=YR
 2 0 0 FIX=YR
ELEMENTS
 1 A 1
 2 B 1 2
PROPS
 A SPRING KX=100 FX=10 RULE=BILINEAR R={r}
 B SPRING KX={k}
"""


@pytest.mark.parametrize("r", [0.1, -0.1, -0.5, -0.9])
def test_a_softening_spring_in_a_row(r):
    """10 at 0.1 + 10/k, then with the stiffness 1/(1/(100 r) + 1/k), down to minus ten."""
    k = 150.0
    p = pushed(ROW.format(r=r, k=k), "2 0.4 PATTERN=FORCES NODES=2 FORCES=1 STEPS=9")
    first, after = 0.1 + 10 / k, 1 / (1 / (100 * r) + 1 / k)
    assert ladder(p) == [pytest.approx((first, 10.0), rel=1e-12)]
    assert p.curve[-1].shear == pytest.approx(10 + after * (0.4 - first), rel=1e-12)
    assert p.failed is None


def test_snap_back_is_a_statement(tmp_path):
    """Softer than the drop is steep: the end can only go back, which a jump would do."""
    text = ROW.format(r=-0.9, k=50)
    p = pushed(text, "2 0.9 PATTERN=FORCES NODES=2 FORCES=1")
    assert p.failed is not None and p.failed.code == "A507"
    assert "no further equilibrium without a jump" in p.end and p.curve[-1].shear == pytest.approx(
        10, rel=1e-12
    )
    deck = tmp_path / "deck.inp"
    deck.write_text(text + "ANALYSIS\n PUSHOVER 2 0.9 PATTERN=FORCES NODES=2 FORCES=1\n")
    results = run(deck, out=tmp_path)
    assert results.status == "stopped" and results.message.startswith("A507 pushover: there is no further")
    assert len(results.table("capacity_curve")) > 10  # what was found is kept


def test_a_control_node_that_is_left_behind():
    """Storey 2 has become a mechanism: the forces on it cannot move the first floor on."""
    p = pushed(STOREYS.format(fa=50, ra=0, fb=3, rb=0), "2 0.5 PATTERN=FORCES NODES=3 FORCES=1")
    assert p.curve[-1].shear == pytest.approx(3.0, rel=1e-12)
    assert p.failed is not None and "no longer move the control displacement" in p.end


def bell(p, at, m, d0, d, v):
    """f = k d exp(-d / c): largest at d = c."""
    k, c = p[:2]
    e = math.exp(-d / c)
    return k * d * e, k * (1 - d / c) * e, 0.0, 0.0


BELL = Rule(
    BranchKind.ELASTIC.named("curved"),
    lambda p: (0, ()),
    lambda p, at, m: linear(p[0], 0.0),
    lambda *_: (0, ()),
    curve=bell,
    parameters=2,
    variables=0,
)  # fmt: skip


def test_a_curve_that_softens():
    """In a row with 150: f of the curve at every station, past its largest 100 c/e."""

    def swap(s):
        return replace(s, laws=tuple(replace(x, law=Law(BELL, (100, 0.2))) for x in s.laws))

    p = pushed(ROW.format(r=0, k=150), "2 0.9 PATTERN=FORCES NODES=2 FORCES=1 STEPS=30", swap)
    assert p.failed is None and len(p.curve) == 31
    for x in p.curve:
        d = x.displacement - x.shear / 150
        assert x.shear == pytest.approx(100 * d * math.exp(-d / 0.2), rel=1e-10, abs=1e-12)
    assert max(x.shear for x in p.curve) == pytest.approx(20 / math.e, rel=5e-3)
    by_force = pushed(
        ROW.format(r=0, k=150), "2 PATTERN=FORCES NODES=2 FORCES=1 CONTROL=FORCE FACTOR=99", swap
    )
    assert by_force.curve[-1].shear == pytest.approx(20 / math.e, rel=1e-6)
    assert by_force.failed is None and "no equilibrium was found further on" in by_force.end


BRITTLE = Rule(
    BranchKind.ELASTIC.named("whole", "broken"),
    lambda p: (0, ()),
    lambda p, at, m: linear(p[0], 0.0, above(p[1])) if at == 0 else linear(0.0, 0.0),
    lambda p, at, m, way, d, v: (1, m),
    parameters=2,
    variables=0,
)


def brittle(s):
    """Spring A (100) breaks at 0.1."""
    return replace(s, laws=tuple(replace(x, law=Law(BRITTLE, (100, 0.1))) for x in s.laws))


def test_what_breaks_hands_its_force_over():
    """Beside a spring of 50: 15 falls to 5 by displacement, and by force the other takes all 15, at 0.3."""
    deck = ROW.format(r=0, k=50).replace("2 B 1 2", "2 B 1").replace(" 2 0 0 FIX=YR\n", "")
    p = pushed(deck, "1 0.4 PATTERN=FORCES NODES=1 FORCES=1 STEPS=4", brittle)
    points = [(x.displacement, x.shear) for x in p.curve]
    assert points == [
        pytest.approx(x, rel=1e-12, abs=1e-13)
        for x in ((0, 0), (0.1, 15.0), (0.1, 5.0), (0.2, 10.0), (0.3, 15.0), (0.4, 20.0))
    ]
    assert p.unbalanced < 1e-15
    p = pushed(deck, "1 PATTERN=FORCES NODES=1 FORCES=1 CONTROL=FORCE FACTOR=30 STEPS=4", brittle)
    assert [(x.displacement, x.shear) for x in p.curve][-2:] == [
        pytest.approx(x, rel=1e-12) for x in ((0.45, 22.5), (0.6, 30.0))
    ]
    # in a row nothing is left to carry
    p = pushed(ROW.format(r=0, k=50), "2 0.5 PATTERN=FORCES NODES=2 FORCES=1 STEPS=5", brittle)
    assert ladder(p) == [pytest.approx((0.3, 10.0), rel=1e-12)]
    assert p.curve[-1].shear == pytest.approx(0.0, abs=1e-14) and p.failed is None


# several things at once


def test_springs_that_yield_together():
    """Eight equal springs side by side, and in a row: every one changes once, at one point."""
    n = 8
    side = "NODES\n 1 0 0 FIX=YR\nELEMENTS\n" + "".join(f" {e} A 1\n" for e in range(1, n + 1))
    side += "PROPS\n A SPRING KX=10 FX=1 RULE=BILINEAR R=0.1\n"
    p = pushed(side, "1 0.3 PATTERN=FORCES NODES=1 FORCES=1 STEPS=1")
    assert [x for x, _ in ladder(p)] == pytest.approx([0.1] * n, rel=1e-12)
    assert sorted(c.law for _, c in p.ladder) == list(range(n))
    assert p.curve[-1].shear == pytest.approx(n * 1.2, rel=1e-12)
    assert len(p.curve) == 3  # a point for all of them
    row = "NODES\n" + "".join(f" {i} 0 0 FIX=YR\n" for i in range(1, n + 1)) + "ELEMENTS\n 1 A 1\n"
    row += "".join(f" {i} A {i - 1} {i}\n" for i in range(2, n + 1))
    row += "PROPS\n A SPRING KX=10 FX=1 RULE=BILINEAR R=0.1\n"
    p = pushed(row, f"{n} 2 PATTERN=FORCES NODES={n} FORCES=1 STEPS=1")
    assert [x for x, _ in ladder(p)] == pytest.approx([0.8] * n, rel=1e-12)
    assert p.curve[-1].shear == pytest.approx(1 + 1.2 / n, rel=1e-11)


def test_a_spring_that_is_turned_back():
    """The bar on three spots of test_static, pushed on: the wall turns the yielded spring back."""
    deck = """
NODES
 1 0 0 FIX=X
 2 1 0 SLAVED=XYR MASTER=1
 3 0.8 0 SLAVED=XYR MASTER=1
 4 0.6 0 SLAVED=XYR MASTER=1
ELEMENTS
 1 PLASTIC 1
 2 WEAK 1
 3 STRONG 2
 4 WALL 4
PROPS
 PLASTIC SPRING KY=100 FY=2 RULE=ELASTO_PLASTIC
 WEAK SPRING KY=10
 STRONG SPRING KY=100
 WALL CONTACT GAP=0.0736 ANGLE=-90 LAW=LINEAR K=1000
"""
    p = pushed(deck, "3 -0.15 DIRECTION=Y PATTERN=FORCES NODES=3 FORCES=-1")
    assert [(c.law, c.after) for _, c in p.ladder[:3]] == [
        (0, "yielding -"),
        (1, "pressed"),
        (0, "elastic"),
    ]
    assert [x.factor for x, _ in p.ladder[:3]] == pytest.approx([11, 12, 12], rel=1e-12)
    assert [x.shear for x, _ in p.ladder[:3]] == pytest.approx([-11, -12, -12], rel=1e-12)


@pytest.mark.parametrize("geometry", ["SMALL", "PDELTA"])
def test_a_wall_rocks_over_its_corner(geometry):
    """Weight 100, foot 2 m, height 4 m, on 20 stiff springs without tension: they open one by one, with
    rounding all about zero, until V = 100 (1 - u) / 4 about the corner (without P-Delta 25).
    """
    p = pushed(
        f"""
GEOMETRY {geometry}
NODES
 1 0 0 FIX=XYR
 2 0 0 FIX=X
 3 0 4
ELEMENTS
 1 BED 1 2
 2 WALL 2 3
PROPS
 BED MULTISPRING KX=1e8 WIDTH=2 COUNT=20 TENSION=NO
 WALL FRAME E=2e8 A=1 I=10
LOADS
 3 0 -100
""",
        "3 0.6 PATTERN=FORCES NODES=3 FORCES=1 STEPS=6",
    )
    assert sorted(c.law for _, c in p.ladder) in (list(range(19)), list(range(1, 20)))  # a corner is left
    assert p.unbalanced < 1e-12 and p.failed is None
    for x in p.curve[-6:]:
        arm = 1.0 - (x.displacement if geometry == "PDELTA" else 0.0)
        assert x.shear == pytest.approx(25 * arm, rel=1e-5)


def test_two_buildings_meet():
    """Left (100) is pushed over its gap against right (200): base shears of each by BASE."""
    deck = """
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
 3 5 0 FIX=XYR
 4 5 3 FIX=YR
ELEMENTS
 1 A 1 2
 2 B 3 4
 3 C 2 4
PROPS
 A SPRING KX=100 FX=50 RULE=ELASTO_PLASTIC
 B SPRING KX=200 FX=4 RULE=BILINEAR R=0.1
 C CONTACT GAP=0.05 LAW=LINEAR K=600
WEIGHTS
 2 9.81
"""
    # in a row 600 and 200: 150; right yields at 4: closure 4/150
    u1, u2 = 0.05, 0.05 + 4 / 150
    whole = pushed(deck, "2 0.2 PATTERN=UNIFORM")
    assert ladder(whole) == [
        pytest.approx((u1, 5.0), rel=1e-12),
        pytest.approx((u2, 100 * u2 + 4), rel=1e-12),
    ]
    after = 1 / (1 / 600 + 1 / 20)
    right = 4 + after * (0.2 - u2)
    assert whole.curve[-1].shear == pytest.approx(20 + right, rel=1e-12)
    for node, shear in ((1, 20.0), (3, right)):
        assert pushed(deck, f"2 0.2 PATTERN=UNIFORM BASE={node}").curve[-1].shear == pytest.approx(
            shear, rel=1e-12
        )


# adaptive


def test_one_storey_needs_no_adapting():
    deck = STOREYS.format(fa=5, ra=0.1, fb=3, rb=0).replace(" 2 B 2 3\n", "")
    deck = deck.replace(" 3 0 6 FIX=YR\n", "").replace(" 3 9.81\n", "").replace(" B SPRING", " !B")
    one, two = (pushed(deck, f"2 0.3 PATTERN=MODE ADAPTIVE={x}") for x in ("NO", "YES"))
    assert one.curve == two.curve and one.ladder == two.ladder


def test_adapting_to_a_soft_storey():
    """Storey 1 yields (R 0.05): from there on the forces grow with the mode of 5, 80;
    those that stand, stay.
    """
    deck = STOREYS.format(fa=5, ra=0.05, fb=300, rb=0)

    def first_mode(k1: float):
        k = np.array([[k1 + 80.0, -80.0], [-80.0, 80.0]])
        values, shapes = np.linalg.eig(np.diag([0.5, 1.0]) @ k)
        f = np.array([2.0, 1.0]) * shapes[:, np.argmin(values)]
        return k, f / f.sum()

    fixed = pushed(deck, "3 0.6 PATTERN=MODE")
    p = pushed(deck, "3 0.6 PATTERN=MODE ADAPTIVE=YES STEPS=4")
    k, one = first_mode(100.0)
    assert p.first == pytest.approx(one, rel=1e-12) and ladder(p) == ladder(fixed)
    k5, two = first_mode(5.0)
    assert p.last == pytest.approx(two, rel=1e-10)
    u = np.linalg.solve(k, 5 * one)
    more = np.linalg.solve(k5, two)
    assert p.curve[-1].factor == pytest.approx(5 + (0.6 - u[1]) / more[1], rel=1e-11)
    assert abs(p.curve[-1].shear - fixed.curve[-1].shear) > 0.01


def test_the_last_mode_is_kept_in_a_mechanism():
    p = pushed(STOREYS.format(fa=5, ra=0, fb=300, rb=0), "3 0.6 PATTERN=MODE ADAPTIVE=YES")
    assert p.last == pytest.approx(p.first, rel=1e-14)
    assert p.curve[-1].shear == pytest.approx(5, rel=1e-12)
    softening = pushed(STOREYS.format(fa=5, ra=-0.05, fb=300, rb=0), "3 0.6 PATTERN=MODE ADAPTIVE=YES")
    assert softening.last == pytest.approx(p.first, rel=1e-14) and softening.failed is None


# laws of the family, and another program


RULES = [f"{x.name} {x.sample}" for x in catalog().family("hysteresis").values() if x.impl is not None]


@pytest.mark.parametrize("rule", [*RULES, "IMK_BILINEAR R=0.05 DP=3 DPC=8 RESIDUAL=0.2 DU=9.05"])
@pytest.mark.parametrize("target", [10.0, -10.0])
def test_one_spring_shows_its_backbone(rule, target):
    """The curve is the law's own, driven alone, softening and broken ends too."""
    deck = f"NODES\n 1 0 0 FIX=YR\nELEMENTS\n 1 A 1\nPROPS\n A SPRING KX=1 FX=1 RULE={rule}\n"
    p = pushed(deck, f"1 {target} PATTERN=FORCES NODES=1 FORCES=1 STEPS=25")
    assert p.failed is None and p.unbalanced < 1e-12, p.end
    (spring,) = assemble(model_of(deck)).laws
    law, events = spring.law, [x.displacement for x, _ in p.ladder]
    points = [(x.displacement, x.shear) for x in p.curve if x.displacement not in events]
    assert len(points) >= 20
    for d, shear in points:
        state = drive(law, law.start(), 0.0, d)
        assert shear == pytest.approx(law.force(state, d)[0], rel=1e-9, abs=1e-9)


def test_against_opensees():
    """Three storeys, two bays, bilinear hinges, P-Delta of a leaning column: OpenSees 3.7.1,
    benchmarks/opensees_pushover.py, whose rigid links of 1e11 leave 5e-7.
    """
    p = pushed(hinged_frame(), "301 0.8 PATTERN=FORCES NODES=101,201,301 FORCES=1/6,2/6,3/6 STEPS=16")
    assert len(p.ladder) == 28 and p.unbalanced < 1e-13
    for d, shear in (
        (0.05, 573.6057),
        (0.1, 1027.2765),
        (0.2, 1459.2296),
        (0.4, 2143.8631),
        (0.6, 2761.8245),
        (0.8, 3362.7046),
    ):
        assert at(p, d) == pytest.approx(shear, rel=7e-7)


# properties


@settings(max_examples=40)
@given(
    strengths=st.lists(st.floats(0.5, 5), min_size=6, max_size=6),
    hard=st.floats(-0.05, 0.4),
    target=st.sampled_from([-2.0, 0.7, 3.0]),
)
@example(strengths=[1.0] * 6, hard=0.0, target=3.0)
@example(strengths=[2.0, 2.0, 2.0, 1.0, 1.0, 0.5], hard=5e-324, target=0.7)  # no number, but a stiffness
def test_shear_is_what_pushes(strengths, hard, target):
    """Base shear by reactions = static loads + factor; nothing is out of balance; the way goes on."""
    n = len(strengths)
    deck = "NODES\n 1 0 0 FIX=XYR\n"
    deck += "".join(f" {i + 2} 0 {3 * (i + 1)} FIX=YR\n" for i in range(n))
    deck += "ELEMENTS\n" + "".join(f" {i + 1} S{i} {i + 1} {i + 2}\n" for i in range(n)) + "PROPS\n"
    deck += "".join(
        f" S{i} SPRING KX={100 - 9 * i} FX={f!r} RULE=BILINEAR R={hard!r}\n"
        for i, f in enumerate(strengths)
    )
    deck += f"WEIGHTS\n 2 TO {n + 1} 9.81\nLOADS\n {n + 1} 0.2\n"
    p = pushed(deck, f"{n + 1} {target}")
    assert p.unbalanced < 1e-11
    for x in p.curve:
        assert x.shear == pytest.approx(0.2 + x.factor, rel=1e-9, abs=1e-10)
    way = [abs(x.displacement - p.curve[0].displacement) for x in p.curve]
    assert way == sorted(way)
    if p.failed is None:
        assert p.curve[-1].displacement == pytest.approx(target, rel=1e-12)
        weakest = min(strengths)
        if hard <= 0:
            assert max(abs(x.shear) for x in p.curve) <= max(strengths) * (1 + 1e-9) and weakest > 0
    else:
        assert hard < 0  # only softening can snap back


# the run


def test_tables_and_report(tmp_path):
    deck = tmp_path / "deck.inp"
    deck.write_text(
        STOREYS.format(fa=5, ra=0.2, fb=3, rb=0.1)
        + "ANALYSIS\n STATIC\n PUSHOVER 3 0.5 PATTERN=FORCES NODES=2,3 FORCES=1,2 STEPS=5\n"
    )
    results = run(deck, out=tmp_path)
    assert results.status == "done"
    curve = results.table("capacity_curve")
    assert len(curve) == 8 and curve["events"].tolist()[-1] == 2
    events = results.table("push_events")
    assert events["element"].tolist() == [2, 1] and events["component"].tolist() == ["X", "X"]
    assert events["after"].tolist() == ["yielding +"] * 2
    pattern = results.table("push_pattern")
    assert [(r["node"], r["direction"], r["first"], r["last"]) for r in pattern] == [
        (2, "X", 1.0, 1.0),
        (3, "X", 2.0, 2.0),
    ]
    said = {row["item"]: row["value"] for row in results.table("pushover")}
    assert said["end"] == "the target displacement is reached"
    report = (tmp_path / "deck.rpt").read_text()
    heads = [
        "PATTERN OF THE PUSHING FORCES",
        "CAPACITY CURVE",
        "EVENTS OF THE PUSHOVER",
        "STATIC DISPLACEMENTS",
    ]
    assert [report.index(h) for h in heads] == sorted(report.index(h) for h in heads)


def test_a_target_that_is_reached_already():
    with pytest.raises(InstabilityError, match="stands at its target"):
        pushed(STOREYS.format(fa=5, ra=0, fb=3, rb=0), "3 0.0")
