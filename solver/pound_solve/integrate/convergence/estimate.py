r"""Estimate of the error in the last of several runs with successively shorter steps.

If the second of two runs takes r times the steps of the first, a peak differs by :math:`\Delta`, and its
error falls with the power p of the step, the error

.. math:: e = \frac{\Delta}{r^p - 1}

remains in the second.  A method of second order tends to p = 2.  Before that, runs may agree by chance, or
the error may fall only in proportion to the step, or not at all.  Therefore p is observed: it is the power
that explains the differences :math:`\Delta_1` and :math:`\Delta_2` between the last three runs,

.. math:: \frac{\Delta_2}{\Delta_1} = \frac{1 - r_2^{-p}}{r_1^p - 1} .

The power is trusted between `MIN_ORDER` and `ORDER`, and only once it has been observed twice: the lower of
two powers is used, that of the last three runs and that of the three runs before the last.  (A power from
three runs is not enough, since the first of them may have had too few steps to show any order.)
Differences that fall with a power above `CHANCE_ORDER` fall faster than the method explains.  They agree by
chance and indicate no order; the slowest power is then assumed, as with fewer than four runs.  The last run
is compared with each of the `COMPARED_RUNS` runs before it, since a single run may agree with it by chance.
`SAFETY` follows from the distribution of the ratio of true errors to estimates (manual, theory of AUTO).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pound_solve.numerics.types import Array

#: smallest and largest power of the step with which an error is assumed to fall
MIN_ORDER, ORDER = 0.5, 1.75
CHANCE_ORDER = 2.5  #: power of the step above which the decrease of the differences counts as chance
SAFETY = 1.5  #: ratio of the estimate to the error that the differences indicate
COMPARED_RUNS = 3  #: number of runs with which the last one is compared
BISECTIONS = 30  #: number of bisections to the observed power


def observed_order(before: Array, now: Array, first: float, second: float) -> Array:
    """Return the observed orders of convergence, between `MIN_ORDER` and `CHANCE_ORDER`: the powers of the
    step with which errors fall.

    Parameters
    ----------
    before, now : ndarray, shape (n,)
        Differences between the first and second, and between the second and third of three runs.
    first, second : float
        Ratio of the steps of the second run to those of the first, and of the third to those of the second.
    """
    low, high = np.full(before.shape, MIN_ORDER), np.full(before.shape, CHANCE_ORDER)
    for _ in range(BISECTIONS):
        power = 0.5 * (low + high)
        faster = now * (first**power - 1.0) <= before * (1.0 - second**-power)
        low, high = np.where(faster, power, low), np.where(faster, high, power)
    return np.asarray(0.5 * (low + high))


def trusted_order(observed: Array) -> Array:
    """Return the assumed orders of convergence for `observed` orders."""
    by_chance = observed > CHANCE_ORDER - 2.0 * (CHANCE_ORDER - MIN_ORDER) / 2**BISECTIONS
    return np.where(by_chance, MIN_ORDER, np.minimum(observed, ORDER))


def differences(steps: Sequence[int], peaks: Sequence[Array], scales: Array) -> tuple[Array, Array]:
    """Return the differences between the peaks of each run and those of the last, relative to `scales`,
    shape (runs, n), and the ratio of the steps of the last run to those of each, shape (runs, 1).
    """
    apart = [np.abs(peaks[-1] - p) / scales for p in peaks[:-1]]
    ratios = steps[-1] / np.array(steps[:-1], float)
    return np.array(apart).reshape(len(apart), -1), ratios[:, None]


def last_order(steps: Sequence[int], peaks: Sequence[Array], scales: Array) -> Array:
    """Return the orders of convergence observed in the last three runs, or the slowest if there are fewer
    runs.
    """
    if len(steps) < 3:
        return np.full(scales.shape, MIN_ORDER)
    before, now = (np.abs(peaks[k] - peaks[k - 1]) / scales for k in (-2, -1))
    return trusted_order(observed_order(before, now, steps[-2] / steps[-3], steps[-1] / steps[-2]))


def error_left(steps: Sequence[int], peaks: Sequence[Array], scales: Array) -> float:
    """Estimate the error of the last run, relative to the scales of the peaks.

    Parameters
    ----------
    steps : sequence of int
        Of at least two runs, ascending.
    peaks : sequence of ndarray, shape (n,)
        Of the runs.
    scales : ndarray, shape (n,)
        Scales of the errors.
    """
    order = np.minimum(last_order(steps, peaks, scales), last_order(steps[:-1], peaks[:-1], scales))
    apart, ratios = differences(steps[-COMPARED_RUNS - 1 :], peaks[-COMPARED_RUNS - 1 :], scales)
    return SAFETY * float(np.max(apart / (ratios**order - 1.0), initial=0.0))


def likely_error(steps: Sequence[int], peaks: Sequence[Array], scales: Array) -> float:
    """Return the value of `error_left` if the last observed order were confirmed or, without an observed
    order, if errors fell with the power `ORDER`.  The next step is chosen from this value.
    """
    order = last_order(steps, peaks, scales) if len(steps) > 2 else np.full(scales.shape, ORDER)
    apart, ratios = differences(steps[-3:], peaks[-3:], scales)
    return SAFETY * float(np.max(apart / (ratios**order - 1.0), initial=0.0))
