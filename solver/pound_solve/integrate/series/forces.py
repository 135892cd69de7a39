"""Kernels for forces that are separate series: of closed rigid contacts, curved contacts, smooth laws and
dampers."""

from __future__ import annotations

from pound_solve.integrate.kernels.law_state import Laws, LawTangent
from pound_solve.integrate.series.curved import PRESSED, enter_curved, has_force
from pound_solve.integrate.series.friction import is_sliding, set_sliding_direction, update_friction
from pound_solve.integrate.series.rigid import is_closed
from pound_solve.integrate.series.smooth import dashpot_remainder
from pound_solve.integrate.series.state import Series
from pound_solve.integrate.series.viscous import is_fast
from pound_solve.laws.functions import Tables
from pound_solve.numerics.types import Array


def take_over(laws: Laws, rules: Tables, series: Series, i: int) -> None:
    """Copy the branch that law `i` has changed to into the arrays of curved contacts and of friction."""
    if series.curved.index_of[i] >= 0:
        enter_curved(laws, rules, series.curved, i)
    if series.friction.index_of[i] >= 0:
        set_sliding_direction(laws.state, series.friction, i)


def has_series(series: Series, i: int) -> bool:
    """Whether the force of law `i` is a series of its own."""
    contact = is_closed(series.rigid, i) or has_force(series.curved, i) or is_sliding(series.friction, i)
    return contact or series.smooth.index_of[i] >= 0 or is_fast(series.viscous, i)


def copy_force(series: Series, degree: int, i: int, sign: float, out: Array) -> None:
    """Put `sign` times the series of the force of law `i`, which has one, into `out`."""
    rigid, curved, friction = (
        series.rigid.index_of[i],
        series.curved.index_of[i],
        series.friction.index_of[i],
    )
    smooth, viscous = series.smooth.index_of[i], series.viscous.index_of[i]
    for k in range(degree + 1):
        out[k] = 0.0
    for k in range(degree - 1):
        if rigid >= 0:
            out[k] = sign * series.rigid.force[rigid, k]
        elif curved >= 0:
            out[k] = sign * series.curved.force[curved, k]
        elif smooth >= 0:
            out[k] = sign * series.smooth.force[smooth, k]
        elif viscous >= 0:
            out[k] = sign * series.viscous.force[viscous, k]
        else:
            out[k] = sign * series.friction.force[friction, k]


def whole_force(laws: Laws, series: Series, degree: int, h: float, i: int, out: Array) -> None:
    """Put the series of the force of law `i` into `out`, all dashpots included."""
    tangent = laws.tangent
    smooth, d = series.smooth, series.deformation[i]
    r, damping = smooth.index_of[i], tangent.damping[i]
    if has_series(series, i):
        copy_force(series, degree, i, 1.0, out)
        if r >= 0:
            for k in range(degree - 1):
                out[k] += damping * (k + 1) / h * d[k + 1] + dashpot_remainder(
                    laws.definition, smooth, r, k, h
                )
        return
    acts = 1.0 if series.curved.index_of[i] < 0 else 0.0  # which presses nothing now
    for k in range(degree + 1):
        out[k] = acts * tangent.stiffness[i] * d[k]
    out[0] += acts * tangent.offset[i]
    if damping != 0.0:
        for k in range(degree):
            out[k] += acts * damping * (k + 1) / h * d[k + 1]


def force_at(force: Array, degree: int, s: float) -> float:
    """Force at the place `s` of a step whose series has this `degree`."""
    value = 0.0
    for k in range(degree - 2, -1, -1):
        value = value * s + force[k]
    return value


def update_branch_forces(laws: Laws, series: Series, degree: int, s: float, h: float) -> None:
    """Set the offsets of rigid and curved contacts and of friction to their forces at the place `s`."""
    update_friction(laws, series, degree, s, h)
    rigid, curved = series.rigid, series.curved
    for q in range(rigid.n_closed[0]):
        r = rigid.closed[q]
        laws.tangent.offset[rigid.laws[r]] = force_at(rigid.force[r], degree, s)
    for r in range(len(curved.laws)):
        laws.tangent.offset[curved.laws[r]] = (
            force_at(curved.force[r], degree, s) if curved.phase[r] == PRESSED else 0.0
        )


def count_largest(tangent: LawTangent, series: Series) -> None:
    """Update the largest force of each rigid and curved contact."""
    rigid, curved = series.rigid, series.curved
    for r in range(len(rigid.laws)):
        rigid.largest[r] = max(rigid.largest[r], abs(tangent.offset[rigid.laws[r]]))
    for r in range(len(curved.laws)):
        curved.largest[r] = max(curved.largest[r], abs(tangent.offset[curved.laws[r]]))
