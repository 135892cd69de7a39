r"""Clough's degrading stiffness: a side reloads straight to its peak.

The rule of `peak_oriented` with :math:`\beta = 0`.  ALFA=0, the default, is Clough's original rule:
unloading with the initial stiffness.  A spring that reverses at zero force, or any distance beyond it, also
aims at the peak, not at the point from which it unloaded.

References
----------
Clough RW, Johnston SB (1966), Effect of stiffness degradation on earthquake ductility requirements, Proc.
Japan Earthquake Engng Symp., Tokyo: 227-232; Otani S (1981), J. Faculty of Engng, Univ. of Tokyo 36(2):
407-441 (unloading by a power of the ductility); Ruaumoko's rule 11.
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
    return Law(RULE, parameters(values, k, fy_plus, fy_minus))


SPEC = Spec(
    "hysteresis",
    "CLOUGH",
    "degrading stiffness, peak-oriented",
    (R_FIELD, ALFA_FIELD, *LOSS),
    code=11,
    reference="Clough & Johnston 1966; Ruaumoko rule 11",
    sample="R=0.05",
    impl=build,
)
