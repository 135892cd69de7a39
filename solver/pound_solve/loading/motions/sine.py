"""SINE: a(t) = A sin(w (t - START) + PHASE), from START on.

Symbols: A amplitude, w circular frequency, T = 2 pi / w period.  Every interval of T/32 holds the Taylor
polynomial of degree 10 about its beginning; the first term left out is (pi/16)^11 / 11! = 4e-16 of A.
Velocity and displacement are written in the same way from their closed forms, since summing the
accelerations over a hundred periods would lose three digits of the displacement.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.loading.motions.base import (
    COMMON,
    GroundMotion,
    LoadingContext,
    Piecewise,
    RecordError,
    finish,
)
from pound_solve.numerics.types import Array

_PER_PERIOD: Final = 32
_DEGREE: Final = 10
_MOST_PIECES: Final = 2_000_000
# 80-bit numbers where the machine has them: w t is hundreds of radians and must be right to 1e-16
_Long = np.longdouble


def build(card_values: Mapping[str, Any], context: LoadingContext) -> GroundMotion:
    """Motion of a SINE card.

    Parameters
    ----------
    card_values : mapping
        Bound values of the card's fields.
    context : LoadingContext
        Its `duration` ends a sine without DURATION.

    Raises
    ------
    RecordError
        R405 unless one of PERIOD and OMEGA is given, or where the sine has no end.
    """
    w = omega(card_values)
    scale = float(card_values.get("SCALE", 1.0))
    a = float(card_values["AMPLITUDE"]) * scale
    phase = float(card_values.get("PHASE", 0.0))
    start = float(card_values.get("START", 0.0))
    end = ending(card_values, context)

    steady_v, steady_d = -a / w * np.cos(_Long(phase)), -a / w**2 * np.sin(_Long(phase))
    v0 = steady_v if card_values.get("VELOCITY0") is None else _Long(card_values["VELOCITY0"])
    # the ground reaches its steady motion at START, moving at v0 before
    d0 = (
        steady_d - v0 * start
        if card_values.get("DISPLACEMENT0") is None
        else _Long(card_values["DISPLACEMENT0"])
    )

    quarter, drift, offset = np.arccos(_Long(-1)) / 2, v0 - steady_v, d0 + v0 * start - steady_d
    lead = min(start, end)

    def history(
        amplitude: Any, turn: Any, before: list[Any], base: Any = 0.0, slope: Any = 0.0
    ) -> Piecewise:
        """A polynomial until the sine begins, then the sine about a straight line."""
        parts = [Piecewise(np.array([0.0, lead]), np.array(before, float)[:, None])] if lead > 0 else []
        if end > start:
            breaks = intervals(w, start, end)
            since = breaks[:-1].astype(_Long) - start
            coefs = taylor(amplitude, w, w * since + _Long(phase) + turn, base + slope * since)
            coefs[1] += float(slope)
            parts.append(Piecewise(breaks, coefs))
        return _joined(parts)

    return finish(
        card_values,
        history(a, 0.0, [0.0]),
        context,
        {
            "kind": SPEC.name,
            "name": SPEC.name,
            "unit": "DECK",
            "start": start,
            "amplitude": a,
            "omega": float(w),
            "period": float(2 * np.arccos(_Long(-1)) / w),
            "phase": phase,
        },
        float(v0),
        float(d0),
        (
            lambda: history(-a / w, quarter, [v0], drift),
            lambda: history(-a / w**2, 0.0, [d0, v0], offset, drift),
        ),
    )


def omega(card_values: Mapping[str, Any]) -> np.longdouble:
    """Circular frequency [rad/T] from PERIOD or OMEGA."""
    period, frequency = card_values.get("PERIOD"), card_values.get("OMEGA")
    if (period is None) == (frequency is None):
        item = "FILE" if period is None else "OMEGA"
        raise RecordError("R405", "a SINE needs PERIOD or OMEGA, one of the two", item=item)
    return 2 * np.arccos(_Long(-1)) / _Long(period) if frequency is None else _Long(frequency)


def ending(card_values: Mapping[str, Any], context: LoadingContext) -> float:
    """Time at which the sine ends [T]: with the analysis at the latest."""
    duration = card_values.get("DURATION")
    start = float(card_values.get("START", 0.0))
    end = min(math.inf if duration is None else start + duration, context.duration or math.inf)
    if end == math.inf:
        raise RecordError("R405", "a SINE without an end", "give it a DURATION")
    return end


def intervals(w: np.longdouble, start: float, end: float) -> Array:
    """Breaks from `start` to `end` that are T/32 apart or closer, shape (n + 1,) [T]."""
    pieces = math.ceil((end - start) * float(w) / (2 * math.pi) * _PER_PERIOD)
    if pieces > _MOST_PIECES:
        raise RecordError(
            "R405", f"a sine of {pieces // _PER_PERIOD} periods is too long", "check PERIOD or OMEGA"
        )
    return np.linspace(start, end, pieces + 1)


def taylor(amplitude: Any, w: np.longdouble, angle: Any, base: Any = 0.0) -> Array:
    """Taylor coefficients of ``amplitude sin(w s + angle) + base`` in s, shape (degree + 1, len(angle))."""
    coefs, turns = np.empty((_DEGREE + 1, len(angle))), (np.sin(angle), np.cos(angle))
    for k in range(_DEGREE + 1):
        sign = 1 - 2 * (k // 2 % 2)
        coefs[k] = sign * amplitude * w**k / math.factorial(k) * turns[k % 2] + (base if k == 0 else 0.0)
    return coefs


def _joined(parts: list[Piecewise]) -> Piecewise:
    """Consecutive polynomials as one function."""
    if len(parts) == 1:
        return parts[0]
    rows = max(len(p.coefs) for p in parts)
    coefs: list[Array] = [np.pad(p.coefs, ((0, rows - len(p.coefs)), (0, 0))) for p in parts]
    return Piecewise(
        np.concatenate([parts[0].breaks, *(p.breaks[1:] for p in parts[1:])]), np.hstack(coefs)
    )


#: frequency, phase and times
FIELDS: Final = (
    Field("PERIOD", Kind.REAL, "T", default=None, above=0, doc="period; give this or OMEGA"),
    Field(
        "OMEGA",
        Kind.REAL,
        "1/T",
        default=None,
        above=0,
        doc="circular frequency in radians; give this or PERIOD",
    ),
    Field("PHASE", Kind.REAL, "-", default=0.0, doc="angle at START in radians"),
    Field("START", Kind.REAL, "T", default=0.0, lo=0, doc="time at which the sine begins"),
    Field(
        "DURATION",
        Kind.REAL,
        "T",
        default=None,
        above=0,
        doc="duration; omitted: to the end of the analysis",
    ),
)

SPEC: Final = Spec(
    "motion",
    "SINE",
    "sinusoidal ground acceleration",
    (
        Field("AMPLITUDE", Kind.REAL, "L/T^2", doc="amplitude of the acceleration"),
        *FIELDS,
        Field(
            "VELOCITY0",
            Kind.REAL,
            "L/T",
            default=None,
            doc="ground velocity at t = 0; omitted: steady state",
        ),
        Field(
            "DISPLACEMENT0",
            Kind.REAL,
            "L",
            default=None,
            doc="ground displacement at t = 0; omitted: steady state",
        ),
        *COMMON,
    ),
    impl=build,
)
