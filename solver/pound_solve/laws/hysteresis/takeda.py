r"""Modified Takeda (bilinear): reloading towards a point of the backbone before the peak.

The rule of `peak_oriented`: unloading with :math:`k_u = k \mu^{-\alpha}`, reloading to the backbone at
:math:`d_m - \beta (d_m - d_y)`, where :math:`d_m` is the peak and :math:`d_m - d_y` its plastic part.
:math:`\beta = 0` aims at the peak.  Usual values range from ALFA=0.5 BETA=0 (thin loops, columns) to
ALFA=0.3 BETA=0.6 (fat loops, beams).

Not implemented, because no available source states them exactly: Ruaumoko's KKK (unloading after Drain-2D
or after Emori and Schnobrich 1978) and NF (power of the reloading; NF=1 is this straight line).

References
----------
Takeda T, Sozen MA, Nielsen NN (1970), Reinforced concrete response to simulated earthquakes, J. Struct.
Div. ASCE 96(12): 2557-2573 (the original, trilinear); Otani S (1974), SAKE, Structural Research Series 413,
Univ. of Illinois, Urbana, and (1981), J. Faculty of Engng, Univ. of Tokyo 36(2): 407-441 (the bilinear
form); Grant DN, Blandon CA, Priestley MJN (2005), Modelling inelastic response in direct displacement-based
design, IUSS Press, Pavia (usual values); Ruaumoko's rule 4 (ALFA, BETA).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import Law
from pound_solve.laws.hysteresis.backbone import ALFA_FIELD, LOSS, R_FIELD, parameters
from pound_solve.laws.hysteresis.peak_oriented import RULE


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two yield forces."""
    return Law(RULE, (*parameters(values, k, fy_plus, fy_minus), values["BETA"]))


SPEC = Spec(
    "hysteresis",
    "TAKEDA",
    "modified Takeda, for reinforced concrete",
    (
        R_FIELD,
        ALFA_FIELD,
        Field(
            "BETA",
            Kind.REAL,
            "-",
            default=0.0,
            lo=0.0,
            hi=1.0,
            doc="reloading aims short of the peak by this share of plastic deformation",
        ),
        *LOSS,
    ),
    code=4,
    reference="Takeda, Sozen & Nielsen 1970; Otani 1974; Ruaumoko rule 4",
    sample="R=0.05 ALFA=0.4 BETA=0.3",
    impl=build,
)
