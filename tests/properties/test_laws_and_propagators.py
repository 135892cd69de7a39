"""Properties of the exact integrator's parts that hold for any input (hypothesis finds the inputs)."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from paths import Walk
from pound_solve.integrate.closed_form.decomposition import make_propagator
from pound_solve.integrate.closed_form.work_integrals import WorkIntegrals
from pound_solve.laws.automaton import BranchKind, Law, drive
from pound_solve.laws.contact import kelvin_voigt
from pound_solve.laws.hysteresis import bilinear, bilinear_slack
from pound_solve.laws.hysteresis.slack_growing import growing_slack
from pound_solve.numerics import polynomial
from pound_solve.numerics.types import Array

forces = st.floats(0.5, 50.0)
paths = st.lists(st.floats(-10.0, 10.0), min_size=1, max_size=12)
ratios = st.floats(-0.5, 0.95)
hardening = st.floats(0.0, 0.95)


@st.composite
def rules(draw: st.DrawFn) -> Law:
    k, plus, minus = draw(st.floats(1.0, 100.0)), draw(forces), -draw(forces)
    if draw(st.booleans()):
        return Law(bilinear.RULE, (k, plus, minus, draw(ratios)))
    gap = draw(st.floats(0.0, 2.0)), -draw(st.floats(0.0, 2.0))
    if draw(st.booleans()):
        return growing_slack(k, (plus, minus), gap, draw(hardening))
    return Law(bilinear_slack.RULE, (k, plus, minus, *gap, draw(hardening)))


def gross(law: Law, walk: Walk) -> float:
    """Size of the work done, for tolerances."""
    forces = [abs(law.force(state, d)[0]) for state, *ends in walk.visits for d in ends]
    return 1.0 + max(forces) * sum(abs(b - a) for _, a, b in walk.visits)


@given(rules(), paths)
def test_work_in_is_stored_or_lost(law: Law, path: list[float]) -> None:
    walk = Walk(law).move(*path)
    stored, lost = law.stored(walk.state, walk.d), law.dissipated(walk.state, walk.d)
    assert stored >= 0.0
    assert abs(walk.work - stored - lost) < 1e-10 * gross(law, walk)


@given(rules(), paths)
def test_the_loss_falls_only_where_a_spring_yields_back(law: Law, path: list[float]) -> None:
    """Along a yield line 1 - r of the work is lost; given back where the force opposes the motion."""
    walk = Walk(law).move(*path)
    size = gross(law, walk)
    for state, a, b in walk.visits:
        change = law.dissipated(state, b) - law.dissipated(state, a)
        if law.branch(state).kind is not BranchKind.YIELDING:
            assert abs(change) < 1e-10 * size
        elif law.force(state, a)[0] * (b - a) >= 0.0 and law.force(state, b)[0] * (b - a) >= 0.0:
            assert change > -1e-10 * size


@given(rules(), paths)
def test_closed_loops_never_give_energy(law: Law, path: list[float]) -> None:
    """However it began: once a loop has closed on itself, work goes in."""
    # two rounds settle the loop, the third is judged
    once = [*path, 0.0]
    two, three = Walk(law).move(*once * 2), Walk(law).move(*once * 3)
    gain = (two.work - law.stored(two.state, 0.0)) - (three.work - law.stored(three.state, 0.0))
    assert gain < 1e-10 * gross(law, three)


@given(rules(), paths, st.floats(0.0, 1.0))
def test_stopping_on_the_way_changes_nothing(law: Law, path: list[float], share: float) -> None:
    whole, broken, d = law.start(), law.start(), 0.0
    for goal in path:
        between = d + share * (goal - d)
        whole = drive(law, whole, d, goal)
        broken = drive(law, drive(law, broken, d, between), between, goal)
        d = goal
        f = law.branch(whole).force(d, 0.0), law.branch(broken).force(d, 0.0)
        size = 1.0 + abs(f[0]) + abs(law.branch(whole).stiffness) * 10.0
        assert abs(f[0] - f[1]) < 1e-9 * size
        assert abs(law.dissipated(whole, d) - law.dissipated(broken, d)) < 1e-9 * size * 20.0


@given(
    st.floats(1.0, 1e6),
    st.floats(0.0, 1e3),
    st.floats(-0.1, 0.1),
    st.floats(-1.0, 1.0),
    st.floats(-5.0, 5.0),
)
def test_a_pressed_contact_without_tension_only_pushes(
    k: float, c: float, gap: float, d: float, v: float
) -> None:
    law = Law(kelvin_voigt.RULE, (k, c, gap))
    branch = law.branch((kelvin_voigt.PRESSED, 0.0, 0.0, ()))
    held = all(e.on_d * d + e.on_v * v + e.constant <= 0.0 for e in branch.events)
    size = k * (abs(d) + abs(gap)) + c * abs(v)
    assert not held or branch.force(d, v) >= -1e-15 * size


active = st.integers(0, 2**32 - 1)


def random_block(seed: int) -> tuple[Array, Array, Array, int]:
    """Mass, damping and stiffness of up to five masses, some with rigid bodies, some without damping."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 6))
    rank = int(rng.integers(0, n + 1))
    x = rng.normal(size=(n, rank))
    y = rng.normal(size=(n, int(rng.integers(0, n + 1))))
    m = np.diag(10.0 ** rng.uniform(-2.0, 2.0, n))
    return m, 0.2 * y @ y.T, 10.0 ** rng.uniform(0.0, 3.0) * x @ x.T, n


@given(active, st.floats(0.01, 3.0), st.floats(0.01, 3.0))
def test_two_intervals_are_one(seed: int, first: float, second: float) -> None:
    m, c, k, n = random_block(seed)
    rng = np.random.default_rng(seed + 1)
    propagator = make_propagator(m, c, k, np.eye(n))
    u, v, p = rng.normal(size=n), rng.normal(size=n), rng.normal(size=(3, n))
    q, g = propagator.state_of(u, v), propagator.load_forcing(p)
    middle = propagator.at(q, g, first)
    again = propagator.state_of((propagator.u_q @ middle).real, (propagator.v_q @ middle).real)
    end = propagator.at(again, propagator.load_forcing(polynomial.shift(p, first)), second)
    direct = propagator.at(q, g, first + second)
    for row in (propagator.u_q, propagator.v_q):
        a, b = (row @ end).real, (row @ direct).real
        assert np.abs(a - b).max() < 1e-8 * (1.0 + np.abs(b).max() + np.abs((row @ middle).real).max())


@given(active, st.floats(1e-6, 4.0))
def test_energy_balances(seed: int, tau: float) -> None:
    m, c, k, n = random_block(seed)
    rng = np.random.default_rng(seed + 1)
    propagator = make_propagator(m, c, k, np.eye(n))
    u, v, p = rng.normal(size=n), rng.normal(size=n), rng.normal(size=(2, n))
    q, g = propagator.state_of(u, v), propagator.load_forcing(p)
    work_integrals = WorkIntegrals(propagator, c, np.eye(n), [])
    found = work_integrals.over_intervals(q[:, None], g[None], np.array([tau]), p[None], np.zeros(n))
    energies = []
    for at in (q, propagator.at(q, g, tau)):
        x, y = (propagator.u_q @ at).real, (propagator.v_q @ at).real
        energies.append(float(0.5 * y @ m @ y + 0.5 * x @ k @ x))
    gross = sum(energies) + found.damping + abs(found.input) + float(np.abs(p[0]) @ np.abs(v)) * tau
    assert found.damping >= -1e-12 * gross
    assert abs(found.input - found.damping - energies[1] + energies[0]) < 1e-9 * gross
