"""Numbers and rows as ranges: ``11 to 13``, ``1001 to 1601 by 100``."""

from __future__ import annotations

from collections.abc import Sequence

Cell = str | int | float
CLOSE = 1e-9  #: fraction of the larger of two numbers by which steps of one range may differ


def numbers(values: Sequence[int]) -> str:
    """Text of whole numbers in their order; three or more in equal steps, or two in a row, as a range."""
    ranges, i = list[str](), 0
    while i < len(values):
        end = _run(values, i)
        if end - i > 2 or (end - i == 2 and values[i + 1] - values[i] == 1):
            ranges.append(between(values[i], values[end - 1], values[i + 1] - values[i]))
        else:
            end = i + 1
            ranges.append(str(values[i]))
        i = end
    return ", ".join(ranges)


def between(first: int, last: int, step: int) -> str:
    """Text of a range of whole numbers."""
    return f"{first} to {last}" + (f" by {step}" if abs(step) != 1 else "")


def _run(values: Sequence[int], start: int) -> int:
    """End of the run of equal steps that begins at index `start`, exclusive."""
    end = min(start + 2, len(values))
    while end < len(values) and values[end] - values[end - 1] == values[start + 1] - values[start] != 0:
        end += 1
    return end


def stepping(rows: Sequence[tuple[Cell, ...]]) -> list[tuple[tuple[Cell, ...], tuple[Cell, ...], int]]:
    """Group rows into ranges in which texts stay the same and numbers step evenly; return first row, last
    row and number of rows of each.

    Two rows are a range only if the first column steps by one and at most one other real number changes.
    """
    ranges, i = [], 0
    while i < len(rows):
        end = i + 1
        while end < len(rows) and _continues(rows, i, end):
            end += 1
        if end - i == 2 and not _neighbours(rows[i], rows[i + 1]):
            end = i + 1
        ranges.append((rows[i], rows[end - 1], end - i))
        i = end
    return ranges


def _continues(rows: Sequence[tuple[Cell, ...]], start: int, at: int) -> bool:
    """Whether row `at` continues the steps of the range that begins with row `start`."""
    first, second, before, row = rows[start], rows[start + 1], rows[at - 1], rows[at]
    return first[0] != second[0] and all(map(_steps, first, second, before, row))


def _steps(first: Cell, second: Cell, before: Cell, value: Cell) -> bool:
    """Whether a number continues the step from `first` to `second` after `before`; a text is the same."""
    if isinstance(first, str) or isinstance(second, str):
        return first == second == value
    assert not isinstance(before, str) and not isinstance(value, str)
    return abs((value - before) - (second - first)) <= CLOSE * max(abs(value), abs(before))


def _neighbours(first: tuple[Cell, ...], second: tuple[Cell, ...]) -> bool:
    """Whether two rows have numbers one apart, and no more than one real number changes."""
    changed = sum(isinstance(a, float) and a != b for a, b in zip(first, second))
    one, next_one = first[0], second[0]
    return isinstance(one, int) and isinstance(next_one, int) and next_one - one == 1 and changed < 2
