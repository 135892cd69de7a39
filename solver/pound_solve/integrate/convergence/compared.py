"""What the runs of AUTO are compared by: the largest and smallest value of every drift and the peak force
of every contact.

Each is relative to the larger magnitude of its own, but at least to `FLOOR` times the largest of its
kind: a contact that is hardly touched does not set the step.  Without drifts, by the deformations of all
springs in the same way, and by all displacements relative to the largest in their direction.  With
PEAKS=ALL, by the accelerations of the nodes and the forces of the members that OUTPUT names, too,
relative to the largest of their kind.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pound_solve.integrate.convergence.replay import Replay
from pound_solve.integrate.tracker import Extreme, Peaks
from pound_solve.numerics.types import Array
from pound_solve.structure.reduction import ReducedSystem

FLOOR = 0.05  #: share of the largest peak of its kind that a peak is measured against at least
BRIEF = 0.05  #: share of a collision below which it is not asked how fast its force rises
RESPONSE, ALL = "RESPONSE", "ALL"  #: what TOL is for


class Peak(NamedTuple):
    """Values that are compared between runs, and the scales of their differences."""

    values: Array
    scales: Array


def measured(extremes: Sequence[Extreme], kinds: Sequence[str]) -> Peak:
    """Extremes, each relative to its own size, but at least to `FLOOR` times the largest of its kind."""
    values = np.array([(e.high, e.low) for e in extremes]).reshape(-1, 2)
    size = np.abs(values).max(axis=1, initial=0.0)
    return Peak(values.ravel(), np.repeat(_floored(size, np.array(kinds)), 2))


def _floored(size: Array, kinds: Array, share: float = FLOOR) -> Array:
    """Sizes, but at least a share of the largest of their kind."""
    out = size.copy()
    for kind in np.unique(kinds):
        own = kinds == kind
        out[own] = np.maximum(out[own], share * out[own].max())
    return out


def figures(system: ReducedSystem, peaks: Peaks, replay: Replay, asked: str = RESPONSE) -> Peak:
    """Return the peaks that are compared between runs, and the scales of their differences."""
    laws = system.structure.laws
    contacts = [i for i, s in enumerate(laws) if s.role.collides]
    force = np.array([max((c.peak for c in peaks.collisions if c.law == i), default=0.0) for i in contacts])
    parts = [measured(peaks.monitored, ["drift"] * len(peaks.monitored))]
    if not peaks.monitored:
        springs = [(e, s.unit) for e, s in zip(peaks.deformation, laws) if not s.role.collides]
        parts.append(measured([e for e, _ in springs], [unit for _, unit in springs]))
        direction = np.array([d for _, d in system.dofs])
        displacement = np.column_stack([np.ravel(replay.high), np.ravel(replay.low)])
        # hinges and uplift have directions of their own
        largest = _floored(np.abs(displacement).max(axis=1), direction, 1.0)
        parts.append(Peak(displacement.ravel(), np.repeat(largest, 2)))
    if asked == ALL:
        values, kinds = replay.seen(system)
        parts.append(Peak(values, _floored(np.abs(values), np.array(kinds), 1.0)))
    parts.append(Peak(force, _floored(force, np.zeros(len(force)))))
    return Peak(*(np.concatenate(x) for x in zip(*parts)))


def hardest(peaks: Peaks) -> float:
    """Return how long the collision of the largest force lasts [T], or twice the time in which that rises
    where this is less; infinite without collisions.

    A long collision may reach its peak early, by a mode that is faster than the whole: steps have to follow
    that.  A force that is largest at once jumps, by a dashpot, which a located event resolves.
    """
    found = max(peaks.collisions, key=lambda c: c.peak, default=None)
    if found is None or not found.t_end > found.t_start:  # it is still closed
        return np.inf
    lasts, rises = found.t_end - found.t_start, found.t_peak - found.t_start
    return min(lasts, max(2.0 * rises, BRIEF * lasts)) if rises > 0.0 else lasts
