"""CONTACT: impact between two nodes, or a node and a wall, along a direction.

The closure is the displacement of I less that of J along the direction (the wall does not move);
the contact touches when it reaches GAP.  The direction points from I to J (or to the wall): along the line
between the nodes, or at ANGLE.  A negative GAP is an overlap from the start.  Compression is positive.

K=ADJACENT takes the axial stiffness EA/L of the elements at the contact's nodes along its direction, as
Watanabe and Kawashima (2004, 13th World Conf.  Earthquake Engng, Vancouver) and Cole et al. (2011) do;
ADJACENT selects the stiffness at one node or the harmonic mean :math:`2 k_1 k_2 / (k_1 + k_2)`.  A wall is
rigid.

MU adds a second component, friction across the direction (see `contact.friction`).
"""

from __future__ import annotations

import math

from pound_deck.schema import Field, Kind, Spec
from pound_solve.structure.dofs import Dof
from pound_solve.structure.elements import base
from pound_solve.structure.elements.base import (
    ElementContext,
    ElementError,
    ElementParts,
    LawSpring,
    Role,
    axes,
)


def direction(context: ElementContext) -> tuple[float, float]:
    """Unit vector along which I closes on J."""
    angle = context.prop["ANGLE"]
    if angle is not None:
        return axes(angle)[0]
    if context.j is None:
        return 1.0, 0.0
    dx, dy = context.j.x - context.i.x, context.j.y - context.i.y
    if dx == 0.0 and dy == 0.0:
        raise ElementError("the nodes coincide: ANGLE must say along which direction they meet", "ANGLE")
    return base.direction(dx, dy)


def adjacent(context: ElementContext, nodes: list[int], normal: tuple[float, float]) -> tuple[float, str]:
    """Stiffness of a contact from the adjacent elements [F/L], and its source in words."""
    choice, pairs = context.prop["ADJACENT"], []
    for node in nodes:
        axial = context.stiffness_along(node, normal)
        if not axial:
            raise ElementError(
                f"K=ADJACENT, but no element that meets node {node} is stiff axially along the contact's "
                "direction: give K a number",
                "K",
            )
        pairs.append((sum(axial.values()), f"element{'s' * (len(axial) > 1)} {', '.join(map(str, axial))}"))
    pairs.sort()
    (soft, softer), (stiff, stiffer) = pairs[0], pairs[-1] if len(pairs) > 1 else (math.inf, "the wall")
    if choice == "HARMONIC":
        return 2.0 / (1.0 / soft + 1.0 / stiff), f"K: harmonic mean of {softer} and {stiffer}"
    if choice == "SOFTER":
        return soft, f"K of {softer}, the softer"
    if math.isinf(stiff):
        raise ElementError("the stiffer of node and wall is the wall, which is rigid", "ADJACENT")
    return stiff, f"K of {stiffer}, the stiffer"


def rubbing(
    context: ElementContext, ends: list[tuple[int, float]], normal: tuple[float, float]
) -> tuple[list[LawSpring], str]:
    """Friction of the contact, if it has any, and its text for the report."""
    card, (nx, ny) = context.prop, normal
    if card["MU"] is None:
        for item in ("MUD", "KT"):
            if card[item] is not None:
                raise ElementError(f"{item} belongs to friction: give MU, too", item)
        return [], ""
    from pound_solve.laws.contact import friction  # imported only for decks with friction

    if card["KT"] is None:
        raise ElementError("friction needs KT, the tangential stiffness while it sticks", "MU")
    mud = card["MU"] if card["MUD"] is None else card["MUD"]
    try:
        law = friction.build(card["KT"], card["MU"], mud)
    except ValueError as err:
        raise ElementError.of_law(err, "MUD") from None
    row, facts = across(ends, (-ny, nx)), {"k": card["KT"]}
    spring = LawSpring(
        context.element.id,
        "friction",
        "COULOMB",
        *row,
        law,
        facts=facts,
        role=Role.FRICTION,
        normal_component="contact",
    )
    return [spring], f"; friction {card['MU']:g}, {mud:g} while it slips"


def across(
    ends: list[tuple[int, float]], unit: tuple[float, float]
) -> tuple[tuple[Dof, ...], tuple[float, ...]]:
    """DOFs of the nodes, and their factors in the displacement of I against J along a unit vector."""
    pairs = [((node, d), sign * n) for node, sign in ends for d, n in enumerate(unit) if n != 0.0]
    return tuple(f for f, _ in pairs), tuple(x for _, x in pairs)


def build(context: ElementContext) -> ElementParts:
    """Build the contact's component and its friction component."""
    card, (nx, ny) = context.prop, direction(context)
    ends = [(context.i.id, 1.0)] + ([(context.j.id, -1.0)] if context.j is not None else [])
    masses = card["MASSES"] or tuple(context.mass_along(node, (nx, ny)) for node, _ in ends)
    masses = (*masses, math.inf)[:2]
    if card["DIAPHRAGMS"] is not None and len(card["DIAPHRAGMS"]) == 2 and context.j is None:
        raise ElementError("a wall has no diaphragm: give the one stiffness of node I", "DIAPHRAGMS")
    inverse = math.inf if 0.0 in masses else sum(1.0 / m for m in masses)
    if inverse == 0.0:
        raise ElementError("nothing that it joins can move along its direction", "ANGLE")
    reduced = 0.0 if math.isinf(inverse) else 1.0 / inverse
    values, note = card.values, ""
    if values.get("K") == "ADJACENT":
        k, whose = adjacent(context, [node for node, _ in ends], (nx, ny))
        values, note = {**values, "K": k}, f"; {whose}"
    elif "ADJACENT" in card.spans:
        raise ElementError(
            "ADJACENT chooses among the neighbours for K=ADJACENT: write that, too", "ADJACENT"
        )
    try:
        built = card.laws["LAW"][0].impl({**values, "MASSES": masses}, reduced)
    except ValueError as err:
        raise ElementError.of_law(err, "LAW") from None
    rubbed, rubs = rubbing(context, ends, (nx, ny))
    facts = {
        "k": built.k,
        "k_unit": built.unit,
        "c": built.c,
        "xi": built.xi,
        "e_asked": built.e_asked,
        "e_given": built.e_given,
        "limit": built.limit,
        "note": built.note + note + rubs,
        "reduced_mass": reduced,
        "masses": masses,
        "angle": math.degrees(math.atan2(ny, nx)),
    }
    spring = LawSpring(
        context.element.id,
        "contact",
        card["LAW"],
        *across(ends, (nx, ny)),
        built.law,
        facts=facts,
        role=Role.CONTACT,
    )
    return ElementParts(laws=[spring, *rubbed])


SPEC = Spec(
    "element",
    "CONTACT",
    "contact between two nodes or with a wall",
    (
        Field("GAP", Kind.REAL, "L", doc="distance at rest; 0 touching, negative overlapping"),
        Field(
            "ANGLE",
            Kind.REAL,
            "deg",
            default=None,
            doc="direction from I towards J or the wall; omitted: the line I-J, or +x for a wall",
        ),
        Field(
            "ADJACENT",
            Kind.WORD,
            default="SOFTER",
            words=("SOFTER", "STIFFER", "HARMONIC"),
            doc="neighbour whose stiffness K=ADJACENT uses, or harmonic mean of both",
        ),
        Field("LAW", Kind.FAMILY, default="LINEAR", family="contact", doc="contact law"),
        Field("MU", Kind.REAL, "-", default=None, above=0, doc="coefficient of friction; omitted: none"),
        Field(
            "MUD", Kind.REAL, "-", default=None, lo=0, doc="coefficient of sliding friction; omitted: MU"
        ),
        Field("KT", Kind.REAL, "F/L", default=None, above=0, doc="tangential stiffness while sticking"),
        Field(
            "MASSES",
            Kind.REAL,
            "F*T^2/L",
            default=None,
            count=(1, 2),
            above=0,
            doc="colliding masses for E and XI; omitted: the nodes' own (a wall: infinite)",
        ),
        Field(
            "DIAPHRAGMS",
            Kind.REAL,
            "F/L",
            default=None,
            count=(1, 2),
            above=0,
            doc="axial stiffness EA/L of the diaphragms that nodes I and J represent; one value: for I, "
            "the other is rigid; omitted: from the members behind the nodes",
        ),
    ),
    impl=build,
)
