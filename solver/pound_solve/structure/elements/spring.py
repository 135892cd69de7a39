"""SPRING: up to three uncoupled components (x, y, rotation), each with its own rule.

The deformation is the displacement of J relative to I along the component, or of a single node relative to
the ground.  The components lie along the global axes unless ANGLE rotates them; ANGLE=MEMBER rotates x into
the line from I to J. ARM places the spring between the nodes on rigid arms, so that a force across the line
rotates both nodes; without it forces cause no moment.
"""

from __future__ import annotations

import math

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.structure.dofs import Dof
from pound_solve.structure.elements.base import (
    DAMAGE,
    ElementContext,
    ElementError,
    ElementMatrix,
    ElementParts,
    Output,
    axes,
    hysteretic,
    signed,
)


def components(context: ElementContext) -> list[tuple[str, tuple[Dof, ...], tuple[float, ...]]]:
    """Name, DOFs and row of the components X, Y and R.

    Raises
    ------
    ElementError
        ANGLE=MEMBER or ARM without a line from I to J.
    """
    ax, ay = _axes(context)
    rotation = [(2, 1.0)]
    rows = []
    for name, at_i, at_j in (
        ("X", _at(ax, context, True), _at(ax, context, False)),
        ("Y", _at(ay, context, True), _at(ay, context, False)),
        ("R", rotation, rotation),
    ):
        if context.j is None:
            terms = [((context.i.id, d), f) for d, f in at_i]
        else:
            terms = [((context.j.id, d), f) for d, f in at_j] + [((context.i.id, d), -f) for d, f in at_i]
        terms = [term for term in terms if term[1] != 0.0]
        rows.append((name, tuple(dof for dof, _ in terms), tuple(f for _, f in terms)))
    return rows


def _line(context: ElementContext, item: str) -> tuple[float, float]:
    """Vector from I to J [L]; raises ElementError if there is none."""
    if context.j is None:
        raise ElementError(f"{item} needs a node J", item)
    line = context.j.x - context.i.x, context.j.y - context.i.y
    if line == (0.0, 0.0):
        raise ElementError(f"the nodes coincide: {item} needs a line from I to J", item)
    return line


def _axes(context: ElementContext) -> tuple[tuple[float, float], tuple[float, float]]:
    """Directions of x and y."""
    angle = context.prop["ANGLE"]
    if angle != "MEMBER":
        return axes(angle)
    dx, dy = _line(context, "ANGLE")
    length = math.hypot(dx, dy)
    ax = dx / length, dy / length
    return ax, (-ax[1], ax[0])


def _at(way: tuple[float, float], context: ElementContext, first: bool) -> list[tuple[int, float]]:
    """Displacement of the spring's end at node I (or J) along a direction, as pairs of DOF direction and
    factor.
    """
    terms = [(0, way[0]), (1, way[1])]
    arm = context.prop["ARM"]
    if arm is not None:
        dx, dy = _line(context, "ARM")
        share = arm if first else arm - 1.0
        terms.append((2, share * (dx * way[1] - dy * way[0])))
    return terms


def build(context: ElementContext) -> ElementParts:
    """Build the components that have stiffness."""
    card, parts = context.prop, ElementParts()
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


#: fields for the directions of SPRING and DASHPOT
PLACEMENT = (
    Field(
        "ANGLE",
        Kind.REAL,
        "deg",
        default=0.0,
        words=("MEMBER",),
        doc="angle of local x from global x, anticlockwise; MEMBER: x runs from I to J",
    ),
    Field(
        "ARM",
        Kind.REAL,
        "-",
        default=None,
        lo=0,
        hi=1,
        doc="position on the line I-J as a fraction from I: rigid arms join it to the nodes; omitted: "
        "its forces cause no moment",
    ),
)

SPEC = Spec(
    "element",
    "SPRING",
    "spring with components x, y and rotation",
    (
        Field("KX", Kind.REAL, "F/L", default=0.0, lo=0, doc="stiffness along local x"),
        Field("KY", Kind.REAL, "F/L", default=0.0, lo=0, doc="stiffness along local y"),
        Field("KR", Kind.REAL, "F*L", default=0.0, lo=0, doc="rotational stiffness"),
        *PLACEMENT,
        Field(
            "FX",
            Kind.REAL,
            "F",
            default=None,
            count=(1, 2),
            doc="yield force along x, positive and (signed) negative; omitted: elastic",
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
        Field(
            "BEARING",
            Kind.WORD,
            default=None,
            words=("YES", "NO"),
            doc="a bearing of an isolated building: the storey that it crosses is a layer of bearings, "
            "whose drift is stated as a length; omitted: one if lower than a quarter of the highest storey",
        ),
    ),
    reference="",
    impl=build,
)
