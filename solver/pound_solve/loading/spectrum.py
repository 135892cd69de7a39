r"""Response spectra of piecewise-linear accelerations, with the true peaks between the samples.

The oscillator of circular frequency :math:`\omega` and damping ratio :math:`\xi < 1`,

.. math:: \ddot u + 2\xi\omega\dot u + \omega^2 u = -a(t), \qquad
          \lambda = -\xi\omega + i\omega_d, \quad \omega_d = \omega\sqrt{1-\xi^2},

satisfies one complex equation, :math:`\dot z = \lambda z - a` with :math:`z = \dot u - \bar\lambda u`.  On
a straight line :math:`a = a_0 + a_1 s` its solution is closed, the recurrence of Nigam and Jennings (1969)
in complex form:

.. math:: z(s) = e^{\lambda s} z_0 - s\,\bigl(a_0 K_0(\lambda s) + a_1 s K_1(\lambda s)\bigr)

with the :math:`K_k` of `numerics.phi`.  Relative displacement, relative velocity and absolute acceleration
(but for its sign) are

.. math:: q_k = \operatorname{Im}(\lambda^k z)/\omega_d, \qquad k = 0, 1, 2 .

The second derivative of each is a free vibration, :math:`\operatorname{Im}(\lambda^k \ddot z_0
e^{\lambda s})/\omega_d`, whose zeros are known.  This bounds what a quantity can gain between two
samples, and splits an interval into parts in which the slope is monotonic: a peak is the zero of the slope
there.  After the last break the oscillator swings freely; its first extreme is the largest.

References
----------
Nigam NC, Jennings PC (1969), Calculation of response spectra from strong-motion earthquake records,
Bull. Seismol. Soc. Am. 59(2): 909-922.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from pound_solve.loading.piecewise import Piecewise
from pound_solve.numerics.phi import duhamel
from pound_solve.numerics.types import Array, Complex, Index

BLOCK: Final = 2**17  #: largest number of elements of a work array
MAX_INTERVALS: Final = 2**22  #: most intervals into which an acceleration is divided for short periods
LINES: Final = 16  #: most straight lines for an interval of a curved acceleration
EQUAL: Final = 12  #: digits to which equal steps agree
ENOUGH: Final = 1e-10  #: of an interval, to which the instant of a peak is found: the peak has its square


@dataclass(frozen=True, slots=True, eq=False)
class Spectrum:
    """Largest responses of oscillators to one acceleration.

    Attributes
    ----------
    periods : ndarray, shape (n,), [T]
    damping : ndarray, shape (m,), [-]
        Ratios to critical damping.
    sd, sv, sa : ndarray, shape (m, n), [L], [L/T], [L/T^2]
        Largest relative displacement, relative velocity and absolute acceleration.
    """

    periods: Array
    damping: Array
    sd: Array
    sv: Array
    sa: Array

    @property
    def psv(self) -> Array:
        """Pseudo-velocity :math:`\\omega S_d`, shape (m, n), [L/T]."""
        return 2.0 * np.pi / self.periods * self.sd

    @property
    def psa(self) -> Array:
        """Pseudo-acceleration :math:`\\omega^2 S_d`, shape (m, n), [L/T^2]."""
        return (2.0 * np.pi / self.periods) ** 2 * self.sd


def response_spectrum(
    acceleration: Piecewise, periods: ArrayLike, damping: ArrayLike = 0.05, *, free: bool = True
) -> Spectrum:
    """Spectrum of oscillators that are at rest when the acceleration begins.

    Parameters
    ----------
    acceleration : Piecewise, [L/T^2]
        Acceleration of the base of the oscillators; a curved one is replaced by its `lines`.
    periods : array_like, shape (n,), [T]
        Undamped periods, above zero.
    damping : array_like, shape (m,), [-]
        Ratios to critical damping, from 0 to below 1.
    free : bool
        Whether the free vibration after the end of the acceleration counts.

    Returns
    -------
    Spectrum

    Raises
    ------
    ValueError
        A period or a damping is out of its range, or a period so short that the acceleration would have
        to be divided into more than `MAX_INTERVALS` intervals.
    """
    t, xi = _valid(periods, damping)
    return Spectrum(t, xi, *_largest(acceleration, t, xi, (0, 1, 2), free))


def pseudo_acceleration(acceleration: Piecewise, periods: ArrayLike, damping: ArrayLike = 0.05) -> Array:
    """Pseudo-acceleration :math:`\\omega^2 S_d` alone, shape (m, n), [L/T^2]: a third of the work of
    `response_spectrum`, whose parameters and errors it has.
    """
    t, xi = _valid(periods, damping)
    (sd,) = _largest(acceleration, t, xi, (0,), True)
    spectrum: Array = (2.0 * np.pi / t) ** 2 * sd
    return spectrum


def _valid(periods: ArrayLike, damping: ArrayLike) -> tuple[Array, Array]:
    """Periods and damping ratios as arrays; ValueError for one out of its range."""
    t, xi = (np.atleast_1d(np.asarray(x, dtype=np.float64)) for x in (periods, damping))
    if not ((t > 0) & (t < np.inf)).all() or not ((xi >= 0) & (xi < 1)).all():
        raise ValueError("periods are finite and above zero, damping ratios from 0 to below 1")
    return t, xi


def _largest(
    acceleration: Piecewise, t: Array, xi: Array, quantities: tuple[int, ...], free: bool
) -> Array:
    """Largest absolute values of some of the q_k, shape (n_quantities, m, n)."""
    period, ratio = (x.ravel() for x in np.broadcast_arrays(t, xi[:, None]))
    width = np.diff(acceleration.breaks).max()
    # what is left of a curve beside its lines falls with the square of their length, and what an oscillator
    # follows of that, once more
    bends = 4.0 * np.sqrt(2.0 * np.pi * width / period) if acceleration.degree > 1 else np.ones(len(period))
    curved = _power_of_two(np.minimum(bends, LINES))
    # an interval shorter than half a period has one inflexion at most
    parts = _power_of_two(2.0 * width / (curved * period))
    if (curved * parts).max() * len(acceleration.breaks) > MAX_INTERVALS:
        raise ValueError(f"the period {t.min():g} is too short for an acceleration of this length")
    peaks = np.empty((len(quantities), len(period)))
    for lines, count in np.unique(np.stack([curved, parts]), axis=1).T.tolist():
        alike = np.flatnonzero((curved == lines) & (parts == count))
        fine = acceleration.lines(int(lines)).divided(int(count))
        for some in np.array_split(alike, -(-len(alike) * len(fine.breaks) // BLOCK)):
            peaks[:, some] = _peaks(fine, 2.0 * np.pi / period[some], ratio[some], quantities, free)
    return peaks.reshape(-1, len(xi), len(t))


def _power_of_two(x: Array) -> Array:
    """The next power of two from each value on, 1 at least."""
    power: Array = 2.0 ** np.ceil(np.log2(np.maximum(x, 1.0)))
    return power


def _peaks(lines: Piecewise, omega: Array, xi: Array, quantities: tuple[int, ...], free: bool) -> Array:
    """Largest absolute values of some of the q_k, shape (n_quantities, n) for n oscillators."""
    omega_d = omega * np.sqrt(1.0 - xi**2)
    eigenvalue = -xi * omega + 1j * omega_d
    z, width = _states(lines, eigenvalue), np.diff(lines.breaks)
    a0, a1 = lines.coefs
    bend = np.abs(_Swing(z[:-1], a0[:, None], a1[:, None], eigenvalue).bend)
    peaks = np.empty((len(quantities), len(omega)))
    for row, k in zip(peaks, quantities):
        factor = np.asarray(eigenvalue**k / omega_d, complex)
        q = np.abs((factor * z).imag)
        row[:] = q.max(axis=0)
        gain = width[:, None] ** 2 / 8.0 * np.abs(factor) * bend
        at, who = np.nonzero(np.maximum(q[:-1], q[1:]) + gain > row)
        some = _Swing(z[at, who], a0[at], a1[at], eigenvalue[who])
        mine, between = some.extremes(factor[who], width[at])
        np.maximum.at(row, who[mine], np.abs(between))
        if free:
            # the first instant at which Im(factor eigenvalue z exp(eigenvalue s)) is zero
            swing = factor * z[-1]
            wait = np.mod(-np.angle(eigenvalue * swing), np.pi) / omega_d
            np.maximum(row, np.abs((swing * np.exp(eigenvalue * wait)).imag), out=row)
    return peaks


def _states(lines: Piecewise, eigenvalue: Complex) -> Complex:
    """State z at every break, shape (n_breaks, n), from rest."""
    # times are sums: equal steps differ by rounding
    mantissa, exponent = np.frexp(np.diff(lines.breaks))
    step, which = np.unique(np.ldexp(np.round(mantissa, EQUAL), exponent), return_inverse=True)
    s = step[:, None]
    decay, k = np.exp(eigenvalue * s), duhamel(eigenvalue * s, 1)
    first, second = s * k[0], s**2 * k[1]
    a0, a1 = lines.coefs[:, :, None]
    z = np.zeros((len(lines.breaks), len(eigenvalue)), complex)
    z[1:] = -a0 * first[which] - a1 * second[which]
    for i, w in enumerate(which):
        z[i + 1] += decay[w] * z[i]
    return z


class _Swing(NamedTuple):
    """Oscillators under linear accelerations: the state at the start, the coefficients of the line, the
    eigenvalue.

    All have one shape, or shapes that broadcast; quantities are Im(factor z).
    """

    z: Complex
    a0: Array
    a1: Array
    eigenvalue: Complex

    @property
    def bend(self) -> Complex:
        """Second derivative of z at the start."""
        return self.eigenvalue * (self.eigenvalue * self.z - self.a0) - self.a1

    def of(self, some: Index) -> _Swing:
        """Some of the oscillators."""
        return _Swing(self.z[some], self.a0[some], self.a1[some], self.eigenvalue[some])

    def state(self, s: Array) -> Complex:
        """State z after the times `s`."""
        k0, k1 = duhamel(self.eigenvalue * s, 1)
        state: Complex = np.exp(self.eigenvalue * s) * self.z - s * (self.a0 * k0 + self.a1 * s * k1)
        return state

    def slope(self, factor: Complex, s: Array) -> Array:
        """Slope of the quantity after the times `s`."""
        slope: Array = (factor * (self.eigenvalue * self.state(s) - self.a0 - self.a1 * s)).imag
        return slope

    def extremes(self, factor: Complex, width: Array) -> tuple[Index, Array]:
        """Stationary points of the quantity within intervals of one inflexion at most.

        Returns
        -------
        which : ndarray of int, shape (n_found,)
            Oscillators that have one.
        values : ndarray, shape (n_found,)
        """
        first, last = self.slope(factor, np.zeros_like(width)), self.slope(factor, width)
        once = np.flatnonzero(first * last < 0)
        inflexion = np.mod(-np.angle(factor * self.bend), np.pi) / self.eigenvalue.imag
        # else one on either side of an inflexion, but for a slope of zero at an end, as at rest
        others = np.flatnonzero((first * last >= 0) & (inflexion < width))
        middle = inflexion[others]
        slope = self.of(others).slope(factor[others], middle)
        left, right = slope * first[others] < 0, slope * last[others] < 0
        which = np.concatenate([once, others[left], others[right]])
        low = np.concatenate([np.zeros(len(once) + int(left.sum())), middle[right]])
        high = np.concatenate([width[once], middle[left], width[others[right]]])
        swings = self.of(which)
        s = swings.stationary(factor[which], low, high)
        return which, (factor[which] * swings.state(s)).imag

    def stationary(self, factor: Complex, low: Array, high: Array) -> Array:
        """Zeros of the slope between times at which its signs differ, by Newton's method and bisection."""
        rises, enough = self.slope(factor, low) < 0, ENOUGH * (high - low)
        bend, s = factor * self.bend, 0.5 * (low + high)
        for _ in range(60):
            slope = self.slope(factor, s)
            before = (slope < 0) == rises
            low, high = np.where(before, s, low), np.where(before, high, s)
            curvature = (bend * np.exp(self.eigenvalue * s)).imag
            new = s - slope / np.where(curvature == 0.0, np.inf, curvature)
            new = np.where((new > low) & (new < high), new, 0.5 * (low + high))
            done = np.abs(new - s) <= enough
            s = new
            if done.all():
                break
        return s
