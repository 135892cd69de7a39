r"""Gonthier's contact: Hunt-Crossley with n = 1.5.

RELATION=PUBLISHED is :math:`d = (1 - e^2)/e`, their approximation of the exact implicit relation
(Gonthier Y, McPhee J, Lange C, Piedboeuf J-C 2004, A regularized contact model with asymmetric damping and
dwell-time dependent friction, Multibody Syst. Dyn. 11: 209-233).
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
    return (1.0 - e * e) / e


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Build the law from a card's values; see `hunt_crossley.build_with`."""
    return build_with(values, reduced_mass, N, published)


SPEC = Spec(
    "contact",
    "GONTHIER",
    "Hertz spring with the damping of Gonthier",
    (stiffness_field(N), *constants.fields("D", DOC, "Gonthier, McPhee, Lange & Piedboeuf 2004")),
    reference="Gonthier, McPhee, Lange & Piedboeuf 2004",
    sample="E=0.5",
    impl=build,
)
