"""``/history/building``, ``/history/storey``: forces on the ground, and the response of the storeys."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING

from pound_solve.results.schema import History, HistoryLayout

if TYPE_CHECKING:
    from pound_solve.analyses.recorder import RecordedItems, SampleBlock
    from pound_solve.numerics.types import Array

BASE = (("shear X", "F"), ("force Y", "F"), ("moment", "F*L"))  #: columns, with their dimensions


def of_buildings(items: RecordedItems) -> HistoryLayout:
    """Three columns for each building."""
    return base_layout([b.name for b in items.buildings])


def base_layout(buildings: Sequence[str]) -> HistoryLayout:
    """Layout for buildings of these names."""
    columns = [(b, quantity, unit) for b in buildings for quantity, unit in BASE]
    return HistoryLayout(
        (len(columns),),
        {
            "building": [b for b, _, _ in columns],
            "quantity": [q for _, q, _ in columns],
            "labels": [f"{b} {q}" for b, q, _ in columns],
            "unit": [u for _, _, u in columns],
        },
    )


def of_storeys(unit: str, items: RecordedItems) -> HistoryLayout:
    """One column for each storey."""
    from pound_solve.structure.storeys import storeys  # not needed to read a report

    return storey_layout(unit, [(b.name, i) for b, i in storeys(items.buildings)])


def storey_layout(unit: str, places: Sequence[tuple[str, int]]) -> HistoryLayout:
    """Layout for storeys, given as building names and storey numbers."""
    return HistoryLayout(
        (len(places),),
        {
            "building": [b for b, _ in places],
            "storey": [i for _, i in places],
            "labels": [f"{b} storey {i}" for b, i in places],
            "unit": unit,
        },
    )


def total(name: str, chosen: slice, block: SampleBlock) -> Array:
    """Part `chosen` of the recorded sums of forces called `name`, shape (n_times, n_chosen)."""
    return block.sums[name][chosen].T


def _storey(place: int, name: str, unit: str, doc: str, values: Callable[[SampleBlock], Array]) -> History:
    return History(
        name=f"storey/{name}",
        place=place,
        row="storeys",
        doc=doc,
        layout=partial(of_storeys, unit),
        values=values,
        axes=MappingProxyType({"building": "building", "storey": "storey"}),
        closeup=True,
        extremes=True,
    )


FORCE = History(
    name="building/base",
    place=42,
    row="buildings x 3",
    doc="force of each building on the ground along X and Y, and overturning moment",
    layout=of_buildings,
    values=partial(total, "base", slice(None)),
    axes=MappingProxyType({"building": "building", "component": "quantity"}),
    closeup=True,
    extremes=True,
)
DRIFT = _storey(43, "drift", "-", "drift ratios of the storeys", partial(total, "drift", slice(None)))
SHEAR = _storey(44, "shear", "F", "shears of the storeys", partial(total, "storey", slice(0, None, 2)))
MOMENT = _storey(
    45, "moment", "F*L", "overturning moments about the feet of the storeys",
    partial(total, "storey", slice(1, None, 2)),
)  # fmt: skip
ACCELERATION = _storey(
    46, "acceleration", "L/T^2", "total accelerations of the floors along X",
    partial(total, "acceleration", slice(None)),
)  # fmt: skip
