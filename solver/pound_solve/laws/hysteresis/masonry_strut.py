r"""Masonry strut: the diagonal strut of an infill panel, which carries compression only.

With the compression :math:`f = -F` and the shortening :math:`x = -d`; :math:`f_m, x_m` are the strength and
the shortening there, :math:`x_u` the ultimate shortening, :math:`a = k x_m / f_m`, :math:`X = x / x_m`:

.. math:: f = f_m \frac{a X + (b - 1) X^2}{1 + (a - 2) X + b X^2}, \quad b = 1 - a \frac{x_m}{x_u}
          \quad (x \le x_m), \qquad
          f = f_m \Bigl[1 - \Bigl(\frac{x - x_m}{x_u - x_m}\Bigr)^2\Bigr] \quad (x_m < x \le x_u)

is the *envelope*; at :math:`x_u` the strut has failed.  The positive yield force has no effect.  Every
other curve joins two points 1 and 2 with the slopes :math:`E_1, E_2` there; :math:`E_s` is the slope of the
chord:

.. math:: \frac{f - f_1}{f_2 - f_1} = \frac{r_1 X + X^2}{1 + (r_1 - q) X + q X^2}, \qquad
          X = \frac{x - x_1}{x_2 - x_1}, \quad r_i = \frac{E_i}{E_s}, \quad q = 2 - r_2 (1 + r_1)

These curves are monotonic.

* Unloading from :math:`(x_{un}, f_{un})` on the envelope leads to the plastic shortening

  .. math:: x_{pl} = x_{un} - \frac{f_{un} (x_{un} + \beta_a f_m / k)}{f_{un} + \beta_a f_m}

  with :math:`E_1 = \gamma_{un} k` and :math:`E_2 = \gamma_{plu} k / (1 + x_{un}/x_m)^{e_1} \le E_s/2`.  If
  :math:`E_1 < 1.5 E_s`, it leads to the shortening of :math:`E_1 = 1.5 E_s`.
* The strut that has opened closes at :math:`x_{pl}` or at :math:`x_{cl}`, whichever is less.  Reloading
  leads along a first curve to the *change point* :math:`(x_{ch}, f_{ch})`, then along a second one to the
  envelope at :math:`x_{re}`.  At first :math:`x_{re} = x_{un}`.  The n-th reloading since then moves it by
  :math:`\alpha_{re} (x_t - x_r) / n^{e_2}`, from the last reversal :math:`x_t` to unloading and the return
  at :math:`x_r \ge x_{pl}`; if the strength is zero there, the strut has failed.  The change point is

  .. math:: f_{ch} = f_{re} \max\Bigl(\frac{\beta_{ch}}{(n + 1)^{0.4}}, \frac12\Bigr), \quad
            x_{ch} = x_b + \frac{f_{ch}}{E_{ch}}, \quad E_{ch} = \frac{f_{un}}{x_{un} - x_b}, \quad
            x_b = x_{pl} + \alpha_{ch} \Bigl(x_{un} - \frac{f_{un}}{\gamma_{un} k} - x_{pl}\Bigr)

  The first curve begins with :math:`\gamma_{plr} \gamma_{plu} k / (1 + x_{un}/x_m)^{e_1}`, but at most with
  :math:`0.2 E_{ch}` and :math:`0.9 E_s`.  Before :math:`x_{pl}` it begins with less, down to 0.15 of this
  at :math:`x = 0`.  The second curve begins with :math:`E_{ch}` and ends with the slope of the envelope.
* A return from unloading begins the first curve up to 0.9 of the change point; its first slope is 1.2 times
  that before the return, but at most :math:`0.9 E_s`.  Above, it begins the second curve, with twice the
  slope before the return or :math:`1.2 E_s`, whichever is more, but at most :math:`\gamma_{un} k`.
* Unloading from the first curve begins with twice its slope, but at most :math:`\gamma_{un} k`, and makes
  its end the new :math:`x_{pl}`; from the second curve it begins with :math:`\gamma_{un} k`.  Beyond
  :math:`x_{un}`, the reversal is the new :math:`(x_{un}, f_{un})`.

Internal variables: :math:`x_{un}, f_{un}, x_{pl}, x_{re}`, the number of the next reloading, :math:`x_t`,
the points and slopes of the present curve, and the energy that could be recovered where loading began.  The
work along a curve is found by Gauss' formula with 16 points: the closed form of the integral loses its
digits where a coefficient of the denominator is small.

References
----------
Crisafulli FJ (1997), Seismic behaviour of reinforced concrete structures with masonry infills, PhD thesis,
University of Canterbury, Christchurch.  The thesis was not read: the equations are those of the material
Masonry of G. Torrisi (2014) for OpenSees.  It is Ruaumoko's rule 33, whose parameters are not certain.
Our choices, where that material contradicts itself, its force jumps or its loops generate energy: no
tensile strength; the area of the strut is constant; a virgin strut closes at zero; :math:`x_{pl}` of a
larger :math:`x_{un}` is not less; the first slope of reloading has :math:`\gamma_{plu}` (there
:math:`\gamma_{un}`); the second curve ends with the slope zero where the envelope falls; a return under
force leads to a point of the envelope above that force; and unloading gives back no more than the energy
that is there: otherwise :math:`E_1` is multiplied, and :math:`E_2` divided, by the factor that makes it
equal.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import (
    FY_MINUS,
    REVERSAL_DOWN,
    REVERSAL_UP,
    STRENGTHLESS,
    BranchKind,
    K,
    Law,
    Numbers,
    Rule,
    above,
    below,
    linear,
    rate_independent,
)
from pound_solve.laws.refusal import ItemError

OPEN, OPENING, RISING, FALLING, UNLOADING, CLOSING, RELOADING, FAILED = range(8)
# parameters of a law after K, FY, FY_MINUS: x_m, x_u, x_cl, alpha_ch, alpha_re, beta_a, beta_ch, gamma_un,
# gamma_plu, gamma_plr, e_1, e_2
X_M, X_U, X_CL, A_CH, A_RE, B_A, B_CH, G_UN, G_PLU, G_PLR, E_1, E_2 = range(3, 15)
# internal variables: x_un, f_un, x_pl, x_re, number of the next reloading, x_t; points 1 and 2 of the
# present curve, and the slopes there (on the envelope X1 is where it was reached); energy that could be
# recovered where the present loading began
X_UN, F_UN, X_PL, X_RE, CYCLE, X_T, X1, F1, X2, F2, SLOPE1, SLOPE2, ENERGY = range(13)
GAUSS = 16  #: number of points
STEEP = 20.0  #: coefficient c from which the range is halved
NODES, WEIGHTS = (tuple(map(float, x)) for x in np.polynomial.legendre.leggauss(GAUSS))
ROUNDING = 1e-12  #: relative error of an area
NEAR = 1e-12  #: distance from the envelope, relative to the shortening, up to which a return reaches it
NO_FORCE = 1e-30  #: compression, relative to the strength, up to which there is none: its work underflows
MOST_STEEPENED = 1e6  #: largest factor on the first slope of unloading, where rounding leaves no energy
LEAST_UNLOADING = 1.5  #: least ratio of the first slope of unloading to that of the chord


def quotient(a: float, b: float, c: float, e: float, x: float) -> tuple[float, float]:
    """Return the value and slope of (a x + b x^2) / (1 + c x + e x^2), with tangents beyond 0 and 1."""
    inside = min(max(x, 0.0), 1.0)
    denominator = 1.0 + (c + e * inside) * inside
    slope = (a + 2.0 * b * inside + (b * c - a * e) * inside * inside) / (denominator * denominator)
    return (a + b * inside) * inside / denominator + slope * (x - inside), slope


def integral(a: float, b: float, c: float, e: float, x0: float, x: float) -> float:
    """Return the integral of the quotient from `x0` to `x`.

    A root of the denominator comes close to 0 for a large c; in terms of the logarithm of 1 + c x it stays
    far enough for an error of 1e-10.
    """
    low, high = min(max(x0, 0.0), 1.0), min(max(x, 0.0), 1.0)
    scale = max(c, 1e-6)
    t, t_end = math.log1p(scale * low), math.log1p(scale * high)
    parts = 1 if c < STEEP else 2
    half = 0.5 * (t_end - t) / parts
    total = 0.0
    for _ in range(parts):
        for n in range(GAUSS):
            y = math.expm1(t + (1.0 + NODES[n]) * half) / scale
            total += WEIGHTS[n] * (a + b * y) * y / (1.0 + (c + e * y) * y) * (1.0 + scale * y)
        t += 2.0 * half
    total *= half / scale
    if x0 != low:
        value, slope = quotient(a, b, c, e, low)
        total -= (x0 - low) * (value + 0.5 * slope * (x0 - low))
    if x != high:
        value, slope = quotient(a, b, c, e, high)
        total += (x - high) * (value + 0.5 * slope * (x - high))
    return total


def envelope(p: Numbers, x: float) -> tuple[float, float]:
    """Return the compression and slope of the envelope."""
    f_m, x_m, x_u = -p[FY_MINUS], p[X_M], p[X_U]
    if x <= x_m:
        a = p[K] * x_m / f_m
        b = 1.0 - a * x_m / x_u
        y, slope = quotient(a, b - 1.0, a - 2.0, b, x / x_m)
        return f_m * y, f_m / x_m * slope
    if x >= x_u:
        return 0.0, 0.0
    z = (x - x_m) / (x_u - x_m)
    return f_m * (1.0 - z * z), -2.0 * f_m * z / (x_u - x_m)


def envelope_area(p: Numbers, at: int, x0: float, x: float) -> float:
    """Return the area below the envelope, on its rising or its falling part."""
    f_m, x_m, x_u = -p[FY_MINUS], p[X_M], p[X_U]
    if at == RISING:
        a = p[K] * x_m / f_m
        b = 1.0 - a * x_m / x_u
        return f_m * x_m * integral(a, b - 1.0, a - 2.0, b, x0 / x_m, x / x_m)
    z0, z = (x0 - x_m) / (x_u - x_m), (x - x_m) / (x_u - x_m)
    return f_m * (x_u - x_m) * (z - z0) * (1.0 - (z * z + z * z0 + z0 * z0) / 3.0)


def ratios(m: Numbers) -> tuple[float, float, float]:
    """Return the slope of the chord of the present curve, r_1 and q."""
    chord = (m[F2] - m[F1]) / (m[X2] - m[X1])
    r = m[SLOPE1] / chord
    return chord, r, 2.0 - m[SLOPE2] / chord * (1.0 + r)


def on_curve(m: Numbers, x: float) -> tuple[float, float]:
    """Return the compression and slope of the present curve."""
    chord, r, q = ratios(m)
    y, slope = quotient(r, 1.0, r - q, q, (x - m[X1]) / (m[X2] - m[X1]))
    return m[F1] + (m[F2] - m[F1]) * y, chord * slope


def curve_area(m: Numbers, x0: float, x: float) -> float:
    """Return the area below the present curve."""
    _, r, q = ratios(m)
    span = m[X2] - m[X1]
    y = integral(r, 1.0, r - q, q, (x0 - m[X1]) / span, (x - m[X1]) / span)
    return m[F1] * (x - x0) + (m[F2] - m[F1]) * span * y


def compression(p: Numbers, at: int, m: Numbers, x: float) -> tuple[float, float]:
    """Return the compression and slope on a branch."""
    if at in (RISING, FALLING):
        return envelope(p, x)
    if at in (UNLOADING, CLOSING, RELOADING):
        return on_curve(m, x)
    return 0.0, 0.0


def curve(
    p: Numbers, at: int, m: Numbers, d0: float, d: float, v: float
) -> tuple[float, float, float, float]:
    """Evaluate the force."""
    f, slope = compression(p, at, m, -d)
    work = 0.0
    if at in (RISING, FALLING):
        work = envelope_area(p, at, -d0, -d)
    elif at in (UNLOADING, CLOSING, RELOADING):
        work = curve_area(m, -d0, -d)
    return 0.0 - f, slope, 0.0, work


def closing(p: Numbers, m: Numbers) -> float:
    """Return the shortening at which an open strut closes."""
    return min(p[X_CL], m[X_PL]) if m[X_UN] > 0.0 else 0.0


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state."""
    return OPEN, (0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the events of the branch, and the initial stiffness while the strut carries a force."""
    if at == OPEN:
        return linear(0.0, 0.0, below(-closing(p, m)))
    if at == OPENING:
        return linear(0.0, 0.0, REVERSAL_DOWN, above(-closing(p, m)))
    if at == UNLOADING:
        return linear(p[K], 0.0, REVERSAL_DOWN, above(-m[X2]))
    if at == FAILED:
        return linear(0.0, 0.0)
    end = m[X2]
    if at == RISING:
        end = p[X_M]
    elif at == FALLING:
        end = p[X_U]
    elif at == CLOSING:
        end = m[X1]
    return linear(p[K], 0.0, REVERSAL_UP, below(-end))


def available(p: Numbers, at: int, m: Numbers, x: float) -> float:
    """Return the largest energy that the strut can give back on a branch of loading: what could be
    recovered where loading began, and the work since then.
    """
    if at in (RISING, FALLING):
        return m[ENERGY] + envelope_area(p, at, m[X1], x)
    return m[ENERGY] + curve_area(m, m[X2] if at == CLOSING else m[X1], x)


def share_left(r1: float, r2: float) -> float:
    """Return the area between a curve and its point 2, as a share of the rectangle around it."""
    q = 2.0 - r2 * (1.0 + r1)
    return 1.0 - integral(r1, 1.0, r1 - q, q, 0.0, 1.0)


def steepened(r1: float, r2: float, share: float) -> float:
    """Return the factor of r_1, and divisor of r_2, with which a curve of unloading gives back a `share`
    of the rectangle around it.
    """
    low, high = 1.0, 2.0
    while share_left(r1 * high, r2 / high) > share and high < MOST_STEEPENED:
        low, high = high, 2.0 * high
    while high - low > 1e-14 * high:
        factor = 0.5 * (low + high)
        if share_left(r1 * factor, r2 / factor) > share:
            low = factor
        else:
            high = factor
    return high


def last_slope(p: Numbers, m: Numbers) -> float:
    """Return the slope with which unloading from the envelope ends, unless the chord limits it."""
    slope: float = p[G_PLU] * p[K] / (1.0 + m[X_UN] / p[X_M]) ** p[E_1]
    return slope


def farthest(p: Numbers, at: int, m: Numbers, x: float, f: float) -> Numbers:
    """Return the internal variables after a reversal on a branch, which may be the farthest so far."""
    if at == CLOSING or (at == RELOADING and x <= m[X_UN]):
        return m
    focus = p[B_A] * -p[FY_MINUS]
    plastic = x - f * (x + focus / p[K]) / (f + focus)
    target = x if envelope(p, x)[0] >= f else m[X_RE]
    return (x, f, max(m[X_PL], plastic), target, 1.0, *m[X_T:])


def unloading(p: Numbers, at: int, m: Numbers, x: float) -> Numbers:
    """Return the internal variables after a reversal to unloading on a branch."""
    f, slope = compression(p, at, m, x)
    energy = available(p, at, m, x)
    now = farthest(p, at, m, x, f)
    first, plastic = p[G_UN] * p[K], now[X_PL]
    if at == CLOSING:
        first = min(2.0 * slope, first)
    end = min(plastic, x - LEAST_UNLOADING * f / first)
    if at == CLOSING:
        plastic = end
    last = min(last_slope(p, now), 0.5 * f / (x - end))
    unloaded = (*now[:X_PL], plastic, *now[X_RE:X_T], x, x, f, end, 0.0, first, last, 0.0)
    if curve_area(unloaded, end, x) <= energy * (1.0 + ROUNDING):
        return unloaded
    chord = f / (x - end)
    factor = steepened(first / chord, last / chord, energy / (f * (x - end)))
    return (*unloaded[:SLOPE1], first * factor, last / factor, 0.0)


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy recovered along the curve of unloading."""
    x = -d
    if f >= 0.0:
        return 0.0
    if at != UNLOADING:
        m = unloading(p, at, m, x)
    return -curve_area(m, x, m[X2])


def begin_unloading(p: Numbers, at: int, m: Numbers, x: float) -> tuple[int, Numbers]:
    """Return the state after a reversal to unloading: open, if there was no motion under a force."""
    if compression(p, at, m, x)[0] <= NO_FORCE * -p[FY_MINUS]:
        return after_unloading(p, (*m[:X_T], x, *m[X1:]), x)
    return UNLOADING, unloading(p, at, m, x)


def after_unloading(p: Numbers, m: Numbers, x: float) -> tuple[int, Numbers]:
    """Return the state at zero force; where the strut is not open yet, a reversal closes it."""
    return (OPENING if x > closing(p, m) else OPEN), m


def on_envelope(p: Numbers, m: Numbers, x: float, energy: float) -> tuple[int, Numbers]:
    """Return the state on the envelope from a shortening, where an energy could be recovered."""
    return (RISING if x < p[X_M] else FALLING), (*m[:X1], x, *m[F1:ENERGY], energy)


def to_envelope(
    p: Numbers, m: Numbers, x: float, f: float, first: float, energy: float
) -> tuple[int, Numbers]:
    """Return the state on the second curve of reloading from a point, which begins with the slope `first`
    and where an energy could be recovered.
    """
    f_re, tangent = envelope(p, m[X_RE])
    return RELOADING, (*m[:X1], x, f, m[X_RE], f_re, first, max(tangent, 0.0), energy)


def next_target(p: Numbers, m: Numbers, x: float, f: float) -> Numbers:
    """Return the internal variables in which reloading from a point moves its end on the envelope.

    Under a force, that end stays where the envelope is above that force: part of the way down to it.
    """
    if m[X_T] <= m[X_PL]:
        return m
    target = m[X_RE] + p[A_RE] * (m[X_T] - max(x, m[X_PL])) / m[CYCLE] ** p[E_2]
    if f > 0.0:
        f_m, f_old = -p[FY_MINUS], envelope(p, m[X_RE])[0]
        least = f_old - (f_old - f) ** 2 / f_old
        if envelope(p, target)[0] < least:
            target = p[X_M] + (p[X_U] - p[X_M]) * math.sqrt(1.0 - least / f_m)
    return (*m[:X_RE], target, m[CYCLE] + 1.0, *m[X_T:])


def reloading(p: Numbers, at: int, m: Numbers, x: float) -> tuple[int, Numbers]:
    """Return the state after a reversal while unloading, or where the strut closes."""
    f, slope = compression(p, at, m, x)
    f = max(f, 0.0)
    energy = recoverable(p, at, m, -x, -f)
    m = next_target(p, m, x, f)
    f_re = envelope(p, m[X_RE])[0]
    if f_re <= 0.0:
        return FAILED, m
    if m[X_RE] - x <= NEAR * m[X_RE]:
        return on_envelope(p, m, x, energy)
    x_b = m[X_PL] + p[A_CH] * (m[X_UN] - m[F_UN] / (p[G_UN] * p[K]) - m[X_PL])
    steep = max(m[F_UN] / (m[X_UN] - x_b), f_re / (m[X_RE] - x_b))
    f_ch = f_re * max(p[B_CH] / m[CYCLE] ** 0.4, 0.5)
    x_ch = x_b + f_ch / steep
    if at == UNLOADING and (f > 0.9 * f_ch or x > 0.9 * x_ch):
        chord = (f_re - f) / (m[X_RE] - x)
        return to_envelope(p, m, x, f, min(max(2.0 * slope, 1.2 * chord), p[G_UN] * p[K]), energy)
    chord = (f_ch - f) / (x_ch - x)
    if at == UNLOADING:
        first = 1.2 * slope
    else:
        first = p[G_PLR] * last_slope(p, m)
        if p[X_CL] <= m[X_PL] and m[X_PL] > 0.0:
            first *= 0.15 + 0.85 * max(x, 0.0) / m[X_PL]
        first = min(first, 0.2 * steep)
    return CLOSING, (*m[:X1], x_ch, f_ch, x, f, steep, min(first, 0.9 * chord), energy)


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a reversal or at the end of a branch."""
    x = -d
    if at in (RISING, FALLING, CLOSING, RELOADING) and event == 0:
        return begin_unloading(p, at, m, x)
    if at == RISING:
        return on_envelope(p, m, p[X_M], available(p, at, m, p[X_M]))
    if at == FALLING:
        return FAILED, m
    if at == CLOSING:
        return to_envelope(p, m, m[X1], m[F1], m[SLOPE1], available(p, at, m, m[X1]))
    if at == RELOADING:
        return on_envelope(p, m, m[X_RE], available(p, at, m, m[X_RE]))
    if at == UNLOADING and event == 1:
        return after_unloading(p, m, m[X2])
    if at == OPENING and event == 1:
        return OPEN, m
    if m[X_UN] == 0.0:
        return on_envelope(p, m, 0.0, 0.0)
    return reloading(p, at, m, x)


def first_yield(p: Numbers) -> tuple[float, float]:
    """Return the deformations from which ductility counts: none in tension."""
    return math.nan, p[FY_MINUS] / p[K]


RULE = Rule(
    (
        *BranchKind.OPEN.named("open", "opening"),
        *BranchKind.ELASTIC.named("on the envelope"),
        *BranchKind.YIELDING.named("crushing"),
        *BranchKind.ELASTIC.named("unloading", "closing", "reloading to the envelope"),
        *BranchKind.OPEN.named(STRENGTHLESS),
    ),
    start,
    branch,
    transition,
    recoverable,
    curve,
    rate_independent,
    first_yield=first_yield,
    parameters=15,
    variables=13,
)


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two yield forces, of which the negative one
    is the strength in compression.

    Raises
    ------
    ValueError
        There is no strength in compression, or the envelope would be steeper than the initial stiffness.
    """
    if fy_minus >= 0.0:
        raise ValueError("this rule needs a negative yield force, the strength in compression")
    x_m, x_u = values["DM"], values["DU"]
    if x_u <= x_m:
        raise ItemError("the ultimate shortening DU is above DM", "DU")
    least = (2.0 - x_m / x_u) * -fy_minus / k
    if x_m < least:
        raise ItemError(
            f"DM must be at least (2 - DM/DU) F/k = {least:g}; else the envelope is steeper than k", "DM"
        )
    names = ("ACH", "ARE", "BA", "BCH", "GUN", "GPLU", "GPLR", "EX1", "EX2")
    return Law(RULE, (k, fy_plus, fy_minus, x_m, x_u, -values["DCL"], *(values[n] for n in names)))


SPEC = Spec(
    "hysteresis",
    "MASONRY_STRUT",
    "strut of a masonry infill: compression only, crushing, pinching",
    (
        Field("DM", Kind.REAL, "L", above=0.0, doc="shortening at the strength, the negative yield force"),
        Field("DU", Kind.REAL, "L", above=0.0, doc="ultimate shortening: the strut has failed"),
        Field(
            "DCL",
            Kind.REAL,
            "L",
            default=0.0,
            doc="elongation (negative: shortening) at which open cracks begin to close",
        ),
        Field(
            "ACH",
            Kind.REAL,
            "-",
            default=0.45,
            lo=0.0,
            below=1.0,
            doc="position of the change point, between plastic shortening (0) and elastic unloading (1)",
        ),
        Field(
            "ARE",
            Kind.REAL,
            "-",
            default=0.3,
            lo=0.0,
            doc="growth of the shortening at the return to the envelope, per shortening unloaded",
        ),
        Field(
            "BA",
            Kind.REAL,
            "-",
            default=1.75,
            above=0.0,
            doc="tension at the focus of the unloading chords, a multiple of the strength",
        ),
        Field(
            "BCH",
            Kind.REAL,
            "-",
            default=0.65,
            lo=0.5,
            below=1.0,
            doc="ratio of the force at the change point to that at the return to the envelope",
        ),
        Field("GUN", Kind.REAL, "-", default=2.0, lo=1.5, doc="first slope of unloading, a multiple of k"),
        Field(
            "GPLU",
            Kind.REAL,
            "-",
            default=0.6,
            lo=0.0,
            hi=1.0,
            doc="last slope of unloading, a multiple of k, from a small shortening",
        ),
        Field(
            "GPLR",
            Kind.REAL,
            "-",
            default=1.3,
            lo=1.0,
            doc="ratio of the first slope of reloading to the last slope of unloading",
        ),
        Field(
            "EX1",
            Kind.REAL,
            "-",
            default=1.75,
            lo=0.0,
            doc="exponent by which that slope decreases with the shortening",
        ),
        Field(
            "EX2",
            Kind.REAL,
            "-",
            default=1.25,
            lo=0.0,
            doc="exponent by which the growth of the return decreases with the number of reloadings",
        ),
    ),
    reference="Crisafulli 1997",
    sample="DM=4 DU=12",
    impl=build,
)
