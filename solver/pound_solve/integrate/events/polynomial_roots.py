r"""Kernels that find the first rise and the extremes of a polynomial, with proof.

On a cell of width w a polynomial of degree n is written in Bernstein's form,

.. math:: p(x + w\sigma) = \sum_j b_j \binom{n}{j} \sigma^j (1-\sigma)^{n-j}, \qquad 0 \le \sigma \le 1 .

It lies between the least and the largest :math:`b_j`, and its derivative has no more zeros there than the
differences of the :math:`b_j` have changes of sign.  Therefore a cell either cannot contain a root or
maximum, or contains exactly one, which Newton's method finds within its bracket, or is halved.  No root is
missed between samples, because there are no samples.

References
----------
Lane JM, Riesenfeld RF (1981), Bounds on a polynomial, BIT 21: 112-117; Farouki RT (2012), The Bernstein
polynomial basis: a centennial retrospective, Comput. Aided Geom. Design 29: 379-419.
"""

from __future__ import annotations

import numpy as np

from pound_solve.numerics.jit import reorder_sums
from pound_solve.numerics.types import Array

MAX_HALVINGS = 44  #: halvings of a cell, at most
COEFFICIENT_ROUNDING = 1e-15  #: fraction of the sum of the coefficients that is rounding
MAX_ROOT_TRIALS = 200  #: bisection alone needs 60; slow steps of Newton's method come on top
MAX_SUMMIT_TRIALS = 100  #: the same; bisection alone needs 30
ROOT_ROUNDING = 2e-16  #: fraction of its place to which a root is found: the last digit
#: fraction of its place to which a maximum is found: it needs half as many digits as its value
SUMMIT_ROUNDING = 1e-10
#: the work array has the polynomial in row 0 and a stack of cells in the other rows, the last of which is
#: examined; the columns after a cell's coefficients are its start and its width
POLYNOMIAL, CELLS = range(2)


def room(degree: int) -> tuple[int, int]:
    """Return the shape of the kernels' work array for polynomials of the given `degree`."""
    return MAX_HALVINGS + 2, degree + 3


@reorder_sums
def size(p: Array, row: int, degree: int) -> float:
    """Return a bound of the change of the polynomial in a row from its value at 0, over [0, 1]."""
    total = 0.0
    for k in range(1, degree + 1):
        total += abs(p[row, k])
    return total


@reorder_sums
def rate_size(p: Array, row: int, degree: int) -> float:
    """Return a bound of the change of its derivative from the value at 0, over [0, 1]."""
    total = 0.0
    for k in range(2, degree + 1):
        total += k * abs(p[row, k])
    return total


def value(p: Array, degree: int, s: float) -> float:
    """Return the value of the polynomial at `s`."""
    total: float = p[POLYNOMIAL, degree]
    for k in range(degree - 1, -1, -1):
        total = total * s + p[POLYNOMIAL, k]
    return total


def slopes(p: Array, degree: int, s: float) -> tuple[float, float]:
    """Return the first two derivatives of the polynomial at `s`."""
    first, second = 0.0, 0.0
    for k in range(degree, 0, -1):
        second = second * s + first
        first = first * s + k * p[POLYNOMIAL, k]
    return first, second


def write_in_bernstein_form(p: Array, degree: int, end: float) -> None:
    """Write the polynomial on [0, end] in Bernstein's form, into the first cell."""
    place, width = p.shape[1] - 2, p.shape[1] - 1
    scale = 1.0
    for k in range(degree + 1):
        p[CELLS, k] = p[POLYNOMIAL, k] * scale
        scale *= end * (k + 1) / (degree - k) if k < degree else 1.0
    for i in range(1, degree + 1):  # alternates between two rows, several entries at once
        for j in range(i, degree + 1):
            p[CELLS + 1, j] = p[CELLS, j] + p[CELLS, j - 1]
        for j in range(i, degree + 1):
            p[CELLS, j] = p[CELLS + 1, j]
    p[CELLS, place], p[CELLS, width] = 0.0, end


def halve_cell(p: Array, degree: int, row: int) -> None:
    """Keep the right half of a cell in its row, and put the left half into the next row (de Casteljau)."""
    place, width = p.shape[1] - 2, p.shape[1] - 1
    p[row + 1, 0] = p[row, 0]
    for i in range(1, degree + 1):
        for j in range(degree - i + 1):
            p[row, j] = 0.5 * (p[row, j] + p[row, j + 1])
        p[row + 1, i] = p[row, 0]
    half = 0.5 * p[row, width]
    p[row + 1, place], p[row + 1, width] = p[row, place], half
    p[row, place], p[row, width] = p[row, place] + half, half


def sign_changes(p: Array, degree: int, row: int, noise: float) -> tuple[float, int]:
    """Return the sign of the first difference of a cell's coefficients, and the number of sign changes."""
    first, last, count = 0.0, 0.0, 0
    for j in range(degree):
        step = p[row, j + 1] - p[row, j]
        if abs(step) <= noise:
            continue
        if last == 0.0:
            first = step
        elif (step > 0.0) != (last > 0.0):
            count += 1
        last = step
    return first, count


def highest_of(p: Array, degree: int, row: int) -> float:
    """Return the largest coefficient of a cell."""
    most: float = p[row, 0]
    for j in range(1, degree + 1):
        most = max(most, p[row, j])
    return most


def find_zero(p: Array, degree: int, low: float, high: float) -> float:
    """Return where the polynomial, not above zero at `low`, rises through zero before `high`, by Newton's
    method with a bracket.
    """
    at, last = 0.5 * (low + high), np.inf
    for _ in range(MAX_ROOT_TRIALS):
        g, slope = value(p, degree, at), slopes(p, degree, at)[0]
        if g == 0.0:
            return at
        if g > 0.0:
            high = at
        else:
            low = at
        new = at - g / slope if slope > 0.0 else low
        if not low < new < high or abs(new - at) > 0.5 * last:
            new = 0.5 * (low + high)
        last = abs(new - at)
        if last <= ROOT_ROUNDING * high or new in (low, high):
            return new
        at = new
    return at


def find_summit(p: Array, degree: int, low: float, high: float) -> float:
    """Return where the slope of the polynomial falls through zero between `low` and `high`."""
    at, last = 0.5 * (low + high), np.inf
    for _ in range(MAX_SUMMIT_TRIALS):
        slope, bend = slopes(p, degree, at)
        if slope > 0.0:
            low = at
        else:
            high = at
        new = at - slope / bend if bend < 0.0 else low
        if not low < new < high or abs(new - at) > 0.5 * last:
            new = 0.5 * (low + high)
        last = abs(new - at)
        if last <= SUMMIT_ROUNDING * high:
            return new
        at = new
    return at


def first_rise(p: Array, degree: int, end: float, tol: float) -> float:
    """Return the first point before `end` (at most 1) where the polynomial in row 0 rises through zero to
    above `tol`; -1 if there is none.

    A value above zero at 0 counts as rounding and is set to zero in row 0.  If the polynomial rises from
    there, the root is 0.
    """
    far = size(p, POLYNOMIAL, degree)
    if p[POLYNOMIAL, 0] + far <= tol:
        return -1.0
    place, width = p.shape[1] - 2, p.shape[1] - 1
    noise = COEFFICIENT_ROUNDING * (abs(p[POLYNOMIAL, 0]) + far)
    p[POLYNOMIAL, 0] = min(p[POLYNOMIAL, 0], 0.0)
    write_in_bernstein_form(p, degree, end)
    row = CELLS
    while row >= CELLS:
        if highest_of(p, degree, row) > tol:
            first, count = sign_changes(p, degree, row, noise)
            if count > 0 and row - CELLS < MAX_HALVINGS:
                halve_cell(p, degree, row)
                row += 1
                continue
            if p[row, degree] > tol and (first >= 0.0 or count > 0):
                at = p[row, place]
                return at if p[row, 0] >= 0.0 else find_zero(p, degree, at, at + p[row, width])
        row -= 1
    return -1.0


def highest(p: Array, degree: int, end: float, known: float) -> tuple[float, float]:
    """Return the largest value of the polynomial in row 0 over [0, end], with `end` at most 1, and where it
    occurs.  If that value is not above `known`, return `known` and -1.
    """
    best, where = known, -1.0
    far = size(p, POLYNOMIAL, degree)
    if p[POLYNOMIAL, 0] + far <= known:
        return best, where
    place, width = p.shape[1] - 2, p.shape[1] - 1
    noise = COEFFICIENT_ROUNDING * (abs(p[POLYNOMIAL, 0]) + far)
    write_in_bernstein_form(p, degree, end)
    row = CELLS
    while row >= CELLS:
        if highest_of(p, degree, row) > best:
            first, count = sign_changes(p, degree, row, noise)
            if count > 1 and row - CELLS < MAX_HALVINGS:
                halve_cell(p, degree, row)
                row += 1
                continue
            low = p[row, place]
            high = low + p[row, width]
            if p[row, 0] > best:
                best, where = p[row, 0], low
            if p[row, degree] > best:
                best, where = p[row, degree], high
            if count > 0 and first > 0.0:
                at = find_summit(p, degree, low, high)
                top = value(p, degree, at)
                if top > best:
                    best, where = top, at
        row -= 1
    return best, where
