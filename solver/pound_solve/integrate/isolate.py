r"""Kernels that find the first rise and the extremes of a polynomial, with proof.

About any place x of its interval a polynomial is written in powers of :math:`s - x`.  Over a cell of
width w it keeps within

.. math:: B = \sum_{k \ge 1} |p_k|\, w^k

of its value :math:`p_0` there, and it is monotone where :math:`|p_1| > \sum_{k \ge 2} k |p_k|\, w^{k-1}`.
A cell that can be settled neither way is halved.  So nothing is missed between samples: there are none.
This is exclusion by a Taylor form, as interval arithmetic does it.

References
----------
Neumaier A (1990), Interval Methods for Systems of Equations, Cambridge University Press
(centred forms and exclusion).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pound_solve.jit import loose

Array = NDArray[np.float64]

NARROW = 1e-13  #: share of the interval below which a cell is not halved any more
POLYNOMIAL, ABOUT = range(
    2
)  #: rows of what these kernels work on: a polynomial, and it about another place


def about(p: Array, terms: int, x: float) -> None:
    """Write the polynomial in row 0 about the place `x`, into row 1."""
    for k in range(terms + 1):
        p[ABOUT, k] = p[POLYNOMIAL, k]
    if x != 0.0:
        for i in range(terms):
            for k in range(terms - 1, i - 1, -1):
                p[ABOUT, k] += x * p[ABOUT, k + 1]


def value(p: Array, terms: int, s: float) -> float:
    """Value of the polynomial in row 1, `s` away from its place."""
    total = p[ABOUT, terms]
    for k in range(terms - 1, -1, -1):
        total = total * s + p[ABOUT, k]
    return total


def slope(p: Array, terms: int, s: float) -> float:
    """Slope of the polynomial in row 1, `s` away from its place."""
    total = terms * p[ABOUT, terms]
    for k in range(terms - 1, 0, -1):
        total = total * s + k * p[ABOUT, k]
    return total


def reach(p: Array, terms: int, w: float) -> float:
    """How far the polynomial in row 1 can come from its value at its place, up to `w` away."""
    total = 0.0
    for k in range(terms, 0, -1):
        total = (total + abs(p[ABOUT, k])) * w
    return total


@loose
def size(p: Array, row: int, terms: int) -> float:
    """How far the polynomial in a row can come from its value at 0, up to 1."""
    total = 0.0
    for k in range(1, terms + 1):
        total += abs(p[row, k])
    return total


def swing(p: Array, terms: int, w: float, order: int) -> float:
    """How far the derivative of an order, 1 or 2, of that in row 1 can come from its value at its place."""
    total = 0.0
    for k in range(terms, order, -1):
        share = k if order == 1 else k * (k - 1)
        total = (total + share * abs(p[ABOUT, k])) * w
    return total


def zero(p: Array, terms: int, w: float) -> float:
    """Where the polynomial in row 1, monotone and not above zero at its place, rises through zero before
    `w`: Newton's method, kept in its bracket.
    """
    low, high, at, last = 0.0, w, 0.5 * w, np.inf
    for _ in range(200):
        g, rate = value(p, terms, at), slope(p, terms, at)
        if g == 0.0:
            return at
        if g > 0.0:
            high = at
        else:
            low = at
        new = at - g / rate if rate > 0.0 else low
        if not low < new < high or abs(new - at) > 0.5 * last:
            new = 0.5 * (low + high)
        last = abs(new - at)
        if last <= 2e-16 * high or new in (low, high):
            return new
        at = new
    return at


def first_rise(p: Array, terms: int, end: float, tol: float) -> float:
    """First place before `end`, which is 1 at most, where the polynomial in row 0 rises through zero, to
    above `tol`; -1 if there is none.

    A value above zero at 0 counts as rounding there: if it rises from it, then at once.
    """
    if p[POLYNOMIAL, 0] + size(p, POLYNOMIAL, terms) <= tol:
        return -1.0
    x, w = 0.0, end
    while x < end:
        w = min(w, end - x)
        about(p, terms, x)
        if x == 0.0:
            p[ABOUT, 0] = min(p[ABOUT, 0], 0.0)
        if p[ABOUT, 0] + reach(p, terms, w) > tol:
            steep, bend = p[ABOUT, 1], swing(p, terms, w, 1)
            narrow = w <= NARROW * end
            if not narrow and abs(steep) <= bend:
                w *= 0.5
                continue
            if (steep > 0.0 or narrow) and value(p, terms, w) > tol:
                return x if p[ABOUT, 0] >= 0.0 else x + zero(p, terms, w)
        x += w
        w *= 2.0
    return -1.0


def highest(p: Array, terms: int, end: float, known: float) -> tuple[float, float]:
    """Largest value in [0, end] of the polynomial in row 0, and its place, if it is above one that is
    `known`; else that and -1.
    """
    best, place = known, -1.0
    if p[POLYNOMIAL, 0] + size(p, POLYNOMIAL, terms) <= known:
        return best, place
    if p[POLYNOMIAL, 0] > best:
        best, place = p[POLYNOMIAL, 0], 0.0
    x, w = 0.0, end
    while x < end:
        w = min(w, end - x)
        about(p, terms, x)
        if p[ABOUT, 0] + reach(p, terms, w) > best:
            if abs(p[ABOUT, 1]) <= swing(p, terms, w, 1):
                bend = 2.0 * p[ABOUT, 2]
                if abs(bend) <= swing(p, terms, w, 2) and w > NARROW * end:
                    w *= 0.5
                    continue
                if p[ABOUT, 1] > 0.0 and bend < 0.0 and slope(p, terms, w) < 0.0:  # one summit
                    top = summit(p, terms, w)
                    high = value(p, terms, top)
                    if high > best:
                        best, place = high, x + top
            high = value(p, terms, w)
            if high > best:
                best, place = high, x + w
        x += w
        w *= 2.0
    return best, place


def summit(p: Array, terms: int, w: float) -> float:
    """Where the slope of the polynomial in row 1, which falls all the way, is zero before `w`."""
    low, high, at, last = 0.0, w, 0.5 * w, np.inf
    for _ in range(100):
        rate, bend = slope(p, terms, at), 0.0
        for k in range(terms, 1, -1):
            bend = bend * at + k * (k - 1) * p[ABOUT, k]
        if rate > 0.0:
            low = at
        else:
            high = at
        new = at - rate / bend if bend < 0.0 else low
        if not low < new < high or abs(new - at) > 0.5 * last:
            new = 0.5 * (low + high)
        last = abs(new - at)
        if last <= 1e-10 * high:  # half as many digits as its value
            return new
        at = new
    return at
