"""Ductility, plastic path and damage index against paths worked by hand; envelopes between samples."""

from __future__ import annotations

import math

import numpy as np
import pytest

from decks import structure_of
from pound_deck.schema import Spec
from pound_solve.analyses import damage
from pound_solve.catalog import catalog
from pound_solve.laws.automaton import BranchKind, Law, State, drive
from pound_solve.laws.hysteresis import bilinear, bilinear_elastic, elasto_plastic, origin_centred
from pound_solve.laws.hysteresis.backbone import LOSS
from verification.cases import Ran, run_text

pytestmark = pytest.mark.full

K, FY = 100.0, 5.0
DY = FY / K
KEPT = {f.name: f.default for f in LOSS}  # no loss of strength
ORIGIN = {"R": 0.1, "ALFA": 0.0, **KEPT}


def driven(law: Law, *turns: float) -> tuple[State, float]:
    """State and energy lost after a path through these deformations."""
    state, at = law.start(), 0.0
    for d in turns:
        state, at = drive(law, state, at, d), d
    return state, law.dissipated(state, at)


def test_monotonic_push() -> None:
    law, last, beta, ultimate = elasto_plastic.build(KEPT, K, FY, -FY), 6 * DY, 0.1, 8.0
    _, loss = driven(law, last)
    assert loss == pytest.approx(FY * 5 * DY, rel=1e-14)
    found = damage.park_ang((last, 0.0), loss, (FY, -FY), (DY, -DY), (ultimate, ultimate), beta)
    assert found.ductility == pytest.approx(6.0, rel=1e-14)
    assert found.total == pytest.approx(6 / 8 + beta * loss / (FY * ultimate * DY), rel=1e-14)
    assert found.total == pytest.approx(0.75 + 0.1 * 5 / 8, rel=1e-14)


def test_what_lies_beyond_yield_is_plastic() -> None:
    assert damage.plastic((4.0, -7.0), (1.0, -2.0)) == 5.0  # 3 on the other side
    assert damage.plastic((0.5, -1.0), (1.0, -2.0)) == 0.0
    assert damage.plastic((-3.0, -5.0), (1.0, -2.0)) == 3.0  # it was on one side only
    assert damage.plastic((4.0, -1.0), (0.0, -2.0)) == 0.0  # no strength on the other side
    assert math.isnan(damage.plastic((4.0, -7.0), None))


def test_cycles() -> None:
    """To 4, -4 and 4 times yield: 3 + 6 + 6 yield deformations of plastic flow."""
    law = elasto_plastic.build(KEPT, K, FY, -FY)
    _, loss = driven(law, 4 * DY, -4 * DY, 4 * DY)
    assert damage.plastic_path(loss, (FY, -FY), (DY, -DY)) == pytest.approx((15 * DY, 15.0), rel=1e-13)
    found = damage.park_ang((4 * DY, -4 * DY), loss, (FY, -FY), (DY, -DY), (10.0, 10.0), 0.05)
    assert found.total == pytest.approx(0.4 + 0.05 * 15 / 10, rel=1e-13)


def test_sides_of_unequal_strength() -> None:
    """The weaker side (yield at 1 and 2, stiffness 1) has the larger energy term, and its own ultimate."""
    found = damage.park_ang((3.0, -4.0), 8.0, (1.0, -2.0), (1.0, -2.0), (6.0, 4.0), 0.1)
    assert found == pytest.approx((6.0, 3.0, 0.5, 0.1 * 8.0 / 6.0))
    other = damage.park_ang((3.0, -7.0), 8.0, (1.0, -2.0), (1.0, -2.0), (6.0, 4.0), 0.1)
    assert other == pytest.approx((4.0, 3.5, 0.875, 0.1 * 8.0 / (2.0 * 8.0)))
    # a closed cycle of plastic flow 5 and back loses 5 (1 + 2): the path is 10
    assert damage.plastic_path(15.0, (1.0, -2.0), (1.0, -2.0))[0] == pytest.approx(10.0)


def test_a_side_without_strength_is_left_out() -> None:
    found = damage.park_ang((2.0, -50.0), 1.0, (1.0, 0.0), (1.0, 0.0), (4.0, 4.0), 0.05)
    assert found.ductility == 2.0 and math.isfinite(found.total)
    assert damage.ductility((2.0, -50.0), (1.0, 0.0)) == 2.0
    assert math.isnan(damage.ductility((2.0, -1.0), None))


def test_a_spring_without_strength_has_no_path_though_its_slack_ends_somewhere() -> None:
    """FX=0 with a SLACK: it begins to slide where the slack ends, without a force."""
    slack = (0.02, -0.02)
    assert all(map(math.isnan, damage.plastic_path(1.0, (0.0, 0.0), slack)))
    assert math.isnan(damage.park_ang((0.1, -0.1), 1.0, (0.0, 0.0), slack, (4.0, 4.0), 0.05).total)


def test_whole() -> None:
    assert damage.overall([0.2, 0.8], [3.0, 1.0]) == pytest.approx(0.35)
    assert math.isnan(damage.overall([0.1, 0.2], [0.0, 0.0]))


@pytest.mark.parametrize(
    "law, turns, left",
    [
        (elasto_plastic.build(KEPT, K, FY, -FY), (6 * DY,), 5 * DY),
        (elasto_plastic.build(KEPT, K, FY, -FY), (6 * DY, -3 * DY), -2 * DY),
        (bilinear.build({"R": 0.1, **KEPT}, K, FY, -FY), (6 * DY,), (6 - 1.5) * DY),  # force 1 + 0.1 * 5
        (bilinear_elastic.build({"R": 0.1}, K, FY, -FY), (6 * DY,), 0.0),
        (origin_centred.build(ORIGIN, K, FY, -FY), (6 * DY,), 0.0),
        (elasto_plastic.build(KEPT, K, FY, -FY), (6 * DY, 5 * DY), 5 * DY),  # at rest already
    ],
)
def test_residual(law: Law, turns: tuple[float, ...], left: float) -> None:
    state, _ = driven(law, *turns)
    assert damage.residual(law, state, turns[-1]) == pytest.approx(left, abs=1e-14)


RULES = [spec for spec in catalog().family("hysteresis").values() if spec.impl is not None]


@pytest.mark.parametrize("spec", RULES, ids=lambda s: s.name)
def test_every_rule_lets_go(spec: Spec) -> None:
    """Led to what is left by its own path, the law has no force."""
    deck = DECK.format(item=f"RULE={spec.name} {spec.sample}", t=1, more="")
    law = structure_of(deck.replace("KX=100 FX=5", "KX=1 FX=1")).laws[0].law
    for turns in ((4.0, -2.5), (1.5, -3.0, 6.0, 4.5), (-0.7, 5.0, -5.5, 1.2, -2.0)):
        state, _ = driven(law, *turns)
        left = damage.residual(law, state, turns[-1])
        assert abs(law.force(drive(law, state, turns[-1], left), left)[0]) < 1e-9


DECK = """
NODES
 1 0 0 FIX=YR
ELEMENTS
 1 S 1
PROPS
 S SPRING KX=100 FX=5 {item}
WEIGHTS
 1 9.81
GRAVITY 9.81
EQUAKE
 SINE PERIOD=0.8 AMPLITUDE=6
ANALYSIS
 HISTORY {t} {more}
"""


@pytest.mark.parametrize("spec", RULES, ids=lambda s: s.name)
def test_yield_is_where_the_rule_yields(spec: Spec) -> None:
    """A push from zero comes to a branch that yields at the deformation that ductility counts from, with
    the yield force; a curve passes near it.
    """
    symmetric = spec.name == "RAMBERG_OSGOOD"
    for minus in (-1.0, -1.0 if symmetric else -1.4):
        deck = DECK.format(item=f"RULE={spec.name} {spec.sample}", t=1, more="")
        (spring,) = structure_of(deck.replace("KX=100 FX=5", f"KX=1 FX=1,{minus}")).laws
        assert spring.yields is not None and spring.strengths == (1.0, minus)
        for y, fy in zip(spring.yields, spring.strengths):
            law = spring.law
            if law.rule.curve is not None:
                assert y == pytest.approx(fy) or (math.isnan(y) and spec.name == "MASONRY_STRUT")
                continue
            before, after = (drive(law, law.start(), 0.0, share * y) for share in (1 - 1e-9, 1 + 1e-9))
            kinds = [law.rule.branches[s[0]].kind for s in (before, after)]
            assert law.force(after, y)[0] == pytest.approx(fy, rel=1e-8)
            if BranchKind.YIELDING in {b.kind for b in law.rule.branches}:
                assert [k is BranchKind.YIELDING for k in kinds] == [False, True]


def test_slack_and_cracks_count_in_the_deformation_at_yield() -> None:
    """Beside the yield force over the initial stiffness: a slack of 0.02, a secant of 0.4 of it."""
    for rule, y in (
        ("BILINEAR_SLACK R=0.05 SLACK=0.02", 0.07),
        ("WAYNE_STEWART FU=5 FI=1 SLACK=0.02", 0.07),
        ("TAKEDA_SLIP R=0.05 FCR=0.3 RHO=0.4", 0.125),
        ("SCHOETTLER_RESTREPO R=0.05 FCR=0.3 RHO=0.4 PINCH=0.3", 0.125),
    ):
        r = ran(f"RULE={rule} DUCTU=8 PA_BETA=0.1", t=2.0)
        spring, (member, _) = r.tables["spring_envelope"][0], r.tables["damage"]
        largest = max(spring["deformation_max"], -spring["deformation_min"])
        assert spring["ductility"] == pytest.approx(largest / y, rel=1e-12) and spring["ductility"] > 1.0
        energy = 0.1 * spring["plastic_work"] / (FY * 8.0 * y)
        assert member["index"] == pytest.approx(spring["ductility"] / 8.0 + energy, rel=1e-12)
        plastic = r.tables["spring_plastic"][0]
        assert plastic["path_ratio"] == pytest.approx(spring["plastic_work"] / FY / y, rel=1e-12)


def ran(item: str, t: float = 4.0, more: str = "METHOD=EXACT") -> Ran:
    return run_text(DECK.format(item=item, t=t, more=more))


def test_in_a_run() -> None:
    r = ran("RULE=ELASTO_PLASTIC DUCTU=6,9 PA_BETA=0.1")
    spring, plastic = r.tables["spring_envelope"][0], r.tables["spring_plastic"][0]
    member, whole = r.tables["damage"]
    high, low, loss = (spring[n] for n in ("deformation_max", "deformation_min", "plastic_work"))
    sides = [(d / (u * DY), 0.1 * loss / (FY * u * DY)) for d, u in ((high, 6.0), (-low, 9.0))]
    assert (member["by_deformation"], member["by_energy"]) == pytest.approx(max(sides, key=sum), rel=1e-12)
    assert member["index"] == pytest.approx(max(map(sum, sides)), rel=1e-12) and member["weight"] == 1.0
    assert (whole["element"], whole["index"]) == (0, pytest.approx(member["index"]))
    assert plastic["path"] == pytest.approx(loss / FY) and spring["yield_events"] > 3
    # nothing else holds the mass of 1: its total acceleration is the spring's force
    force, last = -float(r.a[-1, 0, 0]), float(r.u[-1, 0, 0])
    assert plastic["last"] == pytest.approx(last, abs=1e-14)
    assert plastic["residual"] == pytest.approx(last - force / K, abs=1e-9)


def test_only_where_asked() -> None:
    r = ran("RULE=ELASTO_PLASTIC")
    assert not len(r.tables.get("damage", ())) and len(r.tables["spring_plastic"]) == 1


@pytest.mark.parametrize("item", ["KH=5000", "LP=0.4"])
def test_hinges(item: str) -> None:
    """Ductility and index of a hinge are those of its rotation, with KH or EI / LP as its stiffness."""
    deck = f"""
NODES
 1 0 0 FIX=XYR
 2 0 4 FIX=Y
ELEMENTS
 1 C 1 2
PROPS
 C FRAME E=2E8 A=0.01 I=1E-5 RULE=BILINEAR R=0.05 MI=12 {item} DUCTU=15
WEIGHTS
 2 100
EQUAKE
 SINE PERIOD=1 AMPLITUDE=2
ANALYSIS
 HISTORY 3
"""
    r = run_text(deck)
    (spring,), (hinge, _) = r.tables["spring_envelope"], r.tables["damage"]
    stiffness = 5000.0 if item.startswith("KH") else 2e3 / 0.4
    largest = max(spring["deformation_max"], -spring["deformation_min"])
    assert spring["ductility"] == pytest.approx(largest * stiffness / 12.0, rel=1e-12)
    assert spring["ductility"] > 2.0
    energy = 0.05 * spring["plastic_work"] / (12.0 * 15.0 * 12.0 / stiffness)
    assert hinge["index"] == pytest.approx(spring["ductility"] / 15.0 + energy, rel=1e-12)


WAVES = """
PARAM n = 8
NODES
 100 -1 0 FIX=XYR
 1 TO 1+n 0 TO 8 0 FIX=YR
 50 8 0 FIX=XYR
ELEMENTS
 1 TO n BAR 1 TO n 2 TO 1+n
 90 SOFT 100 1
 91 WALL 1+n 50
PROPS
 BAR FRAME E=2E6 A=1
 SOFT SPRING KX=10
 WALL CONTACT K=1E6 GAP=0.01 ANGLE=0
WEIGHTS
 1 TO 1+n 9.81*2
GRAVITY 9.81
INITIAL
 1 TO 1+n VX=1
ANALYSIS
 HISTORY 0.1 METHOD=EXACT REFINE={refine}
OUTPUT
 EVERY={every}
"""


def test_envelopes_of_chosen_nodes_and_members_are_those_of_all() -> None:
    """The motion between the samples is looked at where OUTPUT asks for it, and nowhere else."""
    whole = run_text(WAVES.format(refine=0, every=0.05))
    some = run_text(WAVES.format(refine=0, every="0.05 NODES=1,3 MEMBERS=2,90"))
    for table, of, chosen in (("node_envelope", "node", {1, 3}), ("member_envelope", "element", {2, 90})):
        a, b = some.tables[table], whole.tables[table]
        b = b[[row[of] in chosen for row in b]]
        assert len(a) == len(b) > 0 and (a[of] == b[of]).all()
        for side in ("max", "min"):
            off, size = np.abs(a[side] - b[side]), np.abs(b[side]).max()
            # a displacement that turns is looked up if it goes far enough; others are seen then
            turns = a["quantity"] == "displacement"
            assert off[~turns].max() < 1e-12 * size
            assert not turns.any() or off[turns].max() < 1e-5 * np.abs(b[side][turns]).max()


def test_envelopes_hold_the_instants_at_which_displacements_turn() -> None:
    """A mass on a spring: node, drift and penetration of the contact have one peak, found in three ways."""
    deck = """
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
ELEMENTS
 1 COLUMN 1 2
 2 WALL 2
PROPS
 COLUMN SPRING KX=4000
 WALL CONTACT GAP=0.01 ANGLE=0 LAW=KELVIN_VOIGT K=1E6 E=0.65
WEIGHTS
 2 981
GRAVITY 9.81
DRIFT
 "d" 1 2
INITIAL
 2 VX=-1
ANALYSIS
 HISTORY 2 METHOD=EXACT
OUTPUT
 EVERY=1
"""
    r = run_text(deck)
    (node,) = [x for x in r.tables["node_envelope"] if x["quantity"] == "displacement"]
    (drift,), (contact,) = r.tables["drift_envelope"], r.tables["contact_summary"]
    assert 0.01 + contact["peak_penetration"] == pytest.approx(drift["max"], rel=1e-12)
    assert drift["min"] == pytest.approx(-((100.0 / 4000.0) ** 0.5), rel=1e-12)  # v / omega
    most = 1e-6 * (drift["max"] - drift["min"])
    assert node["max"] == pytest.approx(drift["max"], abs=most)
    assert node["min"] == pytest.approx(drift["min"], abs=most)


def test_envelopes_see_waves_between_the_samples() -> None:
    """A bar hits a wall: envelopes with three samples are those of five thousand.

    REFINE=4 takes them at most 1/4 rad of the fastest mode apart, so a peak of amplitude 1 is missed by
    less than 1 - cos(1/8) = 0.008.
    """
    coarse, fine = (run_text(WAVES.format(refine=x, every=y)) for x, y in ((4, 0.05), (0, 2e-5)))
    for table, group in (("member_envelope", "unit"), ("node_envelope", "quantity")):
        a, b = coarse.tables[table], fine.tables[table]
        for kind in np.unique(b[group]):
            here, there = a[a[group] == kind], b[b[group] == kind]
            scale = max(there["max"].max(), -there["min"].min())
            for side in ("max", "min"):
                assert np.abs(here[side] - there[side]).max() < 0.02 * scale
    assert len(coarse.time) == 3
    node = coarse.tables["node_envelope"]
    fastest = np.abs(node["min"][node["quantity"] == "acceleration"]).max()
    assert np.abs(coarse.a).max() < 0.7 * fastest  # which the samples alone do not see
