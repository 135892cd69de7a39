r"""Menegotto-Pinto: reinforcing and structural steel with a round knee, Bauschinger effect and hardening.

Each half cycle leaves the reversal :math:`(d_r, f_r)` along the elastic line and approaches the yield line
of its side; the two lines meet at :math:`(d_0, f_0)`:

.. math:: \frac{f - f_r}{f_0 - f_r} = b\,\xi + \frac{(1 - b)\,\xi}{(1 + \xi^n)^{1/n}}, \qquad
          \xi = \frac{d - d_r}{d_0 - d_r}, \qquad
          n = R_0 \left(1 - \frac{c_1 \eta}{c_2 + \eta}\right)

where :math:`\eta` is the distance from :math:`d_0` to the largest deformation of that side so far
(initially the yield deformation), divided by the yield deformation.  The yield line of a side is
:math:`f = b k d + (1 - b) F_y s`.  Isotropic hardening moves it outwards by

.. math:: s = 1 + a \left(\frac{d_{max} - d_{min}}{2 a' d_y}\right)^{0.8}

with :math:`(a, a') = (a_1, a_2)` for negative and :math:`(a_3, a_4)` for positive motion, and the largest
deformations of both sides so far.  The virgin curve has :math:`s = 1, n = R_0`.  A half cycle that begins
within another one does not return to the curve of that one.  After a small unloading the force may
therefore be larger than without it, which is a known property of this model.

Internal variables: the reversal, the point where both lines meet, :math:`n`, and the largest deformations
of both sides.

References
----------
Menegotto M, Pinto PE (1973), Method of analysis for cyclically loaded R.C. plane frames, IABSE Symposium,
Lisbon (the curve and its exponent); Filippou FC, Popov EP, Bertero VV (1983), Effects of bond deterioration
on hysteretic behavior of reinforced concrete joints, EERC 83-19, Berkeley (isotropic hardening), in the
form of Steel02 of OpenSees.  Our extension: unequal yield forces, each with a separate yield deformation.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import (
    FY,
    FY_MINUS,
    REVERSAL_DOWN,
    REVERSAL_UP,
    BranchKind,
    K,
    Law,
    Numbers,
    Rule,
    linear,
    rate_independent,
)
from pound_solve.laws.hysteresis.backbone import R_FIELD
from pound_solve.laws.mirror import need_both_sides
from pound_solve.laws.refusal import ItemError

LOADING, UNLOADING = 0, 1
LEAST_R = 1.2  #: smallest exponent: at 1 the integral of the curve has a different form
# parameters of a law after K, FY, FY_MINUS, by their symbols
B, R0, C1, C2, A1, A2, A3, A4 = range(3, 11)
# internal variables: reversal, meeting point, exponent n, largest and smallest deformation
D_R, F_R, D_0, F_0, EXPONENT, HIGH, LOW = range(7)


def knee(n: float, x: float) -> tuple[float, float]:
    """Return the value and slope of x (1 + x^n)^(-1/n) or, if `x` is not positive, of x itself."""
    if x <= 0.0:
        return x, 1.0
    if x <= 1.0:
        slope = (1.0 + x**n) ** (-1.0 / n)
        return x * slope, slope / (1.0 + x**n)
    small = x**-n
    value = (1.0 + small) ** (-1.0 / n)
    return value, value * small / (x * (1.0 + small))


def pochhammer_sum(a: float, c: float, t: float) -> float:
    """Return the sum of (a)_j / (c)_j t^j with Pochhammer symbols, for t up to 1/2."""
    j, term, total = 0.0, 1.0, 1.0
    while abs(term) > 1e-17:
        term *= (a + j) / (c + j) * t
        total += term
        j += 1.0
    return total


def area_beyond_1(n: float, x: float) -> float:
    """Return an antiderivative of the knee for x of 1 and above."""
    small = x**-n
    inverse: float = (1.0 + small) ** (-1.0 / n)
    return x * inverse * pochhammer_sum(1.0 / n, 1.0 - 1.0 / n, small / (1.0 + small))


def area(n: float, x: float) -> float:
    """Return the integral of the knee from 0 to `x`, by hypergeometric series after Pfaff's
    transformation.
    """
    if x <= 0.0:
        return 0.5 * x * x
    up_to_1 = min(x, 1.0)
    q = up_to_1**n
    inner: float = (
        0.5
        * up_to_1
        * up_to_1
        * (1.0 + q) ** (-1.0 / n)
        * pochhammer_sum(1.0 / n, 1.0 + 2.0 / n, q / (1.0 + q))
    )
    return inner if x <= 1.0 else inner + area_beyond_1(n, x) - area_beyond_1(n, 1.0)


def half_cycle(p: Numbers, s: float, high: float, low: float, d: float, f: float) -> Numbers:
    """Return the internal variables of a motion in direction `s` from a reversal at (d, f)."""
    k, b, r0, c1, c2 = p[K], p[B], p[R0], p[C1], p[C2]
    fy, peak = (p[FY], high) if s > 0.0 else (-p[FY_MINUS], -low)
    a, a_per = (p[A3], p[A4]) if s > 0.0 else (p[A1], p[A2])
    dy = fy / k
    shift = 1.0
    if d != 0.0 or f != 0.0:
        shift += a * ((high - low) / (2.0 * a_per * dy)) ** 0.8
    d_0 = s * ((1.0 - b) * fy * shift - s * (f - k * d)) / ((1.0 - b) * k)
    eta = abs(s * peak - d_0) / dy
    return (d, f, d_0, f + k * (d_0 - d), r0 * (1.0 - c1 * eta / (c2 + eta)), high, low)


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state."""
    return LOADING, half_cycle(p, 1.0, p[FY] / p[K], p[FY_MINUS] / p[K], 0.0, 0.0)


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: loading until the motion reverses, or unloading until it reverses again."""
    return linear(p[K], 0.0, REVERSAL_DOWN if at == LOADING else REVERSAL_UP)


def curve(
    p: Numbers, at: int, m: Numbers, d0: float, d: float, v: float
) -> tuple[float, float, float, float]:
    """Evaluate the force on the present half cycle."""
    k, b, n = p[K], p[B], m[EXPONENT]
    d_r, f_r = m[D_R], m[F_R]
    span = m[D_0] - d_r
    x, x0 = (d - d_r) / span, (d0 - d_r) / span
    y, slope = knee(n, x)
    force = f_r + k * span * (b * x + (1.0 - b) * y)
    integral = 0.5 * b * (x - x0) * (x + x0) + (1.0 - b) * (area(n, x) - area(n, x0))
    work = span * (f_r * (x - x0) + k * span * integral)
    return force, k * (b + (1.0 - b) * slope), 0.0, work


def reversed_at(p: Numbers, at: int, m: Numbers, d: float, f: float) -> Numbers:
    """Return the internal variables after a reversal."""
    s = -1.0 if at == LOADING else 1.0
    return half_cycle(p, s, max(m[HIGH], d), min(m[LOW], d), d, f)


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a reversal."""
    f = curve(p, at, m, d, d, 0.0)[0]
    return (UNLOADING if at == LOADING else LOADING), reversed_at(p, at, m, d, f)


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy recovered down to zero force, which Newton's iteration locates."""
    if f == 0.0:
        return 0.0
    if (f > 0.0) == (at == LOADING):
        m = reversed_at(p, at, m, d, f)
    d_end = d
    for _ in range(100):
        f_end, slope, _, _ = curve(p, at, m, d, d_end, 0.0)
        d_end -= f_end / slope
        if abs(f_end) < 1e-14 * abs(f):
            break
    return -curve(p, at, m, d, d_end, 0.0)[3]


RULE = Rule(
    BranchKind.ELASTIC.named("loading", "unloading"),
    start,
    branch,
    transition,
    recoverable,
    curve,
    rate_independent,
    parameters=11,
    variables=7,
)


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two yield forces.

    Raises
    ------
    ValueError
        A side has no yield force, R is outside its limits, or the knee becomes too round.
    """
    need_both_sides(fy_plus, fy_minus)
    sharp, c1 = values["R0"], values["CR1"]
    if not 0.0 <= values["R"] < 1.0:
        raise ItemError("R of this rule lies from 0 to below 1", "R")
    if sharp * (1.0 - c1) < LEAST_R:
        raise ItemError(f"R0 (1 - CR1), the roundest knee, must not be below {LEAST_R:g}", "R0")
    hardening = (values["A1"], values["A2"], values["A3"], values["A4"])
    return Law(RULE, (k, fy_plus, fy_minus, values["R"], sharp, c1, values["CR2"], *hardening))


SPEC = Spec(
    "hysteresis",
    "MENEGOTTO_PINTO",
    "steel: round knee, Bauschinger effect, isotropic hardening",
    (
        R_FIELD,
        Field("R0", Kind.REAL, "-", default=20.0, lo=2.0, hi=100.0, doc="exponent of the virgin curve"),
        Field(
            "CR1",
            Kind.REAL,
            "-",
            default=0.925,
            lo=0.0,
            below=1.0,
            doc="fraction of R0 lost by large plastic excursions",
        ),
        Field(
            "CR2",
            Kind.REAL,
            "-",
            default=0.15,
            above=0.0,
            doc="plastic excursion, in yield deformations, at half that loss",
        ),
        Field("A1", Kind.REAL, "-", default=0.0, lo=0.0, doc="isotropic hardening of the negative side"),
        Field(
            "A2",
            Kind.REAL,
            "-",
            default=1.0,
            above=0.0,
            doc="half range of deformation, in yield deformations, that gives A1",
        ),
        Field("A3", Kind.REAL, "-", default=0.0, lo=0.0, doc="isotropic hardening of the positive side"),
        Field("A4", Kind.REAL, "-", default=1.0, above=0.0, doc="half range that gives A3"),
    ),
    reference="Menegotto & Pinto 1973; Filippou, Popov & Bertero 1983",
    sample="R=0.02 R0=20 CR1=0.925 CR2=0.15",
    impl=build,
)
