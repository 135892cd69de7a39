r"""Modified Kelvin contact: Hunt-Crossley with n = 1, without a force jump at touch or release.

RELATION=PUBLISHED is :math:`d = 3(1 - e)/(2e)` (Ye K, Li L, Zhu H 2009, A modified Kelvin impact model for
pounding simulation of base-isolated building with adjacent structures, Earthquake Engng Engng Vib. 8:
433-446).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Spec
from pound_solve.laws.contact import constants
from pound_solve.laws.contact.hunt_crossley import DOC, build_with
from pound_solve.laws.contact.kelvin_voigt import Built
from pound_solve.laws.contact.power import stiffness_field

N = 1.0  #: exponent


def published(e: float) -> float:
    """Return the published damping constant for restitution `e`."""
    return 1.5 * (1.0 - e) / e


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Build the law from a card's values; see `hunt_crossley.build_with`."""
    return build_with(values, reduced_mass, N, published)


SPEC = Spec(
    "contact",
    "MODIFIED_KELVIN",
    "linear spring, damping proportional to its force",
    (stiffness_field(N), *constants.fields("D", DOC, "Ye, Li & Zhu 2009")),
    reference="Ye, Li & Zhu 2009",
    sample="E=0.5",
    impl=build,
)
