r"""The backbone with a crack point that SCHOETTLER_RESTREPO and TAKEDA_SLIP share.

One side at a time (`mirror`), with the yield force :math:`F_y > 0` and :math:`k` the initial stiffness.
The backbone goes with :math:`k` to the crack point of force :math:`F_{cr} F_y`, on to the yield point at
:math:`d_y = F_y / (\rho k)`, and beyond it with the slope :math:`r \rho k`.

The first internal variables of each rule are the largest deformation of each side, at first those of the
crack points.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from pound_deck.schema import Field, Kind
from pound_solve.laws.automaton import Numbers, above, below, linear, passes
from pound_solve.laws.hysteresis.backbone import R as SHARE_OF_INITIAL
from pound_solve.laws.mirror import need_both_sides, outward, pair, side, turns_inward

# branches of the positive side; those of the negative side are one more
ELASTIC, CRACKED, YIELDING = 0, 1, 3

PARAMETERS = 9  #: numbers of a law that belong to the backbone, with the power of unloading among them

Point = tuple[float, float]  #: deformation and force, mirrored

R = replace(SHARE_OF_INITIAL, doc="ratio of post-yield stiffness to secant stiffness at the yield point")
FCR = Field(
    "FCR",
    Kind.REAL,
    "-",
    default=(0.5,),
    above=0.0,
    below=1.0,
    count=(1, 2),
    doc="ratio of cracking force to yield force, positive and negative side; one value: both",
)
RHO = Field(
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
    """First parameters of all rules on this backbone: k, both yield forces, r, alpha, then the shares of
    the crack forces and those of the secant stiffness, both of either side.

    Raises
    ------
    ValueError
        No yield force on a side.
    """
    need_both_sides(fy_plus, fy_minus)
    fcr, rho = values["FCR"], values["RHO"]
    return k, fy_plus, fy_minus, values["R"], values["ALFA"], fcr[0], fcr[-1], rho[0], rho[-1]


def of(p: Numbers, s: float) -> tuple[float, float, float, float]:
    """Yield force, crack deformation and force, and yield deformation of a side."""
    fy, share, rho = (p[1], p[5], p[7]) if s > 0.0 else (-p[2], p[6], p[8])
    return fy, share * fy / p[0], share * fy, fy / (rho * p[0])


def first_yield(p: Numbers) -> tuple[float, float]:
    """Deformations at the yield points."""
    return of(p, 1.0)[3], -of(p, -1.0)[3]


def backbone(p: Numbers, s: float, x: float) -> tuple[float, float]:
    """Slope and force of the backbone at a deformation beyond the crack."""
    fy, xc, fc, xy = of(p, s)
    if x >= xy:
        slope = p[3] * fy / xy
        return slope, fy + slope * (x - xy)
    slope = (fy - fc) / (xy - xc)
    return slope, fc + slope * (x - xc)


def largest(m: Numbers, s: float) -> float:
    """Largest deformation of a side so far."""
    return m[0] if s > 0.0 else m[1]


def grown(m: Numbers, s: float, x: float) -> tuple[float, float]:
    """Largest deformations when side `s` has reached `x`."""
    return (max(m[0], x), m[1]) if s > 0.0 else (m[0], max(m[1], x))


def has_yielded(p: Numbers, s: float, m: Numbers) -> bool:
    """Whether a side has gone beyond its yield point."""
    xy = of(p, s)[3]
    return passes(largest(m, s), xy, xy)


def peak(p: Numbers, s: float, m: Numbers) -> Point:
    """Largest deformation of a side and its force."""
    x = largest(m, s)
    return x, backbone(p, s, x)[1]


def backbone_branch(p: Numbers, at: int) -> Numbers:
    """Elastic up to a crack point (event 0: positive side), or along the backbone until the motion reverses
    (event 0) or the side yields (event 1).
    """
    if at == ELASTIC:
        return linear(p[0], 0.0, above(of(p, 1.0)[1]), below(-of(p, -1.0)[1]))
    s = side(at)
    xc, xy = of(p, s)[1], of(p, s)[3]
    if at < YIELDING:
        slope, f = backbone(p, s, xc)
        return linear(slope, s * (f - slope * xc), turns_inward(s), outward(s, xy))
    slope, f = backbone(p, s, xy)
    return linear(slope, s * (f - slope * xy), turns_inward(s))


def enter(p: Numbers, m: Numbers, s: float, x: float) -> tuple[int, Numbers]:
    """State on the backbone of a side."""
    return pair(YIELDING if x >= of(p, s)[3] else CRACKED, s), m
