"""Travelling waves: one motion that reaches the supports at different times.

A wave that runs along x at the apparent speed c arrives at a support at ``(x - x0) / c`` after the support
x0 that it reaches first.  Each support has the same motion, delayed by this time, without interpolation;
for infinite c all supports move together.

References
----------
Der Kiureghian A, Neuenhofer A (1992), Response spectrum method for multi-support seismic excitations,
Earthquake Engng Struct. Dyn. 21: 713-740 (the wave-passage effect; loss of coherence is left out here).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from pound_solve.loading.motions.base import GroundMotion


def fronts(motion: GroundMotion, x: Mapping[int, float]) -> list[GroundMotion]:
    """The motions that a wave makes, one for all supports at the same x; the motion itself without a wave.

    Parameters
    ----------
    motion : GroundMotion
    x : mapping of node to float, [L]
        Coordinates of the supports at least.
    """
    if motion.wave is None or motion.supports is None:
        return [motion]
    places: dict[float, list[int]] = {}
    for node in motion.supports:
        places.setdefault(x[node], []).append(node)
    order = sorted(places, reverse=motion.wave < 0.0)
    return [
        replace(motion.delayed((place - order[0]) / motion.wave), supports=tuple(places[place]))
        for place in order
    ]
