r"""Dampers whose force is a power of the rate, in a power series: kernels.

The force of a damper (see `Rule.power_law`), :math:`f = \pm c\,x^n` at the rate :math:`x = |\dot d|`, has a
power series wherever it moves.  Euler's recurrence (see `power_contacts`) splits into the tangent at the
start of the step, a linear dashpot, and a remainder that is known from the terms before,

.. math:: f_k = n c\,x_0^{n-1}\,\frac{k+1}{h}\,d_{k+1} \pm r_k, \qquad
          r_k = \frac{1}{k x_0} \sum_{j=1}^{k-1} (n j - k + j)\, x_j\, |f|_{k-j} .

The rates of nodes without mass therefore follow from the spring forces and the tangents; Newton's iteration
finds them at the start of every step (`branches.settle_state`).

The series converges up to the nearest reversal of the damper, past or future; steps shorten in proportion
to the rate.  If the rate or the force is below the fraction `SLOW_RATE` of the largest, the force is linear
through zero.  The errors of this on both sides of a reversal cancel.
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.events.polynomial_roots import POLYNOMIAL, first_rise
from pound_solve.integrate.events.protocol import LocatedEvent, earlier
from pound_solve.integrate.kernels.allocation import inverse_index
from pound_solve.integrate.kernels.law_state import LawDefinition, Laws
from pound_solve.integrate.kernels.laws import internal, parameters
from pound_solve.integrate.kernels.products import add_row
from pound_solve.integrate.series.force_events import CROSSES_LINEAR_RANGE
from pound_solve.integrate.series.power_contacts import K, N, accurate_fraction
from pound_solve.integrate.series.springs import deformation_term
from pound_solve.integrate.series.state import PowerDampers, Series
from pound_solve.laws.functions import RuleFunctions, power_law_of
from pound_solve.numerics.types import Array, Flags

SLOW_RATE = 1e-10  #: fraction of the largest rate, or of the force there, below which it is linear
SLOW_RATE_OF_UNIT = 1e-12  #: the same as a multiple of the unit of rates
DEAD_BAND = 1e-3  #: fraction of this rate between the two events, lest they follow one another
#: fraction of a rate that Newton's iteration changes last: it leaves the square of that
RATE_CONVERGED = 1e-6
RATE_ROUNDING = 1e-15  #: fraction of the velocities whose difference a rate is
LIMIT, RATE = 2, 3  #: columns of `PowerDampers.constants`, beside K and N


def allocate(viscous: Flags, on_massless: Flags, n_coefs: int) -> PowerDampers:
    """Allocate the `viscous` laws for series of `n_coefs` coefficients; the laws `on_massless` hold
    massless unknowns.
    """
    laws = np.flatnonzero(viscous)
    n = len(laws)
    return PowerDampers(
        laws=laws,
        index_of=inverse_index(laws, len(viscous)),
        constants=np.zeros((n, 4)),
        on_massless=np.flatnonzero(on_massless[laws]),
        is_series=np.zeros(n, bool),
        rate=np.zeros((n, n_coefs)),
        remainder=np.zeros((n, n_coefs)),
        force=np.zeros((n, n_coefs)),
    )


def linearise_dampers(laws: Laws, rules: RuleFunctions, dampers: PowerDampers) -> None:
    """Replace the branches of the dampers by their present tangents."""
    tangent = laws.tangent
    for r in range(len(dampers.laws)):
        i, constants = dampers.laws[r], dampers.constants[r]
        constants[K], constants[N], _, _, _, _ = power_law_of(
            rules,
            laws.definition.rule[i],
            parameters(laws.definition.parameters, i),
            laws.state.branch[i],
            internal(laws.state.internal, i),
        )
        dampers.is_series[r], constants[RATE] = False, laws.now.rate[i]
        if constants[K] == 0.0:  # the branch is linear
            continue
        c, n, x = (
            abs(constants[K]),
            constants[N],
            constants[RATE] if constants[K] > 0.0 else -constants[RATE],
        )
        exponent = 1.0 / max(n, 1.0)
        constants[LIMIT] = (
            max(SLOW_RATE_OF_UNIT**exponent, SLOW_RATE**exponent * laws.largest.rate[i])
            if n != 1.0
            else np.inf
        )
        dampers.is_series[r] = x > constants[LIMIT]
        if dampers.is_series[r]:
            tangent.damping[i] = n * c * x ** (n - 1.0)
            tangent.offset[i] = (1.0 - n) * constants[K] * x**n
        else:
            tangent.damping[i] = c if n == 1.0 else c * constants[LIMIT] ** (n - 1.0)
            tangent.offset[i] = 0.0


def is_fast(dampers: PowerDampers, i: int) -> bool:
    """Return whether law `i` is a damper whose force is a series."""
    return bool(dampers.index_of[i] >= 0 and dampers.is_series[dampers.index_of[i]])


def compute_rate_term(laws: Laws, series: Series, r: int, k: int, h: float, n_powers: int) -> None:
    """Compute the coefficients `k` of rate and force of damper `r` from the motion."""
    dampers, i = series.power_dampers, series.power_dampers.laws[r]
    constants, sign = dampers.constants[r], 1.0 if dampers.constants[r, K] > 0.0 else -1.0
    x = sign * (k + 1) / h * deformation_term(laws.definition, series, k + 1, n_powers, i)
    if k == 0:
        x = max(x, constants[LIMIT])
        dampers.force[r, 0] = constants[K] * x ** constants[N]
    else:
        dampers.force[r, k] = sign * laws.tangent.damping[i] * x + dampers.remainder[r, k]
    dampers.rate[r, k] = x


def find_damper_remainders(laws: Laws, series: Series, k: int, h: float, n_powers: int) -> None:
    """Compute the coefficients `k` of the dampers' forces beyond their tangents from the motion."""
    dampers = series.power_dampers
    for r in range(len(dampers.laws)):
        if not dampers.is_series[r]:
            continue
        if k == 0:
            dampers.remainder[r, 0] = 0.0
            continue
        compute_rate_term(laws, series, r, k - 1, h, n_powers)
        n, x, force, total = dampers.constants[r, N], dampers.rate[r], dampers.force[r], 0.0
        for j in range(1, k):
            total += (n * j - (k - j)) * x[j] * force[k - j]
        dampers.remainder[r, k] = total / (k * x[0])


def add_damper_remainders(
    definition: LawDefinition, dampers: PowerDampers, k: int, h: float, new: Array
) -> None:
    """Add the coefficients `k` of the dampers' forces beyond their tangents to the right side `new` of the
    coefficients `k` + 2.
    """
    for r in range(len(dampers.laws)):
        if dampers.is_series[r]:
            add_row(definition.rows, dampers.laws[r], -h * h * dampers.remainder[r, k], new)


def dampers_valid_up_to(dampers: PowerDampers, degree: int, end: float) -> float:
    """Return the multiple of a step, at most `end`, up to which the dampers' forces are accurate, and the
    rates of dampers that hold massless unknowns.
    """
    for r in range(len(dampers.laws)):
        if dampers.is_series[r]:
            end = accurate_fraction(dampers.force[r], degree, end)
    for r in dampers.on_massless:
        if dampers.is_series[r]:
            end = accurate_fraction(dampers.rate[r], degree, end)
    return end


def turn_event(series: Series, degree: int, h: float, first: LocatedEvent, i: int) -> LocatedEvent:
    """The instant at which the rate of damper `i` passes the limit of its power series, or the `first`
    event.
    """
    dampers, d, p = series.power_dampers, series.deformation[i], series.polynomial[POLYNOMIAL]
    r = dampers.index_of[i]
    k, limit = dampers.constants[r, K], dampers.constants[r, LIMIT]
    if k == 0.0 or limit == np.inf:
        return first
    sign = -1.0 if dampers.is_series[r] else 1.0
    for q in range(degree):
        p[q] = (sign if k > 0.0 else -sign) * (q + 1) / h * d[q + 1]
    p[degree] = 0.0
    p[0] -= sign * (1.0 + sign * DEAD_BAND) * limit
    return earlier(first, i, CROSSES_LINEAR_RANGE, first_rise(series.polynomial, degree, first.time, 0.0))


def tangents_settled(laws: Laws, dampers: PowerDampers, velocity: Array) -> bool:
    """Whether the tangents of the dampers that hold massless unknowns were taken at the present rates,
    within the tolerance of Newton's iteration and the rounding of the `velocity` of the unknowns.
    """
    rows = laws.definition.rows
    for r in dampers.on_massless:
        i, constants = dampers.laws[r], dampers.constants[r]
        if constants[K] != 0.0 and constants[N] != 1.0:
            v, size = laws.now.rate[i], 0.0
            for q in range(rows.pointers[i], rows.pointers[i + 1]):
                size += abs(rows.values[q] * velocity[rows.columns[q]])
            if (
                abs(v - constants[RATE])
                > RATE_CONVERGED * max(abs(v), constants[LIMIT]) + RATE_ROUNDING * size
            ):
                return False
    return True
