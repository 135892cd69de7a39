"""Cubics through values and slopes at two ends, and interpolation towards a zero."""

from __future__ import annotations

import numpy as np

MAX_HALVINGS = 60  #: of the length, to a place where the cubic is below zero
MAX_TRIALS = 60  #: for a rise: bisection alone needs 50
RISE_ROUNDING = 1e-15  #: fraction of the length to which a rise is found


def next_trial(a: float, b: float, c: float, ga: float, gb: float, gc: float) -> float:
    """Return the next trial for a zero of g between `a` and `b`, where g has opposite signs, by inverse
    quadratic interpolation with the earlier trial `c`, or by the secant if `gc` is unknown.
    """
    fraction = ga / (ga - gb)
    if gc == gc:
        fraction = ga / (gb - ga) * gc / (gb - gc) + (c - a) / (b - a) * ga / (gc - ga) * gb / (gc - gb)
    return a + fraction * (b - a)


def cubic_peak(g0: float, g1: float, s0: float, s1: float, h: float) -> tuple[float, float]:
    """Return the position and value of the maximum of a cubic that rises at 0 and falls at `h`."""
    a = 2.0 * (g0 - g1) / (h * h * h) + (s0 + s1) / (h * h)
    b = 3.0 * (g1 - g0) / (h * h) - (2.0 * s0 + s1) / h
    q = b * b - 3.0 * a * s0
    at = -1.0
    if q >= 0.0:
        # the form of the root without cancellation
        if b < 0.0:
            at = s0 / (np.sqrt(q) - b)
        elif a != 0.0:
            at = -(b + np.sqrt(q)) / (3.0 * a)
    if 0.0 <= at <= h:
        return at, ((a * at + b) * at + s0) * at + g0
    return (0.0, g0) if g0 > g1 else (h, g1)


def cubic_value(g0: float, g1: float, s0: float, s1: float, h: float, t: float) -> float:
    """Return the value at `t` of the cubic with values `g0`, `g1` and slopes `s0`, `s1` at 0 and `h`."""
    a = 2.0 * (g0 - g1) / (h * h * h) + (s0 + s1) / (h * h)
    b = 3.0 * (g1 - g0) / (h * h) - (2.0 * s0 + s1) / h
    return ((a * t + b) * t + s0) * t + g0


def cubic_rise(g0: float, g1: float, s0: float, s1: float, h: float) -> float:
    """Return where a cubic that is at most zero at 0 and positive at `h` first rises through zero."""
    if g0 >= 0.0 and s0 > 0.0:
        return 0.0
    a = 2.0 * (g0 - g1) / (h * h * h) + (s0 + s1) / (h * h)
    b = 3.0 * (g1 - g0) / (h * h) - (2.0 * s0 + s1) / h
    low, high = 0.0, h
    if g0 >= 0.0:  # it falls from zero first
        at = h
        for _ in range(MAX_HALVINGS):
            at *= 0.5
            if ((a * at + b) * at + s0) * at + g0 < 0.0:
                low = at
                break
    at = 0.5 * (low + high)
    if g0 < 0.0:
        at = h * g0 / (g0 - g1)
    for _ in range(MAX_TRIALS):
        g = ((a * at + b) * at + s0) * at + g0
        if g > 0.0:
            high = at
        else:
            low = at
        s = (3.0 * a * at + 2.0 * b) * at + s0
        new = at - g / s if s > 0.0 else -1.0
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - at) <= RISE_ROUNDING * h:
            break
        at = new
    return at
