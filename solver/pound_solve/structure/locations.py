"""Places in buildings in words: ``A, column 2 foot`` in storey 2, ``A, beam 3 left`` of floor 3."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pound_deck.model import Model
from pound_solve.structure.buildings import SAME_LEVEL, Building

STEEP = 0.5  #: least vertical component of the direction of a column


def member_end(model: Model, buildings: Sequence[Building], element: int, end: str) -> str:
    """Words for an end of a member, ``I`` or ``J``, or for the whole element if `end` is empty.

    Empty for an element outside the storeys of all buildings.  The end of a column between two floors is
    named by its height.
    """
    e = model.elements[element]
    first, second = model.nodes[e.i], model.nodes[e.i if e.j is None else e.j]
    building = next((b for b in buildings if e.i in b.nodes and b.floors), None)
    if building is None:
        return ""
    along, up = second.x - first.x, second.y - first.y
    length = math.hypot(along, up)
    here, other = (first, second) if end != "J" else (second, first)
    if length > 0.0 and abs(up) >= STEEP * length:
        return _column(building, here.y, other.y, bool(end), model.units.length)
    floor = min(range(len(building.levels)), key=lambda n: abs(building.levels[n] - here.y))
    words = f"{'beam' if length else 'floor'} {floor}" if floor else "base"
    side = "" if not (length and end) else " left" if here.x < other.x else " right"
    return f"{building.name}, {words}{side}"


def _column(building: Building, y: float, other: float, ends: bool, unit: str) -> str:
    """Words for a column from a height to another, and for its end at the first, if `ends`."""
    storey = sum(level < 0.5 * (y + other) for level in building.levels)
    if not 1 <= storey <= len(building.floors):
        return ""
    words = f"{building.name}, column {storey}"
    if not ends:
        return words
    foot, head = building.levels[storey - 1 : storey + 1]
    near = SAME_LEVEL * (building.levels[-1] - building.base)
    place = next((word for word, level in (("foot", foot), ("head", head)) if abs(y - level) <= near), "")
    return f"{words} {place or f'at {y:.4g} {unit}'}"
