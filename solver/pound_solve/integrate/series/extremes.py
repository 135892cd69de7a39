"""Kernel for the largest and the smallest values of rows on the motion over the stored steps.

Within a step such a row is a polynomial, whose extremes are isolated with proof
(`events.polynomial_roots`).  Its value at the start and the sizes of its terms show beforehand whether it
can exceed the extremes known so far; it seldom can.
"""

from __future__ import annotations

from typing import NamedTuple

from pound_solve.integrate.events.polynomial_roots import POLYNOMIAL, highest, size
from pound_solve.integrate.series.envelope_buffers import STEPS
from pound_solve.integrate.series.expansion import derivative_factor
from pound_solve.integrate.series.state import EnvelopeBuffers
from pound_solve.numerics.ldl import Positions
from pound_solve.numerics.types import Array, Index


class RowExtremes(NamedTuple):
    """Rows on the series of a step, and their extremes.

    Attributes
    ----------
    pointers : ndarray, shape (n_rows + 1,)
        Where the entries of each row begin.
    source, derivative, factors : ndarray, shape (n_entries,)
        Number of the series: of an unknown or a force (see `EnvelopeBuffers`), then of the inputs; order of
        its derivative; factor of that.
    constant : ndarray, shape (n_rows,)
    high, t_high, low, t_low : ndarray, shape (n_rows,)
        Largest and smallest values so far, and their times.
    first, far : ndarray, shape (n_series, 3)
        For the derivatives of every series in the present step: value at the start, and a bound of the
        change.
    polynomial : ndarray
        Work space, see `polynomial_roots.room`.
    """

    pointers: Positions
    source: Positions
    derivative: Index
    factors: Array
    constant: Array
    high: Array
    t_high: Array
    low: Array
    t_low: Array
    first: Array
    far: Array
    polynomial: Array


def bound_series(extremes: RowExtremes, i: int, c: Array, degree: int, h: float) -> None:
    """Compute value and first two derivatives of series `i` at the start of a step, and bounds of their
    changes in it.
    """
    zeroth, first, second = abs(c[1]) + abs(c[2]), 2.0 * abs(c[2]), 0.0
    for k in range(3, degree + 1):
        zeroth += abs(c[k])
        first += k * abs(c[k])
        second += k * (k - 1) * abs(c[k])
    extremes.first[i, 0], extremes.first[i, 1], extremes.first[i, 2] = c[0], c[1] / h, 2.0 * c[2] / h / h
    extremes.far[i, 0], extremes.far[i, 1], extremes.far[i, 2] = zeroth, first / h, second / h / h


def may_exceed(extremes: RowExtremes, r: int) -> bool:
    """Return whether row `r` may exceed its extremes in the present step."""
    first, far = extremes.constant[r], 0.0
    for q in range(extremes.pointers[r], extremes.pointers[r + 1]):
        i, order, factor = extremes.source[q], extremes.derivative[q], extremes.factors[q]
        first += factor * extremes.first[i, order]
        far += abs(factor) * extremes.far[i, order]
    return bool(first + far > extremes.high[r] or first - far < extremes.low[r])


def add_derivative(c: Array, degree: int, order: int, factor: float, p: Array) -> None:
    """Add a derivative of a series, times a factor, to a polynomial."""
    for k in range(degree + 1 - order):
        p[k] += factor * derivative_factor(k + order, order, 1.0) * c[k + order]


def form_row(envelope: EnvelopeBuffers, inputs: Array, extremes: RowExtremes, s: int, r: int) -> None:
    """Write row `r` in step `s` as a polynomial into the work space."""
    p, degree, n = extremes.polynomial[POLYNOMIAL], envelope.degree[s], envelope.coefs.shape[1]
    for k in range(degree + 1):
        p[k] = 0.0
    p[0] = extremes.constant[r]
    for q in range(extremes.pointers[r], extremes.pointers[r + 1]):
        i, order, factor = extremes.source[q], extremes.derivative[q], extremes.factors[q]
        for _ in range(order):
            factor /= envelope.length[s]
        if i < n:
            add_derivative(envelope.coefs[s, i], degree, order, factor, p)
        else:
            add_derivative(inputs[s, i - n], degree, order, factor, p)


def update_row_extremes(envelope: EnvelopeBuffers, extremes: RowExtremes, s: int, r: int) -> None:
    """Update the extremes of row `r` with the polynomial in the work space."""
    p, degree, begin, h = extremes.polynomial, envelope.degree[s], envelope.begin[s], envelope.length[s]
    first, far = p[POLYNOMIAL, 0], size(p, POLYNOMIAL, degree)
    if first + far > extremes.high[r]:
        value, place = highest(p, degree, 1.0, extremes.high[r])
        if place >= 0.0:
            extremes.high[r], extremes.t_high[r] = value, begin + h * place
    if first - far < extremes.low[r]:
        for k in range(degree + 1):
            p[POLYNOMIAL, k] = -p[POLYNOMIAL, k]
        value, place = highest(p, degree, 1.0, -extremes.low[r])
        if place >= 0.0:
            extremes.low[r], extremes.t_low[r] = -value, begin + h * place


def find_extremes(envelope: EnvelopeBuffers, inputs: Array, extremes: RowExtremes) -> int:
    """Update the extremes of all rows with the steps that were kept.

    Parameters
    ----------
    envelope : EnvelopeBuffers
    inputs : ndarray, shape (n_steps, n_inputs, MAX_DEGREE + 1)
        Series of the inputs over each step.
    extremes : RowExtremes

    Returns
    -------
    int
        0.
    """
    for s in range(envelope.kept[STEPS]):
        n, degree, h = envelope.coefs.shape[1], envelope.degree[s], envelope.length[s]
        for i in range(n):
            bound_series(extremes, i, envelope.coefs[s, i], degree, h)
        for j in range(inputs.shape[1]):
            bound_series(extremes, n + j, inputs[s, j], degree, h)
        for r in range(len(extremes.high)):
            if may_exceed(extremes, r):
                form_row(envelope, inputs, extremes, s, r)
                update_row_extremes(envelope, extremes, s, r)
    return 0
