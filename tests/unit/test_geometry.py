"""P-Delta: geometric stiffness, axial forces that settle, buckling, what comes after gravity."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from decks import solved, structure_of
from pound_solve import run
from pound_solve.analyses import static
from pound_solve.analyses.equilibrium import SupportReactions
from pound_solve.analyses.tangent_solution import InstabilityError

E, A, INERTIA, L = 2e8, 0.01, 1e-4, 5.0
EI = E * INERTIA
EULER = math.pi**2 * EI / (4 * L**2)  # of the cantilever


def cantilever(form: str, members: int, press: float, push: float = 1.0, more: str = "", angle=90.0) -> str:
    """A cantilever of `members` at `angle` from x, pressed along its axis and pushed across at its tip."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return f"""
GEOMETRY {form}
NODES
 1 0 0 FIX=XYR
 2 TO {members + 1} {L * c / members!r} TO {L * c!r} {L * s / members!r} TO {L * s!r}
ELEMENTS
 1 TO {members} COL 1 TO {members} 2 TO {members + 1}
PROPS
 COL FRAME E={E} A={A} I={INERTIA}
LOADS
 {members + 1} {-press * c + push * s!r} {-press * s - push * c!r}
{more}
"""


def deflection(s, members: int, angle: float = 90.0) -> float:
    u = s.u[members + 1]
    return u[0] * math.sin(math.radians(angle)) - u[1] * math.cos(math.radians(angle))


# the matrix


def test_the_matrix_of_a_bent_member():
    """Przemieniecki 1968, chapter 15: N/(30 L) [[36, 3L, -36, 3L], [., 4L^2, -3L, -L^2], ...]."""
    for form, bent in (("PDELTA", False), ("PDELTA_MEMBER", True)):
        (g,) = structure_of(cantilever(form, 1, 1.0, angle=0.0)).geometric
        expected = np.zeros((6, 6))
        at = np.ix_([1, 2, 4, 5], [1, 2, 4, 5])
        expected[at] = (
            np.array(
                [
                    [36, 3 * L, -36, 3 * L],
                    [3 * L, 4 * L**2, -3 * L, -(L**2)],
                    [-36, -3 * L, 36, -3 * L],
                    [3 * L, -(L**2), -3 * L, 4 * L**2],
                ]
            )
            / (30 * L)
            if bent
            else np.array([[1, 0, -1, 0], [0] * 4, [-1, 0, 1, 0], [0] * 4]) / L
        )
        assert g.matrix == pytest.approx(expected, abs=1e-15)


@settings(max_examples=40)
@given(
    x=st.floats(-5, 5),
    y=st.floats(1, 5),
    blocks=st.tuples(st.floats(0, 0.4), st.floats(0, 0.4)),
    pin=st.sampled_from(["NONE", "I", "J", "BOTH"]),
    form=st.sampled_from(["PDELTA", "PDELTA_MEMBER"]),
)
def test_an_axial_force_feels_turns_but_no_shifts(x, y, blocks, pin, form):
    """A member of length l that turns by 1 as a whole shifts its force N by l: work N l; moved, none."""
    s = structure_of(f"""
GEOMETRY {form}
NODES
 1 0 0
 2 {x!r} {y!r}
ELEMENTS
 1 B 1 2
PROPS
 B FRAME E={E} A={A} I={INERTIA} G=8e7 AS=0.004 END1={blocks[0]!r} END2={blocks[1]!r} PIN={pin}
""")
    (g,) = s.geometric
    turn = np.array([0.0, 0.0, 1.0, -y, x, 1.0])
    if pin == "NONE":
        assert turn @ g.matrix @ turn == pytest.approx(math.hypot(x, y), rel=1e-12)
    assert g.matrix == pytest.approx(g.matrix.T, abs=1e-14)
    for shift in ([1, 0, 0, 1, 0, 0], [0, 1, 0, 0, 1, 0]):
        assert np.abs(g.matrix @ shift).max() < 1e-14
    assert np.linalg.eigvalsh(g.matrix)[0] > -1e-14


# statics


@pytest.mark.parametrize("angle", [90.0, 0.0, 37.0])
@pytest.mark.parametrize("share", [-0.5, 0.3, 0.9])
def test_one_member_with_its_string(share, angle):
    """delta = H / (3 EI/L^3 - P/L); moment at the foot H L + P delta."""
    press = share * 3 * EI / L**2
    s = solved(cantilever("PDELTA", 1, press, angle=angle))
    delta = 1.0 / (3 * EI / L**3 - press / L)
    assert deflection(s, 1, angle) == pytest.approx(delta, rel=1e-10)
    assert abs(s.force[1, "moment I"]) == pytest.approx(L + press * delta, rel=1e-10)


def exact_deflection(press: float) -> float:
    """H (tan kL - kL) / (P k) with k^2 = P/EI (Timoshenko and Gere 1961, section 1.4), here for H = 1."""
    k = math.sqrt(press / EI)
    return (math.tan(k * L) - k * L) / (press * k)


@pytest.mark.parametrize(("form", "order", "coarse"), [("PDELTA", 2, 0.2), ("PDELTA_MEMBER", 4, 0.02)])
def test_order_towards_the_beam_column(form, order, coarse):
    """Deflection and buckling load against the closed forms on meshes of 2, 4, 8 members."""
    press = 0.6 * EULER
    errors = []
    for members in (2, 4, 8):
        s = solved(cantilever(form, members, press))
        # the column shortens, which the closed form does not know of: nothing of first order
        errors.append(
            (
                abs(deflection(s, members) / exact_deflection(press) - 1),
                abs(s.state.buckling * press / EULER - 1),
            )
        )
    assert errors[0][0] < coarse and errors[0][1] < coarse
    for a, b in itertools.pairwise(errors):
        assert np.log2(np.array(a) / b) == pytest.approx(order, abs=0.15)


def test_the_table_of_the_manual():
    page = (Path(__file__).parents[2] / "manual" / "theory-static.md").read_text("utf-8")
    rows = page.split("<!-- table: cantilever -->")[1].split("<!-- end -->")[0].strip().splitlines()[2:]
    for row in rows:
        members, *errors = row.strip("| ").split(" | ")
        for form, error in zip(("PDELTA", "PDELTA_MEMBER"), errors):
            s = solved(cantilever(form, int(members), 0.1 * EULER))
            assert error == f"{100 * (0.1 * s.state.buckling - 1):.3g} %"


def test_end_forces_of_the_bent_member_balance():
    """Along the chord, with P-delta within the member: moments meet at the node,
    the foot carries H L + P delta, the tip nothing.
    """
    press = 0.5 * EULER
    s = solved(cantilever("PDELTA_MEMBER", 2, press))
    delta = deflection(s, 2)
    assert abs(s.force[1, "moment I"]) == pytest.approx(L + press * delta, rel=1e-9)
    assert s.force[1, "moment J"] == pytest.approx(-s.force[2, "moment I"], rel=1e-9)
    assert s.force[2, "moment J"] == pytest.approx(0.0, abs=1e-9)
    # across its chord a member carries what the axial force along it leaves of H
    chord = (s.u[3][0] - s.u[2][0]) / (L / 2)
    assert s.force[2, "shear I"] == pytest.approx(-s.force[2, "shear J"], rel=1e-9)
    assert abs(s.force[2, "shear I"]) == pytest.approx(abs(1.0 + press * chord), rel=1e-9)


def leaning(form: str = "PDELTA", weight: float = 100.0, spring: str = "KR=900") -> str:
    """A stiff column of 4 m on a rotational spring under a weight: K = k_r/h^2 - P/h."""
    return f"""
GEOMETRY {form}
NODES
 1 0 0 FIX=XYR
 2 0 0 SLAVED=XY MASTER=1
 3 0 4
ELEMENTS
 1 FOOT 1 2
 2 COL 2 3
PROPS
 FOOT SPRING {spring}
 COL FRAME E=2e8 A=1 I=1
WEIGHTS
 3 98.1
LOADS
 3 1 -{weight!r}
"""


def test_a_column_on_a_spring():
    """u = H h^2 / (k_r - P h), up to what the column of EI = 2e8 bends; it falls at P = k_r / h = 225."""
    for weight in (50.0, 200.0):
        s = solved(leaning(weight=weight))
        assert s.u[3][0] == pytest.approx(16 / (900 - 4 * weight), rel=1e-4)
        assert s.state.buckling == pytest.approx(225 / weight, rel=1e-4)
        # the foot feels H h + P u
        assert abs(s.force[1, "moment R"]) == pytest.approx(4 + weight * s.u[3][0], rel=1e-9)
    with pytest.raises(
        InstabilityError, match=r"buckles: its buckling load factor is 0\.9[0-9]+, which is below 1"
    ):
        solved(leaning(weight=230.0))


def test_tension_stiffens():
    s = solved(leaning(weight=-200.0))
    assert s.u[3][0] == pytest.approx(16 / (900 + 800), rel=1e-4)
    assert s.state.buckling == math.inf


def test_yielding_under_gravity_ends_in_collapse():
    """The foot yields at 20: H h + P u = 20 leaves nothing that holds P; the message says at which load."""
    deck = leaning(weight=100.0, spring="KR=900 MR=20 RULE=BILINEAR R=0.3").replace(" 3 1 -", " 3 3 -")
    # H h = 12, elastic u = 3*16/500: the foot would carry 21.6; hardening 270 < P h = 400
    with pytest.raises(InstabilityError, match=r"negative.*at load factor 0\.\d+"):
        solved(deck)


FRAME = """
GEOMETRY {form}
NODES
 1 0 0 FIX=XYR
 2 6 0 FIX=XYR
 3 0 4
 4 6 4
ELEMENTS
 1 TO 2 COL 1 TO 2 3 TO 4
 3 BEAM 3 4
PROPS
 COL FRAME E=2e8 A=0.01 I=8e-5
 BEAM FRAME E=2e8 A=0.01 I=1e-4 WGT=12
LOADS
 3,4 0 -{weight}
 3 {push}
"""


@pytest.mark.parametrize("form", ["PDELTA", "PDELTA_MEMBER"])
def test_the_axial_forces_are_those_of_the_state(form):
    """(K + K_G(N)) u = p with N of the same u, to the last digits; the reactions balance all loads."""
    s = structure_of(FRAME.format(form=form, weight=800, push=60))
    state = static.solve(s)
    assert state.rounds > 3
    assert s.axial(state.u) == pytest.approx(state.axial, abs=1e-9)
    k = s.stressed(s.axial(state.u)).stiffness
    assert k @ state.u == pytest.approx(s.loads, abs=1e-8)
    rows = SupportReactions(s, state.axial).balance(state.u, state.states)
    assert [r[0] for r in rows] == [
        "loads", "reactions of the supports", "axial forces on displaced members", "sum",
    ]  # fmt: skip
    assert rows[0][1:3] == (60.0, -1600.0 - 72.0) and rows[1][1] == pytest.approx(-60.0, rel=1e-10)
    # N on the sway: the couple of 1672 on some 0.07 m
    assert rows[2][3] == pytest.approx(-1672 * state.u[s.dofs.free.index((3, 0))], rel=0.01)
    assert np.abs(rows[3][1:]).max() < 1e-9 * 1672


def test_small_displacements_have_no_geometry():
    s = structure_of(FRAME.format(form="SMALL", weight=800, push=60))
    assert not s.geometric and s.stressed(np.zeros(0)) is s
    assert math.isnan(static.solve(s).buckling)


def test_a_long_mesh_finds_its_buckling_load():
    """200 members: beside its stiffest motion the softest has nine digits less, of sixteen."""
    s = solved(cantilever("PDELTA_MEMBER", 200, 0.5 * EULER))
    assert s.state.buckling == pytest.approx(2.0, rel=2e-6)


# what comes after gravity


def report(tmp_path, text):
    deck = tmp_path / "deck.inp"
    deck.write_text(text)
    return run(deck, out=tmp_path)


def test_frequency_after_gravity(tmp_path):
    """omega^2 = (k_r/h^2 - P/h) / m, falling to zero at the buckling load."""
    for weight in (50.0, 200.0, 220.0):
        results = report(tmp_path, leaning(weight=weight) + "ANALYSIS\n STATIC\n MODAL\n")
        assert results.status == "done"
        omega = results.table("modes")["omega"][0]
        assert omega**2 == pytest.approx((900 / 16 - weight / 4) / 10, rel=2e-3 if weight > 200 else 2e-4)
        run_ = dict(results.table("static_run").tolist())
        assert float(run_["buckling load factor"]) == pytest.approx(225 / weight, rel=1e-4)


def test_tangent_stiffness_after_gravity(tmp_path):
    """AFTER=STATIC: the yielded foot has 0.6 of its stiffness left."""
    spring = "KR=900 MR=1 RULE=BILINEAR R=0.6"
    deck = leaning(weight=50.0, spring=spring) + "ANALYSIS\n STATIC\n MODAL AFTER={}\n"
    for after, k in (("REST", 900.0), ("STATIC", 540.0)):
        results = report(tmp_path, deck.format(after))
        assert results.table("modes")["omega"][0] ** 2 == pytest.approx((k / 16 - 50 / 4) / 10, rel=2e-4)


def test_history_with_gravity(tmp_path):
    """A pull let go at t = 0: free vibration with the lengthened period; energy is kept."""
    deck = leaning(weight=150.0).replace("LOADS\n 3 1 -", "LOADS\n 3 2 HELD=NO\n 3 0 -")
    deck += "OUTPUT\n EVERY=0.01\nANALYSIS\n HISTORY T=3 METHOD=EXACT\n"
    results = report(tmp_path, deck)
    omega = math.sqrt((900 / 16 - 150 / 4) / 10)
    u = results.history("node/u")[:, 2, 0]
    assert u == pytest.approx(2 * 16 / 300 * np.cos(omega * results.time), abs=2e-5)
    energy = {row[0]: row[1] for row in results.table("energy").tolist()}
    assert abs(energy["residual"]) < 1e-10


def test_supports_moved_apart_feel_the_same(tmp_path):
    """The total form with one motion for all supports is the relative form,
    if the structure starts as fast as its supports.
    """
    deck = FRAME.format(form="PDELTA", weight=800, push=0) + "WEIGHTS\n 3,4 800\n"
    deck += "EQUAKE\n SINE AMPLITUDE=0.5 PERIOD=0.9{}\nOUTPUT\n EVERY=0.05\nDRIFT\n D 1 3\n{}"
    deck += "ANALYSIS\n HISTORY T=2 METHOD=EXACT\n"
    starts = f"INITIAL\n 3,4 VX={-0.5 * 0.9 / (2 * math.pi)!r}\n"
    drift = [
        report(tmp_path, deck.format(*more)).history("drift")[:, 0]
        for more in (("", ""), (" SUPPORTS=1,2", starts))
    ]
    assert np.abs(drift[0]).max() > 0.005
    assert drift[0] == pytest.approx(drift[1], abs=1e-11)
