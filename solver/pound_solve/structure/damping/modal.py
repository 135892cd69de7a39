r"""MODAL: damping ratios of the modes, as a constant matrix.

.. math:: C = M \Bigl(\sum_n 2\xi_n\omega_n\,\phi_n\phi_n^T\Bigr) M, \qquad \phi_n^T M \phi_n = 1

with the modes of the initial structure, contacts open.  XI is either a list, mode by mode, whose last value
applies to the rest (one value: uniform damping), or the ratio at some frequencies (OMEGA) or modes (MODES):
between these it is linear, over frequency or over the number of the mode, and beyond the first and the last
it stays constant or continues linearly (:math:`\xi` at two points: tri-linear or linear
damping).

References
----------
Wilson EL, Penzien J (1972), Evaluation of orthogonal damping matrices,
Int. J. Numer. Methods Engng 4: 5-10.
Carr AJ, Ruaumoko, www.ruaumoko.co.nz/damping.html (the variations over frequency).
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


def through(x: Array, at: Array, xi: Array, straight: bool) -> Array:
    """Piecewise linear function through (`at`, `xi`), evaluated at `x`, with linear or constant
    extrapolation.
    """
    order = np.argsort(at)
    at, xi = at[order], xi[order]
    line = np.interp(x, at, xi)
    if straight:
        slope = np.diff(xi) / np.diff(at)
        line = np.where(x < at[0], xi[0] + slope[0] * (x - at[0]), line)
        line = np.where(x > at[-1], xi[-1] + slope[-1] * (x - at[-1]), line)
    return np.asarray(line)


def listed(card: Card, omega: Array) -> tuple[Array, str]:
    """Ratio of every mode from a list, and its description for the report."""
    numbers = card["XI"]
    for item in ("BEYOND", "OVER"):
        if item in card.spans:
            raise DampingError(f"{item} needs OMEGA or MODES: XI alone is a list, mode by mode", item)
    xi = np.array([numbers[min(n, len(numbers) - 1)] for n in range(len(omega))])
    rest = " (the last for all higher modes)" if len(numbers) < len(omega) else ""
    return xi, f"XI {values(numbers)}{rest}"


def interpolated(card: Card, omega: Array, context: DampingContext) -> tuple[Array, str]:
    """Ratio of every mode by straight lines between given ones, and its description for the report."""
    at = frequencies(card, lambda: omega, context)
    item = "OMEGA" if card["OMEGA"] is not None else "MODES"
    x, name = omega, "omega"
    if card["OVER"] == "MODE":
        if card["MODES"] is None:
            raise DampingError("OVER=MODE needs the ratios at MODES", "OVER")
        x, name = np.arange(1.0, len(omega) + 1.0), "mode"
        at = np.minimum(card["MODES"], len(omega)).astype(float)
    xi_at = ratios(card, len(at))
    if len(at) < 2:
        raise DampingError("a line needs two points; XI alone is the same for all modes", item)
    beyond = card["MODES"] is not None and max(card["MODES"]) > len(omega)
    if beyond and (at == at[0]).all() and (xi_at == xi_at[0]).all():  # all of them select the last mode
        return np.full(len(omega), xi_at[0]), f"XI {xi_at[0]:.6g} of every mode"
    apart(at, item)
    straight = card["BEYOND"] == "LINEAR"
    xi = through(x, at, xi_at, straight)
    if len(xi) and xi.min() < 0.0:
        n = int(np.argmin(xi))
        raise DampingError(
            f"the line falls to a ratio of {xi[n]:.4g} at mode {n + 1} (omega {omega[n]:.6g}): "
            "BEYOND=CONSTANT keeps the last value",
            "BEYOND",
        )
    text = f"XI {values(xi_at)} at {name} {values(at)}, {'linear' if straight else 'constant'} beyond"
    return xi, f"{text}; {span(omega, 2.0 * xi * omega)}"


def build(card: Card, context: DampingContext) -> CardDamping:
    """Damping of the whole structure, or of one building of several."""
    modes = context.modes(context.nodes(card), None)
    points = card["OMEGA"] is not None or card["MODES"] is not None
    xi, text = interpolated(card, modes.omega, context) if points else listed(card, modes.omega)
    return CardDamping(context.from_modes(modes, 2.0 * xi * modes.omega), None, text)


SPEC = Spec(
    "damping",
    "MODAL",
    "modal ratios, constant matrix",
    (
        Field(
            "XI",
            Kind.REAL,
            "-",
            count=(1, 1000),
            lo=0,
            doc="damping ratio of mode 1, 2, ..., the last also for the rest; or at OMEGA or MODES",
        ),
        Field(
            "OMEGA",
            Kind.REAL,
            "1/T",
            default=None,
            count=(2, 100),
            above=0,
            doc="circular frequencies of XI; modes between them are interpolated",
        ),
        Field("MODES", Kind.INT, default=None, count=(2, 100), lo=1, doc="modes with XI"),
        Field(
            "BEYOND",
            Kind.WORD,
            default="CONSTANT",
            words=("CONSTANT", "LINEAR"),
            codes={"CONSTANT": 3, "LINEAR": 2},
            doc="before the first and after the last point: same ratio, or same line",
        ),
        Field(
            "OVER",
            Kind.WORD,
            default="FREQUENCY",
            words=("FREQUENCY", "MODE"),
            doc="the ratio is linear in the frequency, or in the mode number",
        ),
        BUILDING,
        NODES,
        AFTER,
    ),
    code=4,
    reference="Wilson & Penzien 1972",
    impl=build,
)
