"""``/history/drift``: the drifts that the deck requests."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from pound_solve.results.schema import History, HistoryLayout

if TYPE_CHECKING:
    from pound_solve.analyses.recorder import RecordedItems, SampleBlock
    from pound_solve.numerics.types import Array


def layout(items: RecordedItems) -> HistoryLayout:
    """One column for each drift."""
    names = list(items.drifts.names)
    return HistoryLayout((len(names),), {"labels": names, "unit": "L"})


def values(block: SampleBlock) -> Array:
    """Drifts, shape (n_times, n_drifts)."""
    d = block.items.drifts
    drifts: Array = (d.rows @ block.u + d.input_rows @ block.inputs + d.constants[:, None]).T
    return drifts


DRIFT = History(
    name="drift",
    place=90,
    row="drifts",
    doc="drifts in the order of the deck",
    layout=layout,
    values=values,
    axes=MappingProxyType({"drift_name": "labels"}),
    closeup=True,
)
