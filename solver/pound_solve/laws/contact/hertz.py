r"""Hertz contact: :math:`f = k\delta^n` while pressed, n = 1.5 for round bodies; restitution 1.

This is Hunt-Crossley without damping.  Hertz H (1882), Ueber die Beruehrung fester elastischer Koerper, J.
reine angew. Math. 92: 156-171.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Spec
from pound_solve.laws.contact.hunt_crossley import law
from pound_solve.laws.contact.kelvin_voigt import Built
from pound_solve.laws.contact.power import power_fields, stiffness_unit


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Build the law from a card's values (GAP, K, N)."""
    k, n = values["K"], values["N"]
    made = law(k, n, values["GAP"], 0.0, reduced_mass)
    return Built(made, k, math.nan, 0.0, 1.0, 1.0, "elastic", stiffness_unit(n))


SPEC = Spec(
    "contact", "HERTZ", "power of the overlap", power_fields(1.5), reference="Hertz 1882", impl=build
)
