"""Scenes without massless freedoms that follow the others, for methods that work on full matrices."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pound_solve.integrate.protocol import LawValues, Sink, Start, Stop, Watch
from pound_solve.numerics.types import Array, Flags
from pound_solve.structure.reduction import Condensed, Scene, condense

MOST_UNKNOWNS = 4000  #: of one run: a full matrix of as many takes 128 MB


class Whole:
    """Hands samples on with all unknowns, condensed ones too."""

    def __init__(self, sink: Sink, small: Condensed) -> None:
        self.sink, self.small, self.at_start = sink, small, small.put_in(np.zeros(1))

    def sample(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take some samples (see `integrate.base.Sink`)."""
        ex = self.small.scene.excitation
        u, v, a = (self.small.all(x, ex.values(t, order).T, order) for order, x in enumerate((u, v, a)))
        if not self.small.scene.total:  # the total form counts the work on all freedoms
            works = works.copy()
            works[0] += self.small.put_in(t) - self.at_start
        self.sink.sample(t, u, v, a, laws, works)

    @property
    def shown(self) -> Flags:
        """Which unknowns `between` looks at (see `integrate.base.Sink`)."""
        return np.asarray(self.small.expand[self.sink.shown].any(axis=0))

    def between(self, t: Array, u: Array, v: Array, a: Array, apart: float) -> None:
        """Take the motion between samples (see `integrate.base.Sink`)."""
        ex = self.small.scene.excitation
        u, v, a = (self.small.all(x, ex.values(t, order).T, order) for order, x in enumerate((u, v, a)))
        self.sink.between(t, u, v, a, apart)

    def turned(self, t: Array, u: Array) -> None:
        """Take displacements that turn (see `integrate.base.Sink`)."""
        self.sink.turned(t, self.small.all(u, self.small.scene.excitation.values(t).T))

    def trial(self, t: float, doing: str = "") -> None:
        """Pass it on."""
        self.sink.trial(t, doing)


def condensed(
    scene: Scene, start: Start, watch: Watch, sink: Sink, method: str
) -> tuple[Scene, Start, Watch, Sink]:
    """What a method is given that works on full matrices: no massless freedoms that follow the others.

    Raises
    ------
    Stop
        There are more unknowns than `MOST_UNKNOWNS`.
    """
    if scene.size > MOST_UNKNOWNS:
        why = f"{method} works on full matrices, and {scene.size} unknowns are too many for them"
        raise Stop("A505", float(start.times[0]), f"{why} ({MOST_UNKNOWNS} at most): NEWMARK takes them")
    small = condense(scene)
    return (
        small.scene,
        replace(start, u=start.u[small.keep], v=start.v[small.keep]),
        Watch(
            watch.names,
            watch.rows @ small.expand,
            watch.input_rows + watch.rows @ small.follow,
            watch.constants + watch.rows @ small.constant,
        ),
        sink if len(small.keep) == scene.size else Whole(sink, small),
    )
