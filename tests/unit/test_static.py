"""Static analysis from event to event: yielding, contacts with gaps and overlaps, mechanisms named."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from decks import solved, structure_of
from pound_solve.analyses import static
from pound_solve.analyses.equilibrium import SupportReactions
from pound_solve.analyses.tangent_solution import InstabilityError
from pound_solve.laws.automaton import REVERSAL_DOWN, REVERSAL_UP, BranchKind, Law, Rule, linear
from pound_solve.laws.contact.kelvin_voigt import PRESSED


def parallel(load: float, rules: str = "RULE=ELASTO_PLASTIC") -> str:
    """Three springs side by side on one node: k 100, 50 (yield 10, 20) and an elastic 25."""
    return f"""
NODES
 1 0 0 FIX=YR
ELEMENTS
 1 A 1
 2 B 1
 3 C 1
PROPS
 A SPRING KX=100 FX=10 {rules}
 B SPRING KX=50 FX=20,-30 {rules}
 C SPRING KX=25
LOADS
 1 {load!r}
"""


@pytest.mark.parametrize(
    ("load", "u", "forces", "events"),
    [
        (14.0, 0.08, (8, 4, 2), 0),  # k 175
        (17.5, 0.1, (10, 5, 2.5), 0),  # just at the yield point of A
        (40.0, 0.4, (10, 20, 10), 1),  # 17.5 at 0.1, then k 75: 22.5 / 75 = 0.3
        (45.0, 0.6, (10, 20, 15), 2),  # B at 0.4, then k 25
        (
            -62.0,
            -0.88,
            (-10, -30, -22),
            2,
        ),  # A at -0.1 (-17.5), k 75 to -0.6 (-55), k 25 for the last 7: -0.28
    ],
)
def test_parallel_springs_yield_one_after_the_other(load, u, forces, events):
    s = solved(parallel(load))
    assert s.u[1][0] == pytest.approx(u, rel=1e-12)
    assert [s.force[e, "force X"] for e in (1, 2, 3)] == pytest.approx(forces, rel=1e-12)
    # a spring that stands at its yield force exactly may have changed branch or not
    assert s.state.events in ((events, events + 1) if load in (17.5, 40.0) else (events,))
    assert s.reaction[1][0] == 0 and sum(forces) == pytest.approx(load)


def test_hardening_springs():
    """R = 0.1: A carries 10 k (d - 0.1) beyond its yield point: 10 + 5 + 2.5 at 0.1,
    then k = 10 + 50 + 25.
    """
    s = solved(parallel(17.5 + 85 * 0.2, "RULE=BILINEAR R=0.1"))
    assert s.u[1][0] == pytest.approx(0.3, rel=1e-12)
    assert s.force[1, "force X"] == pytest.approx(10 + 10 * 0.2, rel=1e-12)


def portal(load: float, hinge: float = 80.0) -> str:
    """Rigid-plastic hinges by stiff rotational springs at the feet and tops of two legs
    under a rigid beam.
    """
    return f"""
NODES
 1 0 0 FIX=XYR
 2 6 0 FIX=XYR
 3 0 0 SLAVED=XY MASTER=1
 4 6 0 SLAVED=XY MASTER=2
 5 0 4 FIX=Y
 6 6 4 FIX=Y SLAVED=X MASTER=5
 7 0 4 FIX=Y SLAVED=X MASTER=5
 8 6 4 FIX=Y SLAVED=X MASTER=5
ELEMENTS
 1 LEG 3 5
 2 LEG 4 6
 3 FOOT 1 3
 4 FOOT 2 4
 5 TOP 7 5
 6 TOP 8 6
 7 HOLD 7
 8 HOLD 8
 9 BRACE 5
PROPS
 LEG FRAME E=2e8 A=0.01 I=1e-4
 FOOT SPRING KR=1e9 MR={hinge} RULE=ELASTO_PLASTIC
 TOP SPRING KR=1e9 MR=100 RULE=ELASTO_PLASTIC
 HOLD SPRING KR=1e12
 BRACE SPRING KX=50
LOADS
 5 {load!r}
"""


def test_elasto_plastic_portal():
    """Sway mechanism against plastic theory: feet (80) hinge first, then tops (100); h = 4, EI = 2e4.

    Clamped legs carry 24 EI/h^3 u, end moments 6 EI/h^2 u = 7500 u (feet yield at 80/7500).
    Then a leg is pinned at its foot but for the moment 80: its top has 3 EI/h^2 du more
    (yield after 20/3750).  Then only the brace is left: F = 2 (80 + 100)/4 + 50 u.
    """
    ei, h = 2e4, 4.0
    u1 = 80 / (6 * ei / h**2)
    u2 = u1 + 20 / (3 * ei / h**2)
    f1 = (24 * ei / h**3 + 50) * u1
    f2 = f1 + (6 * ei / h**3 + 50) * (u2 - u1)
    assert f2 == pytest.approx(2 * 180 / h + 50 * u2, rel=1e-12)  # the figures agree with the mechanism's
    for f, u in ((0.7 * f1, 0.7 * u1), ((f1 + f2) / 2, (u1 + u2) / 2), (f2 + 10, u2 + 0.2)):
        s = solved(portal(f))
        assert s.u[5][0] == pytest.approx(
            u, rel=1e-4
        )  # hinges of 1e9 instead of rigid ones: 4 EI/h / 1e9 = 2e-5
    assert s.state.events == 4
    moments = [abs(s.force[e, "moment R"]) for e in (3, 4, 5, 6)]
    assert moments == pytest.approx([80, 80, 100, 100], rel=1e-9)
    # beyond the last hinge the exact rate of the brace alone
    assert solved(portal(f2 + 20)).u[5][0] - s.u[5][0] == pytest.approx(10 / 50, rel=1e-6)


def test_the_collapse_of_a_portal_without_brace_is_named():
    deck = portal(91.0).replace(" BRACE SPRING KX=50", " BRACE SPRING KX=0")
    with pytest.raises(InstabilityError, match=r"mechanism, worst at node \d ux"):
        solved(deck)
    assert solved(deck.replace("5 91.0", "5 89.9")).state.events >= 2


def contact(gap: float, load: float, law: str = "LINEAR K=300", more: str = "") -> str:
    """Two nodes on springs 100 and 200 with a contact between them;
    the load pushes the left one to the right.
    """
    return f"""
NODES
 1 0 0 FIX=YR
 2 1 0 FIX=YR
ELEMENTS
 1 A 1
 2 B 2
 9 C 1 2
PROPS
 A SPRING KX=100
 B SPRING KX=200
 C CONTACT GAP={gap!r} LAW={law}
LOADS
 1 {load!r}
{more}
"""


@pytest.mark.full
@settings(max_examples=100)
@given(gap=st.floats(-0.5, 0.5), load=st.floats(-50, 50))
@example(gap=-0.1, load=-50.0)  # an overlap that the load pulls open
@example(gap=-0.1, load=-5.0)  # and one that it does not
@example(gap=-0.1, load=50.0)
@example(gap=0.1, load=50.0)
def test_a_contact_with_any_gap(gap, load):
    """Closed: 100 u1 + f = F, 200 u2 = f, f = 300 (u1 - u2 - gap); open where that f is negative."""
    for law in ("LINEAR K=300", "KELVIN_VOIGT K=300 C=7", "KELVIN_VOIGT K=300 C=7 TENSION=YES"):
        s = solved(contact(gap, load, law))
        f = (load / 100 - gap) / (1 / 300 + 1 / 100 + 1 / 200)
        f = max(f, 0.0)
        assert [s.u[1][0], s.u[2][0]] == pytest.approx([(load - f) / 100, f / 200], rel=1e-11, abs=1e-13)
        assert s.force[9, "contact"] == pytest.approx(f, rel=1e-10, abs=1e-11)


@pytest.mark.parametrize(("gap", "events"), [(0.05, 1), (0.0, 1), (-0.05, 0)])
def test_events_of_a_closing_contact(gap, events):
    s = solved(contact(gap, 30.0))
    assert s.state.events == events and s.state.states[0][0] == PRESSED
    assert solved(contact(abs(gap), -30.0)).state.events == 0


def test_an_overlap_alone_pushes_apart():
    """Self-balanced: both springs feel the same force, 300 (0.1 - d) with d = f/100 + f/200."""
    s = solved(contact(-0.1, 0.0))
    f = 0.1 / (1 / 300 + 1 / 100 + 1 / 200)
    assert [s.u[1][0], s.u[2][0]] == pytest.approx([-f / 100, f / 200], rel=1e-12)


def test_a_contact_that_touches_only_for_a_while():
    """Yielding of the wall's spring opens no contact, but a second one closes behind:
    series of events by hand.

    u1 meets spring B at 0.1 (F = 10), both move with 100 + 200 k;
    at F = 10 + 300 (0.1) = 40 node 2 has moved 0.1 and spring B (yield 20) gives way: then 100 only,
    and a wall at gap 0.25 of node 2 stops it (k 1e3). Rigid contacts are approached with 1e9.
    """
    deck = contact(0.1, 70.0, "LINEAR K=1e9")
    deck = deck.replace("KX=200", "KX=200 FX=20 RULE=ELASTO_PLASTIC").replace(
        " 9 C 1 2", " 9 C 1 2\n 10 W 2"
    )
    deck = deck.replace("\nLOADS", "\n W CONTACT GAP=0.25 LAW=LINEAR K=1000\nLOADS")
    s = solved(deck)
    # F = 10 + 300*0.1 = 40 at yield; 100*0.15 more to the wall: 55; the last 15 on 100 + 1000
    assert s.u[1][0] == pytest.approx(0.35 + 15 / 1100, rel=1e-6)
    assert s.force[10, "contact"] == pytest.approx(1000 * 15 / 1100, rel=1e-6)
    assert s.state.events == 3


@settings(max_examples=30)
@given(angle=st.floats(-180, 180), load=st.floats(1, 30))
def test_an_oblique_contact_presses_along_its_normal(angle, load):
    """A node on an isotropic spring against a wall at any angle: u = (F - f n)/k, f the contact's force."""
    n = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    push = load * np.array([np.cos(np.radians(angle + 40)), np.sin(np.radians(angle + 40))])
    s = solved(f"""
NODES
 1 0 0 FIX=R
ELEMENTS
 1 A 1
 9 C 1
PROPS
 A SPRING KX=100 KY=100
 C CONTACT GAP=0.002 ANGLE={angle!r} LAW=LINEAR K=300
LOADS
 1 {push[0]:.17g} {push[1]:.17g}
""")
    f = (push @ n / 100 - 0.002) / (1 / 100 + 1 / 300)
    assert s.force[9, "contact"] == pytest.approx(f, rel=1e-11)
    assert s.u[1][:2] == pytest.approx((push - f * n) / 100, rel=1e-11, abs=1e-14)


LOOSE = """
NODES
 1 0 0 FIX=XYR
 2 0 3
 3 5 0
 4 6 0
ELEMENTS
 1 B 1 2
 2 S 3 4
PROPS
 B FRAME E=2e8 A=0.01 I=1e-4
 S SPRING KX=10
LOADS
"""


def test_unloaded_loose_parts_do_no_harm():
    """Two nodes that hang on each other only, free to travel and to turn: they stay, the rest is exact."""
    s = solved(LOOSE + " 2 1")
    assert s.u[2] == pytest.approx([27 / 3 / 2e4, 0, -9 / 2 / 2e4], rel=1e-12)
    assert not s.u[3].any() and not s.u[4].any()


def test_balanced_loads_on_a_loose_part_strain_it_only():
    s = solved(LOOSE + " 3 -1\n 4 1")
    assert s.u[4][0] - s.u[3][0] == pytest.approx(0.1, rel=1e-12)


@pytest.mark.parametrize(
    ("load", "words"),
    [
        (" 3 1", r"mechanism, worst at node (3|4) ux"),
        (" 4 0 1", "node 4 uy is loaded, but nothing holds it"),
        (" 3 0 0 1", "node 3 rz is loaded, but nothing holds it"),
    ],
)
def test_a_loaded_mechanism_is_named(load, words):
    with pytest.raises(InstabilityError, match=words):
        solved(LOOSE + load)


def test_a_turning_mechanism_is_named():
    """A beam on one pin falls: its far end moves most."""
    deck = (
        "NODES\n 1 0 0 FIX=XY\n 2 4 0\nELEMENTS\n 1 B 1 2\n"
        "PROPS\n B FRAME E=2e8 A=0.01 I=1e-4\nLOADS\n 2 0 -1"
    )
    with pytest.raises(InstabilityError, match="mechanism, worst at node 2 uy"):
        solved(deck)


def test_a_pinned_chain_is_a_mechanism():
    """Three hinged members in a row: the loaded inner node is named."""
    deck = """
NODES
 1 0 0 FIX=XY
 2 2 0
 3 4 0
 4 6 0 FIX=XY
ELEMENTS
 1 TO 3 B 1 TO 3 2 TO 4
PROPS
 B FRAME E=2e8 A=0.01 I=1e-4 PIN=BOTH
LOADS
 3 0 -1
"""
    with pytest.raises(InstabilityError, match="node 3 uy"):
        solved(deck)


@pytest.mark.full
def test_a_long_chain_is_told_from_a_mechanism():
    """Pivots tell: the cantilever of 300 members stands, the same on a pin falls, upright or inclined."""
    for x, y in ((0.1, 0.0), (0.06, 0.08)):
        deck = f"""
NODES
 1 0 0 FIX=XYR
 2 TO 301 {x!r} TO {300 * x!r} {y!r} TO {300 * y!r}
ELEMENTS
 1 TO 300 B 1 TO 300 2 TO 301
PROPS
 B FRAME E=2e8 A=0.01 I=1e-4
LOADS
 301 0 0 1
"""
        assert solved(deck).u[301][2] == pytest.approx(30 / 2e4, rel=1e-5)
        with pytest.raises(InstabilityError, match="mechanism"):
            solved(deck.replace("FIX=XYR", "FIX=XY"))


def test_softening_beyond_collapse_is_told():
    deck = parallel(60.0, "RULE=BILINEAR R=-0.5").replace("KX=25", "KX=20")
    with pytest.raises(InstabilityError, match="negative"):
        solved(deck)


TURNED_BACK = """
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
LOADS
 3 0 -20
"""


def test_a_closing_contact_turns_a_yielding_spring_back():
    """A rigid bar on two spots with a load between; it meets a wall,
    turns about it and unloads the yielded spring.

    Deflections v(x) = v0 + r x downwards.  At x = 0 stand an elasto-plastic spring (100, yield 2)
    and an elastic one (10), at x = 1 an elastic one (100); P stands at 0.8, the wall (1000) at 0.6.
    Up to P = 11: v0 = 0.2 P/110, v1 = 0.8 P/100, then v0' = 0.2/10;
    the gap of 0.0736 is shut at P = 12 with v0 = 0.04, v1 = 0.096.  Beyond, the bar goes up at x = 0:
    the spring there follows its elastic branch.
    """
    s = solved(TURNED_BACK)
    k = np.zeros((2, 2))
    for stiffness, x in ((110, 0.0), (100, 1.0), (1000, 0.6)):
        k += stiffness * np.outer([1, x], [1, x])
    v0, turn = np.array([0.04, 0.056]) + np.linalg.solve(k, 8 * np.array([1, 0.8]))
    assert v0 < 0.04
    assert [-s.u[1][1], -s.u[1][2]] == pytest.approx([v0, turn], rel=1e-11)
    assert s.force[1, "force Y"] == pytest.approx(-2 - 100 * (v0 - 0.04), rel=1e-11)
    assert s.force[4, "contact"] == pytest.approx(1000 * (v0 + 0.6 * turn - 0.0736), rel=1e-10)
    assert s.state.events == 3  # yield, wall, back


def test_nothing_loaded_is_nothing_moved():
    s = structure_of(contact(0.1, 0.0))
    state = static.solve(s)
    assert not state.u.any() and state.events == 0


# many springs at once


@settings(max_examples=60)
@given(
    strengths=st.lists(st.floats(0.5, 5), min_size=9, max_size=9),
    loads=st.lists(st.floats(-12, 12), min_size=4, max_size=4),
    hard=st.sampled_from([0.02, 0.3]),
)
@example(strengths=[1.0] * 9, loads=[6.0] * 4, hard=0.02)  # all at once
@example(strengths=[1.0, 2.0] * 4 + [1.0], loads=[-6.0, 6.0, -6.0, 6.0], hard=0.02)
def test_a_net_of_yielding_springs_is_in_equilibrium(strengths, loads, hard):
    """Four nodes, each joined to the ground and to all others: forces balance,
    and no law stands beyond an exit.
    """
    pairs = [(1, ""), (2, ""), (3, ""), (4, ""), (1, 2), (1, 3), (2, 3), (2, 4), (3, 4)]
    s = structure_of(
        "NODES\n" + "".join(f" {n} 0 0 FIX=YR\n" for n in range(1, 5))
        + "ELEMENTS\n" + "".join(f" {e} P{e} {i} {j}\n" for e, (i, j) in enumerate(pairs, 1))
        + "PROPS\n"
        + "".join(
            f" P{e} SPRING KX={100 + 20 * e} FX={f!r} RULE=BILINEAR R={hard}\n"
            for e, f in enumerate(strengths, 1)
        )
        + "LOADS\n" + "".join(f" {n} {f!r}\n" for n, f in enumerate(loads, 1))
    )  # fmt: skip
    state = static.solve(s)
    d = s.law_rows @ state.u
    force = [x.force(y, z, 0.0) for x, y, z in zip(s.laws, state.states, d)]
    assert s.law_rows.T @ force == pytest.approx(loads, abs=1e-10)
    for x, y, z in zip(s.laws, state.states, d):
        assert all(a * z + c <= 1e-10 for a, _, c in x.law.branch(y).events if a)


# curved laws


def saturating(p, at, m, d0, d, v):
    """f approaches +-F exponentially from where the motion turned: f' = k (1 -+ f / F)."""
    k, strength = p[:2]
    side = 1.0 if at == 0 else -1.0
    rest = (side * strength - m[0]) * math.exp(-side * k * (d - d0) / strength)
    return side * strength - rest, side * rest * k / strength, 0.0, 0.0


SATURATING = Rule(
    BranchKind.ELASTIC.named("loading", "unloading"),
    lambda p: (0, (0.0, 0.0)),
    lambda p, at, m: linear(p[0], 0.0, REVERSAL_DOWN if at == 0 else REVERSAL_UP),
    lambda p, at, m, way, d, v: (1 - at, (saturating(p, at, m, m[1], d, 0.0)[0], d)),
    curve=saturating,
    parameters=2,
    variables=2,
)


def curved(text: str, **laws: tuple[float, float]):
    """Structure of a deck with the SATURATING law (k, strength) in the springs of some property sets."""
    s = structure_of(text)
    own = {p.upper(): Law(SATURATING, numbers) for p, numbers in laws.items()}
    return replace(
        s, laws=tuple(replace(x, law=own.get(s.model.elements[x.element].prop, x.law)) for x in s.laws)
    )


def test_curved_springs_in_a_row_and_beside_each_other():
    """Two in a row carry the same: d_i = -F_i/k_i ln(1 - p/F_i); pulled or pushed."""
    deck = """
NODES
 1 0 0 FIX=YR
 2 0 0 FIX=YR
ELEMENTS
 1 A 1
 2 B 1 2
PROPS
 A SPRING KX=100 FX=1 RULE=BILINEAR
 B SPRING KX=50 FX=1 RULE=BILINEAR
LOADS
 2 {}
"""
    for p in (1.0, 7.9, -7.9):
        state = static.solve(curved(deck.format(p), A=(100, 10), B=(50, 8)))
        size = abs(p)
        one, two = (-f / k * math.log(1 - size / f) for f, k in ((10, 100), (8, 50)))
        assert state.u == pytest.approx(np.sign(p) * np.array([one, one + two]), rel=1e-9)
    with pytest.raises(InstabilityError, match=r"no equilibrium was found further on.*at load factor 0\.8"):
        static.solve(curved(deck.format(10.0), A=(100, 10), B=(50, 8)))


def test_a_closing_contact_turns_a_curved_spring_back():
    """The bar of above with a saturating spring at x = 0 (k 100, strength 2):
    forward until the wall is met, back after it.
    """
    from scipy.optimize import brentq, fsolve

    s = curved(TURNED_BACK, PLASTIC=(100, 2))
    state = static.solve(s)

    def forward(v):
        return 2 * (1 - math.exp(-50 * v))

    def at_wall(v0):  # load at which 0.4 v0 + 0.6 v1 is the gap
        v1 = (0.0736 - 0.4 * v0) / 0.6
        return forward(v0) + 10 * v0 - 0.2 * (100 * v1 / 0.8)

    v0 = brentq(at_wall, 0, 0.1, xtol=1e-15)
    peak = forward(v0)

    def rest(v):  # -2 + (2 + peak) exp(50 (v - v0)) going back; the bar's equilibrium under 20 at 0.8
        spring = -2 + (2 + peak) * math.exp(50 * (v[0] - v0))
        wall = 1000 * (0.4 * v[0] + 0.6 * v[1] - 0.0736)
        return spring + 10 * v[0] + 0.4 * wall - 4, 100 * v[1] + 0.6 * wall - 16

    a, b = fsolve(rest, (v0, 0.1), xtol=1e-12)
    assert a < v0
    assert [-state.u[0], -state.u[1]] == pytest.approx([a, b - a], rel=1e-9)
    assert state.events == 3  # onto the branch downwards, the wall, back


# equilibrium of all


def test_springs_without_length_are_told():
    """A storey spring between two heights carries a shear, but no moment: the sum names its couple."""
    s = structure_of("""
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
 3 0 6 FIX=YR
ELEMENTS
 1 A 1 2
 2 A 2 3
 3 B 3
PROPS
 A SPRING KX=100
 B SPRING KX=50
LOADS
 3 8
""")
    state = static.solve(s)
    rows = {r[0]: r[1:] for r in SupportReactions(s, state.axial).balance(state.u, state.states)}
    # 50 in a row, 50 beside it: 4 each
    assert rows["loads"] == pytest.approx((8, 0, -48))
    assert rows["reactions of the supports"] == pytest.approx((-4, 0, 0))
    assert rows["ground below springs and walls with one node"] == pytest.approx((-4, 0, 24))
    assert rows["couples that springs and contacts without length do not carry"] == pytest.approx(
        (0, 0, 24)
    )
    assert rows["sum"] == pytest.approx((0, 0, 0), abs=1e-12)


@settings(max_examples=20)
@given(
    seats=st.lists(st.floats(-3, 3), min_size=8, max_size=8),
    loads=st.lists(st.floats(-50, 50), min_size=6, max_size=6),
)
def test_loads_and_reactions_balance(seats, loads):
    """Members in any position, slaved nodes, self weight: three sums are zero, none by construction."""
    x = [4 * i + dx / 2 for i, dx in enumerate(seats[:4])]
    y = [3 * (i % 2) + dy / 3 for i, dy in enumerate(seats[4:])]
    s = structure_of(f"""
NODES
 1 {x[0]!r} {y[0]!r} FIX=XY
 2 {x[1]!r} {y[1]!r}
 3 {x[2]!r} {y[2]!r}
 4 {x[3]!r} {y[3]!r} FIX=XYR
 5 3 9 SLAVED=XYR MASTER=3
ELEMENTS
 1 TO 3 B 1 TO 3 2 TO 4
PROPS
 B FRAME E=2e8 A=0.01 I=1e-4 WGT=3 END1=0.2
LOADS
 2 {loads[0]!r} {loads[1]!r} {loads[2]!r}
 5 {loads[3]!r} {loads[4]!r}
MEMBER_LOADS
 2 WX={loads[5]!r}
""")
    state = static.solve(s)
    rows = SupportReactions(s, state.axial).balance(state.u, state.states)
    assert [r[0] for r in rows] == ["loads", "reactions of the supports", "sum"]
    scale = np.abs(np.array([r[1:] for r in rows[:2]])).max()
    assert np.abs(rows[2][1:]).max() < 1e-9 * scale
    assert rows[0][1] == pytest.approx(
        loads[0] + loads[3] + loads[5] * math.hypot(x[2] - x[1], y[2] - y[1]), abs=1e-9
    )


def test_a_frame_that_makes_forces_is_found_out():
    """The check can fail: a stiffness that is not balanced."""
    from pound_solve.analyses import equilibrium

    s = structure_of(LOOSE + " 2 1")
    state = static.solve(s)
    ground = SupportReactions(s, state.axial)
    assert np.abs(ground.balance(state.u, state.states)[-1][1:]).max() < 1e-12
    ground.structure.stiffness[ground.n :] *= 1.001
    assert ground.balance(state.u, state.states)[-1][1] == pytest.approx(-0.001, rel=1e-6)
    assert equilibrium.SUM_ROUNDING < 1e-6
