r"""Modified viscoelastic contact: the dashpot of Kelvin-Voigt, in approach only.

.. math:: f = k\delta + c\dot\delta \ (\dot\delta > 0), \qquad f = k\delta \ (\dot\delta < 0)

The force is continuous where the motion reverses, falls to zero with the overlap, and never pulls (Mahmoud
S, Jankowski R 2011, Modified linear viscoelastic model of earthquake-induced structural pounding, Iranian
J. Sci. Technol. Trans. Civ. Engng 35(C1): 51-62).  The dashpot also acts when bodies approach again before
they have separated.

RELATION=PUBLISHED is their relation, :math:`\xi = (1 - e^2) / (e\,(e(\pi - 2) + 2))`.
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
    BranchKind,
    K,
    Law,
    Numbers,
    Rule,
    above,
    below,
    linear,
)
from pound_solve.laws.contact import restitution
from pound_solve.laws.contact.constants import dashpot, linear_fields
from pound_solve.laws.contact.kelvin_voigt import Built, start

OPEN, APPROACH, PARTING = 0, 1, 2
BRANCHES = (*BranchKind.OPEN.named("open"), *BranchKind.PRESSED.named("pressed", "pressed, parting"))


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch; the deformation is the closure, and overlap = closure - gap."""
    k, c, gap = p[:3]
    if at == OPEN:
        return linear(0.0, 0.0, above(gap))
    if at == APPROACH:
        return linear(k, -k * gap, REVERSAL_DOWN, below(gap), c=c)
    return linear(k, -k * gap, below(gap), REVERSAL_UP)


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a touch, a reversal or a separation."""
    if at == OPEN or (at == PARTING and event == 1):
        return APPROACH, m
    return (PARTING if at == APPROACH and event == 0 else OPEN), m


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy of the contact spring."""
    return 0.0 if at == OPEN else 0.5 * p[K] * (d - p[GAP]) ** 2


RULE = Rule(BRANCHES, start, branch, transition, recoverable, parameters=3, variables=0)


def published(e: float) -> float:
    """Return the published damping ratio for restitution `e`."""
    return (1.0 - e * e) / (e * (e * (math.pi - 2.0) + 2.0))


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Build the law from a card's values (GAP, K, one of C, XI, E; RELATION); see `kelvin_voigt.build`."""
    damper = dashpot(values, reduced_mass, restitution.one_sided, restitution.one_sided_ratio, published)
    return Built(Law(RULE, (values["K"], damper.c, values["GAP"])), values["K"], *damper)


SPEC = Spec(
    "contact",
    "MAHMOUD_JANKOWSKI",
    "spring, and dashpot in approach only",
    linear_fields("Mahmoud & Jankowski 2011"),
    reference="Mahmoud & Jankowski 2011",
    sample="E=0.5",
    impl=build,
)
