"""A run whose samples may not count: they are kept, and passed on if it is the final one."""

from __future__ import annotations

from typing import Any

import numpy as np

from pound_solve.integrate.protocol import Course, EnvelopeRecorder, LawValues, Motion
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.reduction import ReducedSystem


class Replay:
    """Keeps the samples of a run, to pass them on if it is the final one; knows the extremes of u.

    Of the motion between the samples only the envelopes are kept; nothing where the run is not `enveloped`,
    as it will not be the final one.
    """

    def __init__(self, recorder: EnvelopeRecorder, enveloped: bool = True) -> None:
        self.recorder, self.enveloped, self.samples = recorder, enveloped, list[tuple[Any, ...]]()
        self.envelopes = recorder.envelopes.blank()
        self.high: Array | float = -np.inf
        self.low: Array | float = np.inf

    def sample(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take some samples (see `Recorder`)."""
        self.samples.append((t, u, v, a, laws, works))
        self.high = np.maximum(self.high, u.max(axis=1))
        self.low = np.minimum(self.low, u.min(axis=1))
        self.recorder.trial(float(t[-1]))

    def between(self, course: Course) -> None:
        """Take the motion between samples (see `Recorder`)."""
        if self.enveloped:
            self.envelopes.between(course)

    @property
    def shown(self) -> Flags:
        """Which unknowns `between` needs (see `Recorder`)."""
        return self.recorder.shown & self.enveloped

    @property
    def acting(self) -> Index:
        """Laws whose forces `between` needs (see `Recorder`)."""
        return self.recorder.acting if self.enveloped else self.recorder.acting[:0]

    def trial(self, t: float, doing: str = "") -> None:
        """Pass the progress of a trial on."""
        self.recorder.trial(t, doing)

    @property
    def lost(self) -> list[float]:
        """Energy that each law has lost in hysteresis at the last sample [F L]."""
        laws: LawValues = self.samples[-1][4]
        return [float(x) for x in laws.lost[:, -1]]

    def seen(self, system: ReducedSystem) -> tuple[Array, list[str]]:
        """Peaks of the accelerations of nodes and of the forces of members, and the kind of each."""
        own = self.recorder.envelopes.blank()
        own.widen(self.envelopes)
        for t, u, v, a, laws, _ in self.samples:
            law_forces = (laws.force + laws.dashpot)[self.acting]
            s = [system.excitation.values(t, order, before=True).T for order in range(3)]
            own.take(Motion(t, u, v, a, law_forces), s)
        return own.peaks()

    def pass_on(self) -> None:
        """Pass everything on to the recorder."""
        self.recorder.envelopes.widen(self.envelopes)
        for sample in self.samples:
            self.recorder.keep(*sample)
