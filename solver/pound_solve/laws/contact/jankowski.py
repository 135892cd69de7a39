r"""Non-linear viscoelastic contact: a Hertz spring, and a dashpot in approach only.

.. math:: f = k\delta^{3/2} + 2\xi\sqrt{k\sqrt\delta\,m}\;\dot\delta \ (\dot\delta > 0), \qquad
          f = k\delta^{3/2} \ (\dot\delta < 0)

(Jankowski R 2005, Non-linear viscoelastic modelling of earthquake-induced structural pounding, Earthquake
Engng Struct. Dyn. 34(6): 595-611.)  Here n may be any exponent, with
:math:`2\xi\sqrt{k m}\,\delta^{(n-1)/2}`.

RELATION=PUBLISHED is :math:`\xi = \tfrac{9\sqrt5}{2} \frac{1 - e^2}{e\,(e(9\pi - 16) + 16)}` (Jankowski R
2006, Analytical expression between the impact damping ratio and the coefficient of restitution in the
non-linear viscoelastic model of structural pounding, Earthquake Engng Struct. Dyn. 35(4): 517-524), for
n = 1.5.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Spec
from pound_solve.laws.automaton import (
    GAP,
    REVERSAL_DOWN,
    REVERSAL_UP,
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
from pound_solve.laws.contact.kelvin_voigt import Built, start
from pound_solve.laws.contact.mahmoud_jankowski import APPROACH, BRANCHES, OPEN, transition
from pound_solve.laws.contact.power import (
    EXPONENT,
    drag,
    drag_slope,
    power_fields,
    spring_energy,
    spring_force,
    stiffness_unit,
)
from pound_solve.laws.refusal import ItemError


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch; the deformation is the closure, and overlap = closure - gap."""
    if at == OPEN:
        return linear(0.0, 0.0, above(p[GAP]))
    if at == APPROACH:
        return linear(0.0, 0.0, REVERSAL_DOWN, below(p[GAP]))
    return linear(0.0, 0.0, below(p[GAP]), REVERSAL_UP)


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy of the contact spring."""
    return 0.0 if at == OPEN else spring_energy(p[K], p[EXPONENT], d - p[GAP])


def curve(
    p: Numbers, at: int, m: Numbers, d0: float, d: float, v: float
) -> tuple[float, float, float, float]:
    """Evaluate the force; `p` contains k, n, gap, the coefficient of the dashpot, and the mass."""
    if at == OPEN:
        return 0.0, 0.0, 0.0, 0.0
    k, n, gap, c, mass = p[:5]
    x = d - gap
    spring = spring_force(k, n, x)
    work = spring_energy(k, n, x) - spring_energy(k, n, d0 - gap)
    stiffness = n * spring / x if x > 0.0 else 0.0
    if at != APPROACH:
        return spring, stiffness, 0.0, work
    c = drag(c, n, x)
    return spring + c * v, stiffness + drag_slope(k, n, mass, x, v, c), c, work


def power_law(p: Numbers, at: int, m: Numbers) -> PowerLawNumbers:
    """Return the force as powers of the overlap, see `Rule`."""
    k, n, _, c = p[:4]
    return (0.0 if at == OPEN else k), n, (c if at == APPROACH else 0.0), 0.5 * (n - 1.0), 0.0, 0.0


RULE = Rule(
    BRANCHES, start, branch, transition, recoverable, curve, power_law=power_law, parameters=5, variables=0
)


def published(e: float) -> float:
    """Return the published damping ratio for restitution `e`."""
    return 4.5 * math.sqrt(5.0) * (1.0 - e * e) / (e * (e * (9.0 * math.pi - 16.0) + 16.0))


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Build the law from a card's values (GAP, K, N, one of XI, E; RELATION).

    Raises
    ------
    ValueError
        Both or neither of XI, E are given; there is no mass; or the exponent is not that of the published
        relation.
    """
    k, n = values["K"], values["N"]
    constants.damping_item(values, ("XI", "E"), reduced_mass)
    if values["RELATION"] == "PUBLISHED" and n != 1.5:
        raise ItemError(
            "the published relation of E to XI is for N=1.5: RELATION=EXACT holds for any N", "N"
        )
    scale = math.sqrt(2.0 / (n + 1.0))  # to the damping ratio of the linear law with the same path
    damping = constants.constant(
        values,
        "XI",
        lambda xi: restitution.one_sided(scale * xi),
        lambda e: restitution.one_sided_ratio(e) / scale,
        published,
    )
    c = 2.0 * damping.value * math.sqrt(k * reduced_mass)
    law = Law(RULE, (k, n, values["GAP"], c, reduced_mass))
    return Built(law, k, math.nan, *damping, unit=stiffness_unit(n))


SPEC = Spec(
    "contact",
    "JANKOWSKI",
    "power of the overlap, dashpot in approach only",
    (*power_fields(1.5, linear=False), *constants.fields("XI", "impact damping ratio", "Jankowski 2006")),
    reference="Jankowski 2005, 2006",
    sample="E=0.5",
    impl=build,
)
