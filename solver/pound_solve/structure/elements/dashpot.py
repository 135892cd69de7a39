"""DASHPOT: components x, y and rotation that resist the rate; geometry as in SPRING.

A linear dashpot without play and limit enters the structure's damping matrix; any other follows a law of
`pound_solve.laws.damper`.
"""

from __future__ import annotations

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.structure.elements.base import (
    ElementContext,
    ElementError,
    ElementMatrix,
    ElementParts,
    LawSpring,
    Output,
    Role,
    signed,
)
from pound_solve.structure.elements.spring import PLACEMENT, components

LIMITS, PLAYS = {"X": "FX", "Y": "FY", "R": "MR"}, {"X": "GAPX", "Y": "GAPY", "R": "GAPR"}


def build(context: ElementContext) -> ElementParts:
    """Build the components that have a dashpot."""
    card, parts = context.prop, ElementParts()
    for name, dofs, row in components(context):
        c, unit = card["C" + name], "F*L" if name == "R" else "F"
        limit, play = card[LIMITS[name]], card[PLAYS[name]]
        if c == 0.0:
            for item in (LIMITS[name], PLAYS[name]):
                if card[item] is not None:
                    raise ElementError(f"{item} has no effect without C{name}", item)
            continue
        limits = None if limit is None else signed(limit, LIMITS[name])
        if limits is not None and 0.0 in limits:
            raise ElementError(f"{LIMITS[name]}, the largest force, is not 0", LIMITS[name])
        ends = None if play is None else signed(play, PLAYS[name])
        try:
            law = card.laws["LAW"][0].impl(card.values, c, limits, ends)
        except ValueError as err:
            raise ElementError.of_law(err, "LAW") from None
        if law is None:
            r = np.array(row)
            parts.damping.append(ElementMatrix(dofs, c * np.outer(r, r)))
            kind = "moment" if name == "R" else "force"
            parts.outputs.append(
                Output(context.element.id, f"{kind} {name}", unit, dofs, np.zeros(len(row)), c * r)
            )
            continue
        parts.laws.append(
            LawSpring(context.element.id, name, card["LAW"], dofs, row, law, unit=unit, role=Role.DAMPER)
        )
    return parts


SPEC = Spec(
    "element",
    "DASHPOT",
    "dashpot or damper with components x, y and rotation",
    (
        Field("CX", Kind.REAL, "F*T/L", default=0.0, lo=0, doc="force at unit rate along local x"),
        Field("CY", Kind.REAL, "F*T/L", default=0.0, lo=0, doc="force at unit rate along local y"),
        Field("CR", Kind.REAL, "F*L*T", default=0.0, lo=0, doc="moment at unit rate"),
        *PLACEMENT,
        Field("LAW", Kind.FAMILY, default="FLUID", family="damper", doc="damper law"),
        Field(
            "FX",
            Kind.REAL,
            "F",
            default=None,
            count=(1, 2),
            doc="largest force along x, positive and (signed) negative; one value: both; omitted: no limit",
        ),
        Field("FY", Kind.REAL, "F", default=None, count=(1, 2), doc="largest force along y"),
        Field("MR", Kind.REAL, "F*L", default=None, count=(1, 2), doc="largest moment"),
        Field(
            "GAPX",
            Kind.REAL,
            "L",
            default=None,
            count=(1, 2),
            doc="play along x, positive and (signed) negative end; one value: both; no force within it; "
            "beyond it the damper resists motion outwards and back",
        ),
        Field("GAPY", Kind.REAL, "L", default=None, count=(1, 2), doc="play along y"),
        Field("GAPR", Kind.REAL, "rad", default=None, count=(1, 2), doc="play of the rotation"),
    ),
    reference="",
    impl=build,
)
