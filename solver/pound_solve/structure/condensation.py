"""Static condensation: massless DOFs on linear elements follow the others.

Few unknowns remain, but the matrices are full; this suits the closed-form methods.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pound_solve.numerics.matrices import dense
from pound_solve.numerics.modes import massless
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.dofs import Dof, labels
from pound_solve.structure.reduction import Decision, ReducedSystem


@dataclass(frozen=True)
class Condensed:
    """A reduced system without the massless DOFs that follow the others, and the expansion to all DOFs.

    Attributes
    ----------
    system : ReducedSystem
    keep : ndarray, shape (n_left,)
        Which unknowns remain.
    expand, follow, constant : ndarray, shapes (n, n_left), (n, n_inputs), (n,)
        All unknowns: ``expand u + follow s + constant``.
    loads : ndarray, shape (n, n_inputs + 1)
        FORCES, and held loads in the last column, on the condensed DOFs.
    """

    system: ReducedSystem
    keep: Index
    expand: Array
    follow: Array
    constant: Array
    loads: Array

    def put_in(self, t: Array, before: bool = False) -> Array:
        """Return the work of the loads on condensed DOFs at times `t`, shape (n_times,) [F L].

        It is the work by the part of the displacements that is proportional to the loads, counted from zero
        loads.  With `before` it is the work just before the loads jump at these times.
        """
        s = np.vstack([self.system.excitation.values(t, before=before).T, np.ones(len(t))])
        displacements = np.column_stack([self.follow, self.constant]) @ s
        return np.asarray(0.5 * (displacements * (self.loads @ s)).sum(axis=0))

    def all(self, u: Array, s: Array, order: int = 0) -> Array:
        """Return all unknowns, shape (n,), from the remaining ones `u` and the inputs `s`.

        With `order` 1 or 2, `u`, `s` and the result are velocities or accelerations.  Several instants are
        columns.
        """
        whole = self.expand @ u + self.follow @ s
        return (whole.T + self.constant).T if order == 0 else whole


def condense(system: ReducedSystem) -> Condensed:
    """Condense massless DOFs on linear elements.

    They follow the others exactly if their damping is proportional to their stiffness
    (C_ca + C_cc G = 0) or absent, and if no dashpot resists the loads on them.
    """
    structure, at = system.structure, system.columns
    system = replace(
        system,
        mass=dense(system.mass),
        damping=dense(system.damping),
        stiffness=dense(system.stiffness),
        law_rows=dense(system.law_rows),
        expand=dense(system.expand),
    )
    to_supports, c_to_supports = (
        dense(a[at, structure.n_free :]) for a in (structure.stiffness, structure.damping)
    )
    applied = system.force_inputs[at]
    is_massless = massless(system.mass) & ~np.any(system.law_rows != 0.0, axis=0)
    slave = _condensable(
        np.hstack([system.stiffness, to_supports]),
        np.hstack([system.damping, c_to_supports]),
        np.column_stack([applied, structure.released[at]]),
        is_massless,
    )
    system.decisions.extend(_decisions(system.dofs, slave, is_massless & ~slave))
    keep, s = np.flatnonzero(~slave), np.flatnonzero(slave)
    n, n_inputs = system.inputs.shape
    expand, constant, follow = np.eye(n)[:, keep], np.zeros(n), np.zeros((n, n_inputs))
    if len(s):
        inverse = np.linalg.inv(system.stiffness[np.ix_(s, s)])
        expand[s] = -inverse @ system.stiffness[np.ix_(s, keep)]
        constant[s] = inverse @ system.constant[s]
        follow[s] = inverse @ (applied[s] - to_supports[s] @ system.support_inputs)
    loads = np.zeros((n, n_inputs + 1))
    loads[s] = np.column_stack([applied[s], system.constant[s]])
    inner = replace(
        system,
        dofs=tuple(system.dofs[i] for i in keep),
        mass=expand.T @ system.mass @ expand,
        damping=expand.T @ system.damping @ expand,
        stiffness=expand.T @ system.stiffness @ expand,
        inputs=expand.T @ system.inputs,
        constant=expand.T @ system.constant,
        law_rows=system.law_rows @ expand,
        expand=system.expand @ expand,
        expand_constant=system.expand @ constant,
        expand_inputs=system.expand @ follow,
    )
    return Condensed(inner, keep, expand, follow, constant, loads)


def _decisions(dofs: Sequence[Dof], condensed: Flags, kept: Flags) -> list[Decision]:
    """Decisions about the massless DOFs, for the report."""
    lines = []
    if condensed.any():
        subject = _massless(int(condensed.sum()))
        lines.append(Decision(subject, "condensed", "they follow the others statically, no error is made"))
    if kept.any():
        subject = _massless(int(kept.sum()))
        why = "dashpots move them: " + labels([f for f, keep in zip(dofs, kept) if keep])
        lines.append(Decision(subject, "kept", why))
    return lines


def _massless(count: int) -> str:
    return f"{count} massless degree{'s' * (count != 1)} of freedom"


def _condensable(k: Array, c: Array, applied: Array, is_massless: Flags) -> Flags:
    """Which massless DOFs follow the others exactly; the rest are removed one pass at a time.

    Parameters
    ----------
    k, c : ndarray, shape (n, n + n_moved)
        The columns beyond the unknowns are those of moved supports.
    applied : ndarray, shape (n, n_forces)
        Forces that change in time.
    is_massless : ndarray of bool, shape (n,)
        The candidates.
    """
    none, candidates = np.zeros_like(is_massless), is_massless
    while candidates.any():
        s = np.flatnonzero(candidates)
        values = np.linalg.eigvalsh(k[np.ix_(s, s)])
        if values[0] <= 1e-13 * max(values[-1], 0.0):
            # a mechanism among them, or one that only dashpots resist: the integrator keeps it and can
            # name it
            undamped = candidates & ~np.any(c != 0.0, axis=1)
            if (undamped == candidates).all():
                return none
            candidates = undamped
            continue
        # prescribed DOFs are among the others that they follow
        rest = np.concatenate([np.flatnonzero(~candidates), np.arange(len(is_massless), k.shape[1])])
        g = -np.linalg.solve(k[np.ix_(s, s)], k[np.ix_(s, rest)])
        misfit = np.abs(c[np.ix_(s, rest)] + c[np.ix_(s, s)] @ g).max(axis=1, initial=0.0)
        # a dashpot delays the displacements under the applied forces
        static = np.linalg.solve(k[np.ix_(s, s)], applied[s])
        static /= np.maximum(np.abs(static).max(axis=0, initial=0.0), 1e-300)
        lag = np.abs(c[np.ix_(s, s)] @ static).max(axis=1, initial=0.0)
        bad = np.maximum(misfit, lag) > 1e-11 * max(np.abs(c[s]).max(initial=0.0), 1e-300)
        if not bad.any():
            return candidates
        candidates = candidates.copy()
        candidates[s[bad]] = False
    return none
