"""What a derivative by a run depends on: the sequence of its events, its gentlest collision, its exactness.

A response is differentiable with respect to a variable as long as the sequence of events stays the same and
no collision grazes: at a grazing contact the derivative grows like the inverse of the approach speed.
"""

from __future__ import annotations

from hashlib import blake2b
from typing import NamedTuple

from pound_solve.results.record import RunRecord


class EventCourse(NamedTuple):
    """Events of a run.

    Attributes
    ----------
    sequence : str
        Digest of the contacts in the order of their collisions, and of the yield events of every spring;
        empty without a history.
    gentlest : float
        Smallest approach speed of a collision over the largest; 1 without collisions.
    exact : bool
        Whether the method has no error but rounding.
    """

    sequence: str = ""
    gentlest: float = 1.0
    exact: bool = True


def events_of(record: RunRecord) -> EventCourse:
    """Events of a run with a history."""
    if not record.responded:
        return EventCourse()
    peaks = record.history.returned.peaks
    collisions = sorted(peaks.collisions, key=lambda c: (c.t_start, c.law))
    speeds = [abs(c.approach) for c in collisions if c.approach > 0.0]
    order = repr(([c.law for c in collisions], peaks.yields))
    digest = blake2b(order.encode(), digest_size=12).hexdigest()
    gentlest = min(speeds) / max(speeds) if speeds else 1.0
    return EventCourse(digest, gentlest, record.history.returned.exact)
