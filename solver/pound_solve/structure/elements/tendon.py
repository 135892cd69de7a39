r"""TENDON: a bar or cable between two nodes that takes tension only.

Its force follows the rule `BILINEAR_SLACK` on the elongation :math:`e` along the line between its nodes,

.. math:: f = \frac{EA}{L}(e - s - p) \ge 0, \qquad s = \mathrm{SLACK} \quad\mathrm{or}\quad s = -N_0 L / EA

with the plastic elongation :math:`p`, by which the slack grows (prestress is lost).  In compression the
tendon is slack.  The prestress acts on the undeformed structure, whose deformation reduces it.  Modes and
stiffness-proportional damping include a tendon only if it is prestressed.
"""

from __future__ import annotations

import math

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.hysteresis.backbone import R_FIELD
from pound_solve.laws.hysteresis.slack_growing import growing_slack
from pound_solve.structure.elements.base import (
    ElementContext,
    ElementError,
    ElementParts,
    LawSpring,
    direction,
)

UNREACHED_STRAIN = 1e3  #: strain that is never reached


def build(context: ElementContext) -> ElementParts:
    """Build the tendon's one component."""
    p = context.prop
    if context.j is None:
        raise ElementError("a TENDON needs two nodes")
    dx, dy = context.j.x - context.i.x, context.j.y - context.i.y
    length = math.hypot(dx, dy)
    if p["N0"] and p["SLACK"]:
        raise ElementError("a tendon is slack or prestressed, not both: SLACK or N0", "N0")
    if p["PY"] is not None and p["N0"] >= p["PY"]:
        raise ElementError(f"N0 is {p['N0']:g}, no less than the yield force PY={p['PY']:g}", "N0")
    k, far = p["E"] * p["A"] / length, UNREACHED_STRAIN * length
    slack = p["SLACK"] - p["N0"] / k
    strength = k * far if p["PY"] is None else p["PY"]
    row = [
        ((node, d), sign * x)
        for node, sign in ((context.j.id, 1.0), (context.i.id, -1.0))
        for d, x in enumerate(direction(dx, dy))
        if x != 0.0
    ]
    spring = LawSpring(
        context.element.id,
        "axial",
        "BILINEAR_SLACK",
        tuple(f for f, _ in row),
        tuple(x for _, x in row),
        growing_slack(k, (strength, -strength), (slack, -far), p["R"]),
        k if p["N0"] else 0.0,
        *((None, None) if p["PY"] is None else ((slack + strength / k, math.nan), (strength, math.nan))),
    )
    return ElementParts(laws=[spring])


SPEC = Spec(
    "element",
    "TENDON",
    "tension-only bar or cable",
    (
        Field("E", Kind.REAL, "F/L^2", above=0, doc="modulus of elasticity"),
        Field("A", Kind.REAL, "L^2", above=0, doc="cross-section area"),
        Field("PY", Kind.REAL, "F", default=None, above=0, doc="yield force; omitted: elastic"),
        R_FIELD,
        Field("N0", Kind.REAL, "F", default=0.0, lo=0, doc="prestress of the undeformed structure"),
        Field("SLACK", Kind.REAL, "L", default=0.0, lo=0, doc="elongation at which it becomes taut"),
    ),
    reference="Ruaumoko's rule 5",
    impl=build,
)
