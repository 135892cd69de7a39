"""Extremes within intervals of time: the intervals that find room, and what belongs to each."""

import numpy as np
import pytest

from pound_solve.analyses.extremes import BYTES, IntervalExtremes, intervals


@pytest.mark.parametrize(
    ("samples", "count", "room", "bounds"),
    [
        (2, 3, BYTES * 3, [0, 1]),  # the whole history is one interval
        (6, 3, BYTES * 3 * 5, [0, 1, 2, 3, 4, 5]),  # all fit, to the byte
        (6, 3, BYTES * 3 * 5 - 1, [0, 2, 4, 5]),
        (6, 3, BYTES * 3 * 2, [0, 4, 5]),
        (6, 3, BYTES * 3, [0, 5]),
        (6, 3, BYTES * 3 - 1, []),
        (1, 3, 1e6, []),
        (6, 0, 1e6, []),  # nothing to store
    ],
)
def test_intervals_are_joined_by_twos_until_they_find_room(samples, count, room, bounds):
    """An interval takes `BYTES` for each quantity; the last one may be shorter."""
    assert intervals(np.arange(float(samples)), count, room).tolist() == bounds


def test_an_instant_between_two_intervals_belongs_to_both():
    """Three intervals of one second; values at their ends and in the middle one."""
    found = IntervalExtremes(np.array([0.0, 1.0, 2.0, 3.0]), 1)
    found.take(np.array([[1.0, 5.0, -4.0, 2.0]]), np.array([0.0, 1.0, 1.5, 2.0]))
    assert found.high.tolist() == [[5.0, 5.0, 2.0]]
    assert found.low.tolist() == [[1.0, -4.0, 2.0]]
    found.take(np.array([[7.0]]), np.array([3.0]))
    assert found.high.tolist() == [[5.0, 5.0, 7.0]] and found.low.tolist() == [[1.0, -4.0, 2.0]]


def test_some_quantities_may_be_counted_in_alone():
    """The others stay as nothing had been seen, as all are in a blank one."""
    found = IntervalExtremes(np.array([0.0, 1.0, 2.0]), 3)
    found.take(np.array([[3.0, 4.0], [-1.0, -2.0]]), np.array([0.5, 1.5]), np.array([2, 0]))
    nothing = [-np.inf, -np.inf]
    assert found.high.tolist() == [[-1.0, -2.0], nothing, [3.0, 4.0]]
    found.take_tops(np.array([1, 0]), np.array([1.0, -1.0]), np.array([9.0, 8.0]), np.array([0.2, 1.2]))
    assert found.high.tolist() == [[-1.0, -2.0], [9.0, -np.inf], [3.0, 4.0]]
    assert found.low.tolist()[0] == [-1.0, -8.0]  # a top of the negative is the smallest value
    blank = found.blank()
    assert np.isposinf(blank.low).all() and blank.high.shape == (3, 2)
    blank.widen(found)
    assert (blank.high == found.high).all() and (blank.low == found.low).all()
