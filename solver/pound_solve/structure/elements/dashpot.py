"""DASHPOT: linear viscous components x, y and rotation; geometry as in SPRING."""

from __future__ import annotations

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.structure.elements.base import ElementContext, ElementMatrix, Output, Parts
from pound_solve.structure.elements.spring import components


def build(context: ElementContext) -> Parts:
    """Build the components that have a dashpot."""
    parts = Parts()
    for name, dofs, row in components(context):
        c = context.prop["C" + name]
        if c == 0.0:
            continue
        r = np.array(row)
        parts.damping.append(ElementMatrix(dofs, c * np.outer(r, r)))
        unit, kind = ("F*L", "moment") if name == "R" else ("F", "force")
        parts.outputs.append(
            Output(context.element.id, f"{kind} {name}", unit, dofs, np.zeros(len(row)), c * r)
        )
    return parts


SPEC = Spec(
    "element",
    "DASHPOT",
    "linear dashpot with components x, y and rotation",
    (
        Field("CX", Kind.REAL, "F*T/L", default=0.0, lo=0, doc="dashpot along local x"),
        Field("CY", Kind.REAL, "F*T/L", default=0.0, lo=0, doc="dashpot along local y"),
        Field("CR", Kind.REAL, "F*L*T", default=0.0, lo=0, doc="rotational dashpot"),
        Field("ANGLE", Kind.REAL, "deg", default=0.0, doc="angle of local x from global x, anticlockwise"),
    ),
    impl=build,
)
