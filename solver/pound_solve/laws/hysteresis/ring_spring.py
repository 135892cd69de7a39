r"""Ring spring: conical rings that slide on each other, with a constant ratio of the two forces.

A friction ring spring needs a force :math:`f` to be compressed further, and returns with the fraction
:math:`\lambda` of this force, whatever the deformation.  With the preload :math:`F_y` the two lines of the
positive side are

.. math:: f_{up} = F_y + r k (d - d_y), \qquad f_{low} = \lambda f_{up}, \qquad d_y = F_y / k

They are joined by lines with the initial stiffness :math:`k`, that of the rods and the cartridge.  The
lower line meets the elastic line :math:`f = k d` at the force
:math:`\lambda (1 - r) F_y / (1 - \lambda r)`, so no residual deformation remains.

The automaton is that of `flag_shaped`, whose lower line is parallel to the upper one.

References
----------
For cones with the angle :math:`\beta` and the angle of friction :math:`\varphi`, statics of one ring gives
:math:`\lambda = \tan(\beta - \varphi) / \tan(\beta + \varphi)`.  Ruaumoko's rule 18 (Hill 1994) is one for
ring springs.  No source that we could read states its branches, so no number is accepted.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import Law
from pound_solve.laws.hysteresis.backbone import R_FIELD
from pound_solve.laws.hysteresis.flag_shaped import RULE
from pound_solve.laws.mirror import need_both_sides


def build(values: Mapping[str, Any], k: float, fy_plus: float, fy_minus: float) -> Law:
    """Build the rule from a card's values, a stiffness and the two preloads."""
    need_both_sides(fy_plus, fy_minus)
    r, lower = values["R"], values["LOWER"]
    low = lower * (1.0 - r) / (1.0 - lower * r)
    return Law(RULE, (k, fy_plus, fy_minus, r, lower * r, low))


SPEC = Spec(
    "hysteresis",
    "RING_SPRING",
    "friction ring spring, self-centring",
    (
        R_FIELD,
        Field(
            "LOWER",
            Kind.REAL,
            "-",
            above=0.0,
            below=1.0,
            doc="ratio of the force on the way back to the force on the way out",
        ),
    ),
    reference="statics of a conical ring",
    sample="R=0.1 LOWER=0.4",
    impl=build,
)
