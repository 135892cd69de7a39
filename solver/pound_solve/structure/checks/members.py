"""Checks for members with inconsistent values: shapes of sections, lengths, strengths of hinges.

A rectangle with the same A and I is sqrt(12 I/A) deep.  Mixed units or exchanged items make it deeper than
the whole building, or thinner than any real section.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from statistics import median
from typing import Final

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Card, Element, Model
from pound_solve.structure.buildings import parts
from pound_solve.structure.elements.base import LawSpring, Role
from pound_solve.structure.structure import Structure

MEMBERS: Final = ("FRAME", "BEAM_COLUMN")
#: depth over length: a core of 16 m in storeys of 3 m has no more; a section must also fit into its
#: building
MAX_DEPTH_RATIO: Final = 5.0
USUAL_DEPTHS: Final = (1.0 / 50.0, 1.0 / 3.0)  #: depth over length of ordinary members
HORIZONTAL_COSINE: Final = 0.999  #: cosine of the largest slope of a horizontal member
MIN_DEPTH_RATIO: Final = 1.0 / 300.0  #: depth over length of a member that bends
SLENDER_DEPTH_RATIO: Final = 1.0 / 40.0  #: depth over length; floor slabs have no less
#: length over the median of its property set; an error of one digit makes it ten
MAX_LENGTH_RATIO: Final = 6.0
#: M h/(E I) at yield, twice the strain of the outer fibre; sections of concrete, steel or timber have
#: 0.0005 to 0.01, so that a factor of a thousand is beyond these limits
MIN_YIELD_STRAIN, MAX_YIELD_STRAIN = 2e-5, 0.1
MAX_YIELD_ROTATION: Final = 0.2  #: at yield [rad]; joints of timber have 0.05
#: depth over the size of a building; a stick model of a whole building stays below
MAX_DEPTH_IN_BUILDING: Final = 2.0
MAX_WIDTH_RATIO: Final = 8.0  #: width over depth of a section
MAX_HARDENING_RATIO: Final = 0.2  #: fraction of a section's stiffness that remains after yield
ROUNDING: Final = 1e-9  #: fraction of a length
MAX_DUCTILITY: Final = 100.0  #: of the curvature of sections; members have less than 50


def depth(card: Card) -> float:
    """Depth of the rectangle that has the area and the second moment of a section [L]; 0 for a bar."""
    return math.sqrt(12.0 * card["I"] / card["A"])


def length(model: Model, e: Element) -> float:
    """Distance of the nodes of a member [L]."""
    i, j = model.nodes[e.i], model.nodes[e.i if e.j is None else e.j]
    return math.hypot(i.x - j.x, i.y - j.y)


def is_horizontal(model: Model, e: Element) -> bool:
    """Whether an element with two nodes is horizontal."""
    assert e.j is not None
    i, j = model.nodes[e.i], model.nodes[e.j]
    return abs(i.x - j.x) > HORIZONTAL_COSINE * math.hypot(i.x - j.x, i.y - j.y)


def misshapen_members(structure: Structure) -> list[Diagnostic]:
    """Report sections and members of impossible proportions, once for each property set."""
    model, problems = structure.model, dict[str, Diagnostic]()
    sizes = _sizes(model)
    for label, members in members_by_set(model).items():
        card = model.props[label]
        if not card["I"]:
            continue
        h, short = depth(card), min(members, key=lambda e: length(model, e))
        size, long = sizes[short.i], length(model, short)
        if h > size and (h > MAX_DEPTH_RATIO * long or _exchanged(card, long, h / size)):
            problems[label] = _too_deep(model, card, short, h)
            continue
        problem = _area_in_smaller_units(model, card, members, size**2)
        problem = problem or _too_thin(model, card, short, h, size**2) or _too_long(model, card, members, h)
        if problem:
            problems[label] = problem
    return list(problems.values())


def _exchanged(card: Card, long: float, beyond: float) -> bool:
    """Whether A and I of a section have been exchanged: it is `beyond` times as deep as its building is
    large, and with A and I exchanged its depth would be usual for a member of the length `long`.
    """
    return (
        beyond > MAX_DEPTH_IN_BUILDING
        and USUAL_DEPTHS[0] <= math.sqrt(12.0 * card["A"] / card["I"]) / long <= USUAL_DEPTHS[1]
    )


def members_by_set(model: Model) -> dict[str, list[Element]]:
    """Members (elements of frame types) by their property sets."""
    by_set: dict[str, list[Element]] = defaultdict(list)
    for e in model.elements.values():
        if model.props[e.prop].spec.name in MEMBERS and e.j is not None:
            by_set[e.prop].append(e)
    return by_set


def _sizes(model: Model) -> dict[int, float]:
    """For every node, the larger of height and width of its connected part [L]."""
    sizes: dict[int, float] = {}
    for nodes in parts(model):
        x, y = [model.nodes[n].x for n in nodes], [model.nodes[n].y for n in nodes]
        sizes.update(dict.fromkeys(nodes, max(max(x) - min(x), max(y) - min(y))))
    return sizes


def _too_deep(model: Model, card: Card, e: Element, h: float) -> Diagnostic:
    unit = model.units.length
    hint = f"A is in {unit}^2, I in {unit}^4: correct the one of other units, or exchange them"
    return _out_of_proportion(model, card, e, f"{h:.3g}", hint)


def _out_of_proportion(model: Model, card: Card, e: Element, depth: str, hint: str) -> Diagnostic:
    unit = model.units.length
    message = (
        f"the section of {card.label} is {depth} {unit} deep by A and I, sqrt(12 I/A), but member {e.id} "
        f"is {length(model, e):.3g} {unit} long"
    )
    return Diagnostic("P352", message, card.place("I"), hint, "warning")


def _area_in_smaller_units(
    model: Model, card: Card, members: list[Element], face: float
) -> Diagnostic | None:
    """Return a warning for an area in mm^2 or cm^2 in a deck in m, larger than the `face` of the building
    [L^2], beside I in m^4.

    A large area alone may model an axially rigid member, so it is reported only if the factor makes it
    usual.
    """
    middle = median(length(model, e) for e in members)
    if model.units.length.lower() != "m" or card["A"] < face:
        return None
    for unit, factor in (("mm", 1e-3), ("cm", 1e-2)):
        high, area = depth(card) / factor, factor**2 * card["A"]
        if USUAL_DEPTHS[0] <= high / middle <= USUAL_DEPTHS[1] and area <= MAX_WIDTH_RATIO * high**2:
            message = (
                f"A of {card.label} is {card['A']:g} m^2, but I makes the section {depth(card):.1g} m deep"
            )
            hint = f"{card['A']:g} {unit}^2 are {area:g} m^2; keep it if no axial deformation is meant"
            return Diagnostic("P352", message, card.place("A"), hint, "warning")
    return None


def _too_thin(model: Model, card: Card, e: Element, h: float, face: float) -> Diagnostic | None:
    """Return a warning for a section as thin as a wire in members that bend; an area above the `face` of
    the building [L^2] models an axially rigid member.
    """
    if h >= MIN_DEPTH_RATIO * length(model, e) or card["PIN"] == "BOTH" or card["A"] > face:
        return None
    unit = model.units.length
    hint = f"A is in {unit}^2, I in {unit}^4: correct the one of other units; a bar has PIN=BOTH or no I"
    return _out_of_proportion(model, card, e, f"{h:.2g}", hint)


def _too_long(model: Model, card: Card, members: list[Element], h: float) -> Diagnostic | None:
    """Return a warning for a member too slender and far longer than the others of its property set."""
    e = max(members, key=lambda e: length(model, e))
    long, middle = length(model, e), median(length(model, m) for m in members)
    if long <= MAX_LENGTH_RATIO * middle or h >= SLENDER_DEPTH_RATIO * long:
        return None
    unit, ends = model.units.length, " and ".join(str(n) for n in (e.i, e.j))
    message = f"member {e.id} is {long:.3g} {unit} long, others of {card.label} {middle:.3g} {unit}"
    hint = f"correct the coordinates of node {ends.replace(' and ', ' or ')} under NODES"
    return Diagnostic("P353", message, e.span, hint, "warning")


def doubled_members(structure: Structure) -> list[Diagnostic]:
    """Report members between the same two nodes, except in sets all of whose members are parallel to
    others, such as column jackets.
    """
    problems, sets = list[Diagnostic](), members_by_set(structure.model)
    at = defaultdict[frozenset[int | None], list[Element]](list)
    for members in sets.values():
        for e in members:
            at[frozenset((e.i, e.j))].append(e)
    beside = {e.id for members in at.values() if len(members) > 1 for e in members}
    added = {label for label, members in sets.items() if all(e.id in beside for e in members)}
    for first, *others in at.values():
        for e in others:
            if e.prop == first.prop or added.isdisjoint((e.prop, first.prop)):
                of = f" of {e.prop}" if e.prop == first.prop else f", {first.prop} and {e.prop},"
                message = f"members {first.id} and {e.id}{of} join the same nodes, {e.i} and {e.j}"
                hint = "take one out, or correct an end, unless two members stand side by side"
                problems.append(Diagnostic("P354", message, e.span, hint, "warning"))
    return problems


def implausible_hinges(structure: Structure) -> list[Diagnostic]:
    """Report hinges of members with an implausible yield strain of the section or ductility, and hinges and
    springs with a stiffness of their own that yield at an implausible rotation, one for each property set.

    The latter may be rigid until they yield, so small strains and large ductilities are not reported.
    """
    model, problems = structure.model, dict[str, Diagnostic]()
    of_hinges = [
        d for label, members in members_by_set(model).items() for d in _long_hinges(model, label, members)
    ]
    for spring in structure.laws:
        element = model.elements[spring.element]
        card = model.props[element.prop]
        turns = spring.role is Role.SPRING and spring.unit == "F*L" and spring.strengths is not None
        if not turns or card.spec.name not in (*MEMBERS, "SPRING"):
            continue
        assert spring.strengths is not None
        if card.spec.name not in MEMBERS or card.values.get("KH") is not None:
            doubts = list(_rotation(model, card, spring))
        elif card["I"]:
            doubts = [*_strain(model, card, element, spring.strengths), *_ductility(card)]
        else:
            continue
        for d in doubts:
            problems.setdefault(card.label, d)
    return [*of_hinges, *problems.values()]


def _long_hinges(model: Model, label: str, members: list[Element]) -> Iterator[Diagnostic]:
    """Yield warnings for hinges at both ends that together are longer than a typical member, or whose
    hardening is implausible.
    """
    card, e = model.props[label], sorted(members, key=lambda e: length(model, e))[len(members) // 2]
    both = card.values.get("HINGES") == "BOTH" or None not in (card.values.get("MI"), card.values.get("MJ"))
    hinges, long, unit = card.values.get("LP"), length(model, e), model.units.length
    if hinges and both and sum((*hinges, *hinges)[:2]) > long * (1.0 + ROUNDING):
        one, other = (*hinges, *hinges)[:2]
        message = (
            f"the hinges of {label} are {one:g} and {other:g} {unit} long, but member {e.id} is {long:g} "
            f"{unit}"
        )
        hint = f"LP is in {unit}: half the depth of the section is usual"
        yield Diagnostic("P355", message, card.place("LP"), hint, "warning")
    hardening = card.values.get("R")
    if hinges and hardening is not None and hardening >= MAX_HARDENING_RATIO:
        message = f"hinges of {label} keep R={hardening:g} of the stiffness of the section as they yield"
        hint = f"R is a share: {hardening:g} % is R={hardening / 100.0:g}; 0.01 to 0.05 are usual"
        yield Diagnostic("P355", message, card.place("R"), hint, "warning")


def _strain(
    model: Model, card: Card, element: Element, strengths: tuple[float, float]
) -> Iterator[Diagnostic]:
    """Yield a warning for a yield moment that does not fit the stiffness of its section, so that the strain
    at yield is implausible.
    """
    h, unit = depth(card), model.units.text("F*L")
    moment = max((abs(m) for m in strengths if math.isfinite(m)), default=0.0)
    ei = card["E"] * card["I"]
    strain = moment * h / ei if ei else 0.0
    plain = USUAL_DEPTHS[0] < h / length(model, element) < 1.0  # else A or the length is a modelling choice
    if strain and plain and not MIN_YIELD_STRAIN <= strain <= MAX_YIELD_STRAIN:
        few = strain < MIN_YIELD_STRAIN
        message = (
            f"hinges of {card.label} yield at {moment:g} {unit}, a strain of {strain:.1g} of the section: "
            f"{'0.001 is little' if few else '0.01 is much'}"
        )
        item = next(i for i in ("MI", "MJ", "MP", "NM", "LP") if card.values.get(i) is not None)
        hint = f"yield moments are in {unit}, E in {model.units.text('F/L^2')}"
        yield Diagnostic("P355", message, card.place(item), hint, "warning")


def _rotation(model: Model, card: Card, spring: LawSpring) -> Iterator[Diagnostic]:
    """Yield a warning for a yield moment that a hinge or spring with a specified stiffness reaches at an
    implausible rotation.
    """
    at = max((abs(x) for x in spring.yields or () if math.isfinite(x)), default=0.0)
    if at > MAX_YIELD_ROTATION:
        k, m = ("KH", "MI") if card.spec.name in MEMBERS else ("KR", "MR")
        item = next(i for i in (m, "MJ", k) if card.values.get(i) is not None)
        message = f"{card.label} yields at a rotation of {at:.2g} rad: 0.05 is much"
        hint = f"{item} is in {model.units.text('F*L')}, {k} in the same for one radian"
        yield Diagnostic("P355", message, card.place(item), hint, "warning")


def _ductility(card: Card) -> Iterator[Diagnostic]:
    most = max(card.values.get("DUCTU") or (0.0,))
    if most > MAX_DUCTILITY:
        message = f"DUCTU of {card.label} is {most:g}, but no member has more than {MAX_DUCTILITY:g}"
        hint = "DUCTU is a multiple of the yield deformation, not per cent"
        yield Diagnostic("P355", message, card.place("DUCTU"), hint, "warning")
