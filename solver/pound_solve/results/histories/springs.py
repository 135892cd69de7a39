"""``/history/spring``: forces and deformations of springs and hinges."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from pound_solve.results.schema import History, HistoryLayout

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pound_solve.analyses.recorder import RecordedItems


def layout(items: RecordedItems, units: Mapping[str, str]) -> HistoryLayout:
    """One column for each spring; `units` by the dimension of its force."""
    springs = [items.system.structure.laws[i] for i in items.springs]
    return HistoryLayout(
        (len(springs),),
        {
            "element": [s.element for s in springs],
            "quantity": [s.component for s in springs],
            "unit": [units[s.unit] for s in springs],
        },
    )


AXES = MappingProxyType({"spring": "element", "component": "quantity"})


FORCE = History(
    name="spring/force",
    place=70,
    row="components",
    doc="forces and moments of the springs",
    layout=lambda items: layout(items, {"F": "F", "F*L": "F*L"}),
    values=lambda block: block.force[list(block.items.springs)].T,
    axes=AXES,
)
DEFORMATION = History(
    name="spring/deformation",
    place=80,
    row="components",
    doc="deformations of the springs",
    layout=lambda items: layout(items, {"F": "L", "F*L": "rad"}),
    values=lambda block: block.deformation[list(block.items.springs)].T,
    axes=AXES,
    closeup=True,
)
