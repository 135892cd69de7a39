r"""Q-HYST: reloading towards the largest ductility of either side.

The rule is that of `peak_oriented` with :math:`\beta = 0` and a common :math:`\mu` for both sides: a peak
on one side also moves the target of the other side, and softens its unloading.  With unequal yield forces
the two targets have the same ductility (our choice; the published rule is symmetric).  Saiidi's original
exponent is ALFA=0.5.

References
----------
Saiidi M, Sozen MA (1979), Simple and complex models for nonlinear seismic response of reinforced concrete
structures, Structural Research Series 465, Univ. of Illinois, Urbana; Saiidi M (1982), Hysteresis models
for reinforced concrete, J. Struct. Div. ASCE 108(5): 1077-1087; Ruaumoko's rule 12.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Spec
from pound_solve.laws.automaton import Law
from pound_solve.laws.hysteresis.backbone import ALFA_FIELD, LOSS, R_FIELD, parameters
from pound_solve.laws.hysteresis.peak_oriented import RULE


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two yield forces."""
    return Law(RULE, (*parameters(values, k, fy_plus, fy_minus), 0.0, 1.0))


SPEC = Spec(
    "hysteresis",
    "Q_HYST",
    "degrading stiffness, towards the larger peak",
    (R_FIELD, ALFA_FIELD, *LOSS),
    code=12,
    reference="Saiidi & Sozen 1979; Ruaumoko rule 12",
    sample="R=0.05 ALFA=0.5",
    impl=build,
)
