r"""Estimate of the error in the last of several runs with ever shorter steps.

Between two runs, of which the second takes r times the steps of the first, a peak whose error falls with
the power p of the step differs by :math:`\Delta`, and

.. math:: e = \frac{\Delta}{r^p - 1}

is left in the second.  A method of second order tends to p = 2; before that, runs may agree by chance, or
the error may fall only in proportion to the step, or not at all.  So p is observed, as the power that
explains the differences :math:`\Delta_1` and :math:`\Delta_2` between the last three runs,

.. math:: \frac{\Delta_2}{\Delta_1} = \frac{1 - r_2^{-p}}{r_1^p - 1} .

It is trusted from `SLOWEST` to `ORDER`, and only if it is observed twice: the lower of the power of the
last three runs and that of the three before the last is used.  A fourth run may not confirm the power of
three, because the first of them had too few steps for any order.  Differences that fall with a power above
`FASTEST`, faster than the method explains, agree by chance: they show no order, and the slowest is assumed,
as with fewer than four runs.  The last run is compared with each of the `COMPARED_RUNS` runs before it,
since a single one may be near it by chance.  `SAFETY` follows from the distribution of true errors over the
estimates (manual, theory of AUTO).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pound_solve.numerics.types import Array

SLOWEST, ORDER = (
    0.5,
    1.75,
)  #: powers of the step that an error is assumed to fall with, at least and at most
FASTEST = 2.5  #: power of the step above which a faster fall of the differences counts as chance
SAFETY = 1.5  #: factor of the estimate over the error that the differences indicate
COMPARED_RUNS = 3  #: runs that the last one is compared with
BISECTIONS = 30  #: to the observed power


def observed_order(before: Array, now: Array, first: float, second: float) -> Array:
    """Return the observed orders of convergence: powers of the step with which errors fall, between
    `SLOWEST` and `FASTEST`.

    Parameters
    ----------
    before, now : ndarray, shape (n,)
        Differences between the first and the second, and the second and the third of three runs.
    first, second : float
        Steps of the second over those of the first, and of the third over those of the second.
    """
    low, high = np.full(before.shape, SLOWEST), np.full(before.shape, FASTEST)
    for _ in range(BISECTIONS):
        power = 0.5 * (low + high)
        faster = now * (first**power - 1.0) <= before * (1.0 - second**-power)
        low, high = np.where(faster, power, low), np.where(faster, high, power)
    return np.asarray(0.5 * (low + high))


def trusted_order(observed: Array) -> Array:
    """Return the orders of convergence that are assumed for the `observed` ones."""
    by_chance = observed > FASTEST - 2.0 * (FASTEST - SLOWEST) / 2**BISECTIONS
    return np.where(by_chance, SLOWEST, np.minimum(observed, ORDER))


def differences(steps: Sequence[int], peaks: Sequence[Array], scales: Array) -> tuple[Array, Array]:
    """Differences between the peaks of each run and those of the last, relative to `scales`, shape (runs,
    n), and the number of steps of the last run over that of each, shape (runs, 1).
    """
    apart = [np.abs(peaks[-1] - p) / scales for p in peaks[:-1]]
    ratios = steps[-1] / np.array(steps[:-1], float)
    return np.array(apart).reshape(len(apart), -1), ratios[:, None]


def last_order(steps: Sequence[int], peaks: Sequence[Array], scales: Array) -> Array:
    """Orders of convergence observed in the last three runs; the slowest where there are fewer runs."""
    if len(steps) < 3:
        return np.full(scales.shape, SLOWEST)
    before, now = (np.abs(peaks[k] - peaks[k - 1]) / scales for k in (-2, -1))
    return trusted_order(observed_order(before, now, steps[-2] / steps[-3], steps[-1] / steps[-2]))


def error_left(steps: Sequence[int], peaks: Sequence[Array], scales: Array) -> float:
    """Estimate the error left in the last run, relative to the scales of the peaks.

    Parameters
    ----------
    steps : sequence of int
        Of the runs, two at least, each more than the one before.
    peaks : sequence of ndarray, shape (n,)
        Of the runs.
    scales : ndarray, shape (n,)
        That errors are measured against.
    """
    order = np.minimum(last_order(steps, peaks, scales), last_order(steps[:-1], peaks[:-1], scales))
    apart, ratios = differences(steps[-COMPARED_RUNS - 1 :], peaks[-COMPARED_RUNS - 1 :], scales)
    return SAFETY * float(np.max(apart / (ratios**order - 1.0), initial=0.0))


def likely_error(steps: Sequence[int], peaks: Sequence[Array], scales: Array) -> float:
    """Return the value of `error_left` if the last observed order were confirmed or, without one, if errors
    fell with the power `ORDER`: the next step is chosen by it.
    """
    order = last_order(steps, peaks, scales) if len(steps) > 2 else np.full(scales.shape, ORDER)
    apart, ratios = differences(steps[-3:], peaks[-3:], scales)
    return SAFETY * float(np.max(apart / (ratios**order - 1.0), initial=0.0))
