r"""Derivatives by central differences with two steps, and a bound of their error.

With :math:`D(h) = (f(x+h) - f(x-h)) / 2h`, the extrapolation of Richardson,

.. math:: D = D(h/2) + \tfrac13 (D(h/2) - D(h)),

has an error of the order :math:`h^4` if f is smooth (Dahlquist and Björck 2008, Numerical Methods in
Scientific Computing, volume 1, section 3.4.6).  A kink of f between the outer points, as where another
collision becomes the strongest, is seen in the second differences: with :math:`s(h) = (f(x+h) - 2 f(x) +
f(x-h)) / h`, the difference :math:`s(h/2) - s(h)/2` is of the order :math:`h^3` if f is smooth, and a share
of the jump of the slope if it is not.  The error is therefore taken as

.. math:: |D(h/2) - D(h)| + 2\,|s(h/2) - s(h)/2| + 3\,\epsilon\,|f| / h

where :math:`\epsilon` is the rounding of a value.  For one kink or one jump of f anywhere between the outer
points, the first two terms are at least 1.5 times the difference of D from the slope at x.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

#: places of the values in steps, in the order of `slope`
STENCIL: Final = (-1.0, -0.5, 0.5, 1.0)
ROUNDING: Final = 1e-12  #: of the peaks of a run, relative


class Slope(NamedTuple):
    """A derivative.

    Attributes
    ----------
    value : float
        NaN where there is none.
    error : float
        Bound of its error.
    left, right : float
        Slopes of the inner steps on either side.
    """

    value: float
    error: float
    left: float
    right: float


def slope(center: float, around: Sequence[float], h: float) -> Slope:
    """Derivative from the values at a point and at the places `STENCIL` around it.

    Parameters
    ----------
    center : float
    around : sequence of float
    h : float
        Outer step.
    """
    far_left, left, right, far_right = around
    outer, inner = (far_right - far_left) / (2.0 * h), (right - left) / h
    bent = (far_right - 2.0 * center + far_left) / h, 2.0 * (right - 2.0 * center + left) / h
    size = max(map(abs, (center, *around)))
    error = abs(inner - outer) + 2.0 * abs(bent[1] - 0.5 * bent[0]) + 3.0 * ROUNDING * size / h
    value = inner + (inner - outer) / 3.0
    if not math.isfinite(value):
        return Slope(math.nan, math.inf, math.nan, math.nan)
    return Slope(value, error, 2.0 * (center - left) / h, 2.0 * (right - center) / h)
