"""Modal decomposition of a subsystem: its exact motion for one set of stiffnesses, cached for reuse.

Yielding springs and closing contacts return repeatedly to the same stiffnesses, so a run with hundreds of
events needs only a few decompositions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pound_solve.integrate.closed_form.work_integrals import WorkIntegrals
from pound_solve.integrate.events.functions import RowSet
from pound_solve.integrate.propagators.base import Propagator, real_rows
from pound_solve.integrate.propagators.modal import ModalPropagator
from pound_solve.integrate.propagators.series import SeriesPropagator
from pound_solve.integrate.propagators.state_space import Mechanism, held_space, state_space
from pound_solve.integrate.rigid.contacts import RigidContacts
from pound_solve.laws.automaton import Branch
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.reduction import ReducedSystem

MAX_CONDITION = 1e6  #: condition number of the mode matrix above which the exponential series is used
MAX_RESIDUAL = 1e-10  #: residual of the modes, likewise


def make_propagator(m: Array, c: Array, k: Array, inputs: Array, rows: Array | None = None) -> Propagator:
    """Return the exact motion of a subsystem: in modes, or by series if the modes are defective.

    Parameters
    ----------
    m, c, k : ndarray, shape (n, n)
        Mass, damping and stiffness, symmetric.
    inputs : ndarray, shape (n, n_inputs)
        Loads of unit inputs.
    rows : ndarray, shape (n_held, n), or None
        Deformations with prescribed values (see `held_space`).

    Raises
    ------
    Mechanism
        There are massless DOFs with neither stiffness nor dashpot.
    """
    if rows is None:
        space = state_space(m, c, k)
    else:
        space = held_space(m, c, k, rows)
        inputs = np.vstack([inputs, np.zeros((3 * len(rows), inputs.shape[1]))])
    try:
        propagator = ModalPropagator(space, inputs)
    except np.linalg.LinAlgError:
        return SeriesPropagator(space, inputs)
    sound = propagator.condition < MAX_CONDITION and propagator.residual < MAX_RESIDUAL
    return propagator if sound else SeriesPropagator(space, inputs)


@dataclass(frozen=True)
class Reactions:
    """Forces of the rigid contacts that a subsystem holds closed: ``on_q q + on_p p + on_rate p'``.

    Attributes
    ----------
    laws : ndarray of int, shape (n_held,)
    rows : ndarray of int, shape (n_held,)
        Rows of the contacts among those of the run.
    gaps : ndarray, shape (n_held,)
    inputs : ndarray, shape (n_held, n_inputs)
        The prescribed deformations of the unknowns are ``gaps - inputs s``.
    on_q : ndarray, shape (n_held, n_q)
    on_p, on_rate : ndarray, shape (n_held, n + 3 n_held)
        Factors of the loads, extended as in `held_space`.
    """

    laws: Index
    rows: Index
    gaps: Array
    inputs: Array
    on_q: NDArray[Any]
    on_p: Array
    on_rate: Array

    def extended(self, loads: Array, input_coefs: Array) -> Array:
        """Return load polynomials (n_intervals, degree + 1, n + 3 n_held) with the prescribed deformations
        and their derivatives in the last columns, from input polynomials.
        """
        m, orders = len(self.laws), np.arange(1, input_coefs.shape[1])[:, None]
        loads = loads.copy()
        x, first, second = (loads[..., i * m - 3 * m : (i * m - 2 * m) or None] for i in range(3))
        x[:] = -input_coefs @ self.inputs.T
        x[:, 0] += self.gaps
        first[:, :-1] = x[:, 1:] * orders
        second[:, :-1] = first[:, 1:] * orders
        return loads


class JoinedPart(NamedTuple):
    """A decomposition within a joined one: its position in the state, its unknowns and its work
    integrals.
    """

    q: slice
    unknowns: Index
    work: WorkIntegrals


@dataclass(frozen=True)
class Decomposition:
    """Exact motion of a subsystem for one set of stiffnesses.

    Attributes
    ----------
    unknowns : ndarray of int, shape (n,)
    laws : ndarray of int
        Laws that act within the subsystem.
    propagator : Propagator
    monitored : ndarray of int, shape (n_monitored,)
        Rows of the run that depend on the unknowns of the subsystem.
    index_of : list of int
        Index of every row of the run in `monitored`, or -1.
    rows : ndarray, shape (n_monitored, n)
    rows_q, rows_q_size : ndarray, shape (n_monitored, n_q)
        The rows on q, and their magnitudes.
    sampled_q : ndarray, shape (3 n_monitored, n_q or 2 n_q)
        Values, rates and second rates of the rows from `propagator.real_parts` of q.
    motion_q : ndarray, shape (3 n, n_q or 2 n_q)
        Displacements, velocities and accelerations from the same.
    enveloped : ndarray of int, shape (n_enveloped,)
        Indices of the unknowns whose motion the envelopes need.
    enveloped_motion_q : ndarray, shape (3 n_enveloped, n_q or 2 n_q)
        `motion_q` of these unknowns.
    parts : tuple of Part
    reactions : Reactions or None
    """

    unknowns: Index
    laws: Index
    propagator: Propagator
    monitored: Index
    index_of: list[int]
    rows: Array
    rows_q: NDArray[Any]
    rows_q_size: Array
    sampled_q: Array
    motion_q: Array
    enveloped: Index
    enveloped_motion_q: Array
    parts: tuple[JoinedPart, ...]
    reactions: Reactions | None


class Decomposer:
    """Factory of the decompositions of a run.

    Parameters
    ----------
    system : ReducedSystem
    rigid : RigidContacts
    rows : RowSet
        The rows of the run; those of the reactions of rigid contacts are zero.
    reaction_row : dict of int to int
        Row of the reaction of every rigid contact.
    enveloped : ndarray of bool, shape (n,)
        Unknowns whose motion the envelopes need.
    """

    def __init__(
        self,
        system: ReducedSystem,
        rigid: RigidContacts,
        rows: RowSet,
        reaction_row: dict[int, int],
        enveloped: Flags,
    ) -> None:
        self.system, self.rigid, self.rows = system, rigid, rows.rows
        self.reaction_row, self.enveloped = reaction_row, enveloped

    def decompose(self, unknowns: Index, laws: Index, branches: Sequence[Branch]) -> Decomposition:
        """Return the motion of some unknowns with the `laws` that act on them, on their `branches`.

        Raises
        ------
        Mechanism
            There are massless DOFs with neither stiffness nor dashpot; the shape covers all unknowns of the
            system.
        """
        system, block = self.system, np.ix_(unknowns, unknowns)
        b = system.law_rows[np.ix_(laws, unknowns)]
        k = system.stiffness[block] + (b.T * [branches[i].stiffness for i in laws]) @ b
        c = system.damping[block] + (b.T * [branches[i].damping for i in laws]) @ b
        constrained = np.array([i for i in laws if branches[i].constrains], np.intp)
        constrained_rows = system.law_rows[np.ix_(constrained, unknowns)] if len(constrained) else None
        inputs = system.inputs[unknowns]
        try:
            propagator = make_propagator(system.mass[block], c, k, inputs, constrained_rows)
        except Mechanism as err:
            shape = np.zeros(system.size)
            shape[unknowns] = err.shape
            raise Mechanism(shape, err.softens) from None
        dashpots = [
            (int(i), branches[i].damping, system.law_rows[i, unknowns]) for i in laws if branches[i].damping
        ]
        work = WorkIntegrals(propagator, system.damping[block], inputs, dashpots)
        parts = (JoinedPart(slice(None), unknowns, work),)
        reactions = self._reactions(constrained, unknowns, propagator, c, k) if len(constrained) else None
        return self._with_rows(unknowns, laws, propagator, parts, reactions)

    def join(self, decompositions: Sequence[Decomposition]) -> Decomposition:
        """Join several modal decompositions without massless DOFs; their modes remain separate."""
        propagator = ModalPropagator.joined(
            [x.propagator for x in decompositions if isinstance(x.propagator, ModalPropagator)]
        )
        ends = np.cumsum([0, *(x.rows_q.shape[1] for x in decompositions)]).tolist()
        parts = [
            part._replace(q=slice(i, j))
            for x, i, j in zip(decompositions, ends, ends[1:])
            for part in x.parts
        ]
        unknowns = np.concatenate([x.unknowns for x in decompositions])
        laws = np.concatenate([x.laws for x in decompositions])
        return self._with_rows(unknowns, laws, propagator, tuple(parts), None)

    def _with_rows(
        self,
        unknowns: Index,
        laws: Index,
        propagator: Propagator,
        parts: tuple[JoinedPart, ...],
        reactions: Reactions | None,
    ) -> Decomposition:
        """Return a decomposition with the matrices from its state to rows and unknowns."""
        monitored = np.flatnonzero(np.any(self.rows[:, unknowns] != 0, axis=1))
        index_of = [-1] * len(self.rows)
        for i, row in enumerate(monitored.tolist()):
            index_of[row] = i
        rows = self.rows[np.ix_(monitored, unknowns)]
        rows_q = rows @ propagator.u_q
        acceleration_q = propagator.rate_rows(propagator.v_q)
        motion_q = real_rows(np.vstack([propagator.u_q, propagator.v_q, acceleration_q]))
        enveloped = np.flatnonzero(self.enveloped[unknowns])
        return Decomposition(
            unknowns=unknowns,
            laws=laws,
            propagator=propagator,
            monitored=monitored,
            index_of=index_of,
            rows=rows,
            rows_q=rows_q,
            rows_q_size=np.abs(rows_q),
            sampled_q=np.concatenate([rows @ x for x in np.split(motion_q, 3)]),
            motion_q=motion_q,
            enveloped=enveloped,
            enveloped_motion_q=np.concatenate([x[enveloped] for x in np.split(motion_q, 3)]),
            parts=parts,
            reactions=reactions,
        )

    def _reactions(
        self, constrained: Index, unknowns: Index, propagator: Propagator, c: Array, k: Array
    ) -> Reactions:
        """Return the reactions from ``G f = B M^-1 (p - C v - K u) - x''``, see `rigid.contacts`,
        `held_space`.
        """
        assert propagator.u_p is not None and propagator.v_p is not None  # for all constraints
        at = np.array([self.rigid.laws.index(i) for i in constrained], np.intp)
        inverse = self.rigid.inverse(at)
        x = inverse @ self.rigid.velocity_change[np.ix_(unknowns, at)].T
        on_p = -x @ (k @ propagator.u_p + c @ propagator.v_p)
        on_p[:, : len(unknowns)] += x
        on_p[:, on_p.shape[1] - len(constrained) :] -= inverse
        return Reactions(
            laws=constrained,
            rows=np.array([self.reaction_row[i] for i in constrained], np.intp),
            gaps=self.rigid.gap[at],
            inputs=self.rigid.inputs[at],
            on_q=-x @ (k @ propagator.u_q + c @ propagator.v_q),
            on_p=on_p,
            on_rate=-x @ c @ propagator.u_p,
        )
