"""Elastic, perfectly plastic: the bilinear rule without hardening (see `bilinear`)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Spec
from pound_solve.laws.automaton import Law
from pound_solve.laws.hysteresis import degrading_bilinear
from pound_solve.laws.hysteresis.backbone import LOSS, loses_strength
from pound_solve.laws.hysteresis.bilinear import RULE


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a stiffness and the two yield forces."""
    if loses_strength(values):
        return degrading_bilinear.build(values, k, fy_plus, fy_minus)
    return Law(RULE, (k, fy_plus, fy_minus))


SPEC = Spec(
    "hysteresis",
    "ELASTO_PLASTIC",
    "elastic, perfectly plastic",
    LOSS,
    code=1,
    reference="Prandtl; Ruaumoko rule 1",
    impl=build,
)
