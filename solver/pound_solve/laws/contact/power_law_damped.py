r"""Power law with a damping that makes the restitution independent of the speed.

.. math:: f = k\delta^n + \alpha\sqrt{m k}\;\delta^{(n-1)/2}\dot\delta

(Tsuji Y, Tanaka T, Ishida T 1992, Powder Technol. 71: 239-250, for n = 1.5; for any n and with the relation
of RELATION=PUBLISHED, :math:`\alpha = -\sqrt{2(n+1)}\ln e/\sqrt{\pi^2 + \ln^2 e}`: arXiv:2603.27764.)  That
relation is exact with TENSION=YES, where the contact lasts until the overlap is gone.  With TENSION=NO
(default) the force is zero where the sum is negative, and the exact relation is that of the linear contact.

The overlap at which the force vanishes is a nonlinear function of the rate, which no event function can
describe.  The contact therefore stays on its pressed branch until the overlap is gone, without force in the
last part.  The energy that remains in the spring there counts as lost.
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
from pound_solve.laws.contact.kelvin_voigt import OPEN, PRESSED, TENSION, Built
from pound_solve.laws.contact.power import (
    EXPONENT,
    drag,
    drag_slope,
    power_fields,
    spring_energy,
    spring_force,
    stiffness_unit,
)


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the initial state: open, or pressed if the gap is negative."""
    return (PRESSED if p[GAP] < 0.0 else OPEN), ()


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch; the deformation is the closure, and overlap = closure - gap."""
    return linear(0.0, 0.0, above(p[GAP]) if at == OPEN else below(p[GAP]))


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a touch or a separation."""
    return (PRESSED if at == OPEN else OPEN), m


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy of the contact spring."""
    return 0.0 if at == OPEN else spring_energy(p[K], p[EXPONENT], d - p[GAP])


def curve(
    p: Numbers, at: int, m: Numbers, d0: float, d: float, v: float
) -> tuple[float, float, float, float]:
    """Evaluate the force; `p` contains k, n, gap, the dashpot's coefficient, the mass, and whether it may
    pull.
    """
    if at == OPEN:
        return 0.0, 0.0, 0.0, 0.0
    k, n, gap, c, mass, tension = p[:6]
    x = d - gap
    spring = spring_force(k, n, x)
    work = spring_energy(k, n, x) - spring_energy(k, n, d0 - gap)
    c = drag(c, n, x)
    force = spring + c * v
    if x <= 0.0 or (force < 0.0 and tension == 0.0):
        return 0.0, 0.0, 0.0, work
    # at a release with tension the pull vanishes with an infinite slope, which an iteration must not use
    return force, max(n * spring / x + drag_slope(k, n, mass, x, v, c), 0.0), c, work


def power_law(p: Numbers, at: int, m: Numbers) -> PowerLawNumbers:
    """Return the force as powers of the overlap, see `Rule`."""
    k, n, _, c, _, tension = p[:6]
    return (0.0, n, 0.0, n, 0.0, 0.0) if at == OPEN else (k, n, c, 0.5 * (n - 1.0), tension, 0.0)


RULE = Rule(
    (*BranchKind.OPEN.named("open"), *BranchKind.PRESSED.named("pressed")),
    start,
    branch,
    transition,
    recoverable,
    curve,
    power_law=power_law,
    parameters=6,
    variables=0,
)


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Build the law from a card's values (GAP, K, N, one of ALPHA, E; RELATION, TENSION).

    Raises
    ------
    ValueError
        Both or neither of ALPHA, E are given; or there is no mass.
    """
    k, n, tension = values["K"], values["N"], values["TENSION"] == "YES"
    constants.damping_item(values, ("ALPHA", "E"), reduced_mass)
    scale = math.sqrt(2.0 * (n + 1.0))  # from the damping ratio of the linear law with the same path
    restitution_of, exact = (
        (restitution.with_tension, restitution.with_tension_ratio)
        if tension
        else (restitution.no_tension, restitution.no_tension_ratio)
    )
    damping = constants.constant(
        values,
        "ALPHA",
        lambda alpha: restitution_of(alpha / scale),
        lambda e: exact(e) * scale,
        lambda e: restitution.with_tension_ratio(e) * scale,
    )
    c = damping.value * math.sqrt(k * reduced_mass)
    law = Law(RULE, (k, n, values["GAP"], c, reduced_mass, float(tension)))
    return Built(law, k, math.nan, *damping, unit=stiffness_unit(n))


SPEC = Spec(
    "contact",
    "POWER_LAW_DAMPED",
    "power of the overlap, restitution independent of speed",
    (
        *power_fields(1.5, linear=False),
        *constants.fields("ALPHA", "damping constant", "the one with tension"),
        TENSION,
    ),
    reference="Tsuji, Tanaka & Ishida 1992; arXiv:2603.27764",
    sample="E=0.5",
    impl=build,
)
