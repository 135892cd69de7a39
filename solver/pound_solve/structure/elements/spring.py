"""SPRING: up to three uncoupled components (x, y, rotation), each with its own rule.

The deformation is the displacement of J less that of I along the component; with one node only it is the
displacement of that node against the ground.  The components lie along the global axes unless ANGLE turns
them.  A spring has no length of its own: its forces make no moment.
"""

from __future__ import annotations

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.structure.dofs import Dof
from pound_solve.structure.elements.base import (
    DAMAGE,
    ElementContext,
    ElementError,
    ElementMatrix,
    Output,
    Parts,
    axes,
    hysteretic,
    signed,
)


def components(context: ElementContext) -> list[tuple[str, tuple[Dof, ...], tuple[float, ...]]]:
    """Name, DOFs and row of the components X, Y and R."""
    ax, ay = axes(context.prop["ANGLE"])
    i, j = context.i.id, None if context.j is None else context.j.id
    out = []
    for name, direction in (
        ("X", ((0, ax[0]), (1, ax[1]))),
        ("Y", ((0, ay[0]), (1, ay[1]))),
        ("R", ((2, 1.0),)),
    ):
        parts = tuple(p for p in direction if p[1] != 0.0)
        if j is None:
            dofs, row = tuple((i, d) for d, _ in parts), tuple(f for _, f in parts)
        else:
            dofs = tuple((j, d) for d, _ in parts) + tuple((i, d) for d, _ in parts)
            row = tuple(f for _, f in parts) + tuple(-f for _, f in parts)
        out.append((name, dofs, row))
    return out


def build(context: ElementContext) -> Parts:
    """Build the components that have stiffness."""
    card, parts = context.prop, Parts()
    names = card["RULE"]
    if len(names) == 2:
        raise ElementError("RULE takes one rule for all components, or three for x, y, rotation", "RULE")
    specs = {spec.name: spec for spec in card.laws["RULE"]}
    for n, (name, dofs, row) in enumerate(components(context)):
        k, item = card["K" + name], "F" + name if name != "R" else "MR"
        force = card[item]
        rule = specs[names[n] if len(names) == 3 else names[0]]
        if k == 0.0:
            continue
        unit, kind = ("F*L", "moment") if name == "R" else ("F", "force")
        if rule.impl is not None and force is None:
            raise ElementError(
                f"{rule.name} along {name} needs the yield force {item}; "
                "an elastic component has its own RULE=...,ELASTIC",
                "RULE",
            )
        if rule.impl is None and force is not None:
            raise ElementError(f"{item} has no effect with RULE=ELASTIC: name a rule that yields", item)
        if rule.impl is None:
            r = np.array(row)
            parts.stiffness.append(ElementMatrix(dofs, k * np.outer(r, r)))
            parts.outputs.append(Output(context.element.id, f"{kind} {name}", unit, dofs, k * r))
            continue
        at = dict(zip(dofs, row))
        parts.laws.append(
            hysteretic(context.element.id, name, unit, at, card, rule, k, signed(force, item))
        )
    if card["DUCTU"] is not None and not parts.laws:
        raise ElementError("DUCTU has no effect where nothing yields: name a rule that yields", "DUCTU")
    return parts


SPEC = Spec(
    "element",
    "SPRING",
    "spring with components x, y and rotation",
    (
        Field("KX", Kind.REAL, "F/L", default=0.0, lo=0, doc="stiffness along local x"),
        Field("KY", Kind.REAL, "F/L", default=0.0, lo=0, doc="stiffness along local y"),
        Field("KR", Kind.REAL, "F*L", default=0.0, lo=0, doc="rotational stiffness"),
        Field("ANGLE", Kind.REAL, "deg", default=0.0, doc="angle of local x from global x, anticlockwise"),
        Field(
            "FX",
            Kind.REAL,
            "F",
            default=None,
            count=(1, 2),
            doc="yield force along x, positive and (signed) negative; left out: elastic",
        ),
        Field("FY", Kind.REAL, "F", default=None, count=(1, 2), doc="yield force along y"),
        Field("MR", Kind.REAL, "F*L", default=None, count=(1, 2), doc="yield moment"),
        Field(
            "RULE",
            Kind.FAMILY,
            default=("ELASTIC",),
            count=(1, 3),
            family="hysteresis",
            doc="hysteresis rule: one for all components, or three for x, y, rotation",
        ),
        *DAMAGE,
    ),
    reference="",
    impl=build,
)
