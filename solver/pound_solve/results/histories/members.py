"""``/history/member``: forces of the members."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from pound_solve.results.schema import History, HistoryLayout

if TYPE_CHECKING:
    from pound_solve.analyses.recorder import RecordedItems


def layout(items: RecordedItems) -> HistoryLayout:
    """One column for each force."""
    outputs = items.outputs
    return HistoryLayout(
        (len(outputs),),
        {
            "element": [o.element for o in outputs],
            "quantity": [o.quantity for o in outputs],
            "unit": [o.unit for o in outputs],
        },
    )


FORCE = History(
    name="member/force",
    place=40,
    row="quantities",
    doc="forces and moments of the members",
    layout=layout,
    values=lambda block: block.members.T,
    axes=MappingProxyType({"member": "element", "component": "quantity"}),
    closeup=True,
    extremes=True,
)
