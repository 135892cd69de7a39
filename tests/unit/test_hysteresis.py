"""Hysteresis rules along paths worked by hand.

The tables of manual/hysteresis.md are the paths, one or more for every rule; here are others, where a rule
has more to show.  Every step is (deformation, force, energy lost so far), with its arithmetic beside it.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from paths import Walk, turning_points
from pound_deck.schema import Kind
from pound_solve.catalog import catalog
from pound_solve.laws.automaton import Law
from tiers import at_night
from verification.cases import run_text

RULES = catalog().family("hysteresis")
PAGE = (Path(__file__).parents[2] / "manual" / "hysteresis.md").read_text("utf-8")
Step = tuple[float, float, float]


def rule(name: str, plus: float = 20.0, minus: float = -10.0, /, **values: Any) -> Law:
    """A rule of stiffness 10; items that are left out have their defaults."""
    values = {f.name: f.default for f in RULES[name].fields} | values
    return RULES[name].impl(values, 10.0, plus, minus)  # type: ignore[no-any-return]


def drive(law: Law, steps: list[Step]) -> Walk:
    walk = Walk(law)
    for d, force, lost in steps:
        walk.move(d)
        assert walk.force == pytest.approx(force, abs=1e-12), d
        assert law.dissipated(walk.state, d) == pytest.approx(lost, abs=1e-12), d
        assert law.work(walk.state, d) == pytest.approx(walk.work, abs=1e-11), d
    return walk


# ---------------------------------------------------------------------- the tables of the manual

PATHS = re.findall(r"<!-- path: (\S+)(.*?) -->\n\n(.*?)\n\n<!-- end -->", PAGE, re.S)


def test_every_rule_has_a_path_in_the_manual() -> None:
    without = {s.name for s in RULES.values() if s.impl is not None} - {name for name, _, _ in PATHS}
    assert not without, "manual/hysteresis.md needs <!-- path: NAME ITEM=value --> and a table for each"


def digits(number: str) -> float:
    """Half a unit of the last digit of a number with four or more decimals; others are exact."""
    decimals = len(number.strip().partition(".")[2])
    return 0.5 * 10.0**-decimals if decimals >= 4 else 1e-11


@pytest.mark.parametrize(("name", "items", "rows"), PATHS, ids=lambda x: x[:40])
def test_path_of_the_manual(name: str, items: str, rows: str) -> None:
    values: dict[str, Any] = {}
    for item, text in re.findall(r"(\w+)=(\S+)", items):
        field = RULES[name].field(item)
        assert field is not None, item
        if field.kind is Kind.WORD:
            values[item] = text
        else:
            several = tuple(map(float, text.split(",")))
            values[item] = several if field.count[1] > 1 else several[0]
    law = rule(name, 20.0, -20.0, **values)
    walk, steps = Walk(law), [row.split("|")[1:4] for row in rows.splitlines()[2:]]
    assert len(steps) > 3
    for d, force, lost in steps:
        walk.move(float(d))
        assert walk.force == pytest.approx(float(force), abs=digits(force)), d
        assert law.dissipated(walk.state, walk.d) == pytest.approx(float(lost), abs=digits(lost)), d


# ---------------------------------------------------------------------- bilinear, with and without slack


def test_elasto_plastic_with_unequal_forces() -> None:
    drive(
        rule("ELASTO_PLASTIC"),
        [
            (1.5, 15.0, 0.0),  # 10 * 1.5
            (5.0, 20.0, 60.0),  # yields at 2, slips 3: 20 * 3
            (4.0, 10.0, 60.0),  # 20 - 10 * 1
            (4.5, 15.0, 60.0),  # reloads on the same line
            (-1.0, -10.0, 90.0),  # -10 is reached at 4.5 - 25/10 = 2, slips 3 back: 60 + 10 * 3
            (1.0, 10.0, 90.0),  # -10 + 10 * 2
            (3.0, 20.0, 110.0),  # 20 is reached at 2, slips 1: 90 + 20 * 1
        ],
    )


def test_bilinear_hardening() -> None:
    # r = 0.1: of the work along a yield line a tenth goes into f^2 / 2k
    drive(
        rule("BILINEAR", R=0.1),
        [
            (5.0, 23.0, 58.05),  # 20 + 1 * 3; 0.9 * 64.5
            (2.0, -7.0, 58.05),  # 23 - 10 * 3: just at the other yield line
            (-1.0, -10.0, 81.0),  # -7 - 1 * 3; 58.05 + 0.9 * 25.5
            (0.5, 5.0, 81.0),  # -10 + 10 * 1.5
            (4.0, 22.0, 118.8),  # yields again at 2 by 2; 81 + 0.9 * 42
        ],
    )


def test_bilinear_softening() -> None:
    # r = -0.2: the loss is 1.2 of the work along a yield line
    drive(
        rule("BILINEAR", R=-0.2),
        [
            (2.0, 20.0, 0.0),
            (5.0, 14.0, 61.2),  # 20 - 2 * 3; 1.2 * 51
            (2.0, -16.0, 61.2),  # 14 - 10 * 3, the other yield line: -10 - 2 * 3
            (-1.0, -10.0, 108.0),  # -16 + 2 * 3; 61.2 + 1.2 * 39
        ],
    )


def test_hardening_that_yields_back_returns_some_of_the_loss() -> None:
    # r = 0.5: at 12 the force is 20 + 5 * 10 = 70; the other yield line is at -10 + 5 * (d + 1)
    drive(
        rule("BILINEAR", R=0.5),
        [
            (12.0, 70.0, 225.0),  # half of 450
            (9.0, 40.0, 225.0),  # 70 - 30: the other line, -10 + 50; yields back from here
            (1.0, 0.0, 145.0),  # down to zero force: half of 40 * 8 / 2 comes back
            (-1.0, -10.0, 150.0),  # half of 10
        ],
    )


def test_slackness_that_grows() -> None:
    # takes hold at +1 and -0.5
    drive(
        rule("BILINEAR_SLACK", SLACK=(1.0, -0.5), GROW="YES"),
        [
            (0.9, 0.0, 0.0),
            (2.0, 10.0, 0.0),  # 10 * (2 - 1)
            (5.0, 20.0, 40.0),  # yields at 3, slips 2
            (3.5, 5.0, 40.0),  # 20 - 15; it lets go at 1 + 2 = 3
            (0.0, 0.0, 40.0),
            (-1.0, -5.0, 40.0),  # the other side has not moved: 10 * (-1 + 0.5)
            (-2.5, -10.0, 50.0),  # yields at -1.5, slips 1: 40 + 10
            (2.0, 0.0, 50.0),  # slack from -1.5 to 3
            (4.0, 10.0, 50.0),  # 10 * (4 - 3)
        ],
    )


def test_slackness_that_grows_and_hardens() -> None:
    # r = 0.2: slope 2 beyond yield, H = 2 / 0.8 = 2.5
    drive(
        rule("BILINEAR_SLACK", R=0.2, SLACK=(1.0, -0.5), GROW="YES"),
        [
            (5.0, 24.0, 35.2),  # 20 + 2 * 2; p = 4 - 2.4 = 1.6: 20 * 1.6 + 2.5 * 1.6^2 / 2
            (2.6, 0.0, 35.2),  # lets go at 1 + 1.6
            (-2.5, -12.0, 44.0),  # -10 - 2 * 1; p = -2 + 1.2 = -0.8: 35.2 + 8 + 2.5 * 0.64 / 2
            (4.0, 14.0, 44.0),  # 10 * (4 - 2.6): this side has not moved
            (6.0, 26.0, 64.0),  # yields at 5 with 24; p = 5 - 2.6 = 2.4: 44 + 20 * 0.8 + 2.5 * 3.2 / 2
        ],
    )


def test_slackness_that_moves() -> None:
    drive(
        rule("BILINEAR_SLACK", SLACK=(1.0, -0.5), GROW="NO"),
        [
            (5.0, 20.0, 40.0),  # yields at 3, slips 2: the slack is now from 1.5 to 3
            (2.0, 0.0, 40.0),
            (1.0, -5.0, 40.0),  # 10 * (1 - 1.5)
            (-1.0, -10.0, 55.0),  # yields at 0.5, slips 1.5 back: 40 + 15; the slack is from 0 to 1.5
            (1.0, 0.0, 55.0),
            (2.0, 5.0, 55.0),  # 10 * (2 - 1.5)
        ],
    )


def test_slackness_that_moves_far_yields_back_before_it_lets_go() -> None:
    # r = 0.2, H = 2.5: below p = -20/2.5 = -8 the yield force 20 + H p of the positive side is negative;
    # of the work along a yield line 0.8 is lost, or comes back
    drive(
        rule("BILINEAR_SLACK", R=0.2, SLACK=(1.0, -0.5), GROW="NO"),
        [
            (-15.5, -38.0, 268.8),  # -8 + 2 * (-15); p = -15 + 3.8 = -11.2; 0.8 * 14 * 24
            (-12.5, -8.0, 268.8),  # -38 + 30 = 20 + 2.5 * (-11.2): from here it yields back
            (-10.0, -3.0, 257.8),  # on the line 16 + 2 (d + 0.5), p = -9.2; - 0.8 * 2.5 * 5.5
            (-10.5, -8.0, 257.8),  # turns: -3 - 5
            (-10.0, -3.0, 257.8),
            (-8.0, 0.0, 256.0),  # lets go at -8.5 with p = -8: - 0.8 * 1.5 * 1.5
            (-5.0, 4.0, 259.2),  # takes hold at -7, yields at once: 2 * 2, p = -6.4; + 0.8 * 4
            (-6.0, 0.0, 259.2),  # 4 - 10 * 1 would be -6: lets go at -5.4, open until -6.9
            (-7.5, -6.0, 259.2),  # 10 * (-7.5 + 6.9)
        ],
    )


def same(one: Law, other: Law, reach: float = 30.0) -> None:
    """Hold two rules to the same forces and losses along random paths."""
    for seed in range(5):
        a, b = Walk(one), Walk(other)
        for d in turning_points(seed, reach):
            a.move(d)
            b.move(d)
            assert b.force == pytest.approx(a.force, abs=1e-11)
            assert other.dissipated(b.state, d) == pytest.approx(one.dissipated(a.state, d), abs=1e-9)


@pytest.mark.parametrize(("r", "alpha", "beta"), [(0.0, 0.8, 0.9), (0.2, 0.9, 1.0), (0.0, 1.0, 0.7)])
def test_matsushima_falls_with_each_half_cycle(r: float, alpha: float, beta: float) -> None:
    walk = Walk(rule("MATSUSHIMA", 20.0, -20.0, R=r, ALFA=alpha, BETA=beta))
    for n in range(6):
        end = 40.0 * (-1) ** n
        force = (1.0 - r) * 20.0 * beta**n * (-1) ** n + 10.0 * r * end
        assert walk.move(end).force == pytest.approx(force, rel=1e-12)
        tangent = walk.law.force(walk.move(0.999 * end).state, walk.d)[1]
        assert tangent == pytest.approx(10.0 * (r + (1.0 - r) * alpha**n), rel=1e-12)


def test_matsushima_half_cycles_need_a_yield_and_keep_a_hundredth() -> None:
    walk = Walk(rule("MATSUSHIMA", 20.0, -20.0, ALFA=0.5, BETA=0.5)).move(1.9, -1.9, 1.9, -1.9)
    assert walk.force == pytest.approx(-19.0)  # no yield, no loss
    walk.move(*[100.0, -100.0] * 10)
    assert walk.force == pytest.approx(-0.2, rel=1e-12)


@pytest.mark.parametrize("r", [0.0, 0.05, 0.4])
def test_rules_that_are_bilinear_in_a_limit(r: float) -> None:
    bilinear = rule("BILINEAR", R=r)
    same(bilinear, rule("BILINEAR_SLACK", R=r, SLACK=(0.0,), GROW="NO"))
    same(bilinear, rule("DEGRADING_BILINEAR", R=r))
    same(bilinear, rule("MATSUSHIMA", R=r))
    same(bilinear, rule("DEGRADING_BILINEAR", R=r, ILOS="EACH", DUCT1=40.0, DUCT2=50.0, RDUCT=0.5))
    if r:
        same(bilinear, rule("TRILINEAR", R=r, R2=-0.1, F2=(1e3,)))


def test_elasto_plastic_is_bilinear_without_hardening() -> None:
    same(rule("ELASTO_PLASTIC"), rule("BILINEAR", R=0.0))


def test_one_slack_value_holds_both_ways() -> None:
    law = rule("BILINEAR_SLACK", R=0.1, SLACK=(0.7,), GROW="YES")
    assert [(e.on_d, e.constant) for e in law.branch(law.start()).events] == [(1.0, -0.7), (-1.0, -0.7)]
    wider = Walk(law).move(4.0, 0.0)  # yields at 2.7 by 1.3: f = 20 + 1.3, so 0.7 + 1.17 is the edge now
    assert wider.law.branch(wider.state).events[0].constant == pytest.approx(-0.7 - 0.9 * 1.3)


def test_slow_turning_point_unloads_with_the_first_stiffness() -> None:
    """A yielding spring unloads at any deformation, however often the path turns."""
    walk = Walk(rule("BILINEAR", R=0.1))
    for n in range(1, 200):
        top = 2.0 + 0.01 * n
        walk.move(top, top - 0.005)
        assert walk.force == pytest.approx(20.0 + 0.01 * n - 0.05, abs=1e-9)


# ---------------------------------------------------------------------- the degrading rules


def test_trilinear_sides_may_differ() -> None:
    # second yield at 2 (1 + 0.5/0.5) = 4 with 30, and at -1 (1 + 1/0.5) = -3 with -20
    drive(
        rule("TRILINEAR", R=0.5, R2=0.1, F2=(1.5, 2.0)),
        [
            (6.0, 32.0, 80.8),  # 30 + 1 * 2; 20 + 50 + 62 = 132, less 32^2 / 20
            (3.0, 2.0, 80.8),  # 32 - 30: the first range is 3
            (-1.0, -18.0, 96.8),  # 2 - 5 * 4: the second range is 7; 81 + 32, less 16.2
            (-3.0, -20.0, 131.0),  # - 1 * 2: on the virgin curve of this side; 113 + 38 - 20
        ],
    )


def masing(law: Law, d: float) -> float:
    return Walk(law).move(d).force


def test_trilinear_obeys_masing() -> None:
    law = rule("TRILINEAR", 20.0, -20.0, R=0.3, R2=0.05, F2=(1.6,))
    for top in (3.0, 9.0, 20.0):
        for down in np.linspace(0.1, 2.0 * top, 13).tolist():
            walk = Walk(law).move(top, top - down)
            assert walk.force == pytest.approx(masing(law, top) - 2.0 * masing(law, 0.5 * down), abs=1e-12)


def test_strength_of_each_side_falls_by_itself() -> None:
    # 20 up to ductility 2, then to half at 6: on the positive side 20 at 4, 10 at 12
    drive(
        rule("ORIGIN_CENTRED", 20.0, -20.0, ILOS="EACH", DUCT1=2.0, DUCT2=6.0, RDUCT=0.5),
        [
            (8.0, 15.0, 70.0),  # 60 + 4 * 17.5 = 130, less 15 * 8 / 2
            (-4.0, -20.0, 90.0),  # the other side has lost nothing; 70 + 60 - 40
            (-6.0, -17.5, 115.0),  # 70 + 60 + 37.5 = 167.5, less 17.5 * 6 / 2
            (16.0, 10.0, 185.0),  # 115 + 60 + 50 + 40 = 265, less 10 * 16 / 2
        ],
    )


def test_strength_may_fall_with_the_ductility_of_the_other_side() -> None:
    drive(
        rule("ORIGIN_CENTRED", 20.0, -20.0, ILOS="LARGEST", DUCT1=2.0, DUCT2=6.0, RDUCT=0.5),
        [
            (8.0, 15.0, 70.0),
            (-1.0, -7.5, 70.0),  # virgin, but its yield point is at 15: slope 15 / 2
            (-6.0, -15.0, 100.0),  # 70 + 15 + 60 = 145, less 15 * 6 / 2
            (-8.0, -15.0, 115.0),  # 70 + 15 + 90, less 60
            (-12.0, -10.0, 165.0),  # + 4 * 12.5 = 225, less 60
            (4.0, 5.0, 165.0),  # the first side stands at 10 at its peak of 8
        ],
    )


def test_strength_loss_of_a_kinematic_rule() -> None:
    drive(
        rule("DEGRADING_BILINEAR", 20.0, -20.0, ILOS="EACH", DUCT1=2.0, DUCT2=6.0, RDUCT=0.5),
        [
            (8.0, 15.0, 118.75),  # 130 less 15^2 / 20
            (4.5, -20.0, 118.75),  # falls by 35 with 10; the other side has lost nothing
            (-4.0, -20.0, 288.75),  # + 20 * 8.5
            (-12.0, -10.0, 423.75),  # + 8 * 15 and the change of the store, 20 - 5
            (-9.5, 15.0, 423.75),  # the positive line stands at 15
            (8.0, 15.0, 686.25),  # + 15 * 17.5
            (10.0, 12.5, 717.1875),  # beyond the former peak it falls on: + 2 * 13.75 + 11.25 - 7.8125
        ],
    )


def test_soft_elastic_line_that_meets_the_falling_backbone() -> None:
    """A side may yield for the first time beyond the ductility where its loss begins."""
    law = rule("DEGRADING_BILINEAR", 20.0, -20.0, ALFA=1.0, ILOS="EACH", DUCT1=2.0, DUCT2=30.0, RDUCT=0.5)
    walk = Walk(law).move(-32.0)  # ductility 16: half of the way to half of the strength
    assert walk.force == pytest.approx(-15.0)
    assert walk.move(18.0).force == pytest.approx(16.25)  # -15 + 50 * 10 / 16
    # 5 + 1.25 x = 20 (1 - (x - 2) / 56) at x = 9.78; without the loss it would be at 12
    assert walk.names == {"elastic", "yielding -", "yielding weaker -"}
    assert walk.move(22.0).force == pytest.approx(20.0 * (1.0 - 9.0 / 56.0))
    assert "yielding weaker +" in walk.names


def test_soft_elastic_line_that_meets_what_is_left() -> None:
    """A side may even yield for the first time beyond the ductility where its loss has ended."""
    law = rule("DEGRADING_BILINEAR", ALFA=1.0, ILOS="EACH", DUCT1=2.0, DUCT2=4.0, RDUCT=0.5)
    walk = Walk(law).move(-20.0)  # ductility 20
    assert walk.force == pytest.approx(-5.0)
    assert walk.move(9.9).force == pytest.approx(9.95)  # -5 + 29.9 * 10 / 20
    assert walk.move(14.0).force == pytest.approx(10.0)
    assert "yielding weaker +" not in walk.names


def test_unloading_is_never_softer_than_the_secant() -> None:
    # r = 0.5, ductility 5: the secant is (1 + 2) / 5 = 0.6 of k, 5^-1 would be 0.2
    for name in ("CLOUGH", "TAKEDA", "Q_HYST", "DEGRADING_BILINEAR"):
        walk = Walk(rule(name, 20.0, -20.0, R=0.5, ALFA=1.0)).move(10.0, 9.0)
        assert walk.force == pytest.approx(60.0 - 6.0), name


def test_takeda_without_beta_is_clough() -> None:
    loss = {"ILOS": "LARGEST", "DUCT1": 1.5, "DUCT2": 9.0, "RDUCT": 0.4}
    for values in ({"R": 0.0}, {"R": 0.1, "ALFA": 0.4}, {"R": 0.1, "ALFA": 0.4, **loss}):
        same(rule("CLOUGH", **values), rule("TAKEDA", BETA=0.0, **values))


def test_peak_oriented_rules_stay_within_the_backbone_of_their_side() -> None:
    """Sharper than the contract: at every deformation, not only up to the largest.

    Short of yield a line that comes from the other side may carry more than the virgin rule, but not more
    than its yield force.
    """
    for name, values in (
        ("CLOUGH", {"R": 0.05, "ALFA": 0.4}),
        ("Q_HYST", {"R": 0.05, "ALFA": 0.4}),
        ("TAKEDA", {"R": 0.05, "ALFA": 0.4, "BETA": 0.6}),
        ("ORIGIN_CENTRED", {"R": 0.05}),
    ):
        law = rule(name, **values)
        for seed in range(5):
            walk = Walk(law).move(*turning_points(seed, 20.0))
            for state, a, b in walk.visits:
                for d in (a, 0.5 * (a + b), b):
                    f = law.force(state, d)[0]
                    beyond = max(d, 2.0) if f > 0.0 else min(d, -1.0)
                    assert abs(f) <= abs(Walk(law).move(beyond).force) + 1e-12


#: OpenSees 3.7.1 (openseespy 3.7.1.2), strain-driven 4000 steps a stretch, k = 10, yield at +-2, ten digits
CROSSES_LINEAR_RANGE = (8, 6, 1, 1.5, -2, -8, 2, 1, 8, 9, -3, 0, -12, -12.5, 3, 12, 15, -15)
PEER = [
    # Hysteretic, envelope of slope 1 beyond yield, pinchX = pinchY = 1, no damage, beta = 0.5
    ("CLOUGH", {"R": 0.1, "ALFA": 0.5},
     (26, 16, -7.5, -2.5, -20, -26, 11.55555556, 6.555555556, 26, 27, -14.467443, 0.3157968703, -30, -30.5,
      15.32432432, 30, 33, -33)),
    # Parallel of ElasticPP 5 to 2, ElasticPP 4 to 4, and Elastic 1
    ("TRILINEAR", {"R": 0.5, "R2": 0.1, "F2": (1.5,)},
     (34, 14, -21, -16, -28, -34, 28, 18, 34, 35, -29, 1, -38, -38.5, 29, 38, 41, -41)),
    # Steel01, b = 0.1
    ("BILINEAR", {"R": 0.1},
     (26, 6, -17, -12, -20, -26, 20, 10, 26, 27, -21, 9, -30, -30.5, 21, 30, 33, -33)),
    ("DEGRADING_BILINEAR", {"R": 0.1},
     (26, 6, -17, -12, -20, -26, 20, 10, 26, 27, -21, 9, -30, -30.5, 21, 30, 33, -33)),
]  # fmt: skip


@pytest.mark.parametrize(("name", "values", "forces"), PEER, ids=lambda x: x if isinstance(x, str) else "")
def test_opensees_gives_the_same_forces(
    name: str, values: dict[str, Any], forces: tuple[float, ...]
) -> None:
    walk = Walk(rule(name, 20.0, -20.0, **values))
    assert [walk.move(d).force for d in CROSSES_LINEAR_RANGE] == pytest.approx(forces, rel=1e-9)


# ---------------------------------------------------------------------- loss of strength


def left_at(law: Law, *path: float) -> float:
    """Force of the law, without hardening, over its first yield force, at the end of a path."""
    return Walk(law).move(*path).force / 20.0


LOSS = {"DUCT1": 2.0, "DUCT2": 6.0, "RDUCT": 0.5}


def test_strength_falls_on_to_a_hundredth() -> None:
    """1 up to ductility 2, half at 6, 0.01 at 10, where the deformation at yield is 2."""
    for name in (
        "ELASTO_PLASTIC",
        "BILINEAR",
        "DEGRADING_BILINEAR",
        "CLOUGH",
        "TAKEDA",
        "Q_HYST",
        "ORIGIN_CENTRED",
    ):
        law = rule(name, 20.0, -20.0, ILOS="EACH", DUCT3=10.0, **LOSS)
        for x, share in ((1.5, 1.0), (4.0, 0.75), (6.0, 0.5), (8.0, 0.255), (10.0, 0.01), (14.0, 0.01)):
            assert left_at(law, 2.0 * x) == pytest.approx(share, abs=1e-14), name
            assert left_at(law, -2.0 * x) == pytest.approx(-share, abs=1e-14), name
        # a former peak on the way down is met at the strength that it left
        assert left_at(law, 14.0, 13.9, 17.0) == pytest.approx(0.5 - 0.49 * 2.5 / 4.0, abs=1e-13), name


def test_a_sudden_loss() -> None:
    for form in ("EACH_SUDDEN", "LARGEST_SUDDEN"):
        law = rule("CLOUGH", 20.0, -20.0, ILOS=form, DUCT3=10.0, RCYC=0.0, **LOSS)
        for x, share in ((4.0, 0.75), (6.0, 0.5), (9.99, 0.5), (10.01, 0.01), (14.0, 0.01)):
            assert left_at(law, 2.0 * x) == pytest.approx(share, abs=1e-14)
        walk = Walk(law).move(21.0)
        # what the drop lets go is lost: all work but what 0.01 of the strength stores
        assert law.stored(walk.state, 21.0) == pytest.approx(0.5 * 0.2**2 / 10.0, abs=1e-14)
        other = 0.01 if form == "LARGEST_SUDDEN" else 1.0
        assert left_at(law, 21.0, -2.5) == pytest.approx(-min(other, 1.0), abs=1e-12)


def test_a_yield_force_that_is_left_lies_on_the_elastic_line() -> None:
    """BILINEAR: r k d beside a slider of (1 - r) Fy, the share of which falls."""
    r, law = 0.1, rule("BILINEAR", 20.0, -20.0, R=0.1, ILOS="EACH", DUCT3=10.0, **LOSS)
    for x, share in ((4.0, 0.75), (8.0, 0.255), (12.0, 0.01)):
        walk = Walk(law).move(2.0 * x)
        assert walk.force == pytest.approx(20.0 * ((1.0 - r) * share + r * x), abs=1e-13)
        walk.move(-30.0, 60.0)  # and with nothing left, a spring of r k
    assert walk.force == pytest.approx(20.0 * (0.9 * 0.01 + 0.1 * 30.0), abs=1e-12)


def test_strength_by_cycles() -> None:
    """Each yield that one of the other side follows is a cycle; forces at the ends of each half cycle."""
    by_number = rule("BILINEAR", 20.0, -20.0, ILOS="CYCLES", DUCT1=1.0, DUCT2=5.0, RDUCT=0.6)
    beside = rule("BILINEAR", 20.0, -20.0, ILOS="EACH_RCYC", DUCT1=30.0, DUCT2=40.0, RDUCT=0.5, RCYC=10.0)
    for name, law, shares in (
        ("number", by_number, (1.0, 1.0, 1.0, 1.0, 0.9, 0.9, 0.8, 0.8, 0.7, 0.7, 0.6, 0.6, 0.6)),
        ("beside", beside, (1.0, 1.0, 0.9, 0.9, 0.8, 0.8, 0.7, 0.7, 0.6, 0.6, 0.5, 0.5, 0.4)),
    ):
        walk = Walk(law)
        for n, share in enumerate(shares):
            side = -1.0 if n % 2 else 1.0
            walk.move(side * 6.0)
            assert side * walk.force == pytest.approx(20.0 * share, abs=1e-12), (name, n)
            walk.move(side * 5.5, side * 6.0)  # no cycle: the other side does not yield
            assert side * walk.force == pytest.approx(20.0 * share, abs=1e-12), (name, n)


def test_cycles_and_ductility_multiply() -> None:
    """CLOUGH at ductility 4: 0.75, after one cycle of 20 per cent 0.6; the first yield of the other side is
    no cycle, but with LARGEST its strength has fallen with the ductility of this one.
    """
    for form, other in (("EACH_RCYC", 1.0), ("LARGEST_RCYC", 0.75)):
        law = rule("CLOUGH", 20.0, -20.0, ILOS=form, RCYC=20.0, **LOSS)
        walk = Walk(law).move(8.0)
        assert walk.force == pytest.approx(15.0, abs=1e-12)
        walk.move(-3.0)
        assert walk.force == pytest.approx(-20.0 * other, abs=1e-12)
        assert walk.move(8.0).force == pytest.approx(0.8 * 15.0, abs=1e-12)


def test_no_strength_is_ever_regained() -> None:
    """Largest force of a half cycle, over ever the same range, of every form."""
    more = {"DUCT3": 12.0, "RCYC": 7.0}
    for form in ("EACH", "CYCLES", "LARGEST", "EACH_RCYC", "EACH_SUDDEN", "LARGEST_RCYC", "LARGEST_SUDDEN"):
        given = {n: v for n, v in more.items() if n == "DUCT3" or form.endswith(("RCYC", "SUDDEN"))}
        for name in ("BILINEAR", "CLOUGH", "TAKEDA", "Q_HYST", "ORIGIN_CENTRED"):
            law = rule(name, 20.0, -15.0, ILOS=form, **LOSS, **given)
            walk, last = Walk(law), [math.inf, math.inf]
            for n in range(24):
                side = n % 2
                walk.move((-1.0) ** side * 16.0)
                force = abs(walk.force)
                assert force <= last[side] + 1e-12, (name, form, n)
                last[side] = force


def test_no_loss_within_the_elastic_range() -> None:
    for spec in RULES.values():
        if spec.name in ("CLOUGH", "Q_HYST", "TAKEDA", "ORIGIN_CENTRED", "DEGRADING_BILINEAR"):
            law = rule(spec.name, 20.0, -20.0, R=0.1)
            walk = Walk(law).move(1.9, -1.9, 0.3, -1.0, 2.0)
            assert law.dissipated(walk.state, walk.d) == 0.0
            assert walk.names == {"elastic"}


@pytest.mark.parametrize(
    ("name", "minus", "values", "says"),
    [
        ("CLOUGH", 0.0, {}, "yield force"),
        ("TAKEDA", -10.0, {"R": -0.1}, "R of a degrading rule"),
        ("TAKEDA", -10.0, {"DUCT1": 2.0}, "no effect"),
        ("Q_HYST", -10.0, {"ILOS": "EACH", "DUCT1": 2.0, "DUCT2": 3.0}, "needs DUCT1, DUCT2 and RDUCT"),
        ("CLOUGH", -10.0, {"ILOS": "EACH", "DUCT1": 3.0, "DUCT2": 3.0, "RDUCT": 0.5}, "larger than DUCT1"),
        ("CLOUGH", -10.0, {"ILOS": "EACH", **LOSS, "DUCT3": 6.0}, "larger than DUCT2"),
        ("BILINEAR", -10.0, {"ILOS": "EACH", **LOSS, "RDUCT": 0.01, "DUCT3": 9.0}, "larger than 0.01"),
        ("CLOUGH", -10.0, {"ILOS": "EACH_SUDDEN", "RCYC": 1.0, **LOSS}, "needs DUCT3"),
        ("CLOUGH", -10.0, {"ILOS": "EACH_RCYC", **LOSS}, "RCYC goes with"),
        ("CLOUGH", -10.0, {"ILOS": "EACH", "RCYC": 3.0, **LOSS}, "RCYC goes with"),
        ("BILINEAR", -10.0, {"R": -0.1, "ILOS": "EACH", **LOSS}, "R of a degrading rule"),
        ("ELASTO_PLASTIC", -10.0, {"RCYC": 3.0}, "no effect"),
        ("TRILINEAR", -10.0, {"R": 0.3, "R2": 0.3, "F2": (2.0,)}, "slopes must fall"),
        ("BILINEAR_SLACK", -10.0, {"SLACK": (-1.0,)}, "SLACK"),
    ],
)
def test_what_a_rule_refuses(name: str, minus: float, values: dict[str, Any], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        rule(name, 20.0, minus, **values)


LOSING = """
NODES
 1 0 0 FIX=XYR
 2 0 0 FIX=YR
ELEMENTS
 7 S 1 2
PROPS
 S SPRING KX=1000 FX=20 RULE={rule} DUCT1=1.5 DUCT2=3 RDUCT=0.6
WEIGHTS
 2 98.1
DAMPING
 RAYLEIGH ALPHA=0.5
EQUAKE
 SINE DIRECTION=X AMPLITUDE=1.9 PERIOD=0.9
OUTPUT
 EVERY=0.1
ANALYSIS
 HISTORY 6 METHOD={method}
END
"""


@pytest.mark.full
@pytest.mark.parametrize(
    "rule",
    [
        "ELASTO_PLASTIC ILOS=CYCLES",
        "TAKEDA R=0.02 ALFA=0.3 BETA=0.2 ILOS=EACH_SUDDEN RCYC=2 DUCT3=4.5",
        *at_night(
            "BILINEAR R=0.05 ILOS=EACH DUCT3=9",
            "TAKEDA R=0.02 ALFA=0.3 BETA=0.2 ILOS=LARGEST_RCYC RCYC=6 DUCT3=9",
        ),
    ],
)
def test_methods_agree_on_an_oscillator_that_loses_strength(rule: str) -> None:
    found = []
    for method in ("EXACT", "TAYLOR", "LAGUERRE", "NEWMARK DT=0.0005"):
        run = run_text(LOSING.format(rule=rule, method=method))
        assert run.status == "done" and run.check() < 1e-5
        (row,) = run.tables["spring_envelope"]
        found.append([row["deformation_min"], row["deformation_max"], float(row["yield_events"])])
    exact, series, implicit, stepped = found
    assert series == pytest.approx(exact, rel=1e-11)
    assert implicit == pytest.approx(exact, rel=1e-7)
    assert stepped == pytest.approx(exact, rel=3e-5)
    assert exact[2] > 2


@pytest.mark.parametrize(
    ("rule", "counted"),
    [("BILINEAR R=0.05", True), ("RAMBERG_OSGOOD N=8 ALPHA=0.5", False), ("BILINEAR_ELASTIC R=0.1", False)],
)
def test_yield_events_are_counted_where_a_rule_has_a_yield_line_only(rule: str, counted: bool) -> None:
    """A smooth rule at several times its yield deformation has no number of yield events, not 0."""
    text = LOSING.replace(" DUCT1=1.5 DUCT2=3 RDUCT=0.6", "")
    run = run_text(text.format(rule=rule, method="TAYLOR"))
    (row,) = run.tables["spring_envelope"]
    assert row["ductility"] > 1.5
    assert row["yield_events"] > 2 if counted else np.isnan(row["yield_events"])
