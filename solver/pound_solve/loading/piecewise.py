"""Piecewise polynomials of time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from pound_solve.numerics.polynomial import shift
from pound_solve.numerics.types import Array, Index


@dataclass(frozen=True, slots=True, eq=False)
class Piecewise:
    """A function of time: one polynomial in every interval, zero outside them all.

    Attributes
    ----------
    breaks : ndarray, shape (nb + 1,), [T]
        Ends of the intervals, strictly increasing.
    coefs : ndarray, shape (degree + 1, nb)
        ``coefs[k, i]`` multiplies ``(t - breaks[i])**k`` in interval i: ascending powers.
    """

    breaks: Array
    coefs: Array

    def __post_init__(self) -> None:
        if self.coefs.ndim != 2 or self.coefs.shape[1] != len(self.breaks) - 1 or not self.coefs.size:
            raise ValueError(f"coefs of shape {self.coefs.shape} do not go with {len(self.breaks)} breaks")
        if not (np.diff(self.breaks) > 0).all():
            raise ValueError("breaks must increase")

    @classmethod
    def from_samples(cls, times: ArrayLike, values: ArrayLike) -> Piecewise:
        """Straight lines between samples.

        Parameters
        ----------
        times, values : array_like, shape (n,)
        """
        t, v = np.asarray(times, dtype=np.float64), np.asarray(values, dtype=np.float64)
        return cls(t, np.vstack((v[:-1], np.diff(v) / np.diff(t))))

    @classmethod
    def zero(cls, start: float, end: float) -> Piecewise:
        """Zero from `start` to `end`."""
        return cls(np.array([start, end], dtype=np.float64), np.zeros((1, 1)))

    @property
    def degree(self) -> int:
        """Highest power."""
        return len(self.coefs) - 1

    @property
    def start(self) -> float:
        """First break."""
        return float(self.breaks[0])

    @property
    def end(self) -> float:
        """Last break."""
        return float(self.breaks[-1])

    def piece(self, t: ArrayLike) -> Index:
        """Indices of the intervals that contain the times `t`; at a break the one that begins there.

        Times outside get the nearest interval.
        """
        i = np.searchsorted(self.breaks, t, side="right") - 1
        return np.clip(i, 0, len(self.breaks) - 2)

    def value(self, t: ArrayLike) -> Array:
        """Values at some times, same shape as `t`; zero outside (both end points are inside)."""
        t = np.asarray(t, dtype=np.float64)
        i = self.piece(t)
        # clipped to the intervals: far outside, high powers would overflow before they are discarded
        held = np.clip(t, self.start, self.end)
        inside = (t >= self.start) & (t <= self.end)
        return np.where(inside, _horner(self.coefs[:, i], held - self.breaks[i]), 0.0)[()]

    def local(self, i: int, t0: float | None = None) -> Array:
        """Coefficients of interval i in powers of ``t - t0``, ascending, shape (degree + 1,).

        Parameters
        ----------
        i : int
            Number of the interval.
        t0 : float, optional, [T]
            Local origin; the beginning of the interval if left out.
        """
        return self.coefs[:, i].copy() if t0 is None else shift(self.coefs[:, i], t0 - self.breaks[i])

    def on(self, breaks: ArrayLike) -> Piecewise:
        """The same function on other breaks, zero outside its own interval.

        Parameters
        ----------
        breaks : array_like, shape (m + 1,), [T]
            Increasing; every own break between their ends must be among them (to 1e-9 of the whole span).

        Raises
        ------
        ValueError
            `breaks` lacks a break of the function, so that one polynomial would have to replace two.
        """
        new = np.asarray(breaks, dtype=np.float64)
        inner = self.breaks[(self.breaks > new[0]) & (self.breaks < new[-1])]
        near = np.searchsorted(new, inner)
        gap = np.minimum(inner - new[near - 1], new[near] - inner)
        if (gap > 1e-9 * (new[-1] - new[0])).any():
            raise ValueError("the new breaks leave out one of the old")
        # midpoints, because a new break may lie on the wrong side of an old one by rounding
        middle = 0.5 * (new[:-1] + new[1:])
        i = self.piece(middle)
        coefs = shift(self.coefs[:, i], new[:-1] - self.breaks[i])
        coefs[:, (middle < self.start) | (middle > self.end)] = 0.0
        return Piecewise(new, coefs)

    def slice(self, start: float, end: float) -> Piecewise:
        """The function between two times, zero where it is not defined there."""
        span = np.concatenate(([start, end], self.breaks[(self.breaks > start) & (self.breaks < end)]))
        return self.on(merged(span, 1e-12 * (abs(start) + abs(end))))

    def delayed(self, by: float, lead: ArrayLike = (0.0,)) -> Piecewise:
        """The function delayed by `by`; itself without a delay.

        Parameters
        ----------
        by : float, [T]
            Not below zero.
        lead : array_like, shape (m,)
            Coefficients before it, in powers of the time since the old beginning; zero if left out.
        """
        if by == 0.0:
            return self
        first = np.atleast_1d(np.asarray(lead, dtype=np.float64))
        rows = max(len(self.coefs), len(first))
        coefs = np.zeros((rows, len(self.breaks)))
        coefs[: len(first), 0] = first
        coefs[: len(self.coefs), 1:] = self.coefs
        return Piecewise(np.concatenate(([self.start], self.breaks + by)), coefs)

    def extended(self, t_end: float, tail: ArrayLike = (0.0,)) -> Piecewise:
        """The function with one more interval up to `t_end`; itself if it ends no earlier.

        Parameters
        ----------
        t_end : float, [T]
        tail : array_like, shape (m,)
            Coefficients there in powers of the time since the old end; zero if left out.
        """
        if t_end <= self.end:
            return self
        last = np.atleast_1d(np.asarray(tail, dtype=np.float64))
        rows = max(len(self.coefs), len(last))
        coefs = np.zeros((rows, len(self.breaks)))
        coefs[: len(self.coefs), :-1] = self.coefs
        coefs[: len(last), -1] = last
        return Piecewise(np.append(self.breaks, t_end), coefs)

    def divided(self, parts: int) -> Piecewise:
        """The same function with every interval in `parts` equal ones; itself for 1."""
        if parts == 1:
            return self
        offset = np.arange(parts) / parts * np.diff(self.breaks)[:, None]
        breaks = np.append((self.breaks[:-1, None] + offset).ravel(), self.end)
        coefs = shift(np.repeat(self.coefs, parts, axis=1), offset.ravel())
        return Piecewise(breaks, coefs)

    def chords(self, parts: int = 16) -> Piecewise:
        """Straight lines between values, `parts` in every interval; the function itself if it is straight.

        For a sine with 32 intervals a period, 16 parts are wrong by 2e-5 of its amplitude at most.
        """
        if self.degree == 0:
            return Piecewise(self.breaks, np.vstack((self.coefs, np.zeros_like(self.coefs))))
        if self.degree == 1:
            return self
        fine = self.divided(parts)
        width = np.diff(fine.breaks)
        return Piecewise(
            fine.breaks, np.vstack((fine.coefs[0], (_horner(fine.coefs, width) - fine.coefs[0]) / width))
        )

    def lines(self, parts: int = 1) -> Piecewise:
        """A straight line in every one of `parts` of an interval, with the integral and the first moment of
        the function there; the function itself if it is straight.  It may jump at the breaks.

        What follows the function slowly cannot tell them apart: of a sine with 32 intervals a period, one
        line in each gives an oscillator of the same period a response that is wrong by 2e-5.
        """
        if self.degree <= 1:
            return self.chords()
        fine = self.divided(parts)
        width, powers = np.diff(fine.breaks), np.arange(len(fine.coefs))[:, None]
        terms = fine.coefs * width**powers
        mean, moment = (terms / (powers + 1)).sum(axis=0), (terms / (powers + 2)).sum(axis=0)
        slope = 12.0 * (moment - 0.5 * mean)
        return Piecewise(fine.breaks, np.vstack((mean - 0.5 * slope, slope / width)))

    def integral(self, initial: float = 0.0) -> Piecewise:
        """Continuous antiderivative that is `initial` at the first break; its degree is one higher.

        A function that acts beyond the last break (such as the velocity of a ground in steady motion) needs
        :meth:`extended` first.
        """
        powers = np.arange(1.0, len(self.coefs) + 1.0)
        coefs = np.vstack((np.zeros(self.coefs.shape[1]), self.coefs / powers[:, None]))
        gains = _horner(coefs, np.diff(self.breaks))
        # sums of thousands of increments: long double, where available, limits the rounding
        sums = np.longdouble(initial) + np.cumsum(gains, dtype=np.longdouble)
        coefs[0, 0] = initial
        coefs[0, 1:] = sums[:-1]
        return Piecewise(self.breaks, coefs)

    def peak(self) -> tuple[float, float]:
        """Time and value of the point farthest from zero.

        The interval is found by its ends and middle; inside it the peak is exact.
        """
        width = np.diff(self.breaks)
        sampled = np.abs([_horner(self.coefs, part * width) for part in (0.0, 0.5, 1.0)]).max(axis=0)
        i = int(sampled.argmax())
        polynomial = np.polynomial.Polynomial(self.coefs[:, i] * width[i] ** np.arange(self.degree + 1))
        slope = polynomial.deriv()
        # high powers of rounding size would make roots() ill-posed; a constant has no turning point
        roots = slope.trim(1e-15 * np.abs(slope.coef).max()).roots() if self.degree > 1 else np.empty(0)
        turns = roots[np.isreal(roots)].real
        at = np.concatenate(([0.0, 1.0], turns[(turns > 0) & (turns < 1)]))
        values = polynomial(at)
        k = int(np.abs(values).argmax())
        return float(self.breaks[i] + at[k] * width[i]), float(values[k])

    def __mul__(self, factor: float) -> Piecewise:
        return Piecewise(self.breaks, self.coefs * factor)

    __rmul__ = __mul__

    def __neg__(self) -> Piecewise:
        return self * -1.0


def merged(times: ArrayLike, tolerance: float) -> Array:
    """Sorted times without those within `tolerance` of their predecessor; the first and the last are kept.

    Parameters
    ----------
    times : array_like, shape (n,), [T]
    tolerance : float, [T]
    """
    t = np.unique(np.asarray(times, dtype=np.float64))
    kept = t[np.concatenate(([True], np.diff(t) > tolerance))]
    # a chain of close times must not creep up to the last one, which is kept as it is
    return np.append(kept[(kept < t[-1] - tolerance) | (kept == t[0])], t[-1])


def _horner(coefs: Array, s: Array) -> Array:
    """Values of polynomials with ascending `coefs` (first axis) at `s`."""
    values = np.array(coefs[-1])
    for c in coefs[-2::-1]:
        values = values * s + c
    return values
