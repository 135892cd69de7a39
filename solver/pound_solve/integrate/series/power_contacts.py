r"""Power contacts, whose force follows powers of the overlap, in a power series: kernels.

The force of a contact whose spring and dashpot grow with powers of the overlap (see `Rule.power_law`),

.. math:: f = k x^n + c x^q \dot x,

has a power series wherever x, the overlap less a constant that is mostly zero, is above zero.  That of a
power :math:`w = x^n` follows from those of x,

.. math:: w_k = \frac{1}{k x_0} \sum_{j=1}^{k} (n j - k + j)\, x_j\, w_{k-j},

(Euler's recurrence), which gives each term of the force from the motion up to the next term; no equation
has to be solved.  The series converges up to the nearest instant of touch, past or future.  Steps
towards it shorten in proportion to the remaining time, down to an overlap `NO_OVERLAP` whose force is
negligible.  The force is zero where it would be tensile, unless the law allows tension.

References
----------
Knuth DE (1997), The Art of Computer Programming 2, 3rd edition, section 4.7 (powers of series).
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.kernels.allocation import inverse_index
from pound_solve.integrate.kernels.law_state import Laws
from pound_solve.integrate.kernels.laws import internal, parameters
from pound_solve.integrate.kernels.products import add_row
from pound_solve.integrate.series.force_events import PARTS, RELEASES, TOUCHES
from pound_solve.integrate.series.springs import deformation_term
from pound_solve.integrate.series.state import PowerContacts, Series, StepControl
from pound_solve.laws.automaton import GAP
from pound_solve.laws.functions import RuleFunctions, power_law_of
from pound_solve.numerics.types import Array, Flags

#: no overlap beyond rounding; a force acts; the force would be tensile, and is zero
APART, PRESSED, FORCE_FREE = range(3)
NO_OVERLAP = 1e-12  #: overlap that counts as none, over the largest deformation
FORCE_TRUNCATION = 1e-10  #: largest last term of the force, as a fraction of the force
FIRST_STEP = 0.4  #: length of the first step after a touch, as a fraction of the time since touch
SPRING, DASHPOT = range(2)  #: rows of `PowerContacts.overlap_powers`
K, N, C, Q, PULLS, SHIFT = range(6)  #: columns of `PowerContacts.constants`


def allocate(curved: Flags, n_coefs: int) -> PowerContacts:
    """Allocate the `curved` laws for series of `n_coefs` coefficients."""
    laws = np.flatnonzero(curved)
    return PowerContacts(
        laws=laws,
        index_of=inverse_index(laws, len(curved)),
        constants=np.zeros((len(laws), 6)),
        phase=np.zeros(len(laws), np.int64),
        overlap_powers=np.zeros((len(laws), 2, n_coefs)),
        force=np.zeros((len(laws), n_coefs)),
        largest=np.zeros(len(laws)),
    )


def overlap(laws: Laws, i: int) -> float:
    """Return the present overlap of contact `i`."""
    x: float = laws.now.deformation[i] - laws.definition.parameters[i, GAP]
    return x


def touch_overlap(laws: Laws, i: int) -> float:
    """Return the overlap of contact `i` up to which it counts as zero."""
    x: float = NO_OVERLAP * (laws.largest.deformation[i] + abs(laws.definition.parameters[i, GAP]))
    return x


def enter_power_contact(laws: Laws, rules: RuleFunctions, contacts: PowerContacts, i: int) -> None:
    """Copy the force law of curved law `i` on its branch, and find its phase: apart, pressed or
    without force.
    """
    r = contacts.index_of[i]
    powers = power_law_of(
        rules,
        laws.definition.rule[i],
        parameters(laws.definition.parameters, i),
        laws.state.branch[i],
        internal(laws.state.internal, i),
    )
    constants = contacts.constants[r]
    constants[K], constants[N], constants[C], constants[Q], constants[PULLS], constants[SHIFT] = powers
    x, v = overlap(laws, i), laws.now.rate[i]
    y = max(x - constants[SHIFT], 0.0)
    if constants[K] == 0.0 or x <= touch_overlap(laws, i):
        contacts.phase[r] = APART
    elif (
        constants[PULLS] > 0.0
        or constants[K] * y ** constants[N] + constants[C] * y ** constants[Q] * v >= 0.0
    ):
        contacts.phase[r] = PRESSED
    else:
        contacts.phase[r] = FORCE_FREE
    contacts.force[r, :] = 0.0


def power_term(n: float, x: float, d: Array, w: Array, k: int) -> float:
    """Return coefficient `k` of the power `n` of an overlap that starts at `x` and changes with the
    deformation `d`; `w` holds the previous coefficients.
    """
    if k == 0:
        first: float = x**n
        return first
    if n == 1.0:
        term: float = d[k]
        return term
    total = 0.0
    for j in range(1, k + 1):
        total += (n * j - (k - j)) * d[j] * w[k - j]
    return total / (k * x)


def force_term(constants: Array, power: Array, x: float, d: Array, k: int, h: float) -> float:
    """Return coefficient `k` of the force of a contact, from those of its deformation `d` up to `k` + 1."""
    spring, dashpot = power[SPRING], power[DASHPOT]
    spring[k] = power_term(constants[N], x, d, spring, k)
    force: float = constants[K] * spring[k]
    if constants[C] != 0.0:
        dashpot[k] = power_term(constants[Q], x, d, dashpot, k)
        drag = 0.0
        for j in range(k + 1):
            drag += dashpot[j] * (k - j + 1) * d[k - j + 1]
        force += constants[C] * drag / h
    return force


def add_contacts(laws: Laws, series: Series, k: int, h: float, n_powers: int, new: Array) -> None:
    """Add the coefficients `k` of the contacts' forces to the right side `new` of those `k` + 2."""
    contacts = series.power_contacts
    for r in range(len(contacts.laws)):
        if contacts.phase[r] == APART:
            continue
        i = contacts.laws[r]
        d = series.deformation[i]
        for m in range(0 if k == 0 else k + 1, k + 2):
            d[m] = deformation_term(laws.definition, series, m, n_powers, i)
        x = d[0] - laws.definition.parameters[i, GAP] - contacts.constants[r, SHIFT]
        force = force_term(contacts.constants[r], contacts.overlap_powers[r], x, d, k, h)
        contacts.force[r, k] = force
        if contacts.phase[r] == PRESSED:
            add_row(laws.definition.rows, i, -h * h * force, new)


def any_overlap(contacts: PowerContacts) -> bool:
    """Return whether any of the contacts has an overlap beyond rounding."""
    overlaps = False
    for r in range(len(contacts.laws)):
        overlaps = overlaps or contacts.phase[r] != APART
    return overlaps


def accurate_fraction(force: Array, degree: int, end: float) -> float:
    """Return the multiple of a step, at most `end`, up to which the series of a force is accurate; NaN if
    its terms are not finite.
    """
    last, most = degree - 2, 0.0
    for k in range(last + 1):
        most = max(most, abs(force[k]))
    tail = max(abs(force[last]), abs(force[last - 1]))
    if not tail < np.inf:
        return np.nan
    return min(end, (FORCE_TRUNCATION * most / tail) ** (1.0 / last)) if tail > 0.0 else end


def contacts_valid_up_to(contacts: PowerContacts, degree: int, end: float) -> float:
    """Return the multiple of a step, at most `end`, up to which the forces of all contacts are accurate."""
    for r in range(len(contacts.laws)):
        if contacts.phase[r] != APART:
            end = accurate_fraction(contacts.force[r], degree, end)
    return end


def change_phase(laws: Laws, contacts: PowerContacts, control: StepControl, i: int, event: int) -> None:
    """Change the phase of contact `i` by an event: its force begins or ends."""
    r = contacts.index_of[i]
    if event == TOUCHES:
        contacts.phase[r] = PRESSED
        control.length_before_contact = max(control.length_before_contact, control.next_length)
        first = FIRST_STEP * overlap(laws, i) / abs(laws.now.rate[i])
        control.next_length = min(control.next_length, first)
    elif event == PARTS:
        contacts.phase[r] = APART
        control.next_length = max(control.next_length, control.length_before_contact)
        control.length_before_contact = 0.0
    else:
        contacts.phase[r] = FORCE_FREE if event == RELEASES else PRESSED
    contacts.force[r, :] = 0.0


def has_force(contacts: PowerContacts, i: int) -> bool:
    """Return whether law `i` is a power contact that presses."""
    return bool(contacts.index_of[i] >= 0 and contacts.phase[contacts.index_of[i]] == PRESSED)
