"""Which cases of a test run in every check, and which at night: see the developer guide, section Tests."""

from collections import Counter
from collections.abc import Iterable, Mapping
from itertools import combinations, product
from typing import Any

import pytest


def at_night(*cases: Any) -> list[Any]:
    """Cases of one parameter, or tuples of several, that run at night only."""
    return [pytest.param(*(c if isinstance(c, tuple) else (c,)), marks=pytest.mark.slow) for c in cases]


def each_once(*parameters: tuple[str, Iterable[Any]], at_most: int | None = None) -> pytest.MarkDecorator:
    """Parametrise a test by all combinations of values: the night runs all, every check a few of them.

    These few are as many as the longest parameter has values.  Each value occurs in them, together with
    several values of the others, unless they are limited.

    Parameters
    ----------
    parameters
        Name of each and its values, or a mapping of them by what they are called; or several names, with
        tuples of values.
    at_most : int, optional
        Combinations in a check, where one takes seconds and the values differ in little.
    """
    named = [dict(v) if isinstance(v, Mapping) else {_name(x): x for x in v} for _, v in parameters]
    names = [name.split(", ") for name, _ in parameters]
    axes, called = [list(own.values()) for own in named], [list(own) for own in named]
    places = list(product(*(range(len(axis)) for axis in axes)))
    checked = _few(places, at_most or 1 + max(map(max, places)))
    cases = []
    for place in places:
        values = [axis[i] if len(own) > 1 else [axis[i]] for own, axis, i in zip(names, axes, place)]
        cases.append(
            pytest.param(
                *(x for own in values for x in own),
                marks=() if place in checked else pytest.mark.slow,
                id="-".join(own[i] for own, i in zip(called, place)),
            )
        )
    return pytest.mark.parametrize([name for own in names for name in own], cases)


def _few(places: list[tuple[int, ...]], count: int) -> set[tuple[int, ...]]:
    """The places that add, one after the other, most values, then most pairs, then the rarest values."""
    chosen: set[tuple[int, ...]] = set()
    values: Counter[tuple[int, int]] = Counter()
    pairs: set[Any] = set()

    def gain(place: tuple[int, ...]) -> tuple[int, int, int]:
        own = [*enumerate(place)]
        new = sum(value not in values for value in own)
        return new, len({*combinations(own, 2)} - pairs), -sum(values[value] for value in own)

    for _ in range(count):
        best = max(places, key=gain)
        chosen.add(best)
        values.update(enumerate(best))
        pairs.update(combinations(enumerate(best), 2))
    return chosen


def _name(value: Any) -> str:
    """Name of a value within the identity of a case."""
    return getattr(value, "__name__", None) or str(value)
