"""Checks that the motion of a structure can be computed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pound_solve.numerics.matrices import (
    Matrix,
    by_rows,
    diagonal,
    is_diagonal,
    least_squares,
    scaled,
    used_rows,
)
from pound_solve.numerics.modes import massless, softest
from pound_solve.numerics.types import Array, Flags
from pound_solve.structure.dofs import Dof, label
from pound_solve.structure.structure import Structure


class ReductionError(Exception):
    """Raised for a structure whose motion no method can compute."""


def check_inertia(m: Matrix, dofs: Sequence[Dof]) -> None:
    """Raise ReductionError if mass on the arms of slaved nodes leaves a motion without inertia.

    Parameters
    ----------
    m : Matrix, shape (n, n)
        Mass [F T^2/L].
    dofs : sequence of Dof
        Its rows.
    """
    with_mass = np.flatnonzero(~massless(m))
    part = m[np.ix_(with_mass, with_mass)]
    if is_diagonal(part):
        return
    value, vector = softest(scaled(part, 1.0 / np.sqrt(diagonal(part))))
    if value < 1e-13 * len(with_mass):
        # a rotation in the motion is the one at the other end of the arms
        share = np.abs(vector) * [2.0 if dofs[int(i)][1] == 2 else 1.0 for i in with_mass]
        worst = label(dofs[int(with_mass[int(np.argmax(share))])])
        raise ReductionError(
            f"{worst} has no inertia of its own beside the mass on slaved nodes: "
            "give it a rotational weight WR"
        )


def check_jumps(structure: Structure, jumping: Array, live: Flags) -> None:
    """Raise ReductionError if a sudden force would deform a hysteretic spring instantaneously.

    On DOFs with neither mass nor dashpot the path of that deformation would be undefined.

    Parameters
    ----------
    jumping : ndarray, shape (n_free, n_jumping)
        Forces that jump; loads released at the start are added to them.
    live : ndarray of bool, shape (n_free,)
        The unknowns of the reduced system.
    """
    n = structure.n_free
    quick = live & massless(structure.mass[:n, :n]) & ~used_rows(structure.damping[:n, :n])
    z = np.flatnonzero(quick)
    sudden = np.column_stack([jumping, structure.released[:n]])[z]
    if not sudden.any():
        return
    jump = least_squares(structure.initial_stiffness[np.ix_(z, z)], sudden, 1e-12)
    for spring, (at, row) in zip(structure.laws, by_rows(structure.law_rows[:, z])):
        if not spring.role.reports_damping and np.any(
            np.abs(row @ jump[at]) > 1e-9 * np.abs(row).max(initial=0.0) * np.abs(jump).max()
        ):
            where = int(z[int(np.argmax(np.abs(sudden).max(axis=1)))])
            raise ReductionError(
                f"a force jumps or a load is released at {label(structure.dofs.free[where])}, which has "
                f"no mass, and deforms the spring {spring.element} {spring.component} instantly: give the "
                "node weight, or let the force change within a short time (FORCES)"
            )
