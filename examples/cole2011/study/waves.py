"""Waves in two colliding bars by characteristics: velocity and force at all places, at any time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from pound_solve.laws.two_bars import Pair

Array = NDArray[np.float64]
#: instants of Figure 5 as shares of T1
INSTANTS = {
    "(a) before": 0.0,
    "(b) touch: the waves set out": 0.02,
    "(c) on the way": 0.25,
    "(d) bar 1 is at the common speed": 0.5,
    "(e) on the way back": 0.75,
    "(f) the bars part": 0.999,
}


def waves(pair: Pair, cells: int) -> Callable[[float], tuple[Array, Array, Array, Array]]:
    """Two bars that meet with the speeds 1 and 0, to the moment at which bar 1 has its wave back.

    Parameters
    ----------
    pair : Pair
        Bars 1 and 2 in this order, T1 <= T2.
    cells : int
        Of bar 1 in half of T1; a wave passes a cell in a step.

    Returns
    -------
    callable
        Of a share of T1: places in bar 1 and in bar 2 (shares of the way in T2/2), velocities of all cells,
        and their compressive forces over that of Eq. 11.
    """
    one, two = pair.first, pair.second
    n1 = cells
    n2 = round(cells * two.period / one.period)
    z1, z2 = one.impedance, two.impedance

    def at(share: float) -> tuple[Array, Array, Array, Array]:
        # waves to the right and to the left in every cell: p = (f + z v)/2, q = (f - z v)/2
        p1, q1 = np.full(n1, z1 / 2), np.full(n1, -z1 / 2)
        p2, q2 = np.zeros(n2), np.zeros(n2)
        for _ in range(round(2 * cells * share)):
            come, back = p1[-1], q2[0]
            force = 2 * (z2 * come + z1 * back) / (z1 + z2)
            p1, q1 = np.append(-q1[0], p1[:-1]), np.append(q1[1:], force - come)
            p2, q2 = np.append(force - back, p2[:-1]), np.append(q2[1:], -p2[-1])
        x1 = (np.arange(n1) + 0.5 - n1) / n2
        x2 = (np.arange(n2) + 0.5) / n2
        speed = np.append((p1 - q1) / z1, (p2 - q2) / z2)
        return x1, x2, speed, np.append(p1 + q1, p2 + q2) / pair.force

    return at
