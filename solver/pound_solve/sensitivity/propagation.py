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

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pound_solve.integrate.propagators.base import Propagator, gauss
from pound_solve.numerics.types import Array, Index
from pound_solve.sensitivity.dual_law import BranchSlopes
from pound_solve.sensitivity.equations import TangentEquations
from pound_solve.sensitivity.instants import InputSlopes, instants
from pound_solve.sensitivity.trajectory import SmoothPiece

AT_ONCE = 2**21  #: numbers of the load R that are evaluated at once


class Carried(NamedTuple):
    """Derivatives after some intervals, shape (n_params, n) or (n_params, n_laws).

    Attributes
    ----------
    su, sv : ndarray
        Of displacements and velocities at the end.
    impulse : ndarray
        Of the integrals of the laws' forces over the intervals.
    """

    su: Array
    sv: Array
    impulse: Array


def carried(
    equations: TangentEquations,
    input_slopes: InputSlopes,
    piece: SmoothPiece,
    branches: BranchSlopes,
    chosen: Index,
    tau: float,
    start: tuple[Array, Array],
) -> Carried:
    """Return the derivatives after some intervals of a piece.

    Parameters
    ----------
    equations : TangentEquations
    input_slopes : InputSlopes
    piece : SmoothPiece
    branches : BranchSlopes
        Of the piece.
    chosen : ndarray of int
        Successive intervals, each followed over `tau`.
    tau : float
        Their length, or for one interval a part of it [T].
    start : tuple of ndarray, shape (n_params, n) each
        Derivatives at the start of the first one.
    """
    present = piece.dense.subsystems.present
    radius = max((x.decomposition.propagator.spectral_radius for x in present), default=0.0)
    weights, points = gauss(tau, radius)
    at_once = max(1, AT_ONCE // (len(points) * start[0].size))
    k, c, _ = branches.values
    rows, impulse = equations.base.law_rows, np.zeros((equations.n_params, len(k)))
    su, sv = start
    for first in range(0, len(chosen), at_once):
        some = chosen[first : first + at_once]
        inner = instants(piece, some, points, input_slopes)
        load = equations.residual(inner, branches).reshape(*su.shape, len(some), len(points))
        load = load.transpose(0, 2, 3, 1)
        before, area = su, np.zeros_like(su)
        su, sv = su.copy(), sv.copy()
        for subsystem in present:
            unknowns, propagator = subsystem.decomposition.unknowns, subsystem.decomposition.propagator
            q = propagator.state_of(su[:, unknowns].T, sv[:, unknowns].T).T
            q, total = marched(propagator, q, load[..., unknowns], weights, tau - points, tau)
            su[:, unknowns], sv[:, unknowns] = (q @ propagator.u_q.T).real, (q @ propagator.v_q.T).real
            area[:, unknowns] = (total @ propagator.u_q.T).real
            if propagator.u_p is not None and propagator.v_p is not None:  # massless unknowns
                end = instants(piece, some[-1:], np.array([tau]), input_slopes)
                force, rate = (equations.residual(end, branches, order)[:, unknowns, 0] for order in (0, 1))
                su[:, unknowns] += force @ propagator.u_p.T
                sv[:, unknowns] += force @ propagator.v_p.T + rate @ propagator.u_p.T
                over_time = np.einsum("k,pmkn->pn", weights, load[..., unknowns])
                area[:, unknowns] += over_time @ propagator.u_p.T
        fixed = equations.forces_at_fixed_motion(inner, branches)
        impulse += fixed @ np.tile(weights, len(some)) + k * (area @ rows.T) + c * ((su - before) @ rows.T)
    return Carried(su, sv, impulse)


def marched(
    propagator: Propagator, q: NDArray[Any], load: Array, weights: Array, left: Array, tau: float
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the state of the derivatives after intervals of length `tau`, and its integral over them,
    shape (n_params, n_q) each.

    Parameters
    ----------
    propagator : Propagator
    q : ndarray, shape (n_params, n_q)
        State at the start.
    load : ndarray, shape (n_params, n_intervals, n_points, n)
        R at Gauss points with their `weights`, `left` before the ends of the intervals.
    """
    forcing = propagator.load_forcing(load)
    gained = np.einsum("k,pmkq->pmq", weights, propagator.free_motion(forcing, left))
    total = np.einsum("k,pmkq->pq", weights, propagator.free_integral(forcing, left))
    step = np.array([tau])
    for gain in gained.swapaxes(0, 1):
        total = total + propagator.free_integral(q[:, None], step)[:, 0]
        q = propagator.free_motion(q[:, None], step)[:, 0] + gain
    return q, total
