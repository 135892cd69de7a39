"""Time of a model: what its `analyze` commands would have made of time and of a pushed node.

A replay does not solve the model.  Its loops end as they would, nevertheless: every step succeeds, time
passes, and a node under displacement control moves as it is told.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Final

MOST: Final = 1e15  #: magnitude of a step or count
STATIC, TRANSIENT = "Static", "Transient"
_LOAD: Final = ("LoadControl", "LoadPath", "ArcLength", "MinUnbalDispNorm")


@dataclass(slots=True)
class Timeline:
    """Clock of a model.

    Attributes
    ----------
    time : float
        Also the factor of loads with a Linear series [T].
    kind : str
        Of the analysis: STATIC or TRANSIENT.
    integrator : tuple of str
        Words of the integrator.
    moved : dict of (int, int) to float
        Displacements of nodes under control, by node and direction from 1 [L].
    """

    time: float = 0.0
    kind: str = STATIC
    integrator: tuple[str, ...] = ("LoadControl", "1")
    moved: dict[tuple[int, int], float] = field(default_factory=dict)

    def take(self, words: Sequence[str]) -> None:
        """Follow a command; others than those of analyses have no effect."""
        name, *rest = words
        if name == "analysis" and rest:
            self.kind = TRANSIENT if rest[0].startswith(("Transient", "VariableTransient")) else STATIC
        elif name == "integrator" and rest:
            self.integrator = tuple(rest)
        elif name == "loadConst":
            self.time = _after(rest, "-time", self.time)
        elif name == "setTime" and rest:
            self.time = _number(rest[0], self.time)
        elif name == "wipeAnalysis":
            self.kind, self.integrator = STATIC, ("LoadControl", "1")
        elif name in ("wipe", "reset"):
            self.time, self.moved = 0.0, {}
        elif name == "analyze" and rest:
            self._analyze(rest)

    def _analyze(self, rest: Sequence[str]) -> None:
        steps = _number(rest[0], 0.0)
        if self.kind == TRANSIENT:
            self.time = _sum(self.time, steps * _number((*rest[1:2], "0")[0], 0.0))
        elif self.integrator[0] == "DisplacementControl":
            node, direction, step = (_number(w, 0.0) for w in (*self.integrator[1:4], "0", "0", "0")[:3])
            place = int(node), int(direction)
            self.moved[place] = _sum(self.moved.get(place, 0.0), steps * step)
        elif self.integrator[0] in _LOAD:
            self.time = _sum(self.time, steps * _number((*self.integrator[1:2], "0")[0], 0.0))


def _after(words: Sequence[str], flag: str, default: float) -> float:
    for before, word in pairwise(words):
        if before == flag:
            return _number(word, default)
    return default


def _sum(before: float, step: float) -> float:
    """Sum without the rounding of many steps."""
    return float(f"{before + step:.12g}")


def _number(text: str, default: float) -> float:
    """Number of a word, or the default where it has no possible magnitude."""
    try:
        value = float(text)
    except ValueError:
        return default
    return value if abs(value) <= MOST else default
