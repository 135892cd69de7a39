r"""Smooth hysteresis in a power series: kernels.

The tangent of a smooth rule depends on a power of a part w of its deformation (see `Rule.smooth_curve`),

.. math:: f = k d + q w + f_0, \qquad (1 + b p)\,\dot w = (1 + a p)\,\dot d, \qquad p = (w/y)^n .

On a branch, and on one side of w = 0, the force therefore has a power series.  Leibniz's rule gives

.. math:: w_k = \frac{1 + a p_0}{1 + b p_0}\,d_k + r_k, \qquad
          k\,(1 + b p_0)\,r_k = \sum_{j=1}^{k-1} (k - j)\,p_j\,(a\,d_{k-j} - b\,w_{k-j}) .

The first part is the tangent at the start of the step, a spring like that of any law (see `springs`), also
for massless unknowns.  The remainder :math:`q r_k` follows from the motion up to k - 1: a known force.
Dashpots in proportion to the tangent have forces in proportion to the rate of f, so they have a remainder,
too.  Every step begins with the closed form of the law, so that errors do not accumulate.

The series of p is a product if n is an integer.  Else it follows from that of w (`power_contacts`), which
converges only up to w = 0.  Near w = 0 the power is left out as long as it changes the force by less than
`POWER_LEFT_OUT`; after that, steps lengthen in proportion to w.
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.events.polynomial_roots import POLYNOMIAL, first_rise
from pound_solve.integrate.events.protocol import LocatedEvent, earlier
from pound_solve.integrate.kernels.allocation import inverse_index
from pound_solve.integrate.kernels.law_state import LawDefinition, LawExtremes, LawMotion, Laws
from pound_solve.integrate.kernels.laws import curved_force, internal, parameters, proportional_damping
from pound_solve.integrate.kernels.products import add_row
from pound_solve.integrate.series.force_events import POWER_CHANGES
from pound_solve.integrate.series.power_contacts import FIRST_STEP, accurate_fraction, power_term
from pound_solve.integrate.series.springs import deformation_term
from pound_solve.integrate.series.state import Series, Smooth, StepControl
from pound_solve.laws.automaton import PAST
from pound_solve.laws.functions import RuleFunctions, smooth_curve_of
from pound_solve.numerics.types import Array, Flags

POWER_LEFT_OUT = 1e-14  #: fraction of the force at w = y that a power left out may make
ZERO = 0.1 * PAST  #: fraction of y below which w counts as zero
POWER_TRUNCATION = 1e-13  #: error of w by truncating the series of the power, as a share of w, at most
CREEP = 100.0  #: multiple of y over the length of the run: the least rate beside which others are judged
#: bits of the largest whole power computed by multiplication; larger ones matter near w = y only
MAX_POWER_BITS = 7
W, Y, N, A, B, Q, SLOPE = range(7)  #: columns of `Smooth.constants`


def allocate(smooth: Flags, n_coefs: int) -> Smooth:
    """Allocate the `smooth` laws for series of `n_coefs` coefficients."""
    laws = np.flatnonzero(smooth)
    n = len(laws)
    return Smooth(
        laws=laws,
        index_of=inverse_index(laws, len(smooth)),
        constants=np.zeros((n, 7)),
        bent=np.zeros(n, bool),
        low=np.zeros(n),
        high=np.zeros(n),
        ratio=np.zeros((n, 2 * MAX_POWER_BITS, n_coefs)),
        ratio_power=np.zeros((n, n_coefs)),
        w=np.zeros((n, n_coefs)),
        remainder=np.zeros((n, n_coefs)),
        force=np.zeros((n, n_coefs)),
    )


def set_rate_floor(largest: LawExtremes, smooth: Smooth, length: float) -> None:
    """Raise the largest rates, the reference for other rates, to a creep over the `length` of the run.
    Otherwise laws at rest would reverse repeatedly with the rounding of other laws' rates.
    """
    for r in range(len(smooth.laws)):
        i, creep = smooth.laws[r], CREEP * abs(smooth.constants[r, Y]) / length
        largest.rate[i] = max(largest.rate[i], creep)


def is_product(n: float) -> bool:
    """Return whether the power `n` is computed by multiplication: a whole number that is not too large."""
    return n == np.floor(n) and n < 2.0**MAX_POWER_BITS


def linearise_smooth(laws: Laws, rules: RuleFunctions, smooth: Smooth) -> None:
    """Replace the branches of the smooth laws by their present tangents, and find the ranges in which their
    series are valid.
    """
    for r in range(len(smooth.laws)):
        i, constants = smooth.laws[r], smooth.constants[r]
        d = laws.now.deformation[i]
        force, tangent, _, _ = curved_force(laws, rules, i, d, 0.0)
        constants[W], constants[Y], constants[N], constants[A], constants[B], k, constants[Q] = (
            smooth_curve_of(
                rules,
                laws.definition.rule[i],
                parameters(laws.definition.parameters, i),
                laws.state.branch[i],
                internal(laws.state.internal, i),
                d,
                force,
            )
        )
        x, n, most = constants[W] / constants[Y], constants[N], max(abs(constants[A]), abs(constants[B]))
        smooth.low[r], smooth.high[r], smooth.bent[r] = 0.0 if x > ZERO else -np.inf, np.inf, most > 0.0
        if most > 0.0 and not is_product(n):
            near = (POWER_LEFT_OUT * (n + 1.0) / most) ** (1.0 / (n + 1.0))
            smooth.bent[r] = x > 0.75 * near
            smooth.low[r] = 0.5 * near if smooth.bent[r] else -near
            smooth.high[r] = np.inf if smooth.bent[r] else near
        constants[SLOPE] = (tangent - k) / constants[Q] if smooth.bent[r] else 1.0
        laws.tangent.stiffness[i] = k + constants[Q] * constants[SLOPE]
        laws.tangent.damping[i] = proportional_damping(laws, i, laws.tangent.stiffness[i])
        laws.tangent.offset[i] = force - laws.tangent.stiffness[i] * d


def product_term(a: Array, b: Array, k: int) -> float:
    """Return coefficient `k` of the product of two series."""
    total = 0.0
    for j in range(k + 1):
        total += a[j] * b[k - j]
    return total


def whole_power_term(ratio: Array, n: int, k: int) -> float:
    """Coefficient `k` of the power `n` of the series in the first row of `ratio`, by squares and products
    that fill the other rows.
    """
    bit, row = 1, 0
    while 2 * bit <= n:
        bit *= 2
    while bit > 1:
        bit //= 2
        ratio[row + 1, k] = product_term(ratio[row], ratio[row], k)
        row += 1
        if n & bit:
            ratio[row + 1, k] = product_term(ratio[row], ratio[0], k)
            row += 1
    power: float = ratio[row, k]
    return power


def compute_term(laws: Laws, series: Series, r: int, k: int, n_powers: int) -> None:
    """Compute the coefficients `k` of deformation, force and power of smooth law `r` from the motion."""
    smooth, i = series.smooth, series.smooth.laws[r]
    constants, ratio = smooth.constants[r], smooth.ratio[r]
    d = deformation_term(laws.definition, series, k, n_powers, i)
    series.deformation[i, k] = d
    smooth.force[r, k] = laws.tangent.stiffness[i] * d + constants[Q] * smooth.remainder[r, k]
    smooth.w[r, k] = constants[SLOPE] * d + smooth.remainder[r, k]
    if k == 0:
        smooth.force[r, 0] += laws.tangent.offset[i]
        smooth.w[r, 0] = constants[W] + constants[SLOPE] * (d - laws.now.deformation[i])
    ratio[0, k] = smooth.w[r, k] / constants[Y]
    if not smooth.bent[r]:
        smooth.ratio_power[r, k] = 0.0
    elif is_product(constants[N]):
        smooth.ratio_power[r, k] = whole_power_term(ratio, int(constants[N]), k)
    else:
        smooth.ratio_power[r, k] = power_term(constants[N], ratio[0, 0], ratio[0], smooth.ratio_power[r], k)


def find_remainders(laws: Laws, series: Series, k: int, n_powers: int) -> None:
    """Compute the coefficients `k` of the smooth laws' parts beyond their tangents, from the motion up to
    `k` - 1.
    """
    smooth = series.smooth
    for r in range(len(smooth.laws)):
        smooth.remainder[r, k] = 0.0
        if k == 0:
            continue
        compute_term(laws, series, r, k - 1, n_powers)
        constants, d = smooth.constants[r], series.deformation[smooth.laws[r]]
        power, w = smooth.ratio_power[r], smooth.w[r]
        total = 0.0
        for j in range(1, k):
            total += (k - j) * power[j] * (constants[A] * d[k - j] - constants[B] * w[k - j])
        smooth.remainder[r, k] = total / (k * (1.0 + constants[B] * power[0]))


def dashpot_remainder(definition: LawDefinition, smooth: Smooth, r: int, k: int, h: float) -> float:
    """Return coefficient `k` of the dashpot force of smooth law `r` beyond that of its tangent."""
    rate = (k + 1) / h * smooth.remainder[r, k + 1]
    force: float = definition.tangent_damping[smooth.laws[r]] * smooth.constants[r, Q] * rate
    return force


def add_remainders(laws: Laws, smooth: Smooth, k: int, h: float, new: Array) -> None:
    """Add the coefficients `k` of the smooth laws' forces beyond their tangents to the right side `new` of
    the coefficients `k` + 2.
    """
    for r in range(len(smooth.laws)):
        force = smooth.constants[r, Q] * smooth.remainder[r, k] + dashpot_remainder(
            laws.definition, smooth, r, k, h
        )
        add_row(laws.definition.rows, smooth.laws[r], -h * h * force, new)


def power_defect(smooth: Smooth, r: int, degree: int, s: float) -> float:
    """Relative error of w/y at the place `s` that comes from truncating the series of its power."""
    constants, ratio = smooth.constants[r], smooth.ratio[r, 0]
    x, power = 0.0, 0.0
    for k in range(degree - 1, -1, -1):
        x = x * s + ratio[k]
        power = power * s + smooth.ratio_power[r, k]
    whole = (x if is_product(constants[N]) else max(x, 0.0)) ** constants[N]
    lacks: float = max(abs(constants[A]), abs(constants[B])) * abs(whole - power) * abs(x - ratio[0])
    return lacks if lacks == 0.0 else lacks / max(abs(x), abs(ratio[0]))


def smooth_valid_up_to(smooth: Smooth, degree: int, end: float) -> float:
    """Return the multiple of a step, at most `end`, up to which the forces are accurate.

    If the series of a power begins with a high term, the last terms do not show its error.  Therefore the
    error at the end is evaluated, too.
    """
    for r in range(len(smooth.laws)):
        end = accurate_fraction(smooth.force[r], degree, end)
        if smooth.bent[r]:
            at = min(end, 1.0)
            lacks = power_defect(smooth, r, degree, at)
            if not lacks <= POWER_TRUNCATION:
                end = at * (POWER_TRUNCATION / lacks) ** (1.0 / degree)
    return end


def bend_event(series: Series, degree: int, first: LocatedEvent, i: int) -> LocatedEvent:
    """The instant at which smooth law `i` leaves the range in which its series is valid, or the `first`
    event.
    """
    smooth, p = series.smooth, series.polynomial[POLYNOMIAL]
    r = smooth.index_of[i]
    for sign in (-1.0, 1.0):
        limit = smooth.low[r] if sign < 0.0 else smooth.high[r]
        if abs(limit) < np.inf:
            for k in range(degree):
                p[k] = sign * smooth.ratio[r, 0, k]
            p[0] -= sign * limit
            p[degree] = 0.0
            first = earlier(first, i, POWER_CHANGES, first_rise(series.polynomial, degree, first.time, 0.0))
    return first


def shorten_for_power_change(now: LawMotion, smooth: Smooth, control: StepControl, i: int) -> None:
    """Shorten the first step in which the power of smooth law `i` is no longer negligible."""
    r = smooth.index_of[i]
    if smooth.high[r] < np.inf:
        far = smooth.high[r] * abs(smooth.constants[r, Y])
        control.next_length = min(control.next_length, FIRST_STEP * far / abs(now.rate[i]))
