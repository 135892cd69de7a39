r"""Massless joints at the instant at which a law loses its force.

A law that fails may lose its force suddenly.  Massless joints without dashpots (unknowns Z) then
move instantly, and other laws there may yield, unload or fail on the way.  The path is found by gradually
reducing the lost force F of the law, which acts along :math:`b`, while everything else is at rest,

.. math:: K_{ZZ}\,u_Z + f_Z(u_Z) = p_Z - (1 - \lambda)\,F\,b_Z, \qquad 0 \le \lambda \le 1 ,

from one change of branch to the next.  The work of the lost force counts as a loss of the law that
failed; the work of the loads along the path counts as input.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from pound_solve.integrate.protocol import MAX_CHANGES, MAX_CHANGES_PER_LAW, Stop
from pound_solve.integrate.tolerances import LOST_FORCE
from pound_solve.integrate.tracker import ResponseTracker
from pound_solve.laws.automaton import Branch, EventFunction
from pound_solve.numerics import polynomial
from pound_solve.numerics.matrices import dense, used_rows, weighted
from pound_solve.numerics.modes import massless
from pound_solve.numerics.types import Array, Index
from pound_solve.structure.reduction import ReducedSystem

AT_REST = 1e-9  #: fraction of the largest change of a deformation below which a law counts as at rest
PATH_COMPLETE = 1e-13  #: fraction of the largest deformation below which a motion counts as zero
JOINT_ROUNDING = 1e-14  #: rounding of the sum of the forces at a joint, as a fraction of these


class JumpingRun(Protocol):
    """Interface of a run for the release of its massless joints.

    Attributes
    ----------
    u : ndarray, shape (n,)
        Present displacement.
    """

    t: float
    u: Array
    system: ReducedSystem
    tracker: ResponseTracker

    @property
    def branches(self) -> Sequence[Branch]:
        """Present branches of all laws."""

    def force(self, law: int, d: float) -> tuple[float, float]:
        """Return the force of a law at rest at deformation `d`, and its tangent."""

    def transition(self, law: int, event_index: int, d: float, v: float) -> None:
        """Let a law leave its branch at deformation `d` on a path in the direction of `v`."""

    def add_release_work(self, law: int, lost: float, put_in: float) -> None:
        """Add the work `lost` by a dropping force to the work done on its law, and `put_in` by the loads to
        the input.
        """

    def stop(self, code: str, why: str) -> Stop:
        """Return the exception that ends the run here."""


def force_jumps(before: Branch, after: Branch, d: float) -> bool:
    """Return whether the force of a law at rest jumps as it changes branch at the deformation `d`.

    A jump within the rounding of the forces that the branch `before` reaches does not count: if nothing has
    moved yet, `d` itself is rounding.
    """
    ends = [abs(e.constant / e.on_d) for e in before.events if e.on_d != 0.0]
    reach = max(abs(d), *ends, 0.0)
    terms = sum(abs(b.stiffness * reach) + abs(b.force0) for b in (before, after))
    return abs(before.force(d, 0.0) - after.force(d, 0.0)) > LOST_FORCE * terms


def fraction_to_event(event: EventFunction, d: float, move: float) -> float:
    """Return the fraction of the change `move` of a law's deformation from `d` at which an event occurs;
    infinite if it does not.
    """
    if event.on_d == 0.0:
        return 0.0 if event.on_v * move > 0.0 else np.inf
    rise, value = event.on_d * move, event.on_d * d + event.constant
    return max(-value, 0.0) / rise if event.on_v == 0.0 and rise > 0.0 else np.inf


def first_event_on_path(branches: Sequence[Branch], d: Array, move: Array) -> tuple[float, int, int]:
    """Return the fraction of the changes `move` of all deformations `d` up to the first event, its law and
    its number; 1 and -1 if there is none.
    """
    first = 1.0, -1, -1
    for i in np.flatnonzero(np.abs(move) > AT_REST * np.abs(move).max(initial=0.0)).tolist():
        for e, event in enumerate(branches[i].events):
            fraction = fraction_to_event(event, float(d[i]), float(move[i]))
            if fraction < first[0]:
                first = fraction, i, e
    return first


def undamped_massless(system: ReducedSystem, branches: Sequence[Branch]) -> Index:
    """Return the unknowns with neither mass nor dashpot on the present branches."""
    damped = np.flatnonzero([b.damping != 0.0 for b in branches])
    resisted = used_rows(system.damping) | used_rows(system.law_rows[damped].T)
    return np.flatnonzero(massless(system.mass) & ~resisted)


def sizes(system: ReducedSystem, u: Array, force: Array) -> Array:
    """Return the term magnitudes of the forces of structure and laws on the unknowns, shape (n,)."""
    return np.asarray(abs(system.stiffness) @ np.abs(u) + abs(system.law_rows).T @ np.abs(force))


def release(run: JumpingRun, law: int) -> None:
    """Move massless joints to their equilibrium without the force that `law` has lost.

    Raises
    ------
    Stop
        A joint is unrestrained on the way, or the changes of branch do not end.
    """
    system, members = run.system, run.system.structure.corotational
    rows, coefs = system.law_rows, system.excitation.about(np.array([run.t]))[0]
    columns = np.array(system.columns)
    s = polynomial.value(coefs, 0.0, 0)
    for _ in range(MAX_CHANGES + MAX_CHANGES_PER_LAW * len(run.branches)):
        z = undamped_massless(system, run.branches)
        if not len(z):
            return
        d = rows @ run.u + system.law_inputs @ s
        force, tangent = np.array([run.force(i, x) for i, x in enumerate(d.tolist())]).T
        left = (system.inputs @ s + system.constant - system.stiffness @ run.u - rows.T @ force)[z]
        stiffness = dense(system.stiffness[np.ix_(z, z)] + weighted(rows[:, z], tangent))
        if members:
            whole, at = system.all_dofs(run.u, run.t), columns[z]
            left -= members.forces(whole)[at]
            stiffness += dense(members.stiffness(whole)[np.ix_(at, at)])
        if (np.abs(left) <= JOINT_ROUNDING * sizes(system, run.u, force)[z]).all():
            return
        try:
            np.linalg.cholesky(stiffness)
        except np.linalg.LinAlgError:
            name = system.name(int(z[int(np.argmax(np.abs(left)))]))
            raise run.stop("A501", f"{name} has no mass, and does not come to rest where a force is lost: "
                           "give it weight") from None  # fmt: skip
        way = np.linalg.solve(stiffness, left)
        move = rows[:, z] @ way
        if np.abs(move).max(initial=0.0) <= PATH_COMPLETE * np.abs(d).max(initial=0.0):
            return
        fraction, i, e = first_event_on_path(run.branches, d, move)
        run.u[z] += fraction * way
        put_in = float(system.applied(s) @ (system.expand[:, z] @ (fraction * way)))
        run.add_release_work(law, float(left @ way) * (fraction - 0.5 * fraction * fraction), put_in)
        d += fraction * move
        for j in np.flatnonzero(move).tolist():  # extremes occur at the ends of the straight parts
            run.tracker.deformation(j).take(float(d[j]), run.t)
            run.tracker.force(j).take(run.force(j, float(d[j]))[0], run.t)
        if i >= 0:
            run.transition(i, e, float(d[i]), float(move[i]))
    raise run.stop("A503", "the changes of branch where a force is lost do not end")
