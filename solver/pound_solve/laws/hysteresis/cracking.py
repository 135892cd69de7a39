r"""The backbone with a crack point that SCHOETTLER_RESTREPO and TAKEDA_SLIP share.

The formulas are for one side (`mirror`), with the yield force :math:`F_y > 0` and the initial stiffness
:math:`k`.  The backbone rises with :math:`k` to the crack point at the force :math:`F_{cr} F_y`, continues
straight to the yield point at :math:`d_y = F_y / (\rho k)`, and has the slope :math:`r \rho k` beyond it.

The first internal variables of each rule are the largest deformations of both sides, initially those of the
crack points.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from pound_deck.schema import Field, Kind
from pound_solve.laws.automaton import FY, FY_MINUS, K, Numbers, above, below, linear, passes
from pound_solve.laws.hysteresis.backbone import R_FIELD as RATIO_TO_INITIAL
from pound_solve.laws.hysteresis.backbone import R
from pound_solve.laws.mirror import need_both_sides, on_side, outward, side, turns_inward

# branches of the positive side; add one for the negative side
ELASTIC, CRACKED, YIELDING = 0, 1, 3

# parameters of a law after K, FY, FY_MINUS, R, ALPHA: ratios of both sides, of the crack force to the yield
# force, and of the secant stiffness at the yield point to K
FCR, FCR_MINUS, RHO, RHO_MINUS = range(5, 9)
PARAMETERS = 9  #: number of these parameters; a rule's own parameters follow
MOST, MOST_MINUS = 0, 1  #: internal variables: largest deformations of both sides, mirrored

Point = tuple[float, float]  #: deformation and force, mirrored

R_FIELD = replace(
    RATIO_TO_INITIAL, doc="ratio of post-yield stiffness to secant stiffness at the yield point"
)
FCR_FIELD = Field(
    "FCR",
    Kind.REAL,
    "-",
    default=(0.5,),
    above=0.0,
    below=1.0,
    count=(1, 2),
    doc="ratio of cracking force to yield force, positive and negative side; one value: both",
)
RHO_FIELD = Field(
    "RHO",
    Kind.REAL,
    "-",
    default=(0.5,),
    above=0.0,
    below=1.0,
    count=(1, 2),
    doc="secant stiffness at the yield point / initial stiffness",
)


def parameters(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Numbers:
    """Return the first parameters of all rules on this backbone: k, both yield forces, r, alpha, then the
    ratios of the crack forces and of the secant stiffnesses, each for both sides.

    Raises
    ------
    ValueError
        A side has no yield force.
    """
    need_both_sides(fy_plus, fy_minus)
    fcr, rho = values["FCR"], values["RHO"]
    return k, fy_plus, fy_minus, values["R"], values["ALFA"], fcr[0], fcr[-1], rho[0], rho[-1]


def crack_point(p: Numbers, s: float) -> Point:
    """Return the crack point of a side."""
    fc = p[FCR] * p[FY] if s > 0.0 else p[FCR_MINUS] * -p[FY_MINUS]
    return fc / p[K], fc


def yield_point(p: Numbers, s: float) -> Point:
    """Yield point of a side."""
    fy, rho = (p[FY], p[RHO]) if s > 0.0 else (-p[FY_MINUS], p[RHO_MINUS])
    return fy / (rho * p[K]), fy


def first_yield(p: Numbers) -> tuple[float, float]:
    """Return the deformations at the yield points."""
    return yield_point(p, 1.0)[0], -yield_point(p, -1.0)[0]


def backbone(p: Numbers, s: float, x: float) -> tuple[float, float]:
    """Return the slope and force of the backbone at a deformation beyond the crack."""
    (xc, fc), (xy, fy) = crack_point(p, s), yield_point(p, s)
    if x >= xy:
        slope = p[R] * fy / xy
        return slope, fy + slope * (x - xy)
    slope = (fy - fc) / (xy - xc)
    return slope, fc + slope * (x - xc)


def largest_deformation(m: Numbers, s: float) -> float:
    """Return the largest deformation of a side so far."""
    return m[MOST] if s > 0.0 else m[MOST_MINUS]


def deformations_with(m: Numbers, s: float, x: float) -> tuple[float, float]:
    """Return the largest deformations after side `s` has reached `x`."""
    return (max(m[MOST], x), m[MOST_MINUS]) if s > 0.0 else (m[MOST], max(m[MOST_MINUS], x))


def has_yielded(p: Numbers, s: float, m: Numbers) -> bool:
    """Return whether a side has gone beyond its yield point."""
    xy, _ = yield_point(p, s)
    return passes(largest_deformation(m, s), xy, xy)


def peak(p: Numbers, s: float, m: Numbers) -> Point:
    """Return the largest deformation of a side and the force there."""
    x = largest_deformation(m, s)
    return x, backbone(p, s, x)[1]


def backbone_branch(p: Numbers, at: int) -> Numbers:
    """Return the branch: elastic up to a crack point (event 0: positive side), or along the backbone until
    the motion reverses (event 0) or the side yields (event 1).
    """
    if at == ELASTIC:
        return linear(p[K], 0.0, above(crack_point(p, 1.0)[0]), below(-crack_point(p, -1.0)[0]))
    s = side(at)
    xc, xy = crack_point(p, s)[0], yield_point(p, s)[0]
    if at < YIELDING:
        slope, f = backbone(p, s, xc)
        return linear(slope, s * (f - slope * xc), turns_inward(s), outward(s, xy))
    slope, f = backbone(p, s, xy)
    return linear(slope, s * (f - slope * xy), turns_inward(s))


def enter_backbone(p: Numbers, m: Numbers, s: float, x: float) -> tuple[int, Numbers]:
    """Return the state on the backbone of a side."""
    return on_side(YIELDING if x >= yield_point(p, s)[0] else CRACKED, s), m
