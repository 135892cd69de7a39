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
NODES = (1, 2, 3, 4, 100, 101, 102, 300, 301, 302)  #: of the sample

DISPLACEMENT = History(
    name="node/u",
    place=10,
    row="nodes x 3",
    doc="displacement in X, Y and rotation",
    layout=partial(recorded, ""),
    values=partial(values, "u"),
    sample=layout(NODES, ""),
    axes=AXES,
    closeup=True,
    extremes=True,
)
VELOCITY = History(
    name="node/v",
    place=20,
    row="nodes x 3",
    doc="velocity in X, Y and of rotation",
    layout=partial(recorded, "/T"),
    values=partial(values, "v"),
    sample=layout(NODES, "/T"),
    axes=AXES,
    closeup=True,
    extremes=True,
)
ACCELERATION = History(
    name="node/a",
    place=30,
    row="nodes x 3",
    doc="acceleration in X, Y and of rotation",
    layout=partial(recorded, "/T^2"),
    values=partial(values, "a"),
    sample=layout(NODES, "/T^2"),
    axes=AXES,
    closeup=True,
    extremes=True,
)
