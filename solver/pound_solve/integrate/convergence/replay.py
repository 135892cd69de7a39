"""Recorders between a run and the recorder of a history."""

from __future__ import annotations

from typing import Any

import numpy as np

from pound_solve.integrate.protocol import Course, EnvelopeRecorder, LawValues, Motion
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.reduction import ReducedSystem


class Witness:
    """Recorder of a run whose results are only compared: it keeps extremes at the samples and nothing
    between them.

    Attributes
    ----------
    high, low : ndarray, shape (n,)
        Extremes of u at the samples.
    lost : list of float
        Energy that each law has lost in hysteresis at the last sample [F L].
    """

    def __init__(self, recorder: EnvelopeRecorder) -> None:
        self.recorder = recorder
        self.high: Array | float = -np.inf
        self.low: Array | float = np.inf
        self.lost = list[float]()

    def sample(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take some samples (see `Recorder`)."""
        self.see(u, laws)
        self.report_progress(float(t[-1]))

    def see(self, u: Array, laws: LawValues) -> None:
        """Update extremes and lost energies with some samples."""
        self.high = np.maximum(self.high, u.max(axis=1))
        self.low = np.minimum(self.low, u.min(axis=1))
        self.lost = laws.lost[:, -1].tolist()

    def between(self, course: Course) -> None:
        """Ignore the motion between samples (see `Recorder`)."""

    @property
    def enveloped_unknowns(self) -> Flags:
        """Which unknowns `between` needs (see `Recorder`)."""
        return np.zeros_like(self.recorder.enveloped_unknowns)

    @property
    def enveloped_laws(self) -> Index:
        """Laws whose forces `between` needs (see `Recorder`)."""
        return self.recorder.enveloped_laws[:0]

    def report_progress(self, t: float, doing: str = "") -> None:
        """Pass on the progress of a trial."""
        self.recorder.report_progress(t, doing)


class Watch(Witness):
    """Recorder of a run whose results are used: it keeps extremes at the samples, and passes on everything
    immediately.
    """

    def __init__(self, recorder: EnvelopeRecorder) -> None:
        super().__init__(recorder)
        self.envelopes = recorder.envelopes

    def sample(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take some samples (see `Recorder`)."""
        self.see(u, laws)
        self.recorder.sample(t, u, v, a, laws, works)

    def keep(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take some samples whose progress has been reported before (see `EnvelopeRecorder`)."""
        self.see(u, laws)
        self.recorder.keep(t, u, v, a, laws, works)

    def between(self, course: Course) -> None:
        """Pass on the motion between samples (see `Recorder`)."""
        self.recorder.between(course)

    @property
    def enveloped_unknowns(self) -> Flags:
        """Which unknowns `between` needs (see `Recorder`)."""
        return self.recorder.enveloped_unknowns

    @property
    def enveloped_laws(self) -> Index:
        """Laws whose forces `between` needs (see `Recorder`)."""
        return self.recorder.enveloped_laws


class Replay(Witness):
    """Recorder that stores the samples of a run, and passes them on if the run is the final one.

    From the motion between the samples it keeps only envelopes, or nothing if the run is not `enveloped`
    because it will not be the final one.
    """

    def __init__(self, recorder: EnvelopeRecorder, enveloped: bool = True) -> None:
        super().__init__(recorder)
        self.enveloped, self.samples = enveloped, list[tuple[Any, ...]]()
        self.envelopes = recorder.envelopes.blank()

    def sample(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take some samples (see `Recorder`)."""
        self.samples.append((t, u, v, a, laws, works))
        super().sample(t, u, v, a, laws, works)

    def between(self, course: Course) -> None:
        """Take the motion between samples (see `Recorder`)."""
        if self.enveloped:
            self.envelopes.between(course)

    @property
    def enveloped_unknowns(self) -> Flags:
        """Which unknowns `between` needs (see `Recorder`)."""
        return self.recorder.enveloped_unknowns & self.enveloped

    @property
    def enveloped_laws(self) -> Index:
        """Laws whose forces `between` needs (see `Recorder`)."""
        return self.recorder.enveloped_laws if self.enveloped else self.recorder.enveloped_laws[:0]

    def seen(self, system: ReducedSystem) -> tuple[Array, list[str]]:
        """Return the peaks of the node accelerations and member forces, and the kind of each."""
        envelopes = self.recorder.envelopes.blank()
        envelopes.widen(self.envelopes)
        for t, u, v, a, laws, _ in self.samples:
            law_forces = (laws.force + laws.dashpot)[self.enveloped_laws]
            s = [system.excitation.values(t, order, before=True).T for order in range(3)]
            envelopes.take(Motion(t, u, v, a, law_forces), s)
        return envelopes.peaks()

    def pass_on(self) -> None:
        """Pass the samples and envelopes on to the recorder."""
        self.recorder.envelopes.widen(self.envelopes)
        for sample in self.samples:
            self.recorder.keep(*sample)
