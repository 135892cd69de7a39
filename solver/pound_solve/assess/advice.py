"""Conclusions of a study from its trials: errors, the reference, and the advice."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from pound_solve.results.study_record import NOISY, Advice, Errors, MethodTrial, Peaks, Reference
from pound_solve.user_error import UserError

TARGETS: Final = (1e-2, 1e-3, 1e-6)  #: target errors of the advice
KINDS: Final = ("drift", "member", "contact")  #: of extremes, in the order of the table
MARGIN: Final = 5.0  #: factor by which errors of another record may exceed those of this one
ORDER: Final = 2  #: of every stepping method


class MethodStudyError(UserError):
    """Raised if the deck or the options contain nothing to study."""


def errors(peaks: Peaks, reference: Peaks) -> Errors:
    """Error by kind: largest difference of an extreme, divided by the largest extreme of its kind and unit.

    NaN for a kind without extremes, or whose extremes are all zero.
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


def extrapolated(method: str, ladder: Sequence[MethodTrial]) -> Reference:
    """Reference extrapolated to steps of zero from the two finest trials of a ladder by the method's order.

    Its error is estimated by comparison with the extrapolation from one rung before.

    Raises
    ------
    MethodStudyError
        Fewer than three trials were completed.
    """
    done = [t for t in ladder if not t.stopped]
    if len(done) < 3:
        why = next((t.stopped for t in ladder if t.stopped), "give more --steps")
        raise MethodStudyError(f"a reference needs three completed runs of {method}: {why}")

    def limit(coarse: MethodTrial, fine: MethodTrial) -> Peaks:
        weight = 1.0 / ((fine.steps / coarse.steps) ** ORDER - 1.0)
        return {k: x + weight * (x - coarse.peaks[k]) for k, x in fine.peaks.items()}

    best, before = limit(*done[-2:]), limit(*done[-3:-1])
    return Reference(best, errors(before, best), f"{method} extrapolated from {done[-2].setting} and "
                     f"{done[-1].setting}")  # fmt: skip


def advise(trials: Sequence[MethodTrial], reference: Reference) -> tuple[Advice, ...]:
    """The fastest trial for each target; of several with similar times, the one with the least error.

    The error allowed for is `MARGIN` times the largest of the trial's error, of the errors extrapolated
    from its two neighbours in the ladder by the order of the method, so that no zero crossing of an error
    passes for accuracy, and of the errors of all finer trials; the error of the reference is added.  If no
    contact closed, no step is recommended.
    """
    advice = []
    for target in TARGETS:
        fit = [(t, sure) for t, sure in zip(trials, allowed(trials, reference)) if sure <= target]
        longest = (1.0 + NOISY) * min((t.time for t, _ in fit), default=0.0)
        alike = [(sure, t.time, n) for n, (t, sure) in enumerate(fit) if t.time <= longest]
        advice.append(Advice(target, *fit[min(alike)[2]]) if fit else Advice(target))
    return tuple(advice)


def allowed(trials: Sequence[MethodTrial], reference: Reference) -> list[float]:
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
