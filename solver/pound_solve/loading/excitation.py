"""The inputs of an analysis: all motions and histories of forces on common intervals of time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pound_solve.loading.motions.base import Piecewise
from pound_solve.numerics import polynomial
from pound_solve.numerics.types import Array, Flags, Index

#: tolerance, relative to the time and to the unit of time, within which a time coincides with a break
CLOCK_ROUNDING = 1e-13


@dataclass(frozen=True)
class Excitation:
    """The inputs as polynomials of time on common intervals.

    Attributes
    ----------
    breaks : ndarray, shape (n_pieces + 1,) [T]
    coefs : ndarray, shape (n_pieces, degree + 1, n_inputs)
        Ascending powers of the time since the start of the interval.
    """

    breaks: Array
    coefs: Array

    @classmethod
    def of(cls, inputs: Sequence[Piecewise], breaks: Array) -> Excitation:
        """Inputs on `breaks`, which include the breaks of all inputs."""
        degree = max((s.degree for s in inputs), default=0)
        coefs = np.zeros((len(breaks) - 1, degree + 1, len(inputs)))
        for j, s in enumerate(inputs):
            coefs[:, : s.degree + 1, j] = s.on(breaks).coefs.T
        return cls(breaks, coefs)

    @property
    def degree(self) -> int:
        """Highest power."""
        degree: int = self.coefs.shape[1] - 1
        return degree

    @property
    def active(self) -> Flags:
        """Flags of the inputs that are not identically zero, shape (n_inputs,)."""
        return np.asarray(np.abs(self.coefs).max(axis=(0, 1), initial=0.0) > 0)

    def piece(self, t: float) -> int:
        """Index of the interval that begins at or before `t`."""
        return min(max(int(np.searchsorted(self.breaks, t, side="right")) - 1, 0), len(self.coefs) - 1)

    def pieces(self, t: Array) -> Index:
        """`piece` at several times, shape (n_times,)."""
        return np.clip(np.searchsorted(self.breaks, t, side="right") - 1, 0, len(self.coefs) - 1)

    def pieces_after(self, t: Array) -> Index:
        """Indices of the intervals just after some times, shape (n_times,): a time that lies before a break
        by rounding only belongs to the interval that begins there.
        """
        return self.pieces(t + CLOCK_ROUNDING * np.maximum(1.0, t))

    def pieces_before(self, t: Array) -> Index:
        """Indices of the intervals just before some times, shape (n_times,): a time that lies beyond a
        break by rounding only belongs to the interval that ends there.
        """
        i = np.searchsorted(self.breaks, t - CLOCK_ROUNDING * np.maximum(1.0, t), side="left") - 1
        return np.clip(i, 0, len(self.coefs) - 1)

    def before_jumps(self, t: Array) -> Array:
        """Times, moved to just before any jump of an input that coincides with them, shape (n_times,): for
        motions that the jump has not changed yet.
        """
        after = self.pieces_after(t)
        at = np.flatnonzero(after != self.pieces_before(t))
        change = np.abs(self.values_after(t[at]) - self.values(t[at], before=True))
        at = at[(change > 1e-9 * np.abs(self.coefs[:, 0]).max(axis=0, initial=0.0)).any(axis=1)]
        moved = t.copy()
        moved[at] = self.breaks[after[at]] - 4.0 * CLOCK_ROUNDING * np.maximum(1.0, t[at])
        return moved

    def local(self, piece: int, t: float) -> Array:
        """Coefficients about `t`, shape (degree + 1, n_inputs)."""
        return polynomial.shift(self.coefs[piece], t - float(self.breaks[piece]))

    def about(self, t: Array) -> Array:
        """Coefficients about each of several times, each in the interval just after it,
        shape (n_times, degree + 1, n_inputs).
        """
        i = self.pieces_after(t)
        coefs, since = self.coefs[i], t - self.breaks[i]
        if not since.any():
            return coefs
        return np.asarray(polynomial.shift(coefs.swapaxes(0, 1), since[:, None]).swapaxes(0, 1))

    def jumps(self) -> Flags:
        """Flags of the inputs that jump, from zero at t = 0 or between two intervals, shape (n_inputs,)."""
        powers = np.diff(self.breaks)[:, None] ** np.arange(self.degree + 1)
        ends = np.einsum("pk,pkj->pj", powers, self.coefs)
        before = np.concatenate([np.zeros((1, ends.shape[1])), ends[:-1]])
        largest = np.abs(self.coefs[:, 0]).max(axis=0, initial=0.0)
        jumps: Flags = np.abs(self.coefs[:, 0] - before).max(axis=0, initial=0.0) > 1e-9 * largest
        return jumps

    def value(self, t: float, order: int = 0) -> Array:
        """Value of the inputs (or of their derivative of that order) at `t`, shape (n_inputs,)."""
        i = self.piece(t)
        return polynomial.value(self.coefs[i], t - float(self.breaks[i]), order)

    def values(self, t: Array, order: int = 0, before: bool = False) -> Array:
        """`value` at several times, shape (n_times, n_inputs); `before` just before them, where an input
        jumps then.
        """
        i = self.pieces_before(t) if before else self.pieces(t)
        return polynomial.values(self.coefs[i], t - self.breaks[i], order)

    def values_after(self, t: Array, order: int = 0) -> Array:
        """`value` just after several times (see `pieces_after`), shape (n_times, n_inputs)."""
        i = self.pieces_after(t)
        return polynomial.values(self.coefs[i], t - self.breaks[i], order)
