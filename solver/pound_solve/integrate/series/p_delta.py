r"""P-Delta with the present axial force in a power series: kernels.

The force across a string (see `structure.corotational`) is the product of two series of its motion,

.. math:: f_k = \frac1L \sum_{j=0}^{k} n_j\, y_{k-j},

known as soon as the motion up to k is known.  It has no potential: the work :math:`\int y^2/2L\;dn` of the
axial force on the shortening that a string leaves out counts as put in.
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.kernels.state import Corotational
from pound_solve.integrate.series.smooth import product_term
from pound_solve.integrate.series.state import PDeltaMembers, Series
from pound_solve.numerics.types import Array
from pound_solve.structure.corotational import ACROSS, AXIAL, LENGTH, N0


def allocate(members: int, n_coefs: int) -> PDeltaMembers:
    """Allocate the given number of `members` for series of `n_coefs` coefficients."""
    return PDeltaMembers(*np.zeros((3, members, n_coefs)))


def quantity_term(members: Corotational, series: Series, c: int, j: int, k: int, n_powers: int) -> float:
    """Return coefficient `k` of quantity `j` of member `c`."""
    total = 0.0
    for y in range(members.pointers[c], members.pointers[c + 1]):
        total += members.rows[y, j] * series.motion[k, members.unknown[y]]
    if k < n_powers:
        for i in range(series.inputs.shape[1]):
            total += members.inputs[c, j, i] * series.inputs[k, i]
    return total


def add_p_delta(members: Corotational, series: Series, k: int, h: float, n_powers: int, new: Array) -> None:
    """Add the coefficients `k` of the strings' forces to the right side `new` of those `k` + 2."""
    p_delta = series.p_delta
    for c in range(len(members.parameters)):
        p_delta.across[c, k] = quantity_term(members, series, c, ACROSS, k, n_powers)
        p_delta.axial[c, k] = quantity_term(members, series, c, AXIAL, k, n_powers)
        if k == 0:
            p_delta.axial[c, 0] += members.parameters[c, N0]
        force = product_term(p_delta.axial[c], p_delta.across[c], k) / members.parameters[c, LENGTH]
        p_delta.force[c, k] = force
        for y in range(members.pointers[c], members.pointers[c + 1]):
            new[members.unknown[y]] -= h * h * members.rows[y, ACROSS] * force


def p_delta_power(members: Corotational, series: Series, degree: int, s: float, h: float) -> float:
    """Return the power that the strings put in at the place `s`, and set the members' transverse forces to
    those there.
    """
    p_delta, power = series.p_delta, 0.0
    for c in range(len(members.parameters)):
        y, rate, force = 0.0, 0.0, 0.0
        for k in range(degree - 2, -1, -1):
            y = y * s + p_delta.across[c, k]
            force = force * s + p_delta.force[c, k]
            if k > 0:
                rate = rate * s + k * p_delta.axial[c, k]
        members.trial.forces[c, ACROSS] = force
        power += 0.5 * y * y / members.parameters[c, LENGTH] * rate / h
    return power
