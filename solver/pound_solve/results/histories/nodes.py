"""``/history/node``: displacements, velocities and accelerations of the nodes."""

from __future__ import annotations

from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING

from pound_solve.results.schema import History, HistoryLayout

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pound_solve.analyses.recorder import RecordedItems, SampleBlock
    from pound_solve.numerics.types import Array


def layout(nodes: Sequence[int], per: str) -> HistoryLayout:
    """Layout of three values for each node; `per` ends their unit, as ``/T`` for velocities."""
    units = [f"{dimension}{per}" for dimension in ("L", "L", "rad")]
    return HistoryLayout((len(nodes), 3), {"nodes": tuple(nodes), "labels": ["X", "Y", "R"], "unit": units})


def recorded(per: str, items: RecordedItems) -> HistoryLayout:
    """Layout for the recorded nodes."""
    return layout(items.nodes, per)


def values(quantity: str, block: SampleBlock) -> Array:
    """Motion of the nodes, shape (n_times, n_nodes, 3)."""
    return block.nodes[quantity].T.reshape(len(block.t), len(block.items.nodes), 3)


AXES = MappingProxyType({"node": "nodes", "component": "labels"})


def _motion(place: int, quantity: str, per: str, doc: str) -> History:
    return History(
        name=f"node/{quantity}",
        place=place,
        row="nodes x 3",
        doc=doc,
        layout=partial(recorded, per),
        values=partial(values, quantity),
        axes=AXES,
        closeup=True,
        extremes=True,
    )


DISPLACEMENT = _motion(10, "u", "", "displacement in X, Y and rotation")
VELOCITY = _motion(20, "v", "/T", "velocity in X, Y and of rotation")
ACCELERATION = _motion(30, "a", "/T^2", "acceleration in X, Y and of rotation")
