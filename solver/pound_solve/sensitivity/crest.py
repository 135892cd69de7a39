"""The instant of a peak: where the rate of a reading is zero."""

from __future__ import annotations

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.sensitivity.course import RunCourse
from pound_solve.sensitivity.dual_law import BranchSlopes
from pound_solve.sensitivity.equations import TangentEquations
from pound_solve.sensitivity.instants import InputSlopes, instants
from pound_solve.sensitivity.samples import ObservedValue, read
from pound_solve.sensitivity.trajectory import SmoothPiece

SPREAD = 4e-3  #: distance of the values of a difference, in intervals or in radians of the fastest mode
FAR = 0.5  #: largest correction of an instant, likewise
FLAT = 1e-12  #: fraction of a value up to which a difference of it is rounding
CORRECTIONS = 3  #: number of them
#: first and second differences of fourth order over five equidistant values
SLOPE = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0
BEND = np.array([-1.0, 16.0, -30.0, 16.0, -1.0]) / 12.0
AT_END = 1e-9  #: fraction of an interval up to which an instant is at its end


def refined(
    course: RunCourse, equations: TangentEquations, no_slopes: InputSlopes, reading: ObservedValue
) -> ObservedValue | None:
    """Return the reading of a peak at the zero of its rate next to the instant that the run has.

    The envelopes of a run find the value of a peak, which depends little on its instant, to all digits, but
    not its instant.  An instant at an event stays, and one at the end of an interval of the excitation if
    the rate is not zero there: these are corners.  None: the peak lies elsewhere and is not at rest, so it
    is the limit at a jump.

    Parameters
    ----------
    course : RunCourse
    equations : TangentEquations
    no_slopes : InputSlopes
        Of no parameters.
    reading : ObservedValue
    """
    if reading.is_total or not reading.is_peak:
        return reading
    at = course.place(reading.t)
    piece = course.parts[at.part]
    if not isinstance(piece, SmoothPiece):
        return reading
    length, subsystems = float(piece.lengths[at.interval]), piece.dense.subsystems.present
    radius = max((x.decomposition.propagator.spectral_radius for x in subsystems), default=0.0)
    unit = min(length, 1.0 / radius) if radius else length
    h, tau = SPREAD * unit, at.tau
    branches = present_branches(piece)
    for _ in range(CORRECTIONS):  # the motion of the interval continues smoothly beyond its ends
        x = instants(piece, np.array([at.interval]), tau + h * np.arange(-2.0, 3.0), no_slopes)
        values = read(equations, reading.kind, reading.item, x, branches)
        slope, bend = float(SLOPE @ values), float(BEND @ values)
        if abs(slope) <= FLAT * np.abs(values).max():  # at rest, or on a plateau of a plastic force
            break
        tau += -h * slope / bend if bend else np.inf
        if abs(tau - at.tau) > FAR * unit or not -2.0 * h <= tau <= length + 2.0 * h:
            at_end = min(at.tau, length - at.tau) <= AT_END * length
            return reading if at_end else None
    return reading._replace(t=reading.t + tau - at.tau)


def present_branches(piece: SmoothPiece) -> BranchSlopes:
    """Return the branches of a piece, without derivatives."""
    branches = [(b.stiffness, b.damping, b.force0) for b in piece.dense.branches]
    values: Array = np.array(branches).reshape(-1, 3).T
    return BranchSlopes(values, np.zeros((3, 0, values.shape[1])))
