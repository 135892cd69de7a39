"""First rises and extremes of polynomials: against roots and dense samples, and what the search costs."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from pound_solve.integrate.events import polynomial_roots
from pound_solve.integrate.events.polynomial_roots import CELLS, POLYNOMIAL
from pound_solve.numerics.types import Array

TERMS = 32
EPS = 2.3e-16


def rows(coefficients: Array | list[float]) -> tuple[Array, int]:
    """A polynomial as the kernels take it."""
    c = np.asarray(coefficients, float)
    p = np.zeros(polynomial_roots.room(len(c) - 1))
    p[POLYNOMIAL, : len(c)] = c
    return p, len(c) - 1


def cell(p: Array, terms: int, row: int) -> tuple[Array, float, float]:
    """Coefficients of a cell, its place and its width."""
    return p[row, : terms + 1], float(p[row, -2]), float(p[row, -1])


def bernstein(b: Array, sigma: Array) -> Array:
    """Values of a polynomial from its coefficients in Bernstein's form."""
    n = len(b) - 1
    return sum(v * math.comb(n, j) * sigma**j * (1 - sigma) ** (n - j) for j, v in enumerate(b))


def with_roots(*roots: float, lead: float = 1.0) -> Array:
    """Coefficients of a polynomial with these roots."""
    return lead * np.polynomial.polynomial.polyfromroots(roots)


def on(c: Array, s: Array | float) -> Array:
    """Values."""
    return np.polynomial.polynomial.polyval(s, c)


def noise(c: Array) -> float:
    """What values in [0, 1] may be off by rounding."""
    return 40 * EPS * float(np.abs(c).sum()) + 1e-300


#: motions as they come: a few radians of some modes
waves = st.lists(
    st.tuples(st.floats(-1, 1), st.floats(0.1, 6.0), st.floats(0, 2 * np.pi), st.floats(-3.0, 0.5)),
    min_size=1,
    max_size=3,
)
#: any coefficients
anything = st.lists(st.floats(-10, 10).map(lambda x: round(x, 3)), min_size=1, max_size=9).map(np.array)


def series(parts: list[tuple[float, float, float, float]], shift: float = 0.0) -> Array:
    """Coefficients of damped waves on [0, 1]."""
    c = np.zeros(TERMS + 1)
    for a, w, phase, damping in parts:
        z, term = damping + 1j * w, a * np.exp(1j * phase)
        for k in range(TERMS + 1):
            c[k] += term.real
            term *= z / (k + 1)
    c[0] += shift
    return c


polynomials = st.one_of(anything, st.builds(series, waves, st.floats(-1.5, 0.5)))


@pytest.fixture
def halved(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[float]]:
    """The widths of the cells that a search halves."""
    seen: list[float] = []
    own = polynomial_roots.halve_cell

    def halve(p: Array, terms: int, row: int) -> None:
        seen.append(float(p[row, -1]))
        assert len(seen) < 5000, "no end"
        own(p, terms, row)

    monkeypatch.setattr(polynomial_roots, "halve_cell", halve)
    yield seen


# ---------------------------------------------------------------- the parts


@given(c=polynomials, end=st.floats(1e-3, 1))
def test_cells_hold_the_polynomial(c: Array, end: float) -> None:
    """In Bernstein's form on [0, end], and on both halves; within the hull of the coefficients."""
    p, terms = rows(c)
    polynomial_roots.write_in_bernstein_form(p, terms, end)
    polynomial_roots.halve_cell(p, terms, CELLS)
    sigma = np.linspace(0.0, 1.0, 40)
    tolerance = 50 * noise(c)
    for row, place in ((CELLS, 0.5 * end), (CELLS + 1, 0.0)):
        b, x, w = cell(p, terms, row)
        assert (x, w) == (place, 0.5 * end)
        values = on(c, x + w * sigma)
        assert np.abs(bernstein(b, sigma) - values).max() <= tolerance
        assert (
            values.max() <= polynomial_roots.highest_of(p, terms, row) + tolerance
            and values.min() >= b.min() - tolerance
        )
        assert np.abs(b[[0, -1]] - on(c, np.array([x, x + w]))).max() <= tolerance
    assert polynomial_roots.size(p, POLYNOMIAL, terms) == pytest.approx(np.abs(c[1:]).sum(), rel=1e-14)


@given(c=polynomials, s=st.floats(0, 1))
def test_values_and_slopes(c: Array, s: float) -> None:
    p, terms = rows(c)
    first = np.polynomial.polynomial.polyder(c) if terms else np.zeros(1)
    second = np.polynomial.polynomial.polyder(first) if terms > 1 else np.zeros(1)
    tolerance = noise(c) * (1 + terms) ** 2
    assert polynomial_roots.value(p, terms, s) == pytest.approx(float(on(c, s)), abs=tolerance)
    assert polynomial_roots.slopes(p, terms, s) == pytest.approx(
        (float(on(first, s)), float(on(second, s))), abs=tolerance
    )


@given(c=polynomials)
def test_bends_are_no_fewer_than_extremes(c: Array) -> None:
    """Changes of sign that dense samples show; and so it turns that often at most."""
    p, terms = rows(c)
    polynomial_roots.write_in_bernstein_form(p, terms, 1.0)
    steps = np.diff(on(c, np.linspace(0.0, 1.0, 400)))
    seen = steps[np.abs(steps) > 10 * noise(c)]
    turns = int((np.diff(np.sign(seen)) != 0).sum())
    noise_here = polynomial_roots.COEFFICIENT_ROUNDING * float(np.abs(c).sum())
    first, count = polynomial_roots.sign_changes(p, terms, CELLS, noise_here)
    assert count >= turns
    if count == 0 and len(seen):
        assert np.sign(first) == np.sign(seen[0])


@given(root=st.floats(1e-9, 1), more=st.lists(st.floats(1.5, 9), max_size=5))
def test_the_zero_of_a_rise(root: float, more: list[float]) -> None:
    """Other roots lie beyond: to the right it rises no more."""
    c = with_roots(root, *more)
    c = c if on(c, 0.0) < 0 else -c
    inner = np.polynomial.polynomial.polyder(c)
    top = min([x.real for x in np.roots(inner[::-1]) if abs(x.imag) < 1e-9 and x.real > root] + [9.0])
    w = min(1.0, root + 0.9 * (top - root))
    p, terms = rows(c)
    found = polynomial_roots.find_zero(p, terms, 0.0, w)
    assert found == pytest.approx(root, abs=noise(c) / abs(float(on(inner, root))) + 4 * EPS)


@pytest.mark.parametrize("degree", [3, 7, 15])
def test_the_zero_of_a_rise_that_starts_flat(degree: int) -> None:
    """s^n - 2^-n: Newton's steps from the flat part would leave the bracket."""
    p, terms = rows([-(0.01**degree), *[0.0] * (degree - 1), 1.0])
    assert polynomial_roots.find_zero(p, terms, 0.0, 1.0) == pytest.approx(0.01, rel=1e-14)


@given(at=st.floats(1e-6, 0.999), bend=st.floats(0.1, 50), tilt=st.floats(-0.05, 0.05))
def test_the_summit_of_a_hill(at: float, bend: float, tilt: float) -> None:
    """c - bend (s - at)^2 (1 + tilt (s - at)): its slope is zero at `at`."""
    s = np.polynomial.polynomial.Polynomial([-at, 1.0])
    c = (3.0 - bend * s**2 * (1.0 + tilt * s)).coef
    p, terms = rows(c)
    assert polynomial_roots.find_summit(p, terms, 0.0, 1.0) == pytest.approx(at, rel=1e-8, abs=1e-14)


# ---------------------------------------------------------------- the first rise


def judge(c: Array, end: float, tol: float) -> None:
    """Nothing above `tol` comes before what is found, and there it rises through zero."""
    p, terms = rows(c)
    found = polynomial_roots.first_rise(p, terms, end, tol)
    tolerance = noise(c)
    dense = np.linspace(0.0, end, 4001)
    if found < 0.0:
        assert found == -1.0
        last = dense
    else:
        assert 0.0 <= found < end or found == pytest.approx(end, rel=1e-14)
        last = dense[dense < found]
    values = on(c, last)
    if c[0] <= 0.0:  # else it comes from above, and must fall first
        assert values.max(initial=-np.inf) <= tol + tolerance
    if found > 0.0 and c[0] <= 0.0:
        assert abs(on(c, found)) <= tol + tolerance
    if found >= 0.0:  # and it does rise beyond the tolerance, without another return
        beyond = dense[dense > found]
        after = on(c, np.append(beyond, np.linspace(found, min(end, found + 1e-3), 500)))
        fine = np.append(after, on(c, found + (end - found) * np.geomspace(1e-15, 1, 400)))
        assert fine.max() > tol - tolerance


@settings(max_examples=400)
@given(c=polynomials, end=st.sampled_from([1.0, 0.37, 1e-3]), tol=st.sampled_from([1e-12, 1e-9, 1e-3]))
@example(c=np.array([-1.0]), end=1.0, tol=1e-12)
@example(c=np.array([0.0]), end=1.0, tol=0.0)
@example(c=np.array([0.0, 0.0, 1.0]), end=1.0, tol=1e-12)
@example(c=np.array([0.0, -1.0, 1.5]), end=1.0, tol=1e-12)
@example(c=np.array([1e-17, 1.0]), end=1.0, tol=1e-12)
def test_no_rise_is_missed(c: Array, end: float, tol: float) -> None:
    judge(c, end, tol)


@settings(max_examples=300)
@given(roots=st.lists(st.floats(-0.5, 1.5), min_size=1, max_size=7), sign=st.sampled_from([-1.0, 1.0]))
def test_the_first_rise_among_known_roots(roots: list[float], sign: float) -> None:
    """Well apart, they are found; a value above zero at the start is no rise."""
    roots = sorted(roots)
    near = np.diff(np.array([0.0, *(r for r in roots if r > 0.0)]))
    c = with_roots(*roots, lead=sign)
    rises = [
        r for i, r in enumerate(roots) if 0.0 < r < 1.0 and sign * (-1.0) ** (len(roots) - 1 - i) > 0.0
    ]
    if near.min(initial=1.0) < 0.02 or any(abs(r) < 0.02 or abs(r - 1.0) < 0.02 for r in roots):
        return
    if c[0] > 0.0:
        return
    p, terms = rows(c)
    found = polynomial_roots.first_rise(p, terms, 1.0, 1e-12 * np.abs(c).sum())
    if not rises:
        assert found == -1.0
        return
    steep = abs(float(on(np.polynomial.polynomial.polyder(c), rises[0])))
    assert found == pytest.approx(rises[0], abs=noise(c) / steep + 4 * EPS)


@given(at=st.floats(0.05, 0.95), narrow=st.floats(1e-4, 0.04), bend=st.floats(0.5, 20))
def test_two_crossings_however_near_are_not_passed(at: float, narrow: float, bend: float) -> None:
    """-bend (s - a)(s - b), above zero between: as high as bend (b - a)^2 / 4, well above 1e-12."""
    c = with_roots(at, at + narrow, lead=-bend)
    p, terms = rows(c)
    found = polynomial_roots.first_rise(p, terms, 1.0, 1e-12)
    # at the first crossing, or where it is still within the tolerance
    within = 1e-12 / (0.5 * bend * narrow)
    assert at - EPS - noise(c) / (bend * narrow) <= found + 4 * EPS
    assert found <= at + within + 4 * noise(c) / (bend * narrow)


@given(at=st.floats(0.0, 1.0), bend=st.floats(0.1, 30), lift=st.floats(-1.0, 0.99))
def test_a_touch_that_rises_by_less_than_the_tolerance_is_none(at: float, bend: float, lift: float) -> None:
    tol = 1e-10
    s = np.polynomial.polynomial.Polynomial([-at, 1.0])
    c = (lift * tol - bend * s**2).coef
    p, terms = rows(c)
    assert polynomial_roots.first_rise(p, terms, 1.0, tol) == -1.0
    # beyond it is one, from where it is zero or within the tolerance of it
    c[0] += (2.0 - lift) * tol
    p, terms = rows(c)
    found = polynomial_roots.first_rise(p, terms, 1.0, tol)
    if 1e-3 < at < 0.999:
        assert abs(found - (at - np.sqrt(2 * tol / bend))) < 1e-3 and -tol < on(c, found) <= tol + noise(c)


@pytest.mark.parametrize("order", [2, 3, 4, 8])
@pytest.mark.parametrize("at", [0.0, 0.3, 0.5, 1.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("tol", [0.0, 1e-12])
def test_roots_of_higher_order_end(
    halved: list[float], order: int, at: float, sign: float, tol: float
) -> None:
    """Where everything is rounding the search goes on all the same: without a tolerance too."""
    judge_end = with_roots(*[at] * order, lead=sign)
    p, terms = rows(judge_end)
    if judge_end[0] <= 0.0:
        judge(judge_end, 1.0, max(tol, noise(judge_end)))
    polynomial_roots.first_rise(p, terms, 1.0, tol)
    polynomial_roots.highest(p, terms, 1.0, -np.inf)
    p[POLYNOMIAL] *= -1
    polynomial_roots.highest(p, terms, 1.0, -np.inf)
    assert len(halved) < 500


def test_a_rise_at_the_start() -> None:
    """From zero, or from rounding above it: at once; falling from there: not; after a fall: at its own."""
    for c, expected, near in (
        ([0.0, 1.0], 0.0, 0.0),
        ([1e-17, 1.0], 0.0, 0.0),
        ([0.0, 0.0, 1.0], 0.0, 1e-6),  # there it is at the tolerance
        ([1e-17, -1.0], -1.0, 0.0),
        ([0.0, -1.0, 2.0], 0.5, 1e-15),
        ([1e-17, -1.0, 2.0], 0.5, 1e-15),
        ([-1e-17, 1.0], 1e-17, 1e-30),
        ([0.0, 1e-13], -1.0, 0.0),
    ):
        p, terms = rows(c)
        assert polynomial_roots.first_rise(p, terms, 1.0, 1e-12) == pytest.approx(expected, abs=near), c


# ---------------------------------------------------------------- extremes


@pytest.mark.full
@settings(max_examples=400)
@given(c=polynomials, end=st.sampled_from([1.0, 0.4, 1e-3]))
@example(c=np.array([2.0]), end=1.0)
@example(c=with_roots(*[0.5] * 8, lead=-1.0), end=1.0)
def test_the_highest_value(c: Array, end: float) -> None:
    p, terms = rows(c)
    high, place = polynomial_roots.highest(p, terms, end, -np.inf)
    tolerance = noise(c)
    dense = np.linspace(0.0, end, 3001)
    slopes = np.roots(np.polynomial.polynomial.polyder(c)[::-1]) if terms < 9 else np.zeros(0)
    flat = slopes.real[(np.abs(slopes.imag) < 1e-7) & (slopes.real > 0) & (slopes.real < end)]
    assert high >= on(c, np.append(dense, flat)).max() - tolerance
    assert 0.0 <= place <= end and high == pytest.approx(float(on(c, place)), abs=tolerance)
    # what is known already counts
    assert polynomial_roots.highest(p, terms, end, high + tolerance) == (high + tolerance, -1.0)
    if tolerance < 1e-3:
        lower = polynomial_roots.highest(p, terms, end, high - 2e-3)
        assert lower[0] == pytest.approx(high, abs=tolerance) and lower[1] >= 0.0


def test_an_interval_of_no_length_is_its_start() -> None:
    p, terms = rows([1.0, 2.0])
    assert polynomial_roots.highest(p, terms, 0.0, 0.5) == (1.0, 0.0)
    assert polynomial_roots.first_rise(p, terms, 0.0, 1e-12) == -1.0


@settings(max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(parts=waves, shift=st.floats(-1.5, 0.5), tiny=st.sampled_from([1.0, 1e-9, 1e-18]))
def test_waves_are_searched_in_few_cells(
    halved: list[float], parts: list[tuple[float, float, float, float]], shift: float, tiny: float
) -> None:
    """A few cells for a motion of six radians, however small it is beside its constant."""
    halved.clear()
    c = series(parts)
    c *= tiny
    c[0] += shift
    p, terms = rows(c)
    polynomial_roots.first_rise(p, terms, 1.0, 1e-12)
    polynomial_roots.highest(p, terms, 1.0, -np.inf)
    assert len(halved) < 40
