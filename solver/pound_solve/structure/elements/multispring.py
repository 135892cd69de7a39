r"""MULTISPRING: a row of springs across a section that rocks, cracks or yields spring by spring.

Springs along local x lie at distances :math:`y_i` from the axis.  With the displacement u and the rotation
:math:`\theta` of J relative to I (or of I relative to the ground)

.. math:: d_i = u_x - y_i\,\theta, \qquad N = \sum f_i, \qquad M = -\sum y_i f_i .

Given a width, the springs lie at the Gauss-Lobatto points, whose weights divide the stiffness and strength.
The points include the corners about which a section rocks, and three or more springs give exactly the
rotational stiffness :math:`K b^2/12`.  Springs that take no tension open and close; with a strength they
crush, which leaves a gap.

References
----------
Abramowitz M, Stegun IA (1964), Handbook of Mathematical Functions, National Bureau of Standards, 25.4.32
(Lobatto's rule);
Lai S-S, Will GT, Otani S (1984), Model for inelastic biaxial bending of concrete members, J. Struct. Engng
ASCE 110(11): 2563-2584.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.hysteresis.slack_growing import growing_slack
from pound_solve.numerics.types import Array
from pound_solve.structure.dofs import Dof
from pound_solve.structure.elements.base import (
    ElementContext,
    ElementError,
    ElementMatrix,
    ElementParts,
    LawSpring,
    Output,
    axes,
    hysteretic,
    signed,
)

UNREACHED_WIDTHS = 1e3  #: deformation, in widths, that no spring reaches


def lobatto(count: int) -> tuple[Array, Array]:
    """Points on [-1, 1] with their weights, which add up to 1, of Lobatto's rule, shape (count,) each."""
    last = np.polynomial.Legendre.basis(count - 1)
    inner = np.sort(last.deriv().roots().real)
    points = np.concatenate([[-1.0], 0.5 * (inner - inner[::-1]), [1.0]])
    return points, 1.0 / (count * (count - 1) * last(points) ** 2)


def no_tension(
    element: int, component: str, row: Mapping[Dof, float], k: float, strength: float | None, width: float
) -> LawSpring:
    """A spring that opens in tension and crushes at its `strength`; elastic if that is None."""
    far = UNREACHED_WIDTHS * width
    limit = k * far if strength is None else strength
    law = growing_slack(k, (limit, -limit), (far, 0.0))
    dofs, factors = zip(*((f, float(x)) for f, x in row.items() if x != 0.0))
    crushed = (None, None) if strength is None else ((math.nan, -strength / k), (math.nan, -strength))
    return LawSpring(element, component, "BILINEAR_SLACK", dofs, factors, law, k, *crushed)


def _row(context: ElementContext, y: float) -> dict[Dof, float]:
    """Factors of the DOFs in the deformation of the spring at `y`."""
    ax, _ = axes(context.prop["ANGLE"])
    ends = [(context.i.id, 1.0)] if context.j is None else [(context.j.id, 1.0), (context.i.id, -1.0)]
    return {(node, d): sign * x for node, sign in ends for d, x in enumerate((*ax, -y))}


def _places(context: ElementContext) -> tuple[Array, Array, float]:
    """Distances of the springs from the axis, their shares, and the width that they cover."""
    p = context.prop
    if (p["WIDTH"] is None) == (p["Y"] is None):
        raise ElementError("give the springs' places as WIDTH or as Y", "Y")
    if p["WIDTH"] is not None:
        points, shares = lobatto(p["COUNT"])
        if p["SHARE"] is not None:
            raise ElementError("SHARE goes with Y; over a WIDTH the shares are given", "SHARE")
        return p["WIDTH"] / 2 * points, shares, p["WIDTH"]
    y = np.array(p["Y"])
    shares = np.ones(len(y)) if p["SHARE"] is None else np.array(p["SHARE"])
    if len(shares) != len(y):
        raise ElementError(f"SHARE has {len(shares)} values, Y has {len(y)}", "SHARE")
    return y, shares / shares.sum(), float(np.abs(y).max()) or 1.0


def build(context: ElementContext) -> ElementParts:
    """Build the springs."""
    p = context.prop
    (rule,) = p.laws["RULE"]
    y, shares, width = _places(context)
    k, force = p["KX"], p["FX"]
    parts = ElementParts()
    if rule.impl is not None and p["TENSION"] == "NO":
        raise ElementError("TENSION=NO is a rule of its own: leave RULE out", "RULE")
    if rule.impl is not None and force is None:
        raise ElementError(f"{rule.name} needs the yield force FX", "RULE")
    if rule.impl is None and p["TENSION"] == "YES":
        if force is not None:
            raise ElementError("FX has no effect with RULE=ELASTIC: name a rule that yields", "FX")
        dofs = tuple(_row(context, 0.0))
        rows = np.array([list(_row(context, at).values()) for at in y])
        each = (rows.T * (k * shares)).T
        parts.stiffness.append(ElementMatrix(dofs, rows.T @ each))
        parts.outputs += [
            Output(context.element.id, "axial", "F", dofs, each.sum(axis=0)),
            Output(context.element.id, "moment", "F*L", dofs, -y @ each),
        ]
        return parts
    for n, (at, share) in enumerate(zip(y.tolist(), shares.tolist()), 1):
        name, row = f"spring {n}", _row(context, at)
        if rule.impl is None:
            strength = None if force is None else -share * signed(force, "FX")[1]
            parts.laws.append(no_tension(context.element.id, name, row, share * k, strength, width))
        else:
            plus, minus = signed(force, "FX")
            parts.laws.append(
                hysteretic(
                    context.element.id, name, "F", row, p, rule, share * k, (share * plus, share * minus)
                )
            )
    return parts


SPEC = Spec(
    "element",
    "MULTISPRING",
    "row of springs across a section",
    (
        Field("KX", Kind.REAL, "F/L", above=0, doc="total spring stiffness along local x"),
        Field(
            "FX",
            Kind.REAL,
            "F",
            default=None,
            count=(1, 2),
            doc="total yield force, positive and (signed) negative",
        ),
        Field(
            "ANGLE", Kind.REAL, "deg", default=90.0, doc="angle of the springs from global x, anticlockwise"
        ),
        Field("WIDTH", Kind.REAL, "L", default=None, above=0, doc="width covered by the springs"),
        Field("COUNT", Kind.INT, "-", default=10, lo=2, hi=50, doc="number of springs over WIDTH"),
        Field(
            "Y",
            Kind.REAL,
            "L",
            default=None,
            count=(1, 50),
            doc="spring positions along local y, to the left of their direction, in place of WIDTH",
        ),
        Field(
            "SHARE",
            Kind.REAL,
            "-",
            default=None,
            above=0,
            count=(1, 50),
            doc="shares of the springs at Y in KX and FX, any sum; omitted: equal",
        ),
        Field(
            "TENSION",
            Kind.WORD,
            default="YES",
            words=("YES", "NO"),
            doc="NO: springs open in tension and crush at the negative FX, if any",
        ),
        Field(
            "RULE",
            Kind.FAMILY,
            default="ELASTIC",
            family="hysteresis",
            doc="hysteresis rule of the springs",
        ),
    ),
    reference="Lai, Will & Otani 1984",
    impl=build,
)
