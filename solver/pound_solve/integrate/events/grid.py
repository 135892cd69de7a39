"""Location of events and peaks on a grid: bracketed by values and slopes at its points, then refined.

The functions here use numbers only: sampled values and slopes on segments of time, shape
(n, n_segments, n_points), and a function that evaluates exactly between the points.  A *cell* is the time
from one point of a segment to the next.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from pound_solve.integrate.tolerances import EVENT_TOLERANCE
from pound_solve.integrate.tracker import Peak
from pound_solve.numerics.cubic import cubic_peak
from pound_solve.numerics.types import Array, Flags

SHALLOW = 1e-9  #: fraction of its steepest slope below which a function that starts at zero may fall first
MAX_HALVINGS = 60  #: of a cell, to a time after its start; a shorter time would be lost in rounding
MAX_ROOT_TRIALS = 200  #: bisection alone needs 60; slow steps of Newton's method come on top
ROOT_ROUNDING = 4e-16  #: fraction of the time to which a root is found: two units in the last place
MAX_PEAK_TRIALS = 60  #: trials by regula falsi
#: residual slope of a peak, as a fraction of the slopes at the ends of its bracket: it changes the peak by
#: the square of this, 1e-16 of its height
PEAK_SLOPE = 1e-8
PEAK_BRACKETED = 1e-9  #: fraction of the time to which a peak is bracketed, where the slope does not vanish
#: fraction of its rise above both ends of the cell by which an extreme may exceed that of the cubic: on a
#: grid as fine as this, cubics are more accurate
CUBIC_ERROR = 0.02
#: value and slope of function n in some segment and cell at time t
Evaluate = Callable[[int, int, int, float], tuple[float, float]]
ValueAndSlope = Callable[[float], tuple[float, float]]  #: of one function in one cell
Ends = tuple[float, float, float]  #: a time, and the value and slope there


class Rise(NamedTuple):
    """The instant at which one of several functions rises through zero, and the cell that contains it."""

    time: float
    function: int
    segment: int
    cell: int


def may_rise(g: Array, slope: Array, curvature: Array, width: Array) -> Flags:
    """Return in which cells functions may rise through zero: either they are above it at the end, or
    they may have a maximum that the curvature bound does not keep below it.

    A function stays within ``curvature width^2 / 8`` of its chord.  It is monotone if the mean of its
    slopes at both ends is above ``curvature width / 2``.

    Parameters
    ----------
    g, slope : ndarray, shape (n, n_segments, n_points)
    curvature : ndarray, shape (n, n_segments)
        Bounds of the second derivatives.
    width : ndarray, shape (n_segments, n_points - 1)
        Widths of the cells.
    """
    curvature = curvature[:, :, None]
    may_have_extremum = np.abs(slope[..., :-1] + slope[..., 1:]) <= curvature * width
    above = np.maximum(g[..., :-1], g[..., 1:]) + curvature * (width**2 / 8.0) > 0.0
    return np.asarray((g[..., 1:] > 0.0) | (may_have_extremum & above))


def may_peak(value: Array, slope: Array, curvature: Array, width: Array, peaks: Sequence[Peak]) -> Flags:
    """Return in which cells functions may exceed their peaks and all points up to there; parameters as in
    `may_rise`.
    """
    curvature, shape = curvature[:, :, None], value.shape
    may_have_extremum = np.abs(slope[..., :-1] + slope[..., 1:]) <= curvature * width
    known = np.array([[peak.high, peak.low] for peak in peaks])
    margin = curvature * (width**2 / 8.0)
    flat = value.reshape(len(value), -1)
    high = np.maximum(np.maximum.accumulate(flat, axis=1), known[:, :1]).reshape(shape)[..., 1:]
    low = np.minimum(np.minimum.accumulate(flat, axis=1), known[:, 1:]).reshape(shape)[..., 1:]
    beyond = (np.maximum(value[..., :-1], value[..., 1:]) + margin > high) | (
        np.minimum(value[..., :-1], value[..., 1:]) - margin < low
    )
    return np.asarray(may_have_extremum & beyond & (margin > 0.0))


def two_extremes(t: Array, value: Array, slope: Array) -> tuple[Flags, Array]:
    """Return in which cells functions may have two extremes although their slopes have the same sign at
    both ends, and a time between the two extremes.  The cubics through both ends decide.

    Cells whose rise agrees with their slopes to rounding are left out, because in a very narrow cell any
    rounding would count.
    """
    width, rise = np.diff(t), np.diff(value)
    s0, s1 = slope[..., :-1], slope[..., 1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = rise / width
        a, b = s0 + s1 - 2.0 * mean, 3.0 * mean - 2.0 * s0 - s1
        at = -b / (3.0 * a)  # where the cubic's slope, s0 + 2 b x + 3 a x^2, is least or largest
        twice = (s0 * s1 > 0.0) & (at > 0.0) & (at < 1.0) & ((s0 + b * at) * s0 < 0.0)
        rounding = EVENT_TOLERANCE * np.abs(value).max(axis=(1, 2), keepdims=True)
        twice &= np.abs(rise - 0.5 * (s0 + s1) * width) > rounding
    return twice, t[..., :-1] + at * width


def first_rise(t: Array, g: Array, slope: Array, tol: Array, evaluate: Evaluate) -> Rise | None:
    """Return the first instant at which one of several functions rises through zero, or None.

    Parameters
    ----------
    t : ndarray, shape (n_segments, n_points)
        Ascending times on consecutive segments; the first point is the start of a branch or the end of the
        last search.
    g, slope : ndarray, shape (n, n_segments, n_points)
        Sampled values and slopes; `g` is changed at the first point, where a value above zero is rounding.
    tol : ndarray, shape (n, 1, 1)
        Values up to which a function counts as not above zero.
    evaluate : callable
        Value and slope of a function in a cell.
    """
    g[:, 0, 0] = np.minimum(g[:, 0, 0], 0.0)
    crossed = (g[..., 1:] > tol) & (g[..., :-1] <= tol)
    humps, twice, split = _humps(t, g, slope, tol)
    for k, j in np.argwhere((crossed | humps).any(axis=0)).tolist():
        best: Rise | None = None
        for n in np.flatnonzero(crossed[:, k, j] | humps[:, k, j]).tolist():
            function = partial(evaluate, n, k, j)
            low, high = float(t[k, j]), float(t[k, j + 1])
            if not crossed[n, k, j]:
                slopes = float(slope[n, k, j]), float(slope[n, k, j + 1])
                middle = float(split[n, k, j]) if twice[n, k, j] else None
                top = _summit_above(function, (low, high), slopes, middle, tol[n, 0, 0])
                if top is None:
                    continue
                high = top
            elif g[n, k, j] == 0.0:
                # at the first point its slope may be rounding: the function may fall first
                if k == j == 0 and not slope[n, 0, 0] > SHALLOW * np.abs(slope[n]).max():
                    low = _dip(function, low, high)
                if low == t[k, j]:
                    return Rise(low, n, k, j)  # it rises from the start, however slowly
            at = _root(function, low, high)
            if best is None or at < best.time:
                best = Rise(at, n, k, j)
        if best is not None:
            return best
    return None


def _humps(t: Array, g: Array, slope: Array, tol: Array) -> tuple[Flags, Flags, Array]:
    """Return the cells in which functions that are below zero at both ends may rise above it, and the
    result of `two_extremes` for them.
    """
    g0, g1, s0, s1 = g[..., :-1], g[..., 1:], slope[..., :-1], slope[..., 1:]
    below = (g1 <= tol) & (g0 <= tol)
    humps = (s0 > 0) & (s1 < 0) & below
    if humps.any():  # the tangents at both ends must meet above zero
        with np.errstate(divide="ignore", invalid="ignore"):
            humps &= g0 + s0 * ((g1 - g0 - s1 * np.diff(t)) / (s0 - s1)) > tol
    twice, split = two_extremes(t, g, slope)
    twice &= below
    return humps | twice, twice, split


def _summit_above(
    function: ValueAndSlope,
    ends: tuple[float, float],
    slopes: tuple[float, float],
    split: float | None,
    tol: float,
) -> float | None:
    """Return the time of a maximum above `tol` between two times with known slopes, or None.

    With two extremes, `split` is a time between them.
    """
    (low, high), (s_low, s_high) = ends, slopes
    if split is not None:
        s_split = function(split)[1]
        if s_split * s_low >= 0.0:
            return None
        if s_low > 0.0:
            high, s_high = split, s_split
        else:
            low, s_low = split, s_split
    top = stationary_point(lambda x: function(x)[1], low, high, s_low, s_high)
    return None if function(top)[0] <= tol else top


def _dip(function: ValueAndSlope, start: float, high: float) -> float:
    """Return a time after `start` at which a function that is zero at `start` and falls first is below
    zero; `start` if it does not fall.
    """
    width = high - start
    for _ in range(MAX_HALVINGS):
        width *= 0.5
        if function(start + width)[0] < 0.0:
            return start + width
    return start


def _root(function: ValueAndSlope, low: float, high: float) -> float:
    """Return the root of a function that rises through zero in (low, high), by Newton with a bracket."""
    x, last = 0.5 * (low + high), np.inf
    for _ in range(MAX_ROOT_TRIALS):
        g, slope = function(x)
        if g == 0.0:
            return x
        if g > 0.0:
            high = x
        else:
            low = x
        new = x - g / slope if slope > 0.0 else 0.5 * (low + high)
        if not low < new < high or abs(new - x) > 0.5 * last:  # outside, or Newton stalls: halve
            new = 0.5 * (low + high)
        if abs(new - x) <= ROOT_ROUNDING * high or new in (low, high):
            return new
        last, x = abs(new - x), new
    return x


def stationary_point(
    slope: Callable[[float], float], low: float, high: float, s_low: float, s_high: float
) -> float:
    """Return the zero of a slope that falls through zero in (low, high), by the Illinois form of regula
    falsi.
    """
    side, x, steep = 0, low, s_low - s_high
    for _ in range(MAX_PEAK_TRIALS):
        x = (s_low * high - s_high * low) / (s_low - s_high)
        s = slope(x)
        if abs(s) < PEAK_SLOPE * steep or high - low < PEAK_BRACKETED * high:
            break
        if s > 0:
            low, s_low = x, s
            s_high = 0.5 * s_high if side == 1 else s_high
            side = 1
        else:
            high, s_high = x, s
            s_low = 0.5 * s_low if side == -1 else s_low
            side = -1
    return x


def update_by_samples(peaks: Sequence[Peak], t: Array, value: Array) -> None:
    """Update the peaks with sampled functions, shape (n, n_t)."""
    hi, lo = value.argmax(axis=1), value.argmin(axis=1)
    every = np.arange(len(peaks))
    for peak, x, j, y, k in zip(peaks, value[every, hi].tolist(), hi, value[every, lo].tolist(), lo):
        if x > peak.high:
            peak.take(x, float(t[j]))
        if y < peak.low:
            peak.take(y, float(t[k]))


def update_by_extremes(
    peaks: Sequence[Peak], t0: float, t: Array, value: Array, slope: Array, evaluate: Evaluate
) -> None:
    """Update the peaks with sampled functions, and with refined extremes between the samples.

    Parameters
    ----------
    peaks : sequence of Peak
        One for each function.
    t0 : float
        Time of the window's start [T]; `t` counts from it.
    t : ndarray, shape (n_segments, n_points)
    value, slope : ndarray, shape (n, n_segments, n_points)
    evaluate : callable
        Value and slope of a function in a cell.
    """
    if not len(peaks):
        return
    update_by_samples(peaks, t0 + t.ravel(), value.reshape(len(value), -1))
    f0, s0, s1 = value[..., :-1], slope[..., :-1], slope[..., 1:]
    turn = s0 * s1 < 0
    twice, split = two_extremes(t, value, slope)
    if not (turn.any() or twice.any()):
        return
    known = np.array([[peak.high, peak.low] for peak in peaks])[:, :, None, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        # the intersection of the tangents at both ends bounds the extreme of a smooth function
        meet = f0 + s0 * (value[..., 1:] - f0 - s1 * np.diff(t)) / (s0 - s1)
    beyond = turn & (((s0 > 0) & (meet > known[:, 0])) | ((s0 < 0) & (meet < known[:, 1])))
    for i, k, j in np.argwhere(beyond | twice).tolist():
        function = partial(evaluate, i, k, j)
        low, high = ((float(t[k, n]), float(value[i, k, n]), float(slope[i, k, n])) for n in (j, j + 1))
        if not twice[i, k, j]:
            _count_extreme(peaks[i], t0, function, low, high)
            continue
        middle = float(split[i, k, j])
        between = (middle, *function(middle))
        if between[2] * low[2] < 0.0:
            _count_extreme(peaks[i], t0, function, low, between)
            _count_extreme(peaks[i], t0, function, between, high)


def _count_extreme(peak: Peak, t0: float, function: ValueAndSlope, low: Ends, high: Ends) -> None:
    """Update a peak with the extreme between two times whose slopes differ in sign, if it may exceed it."""
    sign = 1.0 if low[2] > 0 else -1.0
    best = peak.high if sign > 0 else -peak.low
    f_low, f_high, s_low, s_high = (sign * float(x) for x in (low[1], high[1], low[2], high[2]))
    # only an extreme whose cubic comes near the peak is refined
    top = cubic_peak(f_low, f_high, s_low, s_high, high[0] - low[0])[1]
    if top + CUBIC_ERROR * (top - max(f_low, f_high)) <= best:
        return

    def slope(x: float) -> float:
        return sign * function(x)[1]

    at = stationary_point(slope, low[0], high[0], s_low, s_high)
    peak.take(function(at)[0], t0 + at)
