r"""The backbone with a crack point that SCHOETTLER_RESTREPO, SINA and TAKEDA_SLIP share.

The formulas are for one side (`mirror`), with the yield force :math:`F_y > 0` and the initial stiffness
:math:`k`.  The backbone rises with :math:`k` to the crack point at the force :math:`F_{cr} F_y`, continues
straight to the yield point at :math:`d_y = F_y / (\rho k)`, and has the slope :math:`r \rho k` beyond it.
With a strength loss it is there

.. math:: F(x) = F_y \left[(1 - r)\,\varphi(x) + r x\right], \qquad x = d / d_y

with the factor :math:`\varphi` of `backbone`.

The first internal variables of each rule are the largest deformations of both sides, initially those of the
crack points.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from pound_deck.schema import Field, Kind
from pound_solve.laws.automaton import FY, FY_MINUS, BranchKind, K, Numbers, above, below, linear, passes
from pound_solve.laws.hysteresis import backbone as bilinear_backbone
from pound_solve.laws.hysteresis.backbone import ALFA_FIELD, LINES, LOSS_OF_SIDE, line_at, line_of_side
from pound_solve.laws.mirror import both_sides, on_side, outward, side, turns_inward

# branches of the positive side; add one for the negative side.  Four lines follow the yield point: up to
# the ductilities D1, D2 and D3, and beyond them
ELASTIC, CRACKED, YIELDING, UNLOADING = 0, 1, 3, 11
BRANCHES = (
    *BranchKind.ELASTIC.named("elastic"),
    *BranchKind.ELASTIC.named(*both_sides("cracked")),
    *BranchKind.YIELDING.named(*both_sides(*LINES)),
)

# parameters of a law after those of `backbone`: ratios of both sides, of the crack force to the yield
# force, and of the secant stiffness at the yield point to K
FCR, FCR_MINUS, RHO, RHO_MINUS = range(bilinear_backbone.PARAMETERS, bilinear_backbone.PARAMETERS + 4)
PARAMETERS = bilinear_backbone.PARAMETERS + 4  #: number of these parameters; a rule's own parameters follow
MOST, MOST_MINUS = 0, 1  #: internal variables: largest deformations of both sides, mirrored

Point = tuple[float, float]  #: deformation and force, mirrored

R_FIELD = replace(
    bilinear_backbone.R_FIELD, doc="ratio of post-yield stiffness to secant stiffness at the yield point"
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
FIELDS = (R_FIELD, ALFA_FIELD, FCR_FIELD, RHO_FIELD, *LOSS_OF_SIDE)


def parameters(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Numbers:
    """Return the first parameters of all rules on this backbone: those of `backbone`, then the ratios of
    the crack forces and of the secant stiffnesses, each for both sides.

    Raises
    ------
    ValueError
        A side has no yield force, or the strength loss is incomplete.
    """
    fcr, rho = values["FCR"], values["RHO"]
    first = bilinear_backbone.parameters(values, k, fy_plus, fy_minus)
    return (*first, fcr[0], fcr[-1], rho[0], rho[-1])


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
        slope, f0, _ = line_of_side(p, line_at(p, x, xy), fy, fy / xy)
        return slope, f0 + slope * x
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
    the motion reverses (event 0) or the line ends (event 1).
    """
    if at == ELASTIC:
        return linear(p[K], 0.0, above(crack_point(p, 1.0)[0]), below(-crack_point(p, -1.0)[0]))
    s = side(at)
    xy, fy = yield_point(p, s)
    if at < YIELDING:
        xc, _ = crack_point(p, s)
        slope, f = backbone(p, s, xc)
        return linear(slope, s * (f - slope * xc), turns_inward(s), outward(s, xy))
    slope, f0, end = line_of_side(p, (at - YIELDING) // 2, fy, fy / xy)
    if end == 0.0:
        return linear(slope, s * f0, turns_inward(s))
    return linear(slope, s * f0, turns_inward(s), outward(s, end))


def next_branch(p: Numbers, at: int, m: Numbers) -> tuple[int, Numbers]:
    """Return the state after the end of a line of the backbone."""
    s = side(at)
    return enter_backbone(p, m, s, yield_point(p, s)[0]) if at < YIELDING else (at + 2, m)


def enter_backbone(p: Numbers, m: Numbers, s: float, x: float) -> tuple[int, Numbers]:
    """Return the state on the backbone of a side at a deformation beyond the crack."""
    xy, _ = yield_point(p, s)
    return on_side(CRACKED if x < xy else YIELDING + 2 * line_at(p, x, xy), s), m
