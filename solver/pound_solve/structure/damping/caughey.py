r"""CAUGHEY: a series with given ratios at as many frequencies, as a constant matrix.

.. math:: C = M \sum_{b=0}^{n-1} a_b (M^{-1}K)^b, \qquad
          2\xi(\omega)\,\omega = \sum_{b=0}^{n-1} a_b\,\omega^{2b}

The second is a polynomial in :math:`\omega^2` through n points.  It is written in Lagrange's form and
summed mode by mode, :math:`C = M \Phi\,\mathrm{diag}(2\xi_n\omega_n)\,\Phi^T M`: the coefficients
:math:`a_b`, which differ by many powers of ten, are never formed, nor are powers of matrices, and
Massless DOFs, for which the series has no meaning, are not damped (Bernal 1994).

Two terms are Rayleigh damping.  With more terms the ratio oscillates between the points and diverges beyond
the last, upwards for an even number and downwards for an odd one. A negative ratio of any mode, or anywhere
between the points, is an error.

References
----------
Caughey TK (1960), Classical normal modes in damped linear dynamic systems, J. Appl. Mech. 27(2): 269-271.
Bernal D (1994), Viscous damping in inelastic structural response, J. Struct. Engng ASCE 120(4): 1240-1254.
"""

from __future__ import annotations

import numpy as np

from pound_deck.model import Card
from pound_deck.schema import Field, Kind, Spec
from pound_solve.numerics.types import Array
from pound_solve.structure.damping.base import (
    AFTER,
    BUILDING,
    NODES,
    CardDamping,
    DampingContext,
    DampingError,
    apart,
    frequencies,
    ratios,
    span,
    values,
)

BETWEEN = 64  #: places between two neighbouring points at which the sign of the ratio is checked


def rates(omega: Array, at: Array, xi: Array) -> Array:
    r""":math:`2\xi\omega` of the series through ratios `xi` at `at`, for frequencies `omega`."""
    total = np.zeros_like(omega)
    for i, (w, x) in enumerate(zip(at, xi)):
        others = np.delete(at, i)
        # differences of squares as products keep their digits
        shares = (omega[:, None] - others) * (omega[:, None] + others) / ((w - others) * (w + others))
        total += 2.0 * x * w * shares.prod(axis=1)
    return total


def build(card: Card, context: DampingContext) -> CardDamping:
    """Damping of the whole structure, or of one building of several."""
    modes = context.modes(context.nodes(card), None)
    at = frequencies(card, lambda: modes.omega, context)
    xi = ratios(card, len(at))
    apart(at, "OMEGA" if card["OMEGA"] is not None else "MODES")
    of_modes = rates(modes.omega, at, xi)
    floor = -1e-12 * float((xi * at).max())
    low, high = np.sort(at)[:-1], np.sort(at)[1:]
    within = (low + (high - low) * np.linspace(0.0, 1.0, BETWEEN)[:, None]).ravel()
    between = rates(within, at, xi)
    if len(within) and between.min() < floor:
        raise DampingError(
            "between the given frequencies the series becomes negative, "
            f"near omega {within[between.argmin()]:.6g}: take fewer of them, or ratios that differ less",
            "XI",
        )
    if len(of_modes) and of_modes.min() < floor:
        n = int(of_modes.argmin())
        raise DampingError(
            f"the series becomes negative beyond the given frequencies, at mode {n + 1} "
            f"(omega {modes.omega[n]:.6g}): give a ratio there too, or an even number of them",
            "XI",
        )
    of_modes = np.maximum(of_modes, 0.0)
    return CardDamping(
        context.from_modes(modes, of_modes),
        None,
        f"{len(at)} terms, XI {values(xi)} at omega {values(at)}; {span(modes.omega, of_modes)}",
    )


SPEC = Spec(
    "damping",
    "CAUGHEY",
    "series with given ratios at several frequencies, constant matrix",
    (
        Field(
            "XI",
            Kind.REAL,
            "-",
            count=(1, 12),
            lo=0,
            doc="damping ratio at each of OMEGA or MODES; one value: at all",
        ),
        Field(
            "OMEGA",
            Kind.REAL,
            "1/T",
            default=None,
            count=(1, 12),
            above=0,
            doc="circular frequencies of XI, one for each term of the series",
        ),
        Field("MODES", Kind.INT, default=None, count=(1, 12), lo=1, doc="modes with XI"),
        BUILDING,
        NODES,
        AFTER,
    ),
    reference="Caughey 1960",
    impl=build,
)
