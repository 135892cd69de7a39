r"""Relations between the restitution of a free impact and the damping constant of a contact law.

Two masses with the reduced mass :math:`m` collide at the approach speed :math:`v_0`.

**Spring and dashpot**, :math:`f = k\delta + c\dot\delta`, :math:`\xi = c / (2\sqrt{k m})`.

*Sticky* (released at :math:`\delta = 0`, tension allowed): :math:`e = \exp(-\pi\xi/\sqrt{1-\xi^2})`,
Anagnostopoulos (2004), Earthquake Engng Struct. Dyn. 33: 897-902; Cole et al. (2011), Eqs 15-17.

*No tension* (released at :math:`f = 0`): the motion is
:math:`\delta = (v_0/\omega_d) e^{-\xi\omega t}\sin\omega_d t`, and :math:`f = 0` at
:math:`t = 2\arccos(\xi)/\omega_d`, so that

.. math:: e = \exp\!\left(-\frac{2\xi\arccos\xi}{\sqrt{1-\xi^2}}\right), \qquad
          e = \exp\!\left(-\frac{2\xi\,\mathrm{arcosh}\,\xi}{\sqrt{\xi^2-1}}\right)\ (\xi > 1)

(Schwager and Poeschel 2007, Granular Matter 9: 465-469, give the same result); e = exp(-2) at xi = 1.

Its impulse is :math:`(1 + e) m v_0`; :math:`\int f t\,dt = m v_0 e (t_r + 2\xi/\omega)` by parts, as
:math:`f = 0` leaves :math:`\delta = (c/k) e v_0`.

*One-sided* (the dashpot acts in approach only): the motion reverses at half that time,
:math:`\arccos(\xi)/\omega_d`, and the spring releases its energy at that instant, so that this restitution
is the square root of the one above.

**Power laws** :math:`f = k\delta^n + c\,\delta^{(n-1)/2}\dot\delta`: with :math:`x = \delta^{(n+1)/2}`, the
path in the plane of :math:`x` and :math:`\dot\delta` is that of the linear contact with the mass
:math:`(n+1)m/2`, so that all three relations hold with :math:`\xi = c / \sqrt{2(n+1) k m}`.

**Damping that grows with the spring force** :math:`F(\delta)`, for any such force: with
:math:`u = \dot\delta/v_0`

.. math:: \frac{u\,du}{1 + d u} = -\frac{F\,d\delta}{m v_0^2}, \qquad
          \int_0^u \frac{s\,ds}{1 + d s} = u^2 \varphi(d u), \qquad
          \varphi(x) = \frac{x - \ln(1 + x)}{x^2}

*In both phases*, :math:`f = F(1 + d\dot\delta/v_0)`: the spring does the same work in both phases,
:math:`\varphi(d) = e^2 \varphi(-d e)`, which is :math:`\ln\frac{1 + d}{1 - d e} = d (1 + e)`.

*In restitution only*: :math:`\tfrac12 = e^2 \varphi(-d e)`.
"""

from __future__ import annotations

import math
from collections.abc import Callable


def with_tension(xi: float) -> float:
    """Return the restitution [-] for damping ratio `xi` [-] when the contact pulls until the
    overlap is gone.
    """
    if xi >= 1.0:
        return 0.0
    return math.exp(-math.pi * xi / math.sqrt((1.0 - xi) * (1.0 + xi)))


def with_tension_ratio(e: float) -> float:
    """Return the damping ratio [-] for restitution `e` in (0, 1] with tension until the overlap is gone."""
    log = math.log(e)
    return -log / math.sqrt(math.pi**2 + log * log)


def no_tension_time(xi: float) -> float:
    """Return the time of release at zero force for damping ratio `xi`, times the undamped frequency [-]."""
    above_1 = xi - 1.0
    if abs(above_1) < 1e-6:
        # acos(xi)/sqrt(1-xi^2) and its continuation beyond 1 have a common series
        # 1 - above_1/3 + 2 above_1^2/15
        return 2.0 * (1.0 - above_1 / 3.0 + 2.0 * above_1 * above_1 / 15.0)
    if xi < 1.0:
        return 2.0 * math.acos(xi) / math.sqrt((1.0 - xi) * (1.0 + xi))
    return 2.0 * math.acosh(xi) / math.sqrt((xi - 1.0) * (xi + 1.0))


def no_tension(xi: float) -> float:
    """Return the restitution [-] for damping ratio `xi` [-] when the contact releases at zero force."""
    return math.exp(-xi * no_tension_time(xi))


def no_tension_ratio(e: float) -> float:
    """Return the damping ratio [-] for restitution `e` in (0, 1] with release at zero force."""
    if e == 1.0:
        return 0.0
    high = 1.0
    while no_tension(high) > e:
        high *= 2.0
    return _root(lambda xi: no_tension(xi) - e, 0.0, high)


def push_centroid(xi: float) -> float:
    """Return the time from the touch to the centroid of the compressive force, times the undamped frequency
    [-].
    """
    e = no_tension(xi)
    return e * (no_tension_time(xi) + 2.0 * xi) / (1.0 + e)


def one_sided(xi: float) -> float:
    """Return the restitution [-] for damping ratio `xi` [-] of a dashpot that acts in approach only."""
    return math.sqrt(no_tension(xi))


def one_sided_ratio(e: float) -> float:
    """Return the damping ratio [-] for restitution `e` in (0, 1] with a dashpot in approach only."""
    return no_tension_ratio(e * e)


def phi(x: float) -> float:
    """Return ``(x - ln(1 + x)) / x^2``, which is 1/2 at zero and decreases from infinity at -1."""
    if x <= -1.0:
        return math.inf
    if abs(x) > 0.1:
        return (x - math.log1p(x)) / (x * x)
    return math.fsum((-x) ** j / (j + 2) for j in range(18))


def in_both_phases(d: float) -> float:
    """Return the restitution [-] for the constant `d` [-] of damping that grows with the spring's force."""
    if d == 0.0:
        return 1.0
    return _root(lambda e: phi(d) - e * e * phi(-d * e), 0.0, min(1.0, 1.0 / d))


def in_both_phases_constant(e: float) -> float:
    """Return the constant [-] of damping that grows with the spring's force, for restitution `e`
    in (0, 1].
    """
    if e == 1.0:
        return 0.0
    return _root(lambda d: phi(d) - e * e * phi(-d * e), 0.0, 1.0 / e)


def in_restitution(d: float) -> float:
    """Return the restitution [-] for the constant `d` [-] of such damping in restitution only."""
    if d == 0.0:
        return 1.0
    return _root(lambda e: 0.5 - e * e * phi(-d * e), 0.0, min(1.0, 1.0 / d))


def in_restitution_constant(e: float) -> float:
    """Return the constant [-] of such damping in restitution only, for restitution `e` in (0, 1]."""
    if e == 1.0:
        return 0.0
    return _root(lambda d: 0.5 - e * e * phi(-d * e), 0.0, 1.0 / e)


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Return the root of a decreasing function, by bisection to the last bit."""
    while True:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            return middle
        if function(middle) > 0.0:
            low = middle
        else:
            high = middle
