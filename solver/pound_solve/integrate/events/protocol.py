"""Result of every locator of events: a `LocatedEvent`.

A law leaves its branch when one of its event functions ``a d + b v + c`` of deformation and rate rises
through zero.  Three locators find the earliest such instant: on a grid of samples with bounds (`grid`, for
methods with a closed form), within a step (`within_step`, for methods with steps), and by isolation of
polynomial roots (`polynomial_roots`, for power series).
"""

from __future__ import annotations

from typing import NamedTuple

#: points before the event of another law at which a contact's event function is evaluated
CONTACT_SAMPLES = 9


class LocatedEvent(NamedTuple):
    """The instant at which an event function of a law rises through zero.

    Attributes
    ----------
    law : int
    event_index : int
        Index of the event function on the law's present branch.
    time : float
        Time since the start of the searched window or step [T]; for a series, in lengths of its step.
    """

    law: int
    event_index: int
    time: float


def earlier(first: LocatedEvent, law: int, event_index: int, at: float) -> LocatedEvent:
    """Return `first`, or the event of `law` at the time `at` if `at` is not negative and earlier."""
    sooner = at >= 0.0 and (first.law < 0 or at < first.time)
    return LocatedEvent(law, event_index, at) if sooner else first


def no_event(end: float) -> LocatedEvent:
    """Return an event with law -1: none up to the time `end`.  Compiled code needs one type."""
    return LocatedEvent(-1, -1, end)
