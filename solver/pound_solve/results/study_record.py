"""Results of a study: trials with their errors, the reference and the advice."""

from __future__ import annotations

import math
import statistics
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

from pound_solve.numerics.types import Array

NOISY: Final = 0.25  #: relative difference below which times are equal; a larger spread of repeats is noise
SHORT: Final = 0.01  #: time below which the spread is ignored [s]

#: Extremes by kind and unit.
Peaks = Mapping[tuple[str, str], Array]
#: Errors by kind; NaN for a kind that the deck does not have.
Errors = dict[str, float]


@dataclass(frozen=True)
class MethodTrial:
    """One method with one setting.

    Attributes
    ----------
    method, setting : str
    seconds : tuple of float
        Times of the repeats [s].
    steps, events, collisions : int
    residual : float
    peaks : mapping
    stopped : str
        Reason why it was not completed; empty if it was.
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
        """Difference of the longest and the shortest repeat, divided by the median."""
        return (max(self.seconds) - min(self.seconds)) / self.time

    @property
    def error(self) -> float:
        """Largest error of all kinds; NaN without errors."""
        return max((e for e in self.errors.values() if math.isfinite(e)), default=math.nan)


@dataclass(frozen=True)
class Reference:
    """Extremes against which errors are measured; `error` is their estimated error, by kind."""

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
    """Fastest trial for a target, and the error allowed for; None if no trial meets the target."""

    target: float
    trial: MethodTrial | None = None
    sure: float = math.nan

    def __str__(self) -> str:
        """Text of the advice for one target."""
        target = (
            f"{100 * self.target:g} %" if self.target >= 1e-4 else f"{self.target:.0e}".replace("e-0", "e-")
        )
        if self.trial is None:
            return f"{target}: none of these runs"
        name = f"{self.trial.method} {self.trial.setting}".strip()
        return f"{target}: {name} ({self.trial.time:.3g} s)"


def order(coarse: MethodTrial, fine: MethodTrial) -> float:
    """Observed order of the largest error between two trials; NaN without one."""
    ratio = fine.steps / coarse.steps if coarse.steps and fine.steps else 1.0
    if not (coarse.error > 0.0 and fine.error > 0.0 and ratio != 1.0):
        return math.nan
    return math.log(coarse.error / fine.error) / math.log(ratio)


@dataclass(frozen=True)
class MethodStudy:
    """Trials with their errors, the reference, and the advice."""

    trials: tuple[MethodTrial, ...]
    reference: Reference
    advice: tuple[Advice, ...]

    @property
    def sentence(self) -> str:
        """The advice in one sentence."""
        lacking = any(a.trial is None for a in self.advice)
        text = "Least time for errors up to " + "; ".join(map(str, self.advice))
        if self.reference.unseen:
            closed = "no contact closed, so no step is named"
            return f"{text}; {closed}: give a stronger motion to learn which step collisions need."
        return text + (" (give smaller --steps, or a larger --longest)." if lacking else ".")

    @property
    def noise(self) -> float:
        """Largest spread of repeats longer than `SHORT`; 0 without any."""
        return max((t.spread for t in self.trials if t.time > SHORT), default=0.0)

    @property
    def warning(self) -> str:
        """Warning that the times are unreliable; empty if they are reliable."""
        if self.noise <= NOISY:
            return ""
        return (
            f"Repeats of one run differ by up to {100 * self.noise:.0f} %: the machine does other work, "
            "go by the steps rather than by the times."
        )

    @property
    def orders(self) -> list[float]:
        """Observed order of each trial against the one before; NaN where there is none: a tolerance does
        not shorten all steps alike.
        """
        orders, before = [], None
        for t in self.trials:
            along = before is not None and before.method == t.method and t.setting.startswith("DT=")
            orders.append(order(before, t) if before is not None and along else math.nan)
            before = None if t.stopped else t
        return orders
