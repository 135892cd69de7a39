"""The tracker of the response: extremes, collisions and yield events of a run, the same for every
method.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np

from pound_solve.laws.automaton import Branch, BranchKind
from pound_solve.numerics.types import Array
from pound_solve.structure.elements.base import LawSpring
from pound_solve.structure.reduction import ReducedSystem

MINOR_PEAK = 1e-3  #: fraction of the largest peak of its unit below which a peak is not examined


@dataclass
class Extreme:
    """Largest and smallest value of a quantity and their times."""

    high: float = -np.inf
    t_high: float = 0.0
    low: float = np.inf
    t_low: float = 0.0

    def take(self, value: float, t: float) -> None:
        """Count a value in."""
        if value > self.high:
            self.high, self.t_high = value, t
        if value < self.low:
            self.low, self.t_low = value, t


@dataclass
class Collision:
    """One collision, from touch to parting; a contact that is released and pressed again continues it."""

    law: int
    t_start: float
    approach: float
    t_end: float = np.nan
    separation: float = np.nan
    peak: float = 0.0
    t_peak: float = 0.0
    impulse: float = 0.0

    def count(self, force: float, t: float, impulse: float = 0.0) -> None:
        """Include a force at a time, and an impulse."""
        self.impulse += impulse
        if force > self.peak:
            self.peak, self.t_peak = force, t


@dataclass
class Peaks:
    """Results of a run that its samples do not show: extremes, collisions, yields, losses.

    Attributes
    ----------
    monitored : list of Extreme
        Extremes of the monitored outputs.
    deformation, force : list of Extreme
        Extremes of every law; for contacts, of the closure and the force (compression positive).
    collisions : list of Collision
        Finished collisions in the order of their ends, followed by those of contacts still closed.
    yields : list of int
        Yield events per law.
    dashpot_losses : list of float
        Energy lost in the dashpot of every law (contacts) [F L].
    between : float
        Largest fraction of a peak by which it exceeds all values at instants.
    """

    monitored: list[Extreme]
    deformation: list[Extreme]
    force: list[Extreme]
    yields: list[int]
    dashpot_losses: list[float]
    collisions: list[Collision] = field(default_factory=list)
    between: float = 0.0


class Peak(Protocol):
    """An object that keeps extremes, such as `Extreme`."""

    @property
    def high(self) -> float:
        """Largest value so far."""

    @property
    def low(self) -> float:
        """Smallest value so far."""

    def take(self, value: float, t: float) -> None:
        """Count a value in."""


class TrackedExtremes(NamedTuple):
    """Extremes of the tracked quantities in this order: monitored outputs, deformations of the laws, forces
    of the laws; shape (n_monitored + 2 n_laws,) each.

    Attributes
    ----------
    high, t_high, low, t_low : ndarray
        Largest and smallest value so far and their times.
    value, slope : ndarray
        Value and slope at the last instant that a method with steps tracked.
    steepest : ndarray
        Largest magnitude of the slope so far.
    reached : ndarray
        Largest magnitude at an instant; `high` and `low` may occur between two instants.
    """

    high: Array
    t_high: Array
    low: Array
    t_low: Array
    value: Array
    slope: Array
    steepest: Array
    reached: Array


class TrackedPeak:
    """Extremes of one tracked quantity."""

    def __init__(self, extremes: TrackedExtremes, i: int) -> None:
        self.extremes, self.i = extremes, i

    @property
    def high(self) -> float:
        """Largest value so far."""
        return float(self.extremes.high[self.i])

    @property
    def low(self) -> float:
        """Smallest value so far."""
        return float(self.extremes.low[self.i])

    def take(self, value: float, t: float) -> None:
        """Count a value in."""
        x, i = self.extremes, self.i
        if value > x.high[i]:
            x.high[i], x.t_high[i] = value, t
        if value < x.low[i]:
            x.low[i], x.t_low[i] = value, t
        x.reached[i] = max(x.reached[i], abs(value))


class CollisionPeak:
    """The largest force of a contact in its present collision."""

    low = -np.inf

    def __init__(self, collision: Collision) -> None:
        self.collision = collision

    @property
    def high(self) -> float:
        """Largest force so far."""
        return self.collision.peak

    def take(self, value: float, t: float) -> None:
        """Include a force."""
        self.collision.count(value, t)


class ResponseTracker:
    """Extremes, collisions and yield events during a run.

    Parameters
    ----------
    laws : sequence of LawSpring
    n_monitored : int

    Attributes
    ----------
    extremes : TrackedExtremes
        Kernels update its arrays directly, other methods through `monitored`, `deformation` and `force`.
    open : dict of Collision
        Collisions in progress, by law.
    """

    def __init__(self, laws: Sequence[LawSpring], n_monitored: int) -> None:
        self.laws, self.n_monitored = laws, n_monitored
        self.extremes = TrackedExtremes(*np.zeros((8, n_monitored + 2 * len(laws))))
        self.extremes.high[:], self.extremes.low[:] = -np.inf, np.inf
        self.open: dict[int, Collision] = {}
        self._ended: list[Collision] = []
        self._yields = [0] * len(laws)

    def monitored(self, i: int) -> TrackedPeak:
        """Return the extremes of a monitored output."""
        return TrackedPeak(self.extremes, i)

    def deformation(self, law: int) -> TrackedPeak:
        """Return the extremes of a law's deformation."""
        return TrackedPeak(self.extremes, self.n_monitored + law)

    def force(self, law: int) -> TrackedPeak:
        """Return the extremes of a law's force."""
        return TrackedPeak(self.extremes, self.n_monitored + len(self.laws) + law)

    def collision_force(self, law: int) -> CollisionPeak:
        """Return the largest force of a contact in its present collision."""
        return CollisionPeak(self.open[law])

    def begin(
        self, system: ReducedSystem, t: float, u: Array, v: Array, branches: Sequence[Branch]
    ) -> None:
        """Record the contacts that are closed at the start."""
        ex = system.excitation
        d = system.law_rows @ u + system.law_inputs @ ex.value(t)
        rate = system.law_rows @ v + system.law_inputs @ ex.value(t, 1)
        for i, (s, b) in enumerate(zip(self.laws, branches)):
            if s.role.collides and b.kind.closed:
                x, y = float(d[i]), float(rate[i])
                self.switched(i, BranchKind.OPEN, b.kind, t, x, y, b.force(x, y))

    def switched(
        self,
        law: int,
        before: BranchKind,
        after: BranchKind,
        t: float,
        d: float,
        v: float,
        force_after: float,
    ) -> None:
        """Record that a law changed to a branch of another kind at deformation `d` and rate `v`."""
        if not self.laws[law].role.collides:
            if after is BranchKind.YIELDING and before is not BranchKind.YIELDING:
                self._yields[law] += 1
            return
        was, now = before.closed, after.closed
        ended = self._last_ended(law) if before is BranchKind.RELEASED and now else None
        if ended is not None:
            # the bodies never parted: the collision continues
            again = self._ended.pop(ended)
            again.t_end = again.separation = np.nan
            self.open[law] = again
        elif now and not was and law not in self.open:
            self.open[law] = Collision(law, t, v, peak=force_after, t_peak=t)
        elif was and not now and law in self.open:
            done = self.open.pop(law)
            done.t_end, done.separation = t, -v
            self._ended.append(done)

    def _last_ended(self, law: int) -> int | None:
        """Return the index of the contact's last collision, which is usually near the end of the list."""
        collisions = self._ended
        return next((i for i in reversed(range(len(collisions))) if collisions[i].law == law), None)

    def close(self, dashpot_losses: Array) -> Peaks:
        """Return the results; collisions of contacts that are still closed come last.

        Parameters
        ----------
        dashpot_losses : ndarray, shape (n_laws,)
        """
        x, n, first = self.extremes, len(self.laws), self.n_monitored
        four = zip(*(a.tolist() for a in (x.high, x.t_high, x.low, x.t_low)))
        extremes = [Extreme(*numbers) for numbers in four]
        collisions = [*self._ended, *(self.open[law] for law in sorted(self.open))]
        return Peaks(
            extremes[:first],
            extremes[first : first + n],
            extremes[first + n :],
            list(self._yields),
            dashpot_losses.tolist(),
            collisions,
            self._between(),
        )

    def _between(self) -> float:
        """Return the largest fraction of a peak by which it exceeds all values at instants.  Peaks far
        below the largest of their unit do not count.
        """
        x = self.extremes
        units = [law.unit for law in self.laws]
        kinds = np.array(["drift"] * self.n_monitored + [f"along {u}" for u in units] + units)
        size = np.maximum(np.maximum(x.high, -x.low), 0.0)
        share = np.divide(size - x.reached, size, out=np.zeros(len(size)), where=size > 0.0)
        for kind in np.unique(kinds):
            alike = kinds == kind
            share[alike & (size < MINOR_PEAK * size[alike].max())] = 0.0
        return float(share.max(initial=0.0))
