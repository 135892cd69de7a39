r"""Linear contact: a spring while pressed, :math:`f = k\delta`;
restitution 1 (Kelvin-Voigt without a dashpot).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import Law
from pound_solve.laws.contact.kelvin_voigt import RULE, Built


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Build the law from a card's values (GAP, K)."""
    return Built(Law(RULE, (values["K"], 0.0, values["GAP"])), values["K"], 0.0, 0.0, 1.0, 1.0, "elastic")


SPEC = Spec(
    "contact",
    "LINEAR",
    "spring while closed",
    (Field("K", Kind.REAL, "F/L", above=0, words=("ADJACENT",), doc="contact stiffness"),),
    code=0,
    reference="Maison & Kasai 1990 and others",
    impl=build,
)
