"""Tolerances of events and of the clock that methods share, and how they depend on one another.

Relative to the largest terms of an event function, in ascending order:

==========================  =====  =====================================================================
`EVENT_TOLERANCE`           1e-12  an event that is located is met to this
`NEAR_EVENT`, `LOST_FORCE`  1e-9   far enough above it that a located event never exceeds them: another
                                   event at this instant, a force that has jumped
`MOVING_ALIKE` times it     1e-9   bodies that move alike in steps: each of their events is met to it
`NEARLY_MET`                1e-6   steps accept an event that they cannot meet more accurately
`LOST_FORCE_OF_STEPS`       1e-5   above it, or such an event would count as a lost force
==========================  =====  =====================================================================

Relative to times and to the lengths of steps: a clock resolves 2e-16 of its time, and the excitation 1e-13
(`loading.excitation.CLOCK_ROUNDING`).
"""

from __future__ import annotations

#: fraction of its largest value up to which an event function counts as not above zero
EVENT_TOLERANCE = 1e-12
#: `EVENT_TOLERANCE` times this is the fraction of their displacements within which bodies that move alike
#: stay together in steps; each of their events is met to `EVENT_TOLERANCE`
MOVING_ALIKE = 1e3
#: fraction of its largest terms within which an event function is at an event of the same instant
NEAR_EVENT = 1e-9
#: fraction of a law's forces above which a change of branch at a located event has made its force jump
LOST_FORCE = 1e-9
#: fraction of its largest value within which steps accept an event that cannot be met more accurately
NEARLY_MET = 1e-6
#: fraction of a law's forces above which its force has jumped at an event of steps
LOST_FORCE_OF_STEPS = 10.0 * NEARLY_MET

SAME_INSTANT = 1e-13  #: fraction of the time within which two events are at one instant
SAME_INSTANT_OF_STEP = 1e-9  #: the same for steps, as a fraction of the step
STEP_ROUNDING = 1e-9  #: fraction of a step by which lengths may differ by rounding
COUNT_ROUNDING = 1e-12  #: fraction of a number of equal parts that is rounding, so that no more are counted
