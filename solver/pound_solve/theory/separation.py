r"""Relative displacement of two buildings from their peaks: the double difference combination.

With peak displacements :math:`u_1, u_2` (Jeng, Kasai and Maison 1992, Earthquake Spectra 8: 201-223),

.. math:: u_{12} = \sqrt{u_1^2 + u_2^2 - 2\rho u_1 u_2}

where :math:`\rho` is the correlation of two oscillators of periods :math:`T_1, T_2` and damping ratios
:math:`\xi_1, \xi_2` under white noise,

.. math:: \rho = \frac{8\sqrt{\xi_1\xi_2}\,(\xi_1 + \chi\xi_2)\,\chi^{3/2}}
          {(1-\chi^2)^2 + 4\xi_1\xi_2\chi(1+\chi^2) + 4(\xi_1^2+\xi_2^2)\chi^2},\qquad \chi = T_1/T_2

(the coefficient of the complete quadratic combination, Der Kiureghian 1981, Earthquake Engng Struct.
Dyn. 9: 419-435).
"""

from __future__ import annotations

import math


def correlation(t1: float, t2: float, xi1: float, xi2: float) -> float:
    """Correlation of two oscillators under white noise, from periods [T] and damping ratios [-]."""
    chi = t1 / t2
    top = 8.0 * math.sqrt(xi1 * xi2) * (xi1 + chi * xi2) * chi**1.5
    cross = 4.0 * xi1 * xi2 * chi * (1.0 + chi**2) + 4.0 * (xi1**2 + xi2**2) * chi**2
    below = (1.0 - chi**2) ** 2 + cross
    return top / below if below > 0.0 else 1.0  # both undamped and of one period: they move alike


def double_difference(u1: float, u2: float, rho: float) -> float:
    """Relative peak displacement of two correlated peaks [L]."""
    return math.sqrt(max(u1**2 + u2**2 - 2.0 * rho * u1 * u2, 0.0))
