"""CONTACT: two nodes, or a node and a wall, that meet along a direction.

The closure is the displacement of I less that of J along the direction (the wall does not move);
the contact touches when it reaches GAP.  The direction points from I to J (or to the wall): along the line
between the nodes, or at ANGLE.  A negative GAP is an overlap from the start.  Compression is positive.
"""

from __future__ import annotations

import math

from pound_deck.schema import Field, Kind, Spec
from pound_solve.elements import base
from pound_solve.elements.base import ElementError, LawSpring, Parts, Site, axes


def direction(site: Site) -> tuple[float, float]:
    """Unit vector along which I closes on J."""
    angle = site.prop["ANGLE"]
    if angle is not None:
        return axes(angle)[0]
    if site.j is None:
        return 1.0, 0.0
    dx, dy = site.j.x - site.i.x, site.j.y - site.i.y
    if dx == 0.0 and dy == 0.0:
        raise ElementError("the nodes coincide: ANGLE must say along which direction they meet", "ANGLE")
    return base.direction(dx, dy)


def build(site: Site) -> Parts:
    """Build the contact's one component."""
    card, (nx, ny) = site.prop, direction(site)
    ends = [(site.i.id, 1.0)] + ([(site.j.id, -1.0)] if site.j is not None else [])
    pairs = [((node, d), sign * n) for node, sign in ends for d, n in ((0, nx), (1, ny)) if n != 0.0]
    masses = card["MASSES"] or tuple(site.mass_along(node, (nx, ny)) for node, _ in ends)
    masses = (*masses, math.inf)[:2]
    if card["DIAPHRAGMS"] is not None and len(card["DIAPHRAGMS"]) == 2 and site.j is None:
        raise ElementError("a wall has no diaphragm: give the one stiffness of node I", "DIAPHRAGMS")
    inverse = math.inf if 0.0 in masses else sum(1.0 / m for m in masses)
    if inverse == 0.0:
        raise ElementError("nothing that it joins can move along its direction", "ANGLE")
    reduced = 0.0 if math.isinf(inverse) else 1.0 / inverse
    try:
        built = card.laws["LAW"][0].impl({**card.values, "MASSES": masses}, reduced)
    except ValueError as err:
        raise ElementError(str(err), "LAW") from None
    facts = {
        "k": built.k,
        "k_unit": built.unit,
        "c": built.c,
        "gap": card["GAP"],
        "xi": built.xi,
        "e_asked": built.e_asked,
        "e_given": built.e_given,
        "note": built.note,
        "reduced_mass": reduced,
        "masses": masses,
        "angle": math.degrees(math.atan2(ny, nx)),
    }
    spring = LawSpring(
        site.element.id,
        "contact",
        card["LAW"],
        tuple(f for f, _ in pairs),
        tuple(v for _, v in pairs),
        built.law,
        facts=facts,
    )
    return Parts(laws=[spring])


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
            doc="direction from I towards J or the wall; left out: the line I-J, or +x for a wall",
        ),
        Field("LAW", Kind.FAMILY, default="LINEAR", family="contact", doc="contact law"),
        Field(
            "MASSES",
            Kind.REAL,
            "F*T^2/L",
            default=None,
            count=(1, 2),
            above=0,
            doc="colliding masses for E and XI; left out: the nodes' own (a wall: infinite)",
        ),
        Field(
            "DIAPHRAGMS",
            Kind.REAL,
            "F/L",
            default=None,
            count=(1, 2),
            above=0,
            doc="axial stiffness EA/L of the diaphragms that the nodes I and J stand for; one value: "
            "that of I, the other is rigid; left out: the members behind the nodes are looked at",
        ),
    ),
    impl=build,
)
