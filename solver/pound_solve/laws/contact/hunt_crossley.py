r"""Hunt-Crossley contact: damping that grows with the force of the spring.

.. math:: f = k\delta^n \Bigl(1 + d\,\frac{\dot\delta}{v_0}\Bigr)

where :math:`v_0` is the approach speed at the instant of touch, which is located as an event (Hunt KH,
Crossley FRE 1975, Coefficient of restitution interpreted as damping in vibroimpact, J. Appl. Mech. 42(2):
440-445).  The force begins and ends at zero.  RELATION=PUBLISHED is their relation, :math:`d = 3(1 - e)/2`,
which is accurate for small losses.

For a contact that touches slowly and is then driven together, or that is closed initially, the damping
would be unbounded.  There :math:`v_0` is replaced by the approach speed at which a free impact reaches the
present overlap,

.. math:: v(\delta) = \sqrt{\frac{k\delta^{n+1}}{(n+1)\,m\,\varphi(d)}}, \qquad
          \varphi(d) = \frac{d - \ln(1 + d)}{d^2},

if that speed is larger, on a separate branch.  No free impact reaches that branch, so free impacts do not
change and no minimum speed has to be chosen.  The damping is then
:math:`d\sqrt{(n+1)\varphi k m}\;\delta^{(n-1)/2}\dot\delta`, like that of POWER_LAW_DAMPED.  If the bodies
are pulled apart faster than :math:`v_0/d`, the force is zero: the contact never pulls.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Spec
from pound_solve.laws.automaton import (
    GAP,
    BranchKind,
    K,
    Law,
    Numbers,
    PowerLawNumbers,
    Rule,
    above,
    below,
    linear,
)
from pound_solve.laws.contact import constants, restitution
from pound_solve.laws.contact.kelvin_voigt import OPEN, PRESSED, Built
from pound_solve.laws.contact.power import (
    EXPONENT,
    drag,
    drag_slope,
    power_fields,
    spring_energy,
    spring_force,
    stiffness_unit,
)

V0 = 0  #: internal variable: approach speed, zero if there was none
BEYOND = 2  #: branch of overlaps that no free impact reaches


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the initial state: open, or pressed if the gap is negative; its variable is the approach
    speed.
    """
    return (BEYOND if p[GAP] < 0.0 else OPEN), (0.0,)


def free_reach(p: Numbers, m: Numbers) -> float:
    """Return the overlap that a free impact reaches; below it the damping for slow touches is larger."""
    k, n, _, constant, slow = p[:5]
    return (slow * m[V0] / (constant * k)) ** (2.0 / (n + 1.0)) if constant > 0.0 else math.inf


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch; the deformation is the closure, and overlap = closure - gap."""
    if at == OPEN:
        return linear(0.0, 0.0, above(p[GAP]))
    if m[V0] == 0.0:  # a free impact reaches no overlap
        return linear(0.0, 0.0, below(p[GAP]))
    far = p[GAP] + free_reach(p, m)
    if far == math.inf:
        return linear(0.0, 0.0, below(p[GAP]))
    return linear(0.0, 0.0, below(p[GAP]), above(far) if at == PRESSED else below(far))


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a touch, after leaving or regaining the reach of a free impact, or after
    separation.
    """
    if at == OPEN:
        return (PRESSED, (v,)) if v > 0.0 else (BEYOND, (0.0,))
    if event == 1:
        return (BEYOND if at == PRESSED else PRESSED), m
    return OPEN, (0.0,)


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy of the contact spring."""
    return 0.0 if at == OPEN else spring_energy(p[K], p[EXPONENT], d - p[GAP])


def curve(
    p: Numbers, at: int, m: Numbers, d0: float, d: float, v: float
) -> tuple[float, float, float, float]:
    """Evaluate the force; `p` contains k, n, gap, d, the coefficient for slow touches, and the mass."""
    if at == OPEN:
        return 0.0, 0.0, 0.0, 0.0
    k, n, gap, constant, slow, mass = p[:6]
    x = d - gap
    work = spring_energy(k, n, x) - spring_energy(k, n, d0 - gap)
    spring = spring_force(k, n, x)
    if at == PRESSED:
        c = constant * spring / m[V0]
        slope = n * c * v / x if x > 0.0 else 0.0
    else:
        c = drag(slow, n, x)
        slope = drag_slope(k, n, mass, x, v, c)
    force = spring + c * v
    if force <= 0.0:
        return 0.0, 0.0, 0.0, work
    return force, n * spring / x + slope, c, work


def power_law(p: Numbers, at: int, m: Numbers) -> PowerLawNumbers:
    """Return the force as powers of the overlap, see `Rule`."""
    k, n, _, constant, slow = p[:5]
    if at == OPEN:
        return 0.0, n, 0.0, n, 0.0, 0.0
    c, q = (constant * k / m[V0], n) if at == PRESSED else (slow, 0.5 * (n - 1.0))
    return k, n, c, q, 0.0, 0.0


RULE = Rule(
    (*BranchKind.OPEN.named("open"), *BranchKind.PRESSED.named("pressed", "pressed, beyond")),
    start,
    branch,
    transition,
    recoverable,
    curve,
    power_law=power_law,
    parameters=6,
    variables=1,
)


def law(k: float, n: float, gap: float, d: float, mass: float) -> Law:
    """Return the law with the damping constant `d`; `mass` is that of the colliding pair [F T^2/L]."""
    slow = d * math.sqrt((n + 1.0) * restitution.phi(d) * k * mass)
    return Law(RULE, (k, n, gap, d, slow, mass))


def build_with(
    values: Mapping[str, Any], reduced_mass: float, n: float, published: constants.Relation
) -> Built:
    """Build the law from a card's values (GAP, K, one of D, E; RELATION), an exponent and the published
    relation.

    Raises
    ------
    ValueError
        Both or neither of D, E are given; or there is no mass.
    """
    constants.damping_item(values, ("D", "E"), reduced_mass)
    damping = constants.constant(
        values, "D", restitution.in_both_phases, restitution.in_both_phases_constant, published
    )
    made = law(values["K"], n, values["GAP"], damping.value, reduced_mass)
    return Built(made, values["K"], math.nan, *damping, unit=stiffness_unit(n))


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Build the law from a card's values; see `build_with`."""
    return build_with(values, reduced_mass, values["N"], lambda e: 1.5 * (1.0 - e))


DOC = "damping constant d"

SPEC = Spec(
    "contact",
    "HUNT_CROSSLEY",
    "power of the overlap, damping proportional to it",
    (*power_fields(1.5), *constants.fields("D", DOC, "Hunt & Crossley 1975")),
    reference="Hunt & Crossley 1975",
    sample="E=0.5",
    impl=build,
)
