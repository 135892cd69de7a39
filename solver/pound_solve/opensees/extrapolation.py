r"""Observed order and limit of a quantity from three halved steps (Richardson).

With values :math:`q_1, q_2, q_4` at the steps h, h/2, h/4 the observed order is
:math:`p = \log_2 |q_1 - q_2| / |q_2 - q_4|`, and the limit :math:`q_4 + (q_4 - q_2)/(2^p - 1)`.  A p above
that of the method, 2, is chance and is taken as 2.  The uncertainty of the limit is Roache's grid
convergence index, :math:`1.25\,|q_4 - q_2|/(2^p - 1)`.  Where the changes do not fall, or turn, they show no
order: the limit is then that of second order, and its uncertainty the larger of both changes.

References
----------
Richardson LF (1911), The approximate arithmetical solution by finite differences of physical problems,
Phil. Trans. R. Soc. A 210: 307-357; Roache PJ (1998), Verification and Validation in Computational Science
and Engineering, Hermosa, Albuquerque.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

FORMAL: Final = 2.0  #: order of Newmark's method with average acceleration
LEAST: Final = 0.5  #: smaller observed orders show no convergence
SAFETY: Final = 1.25  #: Roache's factor for three steps
ROUNDING: Final = 1e-9  #: share of a value below which changes are those of the equation solver


class Limit(NamedTuple):
    """The extrapolated limit of three values.

    Attributes
    ----------
    order : float
        Observed order; NaN where the changes do not show one.
    value : float
        In the unit of the quantity.
    uncertainty : float
        Of the extrapolation itself, in the same unit.
    """

    order: float
    value: float
    uncertainty: float


def limit(coarse: float, middle: float, fine: float) -> Limit:
    """Extrapolate the values at the steps h, h/2 and h/4."""
    first, second = coarse - middle, middle - fine
    floor = ROUNDING * abs(fine)
    order = math.log2(abs(first / second)) if first * second > 0.0 else math.nan
    if abs(first) <= floor or not order >= LEAST:
        value = fine - second / (2.0**FORMAL - 1.0)
        return Limit(math.nan, value, max(abs(first), abs(second), floor))
    change = second / (2.0 ** min(order, FORMAL) - 1.0)
    return Limit(order, fine - change, max(SAFETY * abs(change), floor))
