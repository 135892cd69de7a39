"""Close-ups: the motion at the method's own instants while a contact is pressed, and at every peak of its
force, so that a stored history shows a collision as it was, however far apart its samples are.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pound_solve.integrate.protocol import Course, Motion
from pound_solve.numerics.crests import NODES, crests, on_nodes
from pound_solve.numerics.types import Array, Index

FOR_PEAKS = 0.25  #: share of the room that is kept for peaks of forces
MEGABYTE = 10**6  #: of `OUTPUT CLOSEUPS`
BLOCK = 1024  #: instants that are handed out at a time, at most


class Closeups:
    """Instants of collisions, of which there is room for some.

    Parameters
    ----------
    contacts : ndarray of int
        Rows of the contacts in `Motion.law_forces`.
    room : int
        Instants that are kept, at most.

    Attributes
    ----------
    full : float
        Time from which on only peaks were kept, or nothing; infinite where all were [T].
    """

    def __init__(self, contacts: Index, room: int) -> None:
        self.contacts, self.room = contacts, room
        self.full = np.inf
        self._kept: list[Motion] = []
        self._count = 0

    def blank(self) -> Closeups:
        """Return one that has seen nothing."""
        return Closeups(self.contacts, self.room)

    def widen(self, other: Closeups) -> None:
        """Count in what another one has kept."""
        self._kept += other._kept
        self._count, self.full = self._count + other._count, min(self.full, other.full)

    def take(self, course: Course) -> None:
        """Keep what belongs to collisions."""
        forces = course.motion.law_forces[self.contacts]
        pressed = (forces != 0.0).any(axis=0)
        if self.room == 0 or not pressed.any():
            return
        near = pressed.copy()  # with one instant before and after
        near[1:] |= pressed[:-1]
        near[:-1] |= pressed[1:]
        kept = [_at(course.motion, np.flatnonzero(near)), *self._peaks(course, forces)]
        limits = (1.0 - FOR_PEAKS) * self.room, self.room
        fitting = []
        for motion, limit in zip(kept, limits):
            count = max(min(len(motion.t), int(limit) - self._count), 0)
            if count < len(motion.t):
                self.full = min(self.full, float(motion.t[count]))
            fitting.append(_at(motion, np.arange(count)))
            self._count += count
        found = _joined(fitting)
        self._kept.append(_at(found, np.argsort(found.t, kind="stable")))

    def _peaks(self, course: Course, forces: Array) -> Iterator[Motion]:
        """The motion at the peaks of the forces that lie between the instants, if it is known there."""
        if course.within is None:
            return
        wide = np.pad(forces, ((0, 0), (1, 1)), constant_values=-np.inf)
        tops = (forces > 0.0) & (forces >= wide[:, :-2]) & (forces > wide[:, 2:])
        row, top = np.nonzero(tops)
        if not len(row):
            return
        cells = np.unique(np.concatenate([top, np.maximum(top - 1, 0)]))
        motion = course.within(cells, NODES)
        own = motion.law_forces[self.contacts].reshape(len(forces), len(cells), -1)
        sides = [np.searchsorted(cells, c) for c in (top, np.maximum(top - 1, 0))]
        (high, place), (high_before, place_before) = (crests(own[row, cell]) for cell in sides)
        earlier = high_before > high
        chosen = np.where(earlier, sides[1], sides[0])
        place = np.where(earlier, place_before, place)
        inner = (place > 0.0) & (place < 1.0)  # else it is an instant that is kept
        chosen, place = chosen[inner], place[inner]
        t = course.motion.t[cells[chosen]] + place * course.lengths[cells[chosen]]
        weights = on_nodes(place)

        def at(x: Array) -> Array:
            return np.asarray((x.reshape(len(x), len(cells), -1)[:, chosen] * weights).sum(axis=2))

        yield Motion(t, *map(at, motion[1:]))

    def blocks(self) -> Iterator[Motion]:
        """What was kept, in the order of time."""
        if self._count:
            whole = _joined(self._kept)
            whole = _at(whole, np.argsort(whole.t, kind="stable"))
            for first in range(0, len(whole.t), BLOCK):
                yield _at(whole, np.arange(first, min(first + BLOCK, len(whole.t))))


def _at(motion: Motion, chosen: Index) -> Motion:
    """Some of the instants."""
    return Motion(*(x[..., chosen] for x in motion))


def _joined(motions: list[Motion]) -> Motion:
    """The instants of all."""
    return Motion(*(np.concatenate(x, axis=-1) for x in zip(*motions)))
