"""Conclusions of a study from its trials: errors, the reference, and the advice."""

from __future__ import annotations

import math
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from pound_solve.numerics.types import Array

TARGETS: Final = (1e-2, 1e-3, 1e-6)  #: errors that the advice is for
KINDS: Final = ("drift", "member", "contact")  #: of extremes, in the order of the table
MARGIN: Final = 5.0  #: errors of another record may be that much larger than those of this one
ORDER: Final = 2  #: of every stepping method
NOISY: Final = 0.25  #: share that times may differ by and be alike; repeats that differ by more are noise


class StudyError(Exception):
    """Raised where the deck or the options contain nothing to study."""


#: Extremes by kind and unit.
Peaks = Mapping[tuple[str, str], Array]
#: Errors by kind; NaN for a kind that the deck does not have.
Errors = dict[str, float]


@dataclass(frozen=True)
class Trial:
    """One method with one setting.

    Attributes
    ----------
    method, setting : str
    seconds : tuple of float
        Of the repeats.
    steps, events, collisions : int
    residual : float
    peaks : mapping
    stopped : str
        Why it was not completed; empty if it was.
    errors : dict
        By kind.
    """

    method: str
    setting: str
    seconds: tuple[float, ...] = (math.nan,)
    steps: int = 0
    events: int = 0
    collisions: int = 0
    residual: float = math.nan
    peaks: Peaks = field(default_factory=dict)
    stopped: str = ""
    errors: Errors = field(default_factory=dict)

    @property
    def time(self) -> float:
        """Median time [s]."""
        return statistics.median(self.seconds)

    @property
    def spread(self) -> float:
        """Longest less shortest repeat over the median."""
        return (max(self.seconds) - min(self.seconds)) / self.time

    @property
    def error(self) -> float:
        """Largest error of all kinds; NaN where there is none."""
        return max((e for e in self.errors.values() if math.isfinite(e)), default=math.nan)


@dataclass(frozen=True)
class Reference:
    """Extremes that errors are measured against; `error` is their own, by kind."""

    peaks: Peaks
    error: Errors
    how: str

    @property
    def unseen(self) -> bool:
        """Whether there are contacts but none has closed: the effect of steps on them is unknown."""
        forces = [values for (kind, _), values in self.peaks.items() if kind == "contact"]
        return bool(forces) and not any(values.any() for values in forces)

    @property
    def doubt(self) -> float:
        """Largest estimated error of the reference itself."""
        return max((e for e in self.error.values() if math.isfinite(e)), default=0.0)


@dataclass(frozen=True)
class Advice:
    """Trial of least time for a target, and the error that is allowed for; None where no trial will do."""

    target: float
    trial: Trial | None = None
    sure: float = math.nan

    def __str__(self) -> str:
        """Advice for one target in words."""
        target = (
            f"{100 * self.target:g} %" if self.target >= 1e-4 else f"{self.target:.0e}".replace("e-0", "e-")
        )
        if self.trial is None:
            return f"{target}: none of these runs"
        name = f"{self.trial.method} {self.trial.setting}".strip()
        return f"{target}: {name} ({self.trial.time:.3g} s)"


def errors(peaks: Peaks, reference: Peaks) -> Errors:
    """Error by kind: largest difference of an extreme, divided by the largest extreme of its kind and unit.

    NaN for a kind that nothing belongs to, or all of whose extremes are zero.
    """
    largest = dict.fromkeys(KINDS, math.nan)
    for (kind, unit), true in reference.items():
        if (kind, unit) not in peaks:
            continue
        scale, off = float(np.abs(true).max()), float(np.abs(peaks[kind, unit] - true).max())
        if scale or off:
            ratio = off / scale if scale else math.inf
            largest[kind] = ratio if math.isnan(largest[kind]) else max(largest[kind], ratio)
    return largest


def extrapolated(method: str, ladder: Sequence[Trial]) -> Reference:
    """Reference extrapolated to steps of zero from the two finest trials of a ladder by the method's order.

    Its own error is estimated by what the same extrapolation gives one rung before.

    Raises
    ------
    StudyError
        Fewer than three trials were completed.
    """
    done = [t for t in ladder if not t.stopped]
    if len(done) < 3:
        why = next((t.stopped for t in ladder if t.stopped), "give more --steps")
        raise StudyError(f"a reference needs three completed runs of {method}: {why}")

    def limit(coarse: Trial, fine: Trial) -> Peaks:
        share = 1.0 / ((fine.steps / coarse.steps) ** ORDER - 1.0)
        return {k: x + share * (x - coarse.peaks[k]) for k, x in fine.peaks.items()}

    best, before = limit(*done[-2:]), limit(*done[-3:-1])
    return Reference(best, errors(before, best), f"{method} extrapolated from {done[-2].setting} and "
                     f"{done[-1].setting}")  # fmt: skip


def order(coarse: Trial, fine: Trial) -> float:
    """Observed order of the largest error between two trials; NaN where there is none."""
    ratio = fine.steps / coarse.steps if coarse.steps and fine.steps else 1.0
    if not (coarse.error > 0.0 and fine.error > 0.0 and ratio != 1.0):
        return math.nan
    return math.log(coarse.error / fine.error) / math.log(ratio)


def advise(trials: Sequence[Trial], reference: Reference) -> tuple[Advice, ...]:
    """The trial of least time for each target; of several that take as long, the one of least error.

    The error that is allowed for is `MARGIN` times the largest of the trial's own and of what its two
    neighbours in the ladder make of it by the order of the method, so that no zero crossing of an error is
    taken for accuracy, and of all finer ones; the reference's own error comes on top.  Where no contact
    closed, no step is named.
    """
    advice = []
    for target in TARGETS:
        fit = [(t, sure) for t, sure in zip(trials, allowed(trials, reference)) if sure <= target]
        longest = (1.0 + NOISY) * min((t.time for t, _ in fit), default=0.0)
        alike = [(sure, t.time, n) for n, (t, sure) in enumerate(fit) if t.time <= longest]
        advice.append(Advice(target, *fit[min(alike)[2]]) if fit else Advice(target))
    return tuple(advice)


def allowed(trials: Sequence[Trial], reference: Reference) -> list[float]:
    """Error that the advice allows for, of each trial, see `advise`; infinite for one that stopped."""
    margins = []
    for n, t in enumerate(trials):
        ladder = [x for x in trials[n:] if x.method == t.method and not x.stopped]
        near = [x for x in trials[max(n - 1, 0) : n] if x.method == t.method and not x.stopped]
        if t.stopped or (t.steps and reference.unseen):
            margins.append(math.inf)
            continue
        estimates = [x.error * (x.steps / t.steps) ** ORDER for x in near + ladder[:2] if t.steps]
        # finer steps that do worse are a warning
        estimates += [x.error for x in ladder]
        margins.append(MARGIN * max(estimates) + reference.doubt)
    return margins
