"""The instant of a peak: where the rate of a reading is zero."""

from __future__ import annotations

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.sensitivity.course import Course
from pound_solve.sensitivity.equations import TangentEquations
from pound_solve.sensitivity.instants import InputSlopes, instants
from pound_solve.sensitivity.law_tangent import BranchSlopes
from pound_solve.sensitivity.samples import Reading, read
from pound_solve.sensitivity.trajectory import Piece

SPREAD = 1e-3  #: distance of the values of a difference, in intervals or in radians of the fastest mode
FAR = 0.5  #: largest correction of an instant, likewise
CORRECTIONS = 3  #: number of them


def refined(
    course: Course, equations: TangentEquations, none: InputSlopes, reading: Reading
) -> Reading:
    """Return the reading of a peak at the zero of its rate next to the instant that the run has.

    The envelopes of a run find the value of a peak, which depends little on its instant, to all digits, but
    not its instant.  An instant at an event, or at the end of an interval, stays.
    """
    at = course.place(reading.t)
    piece = course.parts[at.part]
    if not isinstance(piece, Piece):
        return reading
    length, subsystems = float(piece.lengths[at.interval]), piece.dense.subsystems.present
    radius = max((x.decomposition.propagator.spectral_radius for x in subsystems), default=0.0)
    unit = min(length, 1.0 / radius) if radius else length
    h, tau = SPREAD * unit, at.tau
    chosen = np.array([at.interval])
    branches = present_branches(piece)
    for _ in range(CORRECTIONS):
        if not h <= tau <= length - h:
            return reading
        x = instants(piece, chosen, np.array([tau - h, tau, tau + h]), none)
        low, middle, high = read(equations, reading.kind, reading.index, x, branches).tolist()
        bend = high - 2.0 * middle + low
        step = -0.5 * h * (high - low) / bend if bend else np.inf
        if abs(step) > FAR * unit:
            return reading
        tau += step
    return reading._replace(t=reading.t + tau - at.tau)


def present_branches(piece: Piece) -> BranchSlopes:
    """Return the branches of a piece, without derivatives."""
    branches = [(b.stiffness, b.damping, b.force0) for b in piece.dense.branches]
    values: Array = np.array(branches).reshape(-1, 3).T
    return BranchSlopes(values, np.zeros((3, 0, values.shape[1])))
