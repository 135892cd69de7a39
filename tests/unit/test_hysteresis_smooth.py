"""The curved rules, Bouc-Wen, Ramberg-Osgood and Menegotto-Pinto, against closed forms, quadrature, an ODE
solver and OpenSees.

Stiffness 10, yield forces of 20 both ways, so that yield is at 2, if not told otherwise.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

import contract
from paths import Walk
from pound_solve.catalog import catalog
from pound_solve.laws.automaton import Law, drive
from pound_solve.laws.hysteresis import bouc_wen, menegotto_pinto, ramberg_osgood
from verification.cases import run_text

RULES = catalog().family("hysteresis")


def rule(name: str, minus: float = -20.0, /, **values: Any) -> Law:
    base = {f.name: f.default for f in RULES[name].fields}
    return RULES[name].impl(base | values, 10.0, 20.0, minus)  # type: ignore[no-any-return]


def forces(law: Law, goals: list[float]) -> list[float]:
    state, d, out = law.start(), 0.0, []
    for goal in goals:
        state, d = drive(law, state, d, goal), goal
        out.append(law.force(state, d)[0])
    return out


# ---------------------------------------------------------------------- Bouc-Wen


@pytest.mark.parametrize("d", [1e-9, 0.01, 0.7, 1.3, 1.4, 1.7, 1.8, 3.0, 30.0, 100.0, 3000.0])
def test_virgin_curve_in_closed_form(d: float) -> None:
    """n = 1: y = 1 - exp(-u), w = u - y; n = 2: y = tanh u, w = log cosh u (u = d/2)."""
    u = d / 2.0
    log_cosh = u + math.log1p(math.exp(-2.0 * u)) - math.log(2.0)
    exponential = u + math.expm1(-u)
    if u < 1.0:  # where these lose digits
        log_cosh = math.log1p(2.0 * math.sinh(0.5 * u) ** 2)
        exponential = math.fsum((-u) ** j / math.factorial(j) for j in range(2, 30))
    for n, y, slope, w in (
        (1.0, -math.expm1(-u), math.exp(-u), exponential),
        (2.0, math.tanh(u), 1.0 / math.cosh(u) ** 2 if u < 300.0 else 0.0, log_cosh),
    ):
        for s in (1.0, -1.0):
            law = rule("BOUC_WEN", N=n, R=0.1, BETA=0.8)
            state = drive(law, law.start(), 0.0, s * d)
            force, tangent, _ = law.force(state, s * d)
            assert s * force == pytest.approx(d + 18.0 * y, rel=3e-15)
            assert tangent == pytest.approx(1.0 + 9.0 * slope, rel=3e-14)
            work = law.work(state, s * d)
            assert work == pytest.approx(0.5 * d * d + 36.0 * w, rel=3e-14, abs=0.0)


@pytest.mark.parametrize("beta", [0.5, 0.75, 1.0])
def test_branches_after_turns_in_closed_form(beta: float) -> None:
    """n = 1 turns at y0: y = (1 + y0 g) e^(-g u) / g - 1/g down to zero, with g = 2 beta - 1."""
    law, g = rule("BOUC_WEN", N=1.0, BETA=beta), 2.0 * beta - 1.0
    y0 = -math.expm1(-1.5)
    zero = y0 if g == 0.0 else math.log1p(g * y0) / g
    for u in (0.3 * zero, 0.7 * zero, 0.999 * zero):
        y = y0 - u if g == 0.0 else ((1.0 + g * y0) * math.exp(-g * u) - 1.0) / g
        assert forces(law, [3.0, 3.0 - 2.0 * u])[1] == pytest.approx(20.0 * y, rel=1e-12)
    for u in (0.1, 2.0, 20.0):  # beyond zero
        got = forces(law, [3.0, 3.0 - 2.0 * (zero + u)])[1]
        assert got == pytest.approx(20.0 * math.expm1(-u), rel=1e-13)


@pytest.mark.full
@pytest.mark.parametrize("n", [1.0, 1.5, 2.0, 3.7, 8.0, 25.0, 100.0])
@pytest.mark.parametrize("beta", [0.5, 0.6, 1.0])
def test_as_the_differential_equation(n: float, beta: float) -> None:
    """Force and work on a path with unequal sides, against an explicit method of order 8."""
    law, r = rule("BOUC_WEN", -14.0, N=n, BETA=beta, R=0.1), 0.1
    walk, y = Walk(law), np.zeros(2)  # z and the work
    for goal in (1.0, 0.5, 3.0, -1.0, -6.0, 2.0, 2.5, 2.4, 12.0, 11.9, 0.0, -0.3):
        start, way = walk.d, 1.0 if goal > walk.d else -1.0

        def rate(x: float, y: Any, start: float = start, way: float = way) -> list[float]:
            z = float(y[0])
            dy = 2.0 if z > 0.0 else 1.4
            outward = 1.0 - beta + beta * float(np.sign(z * way))
            return [
                way * (1.0 - abs(z / dy) ** n * outward),
                way * 10.0 * (r * (start + way * x) + (1.0 - r) * z),
            ]

        solved = solve_ivp(
            rate, (0.0, abs(goal - start)), y, "DOP853", rtol=1e-12, atol=1e-13, max_step=0.1
        )
        y = solved.y[:, -1]
        walk.move(goal)
        assert walk.force == pytest.approx(10.0 * (r * goal + (1.0 - r) * y[0]), abs=2e-10)  # 1e-11 of 20
        assert law.work(walk.state, goal) == pytest.approx(y[1], abs=1e-8)


@given(st.floats(1.0, 100.0), st.floats(0.5, 1.0), st.floats(1e-6, 60.0))
def test_series_and_their_inversion(n: float, beta: float, u: float) -> None:
    """y(u) put back into u(y), outwards and inwards; where it saturates, no more than 1 is asked."""
    p = rule("BOUC_WEN", N=n, BETA=beta).p
    y, slope, w = bouc_wen.outward_curve(p, u)
    if slope > 1e-5:
        again, work = bouc_wen.inverse_outward_curve(p, y)
        assert again == pytest.approx(u, rel=1e-13 / slope)
        assert work == pytest.approx(w, rel=1e-12 / slope)
    assert 0.0 < y <= 1.0 and slope == pytest.approx(1.0 - y**n, abs=2e-14)
    y, slope, w = bouc_wen.inward_curve(p, min(u, bouc_wen.inverse_inward_curve(p, 1.0)[0]))
    again, work = bouc_wen.inverse_inward_curve(p, y)
    assert again == pytest.approx(min(u, bouc_wen.inverse_inward_curve(p, 1.0)[0]), rel=1e-13)
    assert work == pytest.approx(w, rel=1e-12) and y <= 1.0 + 1e-13


def test_a_sharp_knee_is_the_bilinear_rule() -> None:
    path = [1.0, 5.0, 3.0, -2.0, -6.0, 4.0, 0.0]
    law, bilinear = rule("BOUC_WEN", N=100.0, R=0.1), rule("BILINEAR", R=0.1)
    a, b = Walk(law), Walk(bilinear)
    for goal in path:
        # at the corner itself the two differ by log(2) / n of the yield force
        assert a.move(goal).force == pytest.approx(b.move(goal).force, abs=0.01 * 20.0)
        assert law.dissipated(a.state, a.d) == pytest.approx(bilinear.dissipated(b.state, b.d), abs=1.0)


@pytest.mark.parametrize("beta", [0.5, 0.7, 1.0])
def test_what_is_stored_comes_back(beta: float) -> None:
    law = rule("BOUC_WEN", -14.0, N=1.6, BETA=beta, R=0.2)
    for goals in ([3.0], [-4.0], [3.0, 1.0], [8.0, 5.0], [20.0, 8.0], [2.0, -30.0, -20.0]):
        walk = Walk(law).move(*goals)
        stored, before, sign = law.stored(walk.state, walk.d), walk.work, math.copysign(1.0, walk.force)
        state = drive(law, walk.state, walk.d, walk.d - sign * 1e-9)  # turned
        gone = brentq(
            lambda d, state=state: law.force(state, d)[0], walk.d, walk.d - sign * 60.0, xtol=1e-13
        )
        assert before - walk.move(gone).work == pytest.approx(stored, rel=1e-9, abs=1e-9)


# uniaxialMaterial BoucWen of OpenSees 3.7.1 (openseespy), alpha 0.1, gamma + beta = 2^-n, Ao 1, driven in
# steps of 1e-3, 5e-4, 2.5e-4.  It is backward Euler: its errors, 3e-4 to 8e-4 with the last step, halve
# with the step.  Frozen are values extrapolated twice.
PATH = [1.0, 3.0, -1.0, -5.0, 2.0, 2.5, 1.5, 6.0, 0.0]
OPENSEES = {
    (1.0, 0.5): "8.082448 16.983657 -13.702465 -22.283057 18.580164 19.39423 9.39423 22.93486 -15.703934",
    (
        1.0,
        1.0,
    ): "8.082448 16.983657 -14.671483 -22.414199 18.930584 19.667138 4.829947 22.453788 -16.284647",
    (
        2.0,
        0.5,
    ): "9.318109 19.292669 -15.375558 -22.926335 19.761008 20.354665 10.354665 23.86432 -17.362013",
    (2.0, 0.7): "9.318109 19.292669 -15.882314 -22.937592 19.806694 20.382506 8.60853 23.827355 -17.48383",
    (5.0, 0.7): "9.95378 20.78377 -17.376293 -22.999911 19.998868 20.499676 9.515533 23.999442 -17.986225",
}


@pytest.mark.parametrize(("n", "beta"), OPENSEES)
def test_as_opensees(n: float, beta: float) -> None:
    got = forces(rule("BOUC_WEN", N=n, BETA=beta, R=0.1), PATH)
    assert got == pytest.approx(list(map(float, OPENSEES[n, beta].split())), abs=6e-7)


# ---------------------------------------------------------------------- Ramberg-Osgood


def sigma(u: float, n: float, alpha: float) -> float:
    return u + alpha * math.copysign(abs(u) ** n, u)


@given(st.floats(1.01, 60.0), st.floats(0.01, 20.0), st.floats(1e-3, 5.0))
def test_the_skeleton_keeps_its_equation(n: float, alpha: float, u: float) -> None:
    law = rule("RAMBERG_OSGOOD", N=n, ALPHA=alpha)
    d = 2.0 * sigma(u, n, alpha)
    for s in (1.0, -1.0):
        assert forces(law, [s * d])[0] == pytest.approx(20.0 * s * u, rel=1e-12)


@given(st.floats(1.2, 12.0), st.floats(0.05, 5.0), st.floats(0.2, 1.5), st.floats(0.0, 1.9))
def test_branches_keep_masings_equation(n: float, alpha: float, u0: float, w: float) -> None:
    """From (x0, u0) back by w u0: (x - x0)/2 = sigma((u - u0)/2); the loop is symmetric."""
    law = rule("RAMBERG_OSGOOD", N=n, ALPHA=alpha)
    x0 = sigma(u0, n, alpha)
    x = x0 - 2.0 * sigma(0.5 * w * u0, n, alpha)
    for s in (1.0, -1.0):
        got = forces(law, [s * 2.0 * x0, s * 2.0 * x, -s * 2.0 * x0, -s * 2.0 * x])
        assert got[1] == pytest.approx(20.0 * s * (u0 - w * u0), abs=1e-10 * u0)
        assert got[3] == pytest.approx(-20.0 * s * (u0 - w * u0), abs=1e-10 * u0)


@pytest.mark.parametrize(("n", "alpha", "u0"), [(1.5, 1.0, 2.0), (5.0, 0.4, 1.3), (9.0, 1.0, 1.1)])
def test_area_of_a_loop(n: float, alpha: float, u0: float) -> None:
    """4 (n - 1) / (n + 1) times force times plastic deformation (Masing's similarity)."""
    law, d = rule("RAMBERG_OSGOOD", N=n, ALPHA=alpha), 2.0 * sigma(u0, n, alpha)
    walk = Walk(law).move(d)
    before = law.work(walk.state, d)
    walk.move(-d, d)
    plastic = 2.0 * alpha * u0**n
    area = 4.0 * (n - 1.0) / (n + 1.0) * 20.0 * u0 * plastic
    assert law.work(walk.state, d) - before == pytest.approx(area, rel=1e-13)


def test_inner_loops_close_and_leave_no_trace() -> None:
    law = rule("RAMBERG_OSGOOD", N=5.0)
    for inner in ([2.0, 3.0], [2.0, 3.0, 2.5, 2.8], [2.0, 3.0, 2.5, 2.8, 2.6, 2.7], [-1.0, 1.0, 0.0, 0.5]):
        for after in ([-3.0], [-3.0, 6.0]):
            plain, looped = forces(law, [4.0, *after]), forces(law, [4.0, *inner, *after])
            assert looped[-len(after) :] == pytest.approx(plain[-len(after) :], rel=1e-13)


def test_coming_back_to_the_skeleton() -> None:
    law = rule("RAMBERG_OSGOOD", N=5.0)
    for path in ([4.0, 1.0, 20.0], [4.0, -2.0, 3.0, -20.0], [4.0, 3.999, 20.0]):
        assert forces(law, path)[-1] == pytest.approx(forces(law, path[-1:])[-1], rel=1e-14)


def decaying(count: int) -> list[float]:
    return [(-0.8) ** n * 8.0 for n in range(count)]


def test_reversals_beyond_the_memory() -> None:
    """Forgotten ones are in the middle: the inner loops and the outermost are as they were."""
    law, deep = rule("RAMBERG_OSGOOD", N=5.0), int(ramberg_osgood.DEPTH)
    walk = Walk(law).move(*decaying(deep))
    assert walk.state[3][0] == deep - 1  # the last is still under way
    walk.move(*decaying(deep + 4)[deep:])
    assert walk.state[3][:2] == (deep - 1.0, 1.0)
    # the last loops close where they were left
    path = decaying(deep + 4)
    got = forces(law, path)
    assert forces(law, [*path, path[-2]])[-1] == pytest.approx(got[-2], rel=1e-13)
    assert forces(law, [*path, path[-2], path[-3]])[-1] == pytest.approx(got[-3], rel=1e-13)
    # and from the outermost on, everything is forgotten
    for far in (8.0, -8.0, 9.0, -9.0, 30.0):
        expected = forces(law, [8.0, -8.0, far] if far > -9.0 else [far])[-1]
        assert forces(law, [*path, far])[-1] == pytest.approx(expected, rel=1e-12)


@settings(max_examples=100)
@given(st.lists(st.floats(-9.0, 9.0), min_size=1, max_size=40))
def test_any_history_stays_inside_the_outermost_loop(path: list[float]) -> None:
    """Between the branches from the largest deformation so far and from its mirror image."""
    law, largest, lost = rule("RAMBERG_OSGOOD", N=6.0), 0.0, 0.0
    state, d = law.start(), 0.0
    for goal in path:
        state, d = drive(law, state, d, goal), goal
        largest = max(largest, abs(goal))
        low, high = (forces(law, [s * largest, goal])[-1] for s in (1.0, -1.0))
        assert low - 1e-9 <= law.force(state, d)[0] <= high + 1e-9
        now = law.dissipated(state, d)
        if state[3][1] == 0.0:  # forgetting changes what comes back
            assert now >= lost - 1e-9
        lost = now


def test_unequal_sides_are_refused() -> None:
    with pytest.raises(ValueError, match="same yield force on both sides"):
        rule("RAMBERG_OSGOOD", -10.0, N=5.0)
    for name, values in (("BOUC_WEN", {"N": 2.0}), ("RAMBERG_OSGOOD", {"N": 5.0})):
        with pytest.raises(ValueError, match="both sides"):
            rule(name, 0.0, **values)


# ---------------------------------------------------------------------- Menegotto-Pinto


@given(st.floats(1.2, 60.0), st.floats(1e-3, 300.0))
def test_area_below_the_knee(n: float, x: float) -> None:
    """By quadrature; its slope by the difference of values."""
    pieces = [min(x, at) for at in (0.0, 0.7, 0.9, 0.97, 1.0, 1.03, 1.1, 1.4, 2.0, 5.0, 20.0, x)]
    parts = [
        quad(lambda t: menegotto_pinto.knee(n, t)[0], a, b, epsabs=0.0, epsrel=1e-12, limit=200)[0]
        for a, b in pairwise(pieces)
        if b > a
    ]
    assert menegotto_pinto.area(n, x) == pytest.approx(math.fsum(parts), rel=1e-10)
    h = 1e-5 * x
    value, slope = menegotto_pinto.knee(n, x)
    assert value == pytest.approx((x**-n + 1.0) ** (-1.0 / n), rel=1e-13)
    difference = menegotto_pinto.knee(n, x + h)[0] - menegotto_pinto.knee(n, x - h)[0]
    assert slope == pytest.approx(difference / (2.0 * h), rel=1e-6, abs=1e-9)


def test_a_half_cycle_leaves_along_the_elastic_line_and_comes_to_the_yield_line() -> None:
    law = rule("MENEGOTTO_PINTO", -12.0, R=0.05)
    walk = Walk(law).move(8.0)
    assert walk.force == pytest.approx(20.0 + 0.5 * 6.0, abs=1e-6)
    turned = walk.force
    assert walk.move(8.0 - 1e-4).force == pytest.approx(turned - 1e-3, abs=1e-6)
    # the yield line of the other side, -12 at -1.2; the knee is rounder than the virgin one
    far = Walk(law).move(8.0, -4000.0)
    assert far.force == pytest.approx(-12.0 - 0.5 * (4000.0 - 1.2), abs=0.02)
    assert 0.01 < 12.0 + 0.5 * 2.8 + Walk(law).move(8.0, -4.0).force < 2.0


# uniaxialMaterial Steel02 of OpenSees 3.7.1 (openseespy), Fy 20, E 10; b, R0, cR1, cR2, a1 to a4
STEEL_PATH = [1.0, 3.0, -1.0, -5.0, 2.0, 2.5, 1.5, 6.0, 0.0, -8.0, 12.0]
STEEL02 = {
    (0.05, 20.0, 0.925, 0.15, 0.0, 1.0, 0.0, 1.0): (
        "9.999999547004926 20.499714352869717 -15.198162483908604 -21.38050931900743 17.512678626904574 "
        "18.153804197420634 8.224404440172476 21.999999392436234 -13.744806488496895 -22.049612804307092 "
        "24.361434357841052"
    ),
    (0.02, 5.0, 0.5, 0.3, 0.0, 1.0, 0.0, 1.0): (
        "9.939872760283361 19.721008181121313 -12.869852905560187 -19.631246773403625 17.686769358536417 "
        "18.15730232034295 8.23275969756515 20.788733204493035 -15.621932923209997 -20.71653029910442 "
        "21.79958277236441"
    ),
    (0.05, 20.0, 0.925, 0.15, 0.04, 1.0, 0.02, 2.0): (
        "9.999999547004926 20.499714352869717 -15.812145322873775 -22.302886812600526 17.67932958058914 "
        "18.357070309120253 8.413965292001336 22.379999534876056 -14.713218508310682 -23.622804778992865 "
        "24.856258832692554"
    ),
}


@pytest.mark.parametrize("parameters", STEEL02)
def test_as_steel02(parameters: tuple[float, ...]) -> None:
    names = ("R", "R0", "CR1", "CR2", "A1", "A2", "A3", "A4")
    law = rule("MENEGOTTO_PINTO", **dict(zip(names, parameters)))
    got = forces(law, STEEL_PATH)
    assert got == pytest.approx(list(map(float, STEEL02[parameters].split())), rel=1e-13)
    # a start in the other direction
    assert forces(law, [-1.9])[0] == pytest.approx(-forces(law, [1.9])[0], rel=1e-14)


def test_menegotto_pinto_keeps_the_contract_with_isotropic_hardening() -> None:
    """All but one clause: inside another half cycle the force drifts up, and with it what is stored."""
    law = rule("MENEGOTTO_PINTO", R=0.02, A1=0.1, A2=1.5, A3=0.05, A4=2.0)
    for clause in contract.CLAUSES:
        if clause is not contract.closed_loops_dissipate:
            clause(law, 12.0)


@pytest.mark.parametrize(
    ("values", "says"),
    [({"R0": 10.0, "CR1": 0.925}, "the roundest knee"), ({"R": -0.1}, "from 0 to below 1")],
)
def test_what_menegotto_pinto_refuses(values: dict[str, float], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        rule("MENEGOTTO_PINTO", **values)


@pytest.mark.parametrize("method", ["NEWMARK DT=0.002", "AUTO"])
def test_an_oscillator_of_menegotto_pinto_steel(method: str) -> None:
    """Beside DOP853 from reversal to reversal, by forces that were written anew."""
    deck = f"""
NODES
 1 0 0 FIX=XYR
 2 0 0 FIX=YR
ELEMENTS
 7 S 1 2
PROPS
 S SPRING KX=1000 FX=20 RULE=MENEGOTTO_PINTO R=0.05
WEIGHTS
 2 98.1
INITIAL
 2 VX=1.5
OUTPUT
 EVERY=0.02
ANALYSIS
 HISTORY 1 METHOD={method}
END
"""
    run = run_text(deck)
    assert run.status == "done"
    (row,) = run.tables["spring_envelope"]
    low, high = free_steel(1000.0, 20.0, 0.05, mass=10.0, v=1.5, end=1.0)
    assert (row["deformation_min"], row["deformation_max"]) == pytest.approx((low, high), rel=2e-4)


def free_steel(k: float, fy: float, b: float, mass: float, v: float, end: float) -> tuple[float, float]:
    """Extremes of a free vibration, each half cycle solved by itself."""
    dy = fy / k
    turn, force, high, low, s = 0.0, 0.0, dy, -dy, 1.0
    t, state, seen = 0.0, [0.0, v], [0.0]
    while t < end:
        meets = turn + (s * (1.0 - b) * fy + b * k * turn - force) / (k * (1.0 - b))
        eta = abs((high if s > 0 else low) - meets) / dy
        n = 20.0 * (1.0 - 0.925 * eta / (0.15 + eta))

        def pull(d, turn=turn, force=force, meets=meets, n=n):
            x = abs(d - turn) / abs(meets - turn)
            return force + k * (meets - turn) * (b * x + (1.0 - b) * x * (1.0 + x**n) ** (-1.0 / n))

        def still(_, y):
            return y[1]

        still.terminal, still.direction = True, -s
        way = solve_ivp(
            lambda _, y, pull=pull: [y[1], -pull(y[0]) / mass],
            *((t, end), state),
            method="DOP853",
            events=still,
            rtol=1e-10,
            atol=1e-12,
        )
        t, state = float(way.t[-1]), [float(way.y[0, -1]), 0.0]
        turn, force = state[0], pull(state[0])
        seen.append(turn)
        high, low, s = max(high, turn), min(low, turn), -s
    return min(seen), max(seen)
