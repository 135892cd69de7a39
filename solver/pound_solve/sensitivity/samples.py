"""Readings of a run, linear quantities at an instant, and their derivatives."""

from __future__ import annotations

from enum import Enum, auto
from typing import NamedTuple

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.sensitivity.dual import Dual
from pound_solve.sensitivity.dual_law import BranchSlopes
from pound_solve.sensitivity.equations import TangentEquations
from pound_solve.sensitivity.instants import Instants


class ObservedKind(Enum):
    """Kind of a reading."""

    ROW = auto()  #: a row of the measured quantities
    DEFORMATION = auto()  #: of a law
    FORCE = auto()  #: of a law with its dashpot
    STATIC_FORCE = auto()  #: of a law without its dashpot
    IMPULSE = auto()  #: integral of the force of a law up to the end


class ObservedValue(NamedTuple):
    """A quantity at an instant.

    Attributes
    ----------
    kind : ObservedKind
    item : int
        Row or law.
    t : float
        Time at which the run has it [T].
    value : float
        That the run has; it tells both sides of a jump apart.
    is_peak : bool
        Whether it is the largest or smallest value of the run.
    """

    kind: ObservedKind
    item: int
    t: float
    value: float
    is_peak: bool = True

    @property
    def is_total(self) -> bool:
        """Return whether it belongs to the whole run, not to an instant."""
        return self.kind is ObservedKind.IMPULSE


class TangentSample(NamedTuple):
    """The motion at one instant, and its derivatives.

    Attributes
    ----------
    x : Instants
        One instant.
    su, sv, sa : ndarray, shape (n_params, n)
        Derivatives of displacements, velocities and accelerations.
    branches : BranchSlopes
    """

    x: Instants
    su: Array
    sv: Array
    sa: Array
    branches: BranchSlopes


def sampled(
    equations: TangentEquations,
    x: Instants,
    branches: BranchSlopes,
    su: Array,
    sv: Array,
    moved: Array | None = None,
) -> TangentSample:
    """Return the sample of one instant.

    Parameters
    ----------
    equations : TangentEquations
    x : Instants
    branches : BranchSlopes
    su, sv : ndarray, shape (n_params, n)
        Derivatives at a fixed time.
    moved : ndarray, shape (n_params,), optional
        Derivative of the instant, which an event determines: the derivatives become those along it.
    """
    if moved is not None:
        su, sv = su + np.outer(moved, x.v[:, 0]), sv + np.outer(moved, x.a[:, 0])
        x = x.moved(moved)
    return TangentSample(x, su, sv, equations.accelerations(x, branches, su, sv), branches)


def read(
    equations: TangentEquations, kind: ObservedKind, index: int, x: Instants, b: BranchSlopes
) -> Array:
    """Return the values of a reading at some instants on the same branches, shape (n_times,)."""
    if kind is ObservedKind.ROW:
        return _row(equations, index, x, b)
    d = equations.deformations(x)[index]
    if kind is ObservedKind.DEFORMATION:
        return np.asarray(d)
    k, c, f0 = b.values[:, index]
    rate = equations.deformations(x, 1)[index]
    return np.asarray(k * d + f0 + (c * rate if kind is ObservedKind.FORCE else 0.0))


def _row(equations: TangentEquations, index: int, x: Instants, b: BranchSlopes) -> Array:
    """Return the values of a measured row."""
    base, rows = equations.base, equations.base.rows
    total = np.full(x.u.shape[1], rows.constant[index])
    for order, (on, y) in enumerate(zip((rows.on_u, rows.on_v, rows.on_a), (x.u, x.v, x.a))):
        total += on[index] @ (base.expand @ y + base.follow @ x.s[order])
    total += rows.on_u[index] @ base.offset
    total += rows.on_s[index] @ np.concatenate(list(x.s[:3]))
    k, c, f0 = b.values[:, :, None]
    forces = k * equations.deformations(x) + c * equations.deformations(x, 1) + f0
    return np.asarray(total + rows.on_f[index] @ forces)


def differentiated(equations: TangentEquations, kind: ObservedKind, index: int, at: TangentSample) -> Dual:
    """Return a reading at a sample, with its derivatives."""
    value = float(read(equations, kind, index, at.x, at.branches)[0])
    base, slopes = equations.base, equations.slopes
    dd, drate = (
        equations.deformations_at_fixed_motion(at.x, order)[..., 0] + s @ base.law_rows.T
        for order, s in enumerate((at.su, at.sv))
    )
    if kind is ObservedKind.DEFORMATION:
        return Dual(value, dd[:, index])
    d, rate = equations.deformations(at.x)[:, 0], equations.deformations(at.x, 1)[:, 0]
    (k, c, _), (dk, dc, df0) = at.branches.values, at.branches.slopes
    df = dk * d + k * dd + df0
    if kind is ObservedKind.STATIC_FORCE:
        return Dual(value, df[:, index])
    df = df + dc * rate + c * drate
    if kind is ObservedKind.FORCE:
        return Dual(value, df[:, index])
    rows, drows = base.rows, slopes.rows
    f = np.array(at.branches.values[0] * d + c * rate + at.branches.values[2])
    s, ds = at.x.s[..., 0], at.x.ds[..., 0]
    total = drows.constant[:, index] + df @ rows.on_f[index] + drows.on_f[:, index] @ f
    total = total + ds[:3].swapaxes(0, 1).reshape(len(total), -1) @ rows.on_s[index]
    total = total + drows.on_s[:, index] @ s[:3].ravel()
    motion = zip(rows[:3], drows[:3], (at.x.u, at.x.v, at.x.a), (at.su, at.sv, at.sa))
    for order, (on, don, y, sy) in enumerate(motion):
        whole = base.expand @ y[:, 0] + base.follow @ s[order]
        change = sy @ base.expand.T + slopes.expand @ y[:, 0]
        change = change + slopes.follow @ s[order] + ds[order] @ base.follow.T
        if order == 0:
            whole, change = whole + base.offset, change + slopes.offset
        total = total + change @ on[index] + don[:, index] @ whole
    return Dual(value, total)
