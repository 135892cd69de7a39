r"""Restitution of a free impact against the damping ratio of the linear viscoelastic contact.

Two masses meet, reduced mass :math:`m`, contact :math:`f = k\delta + c\dot\delta`,
:math:`\xi = c / (2\sqrt{k m})`.

*Sticky* (released at :math:`\delta = 0`, tension allowed): :math:`e = \exp(-\pi\xi/\sqrt{1-\xi^2})`,
Anagnostopoulos (2004), Earthquake Engng Struct. Dyn. 33: 897-902; Cole et al. (2011), Eqs 15-17.

*No tension* (released at :math:`f = 0`):
the motion is :math:`\delta = (v_0/\omega_d) e^{-\xi\omega t}\sin\omega_d t`;
:math:`f = 0` at :math:`t = 2\arccos(\xi)/\omega_d`, where

.. math:: e = \exp\!\left(-\frac{2\xi\arccos\xi}{\sqrt{1-\xi^2}}\right), \qquad
          e = \exp\!\left(-\frac{2\xi\,\mathrm{arcosh}\,\xi}{\sqrt{\xi^2-1}}\right)\ (\xi > 1)

(Schwager and Poeschel 2007, Granular Matter 9: 465-469, give the same result); e = exp(-2) at xi = 1.
"""

from __future__ import annotations

import math


def sticky(xi: float) -> float:
    """Restitution [-] for damping ratio `xi` [-] when the contact holds until the overlap is gone."""
    if xi >= 1.0:
        return 0.0
    return math.exp(-math.pi * xi / math.sqrt((1.0 - xi) * (1.0 + xi)))


def sticky_ratio(e: float) -> float:
    """Damping ratio [-] that gives restitution `e` in (0, 1] with a sticky contact."""
    log = math.log(e)
    return -log / math.sqrt(math.pi**2 + log * log)


def no_tension_time(xi: float) -> float:
    """Time of release at zero force for damping ratio `xi`, times the undamped frequency [-]."""
    off = xi - 1.0
    if abs(off) < 1e-6:
        # acos(xi)/sqrt(1-xi^2) and its continuation beyond 1 share the series 1 - off/3 + 2 off^2/15
        return 2.0 * (1.0 - off / 3.0 + 2.0 * off * off / 15.0)
    if xi < 1.0:
        return 2.0 * math.acos(xi) / math.sqrt((1.0 - xi) * (1.0 + xi))
    return 2.0 * math.acosh(xi) / math.sqrt((xi - 1.0) * (xi + 1.0))


def no_tension(xi: float) -> float:
    """Restitution [-] for damping ratio `xi` [-] when the contact lets go at zero force."""
    return math.exp(-xi * no_tension_time(xi))


def no_tension_ratio(e: float) -> float:
    """Damping ratio [-] that gives restitution `e` in (0, 1] with a contact that lets go at zero force."""
    if e == 1.0:
        return 0.0
    low, high = 0.0, 1.0
    while no_tension(high) > e:
        high *= 2.0
    # the function falls monotonically; bisection to the last bit
    while True:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            return middle
        if no_tension(middle) > e:
            low = middle
        else:
            high = middle
