"""BEAM_COLUMN: its springs make exactly the diagram that is given; elastic it is a FRAME."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from decks import solved, structure_of
from pound_solve.analyses import static
from pound_solve.numerics.types import Array
from pound_solve.structure.assembly import AssemblyError
from pound_solve.structure.elements.beam_column import capacity, springs
from verification.cases import run_text

SECTION = "E=2e8 A=0.0106 I=8.1e-5"  # about HE 220 B: Py = 2490 kN, Mp = 226 kN m of S235
EI, HEIGHT = 2e8 * 8.1e-5, 3.0
PY, MP = 2490.0, 226.0
STEEL = f"PY={PY} MP={MP}"
# points of a reinforced concrete section of 0.4 x 0.4, tension to compression
RC = [(900, 0), (0, 160), (-1200, 300), (-3000, 190), (-3900, 0)]


def column(strength: str, n: float = 0.0, h: float = 0.0, more: str = "LP=0.3", tip: str = "") -> str:
    return f"""
NODES
 1 0 0 FIX=XYR
 2 0 {HEIGHT} {tip}
ELEMENTS
 7 C 1 2
PROPS
 C BEAM_COLUMN {SECTION} {strength} {more}
LOADS
 2 {h!r} {n!r}
"""


def nm(corners) -> str:
    return "NM=" + ",".join(f"{float(x)!r}" for corner in corners for x in corner)


def sum_of_segments(direction: Array, strength: Array, shift: Array) -> Array:
    """Corners of the diagram of springs, anticlockwise: walked around edge by edge."""
    g = strength[:, None] * direction
    g = np.where((g[:, :1] < 0) | ((g[:, :1] == 0) & (g[:, 1:] < 0)), -g, g)
    g = g[np.argsort(np.arctan2(g[:, 1], g[:, 0]))]
    at = (shift * strength) @ direction - g.sum(axis=0)
    out = []
    for step in np.vstack([g, -g]):
        out.append(at)
        at = at + 2 * step
    return np.array(out)


def strength_of(laws) -> Array:
    """Corners of what the springs at I can carry, by their laws and their rows on the inner DOFs."""
    own = [x for x in laws if x.component.startswith("hinge I")]
    direction = np.array([[dict(zip(x.dofs, x.row)).get((7, d), 0.0) for d in (5, 3)] for x in own])
    plus, minus = (np.array([x.law.p[i] for x in own]) for i in (1, 2))
    return sum_of_segments(direction, (plus - minus) / 2, (plus + minus) / (plus - minus))


def around(corners: Array) -> Array:
    """The same corners from the one at the left on, shape (n, 2)."""
    start = int(np.lexsort((corners[:, 1], corners[:, 0]))[0])
    return np.roll(corners, -start, axis=0)


@st.composite
def symmetric_diagrams(draw: st.DrawFn) -> Array:
    """Sums of 2 to 6 segments (N in kN, M in kN m), shifted, the origin well inside."""
    count = draw(st.integers(2, 6))
    angles = sorted(draw(st.lists(st.integers(1, 34), min_size=count, max_size=count, unique=True)))
    sizes = draw(st.lists(st.floats(0.2, 1.0), min_size=count, max_size=count))
    g = np.array(
        [
            [1000 * s * math.cos(5 * a / 57.3), 100 * s * math.sin(5 * a / 57.3)]
            for a, s in zip(angles, sizes)
        ]
    )
    assume(np.linalg.cond(g * [1, 10]) < 2)  # the hinge's own bend and stretch are not one and the same
    shift = np.array(draw(st.lists(st.floats(-0.4, 0.4), min_size=2, max_size=2)))
    whole = np.vstack([g, -g])
    at, out = -g.sum(axis=0), []
    for step in whole:
        out.append(at)
        at = at + 2 * step
    corners = np.array(out)
    # the shift stays within the smallest extent
    inner = min(np.abs(g @ [[-d[1]], [d[0]]]).sum() / np.hypot(*(d * [1, 10])) for d in g) / 100
    return corners + shift * inner * [10, 1]


# ---------------------------------------------------------------------- the springs


def test_springs_of_a_steel_section():
    """By hand: edges (-0.15, 1)-(0.15, 1) and (0.15, 1)-(1, 0) in units of Py and Mp."""
    made = springs(np.array([[1, 0], [0.15, 1], [-0.15, 1], [-1, 0], [-0.15, -1], [0.15, -1.0]]))
    order = np.argsort(made.direction[:, 1])
    assert made.direction[order] == pytest.approx(np.array([[1, -1 / 0.85], [1, 0], [1, 1 / 0.85]]))
    assert made.strength[order] == pytest.approx([0.425, 0.15, 0.425])
    assert made.shift == pytest.approx(0.0, abs=1e-15) and made.skew < 1e-14


@settings(max_examples=60)
@given(corners=symmetric_diagrams())
def test_every_symmetric_diagram_is_that_of_its_springs(corners):
    made = springs(corners)
    got = around(sum_of_segments(made.direction, made.strength, made.shift))
    assert got == pytest.approx(around(corners), rel=1e-9, abs=1e-7)
    assert around(capacity(made)) == pytest.approx(got, rel=1e-9, abs=1e-7)
    assert made.skew < 1e-12 and np.abs(made.shift).max() < 1


def test_an_edge_across_the_axial_force_is_a_spring_on_the_rotation():
    """A cap on compression, as codes have it: half the moment range of the edge."""
    made = springs(np.array([[-800, -50], [800, -50], [800, 50], [-800, 50.0]]))
    turning = made.direction[:, 0] == 0.0
    assert turning.sum() == 1
    (lever,) = made.direction[turning, 1]
    assert lever * made.strength[turning] == pytest.approx([50.0])
    assert made.strength[~turning] == pytest.approx([800.0])


def test_a_diagram_that_is_not_symmetric_keeps_its_width_in_every_direction():
    corners = np.array([*RC, *((n, -m) for n, m in RC[-2:0:-1])], float)[::-1]
    made = springs(corners)
    got = sum_of_segments(made.direction, made.strength, made.shift)
    for angle in np.linspace(0, np.pi, 37):
        along = [x / np.ptp(corners, axis=0) @ [math.cos(angle), math.sin(angle)] for x in (got, corners)]
        assert np.ptp(along[0]) == pytest.approx(np.ptp(along[1]), rel=1e-12)
    assert got.min(axis=0) == pytest.approx(corners.min(axis=0))  # so pure forces and moments too
    assert got.max(axis=0) == pytest.approx(corners.max(axis=0))
    assert made.skew == pytest.approx(skew_by_hand(corners, got), rel=1e-2)


def skew_by_hand(a: Array, b: Array) -> float:
    """Largest distance of a corner of either polygon from the other, in half widths."""
    half = np.ptp(a, axis=0) / 2

    def out(p: Array, polygon: Array) -> float:
        """Distance of a point from a convex polygon."""
        q = polygon / half
        if all(a * d - b * c >= -1e-9 for (a, b), (c, d) in zip(np.roll(q, -1, axis=0) - q, p - q)):
            return 0.0
        best = math.inf
        for s, e in zip(q, np.roll(q, -1, axis=0)):
            t = min(max(float((p - s) @ (e - s) / ((e - s) @ (e - s))), 0.0), 1.0)
            best = min(best, float(np.linalg.norm(p - s - t * (e - s))))
        return best

    return max([out(p / half, b) for p in a] + [out(p / half, a) for p in b])


# ---------------------------------------------------------------------- the member


@settings(max_examples=40)
@given(corners=symmetric_diagrams(), lp=st.floats(0.02, 0.1), ends=st.sampled_from(["I", "J", "BOTH"]))
def test_elastic_it_is_a_frame(corners, lp, ends):
    """Also where the diagram is lopsided and its springs couple stretch and bend."""
    common = "END1=0.2 G=8e7 AS=0.003 FJ=1e-6"
    a = structure_of(column("", more=common).replace("BEAM_COLUMN", "FRAME"))
    b = structure_of(column(nm(corners), more=f"{common} LP={lp!r} HINGES={ends} SKEW=1"))
    wanted, got = a.parts[7].initial(), b.parts[7].initial()
    assert np.abs(got.matrix - wanted.matrix).max() <= 1e-11 * np.abs(wanted.matrix).max()
    assert got.dofs == wanted.dofs
    assert {f[1] for f in b.parts[7].internal()} == {"I": {3, 5}, "J": {4, 6}, "BOTH": {3, 4, 5, 6}}[ends]


@pytest.mark.parametrize("angle", [0, 10, 35, 60, 80, 90, 100, 130, 160, 175, 200, 260, 300, 350])
@pytest.mark.parametrize("section", [STEEL, nm(RC) + " SKEW=0.2"], ids=["steel", "concrete"])
def test_the_strength_is_that_of_the_diagram(section, angle):
    """Axial force and moment grow along a ray until they meet the diagram: no sooner and no later."""
    corners = strength_of(structure_of(column(section)).laws)
    if section == STEEL:
        given = np.array([(-1, 0), (-0.15, -1), (0.15, -1), (1, 0), (0.15, 1), (-0.15, 1)]) * [PY, MP]
        assert around(corners) == pytest.approx(around(given), rel=1e-9, abs=1e-9)
    ray = np.array([2000 * math.cos(math.radians(angle)), 200 * math.sin(math.radians(angle))])
    edges = np.roll(corners, -1, axis=0) - corners
    normal = np.column_stack([edges[:, 1], -edges[:, 0]])
    with np.errstate(divide="ignore"):
        reach = np.where(normal @ ray > 0, (normal * corners).sum(axis=1) / (normal @ ray), np.inf).min()
    n, m = (0.9999 * reach * ray).tolist()
    held = solved(
        column(section, n, -m / HEIGHT)
    )  # pushed to the left the column sags (tension on its right)
    assert held.force[7, "moment I"] == pytest.approx(-m, rel=1e-9, abs=1e-6)
    assert held.force[7, "axial I"] == pytest.approx(n, rel=1e-9, abs=1e-6)
    n, m = (1.0001 * reach * ray).tolist()
    with pytest.raises(static.InstabilityError):
        solved(column(section, n, -m / HEIGHT))


def test_plastic_flow_is_normal_to_the_diagram():
    """On the edge from (-0.15 Py, Mp) to (-Py, 0) the section shortens by Mp / 0.85 Py for a unit of turn;
    on the flat edge it only turns.
    """
    for n, m, shorten in ((-0.6 * PY, 0.55 * MP, MP / (0.85 * PY)), (0.0, 1.1 * MP, 0.0)):
        a, b = (
            solved(column(STEEL, x * n, -x * m / HEIGHT, "LP=0.3 RULE=BILINEAR R=1e-7")) for x in (1.0, 1.2)
        )
        names = b.structure.dofs.free
        grown = (b.state.u - a.state.u)[[names.index((7, 3)), names.index((7, 5))]]
        assert grown[0] > 1.0 and -grown[1] / grown[0] == pytest.approx(shorten, rel=1e-4, abs=1e-4)


def test_moment_alone_yields_at_once_and_axial_force_comes_first():
    """At N = 0 both outer springs reach their strength together, at Mp; before that all is elastic."""
    for share, events in ((0.999, 0), (1.0001, 2)):
        deck = column(STEEL, 0.0, share * MP / HEIGHT, "LP=0.3 HINGES=I RULE=BILINEAR R=0.05")
        assert solved(deck).state.events == events


@pytest.mark.slow
def test_in_an_earthquake_the_section_stays_within_its_diagram():
    """A column under its weight, shaken: EXACT's energy balances and the end forces are on or inside."""
    r = run_text(f"""
NODES
 1 0 0 FIX=XYR
 2 0 {HEIGHT}
ELEMENTS
 7 C 1 2
PROPS
 C BEAM_COLUMN {SECTION} {STEEL} LP=0.3 HINGES=I RULE=BILINEAR R=0.01
WEIGHTS
 2 900
LOADS
 2 0 -900
EQUAKE
 SINE DIRECTION=X AMPLITUDE=2 PERIOD=0.9
 SINE DIRECTION=Y AMPLITUDE=2.5 PERIOD=0.11
OUTPUT
 EVERY=0.005
ANALYSIS
 HISTORY 3 METHOD=EXACT
""")
    assert r.status == "done" and r.check() < 1e-9
    table = r.tables["spring_envelope"]
    assert list(table["component"]) == ["hinge I 1", "hinge I 2", "hinge I 3"]
    assert set(table["unit"]) == {"kN"} and table["yield_events"].sum() > 10
    peak = {row["quantity"]: row for row in r.tables["member_envelope"]}
    assert peak["axial I"]["min"] < -1000
    # hardening of 1 % over the little that the springs yield
    assert 0.7 * MP < peak["moment I"]["max"] < 1.1 * MP


# ---------------------------------------------------------------------- the card


@pytest.mark.parametrize(
    ("items", "at", "message"),
    [
        ("LP=0.3", "", "NM, or as PY and MP"),
        (STEEL + " NM=1,0,0,1,-1,0 LP=0.3", "NM", "NM, or as PY and MP"),
        ("PY=100 LP=0.3", "PY", "needs MP"),
        ("NM=1,0,0,1,-1,0 MP=3 LP=0.3", "MP", "MP goes with PY"),
        ("NM=1,0,0,1,-1,0,2 LP=0.3", "NM", "pairs"),
        ("NM=1,0,0,1,-1,0,0,2 LP=0.3", "NM", "once around a convex"),
        ("NM=1,0,0.1,0.1,0,1,-1,0 LP=0.3", "NM", "once around a convex"),
        ("NM=1,0,2,0,3,0 LP=0.3", "NM", "no area"),
        ("NM=9,0,5,1,1,0 LP=0.3", "NM", "does not hold the unloaded section"),
        (nm(RC) + " LP=0.3 SKEW=0.05", "NM", r"is 5\.48 % of its half width away .* SKEW=0\.06 would"),
        (STEEL + " LP=0.3 RULE=ELASTIC", "RULE", "elastic beam-column is a FRAME"),
        (STEEL + " LP=0.3 PIN=BOTH", "", "no end is left"),
        (STEEL + " LP=3.1", "LP", "longer than the flexible length, 3"),
        (STEEL + " LP=0.9 RULE=BOUC_WEN N=2", "RULE", "curves: with it hinges have at most LP=0.45 here"),
        ("PY=-100,100 MP=3 LP=0.3", "PY", "a positive value, then a negative one"),
    ],
)
def test_cards_that_do_not_fit_together(items, at, message):
    deck = column(items, more="")
    with pytest.raises(AssemblyError, match=message) as caught:
        structure_of(deck)
    (found,) = caught.value.diagnostics
    line = next(x for x in deck.splitlines() if "BEAM_COLUMN" in x)
    if at:
        assert line[: found.span.column - 1].endswith(f"{at}=")


def test_a_bar_is_none():
    with pytest.raises(AssemblyError, match="needs I"):
        structure_of(column(STEEL).replace(" I=8.1e-5", ""))


def test_it_takes_member_loads():
    deck = column("", more="{}", tip="FIX=X") + "MEMBER_LOADS\n 7 WX=20"
    a = solved(deck.format(STEEL + " LP=0.3"))
    b = solved(deck.format("").replace("BEAM_COLUMN", "FRAME"))
    assert a.force[7, "moment I"] == pytest.approx(b.force[7, "moment I"], rel=1e-10)
