r"""Observed order and limit of a quantity from three halved steps (Richardson).

With values :math:`q_1, q_2, q_4` at the steps h, h/2, h/4 the observed order is
:math:`p = \log_2 |q_1 - q_2| / |q_2 - q_4|`, and the limit :math:`q_4 + (q_4 - q_2)/(2^p - 1)`.  Its
uncertainty is Roache's grid convergence index, :math:`3\,|q_4 - q_2|/(2^p - 1)`.

Contacts that close and springs that yield within a step add an error that does not fall evenly.  Where the
observed order is not between 0.5 and 2.2, it is chance: the limit is then that of second order from h and
h/4, :math:`q_4 + (q_4 - q_1)/15`, and the uncertainty Roache's index for two steps, of the worse pair,
:math:`3 \max(|q_4 - q_1|/15,\ |q_4 - q_2|/3)`.

References
----------
Richardson LF (1911), The approximate arithmetical solution by finite differences of physical problems,
Phil. Trans. R. Soc. A 210: 307-357; Roache PJ (1998), Verification and Validation in Computational Science
and Engineering, Hermosa, Albuquerque.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

REGULAR: Final = (0.5, 2.2)  #: observed orders of a method of second order
SAFETY: Final = 3.0  #: of the index, for observed orders that may be chance
ROUNDING: Final = 1e-9  #: share of a value below which changes are those of the equation solver


class Limit(NamedTuple):
    """The extrapolated limit of three values.

    Attributes
    ----------
    order : float
        Observed order; NaN where it is chance.
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
    if abs(first) > floor and REGULAR[0] <= order <= REGULAR[1]:
        change = second / (2.0**order - 1.0)
        return Limit(order, fine - change, max(SAFETY * abs(change), floor))
    outer = (coarse - fine) / 15.0
    return Limit(math.nan, fine - outer, max(SAFETY * max(abs(outer), abs(second) / 3.0), floor))
