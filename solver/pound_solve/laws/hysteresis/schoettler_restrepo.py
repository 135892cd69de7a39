r"""Schoettler-Restrepo: a pinched rule for concrete with a cracking point (Ruaumoko's rule 52).

The formulas are for one side (`mirror`), on the backbone of `cracking`.

* A side with the largest deformation so far :math:`d_m` (initially the crack point) and the force
  :math:`F_m` there unloads with :math:`k_u = \rho k (d_m/d_y)^{-\alpha}`.  This stiffness is at most
  :math:`k`, and at least the secant :math:`F_m/d_m` (our choice).
* From zero force at :math:`d_0` the other side is loaded to the pinch point

  .. math:: d_P = \tfrac12 (d_m' - d_y'), \qquad F_P = \pi F_m

  (:math:`d_m', d_y'` are those of the side just left; :math:`d_P` is not negative) and from there to
  :math:`(d_m, F_m)`, where the backbone continues.  It is loaded straight to :math:`(d_m, F_m)` if the
  pinch point lies behind :math:`d_0`, or not below that line.
* A reversal before the pinch point (:math:`d < d_P`; :math:`F < \pi F_m` until both sides have yielded)
  begins an inner loop: then either side is loaded to its *corner*, which is its last reversal, and
  continues from there.  A reversal before the corner changes nothing.  A reversal beyond the corner becomes
  the new corner; if it is also beyond the pinch point, it ends the inner loop.
* A motion that reverses while it unloads returns along the same line.

The branches were inferred from the forces that the old program gives for one record, with ductilities up to
2.05 (:math:`r = 0.06, F_{cr} = \rho = 0.99, \alpha = 0.4, \pi = 0.3`); the factor 1/2 of :math:`d_P` may
stand for a parameter that was not varied.  The behaviour beyond the ductility DULT is unknown: the backbone
continues, and the report gives a warning.

Internal variables: the largest deformation of each side; whether an inner loop is active; the corner of
each side; the point where the present line began; the last reversal, and the branch on which it occurred.

References
----------
Schoettler MJ, Restrepo JI: the model, as Ruaumoko's rule 52; Carr AJ, Ruaumoko (no equations are published
in its openly readable parts).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import BranchKind, K, Law, Numbers, Rule, linear
from pound_solve.laws.hysteresis.backbone import ALPHA
from pound_solve.laws.hysteresis.cracking import (
    BRANCHES,
    ELASTIC,
    FIELDS,
    PARAMETERS,
    UNLOADING,
    Point,
    backbone,
    backbone_branch,
    crack_point,
    deformations_with,
    enter_backbone,
    first_yield,
    has_yielded,
    largest_deformation,
    next_branch,
    parameters,
    peak,
    yield_point,
)
from pound_solve.laws.mirror import both_sides, inward, on_side, outward, side, turns_inward

# branches of the positive side, after those of the backbone; add one for the negative side
TO_CORNER, TO_PINCH, TO_PEAK = 13, 15, 17
PINCH = PARAMETERS  #: parameter of a law, after those of the backbone
# internal variables after the largest deformations: whether an inner loop is on; as mirrored points the
# corners of both sides, where the present line began, and the last reversal; the branch that this left
INNER, X_CORNER, F_CORNER, X_CORNER_MINUS, F_CORNER_MINUS = range(2, 7)
X_ORIGIN, F_ORIGIN, X_REVERSAL, F_REVERSAL, LEFT = range(7, 12)
NO_POINTS = (0.0,) * 10  #: initial values of these


def unloading(p: Numbers, s: float, x: float) -> float:
    """Return the unloading stiffness after a largest deformation `x`."""
    xy, fy = yield_point(p, s)
    if x <= crack_point(p, s)[0]:
        return p[K]
    soft = fy / xy * (x / xy) ** -p[ALPHA]
    stiffness: float = max(min(p[K], soft), backbone(p, s, x)[1] / x)
    return stiffness


def unloading_of_side(p: Numbers, s: float, m: Numbers) -> float:
    """Return the unloading stiffness after the largest deformation of a side so far."""
    return unloading(p, s, largest_deformation(m, s))


def pinch(p: Numbers, s: float, m: Numbers) -> Point:
    """Return the pinch point of a side."""
    return max(0.5 * (largest_deformation(m, -s) - yield_point(p, -s)[0]), 0.0), p[PINCH] * peak(p, s, m)[1]


def corner(s: float, m: Numbers) -> Point:
    """Return the corner of an inner loop on a side or, without a loop, the last reversal; (0, 0)
    if none.
    """
    return (m[X_CORNER], m[F_CORNER]) if s > 0.0 else (m[X_CORNER_MINUS], m[F_CORNER_MINUS])


def before_pinch(p: Numbers, s: float, m: Numbers, x: float, f: float) -> bool:
    """Return whether a point lies before the pinch point."""
    xp, fp = pinch(p, s, m)
    if has_yielded(p, 1.0, m) and has_yielded(p, -1.0, m):
        return x < xp
    return f < fp


def passes_pinch(p: Numbers, s: float, m: Numbers, x: float, f: float) -> bool:
    """Return whether the path from a point to the peak passes through the pinch point."""
    (xp, fp), (xt, ft) = pinch(p, s, m), peak(p, s, m)
    flatter = (fp - f) * (xt - x) < (ft - f) * (xp - x)
    return x < xp < xt and f <= fp < ft and flatter and ft - fp <= unloading_of_side(p, s, m) * (xt - xp)


def loading_branch(p: Numbers, s: float, m: Numbers, x: float, f: float) -> int:
    """Return the loading line that a side follows from a point: to the pinch point or to the peak."""
    return on_side(TO_PINCH if passes_pinch(p, s, m, x, f) else TO_PEAK, s)


def loading_end(p: Numbers, m: Numbers, at: int) -> Point:
    """Return the point at which a loading line ends."""
    s = side(at)
    if at < TO_PINCH:
        return corner(s, m)
    return pinch(p, s, m) if at < TO_PEAK else peak(p, s, m)


def with_origin(m: Numbers, x: float, f: float) -> Numbers:
    """Return the internal variables with the mirrored point at which a line begins."""
    return (*m[:X_ORIGIN], x, f, *m[X_REVERSAL:])


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the virgin state: the crack points are the peaks."""
    return ELASTIC, (crack_point(p, 1.0)[0], crack_point(p, -1.0)[0], *NO_POINTS)


def loading_line(p: Numbers, at: int, m: Numbers) -> tuple[float, float]:
    """Return the slope of a loading line and its force at zero deformation, mirrored."""
    x0, f0 = m[X_ORIGIN], m[F_ORIGIN]
    x1, f1 = loading_end(p, m, at)
    slope = (f1 - f0) / (x1 - x0) if x1 > x0 else 0.0
    return slope, f1 - slope * x1


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch: elastic, along the backbone, unloading, or on a loading line."""
    if at < UNLOADING:
        return backbone_branch(p, at)
    s = side(at)
    if at < TO_CORNER:
        x, f, k = m[X_REVERSAL], m[F_REVERSAL], unloading_of_side(p, s, m)
        return linear(k, s * (f - k * x), outward(s, x), inward(s, x - f / k))
    slope, f = loading_line(p, at, m)
    return linear(slope, s * f, turns_inward(s), outward(s, loading_end(p, m, at)[0]))


def begin_loading(p: Numbers, m: Numbers, s: float, x: float) -> tuple[int, Numbers]:
    """Return the state at zero force, where the loading of a side begins."""
    m = with_origin(m, x, 0.0)
    xc, fc = corner(s, m)
    if m[INNER] != 0.0 and x < xc and 0.0 < fc <= unloading_of_side(p, s, m) * (xc - x):
        return on_side(TO_CORNER, s), m
    return loading_branch(p, s, m, x, 0.0), m


def reversed_at(p: Numbers, at: int, m: Numbers, x: float, f: float) -> Numbers:
    """Return the internal variables after a reversal: largest deformation, inner loop, corner, the
    point.
    """
    s = side(at)
    plus, minus, inner = m[:X_CORNER]
    if at < UNLOADING:
        plus, minus = deformations_with(m, s, x)
    x_corner, f_corner = corner(s, m)
    if at < TO_CORNER or at >= TO_PINCH:
        x_corner, f_corner = x, f
        inner = 1.0 if at >= UNLOADING and before_pinch(p, s, m, x, f) else 0.0
    origin, reversal = m[X_ORIGIN:X_REVERSAL], (x, f, float(at))
    if s > 0.0:
        return (plus, minus, inner, x_corner, f_corner, *m[X_CORNER_MINUS:X_ORIGIN], *origin, *reversal)
    return (plus, minus, inner, *m[X_CORNER:X_CORNER_MINUS], x_corner, f_corner, *origin, *reversal)


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a crack, a yield, a reversal, a return, zero force or the end of a line."""
    if at == ELASTIC:
        s = 1.0 if event == 0 else -1.0
        return enter_backbone(p, m, s, crack_point(p, s)[0])
    s = side(at)
    if UNLOADING <= at < TO_CORNER:
        if event == 0:
            return int(m[LEFT]), m
        return begin_loading(p, m, -s, -(m[X_REVERSAL] - m[F_REVERSAL] / unloading_of_side(p, s, m)))
    k, _, f0 = branch(p, at, m)[:3]
    if event == 0:
        return on_side(UNLOADING, s), reversed_at(p, at, m, s * d, s * (k * d + f0))
    if at < UNLOADING:
        return next_branch(p, at, m)
    x, f = loading_end(p, m, at)
    if x >= peak(p, s, m)[0]:
        return enter_backbone(p, m, s, x)
    return loading_branch(p, s, m, x, f) if at < TO_PINCH else on_side(TO_PEAK, s), with_origin(m, x, f)


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy recovered along the unloading line."""
    if at == ELASTIC:
        return 0.5 * f * f / p[K]
    s = side(at)
    x = largest_deformation(m, s)
    if at < UNLOADING:
        x = max(x, s * d)
    return 0.5 * f * f / unloading(p, s, x)


RULE = Rule(
    (
        *BRANCHES,
        *BranchKind.ELASTIC.named(
            *both_sides(
                "unloading",
                "reloading to the corner",
                "reloading to the pinch point",
                "reloading to the peak",
            )
        ),
    ),
    start,
    branch,
    transition,
    recoverable,
    first_yield=first_yield,
    parameters=PARAMETERS + 1,
    variables=12,
)


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two yield forces."""
    return Law(RULE, (*parameters(values, k, fy_plus, fy_minus), values["PINCH"]))


SPEC = Spec(
    "hysteresis",
    "SCHOETTLER_RESTREPO",
    "pinched, with cracking: reinforced concrete",
    (
        *FIELDS,
        Field(
            "PINCH",
            Kind.REAL,
            "-",
            default=1.0,
            above=0.0,
            hi=1.0,
            doc="ratio of pinching force to force at the largest deformation; 1: no pinching",
        ),
        Field(
            "DULT",
            Kind.REAL,
            "-",
            default=None,
            above=1.0,
            count=(1, 2),
            doc="ductility up to which the rule is known; the report warns beyond; omitted: none",
        ),
    ),
    code=52,
    reference="Ruaumoko rule 52, as its results show it",
    sample="R=0.06 FCR=0.6 RHO=0.5 ALFA=0.4 PINCH=0.3",
    impl=build,
)
