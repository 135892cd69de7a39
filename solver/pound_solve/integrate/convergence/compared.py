"""What the runs of AUTO are compared by: the largest and smallest value of every drift and the peak force
of every contact.

Each is relative to the larger magnitude of its own, but at least to `FLOOR` times the largest of its
kind: a contact that is hardly touched does not set the step.  Without drifts, by the deformations of all
springs in the same way, and by all displacements relative to the largest in their direction.  Where they
have a tolerance, by the accelerations of the nodes and the forces of the members that OUTPUT names, too,
relative to the largest of their kind.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from pound_solve.integrate.convergence.replay import Replay
from pound_solve.integrate.tracker import Extreme, Peaks
from pound_solve.numerics.types import Array, Index
from pound_solve.structure.reduction import ReducedSystem

FLOOR = 0.05  #: share of the largest peak of its kind that a peak is measured against at least
BRIEF = 0.05  #: share of a collision below which it is not asked how fast its force rises
RESPONSE, ALL = "RESPONSE", "ALL"  #: what TOL is for
DRIFTS, ACCELERATIONS, FORCES = range(3)  #: what tolerances are for
NAMES = ("drifts and contact forces", "accelerations", "member forces")


def tolerances(options: Mapping[str, Any]) -> dict[int, float]:
    """The tolerance of each kind of peaks that has one, by the items of AUTO."""
    tol, every = float(options["TOL"]), options.get("PEAKS", RESPONSE) == ALL
    own = {ACCELERATIONS: options.get("TOL_ACCELERATION"), FORCES: options.get("TOL_MEMBER")}
    asked = {kind: float(tol if x is None else x) for kind, x in own.items() if x is not None or every}
    return {DRIFTS: tol, **asked}


class Peak(NamedTuple):
    """Values that are compared between runs, the scales of their differences, and the kind of each: which
    tolerance it has.
    """

    values: Array
    scales: Array
    kinds: Index


def measured(extremes: Sequence[Extreme], kinds: Sequence[str]) -> Peak:
    """Extremes, each relative to its own size, but at least to `FLOOR` times the largest of its kind."""
    values = np.array([(e.high, e.low) for e in extremes]).reshape(-1, 2)
    size = np.abs(values).max(axis=1, initial=0.0)
    return Peak(values.ravel(), np.repeat(_floored(size, np.array(kinds)), 2), _all(DRIFTS, 2 * len(size)))


def _all(kind: int, count: int) -> Index:
    return np.full(count, kind)


def _floored(size: Array, kinds: Array, share: float = FLOOR) -> Array:
    """Sizes, but at least a share of the largest of their kind."""
    out = size.copy()
    for kind in np.unique(kinds):
        own = kinds == kind
        out[own] = np.maximum(out[own], share * out[own].max())
    return out


def figures(system: ReducedSystem, peaks: Peaks, replay: Replay, asked: Collection[int] = ()) -> Peak:
    """Return the peaks that are compared between runs: those of the kind DRIFTS, and others `asked` for."""
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
        parts.append(Peak(displacement.ravel(), np.repeat(largest, 2), _all(DRIFTS, displacement.size)))
    if ACCELERATIONS in asked or FORCES in asked:
        values, units = replay.seen(system)
        kinds = np.array([ACCELERATIONS if unit == "acceleration" else FORCES for unit in units], int)
        wanted = np.isin(kinds, list(asked))
        scales = _floored(np.abs(values), np.array(units), 1.0)
        parts.append(Peak(values[wanted], scales[wanted], kinds[wanted]))
    parts.append(Peak(force, _floored(force, np.zeros(len(force))), _all(DRIFTS, len(force))))
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
