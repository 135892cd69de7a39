"""Propagators: exact motion of subsystems, against the matrix exponential with their forcing."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm

from pound_solve.integrate.closed_form.decomposition import make_propagator
from pound_solve.integrate.propagators.base import gauss
from pound_solve.integrate.propagators.modal import ModalPropagator
from pound_solve.integrate.propagators.series import SeriesPropagator
from pound_solve.integrate.propagators.state_space import Mechanism, state_space
from pound_solve.numerics import polynomial
from pound_solve.numerics.types import Array

Subsystem = tuple[Array, Array, Array]


def chain(stiffness: list[float]) -> Array:
    """Stiffness of masses in a row, the first one held by the first spring."""
    n = len(stiffness)
    rows = np.eye(n) - np.eye(n, k=-1)
    return np.asarray(rows.T @ np.diag(stiffness) @ rows)


def subsystem(kind: str, n: int = 4, seed: int = 0) -> Subsystem:
    """Random mass, damping and stiffness of one kind."""
    rng = np.random.default_rng([seed, sum(map(ord, kind))])
    x, y = rng.normal(size=(2, n, n))
    m, c, k = np.diag(rng.uniform(0.5, 2.0, n)), 0.1 * y @ y.T, x @ x.T + 0.2 * np.eye(n)
    free = chain([0.0, *rng.uniform(1.0, 5.0, n - 1)])
    if kind == "overdamped":
        c = 100.0 * c
    elif kind == "undamped":
        c = 0.0 * c
    elif kind == "consistent mass":
        m = m + 0.3 * (np.eye(n, k=1) + np.eye(n, k=-1))
    elif kind == "rigid body":
        k, c = free, 0.01 * free
    elif kind == "rigid body, mass damping":
        k, c = free, 0.01 * free + 0.1 * m
    elif kind == "several rigid bodies":
        k = 1e3 * x[:, : n - 2] @ x[:, : n - 2].T
    elif kind == "no stiffness":
        k = 0.0 * k
    elif kind == "free masses":
        k, c = 0.0 * k, 0.0 * c
    elif kind == "free masses, one dashpot":
        row = np.eye(n)[0] - np.eye(n)[-1]
        k, c = 0.0 * k, 0.7 * np.outer(row, row)
    elif kind == "negative stiffness":
        k = k - np.diag([3.0] + [0.0] * (n - 1))
    elif kind == "repeated frequencies":
        m, k = np.eye(n), 4.0 * np.eye(n)
    elif kind == "repeated, undamped":
        m, c, k = np.eye(n), 0.0 * c, 4.0 * np.eye(n)
    elif kind == "critically damped":
        # one mode of a damped pair, turned into the others so that rounding hides it
        k = np.diag(rng.uniform(1.0, 9.0, n))
        c = np.diag(np.r_[2.0, np.full(n - 1, 0.1)] * np.sqrt(np.diag(k)))
        turn = np.linalg.qr(x)[0]
        m, c, k = np.eye(n), turn @ c @ turn.T, turn @ k @ turn.T
    return m, c, k


KINDS = (
    "damped",
    "overdamped",
    "undamped",
    "consistent mass",
    "rigid body",
    "rigid body, mass damping",
    "several rigid bodies",
    "no stiffness",
    "free masses",
    "free masses, one dashpot",
    "negative stiffness",
    "repeated frequencies",
    "repeated, undamped",
    "critically damped",
)


def reference(m: Array, c: Array, k: Array, p: Array, u: Array, v: Array, t: float) -> tuple[Array, Array]:
    """Displacement and velocity at `t` under force polynomials `p`: exponential of (u, v, 1, t, ...)."""
    n, count = len(m), len(p)
    inverse = np.linalg.inv(m)
    a = np.zeros((2 * n + count, 2 * n + count))
    a[:n, n : 2 * n] = np.eye(n)
    a[n : 2 * n, :n], a[n : 2 * n, n : 2 * n] = -inverse @ k, -inverse @ c
    a[n : 2 * n, 2 * n :] = inverse @ p.T
    for j in range(1, count):
        a[2 * n + j, 2 * n + j - 1] = j
    y = expm(a * t) @ np.concatenate([u, v, [1.0], np.zeros(count - 1)])
    return y[:n], y[n : 2 * n]


def motion(
    propagator: ModalPropagator | SeriesPropagator, q: NDArray, g: NDArray, t: float
) -> tuple[Array, Array]:  # type: ignore[type-arg]
    at = propagator.at(q, g, t)
    return (propagator.u_q @ at).real, (propagator.v_q @ at).real


def apart(x: tuple[Array, Array], y: tuple[Array, Array]) -> float:
    """Largest difference, each of displacement and velocity against its largest entry."""
    return max(float(np.abs(a - b).max() / np.abs(b).max()) for a, b in zip(x, y))


def loads(n: int, degree: int, seed: int = 0) -> tuple[Array, Array, Array, Array, Array, Array]:
    """Inputs, their coefficients, constant load, the force polynomials of both, and a start (u, v)."""
    rng = np.random.default_rng([7, seed, degree])
    inputs, coefs, constant = rng.normal(size=(n, 2)), rng.normal(size=(degree + 1, 2)), rng.normal(size=n)
    p = coefs @ inputs.T
    p[0] += constant
    return inputs, coefs, constant, p, *rng.normal(size=(2, n))


@pytest.mark.parametrize("degree", [0, 1, 3, 10])
@pytest.mark.parametrize("kind", KINDS)
def test_both_propagators_against_the_matrix_exponential(kind: str, degree: int) -> None:
    # measured: 3e-14 at worst
    for seed in range(3):
        m, c, k = subsystem(kind, seed=seed)
        inputs, coefs, constant, p, u, v = loads(4, degree, seed)
        for propagator in (
            make_propagator(m, c, k, inputs),
            SeriesPropagator(state_space(m, c, k), inputs),
        ):
            q, g = propagator.state_of(u, v), propagator.forcing(coefs, constant)
            found, expected = motion(propagator, q, g, 1.3), reference(m, c, k, p, u, v, 1.3)
            # without stiffness the slowest random decay leaves a condition of 1e5
            assert apart(found, expected) < (1e-11 if kind == "no stiffness" else 5e-13)
            assert np.allclose(g, propagator.load_forcing(p), rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("kind", KINDS)
def test_enter_and_read_back(kind: str) -> None:
    m, c, k = subsystem(kind)
    inputs, *_, u, v = loads(4, 0)
    for propagator in (make_propagator(m, c, k, inputs), SeriesPropagator(state_space(m, c, k), inputs)):
        q = propagator.state_of(u, v)
        assert apart(((propagator.u_q @ q).real, (propagator.v_q @ q).real), (u, v)) < 1e-12


@pytest.mark.parametrize("kind", KINDS)
def test_state_space_is_the_same_system(kind: str) -> None:
    for seed in range(5):
        m, c, k = subsystem(kind, seed=seed)
        n, space = len(m), state_space(m, c, k)
        to, back = np.vstack([space.u_z, space.v_z]), np.hstack([space.z_u, space.z_v])
        assert np.abs(back @ to - np.eye(2 * n)).max() < 1e-13
        force, none = np.linalg.inv(m), np.zeros((n, n))
        whole = np.block([[none, np.eye(n)], [-force @ k, -force @ c]])
        assert np.abs(to @ space.a @ back - whole).max() < 1e-13 * np.abs(whole).max()
        assert np.abs(to @ space.b - np.vstack([none, force])).max() < 1e-13


@pytest.mark.full
@pytest.mark.parametrize("degree", [0, 1, 4])
@pytest.mark.parametrize("kind", KINDS)
def test_samples_steps_and_rates_agree_with_single_times(kind: str, degree: int) -> None:
    m, c, k = subsystem(kind)
    inputs, coefs, constant, _, u, v = loads(4, degree)
    for propagator in (make_propagator(m, c, k, inputs), SeriesPropagator(state_space(m, c, k), inputs)):
        q, g = propagator.state_of(u, v), propagator.forcing(coefs, constant)
        times = 0.125 * np.arange(9)
        single = np.stack([propagator.at(q, g, float(t)) for t in times], axis=1)
        scale = np.abs(single).max()
        assert (
            np.abs(propagator.samples(q[:, None], g[None], 0.125, 9)[:, 0] - single).max() < 1e-13 * scale
        )
        assert np.abs(propagator.trajectory(q, g, times) - single).max() < 1e-13 * scale
        # successive intervals, the forcing of each about its own start
        gs = np.stack([polynomial.shift(g, float(t)) for t in times[:-1]])
        marched = propagator.march(q, gs, np.full(len(gs), 0.125))
        assert np.abs(marched - single).max() < 1e-12 * scale
        several = propagator.samples(marched[:, :-1], gs, 0.0625, 2)
        assert np.abs(several[:, :, 0] - single[:, :-1]).max() < 1e-12 * scale
        # the rate is the derivative: Richardson's difference of the motion itself
        h = 1e-3
        d = [
            (propagator.at(q, g, 0.5 + s * h) - propagator.at(q, g, 0.5 - s * h)) / (2 * s * h)
            for s in (1, 2)
        ]
        slope = propagator.rate_rows(np.eye(len(q), dtype=q.dtype)) @ propagator.at(
            q, g, 0.5
        ) + polynomial.value(g, 0.5)
        speed = np.abs(slope).max() * max(1.0, propagator.spectral_radius) ** 4
        assert np.abs((4 * d[0] - d[1]) / 3 - slope).max() < 1e-10 * speed


def test_more_samples_than_before_of_one_spacing() -> None:
    """Responses are kept for a spacing of samples, 16 of them or more: a longer row takes new ones."""
    inputs, coefs, constant, _, u, v = loads(4, 1)
    propagator = make_propagator(*subsystem("damped"), inputs)
    q, g = propagator.state_of(u, v), propagator.forcing(coefs, constant)
    for count in (3, 20, 7):
        single = np.stack([propagator.at(q, g, 0.125 * i) for i in range(count)], axis=1)
        found = propagator.samples(q[:, None], g[None], 0.125, count)[:, 0]
        assert found.shape == single.shape
        assert np.abs(found - single).max() < 1e-13 * np.abs(single).max()


@pytest.mark.full
@pytest.mark.parametrize("degree", [0, 1, 4])
@pytest.mark.parametrize("kind", KINDS)
def test_bounds_of_the_derivatives(kind: str, degree: int) -> None:
    for seed in range(4):
        inputs, coefs, constant, _, u, v = loads(4, degree, seed)
        m, c, k = subsystem(kind, seed=seed)
        propagator = make_propagator(m, c, k, inputs)
        q, g = propagator.state_of(u, v), propagator.forcing(coefs, constant)
        rate_rows = propagator.rate_rows(np.eye(len(q), dtype=q.dtype))
        lengths = np.array([0.3, 1.1])
        bounds = propagator.derivative_bounds(np.stack([q, q], axis=1), np.stack([g, g]), lengths)
        if isinstance(propagator, SeriesPropagator):
            assert np.isinf(bounds).all()
            continue
        for n, length in enumerate(lengths.tolist()):
            for t in np.linspace(0.0, length, 23).tolist():
                rate = rate_rows @ propagator.at(q, g, t) + polynomial.value(g, t)
                second = rate_rows @ rate + polynomial.value(g, t, 1)
                third = rate_rows @ second + polynomial.value(g, t, 2)
                for found, most in zip((second, third), bounds[:, :, n]):
                    assert (np.abs(found) <= most * (1 + 1e-9) + 1e-9 * np.abs(found).max()).all()
                    if t == 0.0 and degree == 1 and kind == "damped":  # no larger than it need be
                        assert np.allclose(np.abs(found), most, rtol=1e-9)


@pytest.mark.full
@pytest.mark.parametrize("degree", [0, 1, 4])
@pytest.mark.parametrize("kind", KINDS)
def test_integral_of_the_motion(kind: str, degree: int) -> None:
    m, c, k = subsystem(kind)
    inputs, coefs, constant, _, u, v = loads(4, degree)
    x, w = np.polynomial.legendre.leggauss(20)
    for propagator in (make_propagator(m, c, k, inputs), SeriesPropagator(state_space(m, c, k), inputs)):
        q, g = propagator.state_of(u, v), propagator.forcing(coefs, constant)
        cells = int(np.ceil(1.3 * propagator.spectral_radius)) + 1
        width = 1.3 / cells
        points = (width * (np.arange(cells)[:, None] + 0.5 + 0.5 * x)).ravel()
        expected = propagator.trajectory(q, g, points) @ np.tile(0.5 * width * w, cells)
        assert np.abs(propagator.integral(q, g, 1.3) - expected).max() < 1e-12 * np.abs(expected).max()


def test_series_where_the_modes_are_defective() -> None:
    chosen = {kind: type(make_propagator(*subsystem(kind), np.eye(4))) for kind in KINDS}
    assert chosen.pop("critically damped") is SeriesPropagator
    assert set(chosen.values()) == {ModalPropagator}


def test_critically_damped_closed_form() -> None:
    # u = (u0 + (v0 + w u0) t) exp(-w t) with w = 3
    propagator = make_propagator(np.eye(1), np.array([[6.0]]), np.array([[9.0]]), np.eye(1))
    assert isinstance(propagator, SeriesPropagator)
    u, v = motion(propagator, propagator.state_of(np.array([0.4]), np.array([-2.0])), np.zeros((1, 2)), 0.7)
    fall, b = np.exp(-2.1), -2.0 + 3.0 * 0.4
    assert u[0] == pytest.approx((0.4 + b * 0.7) * fall, rel=1e-13)
    assert v[0] == pytest.approx((b - 3.0 * (0.4 + b * 0.7)) * fall, rel=1e-13)


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("off", [1e-3, 1e-6, 1e-9, 1e-12, 1e-15])
def test_nearly_critical_damping(off: float, side: int) -> None:
    """A mode within `off` of critical, turned into two others: the condition costs no more than itself."""
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    k, xi = np.array([9.0, 4.0, 1.0]), 1.0 + side * off
    c = np.array([2.0 * xi * 3.0, 0.2, 0.1])
    p = np.array([[0.3, -0.2, 0.1], [1.0, 0.5, -0.4]])
    u, v = np.array([0.4, 1.0, -0.3]), np.array([-2.0, 0.5, 0.1])
    rotated = (np.eye(3), turn @ np.diag(c) @ turn.T, turn @ np.diag(k) @ turn.T)
    propagator = make_propagator(*rotated, np.eye(3))
    found = motion(
        propagator, propagator.state_of(turn @ u, turn @ v), propagator.load_forcing(p @ turn.T), 0.7
    )
    expected = reference(np.eye(3), np.diag(c), np.diag(k), p, u, v, 0.7)
    # the solution itself is smooth in the damping: the exponential has no trouble here
    assert apart(found, (turn @ expected[0], turn @ expected[1])) < 1e-10
    if isinstance(propagator, ModalPropagator) and side < 0:
        assert apart(found, (turn @ expected[0], turn @ expected[1])) < 1e-13


@pytest.mark.parametrize("ratio", [1e-3, 1e-6, 1e-9, 1e-12])
def test_light_mass_beside_heavy_ones(ratio: float) -> None:
    """Two heavy masses with a light one between: the slow motion keeps its digits.

    By symmetry the masses 1 at the ends of two springs 1, held outside by springs 1, move against
    each other with the light mass still: omega^2 = 2, whatever the light mass.
    """
    m, k = np.diag([1.0, ratio, 1.0]), np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 2.0]])
    propagator = make_propagator(m, np.zeros((3, 3)), k, np.eye(3))
    u, _ = motion(
        propagator,
        propagator.state_of(np.array([1.0, 0.0, -1.0]), np.zeros(3)),
        np.zeros((1, len(propagator.eigenvalues))),
        40.0,
    )
    expected = np.array([1.0, 0.0, -1.0]) * np.cos(np.sqrt(2.0) * 40.0)
    assert np.abs(u - expected).max() < 1e-12
    # in the other slow mode the light mass takes part: omega^2 is the small root of
    # r w^2 - 2 (1 + r) w + 2 = 0 (written without cancellation), shape (1, 2 - w, 1)
    w = 2.0 / ((1.0 + ratio) + np.sqrt(1.0 + ratio * ratio))
    shape = np.array([1.0, 2.0 - w, 1.0])
    u, _ = motion(
        propagator,
        propagator.state_of(shape, np.zeros(3)),
        np.zeros((1, len(propagator.eigenvalues))),
        40.0,
    )
    assert np.abs(u - shape * np.cos(np.sqrt(w) * 40.0)).max() < 1e-11


@pytest.mark.parametrize("pairs", [0, 1, 2])
@pytest.mark.parametrize("loose", [1, 2, 3])
def test_masses_that_nothing_holds_beside_bodies_that_move_as_one(loose: int, pairs: int) -> None:
    """Storeys that yield: some masses without any stiffness, some joined in pairs, others held.

    All their motions without stiffness are rigid-body modes, however the shapes are mixed.
    """
    n = loose + 2 * pairs + 3
    k = np.zeros((n, n))
    for first in range(loose, loose + 2 * pairs, 2):
        k[first : first + 2, first : first + 2] = 4e5 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    k[-3:, -3:] = chain([4e5, 2e6, 2.5e5])
    shuffle = np.random.default_rng(7).permutation(n)
    k, m = k[np.ix_(shuffle, shuffle)], 203.873 * np.eye(n)
    c = 0.5 * m + 1e-3 * k
    propagator = make_propagator(m, c, k, np.eye(n))
    assert isinstance(propagator, ModalPropagator)
    assert np.sum(np.abs(propagator.eigenvalues) < 1e-12 * propagator.spectral_radius) == loose + pairs
    assert (
        np.abs(propagator.rate_rows(propagator.u_q) - propagator.v_q).max()
        < 1e-12 * propagator.spectral_radius * np.abs(propagator.u_q).max()
    )
    assert np.abs(propagator.u_q).max() < 1.0
    v = np.linspace(1.0, 2.0, n)
    q = propagator.state_of(np.zeros(n), v)
    found = motion(propagator, q, np.zeros((1, len(propagator.eigenvalues))), 0.5)
    whole = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(m, k), -np.linalg.solve(m, c)]])
    expected = (expm(0.5 * whole) @ np.r_[np.zeros(n), v]).reshape(2, n)
    assert apart(found, (expected[0], expected[1])) < 1e-11


@pytest.mark.parametrize("decay", [1e-2, 1e-4, 1e-6, 1e-8])
def test_hardly_damped_rigid_body(decay: float) -> None:
    """A free mass, u'' + decay u' = 1: modes cancel to eps / decay, so the series takes over."""
    propagator = make_propagator(np.eye(1), np.array([[decay]]), np.zeros((1, 1)), np.eye(1))
    t, zero = 1.5, np.zeros(1)
    # v = t - decay t^2 / 2 + ..., u = t^2 / 2 - decay t^3 / 6 + ...: series of (1 - exp(-decay t)) / decay
    v = sum((-decay) ** j * t ** (j + 1) / float(np.prod(np.arange(1, j + 2))) for j in range(12))
    u = sum((-decay) ** j * t ** (j + 2) / float(np.prod(np.arange(1, j + 3))) for j in range(12))
    found = motion(propagator, propagator.state_of(zero, zero), propagator.load_forcing(np.ones((1, 1))), t)
    assert found[0][0] == pytest.approx(u, rel=1e-9)
    assert found[1][0] == pytest.approx(v, rel=1e-12)


# ---------------------------------------------------------------------- massless DOFs


def massless(
    with_mass: int, damped: int, static: int, units: float, seed: int
) -> tuple[Array, Array, Array, NDArray[np.intp]]:
    """Random subsystem with massless DOFs, with and without dashpots, in mixed order, and that order."""
    rng = np.random.default_rng([seed, with_mass, damped, static])
    n = with_mass + damped + static
    x, y = rng.normal(size=(n, n)), np.zeros((n, n))
    y[: with_mass + damped] = rng.normal(size=(with_mass + damped, n))
    m = np.diag(np.r_[rng.uniform(0.5, 2.0, with_mass), np.zeros(damped + static)])
    order = rng.permutation(n)
    k = x @ x.T + 0.3 * np.eye(n)
    m, c, k = (units * a[np.ix_(order, order)] for a in (m, 0.3 * y @ y.T, k))
    return m, c, k, order


def eliminated(
    m: Array,
    c: Array,
    k: Array,
    p: Array,
    u: Array,
    v: Array,
    t: float,
    order: NDArray[np.intp],
    with_mass: int,
    damped: int,
) -> tuple[Array, Array]:
    """The same motion with the massless DOFs eliminated by hand."""
    where = np.argsort(order)
    h, d, s = where[:with_mass], where[with_mass : with_mass + damped], where[with_mass + damped :]
    x = np.r_[h, d]
    flex = np.linalg.inv(k[np.ix_(s, s)])
    carry = flex @ k[np.ix_(s, x)]  # u_s = flex p_s - carry u_x
    kx, cx = k[np.ix_(x, x)] - k[np.ix_(x, s)] @ carry, c[np.ix_(x, x)]
    px = p[:, x] - p[:, s] @ carry
    nh, count = len(h), len(p)
    size = 2 * nh + len(d)
    a = np.zeros((size + count, size + count))
    hu, hv, du, one = slice(0, nh), slice(nh, 2 * nh), slice(2 * nh, size), slice(size, size + count)
    a[hu, hv] = np.eye(nh)
    slack = np.linalg.inv(cx[nh:, nh:])
    a[du, hu], a[du, hv], a[du, du], a[du, one] = (
        -slack @ kx[nh:, :nh],
        -slack @ cx[nh:, :nh],
        -slack @ kx[nh:, nh:],
        slack @ px[:, nh:].T,
    )
    a[hv, hu], a[hv, hv], a[hv, du], a[hv, one] = -kx[:nh, :nh], -cx[:nh, :nh], -kx[:nh, nh:], px[:, :nh].T
    a[hv] -= cx[:nh, nh:] @ a[du]
    a[hv] = np.linalg.solve(m[np.ix_(h, h)], a[hv])
    for j in range(1, count):
        a[size + j, size + j - 1] = j
    y = expm(a * t) @ np.concatenate([u[h], v[h], u[d], [1.0], np.zeros(count - 1)])
    rate = a @ y
    out_u, out_v = np.zeros(len(m)), np.zeros(len(m))
    out_u[h], out_v[h], out_u[d], out_v[d] = y[hu], y[hv], y[du], rate[du]
    force, change = polynomial.value(p, t), polynomial.value(p, t, 1)
    out_u[s], out_v[s] = flex @ force[s] - carry @ out_u[x], flex @ change[s] - carry @ out_v[x]
    return out_u, out_v


@pytest.mark.parametrize("units", [1.0, 1e6, 1e-6])
@pytest.mark.parametrize(("damped", "static"), [(1, 0), (0, 2), (2, 1), (2, 2)])
def test_massless_dofs(damped: int, static: int, units: float) -> None:
    # measured: 2e-13 at worst; the reference's exponential of the stiff relaxations is no better
    for seed in range(4):
        m, c, k, order = massless(3, damped, static, units, seed)
        n = len(m)
        inputs, coefs, constant, p, u, v = loads(n, 2, seed)
        p = units * p
        propagator = make_propagator(m, c, k, inputs)
        assert isinstance(propagator, ModalPropagator)
        assert propagator.u_p is not None
        q, g = propagator.state_of(u, v), propagator.forcing(units * coefs, units * constant)
        at = propagator.at(q, g, 1.3)
        found = (
            (propagator.u_q @ at).real + propagator.u_p @ polynomial.value(p, 1.3),
            (propagator.v_q @ at).real
            + propagator.v_p @ polynomial.value(p, 1.3)
            + propagator.u_p @ polynomial.value(p, 1.3, 1),
        )
        assert apart(found, eliminated(m, c, k, p, u, v, 1.3, order, 3, damped)) < 1e-11


def test_condition_does_not_depend_on_units() -> None:
    for seed in range(4):
        m, c, k, _ = massless(3, 2, 1, 1.0, seed)
        of = [make_propagator(s * m, s * c, s * k, np.eye(6)).condition for s in (1e-9, 1.0, 1e9)]
        assert of == pytest.approx([of[1]] * 3, rel=1e-6)


def test_massless_dofs_keep_continuity_of_position_only() -> None:
    """Entering drops the velocity of massless DOFs and the position of those without dashpots."""
    m, c, k, order = massless(3, 1, 1, 1.0, 0)
    propagator = make_propagator(m, c, k, np.eye(5))
    _, _, _, p, u, v = loads(5, 0)
    q = propagator.state_of(u, v)
    kept_u, kept_v = np.isin(order, [0, 1, 2, 3]), np.isin(order, [0, 1, 2])
    found_u = (propagator.u_q @ q).real + propagator.u_p @ p[0]
    found_v = (propagator.v_q @ q).real + propagator.v_p @ p[0]
    assert np.allclose(found_u[kept_u], u[kept_u], rtol=1e-11, atol=1e-12)
    assert np.allclose(found_v[kept_v], v[kept_v], rtol=1e-11, atol=1e-12)
    # and what follows is in balance: no force is left on the massless DOFs
    residual = k @ found_u + c @ found_v - p[0]
    assert np.abs(residual[~kept_v]).max() < 1e-11


def test_mechanism_names_its_shape() -> None:
    # two massless nodes that hang together, held by nothing: they move as one
    m = np.diag([1.0, 0.0, 0.0])
    k = np.array([[2.0, 0.0, 0.0], [0.0, 3.0, -3.0], [0.0, -3.0, 3.0]])
    with pytest.raises(Mechanism) as caught:
        make_propagator(m, np.zeros((3, 3)), k, np.eye(3))
    shape = caught.value.shape
    assert np.allclose(shape / shape[1], [0.0, 1.0, 1.0], atol=1e-12)
    # a dashpot is enough of a hold
    assert make_propagator(m, np.diag([0.0, 0.5, 0.0]), k, np.eye(3)).u_p is not None


def test_gauss_resolves_products_of_the_fastest_mode() -> None:
    w, x = gauss(1.0, 50.0)
    for rate in (100.0j, -50.0 + 50.0j, -100.0):
        assert abs(w @ np.exp(rate * x) - (np.exp(rate) - 1.0) / rate) < 1e-14
