"""Location on a grid: cells that may hold an event or a peak, and the first event in them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pound_solve.integrate.events import grid
from pound_solve.integrate.tracker import Extreme
from pound_solve.numerics.types import Array

waves = st.lists(
    st.tuples(st.floats(0.1, 2.0), st.floats(0.5, 20.0), st.floats(0.0, 6.3)), min_size=1, max_size=4
)


class Waves:
    """A sum of sines on a constant, with the bound of its second derivative."""

    def __init__(self, terms: list[tuple[float, float, float]], constant: float) -> None:
        self.a, self.w, self.p = np.array(terms).T[:, :, None]
        self.constant = constant
        self.curvature = float((self.a * self.w**2).sum())

    def value(self, t: Array) -> Array:
        x = np.ravel(t)
        return ((self.a * np.sin(self.w * x + self.p)).sum(axis=0) + self.constant).reshape(np.shape(t))

    def slope(self, t: Array) -> Array:
        x = np.ravel(t)
        return (self.a * self.w * np.cos(self.w * x + self.p)).sum(axis=0).reshape(np.shape(t))


def mesh(step: float, segments: int, cells: int) -> Array:
    return step * (cells * np.arange(segments)[:, None] + np.arange(cells + 1))


@given(waves, st.floats(-4.0, 0.0), st.floats(0.01, 0.3))
def test_no_rise_is_passed_over(terms: list[tuple[float, float, float]], c: float, step: float) -> None:
    f, t = Waves(terms, c), mesh(step, 3, 4)
    curvature = np.full((1, 3), f.curvature)
    marked = grid.may_rise(f.value(t)[None], f.slope(t)[None], curvature, np.diff(t))[0]
    within = t[:, :-1, None] + np.diff(t)[:, :, None] * np.linspace(0.0, 1.0, 41)
    above = (f.value(within) > 1e-12).any(axis=2) & (f.value(t)[:, :-1] <= 0.0)
    assert not (above & ~marked).any()


@given(waves, st.floats(0.01, 0.3))
def test_no_peak_is_passed_over(terms: list[tuple[float, float, float]], step: float) -> None:
    f, t = Waves(terms, 0.0), mesh(step, 3, 4)
    peak, seen = Extreme(), Extreme()
    marked = grid.may_peak(
        f.value(t)[None], f.slope(t)[None], np.full((1, 3), f.curvature), np.diff(t), [peak]
    )[0]
    grid.update_by_samples([seen], t.ravel(), f.value(t).reshape(1, -1))
    within = t[:, :-1, None] + np.diff(t)[:, :, None] * np.linspace(0.0, 1.0, 41)
    x = f.value(within[marked])
    high = max(seen.high, x.max(initial=-np.inf))
    low = min(seen.low, x.min(initial=np.inf))
    assert f.value(within).max() <= high + 1e-12
    assert f.value(within).min() >= low - 1e-12


def test_cells_that_cannot_matter_are_left_out() -> None:
    """A wave far below zero, and one that stays within its peaks."""
    f, t = Waves([(1.0, 1.0, 0.0)], -2.0), mesh(0.1, 2, 30)
    value, slope, curvature = f.value(t)[None], f.slope(t)[None], np.full((1, 2), f.curvature)
    assert not grid.may_rise(value, slope, curvature, np.diff(t)).any()
    fresh, known = Extreme(), Extreme()
    known.take(0.0, 0.0)
    known.take(-4.0, 0.0)
    assert not grid.may_peak(value, slope, curvature, np.diff(t), [known]).any()
    # otherwise only where it turns: at pi/2 and 3 pi/2, and on the way down from its start nothing
    marked = grid.may_peak(value, slope, curvature, np.diff(t), [fresh]).ravel()
    assert 2 <= marked.sum() <= 6
    assert marked[15] and marked[47]


@given(waves, st.floats(-3.0, -0.1), st.integers(1, 3))
def test_first_rise(terms: list[tuple[float, float, float]], c: float, segments: int) -> None:
    f = Waves(terms, c)
    t = mesh(0.01, segments, 32)
    if f.value(t)[0, 0] > -1e-9:
        return

    def evaluate(n: int, segment: int, cell: int, x: float) -> tuple[float, float]:
        assert t[segment, cell] <= x <= t[segment, cell + 1]
        return float(f.value(np.array([x]))[0]), float(f.slope(np.array([x]))[0])

    g, slope = f.value(t)[None], f.slope(t)[None]
    found = grid.first_rise(t, g, slope, np.zeros((1, 1, 1)), evaluate)
    fine = np.linspace(0.0, t[-1, -1], 20001)
    above = np.flatnonzero(f.value(fine) > 1e-9)
    if found is None:
        assert not len(above)
    else:
        at, n, segment, cell = found
        assert n == 0 and t[segment, cell] <= at <= t[segment, cell + 1]
        assert abs(f.value(np.array([at]))[0]) < 1e-12 * f.curvature
        assert not len(above) or at <= fine[above[0]]


@given(st.floats(0.1, 0.4), st.floats(0.6, 0.9), st.floats(0.05, 0.95), st.sampled_from([1.0, -1.0]))
def test_two_turns_within_one_cell_are_seen(first: float, second: float, share: float, sign: float) -> None:
    """A cubic that turns at two places between two samples, where its slopes have one sign: the hump
    rises through zero, its summit and its trough are the peaks.
    """
    rate = sign * np.polynomial.Polynomial.fromroots([first, second])
    shape = rate.integ()
    top, bottom = sorted((shape(first), shape(second)), reverse=True)
    ends = shape(np.array([0.0, 1.0]))
    low = max(ends.max() if sign > 0 else ends[0], bottom)
    if top - low < 1e-3 or (sign < 0 and ends[1] > top):
        return
    g = shape - (low + share * (top - low))  # zero between the ends, or the trough, and the summit
    t = np.array([[0.0, 1.0]])

    def evaluate(n: int, segment: int, cell: int, x: float) -> tuple[float, float]:
        return float(g(x)), float(rate(x))

    value, slope = g(t)[None], rate(t)[None]
    peak = Extreme()
    grid.update_by_extremes([peak], 0.0, t, value, slope, evaluate)
    assert abs(peak.high - max(g(np.array([0.0, 1.0, first, second])))) < 1e-12
    assert abs(peak.low - min(g(np.array([0.0, 1.0, first, second])))) < 1e-12
    if value.max() > 1e-9:
        return  # it ends above zero: a crossing that samples show
    found = grid.first_rise(t, value.copy(), slope, np.full((1, 1, 1), 1e-12), evaluate)
    assert found is not None
    assert abs(g(found[0])) < 1e-9 and rate(found[0]) > 0.0


@pytest.mark.parametrize("rounding", [0.0, 1e-16, 1e-13, 1e-11])
def test_what_falls_from_zero_rises_where_it_comes_back(rounding: float) -> None:
    """As a contact that has parted: its rate at the start is rounding, and has any sign."""
    back = 0.6

    def g(x: Array) -> Array:
        return np.asarray(rounding * x - x * x * (back - x))

    def rate(x: Array) -> Array:
        return np.asarray(rounding - 2.0 * back * x + 3.0 * x * x)

    def evaluate(n: int, segment: int, cell: int, x: float) -> tuple[float, float]:
        return float(g(np.array(x))), float(rate(np.array(x)))

    t = np.array([[0.0, 0.8, 1.6]])
    found = grid.first_rise(t, g(t)[None], rate(t)[None], np.full((1, 1, 1), 1e-12), evaluate)
    assert found is not None and found.time == pytest.approx(back, rel=1e-9)
