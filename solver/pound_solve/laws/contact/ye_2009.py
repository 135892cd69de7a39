r"""Corrected Hertzdamp: Hunt-Crossley with n = 1.5 and the damping of Ye, Li and Zhu.

RELATION=PUBLISHED is :math:`d = 8(1 - e)/(5e)` (Ye K, Li L, Zhu H 2009, A note on the Hertz contact model
with nonlinear damping for pounding simulation, Earthquake Engng Struct. Dyn. 38(9): 1135-1142; the same
relation in Flores P et al. 2011, Multibody Syst. Dyn. 25: 357-375).
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
    return 1.6 * (1.0 - e) / e


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Build the law from a card's values; see `hunt_crossley.build_with`."""
    return build_with(values, reduced_mass, N, published)


SPEC = Spec(
    "contact",
    "YE_2009",
    "Hertzdamp with the damping corrected",
    (stiffness_field(N), *constants.fields("D", DOC, "Ye, Li & Zhu 2009")),
    reference="Ye, Li & Zhu 2009; Flores et al. 2011",
    sample="E=0.5",
    impl=build,
)
