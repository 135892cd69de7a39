r"""FOUNDATION: a rigid rectangular footing on the surface of an elastic half-space.

Springs along x and y and on the rotation have the footing's static stiffness. Each direction is modelled as
a cone in the soil with this stiffness and the footing's area, which radiates waves downwards.  Translation
with wave speed c is a dashpot parallel to the spring,

.. math:: C = \rho c A,

and rocking is a dashpot whose far end carries a separate mass (no radiation at low frequency),

.. math:: C_r = \rho c I, \qquad J = \rho I z_0, \qquad z_0 = 3\rho c^2 I / K_r .

These are exact for the cone at all frequencies.  :math:`c` is the speed of shear waves along x, else that
of compression waves, at most twice that of shear waves (soil that is nearly incompressible).

With UPLIFT the soil takes no tension.  A row of springs below the footing, of stiffness
:math:`K' = 3K_r/B^2` in all, gives the rocking stiffness; a spring between footing and row corrects the
vertical stiffness,
:math:`1/K_s = 1/K_y - 1/K'`.  With a bearing strength the springs can crush.

References
----------
Gazetas G (1991), Foundation vibrations, in Fang HY (ed.), Foundation Engineering Handbook, 2nd edn, Van
Nostrand Reinhold, chapter 15 (stiffness of rectangles);
Meek JW, Wolf JP (1992), Cone models for homogeneous soil, J. Geotech. Engng ASCE 118: 667-685;
Wolf JP, Deeks AJ (2004), Foundation Vibration Analysis: A Strength-of-Materials Approach, Elsevier.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from pound_deck.model import Card
from pound_deck.schema import Field, Kind, Spec
from pound_solve.structure.dofs import Dof
from pound_solve.structure.elements.base import (
    ElementContext,
    ElementError,
    ElementMatrix,
    ElementParts,
    Output,
)
from pound_solve.structure.elements.multispring import lobatto, no_tension

TAIL, ROW = 3, 5  #: internal DOFs: rotation of the rocking cone's mass, settlement of the row of springs


def stiffness(g: float, nu: float, b: float, across: float) -> tuple[float, float, float]:
    """Static stiffness along x and y [F/L] and in rocking [F L] of a rectangle.

    Parameters
    ----------
    g : float
        Shear modulus of the soil [F/L^2].
    nu : float
        Poisson's ratio.
    b, across : float
        Half the length along x, in the plane of the frame, and across it [L].
    """
    short, long = min(b, across), max(b, across)
    ratio = short / long
    inertia = 4.0 * across * b**3 / 3.0
    vertical = 2 * g * long / (1 - nu) * (0.73 + 1.54 * ratio**0.75)
    along_short = 2 * g * long / (2 - nu) * (2 + 2.5 * ratio**0.85)
    along_long = along_short - 0.2 / (0.75 - nu) * g * long * (1 - ratio)
    if b <= across:  # rocking about the long axis
        rocking = g / (1 - nu) * inertia**0.75 * ratio**-0.25 * (2.4 + 0.5 * ratio)
    else:
        rocking = 3 * g / (1 - nu) * inertia**0.75 * ratio**-0.15
    return (along_short if b <= across else along_long), vertical, rocking


def radiation(p: Card, gravity: float, rocking: float) -> tuple[float, float, float, float]:
    """Dashpots along x and y [F T/L] and in rocking [F L T], and the mass behind the rocking dashpot [F L
    T^2].
    """
    rho = p["WGT"] / gravity
    if rho == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    shear, nu = math.sqrt(p["G"] / rho), p["NU"]
    press = shear * (math.sqrt(2 * (1 - nu) / (1 - 2 * nu)) if nu <= 1 / 3 else 2.0)
    area, inertia = 4 * p["B"] * p["L"], 4 * p["L"] * p["B"] ** 3 / 3
    reach = 3 * rho * press**2 * inertia / rocking
    return rho * shear * area, rho * press * area, rho * press * inertia, rho * inertia * reach


def build(context: ElementContext) -> ElementParts:
    """Build springs, dashpots and the mass of the rocking cone."""
    p, number = context.prop, context.element.id
    kx, ky, kr = stiffness(p["G"], p["NU"], p["B"], p["L"])
    cx, cy, cr, mass = radiation(p, context.gravity, kr)
    ends = [(context.i.id, 1.0)] if context.j is None else [(context.j.id, 1.0), (context.i.id, -1.0)]
    x, y, rotation = ({(node, d): sign for node, sign in ends} for d in range(3))
    parts, settlement, k_settlement, k_rotation = ElementParts(), y, ky, kr
    if p["UPLIFT"] == "YES":  # the row of springs has the stiffness in rocking, and a share of the vertical
        settlement, k_rotation = {**y, (number, ROW): -1.0}, 0.0
        k_settlement = _uplift(context, parts, ky, kr, rotation)
    elif p["QU"] is not None:
        raise ElementError("a bearing strength QU needs UPLIFT=YES", "QU")
    radiating = {**rotation, (number, TAIL): -1.0} if cr else rotation
    _join(parts, number, ("force X", "F"), (kx, x), (cx, x))
    _join(parts, number, ("force Y", "F"), (k_settlement, settlement), (cy, y))
    _join(parts, number, ("moment R", "F*L"), (k_rotation, rotation), (cr, radiating))
    if cr:
        parts.mass.append(ElementMatrix(((number, TAIL),), np.array([[mass]])))
    return parts


def _uplift(
    context: ElementContext, parts: ElementParts, ky: float, kr: float, rotation: Mapping[Dof, float]
) -> float:
    """Add the row of springs without tension below the footing.

    Returns
    -------
    float
        Stiffness of the spring between footing and row that brings the vertical stiffness to `ky` [F/L].
    """
    p, number = context.prop, context.element.id
    row: float = 3 * kr / p["B"] ** 2
    if row <= ky:
        raise ElementError("UPLIFT is for footings less slender than this one: raise L", "UPLIFT")
    for n, (at, share) in enumerate(zip(*lobatto(p["COUNT"])), 1):
        below = {(number, ROW): 1.0, **{f: p["B"] * at * s for f, s in rotation.items()}}
        strength = None if p["QU"] is None else share * p["QU"]
        parts.laws.append(no_tension(number, f"spring {n}", below, share * row, strength, p["B"]))
    return 1.0 / (1.0 / ky - 1.0 / row)


def _join(
    parts: ElementParts,
    number: int,
    quantity: tuple[str, str],
    spring: tuple[float, Mapping[Dof, float]],
    dashpot: tuple[float, Mapping[Dof, float]],
) -> None:
    """Add the spring and dashpot of one direction, each a coefficient along a row of DOFs, and their
    combined force as an output with its name and unit.
    """
    (name, unit), (k, spring_row), (c, row) = quantity, spring, dashpot
    if k:
        parts.stiffness.append(_block(spring_row, k))
    if c:
        parts.damping.append(_block(row, c))
    if k or c:
        dofs = tuple({**spring_row, **row})
        u_row = k * np.array([spring_row.get(f, 0.0) for f in dofs])
        v_row = c * np.array([row.get(f, 0.0) for f in dofs])
        parts.outputs.append(Output(number, name if k else "dashpot R", unit, dofs, u_row, v_row))


def _block(row: Mapping[Dof, float], factor: float) -> ElementMatrix:
    r = np.array(list(row.values()))
    return ElementMatrix(tuple(row), factor * np.outer(r, r))


SPEC = Spec(
    "element",
    "FOUNDATION",
    "rigid footing on soil",
    (
        Field("G", Kind.REAL, "F/L^2", above=0, doc="shear modulus of the soil"),
        Field("NU", Kind.REAL, "-", lo=0, below=0.5, doc="Poisson's ratio of the soil"),
        Field("WGT", Kind.REAL, "F/L^3", default=0.0, lo=0, doc="unit weight of the soil; 0: no radiation"),
        Field("B", Kind.REAL, "L", above=0, doc="half the footing's length along x"),
        Field("L", Kind.REAL, "L", above=0, doc="half its length normal to the frame plane"),
        Field("UPLIFT", Kind.WORD, default="NO", words=("NO", "YES"), doc="allow uplift of the footing"),
        Field(
            "QU",
            Kind.REAL,
            "F",
            default=None,
            above=0,
            doc="bearing strength of the whole footing, with UPLIFT; omitted: elastic",
        ),
        Field(
            "COUNT", Kind.INT, "-", default=10, lo=2, hi=50, doc="number of springs below it, with UPLIFT"
        ),
    ),
    reference="Gazetas 1991; Meek & Wolf 1992",
    impl=build,
)
