r"""The derivatives of the motion from one instant of a piece to a later one.

Between events the derivatives S obey the equations of the motion itself with another load, R(t)
(:mod:`.equations`).  The propagator of the motion thus carries them too.  In its state q,

.. math:: \sigma(\tau) = e^{A\tau}\sigma(0) + \int_0^\tau e^{A(\tau - t)} B R(t)\,dt ,

and the integral, of exponentials that the propagator resolves, is summed at Gauss points, twelve to four
radians of the fastest mode, whose error is less than rounding.  This is the derivative of the matrix
exponential in the direction of a change of the matrix, applied to the motion.  Unlike divided differences
of exponentials it needs no care where eigenvalues are equal, close or zero.

References
----------
Higham NJ (2008), Functions of matrices, SIAM, chapters 3 and 10 (derivative of the exponential).
Najfeld I, Havel TF (1995), Derivatives of the matrix exponential and their computation, Adv. Appl. Math.
16: 321-375 (its integral form).
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.propagators.base import gauss
from pound_solve.numerics.types import Array, Index
from pound_solve.sensitivity.equations import TangentEquations
from pound_solve.sensitivity.instants import InputSlopes, Instants, instants
from pound_solve.sensitivity.law_tangent import BranchSlopes
from pound_solve.sensitivity.trajectory import Piece

AT_ONCE = 2**21  #: numbers of the load R that are evaluated at once


def carried(
    equations: TangentEquations,
    input_slopes: InputSlopes,
    piece: Piece,
    branches: BranchSlopes,
    chosen: Index,
    tau: float,
    start: tuple[Array, Array],
) -> tuple[Array, Array]:
    """Return the derivatives of displacements and velocities after some intervals of a piece.

    Parameters
    ----------
    equations : TangentEquations
    input_slopes : InputSlopes
    piece : Piece
    branches : BranchSlopes
        Of the piece.
    chosen : ndarray of int
        Successive intervals, each followed over `tau`.
    tau : float
        Their length, or for one interval a part of it [T].
    start : tuple of ndarray, shape (n_params, n) each
        Derivatives at the start of the first one.

    Returns
    -------
    tuple of ndarray, shape (n_params, n) each
    """
    radius = max((x.decomposition.propagator.spectral_radius for x in piece.dense.subsystems.present),
                 default=0.0)  # fmt: skip
    weights, points = gauss(tau, radius)
    at_once = max(1, AT_ONCE // (len(points) * start[0].size))
    for first in range(0, len(chosen), at_once):
        some = chosen[first : first + at_once]
        inner = instants(piece, some, points, input_slopes)
        end = instants(piece, some[-1:], np.array([tau]), input_slopes)
        load = equations.residual(inner, branches)
        loads = load.reshape(*load.shape[:2], len(some), len(points)).transpose(0, 2, 3, 1)
        start = _superposed(equations, piece, branches, loads, weights, tau - points, tau, end, start)
    return start


def _superposed(
    equations: TangentEquations,
    piece: Piece,
    branches: BranchSlopes,
    loads: Array,
    weights: Array,
    left: Array,
    tau: float,
    end: Instants,
    start: tuple[Array, Array],
) -> tuple[Array, Array]:
    """Return the derivatives at the end of intervals of length `tau`.

    Parameters
    ----------
    loads : ndarray, shape (n_params, n_intervals, n_points, n)
        R at the Gauss points, `left` before the ends of the intervals.
    end : Instants
        Motion at the end of the last interval.
    """
    su, sv = start[0].copy(), start[1].copy()
    final = [equations.residual(end, branches, order)[:, :, 0] for order in (0, 1)]
    for subsystem in piece.dense.subsystems.present:
        unknowns, propagator = subsystem.decomposition.unknowns, subsystem.decomposition.propagator
        q = propagator.state_of(su[:, unknowns].T, sv[:, unknowns].T).T
        forcing = propagator.load_forcing(loads[..., unknowns])
        gained = np.einsum("k,pmkq->pmq", weights, propagator.free_motion(forcing, left))
        for gain in gained.swapaxes(0, 1):
            q = propagator.free_motion(q[:, None], np.array([tau]))[:, 0] + gain
        su[:, unknowns], sv[:, unknowns] = (q @ propagator.u_q.T).real, (q @ propagator.v_q.T).real
        if propagator.u_p is not None and propagator.v_p is not None:  # massless unknowns
            force, rate = (x[:, unknowns] for x in final)
            su[:, unknowns] += force @ propagator.u_p.T
            sv[:, unknowns] += force @ propagator.v_p.T + rate @ propagator.u_p.T
    return su, sv
