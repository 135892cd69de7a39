r"""Bouc-Wen: smooth hysteresis from a differential equation.

.. math:: f = r k d + (1 - r) k z, \qquad
          \frac{dz}{dd} = 1 - \Bigl|\frac{z}{d_y}\Bigr|^n
                          \bigl(1 - \beta + \beta\,\mathrm{sgn}(z\,\dot d)\bigr)

with :math:`d_y = F_y/k` of the side of :math:`z`.  The force tends to the lines of the bilinear rule, and
the rule tends to the bilinear rule as :math:`n \to \infty`.  (In the usual form A = 1,
:math:`\beta_{BW} = \beta\,d_y^{-n}`, :math:`\gamma_{BW} = (1 - \beta)\,d_y^{-n}`.)  With
:math:`y = |z|/d_y` and :math:`u = |d|/d_y` measured from :math:`z = 0`, the equation is

.. math:: \frac{dy}{du} = 1 - y^n \text{ outwards}, \qquad \frac{dy}{du} = 1 + (2\beta - 1)\,y^n
          \text{ inwards (scaled by } (2\beta-1)^{1/n}\text{: } 1 + y^n)

so that :math:`u` and the work :math:`w = \int y\,du` are incomplete beta functions of :math:`y^n`,

.. math:: \int_0^y \frac{y^{an-1}\,dy}{1 \mp y^n} = \frac{y^{an}}{n}\,\phi(a, \pm y^n), \quad
          \phi(a, q) = \sum_j \frac{q^j}{a + j}, \quad a = \tfrac1n \text{ for } u,\ \tfrac2n \text{ for } w

These are summed as series and inverted by Newton's iteration to an error below 1e-13, independently of any
step size.

Internal variables: the position :math:`u d_y` (signed, along the present direction) and the deformation at
the last reversal, and :math:`\int z\,dd` from :math:`z = 0`.

References
----------
Bouc R (1967), Forced vibration of mechanical systems with hysteresis, Proc. 4th Conf. Nonlinear
Oscillation, Prague.  Wen YK (1976), Method for random vibration of hysteretic systems, J. Eng. Mech. Div.
ASCE 102(EM2): 249-263.  Erlicher S, Point N (2004), Thermodynamic admissibility of Bouc-Wen type hysteresis
models, C. R. Mecanique 332(1): 51-57 (closed loops dissipate for :math:`-\beta \le \gamma \le \beta`).
Series: NIST Handbook of Mathematical Functions (2010), 8.17.7, 15.8.1 and 15.8.10.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import (
    FY,
    FY_MINUS,
    PAST,
    REVERSAL_DOWN,
    REVERSAL_UP,
    BranchKind,
    K,
    Law,
    Numbers,
    Rule,
    SmoothNumbers,
    linear,
    rate_independent,
)
from pound_solve.laws.hysteresis.backbone import R_FIELD
from pound_solve.laws.mirror import need_both_sides

LOADING, UNLOADING = 0, 1
# parameters of a law after K, FY, FY_MINUS: r, n, beta; constants of the series of u and of w near y = 1;
# scale (2 beta - 1)^(1/n) of an inward motion
R, N, BETA, C_U, C_W, SCALE = range(3, 9)
# internal variables at the last reversal: position along the present direction, deformation, integral of z
POSITION, REVERSAL, INTEGRAL = range(3)
SATURATED = 40.0  #: value of -log(1 - y^n) beyond which y is 1 to the last digit


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state: z = 0."""
    return LOADING, (0.0, 0.0, 0.0)


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: loading until the motion reverses, or unloading until it reverses again."""
    return linear(p[K], 0.0, REVERSAL_DOWN if at == LOADING else REVERSAL_UP)


# ---------------------------------------------------------------------- y, u and w


def phi(a: float, q: float) -> float:
    """Return the sum of q^j / (a + j) for q up to 1/2, with Pfaff's transformation for negative q."""
    if q >= 0.0:
        j, power, total = 0.0, 1.0, 1.0 / a
        while power > 1e-17:
            j, power = j + 1.0, power * q
            total += power / (a + j)
        return total
    x = q / (q - 1.0)
    j, term, total = 0.0, 1.0, 1.0
    while term > 1e-17:
        j += 1.0
        term *= j / (a + j) * x
        total += term
    return total / (a * (1.0 - q))


def series_near_1(a: float, t: float) -> float:
    """Return the sum of (1-a)(2-a)...(j-a) t^j / (j j!) for t up to 1/2."""
    j, term, total = 1.0, (1.0 - a) * t, (1.0 - a) * t
    while abs(term) > 1e-17:
        term *= (j + 1.0 - a) * t / (j + 1.0)
        j += 1.0
        total += term / j
    return total


def constant_near_1(a: float) -> float:
    """Return the constant of q^a phi(a, q) = -log(1 - q) + constant - series_near_1(a, 1 - q), from q =
    1/2.
    """
    constant: float = 0.5**a * phi(a, 0.5) - math.log(2.0) + series_near_1(a, 0.5)
    return constant


def outward_curve(p: Numbers, u: float) -> tuple[float, float, float]:
    """Return y, dy/du and w of dy/du = 1 - y^n at `u`."""
    n, c_u, c_w = p[N], p[C_U], p[C_W]
    half = 0.5 ** (1.0 / n)
    # y^n = 1/2 and above: tau = -log(1 - y^n) = n u - c_u + series_near_1, by Newton's iteration
    if n * u >= math.log(2.0) + c_u - series_near_1(1.0 / n, 0.5):
        tau = max(n * u - c_u, math.log(2.0))
        if tau < SATURATED:
            for _ in range(50):
                t = math.exp(-tau)
                step = (n * u - c_u + series_near_1(1.0 / n, t) - tau) * (1.0 - t) ** (1.0 - 1.0 / n)
                tau += step
                if abs(step) < 1e-8:
                    break
        t = math.exp(-tau)
        return (1.0 - t) ** (1.0 / n), t, (tau + c_w - series_near_1(2.0 / n, t)) / n
    y = min(u, half)
    for _ in range(50):
        slope = 1.0 - y**n
        error = u - y * phi(1.0 / n, y**n) / n
        y += error * slope * (1.0 - 0.5 * error * n * y ** (n - 1.0))
        if abs(error) < 1e-6 * u:  # third-order convergence: the next step is rounding
            break
    return y, 1.0 - y**n, y * y * phi(2.0 / n, y**n) / n


def inward_curve(p: Numbers, u: float) -> tuple[float, float, float]:
    """Return y, dy/du and w of dy/du = 1 + (2 beta - 1) y^n at `u`; beyond y = 1, which no motion reaches,
    y is a straight line.
    """
    n, scale = p[N], p[SCALE]
    if scale == 0.0:
        return u, 1.0, 0.5 * u * u
    u1, w1 = inverse_inward_curve(p, 1.0)
    if u >= u1:
        slope = 1.0 + scale**n
        return 1.0 + slope * (u - u1), slope, w1 + (u - u1) * (1.0 + 0.5 * slope * (u - u1))
    x = scale * u
    y = x
    for _ in range(50):
        slope = 1.0 + y**n
        error = x - y * phi(1.0 / n, -(y**n)) / n
        y += error * slope * (1.0 + 0.5 * error * n * y ** (n - 1.0))
        if abs(error) < 1e-6 * x:
            break
    return y / scale, 1.0 + y**n, y * y * phi(2.0 / n, -(y**n)) / (n * scale * scale)


def inverse_outward_curve(p: Numbers, y: float) -> tuple[float, float]:
    """Return u and w at `y`, outwards."""
    n, c_u, c_w = p[N], p[C_U], p[C_W]
    q = y**n
    if q <= 0.5:
        return y * phi(1.0 / n, q) / n, y * y * phi(2.0 / n, q) / n
    t = max(1.0 - q, math.exp(-SATURATED))
    u, w = c_u - math.log(t) - series_near_1(1.0 / n, t), c_w - math.log(t) - series_near_1(2.0 / n, t)
    return u / n, w / n


def inverse_inward_curve(p: Numbers, y: float) -> tuple[float, float]:
    """Return u and w at `y`, inwards."""
    n, scale = p[N], p[SCALE]
    if scale == 0.0:
        return y, 0.5 * y * y
    q = (scale * y) ** n
    return y * phi(1.0 / n, -q) / n, y * y * phi(2.0 / n, -q) / n


# ---------------------------------------------------------------------- the rule


def yield_deformation(p: Numbers, s: float) -> float:
    """Yield deformation of a side."""
    return (p[FY] if s > 0.0 else -p[FY_MINUS]) / p[K]


def motion_at(p: Numbers, s: float, x: float) -> tuple[float, float, float]:
    """Return s z, dz/dd and the integral of z dd from z = 0, at position `x` of a motion in
    direction `s`.
    """
    if x >= 0.0:
        dy = yield_deformation(p, s)
        y, slope, w = outward_curve(p, x / dy)
        return dy * y, slope, dy * dy * w
    dy = yield_deformation(p, -s)
    y, slope, w = inward_curve(p, -x / dy)
    return -dy * y, slope, dy * dy * w


def position(p: Numbers, s: float, z: float) -> tuple[float, float]:
    """Return the position at the (mirrored) `z` of a motion in direction `s`, and the integral of z dd."""
    if z >= 0.0:
        dy = yield_deformation(p, s)
        u, w = inverse_outward_curve(p, z / dy)
        return dy * u, dy * dy * w
    dy = yield_deformation(p, -s)
    u, w = inverse_inward_curve(p, -z / dy)
    return -dy * u, dy * dy * w


def curve(
    p: Numbers, at: int, m: Numbers, d0: float, d: float, v: float
) -> tuple[float, float, float, float]:
    """Evaluate the force from the position along the present direction."""
    k, r = p[K], p[R]
    s = 1.0 if at == LOADING else -1.0
    z, slope, integral = motion_at(p, s, m[POSITION] + s * (d - m[REVERSAL]))
    work = k * (0.5 * r * (d - d0) * (d + d0) + (1.0 - r) * (integral - m[INTEGRAL]))
    return k * (r * d + (1.0 - r) * s * z), k * (r + (1.0 - r) * slope), 0.0, work


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a reversal."""
    s = 1.0 if at == LOADING else -1.0
    z, _, _ = motion_at(p, s, m[POSITION] + s * (d - m[REVERSAL]))
    x, integral = position(p, -s, -z)
    return (UNLOADING if at == LOADING else LOADING), (x, d, integral)


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy recovered down to zero force, which Newton's iteration finds."""
    k, r = p[K], p[R]
    if f == 0.0:
        return 0.0
    s = -1.0 if f > 0.0 else 1.0
    x0, integral_0 = position(p, s, s * (f / k - r * d) / (1.0 - r))
    x, integral = x0, integral_0
    for _ in range(50):
        z, slope, integral = motion_at(p, s, x)
        step = -(r * (s * d + x - x0) + (1.0 - r) * z) / (r + (1.0 - r) * slope)
        x += step
        if abs(step) < 1e-10 * abs(d):  # one-sided, because the force is concave: the next step is rounding
            break
    z, slope, integral = motion_at(p, s, x)
    end = d + s * (x - x0)
    return k * (0.5 * r * (d - end) * (d + end) + (1.0 - r) * (integral_0 - integral))


def smooth_curve(p: Numbers, at: int, m: Numbers, d: float, f: float) -> SmoothNumbers:
    """Return the differential equation of z, see `Rule`."""
    k, r, n, beta = p[K], p[R], p[N], p[BETA]
    s = 1.0 if at == LOADING else -1.0
    z = (f / k - r * d) / (1.0 - r)
    if s * z > -PAST * yield_deformation(p, -s):
        return z, s * yield_deformation(p, s), n, -1.0, 0.0, r * k, (1.0 - r) * k
    return z, -s * yield_deformation(p, -s), n, 2.0 * beta - 1.0, 0.0, r * k, (1.0 - r) * k


RULE = Rule(
    BranchKind.ELASTIC.named("loading", "unloading"),
    start,
    branch,
    transition,
    recoverable,
    curve,
    rate_independent,
    smooth_curve=smooth_curve,
    parameters=9,
    variables=3,
)


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two yield forces."""
    need_both_sides(fy_plus, fy_minus)
    n, beta = values["N"], values["BETA"]
    p = (k, fy_plus, fy_minus, values["R"], n, beta, constant_near_1(1.0 / n), constant_near_1(2.0 / n))
    return Law(RULE, (*p, (2.0 * beta - 1.0) ** (1.0 / n)))


SPEC = Spec(
    "hysteresis",
    "BOUC_WEN",
    "smooth, from a differential equation",
    (
        R_FIELD,
        Field("N", Kind.REAL, "-", lo=1.0, hi=100.0, doc="exponent; the larger, the sharper the knee"),
        Field(
            "BETA",
            Kind.REAL,
            "-",
            default=0.5,
            lo=0.5,
            hi=1.0,
            doc="ratio beta / (beta + gamma); 0.5: unloading is a straight line",
        ),
    ),
    reference="Bouc 1967; Wen 1976",
    sample="R=0.05 N=2",
    impl=build,
)
