r"""Takeda with slip: concrete members whose bars slip, or whose cracks slide.

The rule of `slipping`.  Once a side has gone beyond its yield point, and :math:`d_0` lies on the other
side, it slips with

.. math:: k_s = \frac{F_m}{d_m + d_z'} \left(\frac{d_m}{d_m + d_z'}\right)^{n}, \qquad
          d_z' = d_m' - \frac{F_m'}{k_u'}

until it meets the line from the origin to :math:`(d_m, F_m)`, and then follows that line.

References
----------
Kabeyasawa T, Shiohara H, Otani S, Aoyama H (1983), Analysis of the full-scale seven-story reinforced
concrete test structure, J. Faculty of Engng, Univ. of Tokyo 37(2): 431-478 (slip).  This source was not
read: the branches are those of the material TakedaSlip of K. Ichinohe (2023) for OpenSees, where
:math:`n = 3`.  That material does not bound :math:`b k_u`, and instead of Takeda's rule 6 its force jumps
to the line to the crack point.
Ruaumoko has a rule of this name; its number and parameters are not certain, so no number is accepted.
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
    return Law(RULE, (*parameters(values, k, fy_plus, fy_minus), values["INNER"], values["SLIP"]))


SPEC = Spec(
    "hysteresis",
    "TAKEDA_SLIP",
    "Takeda with slip, with cracking: reinforced concrete",
    (
        *FIELDS,
        Field(
            "SLIP",
            Kind.REAL,
            "-",
            default=3.0,
            lo=0.0,
            hi=20.0,
            doc="exponent n of the slip stiffness; 0: least slip",
        ),
        Field(
            "INNER",
            Kind.REAL,
            "-",
            default=1.0,
            above=0.0,
            hi=1.0,
            doc="ratio of unloading stiffness from a reloading line to that from the backbone",
        ),
    ),
    reference="Takeda, Sozen & Nielsen 1970; Kabeyasawa et al. 1983",
    sample="R=0.06 FCR=0.4 RHO=0.4 ALFA=0.4 SLIP=1",
    impl=build,
)
