"""Solutions with a tangent stiffness that may be singular, for a load or for a prescribed displacement."""

from __future__ import annotations

import numpy as np

from pound_solve.numerics.matrices import Matrix, bordered, dense, scaled, used_rows
from pound_solve.numerics.modes import SingularStiffness, scaling
from pound_solve.numerics.types import Array, Index
from pound_solve.structure.dofs import label
from pound_solve.structure.structure import Structure


class InstabilityError(Exception):
    """There is no further equilibrium: a mechanism, identified by its worst DOF; `code` is the message
    number.

    Attributes
    ----------
    motion : ndarray, shape (n_free,), or None
        Motion of a mechanism under the load.
    """

    def __init__(self, why: str, code: str = "A501", motion: Array | None = None) -> None:
        super().__init__(why)
        self.code, self.motion = code, motion


def solve_under_load(structure: Structure, k: Matrix, load: Array, usual: Array) -> Array:
    """Solve K u = load; DOFs without stiffness stay at zero if nothing loads them.

    Loads that are small compared with the `usual` load count as zero.

    Raises
    ------
    InstabilityError
        K is not positive definite on the DOFs moved by the load.
    """
    held = used_rows(k)
    loose = ~held & (load != 0.0)
    if loose.any():
        first = int(np.flatnonzero(loose)[0])
        coupling = dense(structure.law_rows[:, [first]]).ravel()
        touched = any(s.role.collides and x != 0.0 for s, x in zip(structure.laws, coupling))
        hint = ": only an open contact could; HISTORY FROM=REST lets it come down" if touched else ""
        why = f"{name_of(structure, first)} is loaded, but nothing holds it{hint}"
        raise InstabilityError(why, motion=np.where(loose, load, 0.0))
    at, u = np.flatnonzero(held), np.zeros(len(load))
    if not len(at):
        return u
    root = _scales(k[np.ix_(at, at)])
    whole, scaled_load = SingularStiffness(scaled(k[np.ix_(at, at)], root)), root * load[at]
    if whole.negative is not None:
        worst = at[_fastest(whole.negative)]
        raise InstabilityError(
            "the stiffness is negative: the structure has collapsed, "
            f"worst at {name_of(structure, int(worst))}"
        )
    along = whole.null_space.T @ scaled_load
    size = max(float(np.linalg.norm(scaled_load)), float(np.abs(root * usual[at]).max()))
    if np.any(np.abs(along) > 1e-10 * size):
        worst = at[_fastest(whole.null_space @ along)]
        raise InstabilityError(
            f"the loaded structure is a mechanism, worst at {name_of(structure, int(worst))} "
            "(or parts of it are so much stiffer than others that it looks like one: END1, END2 "
            "or SLAVED make parts rigid)",
            motion=_placed(root * (whole.null_space @ along), at, len(load)),
        )
    # an unloaded mechanism (a free diaphragm) stays where it is
    u[at] = root * whole.solve(scaled_load)
    return u


def _placed(x: Array, at: Index, n: int) -> Array:
    """Return values at some of `n` positions and zeros elsewhere, shape (n,)."""
    placed = np.zeros(n)
    placed[at] = x
    return placed


def _fastest(motion: Array) -> int:
    """Return the first of the unknowns that move most, to within 1e-9."""
    size = np.abs(motion)
    return int(np.argmax(size > (1.0 - 1e-9) * size.max()))


def solve_under_control(
    k: Matrix, unit_load: Array, control: Array, force: Array, control_change: float
) -> tuple[Array, float]:
    """Solve ``K u - unit_load y = force`` with ``control . u = control_change`` for u and the load factor
    y; K may be singular or indefinite.

    Raises
    ------
    InstabilityError
        The control does not fix the motion.
    """
    at = np.flatnonzero(used_rows(k) | (unit_load != 0.0) | (control != 0.0))
    root = _scales(k[np.ix_(at, at)])
    whole = scaled(k[np.ix_(at, at)], root)
    p, c, f = root * unit_load[at], root * control[at], root * force[at]
    p_size, c_size = float(np.linalg.norm(p)), float(np.linalg.norm(c))
    if p_size == 0.0:
        raise InstabilityError("the pattern loads nothing that can move", "A505")
    # a mechanism that neither the load nor the control moves (a free diaphragm) stays where it is
    m, null_space = len(at), SingularStiffness(whole).null_space
    idle = null_space[
        :,
        (np.abs((null_space * (whole @ null_space)).sum(axis=0)) < 1e-13 * m)
        & (np.abs(p @ null_space) < 1e-10 * p_size)
        & (np.abs(c @ null_space) < 1e-10 * c_size),
    ]
    x = bordered(
        whole,
        np.column_stack([-p / p_size, idle]),
        np.column_stack([c / c_size, idle]),
        np.concatenate([f, [control_change / c_size], np.zeros(idle.shape[1])]),
    )
    x = x[: m + 1]
    most = max(abs(control_change) / c_size, np.abs(f).max())
    if not np.all(np.isfinite(x)) or np.abs(x).max() > 1e13 * most:
        raise InstabilityError("the forces no longer move the control displacement: other parts give way")
    u = np.zeros(k.shape[0])
    u[at] = root * x[:m]
    return u, float(x[m]) / p_size


def _scales(k: Matrix) -> Array:
    """Return factors as `scaling` does, limited so that negligible stiffness is not scaled up to one."""
    root = scaling(k)
    limited: Array = np.minimum(root, 1e12 * root.min(initial=np.inf))
    return limited


def name_of(structure: Structure, index: int) -> str:
    """Return the name of an unknown in words."""
    return label(structure.dofs.free[index])
