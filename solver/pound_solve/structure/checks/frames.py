"""Checks for members and buildings that are missing, misplaced or given twice, judged by their
surroundings.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator
from functools import partial
from itertools import pairwise
from statistics import median
from typing import Final

from pound_deck.diagnostics import Diagnostic
from pound_deck.model import Element, Model
from pound_solve.structure.buildings import Building, Floor, buildings, joints, parts, stands
from pound_solve.structure.checks.ends import places
from pound_solve.structure.checks.members import is_horizontal, length, members_by_set
from pound_solve.structure.checks.supports import shaken, some
from pound_solve.structure.structure import Structure

#: least height of a column over the median length of its property set
MIN_COLUMN_LENGTH_RATIO: Final = 0.25

MIN_BRACE_SLOPE, MAX_BRACE_SLOPE = 10.0, 70.0  #: slopes of braces from and to [degrees]

_warn = partial(Diagnostic, severity="warning")


def framing_mistakes(structure: Structure) -> list[Diagnostic]:
    """Report buildings that coincide with others, and members that are missing or slope by mistake."""
    model = structure.model
    if not shaken(model):
        return []
    problems = list(_coincident_frames(model))
    standing = [b for b in buildings(structure) if stands(model, b.nodes)]
    lines = Lines(model, standing)
    for b in standing:
        problems += [*_without_column(lines, b), *_without_beam(lines, b), *_passing_a_floor(lines, b)]
    return [*problems, *_sloping_beams(model), *_short_columns(structure), *_inclined_dashpots(model)]


def _coincident_frames(model: Model) -> Iterator[Diagnostic]:
    """Yield warnings for frames whose nodes all coincide with those of another frame."""
    _, at = places(model)
    first: dict[int, int] = {}
    frames = [p for p in parts(model) if stands(model, p) and len({model.nodes[n].x for n in p}) > 1]
    covers = [frozenset(at[n] for n in p) for p in frames]
    for k, (nodes, cover) in enumerate(zip(frames, covers)):
        below = next((i for i in {first.get(a, k) for a in cover} if i != k and cover <= covers[i]), k)
        if below != k:
            message = (
                f"the frame of nodes {some(nodes)} lies upon that of nodes {some(frames[below])}: each of "
                "its nodes is at the place of one of the other"
            )
            hint = "move it by its X under NODES, or take it out if it is given twice"
            yield _warn("P371", message, model.nodes[nodes[0]].span, hint)
        for a in cover:
            first.setdefault(a, k)


class Lines:
    """Horizontal members and elements that lead up and down, by their nodes.

    Attributes
    ----------
    model : Model
    beams, up, down : mapping of int to list of Element
        At every node: horizontal members, and all elements that lead upwards and downwards.
    joined : set of frozenset of int
        Pairs of nodes that elements join.
    grounded : set of int
        Nodes on elements that end at the ground.
    group, at : list of list of int, mapping of int to int
        Nodes at every place, and the place of every node.
    joint : mapping of int to list of int
        Nodes of a building at the place of each of its nodes: a column that ends at its hinge ends at the
        joint.
    """

    def __init__(self, model: Model, standing: Iterable[Building]) -> None:
        self.model = model
        self.beams, self.up, self.down = (defaultdict[int, list[Element]](list) for _ in range(3))
        self.joined = {frozenset(pair) for pair in joints(model)}
        self.grounded = {e.i for e in model.elements.values() if e.j is None}
        self.group, self.at = places(model)
        self.joint: dict[int, list[int]] = {}
        for b in standing:
            inside = set(b.nodes)
            self.joint |= {n: [m for m in self.group[self.at[n]] if m in inside] for n in b.nodes}
        for e in model.elements.values():
            if e.j is None or model.props[e.prop].spec.name == "CONTACT":
                continue
            i, j = model.nodes[e.i], model.nodes[e.j]
            if is_horizontal(model, e):
                self.beams[e.i].append(e)
                self.beams[e.j].append(e)
            elif i.y != j.y:
                low, high = (e.i, e.j) if i.y < j.y else (e.j, e.i)
                self.up[low].append(e)
                self.down[high].append(e)

    def rises(self, n: int) -> bool:
        """Whether an element leads upwards from the joint of a node."""
        return any(self.up[m] for m in self.joint[n])

    def falls(self, n: int) -> bool:
        """Whether an element leads downwards from the joint of a node."""
        return any(self.down[m] for m in self.joint[n])

    def beamed(self, n: int) -> bool:
        """Whether a beam ends at a node or at one that coincides with it."""
        return any(self.beams[m] for m in self.group[self.at[n]])

    def held(self, n: int) -> bool:
        """Whether a node is supported vertically, slaved vertically, or joined to the ground by an
        element.
        """
        node = self.model.nodes[n]
        return "Y" in node.fixed or "Y" in node.slaved or n in self.grounded

    def end(self, n: int) -> bool:
        """Whether beams lead from the joint of a node to one side only, and nothing leads down from it."""
        nodes, x = self.model.nodes, self.model.nodes[n].x
        ends = [m for at in self.joint[n] for e in self.beams[at] for m in (e.i, e.j) if m is not None]
        return len({nodes[m].x > x for m in ends if nodes[m].x != x}) == 1 and not self.falls(n)


def _without_column(lines: Lines, b: Building) -> Iterator[Diagnostic]:
    """Yield warnings for ends of beams above a column that ends below them."""
    nodes = lines.model.nodes
    upright = defaultdict[float, list[int]](list)
    for n in sorted(b.nodes, key=lambda n: nodes[n].y):
        upright[nodes[n].x].append(n)
    for line in upright.values():
        for below, n in pairwise(line):
            ends = (lines.falls(below) or "Y" in nodes[below].fixed) and not lines.rises(below)
            ends = ends and nodes[below].y < nodes[n].y  # excludes zero-length joints
            if ends and lines.end(n) and not lines.held(n):
                message = (
                    f"nothing stands below node {n} of {b.name!r}, where a beam ends, but node {below} is "
                    "right below it"
                )
                yield _warn("P375", message, nodes[n].span, f"is a column missing from {below} to {n}?")


def _without_beam(lines: Lines, b: Building) -> Iterator[Diagnostic]:
    """Yield warnings for pairs of columns without a beam between them, though one joins them at the floor
    below.
    """
    for below, floor in pairwise(b.floors):
        for left, right in pairwise(_by_x(lines.model, floor)):
            feet = [_foot(lines, n, below) for n in (left, right)]
            free = not any(lines.beamed(n) or lines.model.nodes[n].slaved for n in (left, right))
            tied = frozenset((left, right)) in lines.joined
            if free and not tied and None not in feet and frozenset(feet) in lines.joined:
                message = (
                    f"no beam joins nodes {left} and {right} of {b.name!r}, as one joins {feet[0]} and "
                    f"{feet[1]} below them"
                )
                yield _warn("P375", message, lines.model.nodes[left].span, "is a beam missing?")


def _passing_a_floor(lines: Lines, b: Building) -> Iterator[Diagnostic]:
    """Yield warnings for elements that pass through the place of a node at which a lower element ends."""
    nodes = lines.model.nodes
    ends = [n for n in b.nodes if lines.down[n] and not lines.rises(n) and n not in lines.grounded]
    for n in ends:
        for other in (m for m in b.nodes if nodes[m].x == nodes[n].x and nodes[m].y > nodes[n].y):
            for e in lines.down[other]:
                foot = nodes[e.i if e.j == other else e.j or e.i]
                if foot.x == nodes[n].x and foot.y < nodes[n].y:
                    message = f"element {e.id} passes node {n} of {b.name!r}, from which nothing leads up"
                    yield _warn("P375", message, e.span, f"let it end or begin at node {n}")


def _by_x(model: Model, floor: Floor) -> list[int]:
    return sorted(floor.nodes, key=lambda n: model.nodes[n].x)


def _foot(lines: Lines, n: int, floor: Floor) -> int | None:
    """Floor node at the foot of the single column below a node; None otherwise."""
    lower = {m for e in lines.down[n] for m in (e.i, e.j) if m != n}
    return lower.pop() if len(lower) == 1 and lower <= set(floor.nodes) else None


def _sloping_beams(model: Model) -> Iterator[Diagnostic]:
    """Yield a warning for the only sloping beam of a property set with at least two horizontal beams and no
    column.
    """
    for members in members_by_set(model).values():
        flat = [e for e in members if is_horizontal(model, e)]
        others = [e for e in members if not is_horizontal(model, e)]
        if len(others) != 1 or len(flat) < 2:
            continue
        (e,) = others
        assert e.j is not None
        i, j = model.nodes[e.i], model.nodes[e.j]
        slope = math.degrees(math.atan2(abs(j.y - i.y), abs(j.x - i.x)))
        if slope < 45.0:
            message = f"member {e.id} slopes by {slope:.3g} degrees, all others of {e.prop} lie"
            hint = f"correct its nodes, {e.i} and {e.j}, or their heights under NODES"
            yield _warn("P375", message, e.span, hint)


def _inclined_dashpots(model: Model) -> Iterator[Diagnostic]:
    """Yield warnings for dashpots along X alone between nodes on a slope, as in a brace, once per property
    set.
    """
    reported = set[str]()
    for e in model.elements.values():
        card = model.props[e.prop]
        if (
            e.j is None
            or card.spec.name != "DASHPOT"
            or e.prop in reported
            or card["ANGLE"] not in (None, 0.0)
        ):
            continue
        i, j = model.nodes[e.i], model.nodes[e.j]
        slope = math.degrees(math.atan2(abs(j.y - i.y), abs(j.x - i.x)))
        if card["CX"] and not card["CY"] and MIN_BRACE_SLOPE < slope < MAX_BRACE_SLOPE:
            reported.add(e.prop)
            message = f"dashpot {e.id} acts along X, but its nodes lie on a slope of {slope:.3g} degrees"
            hint = "ANGLE=MEMBER lets it act along the line between them"
            yield _warn("P378", message, card.place("CX"), hint)


def _short_columns(structure: Structure) -> Iterator[Diagnostic]:
    """Yield warnings for columns between floors far shorter than the others of their property set."""
    model = structure.model
    floors = {n for b in buildings(structure) for floor in b.floors for n in floor.nodes}
    for label, members in members_by_set(model).items():
        high = [e for e in members if model.nodes[e.i].x == model.nodes[e.j or e.i].x]
        short = [e for e in high if {e.i, e.j} <= floors]
        if not short:
            continue
        e, middle = min(short, key=lambda e: length(model, e)), median(length(model, e) for e in high)
        height, unit = length(model, e), model.units.length
        if height < MIN_COLUMN_LENGTH_RATIO * middle:
            message = f"column {e.id} is {height:.3g} {unit} high, others of {label} {middle:.3g} {unit}"
            hint = f"correct the height of node {e.i} or {e.j} under NODES"
            yield _warn("P353", message, e.span, hint)
