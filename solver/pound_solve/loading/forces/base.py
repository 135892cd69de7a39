"""Common parts of all forces in time: nodes, components, and the Force made from a card."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from pound_deck.schema import Field, Kind
from pound_solve.loading.piecewise import Piecewise
from pound_solve.loading.records.base import RecordError

COMMON: Final = (
    Field("NODES", Kind.NODES, doc="nodes that each get this force", positional=True),
    Field("FX", Kind.REAL, "F", default=None, doc="force along x", positional=True),
    Field("FY", Kind.REAL, "F", default=None, doc="force along y, upwards", positional=True),
    Field("MZ", Kind.REAL, "F*L", default=None, doc="moment, anticlockwise", positional=True),
)


@dataclass(frozen=True, slots=True, eq=False)
class Force:
    """Forces on some nodes that follow one history.

    Attributes
    ----------
    nodes : tuple of int
    push : tuple of three floats, [F], [F], [F L]
        Forces along x and y and moment on each node, per unit of the history.
    history : Piecewise, [-]
        Begins at t = 0; zero after its last break.
    info : mapping
        Values for the report: ``kind`` and items specific to the kind.
    """

    nodes: tuple[int, ...]
    push: tuple[float, float, float]
    history: Piecewise
    info: Mapping[str, Any] = field(default_factory=dict)


def finish(card: Mapping[str, Any], history: Piecewise, info: Mapping[str, Any]) -> Force:
    """Force of a card with the given `history`.

    Raises
    ------
    RecordError
        R405 where the card gives no component of the force.
    """
    push = [card.get(name) for name in ("FX", "FY", "MZ")]
    if all(p is None for p in push):
        raise RecordError("R405", "the force has no component", "give FX, FY or MZ", "NODES")
    x, y, moment = (float(p or 0.0) for p in push)
    return Force(tuple(card["NODES"]), (x, y, moment), history, info)
