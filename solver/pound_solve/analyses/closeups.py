"""Close-ups: the motion at the instants of the method while a contact is pressed, and at every peak of its
force.  A stored history thus resolves collisions even if its samples are coarse.

If the memory limit is reached, every second instant of all collisions is dropped, repeatedly if needed. The
largest force peak of each collision is always kept.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from pound_solve.integrate.protocol import Course, Motion
from pound_solve.numerics.crests import NODES, crests, on_nodes
from pound_solve.numerics.types import Array, Flags, Index

FOR_PEAKS: Final = 0.25  #: fraction of the memory reserved for force peaks
MEGABYTE: Final = 10**6  #: of `OUTPUT CLOSEUPS`
BLOCK: Final = 1024  #: largest number of instants per block


@dataclass(frozen=True, eq=False)
class ContactPeaks:
    """The motion at peaks of the contact forces.

    Attributes
    ----------
    motion : Motion
    contact, collision : ndarray of int, shape (n_peaks,)
        Number of the contact, and of the collision in this contact.
    height : ndarray, shape (n_peaks,)
        The force [F].
    at_step : ndarray of bool, shape (n_peaks,)
        Whether the peak lies at an instant of the method.
    """

    motion: Motion
    contact: Index
    collision: Index
    height: Array
    at_step: Flags

    def at(self, chosen: Index | Flags) -> ContactPeaks:
        """Return the chosen peaks."""
        return ContactPeaks(
            _at(self.motion, chosen),
            self.contact[chosen],
            self.collision[chosen],
            self.height[chosen],
            self.at_step[chosen],
        )

    def largest(self) -> ContactPeaks:
        """Return the largest peak of each collision."""
        order = np.lexsort((self.height, self.collision, self.contact))
        last = np.append(np.diff(self.contact[order]) | np.diff(self.collision[order]) != 0, True)
        return self.at(np.sort(order[last]))


class Closeups:
    """The motion at instants of collisions, within a memory limit.

    Parameters
    ----------
    contacts : ndarray of int
        Rows of the contacts in `Motion.law_forces`.
    room : int
        Largest number of instants kept.

    Attributes
    ----------
    every : int
        One in `every` instants of collisions is kept.
    full : float
        Time after which peaks were dropped too; infinite if every collision has its peak [T].
    """

    def __init__(self, contacts: Index, room: int) -> None:
        self.contacts, self.room = contacts, room
        self.every, self.full = 1, np.inf
        self._instants: list[Motion] = []
        self._peaks: list[ContactPeaks] = []
        self._seen = 0
        self._pressed = np.zeros(len(contacts), bool)
        self._collisions = np.zeros(len(contacts), np.int64)

    def blank(self) -> Closeups:
        """Return empty close-ups of the same contacts."""
        return Closeups(self.contacts, self.room)

    def widen(self, other: Closeups) -> None:
        """Include the contents of other close-ups."""
        self._instants += other._instants
        self.every, self.full = max(self.every, other.every), min(self.full, other.full)
        for peaks in other._peaks:
            self._keep(replace(peaks, collision=peaks.collision + 1 + self._collisions[peaks.contact]))
        self._collisions = self._collisions + 1 + other._collisions
        self._thin()

    def take(self, course: Course) -> None:
        """Keep the instants and force peaks of collisions."""
        forces = course.motion.law_forces[self.contacts]
        pressed = forces != 0.0
        before = np.column_stack([self._pressed, pressed[:, :-1]])
        collisions = self._collisions[:, None] + np.cumsum(pressed & ~before, axis=1)
        self._pressed, self._collisions = pressed[:, -1].copy(), collisions[:, -1]
        any_ = pressed.any(axis=0)
        if self.room == 0 or not any_.any():
            return
        near = any_.copy()  # with one instant before and after
        near[1:] |= any_[:-1]
        near[:-1] |= any_[1:]
        chosen = np.flatnonzero(near)
        number = self._seen + np.arange(len(chosen))
        self._seen += len(chosen)
        self._instants.append(_at(course.motion, chosen[number % self.every == 0]))
        self._keep(self._peaks_of(course, forces, collisions))
        self._thin()

    def _keep(self, peaks: ContactPeaks) -> None:
        """Keep peaks; if there are too many, only the largest of each collision."""
        if self.full < np.inf:
            return
        self._peaks.append(peaks)
        most = int(FOR_PEAKS * self.room)
        if sum(len(p.height) for p in self._peaks) > most:
            whole = joined_peaks(self._peaks).largest()
            self.full = float(whole.motion.t[most:].min(initial=np.inf))
            self._peaks = [whole.at(np.arange(min(most, len(whole.height))))]

    def _thin(self) -> None:
        """Drop every second instant while there are too many."""
        most = max(int((1.0 - FOR_PEAKS) * self.room), 1)
        while sum(len(m.t) for m in self._instants) > most:
            whole = _joined(self._instants)
            self._instants = [_at(whole, np.arange(0, len(whole.t), 2))]
            self.every *= 2

    def _peaks_of(self, course: Course, forces: Array, collisions: Index) -> ContactPeaks:
        """Return the motion at the peaks of the contact forces: at an instant or, if the course provides
        the motion between instants, between two instants.
        """
        wide = np.pad(forces, ((0, 0), (1, 1)), constant_values=-np.inf)
        row, top = np.nonzero((forces > 0.0) & (forces >= wide[:, :-2]) & (forces > wide[:, 2:]))
        at_instants = np.ones(len(row), bool)
        peaks = ContactPeaks(
            _at(course.motion, top), row, collisions[row, top], forces[row, top], at_instants
        )
        if course.within is None or not len(row):
            return peaks
        cells = np.unique(np.concatenate([top, np.maximum(top - 1, 0)]))
        motion = course.within(cells, NODES)
        forces_within = motion.law_forces[self.contacts].reshape(len(forces), len(cells), -1)
        sides = [np.searchsorted(cells, c) for c in (top, np.maximum(top - 1, 0))]
        (high, place), (high_before, place_before) = (crests(forces_within[row, cell]) for cell in sides)
        earlier = high_before > high
        chosen = np.where(earlier, sides[1], sides[0])
        place = np.where(earlier, place_before, place)
        inner = (place > 0.0) & (place < 1.0)
        chosen, place = chosen[inner], place[inner]
        t = course.motion.t[cells[chosen]] + place * course.lengths[cells[chosen]]
        weights = on_nodes(place)

        def at(x: Array) -> Array:
            return np.asarray((x.reshape(len(x), len(cells), -1)[:, chosen] * weights).sum(axis=2))

        between = replace(
            peaks.at(inner),
            motion=Motion(t, *map(at, motion[1:])),
            height=np.maximum(high, high_before)[inner],
            at_step=np.zeros(len(t), bool),
        )
        return joined_peaks([peaks.at(~inner), between])

    def nearest(self, t: float) -> Motion | None:
        """Return the kept instant nearest to a time; None if none is kept."""
        kept = [*self._instants, *(peaks.motion for peaks in self._peaks)]
        near = [_at(m, np.array([np.argmin(np.abs(m.t - t))])) for m in kept if len(m.t)]
        return min(near, key=lambda motion: abs(float(motion.t[0]) - t), default=None)

    def blocks(self) -> Iterator[Motion]:
        """Yield the kept instants and peaks, in order of time."""
        kept = list(self._instants)
        if self._peaks:
            peaks = joined_peaks(self._peaks)
            # drops peaks at instants when all instants are kept
            kept.append(
                peaks.at(~peaks.at_step if self.every == 1 else np.ones(len(peaks.at_step), bool)).motion
            )
        if kept:
            whole = _joined(kept)
            whole = _at(whole, np.argsort(whole.t, kind="stable"))
            for first in range(0, len(whole.t), BLOCK):
                yield _at(whole, np.arange(first, min(first + BLOCK, len(whole.t))))


def joined_peaks(parts: Sequence[ContactPeaks]) -> ContactPeaks:
    """Concatenate several sets of peaks."""
    rest = zip(*((p.contact, p.collision, p.height, p.at_step) for p in parts))
    return ContactPeaks(_joined([p.motion for p in parts]), *map(np.concatenate, rest))


def _at(motion: Motion, chosen: Index | Flags) -> Motion:
    """Return the motion at the chosen instants."""
    return Motion(*(x[..., chosen] for x in motion))


def _joined(motions: Sequence[Motion]) -> Motion:
    """Concatenate several motions."""
    return Motion(*(np.concatenate(x, axis=-1) for x in zip(*motions)))
