"""Ibarra-Medina-Krawinkler, peak-oriented: the pinching rule without a break point (see `imk_pinching`).

Reloading goes from zero force to the peak, via the local peak if that path is stiffer.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Spec
from pound_solve.laws.automaton import Law, Numbers
from pound_solve.laws.hysteresis.imk import fields, parameters
from pound_solve.laws.hysteresis.imk_pinching import MODES, RULE

NO_PINCHING: Numbers = (1.0, 0.0)  #: kappa_F and kappa_D without a break point


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two yield forces."""
    return Law(RULE, (*parameters(values, k, fy_plus, fy_minus), *NO_PINCHING))


SPEC = Spec(
    "hysteresis",
    "IMK_PEAK_ORIENTED",
    "peak-oriented with capping and cyclic deterioration",
    fields(MODES, 4),
    reference="Ibarra, Medina & Krawinkler 2005; Lignos & Krawinkler 2011",
    sample="R=0.05 DP=3 DPC=8 RESIDUAL=0.2 LAMBDA=80",
    impl=build,
)
