r"""AUTO: EXACT where it pays, else NEWMARK with the step that meets a tolerance.

EXACT needs no step, but linear pieces and few events.  Elsewhere the whole run is repeated with a shorter
step until the peaks no longer change: between two runs with steps h and h/r the peaks differ by
:math:`\Delta`, and the error left in the second is estimated as :math:`\Delta/(r-1)`, as if the method
were of first order only.  It is of second order, so that the estimate errs on the safe side.

What is compared: the largest and smallest value of every drift, against the larger of the two (but no less
than a millionth of the largest drift: what is smaller may be rounding, which never stands still); the peak
force of every contact, against itself (but no less than a twentieth of the largest contact force);
without either, the deformations of all springs in the same way as drifts.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_deck.schema import Field, Kind, Spec
from pound_solve.integrate import exact, newmark
from pound_solve.integrate.base import Extreme, LawValues, Outcome, Peaks, Sink, Start, Stop, Watch
from pound_solve.scene import Decision, Scene

Array = NDArray[np.float64]

MOST_UNKNOWNS = 1000  #: at 800 unknowns a run of EXACT like the paper's takes a minute
MOST_LAWS = 32  #: more springs that yield change branch too often for EXACT to pay
MOST_STEPS = 50_000_000  #: of one run
MARGIN = 0.6  #: of the tolerance that the next step aims at


def why_not_exact(scene: Scene) -> str:
    """Reason why EXACT cannot solve the scene, or does not pay; empty where it does."""
    laws = scene.structure.laws
    if scene.structure.chords:
        return f"GEOMETRY {scene.structure.model.geometry}: the members' stiffness changes as they move"
    curved = next((s for s in laws if s.law.curved), None)
    if curved is not None:
        return f"the law {curved.rule} of element {curved.element} is curved"
    if scene.size > MOST_UNKNOWNS:
        return f"{scene.size} unknowns are too many for EXACT (up to {MOST_UNKNOWNS})"
    if len(laws) > MOST_LAWS:
        return f"{len(laws)} springs and contacts change too often for EXACT to pay (up to {MOST_LAWS})"
    return ""


class Replay:
    """Keeps what a run tells its sink, to hand it on if it is the last."""

    def __init__(self, sink: Sink) -> None:
        self.sink, self.told = sink, list[tuple[Callable[..., None], tuple[Any, ...]]]()

    def sample(self, t: float, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take one sample (see `integrate.base.Sink`)."""
        self.told.append((self.sink.sample, (t, u, v, a, laws, works)))
        self.sink.trial(t)

    def between(self, t: Array, u: Array, v: Array, a: Array) -> None:
        """Take the motion between samples (see `integrate.base.Sink`)."""
        self.told.append((self.sink.between, (t, u, v, a)))

    def trial(self, t: float) -> None:
        """Pass on how far a trial has come."""
        self.sink.trial(t)

    def hand_on(self) -> None:
        """Tell the sink all of it."""
        for tell, what in self.told:
            tell(*what)


def figures(scene: Scene, peaks: Peaks) -> tuple[Array, Array]:
    """Peaks that are compared between runs, and what their differences are measured against."""
    laws = scene.structure.laws
    contact = [i for i, s in enumerate(laws) if s.is_contact]
    force = np.array([max((c.peak for c in peaks.collisions if c.law == i), default=0.0) for i in contact])
    swings: list[Extreme] = list(peaks.watch)
    if not swings and not contact:
        swings = peaks.deformation
    values = [(e.high, e.low) for e in swings]
    size = np.repeat([max(abs(e.high), abs(e.low)) for e in swings], 2)
    against = [np.maximum(x, share * x.max(initial=0.0)) for x, share in ((size, 1e-6), (force, 0.05))]
    return np.concatenate([np.ravel(values), force]), np.concatenate(against)


def to_tolerance(
    scene: Scene, start: Start, watch: Watch, options: Mapping[str, Any], sink: Sink
) -> Outcome:
    """Repeat the run with shorter steps until the peaks stand still."""
    tol, length = options["TOL"], float(start.times[-1] - start.times[0])
    breaks = scene.excitation.breaks
    steps = np.diff(breaks[(breaks >= start.times[0]) & (breaks <= start.times[-1])])
    h = float(np.median(steps)) if len(steps) > 1 else length / 1000
    before: tuple[float, Array] | None = None
    runs, error = 0, np.inf
    while True:
        replay = Replay(sink)
        try:
            outcome = newmark.integrate(scene, start, watch, {"DT": h, "BETA": 0.25, "GAMMA": 0.5}, replay)
        except Stop:
            if before is None and h > 1e-6 * length:  # too coarse to go on says nothing of the structure
                h *= 0.25
                continue
            replay.hand_on()
            raise
        runs += 1
        now, against = figures(scene, outcome.peaks)
        if before is not None:
            change = float(
                (np.abs(now - before[1]) / np.where(against > 0.0, against, 1.0)).max(initial=0.0)
            )
            error = change / (before[0] / h - 1.0)
            if error <= tol or length / h * 2.0 > MOST_STEPS:
                break
        before = h, now
        h *= 0.5 if not np.isfinite(error) else float(np.clip(np.sqrt(MARGIN * tol / error), 1 / 8, 1 / 2))
    replay.hand_on()
    outcome.figures = {**outcome.figures, "runs": runs}
    outcome.checks = [  # it says more than those of a single run
        (
            f"estimated error of drifts and contact forces, TOL {tol:g}",
            f"{error:.1e}",
            "met" if error <= tol else f"look: not met with {MOST_STEPS} steps",
        )
    ]
    return outcome


def integrate(scene: Scene, start: Start, watch: Watch, options: Mapping[str, Any], sink: Sink) -> Outcome:
    """Choose a method, note why, and run it."""
    reason = why_not_exact(scene)
    if not reason:
        why = "all laws are piecewise linear, unknowns and laws are few: no time step is needed"
        scene.decisions.append(Decision("method", "EXACT", why))
        return exact.integrate(scene, start, watch, {}, sink)
    how = f"{reason}; steps are shortened until the peaks stand still"
    scene.decisions.append(Decision("method", "NEWMARK", how))
    return to_tolerance(scene, start, watch, options, sink)


SPEC = Spec(
    "method",
    "AUTO",
    "EXACT where it pays, else steps that meet a tolerance",
    (
        Field(
            "TOL",
            Kind.REAL,
            "-",
            default=1e-4,
            lo=1e-9,
            hi=0.1,
            doc="largest error of drifts and contact forces as a share of their peaks, if steps are taken",
        ),
    ),
    impl=integrate,
)
