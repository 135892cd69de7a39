"""Kernels for forces that are separate series: of closed rigid contacts, power contacts, smooth laws and
dampers.

For a motion of degree n, such a force is known up to the degree n - 2, because the coefficients `k` + 2 of
the motion follow from the coefficients `k` of the forces.
"""

from __future__ import annotations

from pound_solve.integrate.kernels.law_state import Laws, LawTangent
from pound_solve.integrate.series.friction import is_sliding, set_sliding_direction, update_friction
from pound_solve.integrate.series.power_contacts import PRESSED, enter_power_contact, has_force
from pound_solve.integrate.series.power_dampers import is_fast
from pound_solve.integrate.series.rigid import is_closed
from pound_solve.integrate.series.smooth import dashpot_remainder
from pound_solve.integrate.series.state import Series
from pound_solve.laws.functions import RuleFunctions
from pound_solve.numerics.types import Array


def refresh_branch_series(laws: Laws, rules: RuleFunctions, series: Series, i: int) -> None:
    """Copy the branch that law `i` has changed to into the arrays of power contacts and of friction."""
    if series.power_contacts.index_of[i] >= 0:
        enter_power_contact(laws, rules, series.power_contacts, i)
    if series.friction.index_of[i] >= 0:
        set_sliding_direction(laws.state, series.friction, i)


def has_series(series: Series, i: int) -> bool:
    """Return whether the force of law `i` is a separate series."""
    pressed = is_closed(series.rigid, i) or has_force(series.power_contacts, i)
    smooth = series.smooth.index_of[i] >= 0
    return pressed or is_sliding(series.friction, i) or smooth or is_fast(series.power_dampers, i)


def copy_force(series: Series, degree: int, i: int, sign: float, out: Array) -> None:
    """Put `sign` times the series of the force of law `i`, which has one, into `out`."""
    rigid, curved, friction = (
        series.rigid.index_of[i],
        series.power_contacts.index_of[i],
        series.friction.index_of[i],
    )
    smooth, viscous = series.smooth.index_of[i], series.power_dampers.index_of[i]
    for k in range(degree + 1):
        out[k] = 0.0
    for k in range(degree - 1):
        if rigid >= 0:
            out[k] = sign * series.rigid.force[rigid, k]
        elif curved >= 0:
            out[k] = sign * series.power_contacts.force[curved, k]
        elif smooth >= 0:
            out[k] = sign * series.smooth.force[smooth, k]
        elif viscous >= 0:
            out[k] = sign * series.power_dampers.force[viscous, k]
        else:
            out[k] = sign * series.friction.force[friction, k]


def total_force(laws: Laws, series: Series, degree: int, h: float, i: int, out: Array) -> None:
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
    # a power contact without force is left out
    acts = 1.0 if series.power_contacts.index_of[i] < 0 else 0.0
    for k in range(degree + 1):
        out[k] = acts * tangent.stiffness[i] * d[k]
    out[0] += acts * tangent.offset[i]
    if damping != 0.0:
        for k in range(degree):
            out[k] += acts * damping * (k + 1) / h * d[k + 1]


def force_at(force: Array, degree: int, s: float) -> float:
    """Return the force at the place `s` of a step whose series has this `degree`."""
    value = 0.0
    for k in range(degree - 2, -1, -1):
        value = value * s + force[k]
    return value


def update_branch_forces(laws: Laws, series: Series, degree: int, s: float, h: float) -> None:
    """Set the offsets of rigid and power contacts and of friction to their forces at the place `s`."""
    update_friction(laws, series, degree, s, h)
    rigid, contacts = series.rigid, series.power_contacts
    for q in range(rigid.n_closed[0]):
        r = rigid.closed[q]
        laws.tangent.offset[rigid.laws[r]] = force_at(rigid.force[r], degree, s)
    for r in range(len(contacts.laws)):
        laws.tangent.offset[contacts.laws[r]] = (
            force_at(contacts.force[r], degree, s) if contacts.phase[r] == PRESSED else 0.0
        )


def update_largest_forces(tangent: LawTangent, series: Series) -> None:
    """Update the largest force of each rigid and power contact."""
    rigid, contacts = series.rigid, series.power_contacts
    for r in range(len(rigid.laws)):
        rigid.largest[r] = max(rigid.largest[r], abs(tangent.offset[rigid.laws[r]]))
    for r in range(len(contacts.laws)):
        contacts.largest[r] = max(contacts.largest[r], abs(tangent.offset[contacts.laws[r]]))
