"""Kernels that find where a law leaves its branch within a step."""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.kernels.laws import along
from pound_solve.integrate.kernels.state import (
    A1,
    BACK,
    EXIT,
    LD,
    LD1,
    LV,
    LV1,
    MOST_D,
    MOST_V,
    N_EXITS,
    A,
    Laws,
    Motion,
)
from pound_solve.integrate.protocol import STILL


def excess(w: Laws, i: int, e: int, d: float, v: float) -> tuple[float, float]:
    """How far law `i` is beyond its exit `e` at deformation `d` and rate `v`, and the size of the terms."""
    fd, fv, fc = w.f[i, EXIT + 3 * e], w.f[i, EXIT + 3 * e + 1], w.f[i, EXIT + 3 * e + 2]
    if fd == 0.0 and fc == 0.0:  # what hardly moves would turn again and again
        fc = -BACK * abs(fv) * w.f[i, MOST_V]
    return fd * d + fv * v + fc, abs(fd) * w.f[i, MOST_D] + abs(fv) * w.f[i, MOST_V] + abs(fc)


def behind(w: Laws, x: Motion, i: int, e: int) -> float:
    """Excess at the start of the step, for an interpolation; NaN where it falls at first.

    A law that has just come through an exit and moves on stands next to zero there: an interpolation would
    take the way back to that exit, late in the step, for one at once.
    """
    d, v = w.f[i, LD], w.f[i, LV]
    fd, fv = w.f[i, EXIT + 3 * e], w.f[i, EXIT + 3 * e + 1]
    slope = fd * v
    if fv != 0.0:
        slope += fv * along(w.rows, i, x.q, A)
    return np.nan if slope < 0.0 else excess(w, i, e, d, v)[0]


def first_exit(w: Laws, x: Motion, h: float) -> tuple[int, int, float]:
    """The first exit that is passed in the step of length `h` that was tried.

    Returns
    -------
    law, exit, time : int, int, float
        Law -1 where there is none; the time is that of the cubic through values and slopes at both ends,
        for an exit at a rate that of the straight line.
    """
    best, best_law, best_exit = np.inf, -1, -1
    for i in range(len(w.i)):
        d, v, d1, v1 = w.f[i, LD], w.f[i, LV], w.f[i, LD1], w.f[i, LV1]
        for e in range(w.i[i, N_EXITS]):
            fd, fv = w.f[i, EXIT + 3 * e], w.f[i, EXIT + 3 * e + 1]
            if fd == 0.0 and fv == 0.0:
                continue
            g1, size = excess(w, i, e, d1, v1)
            s0, s1 = fd * v, fd * v1
            turns = s0 > 0.0 and s1 < 0.0
            if g1 <= 0.0 and not turns:
                continue
            tol = STILL * max(size, abs(g1))
            if g1 <= tol and not turns:
                continue
            if fv != 0.0:
                s0 += fv * along(w.rows, i, x.q, A)
                s1 += fv * along(w.rows, i, x.q, A1)
            g0 = min(excess(w, i, e, d, v)[0], 0.0)  # a branch holds when it is entered
            if g1 > tol and g0 < 0.0 and fd == 0.0:  # accelerations of massless unknowns would mislead
                at = h * g0 / (g0 - g1)
            elif g1 > tol:
                at = root(g0, g1, s0, s1, h)
            else:
                at, top = summit(g0, g1, s0, s1, h)
                if top <= tol:
                    continue
                at = root(g0, top, s0, 0.0, at)
            if at < best:
                best, best_law, best_exit = at, i, e
    return best_law, best_exit, best


def between(a: float, b: float, c: float, ga: float, gb: float, gc: float) -> float:
    """Next trial for a zero of g between `a` and `b`, where its signs differ, by inverse quadratic
    interpolation with `c`, tried before; by the secant where `gc` is not known.
    """
    share = ga / (ga - gb)
    if gc == gc:
        share = ga / (gb - ga) * gc / (gb - gc) + (c - a) / (b - a) * ga / (gc - ga) * gb / (gc - gb)
    return a + share * (b - a)


def summit(g0: float, g1: float, s0: float, s1: float, h: float) -> tuple[float, float]:
    """Place and value of the maximum of a cubic that rises at 0 and falls at `h`."""
    a = 2.0 * (g0 - g1) / (h * h * h) + (s0 + s1) / (h * h)
    b = 3.0 * (g1 - g0) / (h * h) - (2.0 * s0 + s1) / h
    q = b * b - 3.0 * a * s0
    at = -1.0
    if q >= 0.0:
        # of the two forms of the root the one without cancellation
        if b < 0.0:
            at = s0 / (np.sqrt(q) - b)
        elif a != 0.0:
            at = -(b + np.sqrt(q)) / (3.0 * a)
    if 0.0 <= at <= h:
        return at, ((a * at + b) * at + s0) * at + g0
    return (0.0, g0) if g0 > g1 else (h, g1)


def root(g0: float, g1: float, s0: float, s1: float, h: float) -> float:
    """First place where a cubic that is not above zero at 0 and above it at `h` rises through zero."""
    if g0 >= 0.0 and s0 > 0.0:
        return 0.0
    a = 2.0 * (g0 - g1) / (h * h * h) + (s0 + s1) / (h * h)
    b = 3.0 * (g1 - g0) / (h * h) - (2.0 * s0 + s1) / h
    low, high = 0.0, h
    if g0 >= 0.0:  # it falls from zero first
        at = h
        for _ in range(60):
            at *= 0.5
            if ((a * at + b) * at + s0) * at + g0 < 0.0:
                low = at
                break
    at = 0.5 * (low + high)
    if g0 < 0.0:
        at = h * g0 / (g0 - g1)
    for _ in range(60):
        g = ((a * at + b) * at + s0) * at + g0
        if g > 0.0:
            high = at
        else:
            low = at
        s = (3.0 * a * at + 2.0 * b) * at + s0
        new = at - g / s if s > 0.0 else -1.0
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - at) <= 1e-15 * h:
            break
        at = new
    return at
