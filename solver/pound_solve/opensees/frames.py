r"""FRAME: elasticBeamColumn, ElasticTimoshenkoBeam, truss, or with hinges forceBeamColumn.

A member with hinges is one force-based element: its flexibility is the sum over integration points of
weight times the flexibility of a section.  Two Gauss points with the weight 1/2 are exact for the elastic
beam, also under a uniform load.  A hinge is a further point at its end with a weight w, whose section has
the hinge's moment over the rotation divided by w L:

- LP: the section of the beam yields, w = LP/L; an elastic section at the same place with the weight -w
  takes the length of the hinge out of the beam.
- KH: w = 0.1 and the stiffness KH w L.

The sections of hinges bend only; the member stretches at Gauss's points.

References
----------
Scott MH, Fenves GL (2006), Plastic hinge integration methods for force-based beam-column elements,
J. Struct. Eng. 132(2): 244-252 (the integration); OpenSees documentation, beamIntegration UserDefined.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from pound_deck.model import Card, Element
from pound_solve.opensees import rules
from pound_solve.opensees.script import Material, Script, literal
from pound_solve.structure.elements.base import direction, signed
from pound_solve.structure.elements.beam import pair, pinned

GAUSS = 0.5 / math.sqrt(3.0)  #: distance of Gauss's two points from the middle, share of the length
OWN_WEIGHT = 0.1  #: weight of a hinge that has its own stiffness
RELEASES = {"NONE": 0, "I": 1, "J": 2, "BOTH": 3}
FOLLOWING = ("PDELTA_VARYING", "LARGE")  #: geometries that follow the axial force of each instant
TRANSFORMATIONS = {
    "SMALL": "Linear",
    "PDELTA": "Linear",
    "PDELTA_VARYING": "PDelta",
    "LARGE": "Corotational",
}


class Line(NamedTuple):
    """Axis of a member: lengths between the nodes and of the flexible part [L], direction."""

    full: float
    length: float
    axis: tuple[float, float]


def line(script: Script, element: Element, card: Card) -> Line:
    """Axis of a member."""
    assert element.j is not None
    i, j = script.model.nodes[element.i], script.model.nodes[element.j]
    dx, dy = j.x - i.x, j.y - i.y
    full = math.hypot(dx, dy)
    return Line(full, full - card["END1"] - card["END2"], direction(dx, dy))


def frame(script: Script, element: Element, card: Card) -> None:
    """Write a member, or refuse every item of it that has no counterpart."""
    hinges = [end for end in ("I", "J") if card[f"M{end}"] is not None]
    refusals = [*_refused(card, script.model.geometry), *(_refused_of_hinges(card) if hinges else ())]
    for what, item in refusals:
        script.refuse(f"{what} ({card.label})", card.place(item))
    if refusals:
        return
    at = line(script, element, card)
    if script.model.geometry == "PDELTA":
        cos, sin = at.axis
        row = (element.id, element.i, element.j, at.full, cos, sin)
        script.sway.append(f"({', '.join(map(literal, row))})")
    if hinges:
        _hinged(script, element, card, at, hinges)
    elif card["I"] == 0.0:
        _bar(script, element, card)
    else:
        _beam(script, element, card, at)


def _refused(card: Card, geometry: str) -> Iterator[tuple[str, str]]:
    """Yield what has no counterpart, and its item, of a member of any kind."""
    for item in ("FJ", "M0", "N0"):
        if any(card[item]) if isinstance(card[item], tuple) else card[item]:
            yield f"{item} of a member", item
    if geometry not in TRANSFORMATIONS:
        yield f"GEOMETRY {geometry}", "GEOMETRY"
    if card["I"] == 0.0 and geometry == "PDELTA_VARYING":
        yield "a bar under PDELTA_VARYING", "I"
    if card["I"] == 0.0 and (card["END1"] or card["END2"]):
        yield "rigid blocks of a bar", "END1" if card["END1"] else "END2"
    if card["AS"] > 0.0 and card["PIN"] != "NONE":
        yield "a pinned end of a beam with shear deformation", "PIN"
    for item in ("AS", "END1", "END2"):
        if card[item] and geometry in FOLLOWING:
            yield f"{item} of a member with GEOMETRY {geometry}", item


def _refused_of_hinges(card: Card) -> Iterator[tuple[str, str]]:
    """Yield what has no counterpart, and its item, of a member with hinges."""
    (rule,) = card.laws["RULE"]
    if rule.name not in rules.RULES:
        yield f"hinges of RULE={rule.name}", "RULE"
    elif rule.name == "ELASTO_PLASTIC" or card["R"] <= 0.0:
        what = "hinges without hardening: a section that yields must keep some stiffness, such as R=0.001"
        yield what, "RULE" if rule.name == "ELASTO_PLASTIC" else "R"
    if pinned(card):
        yield "a pinned end of a member with a hinge", "PIN"
    if card["AS"] > 0.0:
        yield "shear deformation of a member with hinges", "AS"


def _bar(script: Script, element: Element, card: Card) -> None:
    """Write a truss element."""
    material = script.material(rules.elastic(card["E"]))
    ends = (element.i, element.j)
    kind = "corotTruss" if script.model.geometry == "LARGE" else "Truss"
    script.call("elements", "element", kind, element.id, *ends, card["A"], material, "-doRayleigh", 1)


def _beam(script: Script, element: Element, card: Card, at: Line) -> None:
    """Write an elastic beam."""
    transformation = _transformation(script, card, at)
    e, area, inertia = card["E"], card["A"], card["I"]
    head = ("element", "elasticBeamColumn", element.id, element.i, element.j)
    if card["AS"] > 0.0:
        timoshenko = (e, card["G"], area, inertia, card["AS"], transformation)
        head = ("element", "ElasticTimoshenkoBeam", *head[2:])
        script.call("elements", *head, *timoshenko)
        return
    release = RELEASES[card["PIN"]]
    pins = ("-release", release) if release else ()
    script.call("elements", *head, area, e, inertia, transformation, *pins)


def _transformation(script: Script, card: Card, at: Line) -> int:
    """Write the transformation of a member, and return its tag."""
    tag, (cos, sin) = script.tag(), at.axis
    offsets: tuple[object, ...] = ()
    if card["END1"] or card["END2"]:
        first, second = card["END1"], card["END2"]
        offsets = ("-jntOffset", first * cos, first * sin, -second * cos, -second * sin)
    script.call("elements", "geomTransf", TRANSFORMATIONS[script.model.geometry], tag, *offsets)
    return tag


def _hinged(script: Script, element: Element, card: Card, at: Line, hinges: list[str]) -> None:
    """Write a member with hinges."""
    (rule,) = card.laws["RULE"]
    e, area, inertia = card["E"], card["A"], card["I"]
    lengths = dict(zip("IJ", pair(card["LP"] or (0.0,))))
    stiffnesses = dict(zip("IJ", pair(card["KH"] or (0.0,))))
    plain, bend = script.tag(), 0
    script.call("elements", "section", "Elastic", plain, e, area, inertia)
    if card["LP"] is not None:
        bend = _section(script, rules.elastic(e * inertia))
    points = [(0.5 - GAUSS, 0.5, plain), (0.5 + GAUSS, 0.5, plain)]
    for end in hinges:
        weight, k = lengths[end] / at.length, e * inertia
        if card["KH"] is not None:
            weight, k = OWN_WEIGHT, stiffnesses[end] * OWN_WEIGHT * at.length
        plus, minus = signed(card[f"M{end}"], f"M{end}")
        material = rules.RULES[rule.name](card.values, k, plus, minus)
        section, place_of_end = _section(script, material), float(end == "J")
        points.append((place_of_end, weight, section))
        if card["LP"] is not None:
            points.append((place_of_end, -weight, bend))
    places, weights, sections = zip(*points)
    integration = script.tag()
    arguments = (len(points), *sections, *places, *weights)
    script.call("elements", "beamIntegration", "UserDefined", integration, *arguments)
    transformation = _transformation(script, card, at)
    ends = (element.i, element.j)
    script.call("elements", "element", "forceBeamColumn", element.id, *ends, transformation, integration)


def _section(script: Script, flexure: Material) -> int:
    """Write a section that bends only, and return its tag."""
    material, section = script.material(flexure), script.tag()
    script.call("elements", "section", "Uniaxial", section, material, "Mz")
    return section
