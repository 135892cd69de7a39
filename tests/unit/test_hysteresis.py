"""Hysteresis rules along paths worked by hand; stiffness 10, yield forces +20 and -10 (at +2 and -1).

Every step is (deformation, force, plastic work so far, recoverable energy), with its arithmetic beside it.
"""

from __future__ import annotations

from typing import Any

import pytest

from pound_solve.catalog import catalog
from pound_solve.hysteresis.slackness import Slackness
from pound_solve.laws import Law, follow

Step = tuple[float, float, float, float]


def rule(name: str, **values: Any) -> Law:
    return catalog().family("hysteresis")[name].impl(values, 10.0, 20.0, -10.0)  # type: ignore[no-any-return]


def walk(law: Law, steps: list[Step]) -> Any:
    state, last = law.start(), 0.0
    for d, force, lost, stored in steps:
        state = follow(law, state, last, d)
        last = d
        assert law.branch(state).force(d, 0.0) == pytest.approx(force, abs=1e-12), d
        assert law.dissipated(state, d) == pytest.approx(lost, abs=1e-12), d
        assert law.stored(state, d) == pytest.approx(stored, abs=1e-12), d
    return state


def test_elasto_plastic() -> None:
    walk(
        rule("ELASTO_PLASTIC"),
        [
            (1.5, 15.0, 0.0, 11.25),  # 10 * 1.5; 15^2 / 20
            (5.0, 20.0, 60.0, 20.0),  # yields at 2, slips 3: 20 * 3; 20^2 / 20
            (4.0, 10.0, 60.0, 5.0),  # 20 - 10 * 1
            (4.5, 15.0, 60.0, 11.25),  # reloads on the same line
            (-1.0, -10.0, 90.0, 5.0),  # -10 is reached at 4.5 - 25/10 = 2, slips 3 back: 60 + 10 * 3
            (1.0, 10.0, 90.0, 5.0),  # -10 + 10 * 2
            (3.0, 20.0, 110.0, 20.0),  # 20 is reached at 2, slips 1: 90 + 20 * 1
        ],
    )


def test_bilinear_hardening() -> None:
    # r = 0.1: a spring of 1 beside a slider of stiffness 9 that slips at +18 and -9
    walk(
        rule("BILINEAR", R=0.1),
        [
            (
                5.0,
                23.0,
                54.0,
                30.5,
            ),  # 20 + 1 * 3; 18 * 3; 5^2 / 2 + 18^2 / 18; the area is 20 + 64.5 = 84.5
            (2.0, -7.0, 54.0, 6.5),  # 23 - 10 * 3: just at the other slip, -9 + 2; 2^2 / 2 + 9^2 / 18
            (-1.0, -10.0, 81.0, 5.0),  # -7 - 1 * 3; 54 + 9 * 3; 1/2 + 4.5
            (0.5, 5.0, 81.0, 1.25),  # -10 + 10 * 1.5; 0.5^2 / 2 + (0.5 * 9)^2 / 18
            (4.0, 22.0, 117.0, 26.0),  # slips again at 2 by 2: 18 + 4; 81 + 18 * 2; 8 + 18
        ],
    )


def test_bilinear_softening() -> None:
    # r = -0.2: a spring of -2 beside a slider of stiffness 12 that slips at +24 and -12
    walk(
        rule("BILINEAR", R=-0.2),
        [
            (2.0, 20.0, 0.0, 20.0),  # -4 + 24; -4 + 24
            (5.0, 14.0, 72.0, -1.0),  # 20 - 2 * 3; 24 * 3; -25 + 24; the area is 20 + 51 = 71
            (2.0, -16.0, 72.0, 2.0),  # 14 - 10 * 3 = -4 - 12; -4 + 6
            (-1.0, -10.0, 108.0, 5.0),  # -16 + 2 * 3; 72 + 12 * 3; -1 + 6
        ],
    )


def test_slackness_that_grows() -> None:
    # takes hold at +1 and -0.5
    walk(
        rule("BILINEAR_SLACK", R=0.0, SLACK=(1.0, -0.5), GROW="YES"),
        [
            (0.9, 0.0, 0.0, 0.0),
            (2.0, 10.0, 0.0, 5.0),  # 10 * (2 - 1)
            (5.0, 20.0, 40.0, 20.0),  # yields at 3, slips 2
            (3.5, 5.0, 40.0, 1.25),  # 20 - 15; it lets go at 1 + 2 = 3
            (0.0, 0.0, 40.0, 0.0),
            (-1.0, -5.0, 40.0, 1.25),  # the other side has not moved: 10 * (-1 + 0.5)
            (-2.5, -10.0, 50.0, 5.0),  # yields at -1.5, slips 1: 40 + 10
            (2.0, 0.0, 50.0, 0.0),  # slack from -1.5 to 3
            (4.0, 10.0, 50.0, 5.0),  # 10 * (4 - 3)
        ],
    )


def test_slackness_that_grows_and_hardens() -> None:
    # r = 0.2: slope 2 beyond yield, H = 2 / 0.8 = 2.5
    walk(
        rule("BILINEAR_SLACK", R=0.2, SLACK=(1.0, -0.5), GROW="YES"),
        [
            (
                5.0,
                24.0,
                35.2,
                28.8,
            ),  # 20 + 2 * 2; p = 4 - 2.4 = 1.6: 32 + 2.5 * 1.6^2 / 2; 24^2 / 20; sum 64 = 20 + 44
            (2.6, 0.0, 35.2, 0.0),  # lets go at 1 + 1.6
            (-2.5, -12.0, 44.0, 7.2),  # -10 - 2 * 1; p = -2 + 1.2 = -0.8: 35.2 + 8 + 2.5 * 0.64 / 2
            (4.0, 14.0, 44.0, 9.8),  # 10 * (4 - 2.6): this side has not moved
            (
                6.0,
                26.0,
                64.0,
                33.8,
            ),  # yields at 5 with 24; p = 5 - 2.6 = 2.4: 44 + 20 * 0.8 + 2.5 * 3.2 / 2
        ],
    )


def test_slackness_that_moves() -> None:
    walk(
        rule("BILINEAR_SLACK", R=0.0, SLACK=(1.0, -0.5), GROW="NO"),
        [
            (5.0, 20.0, 40.0, 20.0),  # yields at 3, slips 2: the slack is now from 1.5 to 3
            (2.0, 0.0, 40.0, 0.0),
            (1.0, -5.0, 40.0, 1.25),  # 10 * (1 - 1.5)
            (-1.0, -10.0, 55.0, 5.0),  # yields at 0.5, slips 1.5 back: 40 + 15; the slack is from 0 to 1.5
            (1.0, 0.0, 55.0, 0.0),
            (2.0, 5.0, 55.0, 1.25),  # 10 * (2 - 1.5)
        ],
    )


def test_slackness_that_moves_far_yields_back_before_it_lets_go() -> None:
    # r = 0.2, H = 2.5: below p = -20/2.5 = -8 the yield force 20 + H p of the positive side is negative
    law = rule("BILINEAR_SLACK", R=0.2, SLACK=(1.0, -0.5), GROW="NO")
    walk(
        law,
        [
            # -8 + 2 * (-15); p = -15 + 3.8 = -11.2: 10 * 11.2; 38^2 / 20 + 2.5 * 11.2^2 / 2
            (-15.5, -38.0, 112.0, 72.2 + 156.8),
            (-12.5, -8.0, 112.0, 3.2 + 156.8),  # -38 + 30 = 20 + 2.5 * (-11.2): from here it yields back
            # on the line 16 + 2 (d + 0.5): -3 at -10; p = -9.5 + 0.3 = -9.2: 112 + 20 * 2
            (-10.0, -3.0, 152.0, 0.45 + 105.8),
            (-10.5, -8.0, 152.0, 3.2 + 105.8),  # turns: -3 - 5
            (-10.0, -3.0, 152.0, 0.45 + 105.8),
            (-8.0, 0.0, 176.0, 80.0),  # lets go at -8.5 with p = -8: 112 + 20 * 3.2; 2.5 * 64 / 2
            (-5.0, 4.0, 208.0, 0.8 + 51.2),  # takes hold at -7, yields at once: 2 * 2; p = -6.4: 176 + 32
            (-6.0, 0.0, 208.0, 51.2),  # 4 - 10 * 1 would be -6: lets go at -5.4, open until -6.9
            (-7.5, -6.0, 208.0, 1.8 + 51.2),  # 10 * (-7.5 + 6.9)
        ],
    )


def test_slackness_without_slack_and_growth_is_the_bilinear_rule() -> None:
    for r in (0.0, 0.05, 0.4):
        one, other = rule("BILINEAR", R=r), rule("BILINEAR_SLACK", R=r, SLACK=(0.0,), GROW="NO")
        a, b, last = one.start(), other.start(), 0.0
        for d in (3.0, 1.0, 8.0, -30.0, -29.5, -3.0, -10.0, 25.0, 0.0, 0.1, -1.0):
            a, b, last = follow(one, a, last, d), follow(other, b, last, d), d
            assert other.branch(b).force(d, 0.0) == pytest.approx(one.branch(a).force(d, 0.0), abs=1e-12)
            assert other.dissipated(b, d) == pytest.approx(one.dissipated(a, d), abs=1e-10)
            assert other.stored(b, d) == pytest.approx(one.stored(a, d), abs=1e-10)


def test_one_slack_value_holds_both_ways() -> None:
    law = rule("BILINEAR_SLACK", R=0.1, SLACK=(0.7,), GROW="YES")
    assert isinstance(law, Slackness)
    assert (law.gap_plus, law.gap_minus, law.grow) == (0.7, -0.7, True)


def test_slow_turning_point_unloads_with_the_first_stiffness() -> None:
    """A yielding spring unloads at any deformation, however often the path turns."""
    law = rule("BILINEAR", R=0.1)
    state, last = law.start(), 0.0
    for n in range(1, 200):
        top = 2.0 + 0.01 * n
        for d in (top, top - 0.005):
            state = follow(law, state, last, d)
            last = d
        assert law.branch(state).force(last, 0.0) == pytest.approx(20.0 + 0.01 * n - 0.05, abs=1e-9)
