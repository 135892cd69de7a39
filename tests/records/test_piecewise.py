"""Piecewise polynomials against numpy and against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from pound_solve.loading.motions.base import GroundMotion, LoadingContext, common_breaks, finish
from pound_solve.loading.piecewise import Piecewise, merged


@st.composite
def functions(draw: st.DrawFn) -> Piecewise:
    """Up to six pieces of up to degree four."""
    n, degree = draw(st.integers(1, 6)), draw(st.integers(0, 4))
    widths = draw(arrays(float, n, elements=st.floats(0.01, 2.0)))
    coefs = draw(arrays(float, (degree + 1, n), elements=st.floats(-10, 10, width=32)))
    return Piecewise(draw(st.floats(-3, 3)) + np.concatenate(([0.0], np.cumsum(widths))), coefs)


@given(functions())
def test_value_is_that_of_numpy(f: Piecewise) -> None:
    for i in range(f.coefs.shape[1]):
        s = np.linspace(0, 0.999, 7) * (f.breaks[i + 1] - f.breaks[i])
        want = np.polynomial.Polynomial(f.coefs[:, i])(s)
        np.testing.assert_allclose(f.value(f.breaks[i] + s), want, atol=1e-10)
    assert f.value(f.start - 1) == 0 == f.value(f.end + 1)


@given(functions(), st.floats(-10, 10))
def test_integral(f: Piecewise, initial: float) -> None:
    g = f.integral(initial)
    total = initial
    for i in range(f.coefs.shape[1]):
        assert g.coefs[0, i] == pytest.approx(total, abs=1e-10)
        own = np.polynomial.Polynomial(f.coefs[:, i]).integ()
        s = np.linspace(0, 1, 5) * (f.breaks[i + 1] - f.breaks[i])
        np.testing.assert_allclose(np.polynomial.Polynomial(g.coefs[:, i])(s), total + own(s), atol=1e-10)
        total += own(f.breaks[i + 1] - f.breaks[i])
    assert g.value(g.end) == pytest.approx(total, abs=1e-9)


@given(functions(), st.floats(0, 1))
def test_other_origin_is_the_same_function(f: Piecewise, share: float) -> None:
    i = f.coefs.shape[1] // 2
    t0 = f.breaks[i] + share * (f.breaks[i + 1] - f.breaks[i])
    t = np.linspace(f.breaks[i], f.breaks[i + 1], 5)[:-1]
    np.testing.assert_allclose(np.polynomial.Polynomial(f.local(i, t0))(t - t0), f.value(t), atol=1e-9)
    np.testing.assert_array_equal(f.local(i), f.coefs[:, i])


@given(functions(), st.floats(-4, 4), st.floats(0.1, 5))
def test_slice_is_the_same_function_inside(f: Piecewise, start: float, length: float) -> None:
    g = f.slice(start, start + length)
    assert (g.start, g.end) == (start, start + length)
    # middles: at a jump the two may differ by which side of a rounding error they see
    t = 0.5 * (g.breaks[:-1] + g.breaks[1:])
    np.testing.assert_allclose(g.value(t), f.value(t), atol=1e-9)


@given(functions())
def test_peak_is_not_below_any_value(f: Piecewise) -> None:
    at, peak = f.peak()
    assert f.start <= at <= f.end
    ends = np.abs(f.value(0.5 * (f.breaks[:-1] + f.breaks[1:])))
    assert abs(peak) >= ends.max() - 1e-12


def test_peak_inside_a_piece() -> None:
    assert Piecewise(np.array([1.0, 3.0]), np.array([[0.0], [2.0], [-1.0]])).peak() == pytest.approx(
        (2.0, 1.0)
    )


def test_peak_where_the_highest_power_is_rounding() -> None:
    f = Piecewise(np.array([0.0, 1.0]), np.array([[0.0], [-2.0], [2.0], [2.0**-52]]))
    assert f.peak() == pytest.approx((0.5, -0.5))


def test_extended_velocity_keeps_its_value() -> None:
    v = Piecewise.from_samples([0.0, 1.0], [2.0, 2.0]).extended(3.0).integral(1.0)
    np.testing.assert_allclose(v.value([0.0, 0.5, 1.0, 2.0, 3.0]), [1.0, 2.0, 3.0, 3.0, 3.0])
    assert v.extended(2.0) is v
    np.testing.assert_allclose(v.extended(4.0, (3.0, 1.0)).value(4.0), 4.0)


def test_arithmetic() -> None:
    f = Piecewise.from_samples([0.0, 1.0, 2.0], [0.0, 1.0, 0.5])
    assert (f * 2).value(1.5) == (2 * f).value(1.5) == -(-2 * f).value(1.5) == -(-(f * 2)).value(1.5) == 1.5
    assert f.degree == 1 and Piecewise.zero(0, 1).value(0.5) == 0


def test_bad_shapes_and_breaks() -> None:
    with pytest.raises(ValueError, match="breaks"):
        Piecewise(np.array([0.0, 1.0]), np.zeros((1, 2)))
    with pytest.raises(ValueError, match="increase"):
        Piecewise(np.array([0.0, 0.0]), np.zeros((1, 1)))
    with pytest.raises(ValueError, match="leave out"):
        Piecewise.from_samples([0.0, 1.0, 2.0], [0.0, 1.0, 0.0]).on([0.0, 2.0])


def test_merged_keeps_both_ends_and_no_slivers() -> None:
    t = merged([0.0, 1e-15, 1.0, 1.0 + 1e-15, 2.0 - 1e-15, 2.0], 2e-12)
    assert t.tolist() == [0.0, 1.0, 2.0]


def test_common_breaks() -> None:
    a = GroundMotion("X", None, Piecewise.from_samples(0.01 * np.arange(301), np.sin(np.arange(301.0))))
    b = GroundMotion("Y", None, Piecewise.from_samples(0.005 * np.arange(1001), np.cos(np.arange(1001.0))))
    breaks = common_breaks([a.acceleration, b.acceleration], 4.0)
    assert len(breaks) == 801 and (breaks[0], breaks[-1]) == (0.0, 4.0)
    t = 0.5 * (breaks[1:] + breaks[:-1])
    for motion in (a, b):
        np.testing.assert_allclose(
            motion.acceleration.on(breaks).value(t), motion.acceleration.value(t), atol=1e-12
        )
    assert common_breaks([], 2.0).tolist() == [0.0, 2.0]


def test_finish_warns_of_odd_strength() -> None:
    context = LoadingContext(9.81)
    strong = Piecewise.from_samples([0.0, 1.0], [0.0, 300.0])
    assert "30.6 g" in finish({}, strong, context, {}).info["warnings"][0]
    assert finish({"SCALE": 0.0}, strong * 0.0, context, {}).info["warnings"] == ()
    assert finish({}, strong * 1e-5, context, {}).info["warnings"] != ()
    assert finish({}, strong * 0.01, context, {}).info["warnings"] == ()
