"""``/history/ground`` and ``/history/force``: ground accelerations and forces in time."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from pound_solve.results.schema import History, HistoryLayout

if TYPE_CHECKING:
    from pound_solve.analyses.recorder import RecordedItems, SampleBlock
    from pound_solve.numerics.types import Array


def ground_layout(items: RecordedItems) -> HistoryLayout:
    """One column for each motion."""
    motions = items.system.motions
    return HistoryLayout(
        (len(motions),),
        {
            "labels": [f"{i + 1} {m.direction}" for i, m in enumerate(motions)],
            "unit": ["rad/T^2" if m.direction == "R" else "L/T^2" for m in motions],
        },
    )


def ground(block: SampleBlock) -> Array:
    """Accelerations, shape (n_times, n_motions)."""
    motions = block.items.system.motions
    accelerations = np.empty((len(block.t), len(motions)))
    for column, motion in zip(accelerations.T, motions):
        column[:] = motion.acceleration.value(block.t)
    return accelerations


def force_layout(items: RecordedItems) -> HistoryLayout:
    """One column for each card of FORCES."""
    forces = items.system.forces
    return HistoryLayout(
        (len(forces),), {"labels": [f"{i + 1} {f.info['kind']}" for i, f in enumerate(forces)]}
    )


def forces(block: SampleBlock) -> Array:
    """Forces in time, which are the last of the inputs, shape (n_times, n_forces)."""
    return block.inputs[len(block.inputs) - len(block.items.system.forces) :].T


GROUND = History(
    name="ground",
    place=100,
    row="motions",
    doc="ground accelerations, scaled",
    layout=ground_layout,
    values=ground,
    axes=MappingProxyType({"motion": "labels"}),
)
FORCE = History(
    name="force",
    place=110,
    row="forces",
    doc="histories of FORCES, in the order of the deck",
    layout=force_layout,
    values=forces,
    axes=MappingProxyType({"load": "labels"}),
)
