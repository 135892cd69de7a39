r"""Sina: reinforced concrete that slips until its cracks close, and is then as stiff as in unloading.

The rule of `slipping`.  A side that has gone beyond its yield point slips from zero force at :math:`d_0`
straight to the point where its cracks close, which lies at the force :math:`F_{cc} F_y` on the unloading
line from :math:`(d_m, F_m)`, and follows that line to :math:`(d_m, F_m)`.  Where :math:`d_0` lies beyond
that point, or the straight line to the peak is flatter, it is loaded straight to the peak.  If a strength
loss has left less than :math:`F_y` at the peak, the cracks close at :math:`F_{cc} F_m` (our choice).

References
----------
Saiidi M, Sozen MA (1979), Simple and complex models for nonlinear seismic response of reinforced concrete
structures, Civil Engng Studies, Structural Research Series 465, Univ. of Illinois, Urbana; Ruaumoko's
rule 8.  Neither source was read; the branches are those of the published model as it is usually described.
What both leave open follows `slipping`.  The parameters of Ruaumoko's rule are not certain.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import Law
from pound_solve.laws.hysteresis.cracking import FIELDS, parameters
from pound_solve.laws.hysteresis.slipping import RULE


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two yield forces."""
    closing = values["FCC"]
    return Law(RULE, (*parameters(values, k, fy_plus, fy_minus), 1.0, 0.0, closing[0], closing[-1]))


SPEC = Spec(
    "hysteresis",
    "SINA",
    "degrading, with cracking and crack closure: reinforced concrete",
    (
        *FIELDS,
        Field(
            "FCC",
            Kind.REAL,
            "-",
            default=(0.3,),
            above=0.0,
            below=1.0,
            count=(1, 2),
            doc="ratio of the force at which cracks close to the yield force, positive and negative side; "
            "one value: both",
        ),
    ),
    reference="Saiidi & Sozen 1979; Ruaumoko rule 8",
    sample="R=0.06 FCR=0.4 RHO=0.4 ALFA=0.4 FCC=0.3",
    impl=build,
)
