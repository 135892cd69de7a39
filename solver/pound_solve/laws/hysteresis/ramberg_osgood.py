r"""Ramberg-Osgood: a smooth power curve with Masing's loops.

With :math:`u = f/F_y`, :math:`x = d/d_y`, :math:`d_y = F_y/k`, :math:`\sigma(u) = u + \alpha u |u|^{n-1}`:

.. math:: x = \sigma(u) \quad\text{(skeleton)}, \qquad
          \frac{x - x_0}{2} = \sigma\Bigl(\frac{u - u_0}{2}\Bigr) \quad\text{(branch from a reversal at 0)}

A branch ends where it meets the curve from which it started.  At the reversal before the last one its loop
closes, and the branch from the reversal before that continues.  A branch that started on the skeleton
returns to it at the mirrored point.  At any amplitude, no force exceeds that of the skeleton or overshoots
a closed loop.

Work along a curve scaled by :math:`c` (1 or 2) from its origin, :math:`w = (u - u_0)/c`:

.. math:: \int f\,dd = c\,F_0 d_y\,\sigma(w)
          + c^2 F_y d_y \Bigl(\frac{w^2}{2} + \frac{\alpha n}{n+1} |w|^{n+1}\Bigr)

Internal variables: the number of open reversals, whether some were dropped, and the deformation and force
of up to seven reversals, the latest first.  At an eighth reversal, the second and third oldest are dropped.
A branch that would have met the curves from these continues to the next outer curves: those of the loop
between the oldest reversal, which was on the skeleton, and its mirror image.

References
----------
Ramberg W, Osgood WR (1943), Description of stress-strain curves by three parameters, NACA TN 902.
Masing G (1926), Eigenspannungen und Verfestigung beim Messing, Proc. 2nd Int. Congr. Appl. Mech., Zurich.
Jennings PC (1964), Periodic response of a general yielding structure, J. Eng. Mech. Div. ASCE 90(EM2):
131-166 (the form with alpha and n).  Ruaumoko's rule 3 is the case alpha = 1.  The treatment of a loop that
does not return to the skeleton is our choice (loops close, as for Ruaumoko's rules 40 and 41).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import (
    FY,
    NEVER,
    BranchKind,
    K,
    Law,
    Numbers,
    Rule,
    SmoothNumbers,
    linear,
    rate_independent,
)
from pound_solve.laws.mirror import need_both_sides, outward, turns_inward

LOADING, UNLOADING = 0, 1
N, ALPHA = 3, 4  #: parameters of a law after K, FY, FY_MINUS
# internal variables: number of open reversals, whether some were dropped; deformation and force of the
# reversals, the latest first
OPEN, DROPPED, D1, F1, D2, F2, D3, F3 = range(8)
DEPTH = 7.0  #: reversals stored
VIRGIN = (0.0,) * 16  #: internal variables without a reversal


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state: on the skeleton."""
    return LOADING, VIRGIN


def sigma(p: Numbers, w: float) -> float:
    """Return the deformation of the curve, sigma(w)."""
    d: float = w + p[ALPHA] * w * abs(w) ** (p[N] - 1.0)
    return d


def energy(p: Numbers, w: float) -> float:
    """Return the integral of w d(sigma)."""
    n = p[N]
    area: float = 0.5 * w * w + p[ALPHA] * n / (n + 1.0) * abs(w) ** (n + 1.0)
    return area


def inverse_sigma(p: Numbers, x: float) -> float:
    """Return the force w of the curve with sigma(w) = x, by Newton's iteration.

    The iteration starts above the root of a convex function and therefore decreases monotonically to it.
    """
    n, alpha = p[N], p[ALPHA]
    size = abs(x)
    if size == 0.0:
        return 0.0
    w: float = min(size, (size / alpha) ** (1.0 / n))
    for _ in range(100):
        step = (w + alpha * w**n - size) / (1.0 + alpha * n * w ** (n - 1.0))
        w -= step
        if abs(step) < 1e-9 * w:  # quadratic convergence: the next step is rounding
            break
    return w if x > 0.0 else -w


def origin(m: Numbers) -> tuple[float, float, float]:
    """Return the scale of the present curve, and the deformation and force of its origin."""
    return (1.0, 0.0, 0.0) if m[OPEN] == 0.0 else (2.0, m[D1], m[F1])


def from_dropped(m: Numbers) -> bool:
    """Return whether the present branch started on a curve whose reversals are no longer stored."""
    return m[DROPPED] != 0.0 and (m[OPEN] == 2.0 or m[OPEN] == 3.0)


def outer_origin(m: Numbers) -> tuple[float, float]:
    """Return the origin of the next curve outside a dropped one: the oldest reversal or its mirror
    image.
    """
    return (-m[D2], -m[F2]) if m[OPEN] == 2.0 else (m[D3], m[F3])


def closing_point(p: Numbers, m: Numbers) -> tuple[float, float]:
    """Return the deformation and force where a branch meets the curve from which it started.

    If that curve is no longer stored, the branch ends at the intersection with the next outer curve.  The
    branch is the steeper of the two, so bisection finds the intersection, between the origin of the branch
    and the mirror image of the other origin.
    """
    if m[OPEN] == 1.0:
        return -m[D1], -m[F1]
    if not from_dropped(m):
        return m[D2], m[F2]
    d0, f0 = outer_origin(m)
    fy = p[FY]
    scale = 0.5 * p[K] / fy
    inner, outer = m[D1], -d0
    s = 1.0 if outer > inner else -1.0
    while True:
        d = 0.5 * (inner + outer)
        f = m[F1] + 2.0 * fy * inverse_sigma(p, (d - m[D1]) * scale)
        if d in (inner, outer):  # adjacent floating-point numbers
            return d, f
        if s * (f - f0 - 2.0 * fy * inverse_sigma(p, (d - d0) * scale)) < 0.0:
            inner = d
        else:
            outer = d


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch; its events are a reversal and the closing of the loop."""
    s = 1.0 if at == LOADING else -1.0
    closes = outward(s, s * closing_point(p, m)[0]) if m[OPEN] > 0.0 else NEVER
    return linear(p[K], 0.0, turns_inward(s), closes)


def curve(
    p: Numbers, at: int, m: Numbers, d0: float, d: float, v: float
) -> tuple[float, float, float, float]:
    """Evaluate the force on the skeleton or on the branch from the latest reversal."""
    k, fy, n, alpha = p[K], p[FY], p[N], p[ALPHA]
    dy = fy / k
    c, d1, f1 = origin(m)
    w, w0 = inverse_sigma(p, (d - d1) / (c * dy)), inverse_sigma(p, (d0 - d1) / (c * dy))
    work = f1 * (d - d0) + c * c * fy * dy * (energy(p, w) - energy(p, w0))
    return f1 + c * fy * w, k / (1.0 + alpha * n * abs(w) ** (n - 1.0)), 0.0, work


def with_reversal(m: Numbers, d: float, f: float) -> Numbers:
    """Store a reversal."""
    if m[OPEN] == DEPTH:  # keep the four latest and the oldest: 6 with the new one
        return (DEPTH - 1.0, 1.0, d, f, *m[D1:10], *m[14:16], 0.0, 0.0)
    return (m[OPEN] + 1.0, m[DROPPED], d, f, *m[D1:14])


def without_closed_loop(m: Numbers) -> Numbers:
    """Return the internal variables without the reversals of the closed loop, or without any reversal if
    the skeleton continues.
    """
    if from_dropped(m):
        d0, f0 = outer_origin(m)
        if m[OPEN] == 2.0:
            return (2.0, 0.0, d0, f0, m[D2], m[F2], *VIRGIN[D3:])
        return (1.0, 0.0, d0, f0, *VIRGIN[D2:])
    if m[OPEN] <= 2.0:
        return VIRGIN
    return (m[OPEN] - 2.0, m[DROPPED], *m[D3:], 0.0, 0.0, 0.0, 0.0)


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a reversal, or on the curve from which the branch started."""
    if event == 1:
        return at, without_closed_loop(m)
    opposite = UNLOADING if at == LOADING else LOADING
    s = 1.0 if at == LOADING else -1.0
    if m[OPEN] == 0.0 and s * d <= 0.0:
        return opposite, m  # a virgin spring that starts to move in the other direction
    return opposite, with_reversal(m, d, curve(p, at, m, d, d, 0.0)[0])


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy recovered along the branches down to zero force."""
    k, fy = p[K], p[FY]
    if f > 0.0 if at == LOADING else f < 0.0:
        m = with_reversal(m, d, f)
    recovered, f_from = 0.0, f
    while f_from * f > 0.0:
        f1, f_to = m[F1], closing_point(p, m)[1]  # a loop closes here, and the curve changes
        if f_to * f < 0.0:
            f_to = 0.0
        a, b = 0.5 * (f_from - f1) / fy, 0.5 * (f_to - f1) / fy
        recovered -= 2.0 * f1 * (sigma(p, b) - sigma(p, a)) + 4.0 * fy * (energy(p, b) - energy(p, a))
        m, f_from = without_closed_loop(m), f_to
    return recovered * fy / k


def smooth_curve(p: Numbers, at: int, m: Numbers, d: float, f: float) -> SmoothNumbers:
    """Return the elastic part of the deformation from the origin of the curve, see `Rule`."""
    k, fy, n, alpha = p[K], p[FY], p[N], p[ALPHA]
    c, _, f1 = origin(m)
    s = 1.0 if at == LOADING else -1.0
    return (f - f1) / k, s * c * fy / k, n - 1.0, 0.0, alpha * n, 0.0, k


RULE = Rule(
    BranchKind.ELASTIC.named("loading", "unloading"),
    start,
    branch,
    transition,
    recoverable,
    curve,
    rate_independent,
    smooth_curve=smooth_curve,
    parameters=5,
    variables=16,
)


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two yield forces."""
    need_both_sides(fy_plus, fy_minus)
    if fy_plus != -fy_minus:
        raise ValueError("Masing's loops need the same yield force on both sides")
    return Law(RULE, (k, fy_plus, fy_minus, values["N"], values["ALPHA"]))


SPEC = Spec(
    "hysteresis",
    "RAMBERG_OSGOOD",
    "smooth power curve with Masing's loops",
    (
        Field("N", Kind.REAL, "-", above=1.0, doc="exponent; the larger, the sharper the knee"),
        Field(
            "ALPHA",
            Kind.REAL,
            "-",
            default=1.0,
            above=0.0,
            doc="ratio of plastic to elastic deformation at the yield force",
        ),
    ),
    code=3,
    reference="Ramberg & Osgood 1943; Masing 1926; Jennings 1964; Ruaumoko rule 3",
    sample="N=7",
    impl=build,
)
