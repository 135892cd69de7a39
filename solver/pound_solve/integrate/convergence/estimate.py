r"""The error that is left in the last of some runs with shorter and shorter steps.

Between two runs, of which the second takes r times the steps of the first, a peak whose error falls with
the power p of the step differs by :math:`\Delta`, and

.. math:: e = \frac{\Delta}{r^p - 1}

is left in the second.  A method of second order has p = 2 in the end; before that, runs may agree by
chance, or the error may fall as slowly as the step or not at all.  So p is observed: it is that power
for which the differences :math:`\Delta_1` and :math:`\Delta_2` between the last three runs fall as they
do,

.. math:: \frac{\Delta_2}{\Delta_1} = \frac{1 - r_2^{-p}}{r_1^p - 1} .

It is trusted from `SLOWEST` to `ORDER`.  Differences that fall faster than the method explains, with a
power above `FASTEST`, agree by chance: they show no order, and the slowest is assumed, as it is where
there are two runs only.  The last run is compared with both of the others, for one may be near it by
chance.  `SAFETY` is from the distribution of true errors over the estimates (manual, theory of AUTO).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pound_solve.numerics.types import Array

SLOWEST, ORDER = (
    0.5,
    1.75,
)  #: powers of the step that an error is assumed to fall with, at least and at most
FASTEST = 2.5  #: power of the step above which a fall of the differences is chance
SAFETY = 1.5  #: estimate over the error that the differences tell
BISECTIONS = 30  #: to the observed power


def observed_order(before: Array, now: Array, first: float, second: float) -> Array:
    """Return the powers of the step with which some errors fall, between `SLOWEST` and `FASTEST`.

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
    """Return the powers that errors are assumed to fall with."""
    by_chance = observed > FASTEST - 2.0 * (FASTEST - SLOWEST) / 2**BISECTIONS
    return np.where(by_chance, SLOWEST, np.minimum(observed, ORDER))


def error_left(steps: Sequence[int], peaks: Sequence[Array], scales: Array) -> float:
    """Estimate the error left in the last run, relative to the scales of the peaks.

    Parameters
    ----------
    steps : sequence of int
        Of the runs, each more than the one before.
    peaks : sequence of ndarray, shape (n,)
        Of the runs; the last three count.
    scales : ndarray, shape (n,)
        That errors are measured against.
    """
    runs = range(max(len(steps) - 3, 0), len(steps) - 1)
    apart = [np.abs(peaks[-1] - peaks[k]) / scales for k in runs]
    ratios = [steps[-1] / steps[k] for k in runs]
    order = np.full(scales.shape, SLOWEST)
    if len(runs) == 2:
        before = np.abs(peaks[-2] - peaks[-3]) / scales
        order = trusted_order(observed_order(before, apart[1], ratios[0] / ratios[1], ratios[1]))
    left = [d / (r**order - 1.0) for d, r in zip(apart, ratios)]
    return SAFETY * float(np.max(left, initial=0.0))


def likely_error(steps: Sequence[int], peaks: Sequence[Array], scales: Array) -> float:
    """Return what `error_left` were if errors fell with the power `ORDER`: what the next step is chosen by
    where no order is observed yet.
    """
    apart = float(np.max(np.abs(peaks[-1] - peaks[-2]) / scales, initial=0.0))
    return SAFETY * apart / float((steps[-1] / steps[-2]) ** ORDER - 1.0)
