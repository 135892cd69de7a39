r"""Collision of two diaphragms in closed form: uniform elastic bars of finite length that meet end to end.

A diaphragm of mass :math:`m` and axial stiffness :math:`k_D` has the collision period
:math:`T = 2\sqrt{m/k_D}` (a wave's return trip) and the impedance :math:`Z = \sqrt{k_D m} = 2m/T`.
Index 1 is the diaphragm of the shorter period; :math:`\Delta v = v_1 - v_2` is the approach speed.

Cole, Dhakal, Carr and Bull (2011), Earthquake Engng Struct. Dyn. 40: 641-659, let the bars part at
:math:`T_1` (Eqs 3-22).  That is correct for :math:`Z_1 \le Z_2`.  Otherwise the wave that returns from the
far end of bar 1 does not reverse its motion, and contact lasts until :math:`T_2` with the force

.. math:: F_j = F_0 \rho^j,\quad jT_1 < t < (j+1)T_1,\qquad
          F_0 = \frac{Z_1 Z_2}{Z_1 + Z_2}\Delta v,\quad \rho = \frac{Z_1 - Z_2}{Z_1 + Z_2}

``manual/theory-pounding.md`` derives it.  With :math:`T_2/T_1 = n + s` (n an integer; for
:math:`\rho \le 0` n = 1, s = 0) bar 1 separates with the mean velocity :math:`v_2 + \kappa\Delta v`,
:math:`\kappa = \rho^n(1 - s(1-\rho))`, and everything else follows from momentum.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

ROUNDING = 1e-12  #: relative difference up to which impedances count as equal


@dataclass(frozen=True)
class Diaphragm:
    """A uniform bar; it is rigid without a `stiffness`, and a wall with an infinite mass.

    Attributes
    ----------
    mass : float
        [F T^2/L]
    stiffness : float
        Axial stiffness EA/L of the whole bar [F/L].
    """

    mass: float
    stiffness: float = math.inf

    @property
    def period(self) -> float:
        """Collision period, Eqs 3-5 [T]: 0 for a rigid mass, infinite for a wall."""
        return math.inf if math.isinf(self.mass) else 2.0 * math.sqrt(self.mass / self.stiffness)

    @property
    def impedance(self) -> float:
        """Force per unit jump of the velocity at the end [F T/L]."""
        return math.sqrt(self.stiffness * self.mass)


@dataclass(frozen=True)
class Pair:
    """Two colliding diaphragms; forces and impulses are for a unit approach speed.

    Parameters
    ----------
    first, second : Diaphragm
        In any order; at least one is not rigid.  Tuples of results keep this order.

    Raises
    ------
    ValueError
        Both are rigid.
    """

    first: Diaphragm
    second: Diaphragm

    def __post_init__(self) -> None:
        if math.isinf(self.first.stiffness) and math.isinf(self.second.stiffness):
            raise ValueError("two rigid diaphragms have no collision period")

    @cached_property
    def _ordered(self) -> tuple[Diaphragm, Diaphragm]:
        """Return bars 1 and 2 of the theory; if the periods are equal, either may be bar 1."""
        bar1, bar2 = sorted((self.first, self.second), key=lambda d: (d.period, d.impedance))
        return bar1, bar2

    def _in_order(self, one: float, two: float) -> tuple[float, float]:
        return (one, two) if self._ordered[0] is self.first else (two, one)

    @property
    def mass(self) -> float:
        """Reduced mass m1 m2 / (m1 + m2) [F T^2/L]."""
        return 1.0 / (1.0 / self.first.mass + 1.0 / self.second.mass)

    @property
    def force(self) -> float:
        """Initial contact force, which is the largest, Eq 11 [F T/L]."""
        return 1.0 / (1.0 / self.first.impedance + 1.0 / self.second.impedance)

    @property
    def paper_holds(self) -> bool:
        """Whether the bars separate at the shorter period, as Eqs 7, 8 and 14 to 17 assume; equal bars do,
        even if rounding makes their impedances differ.
        """
        bar1, bar2 = self._ordered
        return bar1.impedance <= bar2.impedance * (1.0 + ROUNDING)

    @property
    def alpha_lumped(self) -> tuple[float, float]:
        """Influence coefficients of lumped masses, Table III [-]."""
        return self.mass / self.first.mass, self.mass / self.second.mass

    @property
    def alpha_paper(self) -> tuple[float, float]:
        """Influence coefficients of distributed masses, Table III [-]."""
        bar1, bar2 = self._ordered
        alpha = 1.0 / (1.0 + bar1.impedance / bar2.impedance)
        return self._in_order(alpha, alpha * bar1.mass / bar2.mass)

    @property
    def e_paper(self) -> float:
        """Effective restitution, Eq 14; may be negative where the equation does not hold [-]."""
        bar1, bar2 = self._ordered
        return 2.0 * (1.0 + bar1.mass / bar2.mass) / (1.0 + bar1.impedance / bar2.impedance) - 1.0

    @property
    def reflection(self) -> float:
        """Ratio rho of the contact forces in successive intervals of the shorter period [-]."""
        bar1, bar2 = self._ordered
        return self.force * (1.0 / bar2.impedance - 1.0 / bar1.impedance)

    @property
    def duration(self) -> float:
        """Duration of the contact [T]."""
        bar1, bar2 = self._ordered
        return bar1.period if self.paper_holds else bar2.period

    def force_at(self, t: float) -> float:
        """Return the contact force at time `t` after the touch [F T/L]."""
        if not 0.0 <= t < self.duration:
            return 0.0
        bar1, bar2 = self._ordered
        if bar1.period == 0.0:
            return bar2.impedance * math.exp(-bar2.impedance * t / bar1.mass)
        return self.force * self.reflection ** math.floor(t / bar1.period)

    @property
    def _kappa(self) -> float:
        """Return the mean velocity of bar 1 after the collision, divided by the approach speed, if bar 2 is
        initially at rest.
        """
        bar1, bar2 = self._ordered
        if bar1.period == 0.0:
            return math.exp(-2.0 * bar2.mass / bar1.mass)
        n, s = divmod(self.duration / bar1.period if not self.paper_holds else 1.0, 1.0)
        rho = self.reflection
        kappa: float = rho**n * (1.0 - s * (1.0 - rho))
        return kappa

    @property
    def impulse(self) -> float:
        """Integral of the contact force [F T^2/L]."""
        return self._ordered[0].mass * (1.0 - self._kappa)

    @property
    def centroid(self) -> float:
        """First moment of the contact force about the instant of touch, divided by the impulse [T].

        Unlike `duration`, it is continuous where the impedances or the periods of the bars become equal.
        """
        bar1, bar2 = self._ordered
        if self.paper_holds:
            return 0.5 * bar1.period
        if bar1.period == 0.0:  # exp(-a t/T2) until T2
            a = 2.0 * bar2.mass / bar1.mass
            return bar2.period * (1.0 / a - 1.0 / math.expm1(a))
        n, s = divmod(bar2.period / bar1.period, 1.0)
        drop = 2.0 * self.force / bar1.impedance  # 1 - rho, without cancellation
        rho_n = math.exp(n * math.log1p(-drop))
        impulse = (1.0 - rho_n) / drop  # of n complete intervals, over F0 T1; its centroid over T1
        centroid = 0.5 + (1.0 - drop) / drop - n * rho_n / (1.0 - rho_n)
        return bar1.period * (impulse * centroid + s * rho_n * (n + 0.5 * s)) / (impulse + s * rho_n)

    @property
    def alpha(self) -> tuple[float, float]:
        """Influence coefficients of distributed masses, exact in all cases [-]."""
        half = 0.5 * self.impulse
        return half / self.first.mass, half / self.second.mass

    @property
    def e(self) -> float:
        """Effective restitution of the centres of mass, exact in all cases [-]."""
        return self.impulse / self.mass - 1.0
