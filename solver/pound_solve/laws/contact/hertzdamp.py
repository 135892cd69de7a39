r"""Hertzdamp: Hunt-Crossley with n = 1.5 and the damping of Lankarani and Nikravesh.

RELATION=PUBLISHED is :math:`d = 3(1 - e^2)/4` (Lankarani HM, Nikravesh PE 1990, A contact force model with
hysteresis damping for impact analysis of multibody systems, J. Mech. Design 112(3): 369-376; for pounding
Muthukumar S, DesRoches R 2006, A Hertz contact model with non-linear damping for pounding simulation,
Earthquake Engng Struct. Dyn. 35(7): 811-828); it is valid near e = 1 only.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Spec
from pound_solve.laws.contact import constants
from pound_solve.laws.contact.hunt_crossley import DOC, build_with
from pound_solve.laws.contact.kelvin_voigt import Built
from pound_solve.laws.contact.power import stiffness_field

N = 1.5  #: exponent


def published(e: float) -> float:
    """Return the published damping constant for restitution `e`."""
    return 0.75 * (1.0 - e * e)


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Build the law from a card's values; see `hunt_crossley.build_with`."""
    return build_with(values, reduced_mass, N, published)


SPEC = Spec(
    "contact",
    "HERTZDAMP",
    "Hertz spring with the damping of Lankarani and Nikravesh",
    (stiffness_field(N), *constants.fields("D", DOC, "Lankarani & Nikravesh 1990")),
    reference="Lankarani & Nikravesh 1990; Muthukumar & DesRoches 2006",
    sample="E=0.5",
    impl=build,
)
