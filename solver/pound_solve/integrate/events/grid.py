"""Search for events and peaks: bracketed on a grid by value and slope, then polished.

Functions here see numbers only: sampled values and slopes, and a function that evaluates exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from pound_solve.integrate.protocol import STILL, Peak
from pound_solve.numerics.cubic import cubic_peak
from pound_solve.numerics.types import Array, Flags

#: value and slope of function n in some arc and cell at time t
Exact = Callable[[int, int, int, float], tuple[float, float]]
Ends = tuple[float, float, float]  #: a time, and value and slope there


def may_rise(g: Array, slope: Array, bend: Array, width: Array) -> Flags:
    """Return in which cells functions may rise through zero: where they are above it at the end, or
    where they turn and are not kept below it by how little they can bend.

    A function keeps within ``bend width^2 / 8`` of its chord, and it is monotone where its mean slope
    at both ends is above ``bend width / 2``.

    Parameters
    ----------
    g, slope : ndarray, shape (n, n_arcs, n_points)
    bend : ndarray, shape (n, n_arcs)
        Bounds of the second derivatives.
    width : ndarray, shape (n_arcs, n_points - 1)
        Of the cells between the points.
    """
    bend = bend[:, :, None]
    turns = np.abs(slope[..., :-1] + slope[..., 1:]) <= bend * width
    above = np.maximum(g[..., :-1], g[..., 1:]) + bend * (width**2 / 8.0) > 0.0
    return np.asarray((g[..., 1:] > 0.0) | (turns & above))


def may_peak(value: Array, slope: Array, bend: Array, width: Array, peaks: Sequence[Peak]) -> Flags:
    """Return in which cells functions may go beyond their peaks and all points up to there
    (see `may_rise`).
    """
    bend, shape = bend[:, :, None], value.shape
    turns = np.abs(slope[..., :-1] + slope[..., 1:]) <= bend * width
    known = np.array([[peak.high, peak.low] for peak in peaks])
    slack = bend * (width**2 / 8.0)
    flat = value.reshape(len(value), -1)
    high = np.maximum(np.maximum.accumulate(flat, axis=1), known[:, :1]).reshape(shape)[..., 1:]
    low = np.minimum(np.minimum.accumulate(flat, axis=1), known[:, 1:]).reshape(shape)[..., 1:]
    beyond = (np.maximum(value[..., :-1], value[..., 1:]) + slack > high) | (
        np.minimum(value[..., :-1], value[..., 1:]) - slack < low
    )
    return np.asarray(turns & beyond & (slack > 0.0))


def waves(t: Array, value: Array, slope: Array) -> tuple[Flags, Array]:
    """Return in which cells functions may turn twice, their slopes having one sign at both ends: where the
    cubics through both ends do; and where that turns from one to the other, as a time.

    Not where values are as far from what the slopes make of them as rounding is: in a cell that is next to
    nothing this would be a wave.
    """
    width, rise = np.diff(t), np.diff(value)
    s0, s1 = slope[..., :-1], slope[..., 1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = rise / width
        a, b = s0 + s1 - 2.0 * mean, 3.0 * mean - 2.0 * s0 - s1
        at = -b / (3.0 * a)  # where the cubic's slope, s0 + 2 b x + 3 a x^2, is least or largest
        twice = (s0 * s1 > 0.0) & (at > 0.0) & (at < 1.0) & ((s0 + b * at) * s0 < 0.0)
        still = STILL * np.abs(value).max(axis=(1, 2), keepdims=True)
        twice &= np.abs(rise - 0.5 * (s0 + s1) * width) > still
    return twice, t[..., :-1] + at * width


def turn(u0: Array, u1: Array, v0: Array, v1: Array) -> tuple[Array, Array]:
    """Place from 0 to 1, and value, of the extreme of cubics with values and slopes at 0 and 1, which
    have slopes of different sign there; shape (n,) each.
    """
    rise = u1 - u0
    b, c = 3.0 * rise - 2.0 * v0 - v1, v0 + v1 - 2.0 * rise  # slope: v0 + 2 b s + 3 c s^2
    root = np.copysign(np.sqrt(b * b - 3.0 * c * v0), v0)
    # of the two forms of the zero the one without cancellation
    plain = b * v0 <= 0.0
    s = np.where(plain, v0, -b - root) / np.where(plain, root - b, 3.0 * c)
    return s, u0 + s * (v0 + s * (b + s * c))


def first_rise(
    t: Array, g: Array, slope: Array, tol: Array, exact: Exact
) -> tuple[float, int, int, int] | None:
    """Return when, which of some functions and where first rises through zero.

    Parameters
    ----------
    t : ndarray, shape (n_arcs, n_points)
        Rising times on arcs one after the other, the first being the start of a branch or where it was left
        off.
    g, slope : ndarray, shape (n, n_arcs, n_points)
        Sampled values and slopes; `g` is changed at the start, where a value above zero is rounding.
    tol : ndarray, shape (n, 1, 1)
        Values up to which a function counts as not above zero.
    exact : callable
        Evaluates function n in a cell.

    Returns
    -------
    tuple of (time, n, arc, cell), or None
    """
    g[:, 0, 0] = np.minimum(g[:, 0, 0], 0.0)
    g0, g1, s0, s1 = g[..., :-1], g[..., 1:], slope[..., :-1], slope[..., 1:]
    crossed = (g1 > tol) & (g0 <= tol)
    # up and down again within one cell: where the end tangents meet above zero it is looked at closely
    below = (g1 <= tol) & (g0 <= tol)
    turn = (s0 > 0) & (s1 < 0) & below
    if turn.any():
        with np.errstate(divide="ignore", invalid="ignore"):
            turn &= g0 + s0 * ((g1 - g0 - s1 * np.diff(t)) / (s0 - s1)) > tol
    twice, split = waves(t, g, slope)
    twice &= below
    turn |= twice
    for k, j in np.argwhere((crossed | turn).any(axis=0)).tolist():
        best: tuple[float, int] | None = None
        for n in np.flatnonzero(crossed[:, k, j] | turn[:, k, j]).tolist():
            low, high = float(t[k, j]), float(t[k, j + 1])

            def own(x: float, n: int = n, k: int = k, j: int = j) -> tuple[float, float]:
                return exact(n, k, j, x)

            if not crossed[n, k, j]:
                start, s_start, s_end = low, float(slope[n, k, j]), float(slope[n, k, j + 1])
                if twice[n, k, j]:
                    middle = float(split[n, k, j])
                    s_middle = own(middle)[1]
                    if s_middle * s_start >= 0.0:
                        continue
                    if s_start > 0.0:
                        high, s_end = middle, s_middle
                    else:
                        start, s_start = middle, s_middle
                top = turning(lambda x, own=own: own(x)[1], start, high, s_start, s_end)  # type: ignore[misc]
                if own(top)[0] <= tol[n, 0, 0]:
                    continue
                high = top
            elif k == j == 0 and g[n, 0, 0] == 0.0:
                if slope[n, 0, 0] > STILL * np.abs(slope[n]).max():
                    return low, n, k, j  # it leaves at once, not by the rounding of its slope
                low = _dip(lambda x, own=own: own(x)[0], low, high)  # type: ignore[misc]
            if crossed[n, k, j] and low == t[k, j] and g[n, k, j] == 0.0:
                return low, n, k, j  # it rises from the start, however slowly
            at = _root(own, low, high)
            if best is None or at < best[0]:
                best = at, n
        if best is not None:
            return *best, k, j
    return None


def _dip(value: Callable[[float], float], start: float, high: float) -> float:
    """A time after `start` where a function is below zero that starts there at zero and falls first."""
    width = high - start
    for _ in range(60):
        width *= 0.5
        if value(start + width) < 0.0:
            return start + width
    return start


def _root(exact: Callable[[float], tuple[float, float]], low: float, high: float) -> float:
    """Root of a function that rises through zero in (low, high): Newton, kept inside its bracket."""
    x, last = 0.5 * (low + high), np.inf
    for _ in range(200):
        g, slope = exact(x)
        if g == 0.0:
            return x
        if g > 0.0:
            high = x
        else:
            low = x
        new = x - g / slope if slope > 0.0 else 0.5 * (low + high)
        if not low < new < high or abs(new - x) > 0.5 * last:  # outside, or Newton stalls: halve
            new = 0.5 * (low + high)
        if abs(new - x) <= 4e-16 * high or new in (low, high):
            return new
        last, x = abs(new - x), new
    return x


def turning(slope: Callable[[float], float], low: float, high: float, s_low: float, s_high: float) -> float:
    """Zero of a slope that falls through zero in (low, high): the Illinois form of regula falsi.

    At a peak a slope of 1e-8 of the ends' costs 1e-16 of the arc's height, so that much is enough.
    """
    side, x, steep = 0, low, s_low - s_high
    for _ in range(60):
        x = (s_low * high - s_high * low) / (s_low - s_high)
        s = slope(x)
        if abs(s) < 1e-8 * steep or high - low < 1e-9 * high:
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


def count(peaks: Sequence[Peak], t: Array, value: Array) -> None:
    """Count sampled functions, shape (n, n_t), into their peaks."""
    hi, lo = value.argmax(axis=1), value.argmin(axis=1)
    every = np.arange(len(peaks))
    for peak, x, j, y, k in zip(peaks, value[every, hi].tolist(), hi, value[every, lo].tolist(), lo):
        if x > peak.high:
            peak.take(x, float(t[j]))
        if y < peak.low:
            peak.take(y, float(t[k]))


def widen(peaks: Sequence[Peak], t0: float, t: Array, value: Array, rate: Array, exact: Exact) -> None:
    """Count sampled functions into their peaks, and what rises beyond them between the samples, polished.

    Parameters
    ----------
    peaks : sequence of Peak
        One for each function.
    t0 : float
        Time of the window's start [T]; `t` counts from it.
    t : ndarray, shape (n_arcs, n_points)
    value, rate : ndarray, shape (n, n_arcs, n_points)
    exact : callable
        Evaluates function n in a cell.
    """
    if not len(peaks):
        return
    count(peaks, t0 + t.ravel(), value.reshape(len(value), -1))
    f0, s0, s1 = value[..., :-1], rate[..., :-1], rate[..., 1:]
    turn = s0 * s1 < 0
    twice, split = waves(t, value, rate)
    if not (turn.any() or twice.any()):
        return
    known = np.array([[peak.high, peak.low] for peak in peaks])[:, :, None, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        # where the end tangents meet bounds the turning point of a smooth arc
        meet = f0 + s0 * (value[..., 1:] - f0 - s1 * np.diff(t)) / (s0 - s1)
    beyond = turn & (((s0 > 0) & (meet > known[:, 0])) | ((s0 < 0) & (meet < known[:, 1])))

    def polish(i: int, k: int, j: int, low: Ends, high: Ends) -> None:
        """Count in the turning point between two places, where the slopes differ in sign."""
        sign = 1.0 if low[2] > 0 else -1.0
        best = peaks[i].high if sign > 0 else -peaks[i].low
        f_low, f_high, s_low, s_high = (sign * float(x) for x in (low[1], high[1], low[2], high[2]))
        # the cubic through both ends tells whether it can win; only then is it polished
        top = cubic_peak(f_low, f_high, s_low, s_high, high[0] - low[0])[1]
        if top + 0.02 * (top - max(f_low, f_high)) <= best:
            return

        def slope(x: float) -> float:
            return sign * exact(i, k, j, x)[1]

        at = turning(slope, low[0], high[0], s_low, s_high)
        peaks[i].take(exact(i, k, j, at)[0], t0 + at)

    for i, k, j in np.argwhere(beyond | twice).tolist():
        low, high = ((float(t[k, n]), float(value[i, k, n]), float(rate[i, k, n])) for n in (j, j + 1))
        if not twice[i, k, j]:
            polish(i, k, j, low, high)
            continue
        middle = float(split[i, k, j])
        between = (middle, *exact(i, k, j, middle))
        if between[2] * low[2] < 0.0:
            polish(i, k, j, low, between)
            polish(i, k, j, between, high)
