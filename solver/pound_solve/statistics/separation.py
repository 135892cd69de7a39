r"""Relative displacement of two buildings from their peaks: the double difference combination.

With peak displacements :math:`u_1, u_2` (Jeng, Kasai and Maison 1992, Earthquake Spectra 8: 201-223),

.. math:: u_{12} = \sqrt{u_1^2 + u_2^2 - 2\rho u_1 u_2}

where :math:`\rho` is the correlation of two oscillators of periods :math:`T_1, T_2` and damping ratios
:math:`\xi_1, \xi_2` under white noise,

.. math:: \rho = \frac{8\sqrt{\xi_1\xi_2}\,(\xi_1 + \chi\xi_2)\,\chi^{3/2}}
          {(1-\chi^2)^2 + 4\xi_1\xi_2\chi(1+\chi^2) + 4(\xi_1^2+\xi_2^2)\chi^2},\qquad \chi = T_1/T_2

(the coefficient of the complete quadratic combination, Der Kiureghian 1981, Earthquake Engng Struct.
Dyn. 9: 419-435).

Beside it stand the rules of codes, on the largest displacements that the buildings are expected to have:

* ASCE 7-10, 12.12.3: :math:`\delta_{MT} = \sqrt{\delta_{M1}^2 + \delta_{M2}^2}` (12.12-2) with
  :math:`\delta_M = C_d\,\delta_{max}/I_e` (12.12-1), where :math:`\delta_{max}` is elastic;
* EN 1998-1:2004, 4.4.2.7(2): the root of the sum of the squares of the displacements
  :math:`d_s = q_d\,d_e` of 4.3.4(1); 4.4.2.7(3): 0.7 of it where floors are at equal heights.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final, NamedTuple

import numpy as np
from scipy.special import betaincinv

from pound_solve.numerics.types import Array

TAKES_PART: Final = 0.1  #: component of a mode, largest 1, from which it is taken for a building's own
EQUAL_FLOORS: Final = 0.7  #: of EN 1998-1, 4.4.2.7(3)


def correlation(t1: float, t2: float, xi1: float, xi2: float) -> float:
    """Correlation of two oscillators under white noise, from periods [T] and damping ratios [-]; NaN where
    one of them is.
    """
    if math.isnan(t1 + t2 + xi1 + xi2):
        return math.nan
    chi = t1 / t2
    top = 8.0 * math.sqrt(xi1 * xi2) * (xi1 + chi * xi2) * chi**1.5
    cross = 4.0 * xi1 * xi2 * chi * (1.0 + chi**2) + 4.0 * (xi1**2 + xi2**2) * chi**2
    below = (1.0 - chi**2) ** 2 + cross
    return top / below if below > 0.0 else 1.0  # both undamped and of one period: they move alike


def double_difference(u1: float, u2: float, rho: float) -> float:
    """Relative peak displacement of two correlated peaks [L]."""
    return math.sqrt(max(u1**2 + u2**2 - 2.0 * rho * u1 * u2, 0.0))


def own_mode(components: Array, periods: Array, damping: Array) -> tuple[float, float]:
    """Period and damping of the longest mode in which a node takes part; NaN where there is none.

    Parameters
    ----------
    components : ndarray, shape (n_modes,)
        Of the node along a direction; the largest component of a mode is 1.
    periods, damping : ndarray, shape (n_modes,)
    """
    taking = np.flatnonzero(np.abs(components) >= TAKES_PART)
    if not len(taking):
        return math.nan, math.nan
    longest = taking[np.argmax(periods[taking])]
    return float(periods[longest]), float(damping[longest])


class SeparationPeaks(NamedTuple):
    """Input of the rules of separation: peak displacements of both buildings and their correlation.

    Attributes
    ----------
    u1, u2 : float
        Peak displacements [L].
    rho : float
        Correlation of both motions; NaN where it is not known.
    a1, a2 : float
        Factors by which a code raises the displacements of an elastic analysis.
    """

    u1: float
    u2: float
    rho: float = math.nan
    a1: float = 1.0
    a2: float = 1.0

    @property
    def raised(self) -> float:
        """Root of the sum of the squares of the displacements that codes expect [L]."""
        return math.hypot(self.a1 * self.u1, self.a2 * self.u2)

    @property
    def difference(self) -> float:
        """Double difference combination [L]; NaN without a correlation."""
        if self.u1 == 0.0 or self.u2 == 0.0:  # one side does not move: there is nothing to correlate
            return self.u1 + self.u2
        return double_difference(self.u1, self.u2, self.rho) if math.isfinite(self.rho) else math.nan


class Separation(NamedTuple):
    """A rule for the distance of two buildings.

    Attributes
    ----------
    name, source : str
    of : callable
        Distance [L]; NaN where something that it needs is not known.
    """

    name: str
    source: str
    of: Callable[[SeparationPeaks], float]


RULES: Final = (
    Separation("ABS", "u1 + u2", lambda p: p.u1 + p.u2),
    Separation("SRSS", "(u1^2 + u2^2)^1/2", lambda p: math.hypot(p.u1, p.u2)),
    Separation("DDC", "Jeng et al. 1992", lambda p: p.difference),
    Separation("ASCE 7-10", "12.12.3, eq. 12.12-2", lambda p: p.raised),
    Separation("EN 1998-1", "4.4.2.7(2)", lambda p: p.raised),
    Separation("EN 1998-1, 0.7", "4.4.2.7(3)", lambda p: EQUAL_FLOORS * p.raised),
)


def share(count: int, total: int, level: float = 0.95) -> tuple[float, float, float]:
    """Probability from a count, and its exact interval (Clopper and Pearson 1934, Biometrika 26: 404-413).

    Parameters
    ----------
    count, total : int
        Trials in which something happened, and all.
    level : float
        Of confidence.

    Returns
    -------
    probability, low, high : float
        NaN without a trial.
    """
    if total == 0:
        return math.nan, math.nan, math.nan
    tail = 0.5 * (1.0 - level)
    low = float(betaincinv(count, total - count + 1, tail)) if count else 0.0
    high = float(betaincinv(count + 1, total - count, 1.0 - tail)) if count < total else 1.0
    return count / total, low, high
