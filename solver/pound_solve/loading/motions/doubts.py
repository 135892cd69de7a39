"""Detection of records with a wrong step, from implausible periods and durations."""

from __future__ import annotations

from typing import Final

import numpy as np

from pound_solve.loading.intensity import significant_duration
from pound_solve.loading.piecewise import Piecewise

#: mean time between every second crossing of zero within the significant duration [s]: rock has 0.05 to
#: 0.2, firm soil 0.2 to 0.5, the bed of a lake 2
MIN_MEAN_PERIOD, MAX_MEAN_PERIOD = 0.03, 1.5
#: the same times the significant duration [s^2]: 40 s of 2 s, or 150 s of 0.4 s; it grows with the square
#: of a step that is too long
MAX_PERIOD_TIMES_DURATION: Final = 130.0
MIN_SAMPLES: Final = 100  #: fewest samples of a record for this check


def pace(acceleration: Piecewise) -> tuple[float, float]:
    """Mean period from zero crossings within the significant duration, and this duration [T].

    Parameters
    ----------
    acceleration : Piecewise
        Straight lines between samples.

    Returns
    -------
    period, duration : float, [T]
        Zero for fewer than `MIN_SAMPLES` samples, or without zero crossings.
    """
    duration = significant_duration(acceleration)
    values = acceleration.coefs[0]
    strong = values[
        np.abs(values) > 0.05 * np.abs(values).max(initial=0.0)
    ]  # a drifting line counts nothing
    if len(values) < MIN_SAMPLES or not duration > 0.0 or not len(strong):
        return 0.0, 0.0
    turns = int(np.count_nonzero(np.diff(np.sign(strong))))
    return (2.0 * duration / turns, duration) if turns else (0.0, 0.0)


def reason_mispaced(acceleration: Piecewise) -> str:
    """Text on an implausible step of a record; empty if the step is plausible."""
    period, duration = pace(acceleration)
    if 0.0 < period < MIN_MEAN_PERIOD:
        return f"the record swings every {period:.2g} s for {duration:.2g} s: hard rock has 0.05 s"
    if period > MAX_MEAN_PERIOD and period * duration > MAX_PERIOD_TIMES_DURATION:
        return f"the record swings every {period:.2g} s for {duration:.2g} s: lake beds have 2 s for 40 s"
    return ""
