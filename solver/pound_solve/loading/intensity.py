r"""Intensity measures of a ground motion: exact integrals of its piecewise-linear acceleration.

On a line from :math:`a_0` to :math:`a_1` of length h

.. math:: \int a^2\,dt = \tfrac{h}{3}(a_0^2 + a_0 a_1 + a_1^2), \qquad
          \int |a|\,dt = \begin{cases} \tfrac{h}{2}(|a_0| + |a_1|) & a_0 a_1 \ge 0 \\
          \tfrac{h}{2}\,(a_0^2 + a_1^2)/(|a_0| + |a_1|) & a_0 a_1 < 0 \end{cases}

and the instant at which a fraction of the first integral is reached is the root of a cubic.

.. math:: I_A = \frac{\pi}{2g}\int a^2\,dt, \qquad \mathit{CAV} = \int |a|\,dt, \qquad
          \mathit{SI} = \int_{0.1}^{2.5} \mathit{PSV}(T, \xi)\,dT

References
----------
Arias A (1970), A measure of earthquake intensity, in: Hansen RJ (ed.), Seismic design for nuclear power
plants, MIT Press: 438-483 (:math:`I_A`).
EPRI (1988), A criterion for determining exceedance of the operating basis earthquake, report NP-5930 (CAV;
here without a threshold).
Housner GW (1952), Spectrum intensities of strong-motion earthquakes, Proc. Symp. Earthquake and Blast
Effects on Structures, EERI: 20-36 (SI).
Trifunac MD, Brady AG (1975), A study on the duration of strong earthquake ground motion, Bull. Seismol.
Soc. Am. 65(3): 581-626 (significant duration).
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from pound_solve.loading.piecewise import Piecewise
from pound_solve.loading.spectrum import pseudo_acceleration
from pound_solve.numerics.cubic import cubic_rise
from pound_solve.numerics.types import Array

#: periods of the spectrum intensity, whose trapezium rule is some 3e-4 from the integral [s]
HOUSNER: Final = tuple(0.1 + 0.025 * k for k in range(97))


class Intensity(NamedTuple):
    """Intensity measures of one motion.

    Attributes
    ----------
    pga, pgv, pgd : float, [L/T^2], [L/T], [L]
        Peaks of acceleration, velocity and displacement of a ground that begins at rest.
    arias : float, [L/T]
    d5_75, d5_95 : float, [T]
        Time from 5 % to 75 % and to 95 % of the Arias intensity; NaN without acceleration.
    cav : float, [L/T]
        Cumulative absolute velocity.
    housner : float, [L]
        Spectrum intensity, pseudo-velocity of 5 % damping.
    """

    pga: float
    pgv: float
    pgd: float
    arias: float
    d5_75: float
    d5_95: float
    cav: float
    housner: float


def intensity(acceleration: Piecewise, gravity: float) -> Intensity:
    """Intensity measures of a ground motion that begins at rest.

    Parameters
    ----------
    acceleration : Piecewise, [L/T^2]
        A curved one is replaced by its `chords`.
    gravity : float, [L/T^2]
        Of the Arias intensity, in the same units.

    Raises
    ------
    ValueError
        The acceleration is too long for its spectrum, see `response_spectrum`.
    """
    velocity = acceleration.integral()
    return Intensity(
        pga=abs(acceleration.peak()[1]),
        pgv=abs(velocity.peak()[1]),
        pgd=abs(velocity.integral().peak()[1]),
        arias=arias(acceleration, gravity),
        d5_75=significant_duration(acceleration, 0.05, 0.75),
        d5_95=significant_duration(acceleration, 0.05, 0.95),
        cav=cumulative_absolute_velocity(acceleration),
        housner=housner(acceleration),
    )


def arias(acceleration: Piecewise, gravity: float) -> float:
    """Arias intensity [L/T] of an acceleration [L/T^2]."""
    return math.pi / (2.0 * gravity) * float(_squares(acceleration.chords()).sum())


def share(acceleration: Piecewise, end: float) -> float:
    """Share of the Arias intensity that is reached at a time [T]; 1 without acceleration."""
    whole = arias(acceleration, 1.0)
    if not whole or end >= acceleration.end:
        return 1.0
    return (
        arias(acceleration.slice(acceleration.start, end), 1.0) / whole if end > acceleration.start else 0.0
    )


def significant_duration(acceleration: Piecewise, start: float = 0.05, end: float = 0.95) -> float:
    """Time between two shares of the Arias intensity [T]; NaN without acceleration."""
    lines = acceleration.chords()
    total = np.concatenate([[0.0], np.cumsum(_squares(lines))])
    if total[-1] == 0.0:
        return math.nan
    return _reached(lines, total, end) - _reached(lines, total, start)


def _reached(lines: Piecewise, total: Array, fraction: float) -> float:
    """Time [T] at which the integral of the square, `total` at the breaks, is a fraction of its end."""
    wanted = fraction * float(total[-1])
    i = max(int(np.searchsorted(total, wanted)), 1) - 1
    a0, slope = lines.coefs[:, i]
    width = float(lines.breaks[i + 1] - lines.breaks[i])
    a1 = a0 + slope * width
    since = cubic_rise(total[i] - wanted, total[i + 1] - wanted, a0**2, a1**2, width)
    return float(lines.breaks[i] + since)


def cumulative_absolute_velocity(acceleration: Piecewise) -> float:
    """Integral of the absolute acceleration [L/T], without a threshold."""
    h, a0, a1 = _ends(acceleration.chords())
    sizes = np.abs(a0) + np.abs(a1)
    crosses = a0 * a1 < 0.0
    means = np.where(crosses, (a0**2 + a1**2) / np.where(crosses, sizes, 1.0), sizes)
    return float((0.5 * h * means).sum())


def housner(acceleration: Piecewise, damping: float = 0.05) -> float:
    """Spectrum intensity [L]: the pseudo-velocity over periods from 0.1 to 2.5 s, trapezium rule."""
    periods = np.array(HOUSNER)
    pseudo_velocity = periods / (2.0 * np.pi) * pseudo_acceleration(acceleration, periods, damping)[0]
    return float(np.trapezoid(pseudo_velocity, periods))


def _squares(lines: Piecewise) -> Array:
    """Integral of the squared acceleration over every interval, shape (nb,)."""
    h, a0, a1 = _ends(lines)
    return h / 3.0 * (a0**2 + a0 * a1 + a1**2)


def _ends(lines: Piecewise) -> tuple[Array, Array, Array]:
    """Width of every interval, and the values at its two ends, shape (nb,) each."""
    h = np.diff(lines.breaks)
    a0, slope = lines.coefs
    return h, a0, a0 + slope * h
