"""SPRING, DASHPOT and CONTACT: elements without length of OpenSees, which join nodes at any distance.

An element of OpenSees measures the displacement of its second node less that of the first along its local
axes (1, 2) and their relative rotation (6).  One that ends at the ground or at a wall gets a fixed node.
"""

from __future__ import annotations

import math

from pound_deck.model import Card, Element, Model
from pound_solve.laws.refusal import ItemError
from pound_solve.opensees import impacts, rules
from pound_solve.opensees.script import Material, Script
from pound_solve.structure.elements.base import axes, signed

COMPONENTS = (("X", 1, "FX"), ("Y", 2, "FY"), ("R", 6, "MR"))  #: name, direction in OpenSees, strength


def spring(script: Script, element: Element, card: Card) -> None:
    """Write the components of a SPRING that have stiffness."""
    names = card["RULE"]
    specs = {spec.name: spec for spec in card.laws["RULE"]}
    parts = []
    for n, (component, direction, strength) in enumerate(COMPONENTS):
        k = card["K" + component]
        if k == 0.0:
            continue
        rule = specs[names[n] if len(names) == 3 else names[0]]
        if rule.impl is None:
            parts.append((direction, rules.elastic(k)))
        elif rule.name not in rules.RULES:
            script.refuse(f"{card.label}: RULE={rule.name}", card.place("RULE"))
        else:
            plus, minus = signed(card[strength], strength)
            parts.append((direction, rules.RULES[rule.name](card.values, k, plus, minus)))
    _write(script, element, card, parts, damped=True)


def dashpot(script: Script, element: Element, card: Card) -> None:
    """Write the components of a DASHPOT without limits and play."""
    parts = []
    if card["ALPHA"] < 1.0:
        raise ItemError("a dashpot with ALPHA below 1: OpenSees does not converge with it", "ALPHA")
    for component, direction, limit in COMPONENTS:
        if card["C" + component] == 0.0:
            continue
        for item in (limit, f"GAP{component}"):
            if card[item] is not None:
                raise ItemError(f"a dashpot with {item}", item)
        parts.append((direction, Material("Viscous", (card["C" + component], float(card["ALPHA"])))))
    _write(script, element, card, parts, damped=False)


def contact(script: Script, element: Element, card: Card) -> None:
    """Write a contact; its direction points from I to J or to the wall."""
    if card["MU"] is not None:
        raise ItemError("friction of a contact", "MU")
    if card["LAW"] not in impacts.LAWS:
        raise ItemError(f"LAW={card['LAW']}", "LAW")
    (law,) = script.structure.parts[element.id].laws
    material = impacts.LAWS[card["LAW"]](law.law.p)
    normal = [0.0, 0.0]
    for (node, d), factor in zip(law.dofs, law.row):
        if node == element.i:
            normal[d] = factor
    second = element.j if element.j is not None else _ground(script, element)
    _zero_length(script, element, (element.i, second), [(1, material)], normal, damped=False)


def _write(
    script: Script, element: Element, card: Card, parts: list[tuple[int, Material]], damped: bool
) -> None:
    """Write the components of a spring or a dashpot in one element."""
    if card["ARM"] is not None:
        raise ItemError("rigid arms of a spring", "ARM")
    if not parts:
        return
    ends = (_ground(script, element), element.i) if element.j is None else (element.i, element.j)
    _zero_length(script, element, ends, parts, _axis(script.model, element, card), damped)


def _axis(model: Model, element: Element, card: Card) -> list[float]:
    """Direction of local x."""
    if card["ANGLE"] != "MEMBER":
        return list(axes(card["ANGLE"])[0])
    assert element.j is not None
    i, j = model.nodes[element.i], model.nodes[element.j]
    length = math.hypot(j.x - i.x, j.y - i.y)
    return [(j.x - i.x) / length, (j.y - i.y) / length]


def _zero_length(
    script: Script,
    element: Element,
    ends: tuple[int, int],
    parts: list[tuple[int, Material]],
    axis: list[float],
    damped: bool,
) -> None:
    """Write an element without length; `axis` is its local x."""
    tags = [script.material(material) for _, material in parts]
    cos, sin = axis
    orient = () if (cos, sin) == (1.0, 0.0) else ("-orient", cos, sin, 0.0, -sin, cos, 0.0)
    directions = [direction for direction, _ in parts]
    arguments = (*ends, "-mat", *tags, "-dir", *directions, *orient, "-doRayleigh", int(damped))
    script.call("elements", "element", "zeroLength", element.id, *arguments)


def _ground(script: Script, element: Element) -> int:
    """Write a fixed node at node I, and return its tag."""
    node, tag = script.model.nodes[element.i], script.tag()
    script.call("nodes", "node", tag, node.x, node.y)
    script.call("nodes", "fix", tag, 1, 1, 1)
    return tag
