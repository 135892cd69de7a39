r"""Rubber bumper of limited thickness: elastic in approach, damped in restitution, stiff when fully
compressed.

.. math:: F(\delta) = k\delta^n \ (\delta \le \delta_u), \qquad
          F(\delta) = k\delta_u^n + k_u(\delta - \delta_u) \ (\delta > \delta_u), \qquad
          f = F \ (\dot\delta > 0), \qquad f = F\Bigl(1 + d\,\frac{\dot\delta}{v_0}\Bigr) \ (\dot\delta < 0)

after Polycarpou PC, Komodromos P, Polycarpou AC (2013), A nonlinear impact model for simulating the use of
rubber shock absorbers for mitigating the effects of structural pounding during earthquakes, Earthquake
Engng Struct. Dyn. 42(1): 81-100.  Only the abstract was available.  The model (the spring, the damping in
restitution only, the stiff branch beyond a limit), the defaults N = 2.65 and LIMIT = 0.8 and the published
relation :math:`d = 1.55 (1 - e^2) / e^{0.7076}` are quoted from memory.  The relation fits the exact one to
within 0.016 in e for e of 0.2 and above.  Use measured values for a real bumper.

It is our choice that the damping also acts on the stiff branch: the force is then continuous, and the
restitution has the required value for any overlap.

After a slow touch the damping would be unbounded.  Therefore :math:`v_0` is never less than the approach
speed at which a free impact reaches the overlap at which the motion reversed,
:math:`\sqrt{2\int F\,d\delta/m}`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import (
    GAP,
    REVERSAL_DOWN,
    REVERSAL_UP,
    BranchKind,
    Law,
    Numbers,
    PowerLawNumbers,
    Rule,
    above,
    below,
    linear,
)
from pound_solve.laws.contact import constants, restitution
from pound_solve.laws.contact.kelvin_voigt import Built
from pound_solve.laws.contact.power import power_fields, spring_energy, spring_force, stiffness_unit
from pound_solve.laws.refusal import ItemError

OPEN, APPROACH, PARTING, STIFF_APPROACH, STIFF_PARTING = range(5)  #: stiff: the rubber is fully compressed
# parameters of a law besides K, EXPONENT and GAP: limit, stiffness beyond it, damping constant d, mass
LIMIT, K_BEYOND, D, MASS = 3, 4, 5, 6
V0 = 0  #: internal variable: the speed v0


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the initial state: open, or pressed if the gap is negative; its variable is the speed v0."""
    if p[GAP] >= 0.0:
        return OPEN, (0.0,)
    return (APPROACH if -p[GAP] <= p[LIMIT] else STIFF_APPROACH), (0.0,)


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch; the deformation is the closure, and overlap = closure - gap."""
    gap, limit = p[GAP], p[LIMIT]
    if at == OPEN:
        return linear(0.0, 0.0, above(gap))
    if at == STIFF_APPROACH:
        return linear(0.0, 0.0, REVERSAL_DOWN)
    if at == STIFF_PARTING:
        return linear(0.0, 0.0, below(gap + limit), REVERSAL_UP)
    if at == PARTING:
        return linear(0.0, 0.0, below(gap), REVERSAL_UP)
    if limit == math.inf:
        return linear(0.0, 0.0, REVERSAL_DOWN, below(gap))
    return linear(0.0, 0.0, REVERSAL_DOWN, below(gap), above(gap + limit))


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a touch, a reversal, passing the limit of the rubber either way, or a
    separation.
    """
    if at == OPEN:
        return APPROACH, (max(v, 0.0),)
    approaching = at in (APPROACH, STIFF_APPROACH)
    if approaching and event == 0:
        _, _, energy = spring(p, d - p[GAP])
        v0 = max(m[V0], math.sqrt(2.0 * energy / p[MASS]))
        return (PARTING if at == APPROACH else STIFF_PARTING), (v0,)
    if approaching:
        return (STIFF_APPROACH, m) if event == 2 else (OPEN, (0.0,))
    if event == 1:
        return (APPROACH if at == PARTING else STIFF_APPROACH), m
    return (PARTING, m) if at == STIFF_PARTING else (OPEN, (0.0,))


def spring(p: Numbers, x: float) -> tuple[float, float, float]:
    """Return the force of the bumper without damping, its stiffness, and its energy."""
    k, n, _, limit, k_beyond = p[:D]
    if x <= 0.0:
        return 0.0, 0.0, 0.0
    if x <= limit:
        force = spring_force(k, n, x)
        return force, n * force / x, spring_energy(k, n, x)
    force, beyond = spring_force(k, n, limit), x - limit
    energy = spring_energy(k, n, limit) + (force + 0.5 * k_beyond * beyond) * beyond
    return force + k_beyond * beyond, k_beyond, energy


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy of the bumper."""
    return 0.0 if at == OPEN else spring(p, d - p[GAP])[2]


def curve(
    p: Numbers, at: int, m: Numbers, d0: float, d: float, v: float
) -> tuple[float, float, float, float]:
    """Evaluate the force; `p` contains k, n, gap, the limit, the stiffness beyond it, d, and the mass."""
    if at == OPEN:
        return 0.0, 0.0, 0.0, 0.0
    force, stiffness, energy = spring(p, d - p[GAP])
    work = energy - spring(p, d0 - p[GAP])[2]
    if at in (APPROACH, STIFF_APPROACH) or m[V0] == 0.0:
        return force, stiffness, 0.0, work
    c, slope = p[D] * force / m[V0], p[D] * stiffness / m[V0]
    if force + c * v <= 0.0:
        return 0.0, 0.0, 0.0, work
    return force + c * v, stiffness + slope * v, c, work


def power_law(p: Numbers, at: int, m: Numbers) -> PowerLawNumbers:
    """Return the force as powers of the overlap, see `Rule`."""
    k, n, _, limit, k_beyond, constant = p[:MASS]
    if at == OPEN:
        return 0.0, n, 0.0, n, 0.0, 0.0
    by_rate = constant / m[V0] if at in (PARTING, STIFF_PARTING) and m[V0] > 0.0 else 0.0
    if at in (APPROACH, PARTING):
        return k, n, by_rate * k, n, 0.0, 0.0
    shift = limit - spring_force(k, n, limit) / k_beyond
    return k_beyond, 1.0, by_rate * k_beyond, 1.0, 0.0, shift


RULE = Rule(
    (
        *BranchKind.OPEN.named("open"),
        *BranchKind.PRESSED.named("pressed", "pressed, parting", "used up", "used up, parting"),
    ),
    start,
    branch,
    transition,
    recoverable,
    curve,
    power_law=power_law,
    parameters=7,
    variables=1,
)


def published(e: float) -> float:
    """Return the published damping constant for restitution `e`, a fit to the exact relation."""
    c: float = 1.55 * (1.0 - e * e) / e**0.7076
    return c


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Build the law from a card's values (GAP, K, N, THICKNESS, LIMIT, KU, one of D, E; RELATION).

    Raises
    ------
    ValueError
        Both or neither of D, E are given; only one of THICKNESS and KU is given; or there is no mass.
    """
    k, n, thickness, ku = (values[x] for x in ("K", "N", "THICKNESS", "KU"))
    if (thickness is None) != (ku is None):
        raise ItemError(
            "THICKNESS and KU, the stiffness beyond its limit, go together",
            "KU" if thickness is None else "THICKNESS",
        )
    constants.damping_item(values, ("D", "E"), reduced_mass)
    damping = constants.constant(
        values, "D", restitution.in_restitution, restitution.in_restitution_constant, published
    )
    limit = math.inf if thickness is None else values["LIMIT"] * thickness
    law = Law(RULE, (k, n, values["GAP"], limit, ku or 0.0, damping.value, reduced_mass))
    end = math.inf if thickness is None else thickness
    return Built(law, k, math.nan, *damping, unit=stiffness_unit(n), limit=end)


SPEC = Spec(
    "contact",
    "RUBBER_BUMPER",
    "rubber of limited thickness, damped in restitution",
    (
        *power_fields(2.65),
        Field("THICKNESS", Kind.REAL, "L", default=None, above=0, doc="thickness; omitted: unlimited"),
        Field("LIMIT", Kind.REAL, "-", default=0.8, above=0, hi=1, doc="soft fraction of the thickness"),
        Field("KU", Kind.REAL, "F/L", default=None, above=0, doc="stiffness beyond the limit"),
        *constants.fields("D", "damping constant d", "their fit"),
    ),
    reference="Polycarpou, Komodromos & Polycarpou 2013",
    sample="E=0.5",
    impl=build,
)
