"""The rules of Ibarra, Medina & Krawinkler: deterioration by hand, mode by mode, capping, failure, and
OpenSees beside them.

Stiffness 10, yield forces of 20 both ways, so that yield is at 2.
"""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from paths import Walk
from pound_solve.catalog import catalog
from pound_solve.laws.automaton import Law, Numbers
from pound_solve.laws.hysteresis import imk, imk_pinching

RULES = catalog().family("hysteresis")
BILINEAR, PEAK, PINCHING = "IMK_BILINEAR", "IMK_PEAK_ORIENTED", "IMK_PINCHING"


def rule(name: str, **values: Any) -> Law:
    """A rule with its cap 8 beyond yield and no strength left 20 beyond that, if not told otherwise."""
    base = {f.name: f.default for f in RULES[name].fields} | {"DP": (8.0,), "DPC": (20.0,)}
    if name == PINCHING:
        base |= {"KAPPAF": 0.5, "KAPPAD": 0.4}
    return RULES[name].impl(base | values, 10.0, 20.0, -20.0)  # type: ignore[no-any-return]


def forces(law: Law, goals: list[float]) -> list[float]:
    walk = Walk(law)
    return [walk.move(goal).force for goal in goals]


every = pytest.mark.parametrize("name", [BILINEAR, PEAK, PINCHING])
reloads = pytest.mark.parametrize("name", [PEAK, PINCHING])

# ---------------------------------------------------------------------- modes of deterioration, one by one
# Without hardening an excursion to 6 takes 20 + 80 and gives 20 back, down to 4.  A capacity of 880
# (LAMBDA = 44) makes its beta 80 / (880 - 80) = 0.1.


@pytest.mark.parametrize(
    ("name", "second"),
    [
        (BILINEAR, 18.0 * 8.2),  # slips from 4 - 1.8 to -6
        (PEAK, 0.5 * 18.0 * 6.0 + 18.0 * 4.0 - 16.2),  # (4, 0) to (-2, -18), slips 4, gives 18^2/20 back
        # break point at 0.6 (2 - 1.8) = 0.12 with 9 * 4.12 / 6 = 6.18 (mirrored)
        (PINCHING, 0.5 * 6.18 * 4.12 + 0.5 * (6.18 + 18.0) * 1.88 + 72.0 - 16.2),
    ],
)
def test_basic_strength(name: str, second: float) -> None:
    walk = Walk(rule(name, LAMBDA=(44.0, 0.0, 0.0))).move(6.0, -6.0)
    assert walk.force == pytest.approx(-18.0, rel=1e-14)
    beta = second / (880.0 - 80.0 - second)
    assert walk.move(6.0).force == pytest.approx(20.0 * (1.0 - beta), rel=1e-13)


@every
def test_exponent(name: str) -> None:
    assert forces(rule(name, LAMBDA=(44.0, 0.0, 0.0), C=2.0), [6.0, -6.0])[1] == pytest.approx(-19.8)


@every
def test_hardening_deteriorates_with_the_yield_force(name: str) -> None:
    # to 6 with r = 0.1: work 20 + 88, 24^2/20 = 28.8 back, E = 79.2; capacity 871.2
    law = rule(name, R=0.1, LAMBDA=(43.56, 0.0, 0.0))
    # yield at 1.8 with 18, then 0.9
    assert forces(law, [6.0, -6.0])[1] == pytest.approx(-18.0 - 0.9 * 4.2, rel=1e-14)


@every
def test_post_capping_strength(name: str) -> None:
    # the falling line 30 - d of the other side becomes 27 - d
    got = forces(rule(name, LAMBDA=(0.0, 44.0, 0.0)), [6.0, -6.0, -9.0])
    assert got == pytest.approx([20.0, -20.0, -18.0], rel=1e-14)


@every
def test_unloading_stiffness(name: str) -> None:
    assert forces(rule(name, LAMBDA=(0.0, 0.0, 44.0)), [6.0, 5.0]) == pytest.approx([20.0, 11.0], rel=1e-14)


@every
def test_an_excursion_softens_once_however_often_it_turns(name: str) -> None:
    many = [6.0, *(6.0 - 0.01 * (n % 2) for n in range(1, 41)), 6.5, 5.5]
    for goals in ([6.5, 5.5], [6.0, 5.0, 6.5, 5.5], many):
        # at 6.5: E = 110 - 20, beta = 90 / (880 - 90)
        last = forces(rule(name, LAMBDA=(0.0, 0.0, 44.0)), goals)[-1]
        assert last == pytest.approx(20.0 - 10.0 * (1.0 - 90.0 / 790.0), rel=1e-13)


@every
def test_an_excursion_softens_by_half_at_most(name: str) -> None:
    # capacity 180: beta would be 80 / 100
    assert forces(rule(name, LAMBDA=(0.0, 0.0, 9.0)), [6.0, 5.0])[1] == pytest.approx(15.0, rel=1e-14)


def test_accelerated_reloading() -> None:
    walk = Walk(rule(PEAK, LAMBDA=(0.0, 0.0, 0.0, 44.0))).move(6.0, 0.9)
    assert walk.force == pytest.approx(-10.0, rel=1e-14)  # half way from (4, 0) to (-2.2, -20)
    # 2nd excursion, ends at -4: 62 + 76 - 20 = 118; beta = 118 / (880 - 198); the target was 6
    target = 6.0 * (1.0 + 118.0 / 682.0)
    assert walk.move(-6.0, 6.0).force == pytest.approx(20.0 * 10.0 / (target + 4.0), rel=1e-14)
    assert walk.move(target - 1e-9).force < 20.0 == walk.move(target + 1e-9).force


@every
def test_exhausted_energy_fails_where_the_force_is_gone(name: str) -> None:
    # capacity 160: beta = 80 / 80; of 120: the stiffness is halved, which gives 40 back, beta = 60 / 60
    for modes, foot in (((8.0, 0.0, 0.0), 4.0), ((0.0, 8.0, 0.0), 4.0), ((0.0, 0.0, 6.0), 2.0)):
        walk = Walk(rule(name, LAMBDA=modes)).move(6.0)
        assert walk.move(foot + 1e-6).force > 0.0
        assert walk.move(foot - 1e-6).force == 0.0
        assert forces(walk.law, [6.0, -6.0, 20.0]) == [20.0, 0.0, 0.0]
        assert "failed" in walk.names
    assert "failed" not in Walk(rule(name, LAMBDA=(8.001, 0.0, 0.0))).move(6.0, -6.0).names


# ---------------------------------------------------------------------- cap, residual, end


@every
def test_monotonic_backbone(name: str) -> None:
    # 24 at the cap; it falls by 1.2 to 4 at 26.67, and would be at zero at 30
    law = rule(name, R=0.05, RESIDUAL=0.2)
    goals = [1.0, 2.0, 6.0, 10.0, 20.0, 26.0, 27.0, 50.0]
    expected = [10.0, 20.0, 22.0, 24.0, 12.0, 4.8, 4.0, 4.0]
    assert forces(law, goals) == pytest.approx(expected, rel=1e-14)
    assert forces(law, [-x for x in goals]) == pytest.approx([-f for f in expected], rel=1e-14)


@every
def test_without_a_residual_strength_it_fails_at_zero_force(name: str) -> None:
    walk = Walk(rule(name, R=0.05)).move(29.9)
    assert walk.force == pytest.approx(0.12, rel=1e-12)
    assert walk.move(30.1, 0.0, -10.0).force == 0.0
    # all that was put in is lost: 20 + 22 * 8 + 12 * 20
    assert walk.law.dissipated(walk.state, walk.d) == pytest.approx(20.0 + 176.0 + 240.0, rel=1e-13)


@every
def test_ultimate_deformation(name: str) -> None:
    law = rule(name, R=0.05, RESIDUAL=0.2, DU=(12.0, 8.0))
    for sign, last, force in ((1.0, 12.0, 21.6), (-1.0, 8.0, 23.0)):
        walk = Walk(law).move(sign * (last - 1e-9))
        assert walk.force == pytest.approx(sign * force, rel=1e-8)
        assert walk.move(sign * (last + 1e-9), 0.0, -sign * 5.0).force == 0.0
    # in the elastic range too, where it has moved beyond
    assert forces(law, [11.0, 10.9, 12.5]) == pytest.approx([22.8, 21.8, 0.0], rel=1e-13)


@every
def test_sides_of_their_own(name: str) -> None:
    law = rule(name, DP=(4.0, 8.0), DPC=(10.0, 40.0))
    assert forces(law, [8.0]) == pytest.approx([16.0])  # cap at 6, falls by 2
    assert forces(law, [-14.0]) == pytest.approx([-18.0])  # cap at 10, falls by 0.5


@every
def test_bad_parameters(name: str) -> None:
    with pytest.raises(ValueError, match="beyond the yield deformation"):
        rule(name, DU=(2.0,))
    spec, values = RULES[name], {"DP": (1.0,), "DPC": (1.0,), "KAPPAF": 0.5, "KAPPAD": 0.0}
    with pytest.raises(ValueError, match="both sides"):
        spec.impl({f.name: f.default for f in spec.fields} | values, 10.0, 20.0, 0.0)


# ---------------------------------------------------------------------- any history

goals = st.lists(st.floats(-16.0, 16.0), min_size=1, max_size=15)
modes = st.tuples(*[st.sampled_from([0.0, 40.0, 200.0])] * 3)


@settings(max_examples=60)
@given(path=goals, modes=modes, r=st.sampled_from([0.0, 0.05, 0.2]))
@every
def test_no_force_beyond_the_virgin_backbone_nor_stiffer_than_at_first(
    name: str, path: list[float], modes: tuple[float, ...], r: float
) -> None:
    law = rule(name, R=r, RESIDUAL=0.1, LAMBDA=modes)
    walk = Walk(law).move(*path)
    cap = 20.0 + 80.0 * r
    for state, a, b in walk.visits:
        assert law.branch(state).stiffness <= 10.0 * (1.0 + 1e-12)
        for d in (a, b):
            f = abs(law.force(state, d)[0])
            assert f <= cap * (1.0 + 1e-12)
            if law.force(state, d)[0] * d > 0.0:
                assert f <= max(2.0, cap * (1.0 - (abs(d) - 10.0) / 20.0)) + 1e-9


@pytest.mark.full
@settings(max_examples=60)
@given(path=goals, r=st.sampled_from([0.0, 0.05, 0.2]), residual=st.sampled_from([0.0, 0.3]))
@every
def test_without_deterioration_the_loss_never_falls(
    name: str, path: list[float], r: float, residual: float
) -> None:
    walk, lost = Walk(rule(name, R=r, RESIDUAL=residual)), 0.0
    for goal in path:
        start = walk.d
        for n in range(1, 11):
            walk.move(start + (goal - start) * n / 10.0)
            now = walk.law.dissipated(walk.state, walk.d)
            assert now >= lost - 1e-10
            lost = now


# ---------------------------------------------------------------------- OpenSees 3.7.1
# uniaxialMaterial IMKBilin ("Code by AE_KI (Nov22)"), IMKPeakOriented, IMKPinching ("Sep23"), driven in
# steps of 1e-4: deformation and stress; steps of 2e-4 give the same digits but one.

#: R = 0.05, RESIDUAL = 0.2 where nothing else stands
SAME = {
    "peak-oriented, growing": (
        (PEAK, {"LAMBDA": (50.0,)}),
        "3 20.5 -3 -20.125662 3 19.567643 -3 -19.513392 5 20.546569 -5 -19.505123 5 18.180813 "
        "-5 -17.777764 8 19.07617 -8 -16.776395 8 11.978648 -8 -11.55033 12 6.779057 -12 -4.35991 "
        "12 3.576213 -12 -3.712747 0 1.595738",
    ),
    "peak-oriented, inner cycles": (
        (PEAK, {"LAMBDA": (50.0,)}),
        "4 21 1 -4.021817 4 20.958616 -2 -18.780361 1 5.051799 -2 -18.780361 8 22.487713 2 -7.391476 "
        "5 9.010107 3 -3.470269 8 21.893479 12 20.361479 4 -6.257374 -1 -12.535545 3 2.786543 "
        "-6 -15.797951 -2 0.665221 -6 -15.777623 6 5.260103 15 9.843093 0 -8.271996",
    ),
    "pinching, growing": (
        (PINCHING, {"LAMBDA": (50.0,)}),
        "3 20.5 -3 -20.125662 3 19.619277 -3 -19.705819 5 20.793604 -5 -19.825086 5 18.48652 -5 -18.504957 "
        "8 20.189721 -8 -18.284424 8 14.778028 -8 -14.468513 12 10.94646 -12 -6.961153 12 3.563759 "
        "-12 -4.281783 0 0.820238",
    ),
    "pinching, inner cycles": (
        (PINCHING, {"LAMBDA": (50.0,)}),
        "4 21 1 -2.010908 4 20.969761 -2 -18.511765 1 2.652222 -2 -18.511765 8 22.708241 2 -3.72776 "
        "5 9.347056 3 -1.199904 8 22.353924 12 20.883283 4 -3.125008 -1 -8.338079 3 2.130584 -6 -15.816727 "
        "-2 0.570732 -6 -15.795867 6 3.731995 15 12.323728 0 -4.301589",
    ),
    # sides and modes of their own (here S, C, K, A; OpenSees has A before K), exponent 1.5, to failure
    "pinching, all different": (
        (
            PINCHING,
            {
                "DP": (6.0, 10.0),
                "DPC": (15.0, 25.0),
                "RESIDUAL": 0.1,
                "LAMBDA": (60.0, 90.0, 40.0, 70.0),
                "C": 1.5,
                "KAPPAF": 0.3,
                "KAPPAD": 0.2,
            },
        ),
        "4 21 -4 -20.878334 4 20.690736 -4 -20.820204 7 22.301266 -7 -21.916419 7 21.178029 -7 -21.573697 "
        "11 17.68361 -11 -22.231335 11 15.344803 -11 -21.718572 16 9.10474 -16 0 0 0",
    ),
    "bilinear, before the cap": (
        (BILINEAR, {"LAMBDA": (50.0,)}),
        "3 20.5 -3 -20.125662 3 19.763624 -3 -19.423943 5 20.024617 -5 -18.8168 5 17.702107 -5 -16.678127 "
        "7 16.479558",
    ),
    "bilinear, without deterioration": (
        (BILINEAR, {}),
        "6 22 -6 -22 9 23.5 -9 -23.5 9 23.5 14 19.2 0 -19 -14 -19.2 0 19",
    ),
}


def table(text: str) -> tuple[list[float], list[float]]:
    numbers = list(map(float, text.split()))
    return numbers[::2], numbers[1::2]


@pytest.mark.parametrize(("case", "frozen"), SAME.values(), ids=SAME)
def test_as_opensees(case: tuple[str, dict[str, Any]], frozen: str) -> None:
    name, values = case
    path, expected = table(frozen)
    got = forces(rule(name, **({"R": 0.05, "RESIDUAL": 0.2} | values)), path)
    assert got == pytest.approx(expected, abs=1.1e-6)


def test_opensees_softens_again_at_every_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    path, frozen = table("6 22 -6 -20.228662 6 18.274262 4 3.732823 9 20.698458 0 -7.827254 -9 -17.028516")
    law = rule(PEAK, R=0.05, RESIDUAL=0.2, LAMBDA=(50.0,))
    got = forces(law, path)
    assert got[:5] == pytest.approx(frozen[:5], abs=1.1e-6)
    assert got[5:] == pytest.approx([-7.983261, -16.872446], abs=1.1e-6)  # it turned at 6 and at 9

    def again(p: Numbers, m: Numbers, f: float) -> float:
        return imk.softened(p, (*m[: imk.KU_BEFORE], m[imk.KU], *m[imk.KU_BEFORE + 1 :]), f)

    monkeypatch.setattr(imk_pinching, "softened", again)
    assert forces(law, path) == pytest.approx(frozen, abs=1.1e-6)


def test_opensees_aims_at_a_local_peak_that_the_backbone_has_left(monkeypatch: pytest.MonkeyPatch) -> None:
    path, frozen = table(
        "4 21 -4 -20.878334 4 20.657563 -4 -20.681958 7 22.102291 -7 -21.527609 7 20.624132"
    )
    law = rule(PEAK, R=0.05, DP=(6.0, 10.0), DPC=(15.0, 25.0), LAMBDA=(60.0, 90.0, 40.0, 70.0), C=1.5)
    got = forces(law, path)
    assert got[:5] == pytest.approx(frozen[:5], abs=1.1e-6)
    assert got[5] == pytest.approx(-21.534454, abs=1.1e-6)

    def anyway(p: Numbers, s: float, m: Numbers, d: float, f: float) -> bool:
        (d1, f1), (d2, f2) = imk_pinching.local_peak(s, m), imk_pinching.peak(p, s, m)
        return d < d1 < d2 and f < f1 < f2 and (f1 - f) * (d2 - d) > (f2 - f) * (d1 - d)

    monkeypatch.setattr(imk_pinching, "passes_local_peak", anyway)
    assert forces(law, path) == pytest.approx(frozen, abs=1.1e-6)


def test_opensees_has_no_strength_limit() -> None:
    path, frozen = table("14 19.2 0 -19 6 22 10 24 14 19.2")
    got = forces(rule(BILINEAR, R=0.05, RESIDUAL=0.2), path)
    assert got == pytest.approx([19.2, -19.0, 19.2, 19.2, 19.2], rel=1e-14)
    assert frozen[2:4] == pytest.approx([19.0 + 0.5 * 6.0, 19.0 + 0.5 * 10.0])  # the hardening line


def test_opensees_flattens_the_falling_branch() -> None:
    path, frozen = table("6 22 -9 -22.57606 -10 -23.055566 -12 -20.862192 -14 -18.58516 -20 -11.754064")
    got = forces(rule(BILINEAR, R=0.05, RESIDUAL=0.2, LAMBDA=(100.0,)), path)
    # by hand: 104 to 6, 2000 in all; the energy that comes back is 22^2/2ku
    ku = 10.0 * (1.0 - (104.0 - 24.2) / (2000.0 - 104.0 + 24.2))
    spent = 104.0 - 0.5 * 22.0**2 / ku
    left = 1.0 - spent / (2000.0 - spent)

    def hardening(d: float) -> float:
        return left * (20.0 + 0.5 * (d - 2.0 * left))

    assert got[1] == pytest.approx(-hardening(9.0), rel=1e-13)
    for n, d in enumerate((10.0, 12.0, 14.0, 20.0), 2):
        ours, theirs = 36.0 * left - 1.2 * d, 36.0 * left - 1.2 * (20.0 * left - 4.0) / 16.0 * d
        assert got[n] == pytest.approx(-ours, rel=1e-13)
        assert frozen[n] == pytest.approx(-min(hardening(d), theirs), abs=1.1e-6)
