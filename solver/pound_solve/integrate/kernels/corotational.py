"""Kernels of members that turn: forces and tangents of the chords (see `corotational`)."""

from __future__ import annotations

from pound_solve.integrate.kernels.state import (
    A1,
    AHEAD,
    CLEAR,
    G0,
    G1,
    REST,
    ROUNDING,
    S0,
    S1,
    U1,
    Laws,
    Matrices,
    Motion,
    Turning,
    U,
)
from pound_solve.numerics.types import Array
from pound_solve.structure.corotational import KNN, KTT, LENGTH, quantity_forces, quantity_stiffness


def locate(b: Turning, q: Array, row: int, s: Array, to: int) -> None:
    """Quantities of the chords at row `row` of `q` and the inputs `s`."""
    for c in range(len(b.p)):
        for j in range(6):
            total = 0.0
            for y in range(b.at[c], b.at[c + 1]):
                total += b.rows[y, j] * q[row, b.unknown[y]]
            for i in range(len(s)):
                total += b.inputs[c, j, i] * s[i]
            b.s[c, to + j] = total


def resist(b: Turning, c: int, q: Array, row: int, of: int) -> None:
    """Take the forces of chord `c` off row `row` of `q`."""
    for y in range(b.at[c], b.at[c + 1]):
        total = 0.0
        for j in range(6):
            total += b.rows[y, j] * b.s[c, of + j]
        q[row, b.unknown[y]] -= total


def straight_force(b: Turning, c: int, h: int, s: int, to: int, sign: float) -> None:
    """Add the force of the tangent in row `h` at the quantities in columns `s` to columns `to`."""
    for i in range(6):
        total = 0.0
        for j in range(6):
            total += b.h[h, 6 * i + j] * b.s[c, s + j]
        b.s[c, to + i] += sign * total


def stiffen(m: Matrices, b: Turning, x: Motion, c: int, h: int, factor: float, light: bool) -> None:
    """Add `factor` times the tangent of chord `c` in row `h` to A, with `light` where massless only."""
    first = b.at[c]
    for y in range(first, b.at[c + 1]):
        for i in range(6):
            total = 0.0
            for j in range(6):
                total += b.h[h, 6 * i + j] * b.rows[y, j]
            b.product[y - first, i] = factor * total
    for y in range(b.pairs[c], b.pairs[c + 1]):
        at = b.pair[y, 0]
        if light and (m.heavy[m.pattern.ai[at]] or m.heavy[m.column[at]]):
            continue
        for j in range(6):
            x.ax[at] += b.rows[b.pair[y, 1], j] * b.product[b.pair[y, 2] - first, j]


def turn_start(w: Laws, x: Motion, s: Array) -> None:
    """Quantities and forces of the chords at the start of a step."""
    b = w.corotational
    locate(b, x.q, U, s, S0)
    for c in range(len(b.p)):
        quantity_forces(b.p, c, b.s, S0, b.s, G0)


def aim(w: Laws, x: Motion, s: Array) -> None:
    """Begin the chords' iterations: a line through their forces where the step leads without its end."""
    b = w.corotational
    locate(b, x.q, U1, s, AHEAD)
    for c in range(len(b.p)):
        quantity_forces(b.p, c, b.s, AHEAD, b.s, REST)
        straight_force(b, c, c, AHEAD, REST, -1.0)


def miss(w: Laws, x: Motion, bk: float) -> float:
    """Find the chords' forces for the accelerations tried, and their largest distance from the line,
    over that allowed; lead the line through them.
    """
    b, worst = w.corotational, 0.0
    size = b.most[0]
    for c in range(len(b.p)):
        for j in range(6):
            total = 0.0
            for y in range(b.at[c], b.at[c + 1]):
                total += b.rows[y, j] * x.q[A1, b.unknown[y]]
            b.s[c, S1 + j] = b.s[c, AHEAD + j] + bk * total
        quantity_forces(b.p, c, b.s, S1, b.s, G1)
        size = max(size, chord_force(b, c))
    for c in range(len(b.p)):
        length, knn = b.p[c, LENGTH], b.p[c, KNN]
        allowed = CLEAR * size + ROUNDING * knn * (length + abs(b.s[c, S1 + 2]) + abs(b.s[c, S1 + 3]))
        straight_force(b, c, c, S1, REST, 1.0)
        for j in range(6):
            off = abs(b.s[c, G1 + j] - b.s[c, REST + j])
            if j == 0:
                off *= knn
            elif j == 1:
                off *= b.p[c, KTT] / length
            elif j > 3:
                off /= length
            worst = off / allowed if not off <= worst * allowed else worst
            b.s[c, REST + j] = b.s[c, G1 + j]
        straight_force(b, c, c, S1, REST, -1.0)
    return worst


def chord_force(b: Turning, c: int) -> float:
    """Size of the forces of chord `c` at the end of the step."""
    return max(
        abs(b.s[c, S1]), abs(b.s[c, S1 + 1]) / b.p[c, LENGTH], abs(b.s[c, G1 + 2]), abs(b.s[c, G1 + 3])
    )


def linearise(b: Turning, s: int) -> None:
    """Take the chords' tangents at the quantities in columns `s` for the factor to come."""
    for c in range(len(b.p)):
        quantity_stiffness(b.p, c, b.s, s, b.h, c)
