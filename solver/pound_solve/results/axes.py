"""Axes of a history's row, with a label for each position.

A row of nodes has two axes, ``node`` and ``component``. A row of members has one axis of pairs, because not
every member has every component; the coordinates ``member`` and ``component`` label the pairs.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from pound_solve.results.contents import HISTORIES


class Axis(NamedTuple):
    """One axis of a row: its name, a label for each position, and further coordinates by name."""

    name: str
    labels: Sequence[Any]
    coordinates: Mapping[str, Sequence[Any]]

    @property
    def named(self) -> Mapping[str, Sequence[Any]]:
        """Labels that select a position, keyed by name: the coordinates, or else the axis labels."""
        return self.coordinates or {self.name: self.labels}


def axes_of(name: str, attributes: Mapping[str, Any]) -> tuple[Axis, ...]:
    """Axes of a history other than time, from the attributes of its dataset."""
    sources = HISTORIES[name].axes if name in HISTORIES else {}
    labels = attributes["labels"]
    if name == "time":
        return ()
    if not sources or not attributes.keys() >= set(sources.values()):  # a file of another version
        plain = Axis(f"{name.rpartition('/')[2]}_label", labels, {})
        return (Axis("node", attributes["nodes"], {}), plain) if "nodes" in attributes else (plain,)
    coordinates = {axis: attributes[source] for axis, source in sources.items()}
    if len(coordinates) == 1 or "nodes" in attributes:
        return tuple(Axis(axis, values, {}) for axis, values in coordinates.items())
    return (Axis("_".join(coordinates), labels, coordinates),)


def coordinates(axes: Sequence[Axis]) -> dict[str, tuple[Any, ...]]:
    """Coordinates of every value of a row in C order, keyed by name."""
    places = list(itertools.product(*(range(len(axis.labels)) for axis in axes)))
    return {
        name: tuple(values[place[k]] for place in places)
        for k, axis in enumerate(axes)
        for name, values in axis.named.items()
    }
