"""FRAME with hinges, joint flexibility and initial forces: equal to the elastic member before yield, and to
plastic theory after it.
"""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from decks import solved, structure_of
from pound_solve.analyses import static
from pound_solve.catalog import catalog
from pound_solve.structure.assembly import AssemblyError
from pound_solve.structure.elements.base import LawSpring
from tiers import at_night
from verification.cases import run_text

E, A, IZ, G, AS = 2.0e8, 0.011, 1.5e-4, 8.0e7, 0.004
EI = E * IZ
SECTION = f"E={E!r} A={A!r} I={IZ!r}"


def close(got, wanted, rel=1e-12):
    got, wanted = np.asarray(got), np.asarray(wanted)
    assert np.abs(got - wanted).max() <= rel * np.abs(wanted).max(), f"{got} instead of {wanted}"


def member(extra, length=4.0, angle=0.0, fix_j="", loads="", member_loads="", head=""):
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return f"""
{head}
NODES
 1 0 0 FIX=XYR
 2 {length * c!r} {length * s!r} {fix_j}
ELEMENTS
 7 M 1 2
PROPS
 M FRAME {SECTION} {extra}
{"LOADS" if loads else ""}
{loads}
{"MEMBER_LOADS" if member_loads else ""}
{member_loads}
"""


def hinges(structure) -> dict[str, LawSpring]:
    return {s.component: s for s in structure.laws}


# ---------------------------------------------------------------------- before yield


def test_elastic_members_have_nothing_of_hinges():
    s = structure_of(member("PIN=J"))
    assert not s.laws and len(s.dofs.free) == 3 and not s.parts[7].internal()


@pytest.mark.full
@settings(max_examples=40)
@given(
    angle=st.floats(-180, 180),
    ends=st.tuples(st.floats(0, 0.5), st.floats(0, 0.5)),
    lp=st.tuples(st.floats(0.01, 0.4), st.floats(0.01, 0.4)),
    fj=st.tuples(st.floats(0, 1e-4), st.floats(0, 1e-4)),
    shear=st.booleans(),
    which=st.sampled_from(["MI=1e9", "MJ=1e9", "MI=1e9 MJ=1e9"]),
)
def test_a_hinge_length_leaves_the_elastic_member_as_it_is(angle, ends, lp, fj, shear, which):
    common = f"END1={ends[0]!r} END2={ends[1]!r} FJ={fj[0]!r},{fj[1]!r} "
    common += f"G={G!r} AS={AS!r}" if shear else ""
    rule = f" RULE=BILINEAR LP={lp[0]!r},{lp[1]!r} {which}"
    elastic, hinged = (
        structure_of(member(common + x, 4.0, angle, head="MASS LUMPED")).parts[7] for x in ("", rule)
    )
    close(hinged.initial().matrix, elastic.initial().matrix)
    assert hinged.initial().dofs == elastic.initial().dofs
    loads = {"loads": " 2 9 -7 5", "member_loads": " 7 WX=3 WY=-4 PX=2 PY=-6 AT=0.3"}
    a, b = (solved(member(common + x, 4.0, angle, **loads)) for x in ("", rule))
    close(b.u[2], a.u[2], 1e-11)
    for quantity in ("axial I", "axial J", "shear I", "shear J", "moment I", "moment J"):
        assert b.force[7, quantity] == pytest.approx(a.force[7, quantity], rel=1e-10, abs=1e-9)
    close(b.reaction[1], a.reaction[1], 1e-10)


@settings(max_examples=20)
@given(k=st.tuples(st.floats(1e3, 1e7), st.floats(1e3, 1e7)), angle=st.floats(-180, 180))
def test_a_hinge_stiffness_is_a_flexible_joint_before_yield(k, angle):
    """KH adds the rotation M/KH: the same as the elastic joint flexibility FJ = 1/KH."""
    joints = f"FJ={1 / k[0]!r},{1 / k[1]!r} G={G!r} AS={AS!r}"
    yielding = f"KH={k[0]!r},{k[1]!r} MI=1e9 MJ=1e9 RULE=ELASTO_PLASTIC G={G!r} AS={AS!r}"
    a, b = (structure_of(member(x, 4.0, angle)).parts[7].initial().matrix for x in (joints, yielding))
    close(b, a)


def test_the_stiffness_that_damps_is_the_members_own():
    """Damping in proportion to the initial stiffness leaves the inner DOFs alone, and is in modes what
    the whole matrix would give.
    """
    s = structure_of(member("MI=100 MJ=100 LP=0.3 RULE=BILINEAR"))
    parts = s.parts[7]
    assert parts.internal() == ((7, 3), (7, 4)) and all(f[1] < 3 for f in parts.initial().dofs)
    k, n = s.initial_stiffness, [s.dofs.free.index((2, d)) for d in range(3)]
    rest = [i for i in range(len(k)) if i not in n]
    condensed = k[np.ix_(n, n)] - k[np.ix_(n, rest)] @ np.linalg.solve(
        k[np.ix_(rest, rest)], k[np.ix_(rest, n)]
    )
    close(parts.initial().matrix[3:, 3:], condensed)
    damping = "DAMPING\n RAYLEIGH BETA=0.01"
    a, b = (
        structure_of(member(x, head=damping)).damping for x in ("", "MI=100 MJ=100 LP=0.3 RULE=BILINEAR")
    )
    close(b[:3, :3], a)
    assert not b[3:].any() and not b[:, 3:].any()


@pytest.mark.parametrize(("geometry", "rel"), [("PDELTA", 1e-10), ("PDELTA_MEMBER", 1e-4)])
def test_axial_forces_act_on_hinged_members_as_on_elastic_ones(geometry, rel):
    """P-Delta of the chord does not know of hinges; the bow of the member is that between them."""

    def column(items: str) -> static.StaticState:
        return static.solve(
            structure_of(f"""
GEOMETRY {geometry}
NODES
 1 0 0 FIX=XYR
 2 0 4
 3 0 8
ELEMENTS
 1 M 1 2
 2 M 2 3
PROPS
 M FRAME {SECTION} {items}
LOADS
 3 10 -200
""")
        )

    a, b = column(""), column("MI=1e9 MJ=1e9 LP=0.3 RULE=BILINEAR")
    assert b.u[3] == pytest.approx(a.u[3], rel=rel) and a.u[3] > 0.06
    assert b.buckling == pytest.approx(a.buckling, rel=10 * rel)


def test_hinges_have_no_mass():
    for mass in ("LUMPED", "CONSISTENT"):
        deck = member("WGT=8 MI=100 MJ=100 LP=0.3 RULE=BILINEAR END1=0.3", head=f"MASS {mass}")
        a, b = structure_of(deck), structure_of(member("WGT=8 END1=0.3", head=f"MASS {mass}"))
        assert np.array_equal(a.mass[:3, :3], b.mass) and not a.mass[3:].any()


# ---------------------------------------------------------------------- joints and initial forces


def test_flexible_joints():
    """Slope deflection with the joint rotation M f: end moments of a uniform load, clamped at both ends,
    w L^2 / 12 / (1 + 2 f EI / L); the tip of a cantilever sinks by P L^2 f more.
    """
    n, f, w, p = 4.0, 2e-5, 10.0, 30.0
    s = solved(member(f"FJ={f}", n, fix_j="FIX=XYR", member_loads=f" 7 WY={-w}"))
    moment = w * n**2 / 12 / (1 + 2 * f * EI / n)
    close([s.force[7, "moment I"], s.force[7, "moment J"]], [moment, -moment])
    s = solved(member(f"FJ={f},0", n, loads=f" 2 0 {-p}"))
    close(s.u[2][1:], [-p * n**3 / (3 * EI) - p * n**2 * f, -p * n**2 / (2 * EI) - p * n * f])
    assert solved(member("FJ=0,1", n, loads=f" 2 0 {-p}")).u[2][1] == pytest.approx(
        -p * n**3 / (3 * EI), rel=1e-12
    )


def test_a_very_flexible_joint_is_a_pin():
    a, b = (
        solved(member(x, fix_j="FIX=XYR", member_loads=" 7 WY=-10 PY=-5 AT=0.2"))
        for x in ("PIN=J", "FJ=0,1e6")
    )
    for q in ("moment I", "shear I", "shear J"):
        assert b.force[7, q] == pytest.approx(a.force[7, q], rel=1e-9)


def test_an_initial_axial_force_shortens_what_is_free_and_pulls_what_is_held():
    s = solved(member("N0=50", 4.0, 30.0))
    close(np.linalg.norm(s.u[2][:2]), 50 * 4 / (E * A))
    assert s.u[2][0] < 0 and s.force[7, "axial I"] == pytest.approx(0, abs=1e-10)
    s = solved(member("N0=50", 4.0, 30.0, fix_j="FIX=XYR"))
    assert s.force[7, "axial J"] == pytest.approx(50) and s.force[7, "axial I"] == pytest.approx(50)


def test_initial_moments_are_the_fixed_end_moments_of_a_load_that_is_not_there():
    """Hogging w L^2/12 at both ends turns the next member as the uniform load itself does; a free end
    carries nothing.
    """

    def frame(prop, more=""):
        return solved(f"""
NODES
 1 0 0 FIX=XYR
 2 4 0 FIX=Y
 3 9 0 FIX=XYR
ELEMENTS
 1 {prop} 1 2
 2 B 2 3
PROPS
 A FRAME {SECTION} M0={-10 * 16 / 12!r}
 B FRAME {SECTION}
{more}
""")

    a, b = frame("A"), frame("B", "MEMBER_LOADS\n 1 WY=-10")
    assert a.u[2][2] == pytest.approx(b.u[2][2], rel=1e-12)
    for key in ((1, "moment I"), (1, "moment J"), (2, "moment I"), (2, "shear I")):
        assert a.force[key] == pytest.approx(b.force[key], rel=1e-12)
    s = solved(member("M0=-12,-20", 4.0))
    assert s.force[7, "moment I"] == pytest.approx(0, abs=1e-10)
    # a beam that would hog if it were held sags when it is let go
    close(s.u[2][1:], [(12 * 16 / 3 + 20 * 16 / 6) / EI, (12 + 20) / 2 * 4 / EI])


# ---------------------------------------------------------------------- after yield


@pytest.mark.parametrize("lp", [0.05, 0.4, 0.9])
def test_a_hardening_cantilever(lp):
    """Tip: P L^3/3EI, and beyond the yield moment (M - My)(1/r - 1) Lp/EI of rotation."""
    n, r, my = 4.0, 0.1, 100.0
    for p in (20.0, 24.9, 30.0, 60.0):
        s = solved(member(f"MI={my} LP={lp} RULE=BILINEAR R={r}", n, loads=f" 2 0 {p}"))
        turn = max(p * n - my, 0.0) * (1 / r - 1) * lp / EI
        close(s.u[2][1:], [p * n**3 / (3 * EI) + turn * n, p * n**2 / (2 * EI) + turn], 1e-11)
        assert s.force[7, "moment I"] == pytest.approx(-p * n) and s.state.events == (p > 25)
        assert s.force[7, "moment hinge I"] == pytest.approx(p * n)


def test_strengths_are_those_of_sagging_and_hogging():
    """A cantilever to the right of its support hogs under a downward load, one to the left does too."""
    for x, end in ((4, "I"), (-4, "J")):
        for p, yields in ((-14, 0), (-16, 1), (24, 0), (26, 1)):
            ends = "1 2" if end == "I" else "2 1"
            deck = f"""
NODES
 1 0 0 FIX=XYR
 2 {x} 0
ELEMENTS
 7 M {ends}
PROPS
 M FRAME {SECTION} M{end}=100,-60 LP=0.3 RULE=BILINEAR R=0.1
LOADS
 2 0 {p}
"""
            s = solved(deck)
            assert s.state.events == yields
            assert s.force[7, f"moment hinge {end}"] == pytest.approx(4.0 * p)


def test_rigid_blocks_put_the_hinge_at_their_face():
    n, b, my = 4.0, 0.6, 100.0
    flexible = n - b
    for share, events in ((0.999, 0), (1.001, 1)):
        p = share * my / flexible
        s = solved(member(f"END1={b} MI={my} KH=1e5 RULE=BILINEAR R=0.2", n, loads=f" 2 0 {p}"))
        assert s.state.events == events
    p = 2 * my / flexible
    s = solved(member(f"END1={b} MI={my} KH=1e5 RULE=BILINEAR R=0.2", n, loads=f" 2 0 {p}"))
    turn = my / 1e5 + my / (0.2 * 1e5)
    close(s.u[2][1], p * flexible**3 / (3 * EI) + turn * flexible, 1e-11)


def test_the_other_end_may_be_pinned():
    """Propped: clamped at I, pinned at J, a point load in the middle: 3PL/16 until the end yields,
    then a beam on two supports.
    """
    n, my = 6.0, 90.0
    first = 16 * my / (3 * n)
    deck = member(f"PIN=J MI={my} LP=1 RULE=ELASTO_PLASTIC", n, fix_j="FIX=XYR", member_loads=" 7 PY={p}")
    for p, events in ((0.99 * first, 0), (2 * first, 1)):
        s = solved(deck.format(p=-p))
        assert s.force[7, "moment I"] == pytest.approx(min(3 * p * n / 16, my))
        assert s.force[7, "moment J"] == 0 and s.state.events == events


def test_redistribution_in_a_fixed_beam_to_its_collapse():
    """Uniform load: ends yield at 12 M/L^2, the middle at 16 M/L^2; deflections w L^4/384EI, then
    5 dw L^4/384EI; beyond that a mechanism.
    """
    n, m = 8.0, 120.0
    w1, w2 = 12 * m / n**2, 16 * m / n**2
    deck = f"""
NODES
 1 0 0 FIX=XYR
 2 {n / 2} 0
 3 {n} 0 FIX=XYR
ELEMENTS
 1 LEFT 1 2
 2 RIGHT 2 3
PROPS
 LEFT FRAME {SECTION} MI={m} MJ={m} LP=0.3 RULE=ELASTO_PLASTIC
 RIGHT FRAME {SECTION} MJ={m} LP=0.3 RULE=ELASTO_PLASTIC
MEMBER_LOADS
 1,2 WY={{w}}
"""
    for w, sag, middle, events in (
        (0.99 * w1, 0.99 * w1 * n**4 / (384 * EI), 0.99 * m / 2, 0),
        (14 * m / n**2, (w1 + 5 * (14 - 12) * m / n**2) * n**4 / (384 * EI), 0.75 * m, 2),
        (0.999 * w2, (w1 + 5 * (0.999 * w2 - w1)) * n**4 / (384 * EI), 0.998 * m, 2),
    ):
        s = solved(deck.format(w=-w))
        close(s.u[2][1], -sag, 1e-10)
        assert s.force[1, "moment J"] == pytest.approx(middle, rel=1e-10) and s.state.events == events
        assert s.force[1, "moment hinge I"] == pytest.approx(-min(w / w1, 1) * m)
    with pytest.raises(static.InstabilityError, match="mechanism, worst at"):
        solved(deck.format(w=-1.001 * w2))


def portal(load: float, more: str = "", ratio: float = 0.75) -> str:
    """Portal h = 4, L = 6, clamped feet; columns yield at 100 at both ends, the beam does not."""
    return f"""
NODES
 1 0 0 FIX=XYR
 2 6 0 FIX=XYR
 3 0 4
 4 6 4
ELEMENTS
 1 C 1 3
 2 C 2 4
 3 B 3 4
PROPS
 C FRAME E={E!r} A=1e4 I={IZ!r} MI=100 MJ=100 LP=0.35 RULE=ELASTO_PLASTIC {more}
 B FRAME E={E!r} A=1e4 I={ratio * IZ!r}
LOADS
 3 {load / 2!r}
 4 {load / 2!r}
"""


def test_pushover_ladder_of_a_portal():
    """Elastic clamped portal, k = (Ib/L)/(Ic/h): feet (3k+1)/(6k+1) H h/4, tops 3k/(6k+1) H h/4,
    sway H h^3/12EI (3k+2)/(6k+1).  The feet yield, then the portal has pinned feet: tops H h/4 each,
    sway H h^3/12EI (2k+1)/k less that of ... until the tops yield at H = 4 M/h.
    """
    m, h, k = 100.0, 4.0, 0.75 * 4 / 6
    first = 4 * m * (6 * k + 1) / (2 * h * (3 * k + 1))
    last = 4 * m / h
    unit = h**3 / (12 * EI)
    u1 = first * unit * (3 * k + 2) / (6 * k + 1)
    u2 = u1 + (last - first) * unit * (2 * k + 1) / k
    for load, u, events in (
        (0.9 * first, 0.9 * u1, 0),
        ((first + last) / 2, (u1 + u2) / 2, 2),
        (0.9999 * last, u1 + (u2 - u1) * (0.9999 * last - first) / (last - first), 2),
    ):
        s = solved(portal(load))
        assert s.u[3][0] == pytest.approx(u, rel=1e-6)  # stiff in the axial direction, not rigid
        assert s.state.events == events
        feet = min(load / first, 1) * m
        assert abs(s.force[1, "moment hinge I"]) == pytest.approx(feet, rel=1e-6)
        assert s.force[1, "moment I"] + s.force[1, "moment J"] == pytest.approx(load / 2 * h, rel=1e-6)
    with pytest.raises(static.InstabilityError, match="mechanism"):
        solved(portal(1.001 * last))


@pytest.mark.full
def test_a_hinge_yields_back():
    """A cantilever that follows a spring of its own law: in every branch of a history the tip is a bilinear
    oscillator of k = 3EI/L^3, Fy = My/L and the slope of hinge and beam in series.
    """
    n, my, kh, r = 3.0, 60.0, 9000.0, 0.08
    flexible = n**3 / (3 * EI) + n**2 / kh
    slope = 1 / (n**3 / (3 * EI) + n**2 / (r * kh))
    rest = """
WEIGHTS
 2 200 0 0
EQUAKE
 SINE DIRECTION=X AMPLITUDE=4 PERIOD=0.5
OUTPUT
 EVERY=0.02
DRIFT
 "tip" 1 2
ANALYSIS
 HISTORY 4 METHOD=EXACT
"""
    beam = run_text(f"""
NODES
 1 0 0 FIX=XYR
 2 0 {n} FIX=Y
ELEMENTS
 1 M 1 2
PROPS
 M FRAME {SECTION} MI={my} KH={kh} RULE=BILINEAR R={r}
{rest}""")
    spring = run_text(f"""
NODES
 1 0 0 FIX=XYR
 2 0 {n} FIX=YR
ELEMENTS
 1 S 1 2
PROPS
 S SPRING KX={1 / flexible!r} FX={my / n!r} RULE=BILINEAR R={slope * flexible!r}
{rest}""")
    close(beam.u[:, 1, 0], spring.u[:, 1, 0], 1e-9)
    assert beam.tables["spring_envelope"]["yield_events"][0] > 5
    assert (
        beam.tables["spring_envelope"]["yield_events"] == spring.tables["spring_envelope"]["yield_events"]
    )
    row = beam.tables["spring_envelope"][0]
    assert (row["component"], row["unit"], row["deformation_unit"]) == ("hinge I", "kN*m", "rad")
    energy, other = (list(r.tables["energy"]["value"]) for r in (beam, spring))
    assert energy[4] > 1 and energy == pytest.approx(other, rel=1e-8, abs=1e-9)
    assert beam.check() < 1e-9


def test_against_opensees():
    """Two storeys, one bay, gravity and push growing together; benchmarks/opensees_hinged_frame.py with
    OpenSees 3.7.1 (elasticBeamColumn between zeroLength hinges of Steel01).
    """
    s = solved("""
PARAM E=2e8 h=3.5 span=6
NODES
 1 0 0 FIX=XYR
 2 span 0 FIX=XYR
 11 0 h
 12 span h
 21 0 2*h
 22 span 2*h
ELEMENTS
 1 C 1 11
 2 C 2 12
 3 C 11 21
 4 C 12 22
 5 B 11 12
 6 B 21 22
PROPS
 C FRAME E=E A=0.012 I=2.5e-4 RULE=BILINEAR R=0.03 MI=260 MJ=260 KH=60*E*2.5e-4/h
 B FRAME E=E A=0.009 I=1.8e-4 RULE=BILINEAR R=0.03 MI=170 MJ=170 KH=60*E*1.8e-4/span
LOADS
 11 75
 21 150
MEMBER_LOADS
 5,6 WY=-30
""")
    displacements = {
        11: (0.02762100052, -9.01044543447e-05, -0.00942261744169),
        12: (0.0275665277917, -0.000434895545655, -0.00886779059671),
        21: (0.0618931719693, -0.000143070346215, -0.00792464409478),
        22: (0.0615591709626, -0.000644429653785, -0.00605591336409),
    }
    moments = {
        1: (299.4792491, 80.12332918),
        2: (303.7362202, 104.1612015),
        3: (66.44016253, 107.8587804),
        4: (136.4766497, 214.2244073),
        5: (-146.5634917, -240.6378512),
        6: (-107.8587804, -214.2244073),
    }
    for node, u in displacements.items():
        assert s.u[node] == pytest.approx(u, rel=1e-10)
    for e, m in moments.items():
        assert (s.force[e, "moment I"], s.force[e, "moment J"]) == pytest.approx(m, rel=1e-9)
    assert s.state.events == 4


# ---------------------------------------------------------------------- long hinges

STEWART = "RULE=WAYNE_STEWART R=0.1 FU=150 FI=20 BETA=1.1 ALPHA=0.6 PUNL=2"


@settings(max_examples=25, deadline=None)
@given(
    lengths=st.tuples(st.floats(0.1, 4.0), st.floats(0.1, 4.0)),
    moments=st.tuples(st.floats(-400.0, 400.0), st.floats(-400.0, 400.0)),
    ratio=st.floats(0.01, 0.9),
)
def test_rotations_of_a_beam_whose_hinges_are_of_any_length(lengths, moments, ratio):
    """End moments on a simply supported beam: L/6EI (2 MI - MJ) and the like, sagging positive, and beyond
    My the curvature (1/r - 1)(M - My)/EI over the length of the hinge.
    """
    n, my = 4.0, 150.0
    text = f"""
NODES
 1 0 0 FIX=XY
 2 {n} 0 FIX=Y
ELEMENTS
 7 M 1 2
PROPS
 M FRAME {SECTION} MI={my} MJ={my} LP={lengths[0]!r},{lengths[1]!r} RULE=BILINEAR R={ratio!r}
LOADS
 1 0 0 {-moments[0]!r}
 2 0 0 {moments[1]!r}
"""
    s = solved(text)
    (mi, mj), over = moments, [math.copysign(max(abs(m) - my, 0.0), m) for m in moments]
    plastic = [(1.0 / ratio - 1.0) * lp * m / EI for lp, m in zip(lengths, over)]
    wanted = [-n / (6 * EI) * (2 * mi + mj) - plastic[0], n / (6 * EI) * (2 * mj + mi) + plastic[1]]
    scale = n / EI * 400.0 / ratio
    assert s.u[1][2] == pytest.approx(wanted[0], abs=1e-11 * scale)
    assert s.u[2][2] == pytest.approx(wanted[1], abs=1e-11 * scale)


@settings(max_examples=20, deadline=None)
@given(
    lp=st.tuples(st.floats(0.5, 3.0), st.floats(0.5, 3.0)),
    fj=st.tuples(st.floats(0, 1e-4), st.floats(0, 1e-4)),
    shear=st.booleans(),
    rule=st.sampled_from(["BILINEAR", "TAKEDA ALFA=0.4", "IMK_BILINEAR DP=0.02 DPC=0.1"]),
)
def test_a_long_hinge_leaves_the_elastic_member_as_it_is(lp, fj, shear, rule):
    common = f"FJ={fj[0]!r},{fj[1]!r} END1=0.2 " + (f"G={G!r} AS={AS!r}" if shear else "")
    hinged = f" RULE={rule} LP={lp[0]!r},{lp[1]!r} MI=1e4 MJ=1e4"
    a, b = (structure_of(member(common + x, 4.0, 20.0)).parts[7].initial().matrix for x in ("", hinged))
    close(b, a, 1e-11)


def test_the_ductility_of_a_long_hinge_is_that_of_its_curvature():
    """(M/My - 1)/r + 1, whatever part of the rotation the beam behind it has."""
    n, my, r = 4.0, 100.0, 0.1
    for lp in (0.5, 1.0, 2.0, 4.0):
        for share in (0.5, 1.7, -2.4):
            s = structure_of(
                member(f"MI={my} LP={lp} RULE=BILINEAR R={r}", n, loads=f" 2 0 {share * my / n}")
            )
            (hinge,), u = s.laws, static.solve(s).u
            deformation = float(s.law_rows[0] @ u)
            whole = hinge.whole(deformation, share * my)
            curvature = share if abs(share) < 1 else math.copysign((abs(share) - 1.0) / r + 1.0, share)
            assert whole * EI / (lp * my) == pytest.approx(curvature, rel=1e-10)
            assert hinge.strengths[0] / hinge.yields[0] == pytest.approx(EI / lp, rel=1e-14)


@pytest.mark.full
@pytest.mark.parametrize("method", ["TAYLOR", *at_night("LAGUERRE", "EXACT", "NEWMARK")])
def test_a_cantilever_with_a_long_hinge_is_a_bilinear_oscillator(method):
    """Its tip is k = 3EI/n^3 up to My/n, and beyond it the flexibility is more by (1/r - 1) Lp n^2/EI."""
    n, my, r, mass = 4.0, 100.0, 0.1, 10.0
    motion = f"""
WEIGHTS
 2 {mass * 9.81}
EQUAKE
 SINE DIRECTION=Y AMPLITUDE=4 PERIOD=0.6
OUTPUT
 EVERY=0.05
ANALYSIS
 HISTORY 3 METHOD={method} {"DT=0.002" if method == "NEWMARK" else ""}
END
"""
    for lp in (0.3, 2.0, 4.0):
        cantilever = member(f"MI={my} LP={lp} RULE=BILINEAR R={r}", n) + motion
        soft = n**3 / (3 * EI)
        ratio = soft / (soft + (1 / r - 1) * lp * n**2 / EI)
        oscillator = f"""
NODES
 1 0 0 FIX=XYR
 2 0 0 FIX=XR
ELEMENTS
 7 S 1 2
PROPS
 S SPRING KY={1 / soft!r} FY={my / n!r} RULE=BILINEAR R={ratio!r}
{motion}"""
        a, b = (run_text(text) for text in (cantilever, oscillator))
        ends = [
            {
                x["quantity"]: x
                for x in run.tables["node_envelope"]
                if x["node"] == 2 and x["direction"] == "Y"
            }
            for run in (a, b)
        ]
        assert a.tables["spring_envelope"]["yield_events"][0] > 5
        # an event that a step meets is located to a part of the step
        rel = 1e-5 if method == "NEWMARK" else 1e-9
        for quantity in ("displacement", "velocity"):
            for name in ("max", "min"):
                one, other = (x[quantity][name] for x in ends)
                assert one == pytest.approx(other, rel=rel), quantity


# ---------------------------------------------------------------------- the card


@pytest.mark.parametrize(
    ("items", "at", "message"),
    [
        ("MI=100", "MI", "RULE=ELASTIC"),
        ("MI=100 RULE=BILINEAR", "MI", "needs its stiffness KH or its length LP"),
        ("MI=100 RULE=BILINEAR KH=1e5 LP=0.3", "LP", "KH and LP both give .*: keep one"),
        ("RULE=BILINEAR", "RULE", "needs a yield moment"),
        ("LP=0.3", "LP", "no effect without a yield moment"),
        ("KH=1e5", "KH", "no effect without a yield moment"),
        (
            "MI=100 PIN=I LP=0.3 RULE=BILINEAR",
            "MI",
            "end I is pinned, where no hinge yields: leave out MI,",
        ),
        ("MI=100 MJ=9 PIN=I LP=0.3 RULE=BILINEAR", "MI", "no hinge yields: leave out MI$"),
        ("MI=1 MJ=1 PIN=BOTH KH=3 RULE=BILINEAR", "MI", "ends I and J .*: leave out MI, MJ, RULE, KH"),
        ("MI=1,1 MJ=1,1 LP=0.3 RULE=BILINEAR", "MI", "MI and MJ need a positive value, then a negative"),
        ("MJ=-100,100 LP=0.3 RULE=BILINEAR", "MJ", "a positive value, then a negative one"),
        ("MI=100 LP=4.1 RULE=BILINEAR", "LP", "4.1 is longer than the flexible length, 4$"),
        (
            "MI=100 MJ=100 LP=1,4.2 END1=0.3 RULE=BILINEAR",
            "LP",
            "4.2 is longer than the flexible length, 3.7",
        ),
        ("MI=100 LP=4.0000001 RULE=BILINEAR", "LP", "4.0000001 is longer than the flexible length, 4$"),
        ("MI=100 LP=1 RULE=RAMBERG_OSGOOD N=5", "RULE", "curves: with it hinges have at most LP=0.9 here"),
        (f"MI=100 LP=3.6 {STEWART}", "RULE", "too steeply: with it hinges have at most LP=0.9 here"),
    ],
)
def test_cards_that_do_not_fit_together(items, at, message):
    with pytest.raises(AssemblyError, match=message) as caught:
        structure_of(member(items))
    (found,) = caught.value.diagnostics
    line = " M FRAME " + SECTION + " " + items
    assert line[: found.span.column - 1].endswith(at + "=")


def test_a_hinge_may_be_as_long_as_a_member_whose_length_is_rounded():
    """4 less 0.3 and 3.4 is 0.30000000000000027 or 0.2999999999999998."""
    for ends in ("END1=0.3 END2=3.4", "END1=3.4 END2=0.3", "END1=3.7"):
        structure_of(member(f"MI=100 LP=0.3 {ends} RULE=BILINEAR"))


def test_the_longest_hinge_that_is_told_is_taken():
    items = "MI=100 LP={} RULE=RAMBERG_OSGOOD N=5 END1=0.1234567"
    with pytest.raises(AssemblyError, match="have at most LP=") as caught:
        structure_of(member(items.format(1)))
    most = re.search(r"LP=([\d.]+)", str(caught.value.diagnostics))[1]
    structure_of(member(items.format(most)))


def test_a_bar_has_no_hinge():
    deck = member("MI=100 LP=0.3 RULE=BILINEAR").replace(f"I={IZ!r}", "I=0")
    with pytest.raises(AssemblyError, match="bar without bending"):
        structure_of(deck)


def test_hinge_lengths_up_to_the_limit():
    """L/4 at one end, L/6 at both, L/3 before a pin: just below them the member is still that of EI."""
    for items in ("MI=1e9 LP=0.9999", "MI=1e9 MJ=1e9 LP=0.6666", "MI=1e9 PIN=J LP=1.333"):
        pin = "PIN=J" if "PIN" in items else ""
        a, b = (structure_of(member(x)).parts[7].initial().matrix for x in (pin, items + " RULE=BILINEAR"))
        close(b, a, 1e-9)


def test_no_rule_has_an_item_of_an_element():
    """A rule's items join the element's card: one name may not mean two things."""
    families = {}
    for family in ("hysteresis", "contact", "damper"):
        families[family] = {f.name for spec in catalog().family(family).values() for f in spec.fields}
    for element in catalog().family("element").values():
        for f in element.fields:
            if f.family:
                both = {g.name for g in element.fields} & families[f.family]
                assert not both, (element.name, both)
