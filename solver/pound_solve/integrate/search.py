"""Search for events and peaks: bracketed on a grid by value and slope, then polished.

Functions here see numbers only: sampled values and slopes, and a function that evaluates exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from pound_solve.integrate.base import Peak
from pound_solve.integrate.exits import summit

Array = NDArray[np.float64]
Exact = Callable[[int, float], tuple[float, float]]  #: value and slope of function n at time t


def first_rise(t: Array, g: Array, slope: Array, tol: Array, exact: Exact) -> tuple[float, int] | None:
    """Return when and which of some functions first rises through zero.

    Parameters
    ----------
    t : ndarray, shape (n_t,)
        Grid times, the first being the start of a branch or where it was left off.
    g, slope : ndarray, shape (n, n_t)
        Sampled values and slopes; `g` is changed at the start, where a value above zero is rounding.
    tol : ndarray, shape (n, 1)
        Values up to which a function counts as not above zero.
    exact : callable
        Evaluates function n at a time.
    """
    g[:, 0] = np.minimum(g[:, 0], 0.0)
    crossed = (g[:, 1:] > tol) & (g[:, :-1] <= tol)
    # up and down again within one interval: where the end tangents meet above zero it is looked at closely
    turn = (slope[:, :-1] > 0) & (slope[:, 1:] < 0) & (g[:, 1:] <= tol) & (g[:, :-1] <= tol)
    if turn.any():
        with np.errstate(divide="ignore", invalid="ignore"):
            x = (g[:, 1:] - g[:, :-1] - slope[:, 1:] * np.diff(t)) / (slope[:, :-1] - slope[:, 1:])
            turn &= g[:, :-1] + slope[:, :-1] * x > tol
    for j in np.flatnonzero((crossed | turn).any(axis=0)):
        best: tuple[float, int] | None = None
        for n in np.flatnonzero(crossed[:, j] | turn[:, j]).tolist():
            low, high = float(t[j]), float(t[j + 1])
            if not crossed[n, j]:
                top = turning(lambda x, n=n: exact(n, x)[1], low, high, slope[n, j], slope[n, j + 1])  # type: ignore[misc]
                if exact(n, top)[0] <= tol[n, 0]:
                    continue
                high = top
            elif j == 0 and g[n, 0] == 0.0:
                if slope[n, 0] > 0.0:
                    return low, n  # it leaves at once
                low = _dip(lambda x, n=n: exact(n, x)[0], low, high)  # type: ignore[misc]
            if crossed[n, j] and low == t[j] and g[n, j] == 0.0:
                return low, n  # it rises from the start, however slowly
            at = _root(lambda x, n=n: exact(n, x), low, high)  # type: ignore[misc]
            if best is None or at < best[0]:
                best = at, n
        if best is not None:
            return best
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


def widen(peaks: Sequence[Peak], t0: float, t: Array, value: Array, rate: Array, exact: Exact) -> None:
    """Count sampled functions into their peaks, and what rises beyond them between the samples, polished.

    Parameters
    ----------
    peaks : sequence of Peak
        One for each function.
    t0 : float
        Time of the window's start [T]; `t` counts from it.
    t : ndarray, shape (n_t,)
    value, rate : ndarray, shape (n, n_t)
    exact : callable
        Evaluates function n at a local time.
    """
    if not len(peaks):
        return
    hi, lo = value.argmax(axis=1), value.argmin(axis=1)
    every = np.arange(len(peaks))
    for peak, x, j, y, k in zip(peaks, value[every, hi].tolist(), hi, value[every, lo].tolist(), lo):
        if x > peak.high:
            peak.take(x, t0 + float(t[j]))
        if y < peak.low:
            peak.take(y, t0 + float(t[k]))
    f0, s0, s1 = value[:, :-1], rate[:, :-1], rate[:, 1:]
    turn = s0 * s1 < 0
    if not turn.any():
        return
    known = np.array([[peak.high, peak.low] for peak in peaks])[:, :, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        # where the end tangents meet bounds the turning point of a smooth arc
        meet = f0 + s0 * (value[:, 1:] - f0 - s1 * np.diff(t)) / (s0 - s1)
    beyond = turn & (((s0 > 0) & (meet > known[:, 0])) | ((s0 < 0) & (meet < known[:, 1])))
    for i, j in zip(*np.nonzero(beyond)):
        i, sign = int(i), 1.0 if s0[i, j] > 0 else -1.0
        best = peaks[i].high if sign > 0 else -peaks[i].low
        f_low, f_high, s_low, s_high = (
            sign * float(x) for x in (f0[i, j], value[i, j + 1], s0[i, j], s1[i, j])
        )
        # the cubic through both ends tells whether it can win; only then is it polished
        top = summit(f_low, f_high, s_low, s_high, float(t[j + 1] - t[j]))[1]
        if top + 0.02 * (top - max(f_low, f_high)) <= best:
            continue

        def slope(x: float, i: int = i, sign: float = sign) -> float:
            return sign * exact(i, x)[1]

        at = turning(slope, float(t[j]), float(t[j + 1]), s_low, s_high)
        peaks[i].take(exact(i, at)[0], t0 + at)
