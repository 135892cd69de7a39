"""``/history/reaction``: forces of the supports on the structure."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from pound_solve.results.schema import History, HistoryLayout

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pound_solve.analyses.recorder import RecordedItems, SampleBlock
    from pound_solve.numerics.types import Array


def layout(supports: Sequence[int]) -> HistoryLayout:
    """Three values for each support."""
    unit = ["F", "F", "F*L"]
    return HistoryLayout(
        (len(supports), 3), {"nodes": tuple(supports), "labels": ["FX", "FY", "MZ"], "unit": unit}
    )


def recorded(items: RecordedItems) -> HistoryLayout:
    """Layout for the recorded supports."""
    return layout(items.supports)


def values(block: SampleBlock) -> Array:
    """Reactions, shape (n_times, n_supports, 3)."""
    return block.sums["reaction"].T.reshape(len(block.t), len(block.items.supports), 3)


HISTORY = History(
    name="reaction",
    place=41,
    row="supports x 3",
    doc="forces of the supports on the structure: X, Y and moment",
    layout=recorded,
    values=values,
    axes=MappingProxyType({"support": "nodes", "action": "labels"}),
    closeup=True,
    extremes=True,
)
