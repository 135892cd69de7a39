"""TAYLOR with unknowns without mass, of order one and zero: closed forms, EXACT's answers, rates that jump,
joints that nothing holds.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from pound_solve.integrate.events.functions import EventFunctions
from pound_solve.integrate.events.protocol import LocatedEvent
from pound_solve.integrate.kernels.engine import KernelEngine
from pound_solve.laws.automaton import Branch, BranchKind, EventFunction, Law, drive
from pound_solve.laws.hysteresis import bilinear
from pound_solve.structure.dofs import label
from pound_solve.structure.reduction import ReducedSystem
from tiers import at_night, each_once
from unit.test_taylor import HINGE, LOADS, SHAKEN, agree, frames
from verification.cases import Ran, run_text

pytestmark = pytest.mark.full


# ---------------------------------------------------------------- closed forms

ZENER = """UNITS N m s
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
 3 2 0 FIX=YR
 4 3 0 FIX=XYR
ELEMENTS
 1 K 1 2
 2 SOFT 2 3
 3 DRAG 3 4
PROPS
 K SPRING KX=9
 SOFT SPRING KX=7
 DRAG DASHPOT CX={c}
WEIGHTS
 2 1
INITIAL
 2 UX=1 VX=0.5
OUTPUT
 EVERY=0.05
ANALYSIS
 HISTORY 10
"""


def of_first_order(a: np.ndarray, x: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Solution of ``x' = a x``, shape (n, n_times)."""
    values, vectors = np.linalg.eig(a)
    free = np.linalg.solve(vectors, x.astype(complex))
    return np.asarray((vectors @ (free[:, None] * np.exp(np.outer(values, t)))).real)


@pytest.mark.parametrize("c", [0.02, 1.5, 400.0])
def test_a_spring_in_series_with_a_dashpot(c: float) -> None:
    """The node between them has no mass: u'' = -9 u - 7 (u - z), c z' = 7 (u - z)."""
    r = run_text(ZENER.format(c=c), None, "TAYLOR")
    a = np.array([[0, 1, 0], [-16, 0, 7], [7 / c, 0, -7 / c]])
    exact = of_first_order(a, np.array([1.0, 0.5, 0.0]), r.time)
    assert np.abs(r.u[:, r.nodes.index(2), 0] - exact[0]).max() < 1e-11
    assert np.abs(r.u[:, r.nodes.index(3), 0] - exact[2]).max() < 1e-11
    rate = 7 / c * (exact[0] - exact[2])
    assert np.abs(r.v[:, r.nodes.index(3), 0] - rate).max() < 1e-11 * max(np.abs(rate).max(), 1.0)
    assert np.abs(r.a[:, r.nodes.index(3), 0] - 7 / c * (exact[1] - rate)).max() < 1e-9 / c
    assert r.check() < 1e-12


def test_springs_in_series() -> None:
    """The node between two springs is where they are in balance, and moves in proportion."""
    deck = ZENER.replace("DRAG DASHPOT CX={c}", "DRAG SPRING KX=3").replace("DRAG", "STIFF")
    r = run_text(deck, None, "TAYLOR")
    w = np.sqrt(9 + 2.1)
    u = np.cos(w * r.time) + 0.5 / w * np.sin(w * r.time)
    assert np.abs(r.u[:, r.nodes.index(2), 0] - u).max() < 1e-12
    for name, scale in (("u", 1.0), ("v", w), ("a", w * w)):
        two, three = (getattr(r, name)[:, r.nodes.index(n), 0] for n in (2, 3))
        assert np.abs(three - 0.7 * two).max() < 1e-12 * scale, name


# ---------------------------------------------------------------- frames

HELD = {
    "rotations without mass or dashpot": "RAYLEIGH ALPHA=0.4",
    "rotations that dashpots resist": "RAYLEIGH ALPHA=0.4 BETA=0.001",
    "hinges with dashpots of their own": "RAYLEIGH ALPHA=0.4 BETA=0.001 STIFFNESS=TANGENT",
    "a full matrix": "MODAL XI=0.05",
    "no damping": "",
}


def hinged(damping: str, turn: str = "0", head: str = "", load: str = SHAKEN) -> str:
    deck = frames(head=head, hinge=HINGE, turn=turn, load=load)
    section = f"DAMPING\n {damping}\n" if damping else ""
    return deck.replace("DAMPING\n RAYLEIGH ALPHA=0.4 BETA=0.001\n", section)


def yields(r: Ran) -> int:
    return int(r.column("spring_envelope", "yield_events").sum())


@each_once(("damping", HELD), ("turn", ["0", "0.5"]), at_most=2)
def test_hinges_of_a_frame(damping: str, turn: str) -> None:
    r, _ = agree(hinged(damping, turn))
    assert yields(r) > 10


def test_hinges_beside_a_mass_matrix_that_is_not_diagonal() -> None:
    """Loads on what has no mass must not become accelerations of it."""
    deck = hinged("RAYLEIGH ALPHA=0.4 BETA=0.001", head="MASS CONSISTENT")
    deck = deck.replace("I=0.0007", "I=0.0007 WGT=3").replace("I=0.0005", "I=0.0005 WGT=5")
    r, _ = agree(deck)
    assert yields(r) > 10


@pytest.mark.parametrize(
    "load",
    [
        "thrown",
        "let go",
        *at_night("supports apart", "one motion of the ground", "forces", "forces and supports"),
    ],
)
def test_what_moves_hinges(load: str) -> None:
    agree(hinged("RAYLEIGH ALPHA=0.4 BETA=0.001", load=LOADS[load]))


@pytest.mark.parametrize(
    "head", ["GEOMETRY PDELTA", *at_night("GEOMETRY PDELTA_MEMBER", "MASS CONSISTENT")]
)
def test_geometry_and_mass_beside_hinges(head: str) -> None:
    agree(hinged("RAYLEIGH ALPHA=0.4 BETA=0.001", head=head))


@pytest.mark.parametrize(
    "rule", ["TAKEDA R=0.02 ALFA=0.5 BETA=0", *at_night("CLOUGH R=0.05", "ORIGIN_CENTRED R=0.1")]
)
def test_rules_of_hinges(rule: str) -> None:
    deck = hinged("RAYLEIGH ALPHA=0.4")
    r, _ = agree(deck.replace("RULE=BILINEAR R=0.05", f"RULE={rule}"))
    assert yields(r) > 4


# ---------------------------------------------------------------- rates that jump

SERIES = """UNITS N m s
GRAVITY 1
PARAM every = 0.05
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
 3 2 0 FIX=XYR
 4 3 0 FIX=XYR
 5 4 0 FIX=YR
ELEMENTS
 1 A 1 2
 2 B 2 3
 3 C 2 4
 4 M 4 5
PROPS
 A SPRING KX=40 FX=0.2 RULE=BILINEAR R=0.1
 B SPRING KX=100 FX=30 RULE=BILINEAR R=0.01
 C SPRING KX=40 FX=90 RULE=BILINEAR R=0.2
 M SPRING KX=30
WEIGHTS
 5 1
EQUAKE
 TABLE POINTS=0,0.1,2,-0.3,4,0 SUPPORTS=1
 TABLE POINTS=0,6,0.3,6,0.31,0,1.5,-3,2.5,2,3.5,-2,4,0 SUPPORTS=3
 TABLE POINTS=0,-6,0.3,-6,0.31,2,0.43,2,0.435,90,0.46,90,0.47,0,1.5,3,2.5,-9,3.5,2,4,0 SUPPORTS=4
OUTPUT
 EVERY=every
ANALYSIS
 HISTORY 4
"""
SPRINGS = ((40.0, 0.2, 0.1), (100.0, 30.0, 0.01), (40.0, 90.0, 0.2))  #: k, yield force, share of k after it


def balanced(supports: np.ndarray, n: int = 10) -> np.ndarray:
    """Place of the node between three springs with kinematic hardening, at supports of shape (3, n_times):
    by return mapping in `n` increments between two times, with Newton's iterations to their balance.
    """
    k, fy, r = np.array(SPRINGS).T
    slip, z, out = np.zeros(3), 0.0, [0.0]
    for a, b in zip(supports.T[:-1], supports.T[1:]):
        for s in np.linspace(a, b, n + 1)[1:]:
            for _ in range(50):
                trial = (1 - r) * k * (z - s - slip)
                limit = (1 - r) * fy
                f = r * k * (z - s) + np.clip(trial, -limit, limit)
                tangent = k * np.where(np.abs(trial) > limit, r, 1.0)
                step = f.sum() / tangent.sum()
                z -= step
                if abs(step) < 1e-15:
                    break
            trial = (1 - r) * k * (z - s - slip)
            slip += np.where(np.abs(trial) > limit, trial - np.sign(trial) * limit, 0.0) / ((1 - r) * k)
        out.append(z)
    return np.array(out)


@pytest.mark.parametrize(
    ("method", "rounding"), [("TAYLOR", 1e-12), *at_night(("LAGUERRE", 1e-8), ("EXACT", 1e-12))]
)
def test_a_law_that_another_makes_turn_back(method: str, rounding: float) -> None:
    """Where spring B yields, its node runs away with it, and a spring that was yielding has to unload at
    once: its rate changes its sign without passing through zero.
    """
    fine = run_text(SERIES, {"every": 0.0005}, method)
    supports = np.array([fine.u[:, fine.nodes.index(n), 0] for n in (1, 3, 4)])
    want = balanced(supports, 4)
    for every, r in ((1, fine), (100, run_text(SERIES, None, method))):
        assert (r.status, r.message) == ("done", "")
        z = r.u[:, r.nodes.index(2), 0]
        assert np.abs(z - want[::every]).max() < 1e-5 * np.abs(want).max()
        assert r.check() < rounding
        assert yields(r) == 6


def test_an_event_function_above_zero_at_the_first_sample_is_overdue_if_it_depends_on_the_rate() -> None:
    """Law 0 would unload where its rate is negative, law 1 where its deformation is above 2."""
    unload, above = EventFunction(0.0, -1.0, 0.0), EventFunction(1.0, 0.0, -2.0)
    kind = BranchKind.YIELDING
    branches = [Branch("", kind, 1.0, 0.0, 0.0, (unload,)), Branch("", kind, 1.0, 0.0, 0.0, (above,))]
    functions = EventFunctions(branches, {})

    def found(rate: float, jumping: tuple[bool, bool]) -> LocatedEvent | None:
        first = np.array([[[0.0, 0.1]], [[3.0, 3.0]]])
        rates = np.array([[[rate, 1.0]], [[0.0, 0.0]]])
        samples = SimpleNamespace(t=np.array([[0.0, 1.0]]), value=first, rate=rates, second=0.0 * rates)
        return functions.violated(samples, np.ones((2, 2)), 1e-9, np.array(jumping))

    assert found(-0.01, (True, True)) == LocatedEvent(0, 0, 0.0)
    assert found(-0.01, (False, True)) is None
    assert found(-1e-10, (True, True)) is None
    assert found(0.01, (True, True)) is None


# ---------------------------------------------------------------- joints that nothing holds


def test_dashpots_between_two_joints_without_mass_are_told() -> None:
    deck = ZENER.format(c=2).replace(" 4 3 0 FIX=XYR", " 4 3 0 FIX=YR\n 5 4 0 FIX=XYR")
    deck = deck.replace(" 3 DRAG 3 4", " 3 DRAG 3 4\n 4 SOFT 4 5")
    r = run_text(deck, None, "TAYLOR")
    assert r.message.startswith("A501 at t = 0 s"), r.message
    told = (
        "node 3 ux and node 4 ux have no mass, and only dashpots to each other resist them: give one weight"
    )
    assert told in r.message, r.message


@pytest.mark.parametrize("method", ["TAYLOR", "LAGUERRE", "EXACT", "NEWMARK", "AUTO"])
def test_a_joint_that_snaps_through_is_named(method: str) -> None:
    """Two springs in series, of which one softens more steeply than the other is stiff."""
    steep = "STEEP SPRING KX=30 FX=2 RULE=BILINEAR R=-0.5"
    deck = ZENER.replace("UX=1 VX=0.5", "VX=3").replace("DRAG DASHPOT CX={c}", steep)
    dt = 0.001 if method == "NEWMARK" else None
    r = run_text(deck.replace("DRAG", "STEEP"), None, method, dt)
    assert r.message.startswith("A501 at t = "), r.message
    told = "node 3 ux has no mass, and its stiffness has become negative: it snaps through; give it weight"
    assert r.message.endswith(told)
    assert len(r.time) > 2


@pytest.mark.parametrize(("hardening", "snaps"), [(-0.5, True), (-0.2, False), (0.1, False)])
def test_only_a_stiffness_below_zero_snaps_through(hardening: float, snaps: bool) -> None:
    """A spring of 30 that softens beside one of 10; changes without end alone do not tell."""
    law = Law(bilinear.RULE, (30.0, 2.0, -2.0, hardening))
    yielding = drive(law, law.start(), 0.0, 0.2)
    for state in (yielding, law.transition(yielding, 0, 0.2)):
        stub = SimpleNamespace(
            system=SimpleNamespace(
                mass=np.zeros((1, 1)),
                stiffness=np.array([[10.0]]),
                law_rows=np.array([[1.0]]),
                structure=SimpleNamespace(corotational=()),
            ),
            laws=SimpleNamespace(
                tangent=SimpleNamespace(stiffness=np.array([law.branch(state).stiffness])),
                now=SimpleNamespace(deformation=np.array([0.2])),
            ),
            law_springs=[SimpleNamespace(law=law)],
            law_state=lambda i, state=state: state,
            latest=[[0, 0, 1, 5.0]],
            sim=SimpleNamespace(run=SimpleNamespace(time=5.0)),
        )
        assert KernelEngine._softens(stub) is snaps


@pytest.mark.parametrize("falls", [True, False])
def test_a_falling_branch_counts_where_the_law_has_been_on_it_at_this_instant(falls: bool) -> None:
    """Branch 2, two changes away from branch 0, falls; a law of three branches has met it or not."""
    stiffness, follows = (10.0, 10.0, -15.0), (1, 2, 0)
    law = SimpleNamespace(
        curved=False,
        branch=lambda state: SimpleNamespace(stiffness=stiffness[state[0]], events=[None]),
        transition=lambda state, n, d: (follows[state[0]],),
    )
    changes = [(0, 1), (1, 2), (2, 0)] if falls else [(0, 1), (1, 0)]
    stub = SimpleNamespace(
        system=SimpleNamespace(
            mass=np.zeros((1, 1)),
            stiffness=np.array([[10.0]]),
            law_rows=np.array([[1.0]]),
            structure=SimpleNamespace(corotational=()),
        ),
        laws=SimpleNamespace(
            tangent=SimpleNamespace(stiffness=np.array([10.0])),
            now=SimpleNamespace(deformation=np.array([0.2])),
        ),
        law_springs=[SimpleNamespace(law=law)],
        law_state=lambda i: (0,),
        latest=[[0, *change, 5.0] for change in changes],
        sim=SimpleNamespace(run=SimpleNamespace(time=5.0)),
    )
    assert KernelEngine._softens(stub) is falls


@pytest.mark.parametrize("method", ["TAYLOR", "NEWMARK"])
def test_a_joint_of_a_large_structure_that_snaps_through_is_named(method: str) -> None:
    """Its matrices are sparse."""
    steep = "STEEP SPRING KX=30 FX=2 RULE=BILINEAR R=-0.5"
    deck = (
        ZENER.replace("UX=1 VX=0.5", "VX=3").replace("DRAG DASHPOT CX={c}", steep).replace("DRAG", "STEEP")
    )
    others = range(101, 421)
    nodes = "".join(f" {n} {n} 9 FIX=YR\n" for n in others)
    chain = "".join(f" {n} K {n} {n + 1}\n" for n in others[:-1])
    deck = deck.replace("ELEMENTS\n", nodes + "ELEMENTS\n").replace(
        "PROPS\n", f" 100 K 101 4\n{chain}PROPS\n"
    )
    deck = deck.replace(" 2 1\nINITIAL", " 2 1\n 101 TO 420 1\nINITIAL").replace("HISTORY 10", "HISTORY 1")
    r = run_text(deck, None, method, 0.001 if method == "NEWMARK" else None)
    assert r.message.startswith("A501 at t = ") and "node 3 ux has no mass, and its" in r.message, r.message


def test_the_cure_is_that_of_what_snaps_through() -> None:
    dofs = (7, 0), (7, 2), (4, 4)
    stub = SimpleNamespace(dofs=dofs, name=lambda i: label(dofs[i]))
    told = [ReducedSystem.explain_massless(stub, i, softens=True).rpartition("; ")[2] for i in range(3)]
    assert told[0] == "give it weight" and told[1] == "give the joints WR in WEIGHTS"
    assert told[2] == "give element 4 a flatter softening branch, or a longer LP"
    assert "element 4 rotation inside J has no mass and nothing" in ReducedSystem.explain_massless(stub, 2)


def test_the_force_of_a_contact_that_meets_a_node_without_mass() -> None:
    """Its dashpot takes the node's speed away at touch: the force then is that of the spring behind it."""
    deck = """UNITS N m s
GRAVITY 1
NODES
 1 0 0 FIX=YR
 2 0.5 0 FIX=YR
ELEMENTS
 1 K 1 2
 2 STOP 2
PROPS
 K SPRING KX=1000
 STOP CONTACT GAP=0.1 ANGLE=0 LAW=KELVIN_VOIGT K=1E5 C=5000
WEIGHTS
 1 1
INITIAL
 1 VX=2
 2 VX=2
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 0.3 FROM=REST METHOD={method}
"""
    taylor, exact = (run_text(deck.format(method=m)) for m in ("TAYLOR", "EXACT"))
    one, other = (r.tables["collisions"]["peak_force"] for r in (taylor, exact))
    assert one == pytest.approx(other, rel=1e-9)
    assert one[0] < 100.0  # the dashpot alone would have 10 000 at the speed of touch


SLACK = """UNITS kN m s
GEOMETRY PDELTA
NODES
 1 0 0 FIX=XYR
 2 5.8 0 FIX=XYR
 3 0 4.058
 4 5.8 4.058
 5 0 7.653
 6 5.8 7.653
 11 5.8 0 FIX=XYR
 12 12 0 FIX=XYR
 13 5.8 4.058
 14 12 4.058
 15 5.8 7.653
 16 12 7.653
ELEMENTS
 1 HIT 4 13
 2 HIT 6 15
 3 COLUMN 1 3
 4 COLUMN 2 4
 5 BEAM 3 4
 6 COLUMN 3 5
 7 COLUMN 4 6
 8 BEAM 5 6
 13 HINGED 11 13
 14 HINGED 12 14
 15 SLACK 13 14
 16 HINGED 13 15
 17 HINGED 14 16
 18 SLACK 15 16
PROPS
 HIT CONTACT GAP=0 ANGLE=0 LAW=MAHMOUD_JANKOWSKI K=1.9653e5 E=0.41408
 COLUMN FRAME E=2.7E7 A=0.1749 I=0.001275
 BEAM FRAME E=2.7E7 A=0.1555 I=0.00174
 HINGED FRAME E=2.7E7 A=0.156 I=0.001014 LP=0.197 MI=151.3 MJ=151.3 RULE=BILINEAR R=0.074606
 SLACK FRAME E=2.7E7 A=0.1485 I=0.001516 LP=0.247 MI=207 MJ=207 RULE=BILINEAR_SLACK R=0.08 SLACK=0.0024
WEIGHTS
 3,4,5,6 47.151
 13,14,15,16 100.38
DAMPING
 MODAL XI=0.04
EQUAKE
 TABLE POINTS=0,0.3,1,2
OUTPUT
 EVERY=0.005
ANALYSIS
 STATIC GRAVITY=YES
 HISTORY 0.02 METHOD=TAYLOR
"""


def test_a_joint_moves_once_where_rounding_is_all_that_is_left_of_its_way() -> None:
    """Hinges that have hardly turned when a contact closes: the run did not end, as their rounding was a
    jump of their deformations ever again.
    """
    r = run_text(SLACK)
    assert r.status == "done" and r.check() < 1e-12, r.message
