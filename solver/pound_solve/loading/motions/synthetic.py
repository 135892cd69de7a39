"""SYNTHETIC: white noise through the two filters of Clough and Penzien, under an envelope.

The ground below is taken as white noise.  A soil layer of frequency wg and damping zg passes it on
(Kanai 1957; Tajimi 1960), and a second filter wf, zf removes the low frequencies
(Clough & Penzien 1975).  With S0 the density of the noise, that of the ground acceleration is::

    S(w) = S0 |Hg(w)|^2 |Hf(w)|^2
    Hg(w) = (wg^2 + 2 i zg wg w) / (wg^2 - w^2 + 2 i zg wg w)
    Hf(w) = w^2 / (wf^2 - w^2 + 2 i zf wf w)

The envelope of Jennings, Housner & Tsai (1968) rises as (t / RISE)^2, stays at one for STRONG and falls as
exp(-DECAY s) after that.  The result is scaled to PGA.  S0 therefore cancels, and is not a field.

The filters are applied to the Fourier transform of the noise, so that the motion is stationary from its
first sample on and only the envelope makes it grow.
"""

from __future__ import annotations

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

LIKE_G: Final = (0.1, 1.2)  #: usual peaks of earthquakes in units of gravity
WEAK: Final = 0.06  #: peak in units of gravity below which an earthquake does no damage
MOST_SAMPLES: Final = 10_000_000


def build(card_values: Mapping[str, Any], context: LoadingContext) -> GroundMotion:
    """Motion of a SYNTHETIC card; the same SEED gives the same motion.

    Parameters
    ----------
    card_values : mapping
        Bound values of the card's fields.
    context : LoadingContext

    Raises
    ------
    RecordError
        R405 where DURATION is shorter than two steps.
    """
    t = samples(card_values)
    wg, zg = float(card_values["WG"]), float(card_values["ZG"])
    wf = 0.1 * wg if card_values.get("WF") is None else float(card_values["WF"])
    zf = zg if card_values.get("ZF") is None else float(card_values["ZF"])
    seed = int(card_values["SEED"])

    n, dt = len(t), float(card_values["DT"])
    noise = np.random.default_rng(seed).standard_normal(n)
    w = np.asarray(2 * np.pi * np.fft.rfftfreq(n, dt), dtype=np.float64)
    a = np.fft.irfft(np.fft.rfft(noise) * transfer(w, wg, zg, wf, zf), n)
    a *= envelope(t, float(card_values["RISE"]), float(card_values["STRONG"]), float(card_values["DECAY"]))
    a *= float(card_values["PGA"]) / np.abs(a).max()
    facts = {"seed": seed, "wg": wg, "zg": zg, "wf": wf, "zf": zf, "cuts": _cuts(card_values)}
    return of_samples(SPEC, card_values, context, t, a, facts)


def _cuts(card_values: Mapping[str, Any]) -> tuple[tuple[str, str, str], ...]:
    """Warning that the motion ends during the rise of its envelope, before its strong part."""
    rise, duration = float(card_values["RISE"]), float(card_values["DURATION"])
    message = f"the motion ends at DURATION={duration:g}, within its RISE={rise:g}"
    return () if rise < duration else ((message, "DURATION", "give DURATION room for RISE and STRONG"),)


def of_samples(
    spec: Spec,
    card_values: Mapping[str, Any],
    context: LoadingContext,
    t: Array,
    a: Array,
    facts: Mapping[str, Any],
) -> GroundMotion:
    """Motion of a card with accelerations `a` [L/T^2] at the times `t`, see `samples`."""
    info = {
        "kind": spec.name,
        "name": f"{spec.name} SEED={int(card_values['SEED'])}",
        "unit": "DECK",
        "npts": len(t),
        "dt": float(card_values["DT"]),
        "start": 0.0,
    }
    scale = float(card_values.get("SCALE", 1.0))
    doubts = _in_g(card_values.get("PGA"), context) if scale == 1.0 else ()
    info["warnings"] = doubts
    return finish(card_values, Piecewise.from_samples(t, a * scale), context, info | dict(facts))


def _in_g(pga: float | None, context: LoadingContext) -> tuple[str, ...]:
    """Warning that a weak peak [L/T^2] may be meant in units of gravity."""
    round_number = pga is not None and float(f"{pga:.2g}") == pga
    if pga is None or not round_number or not LIKE_G[0] <= pga <= min(LIKE_G[1], WEAK * context.gravity):
        return ()
    message = f"PGA={pga:g} is {pga / context.gravity:.2g} g: PGA is no share of gravity"
    return (f"{message}; {pga:g} g is PGA={pga * context.gravity:.4g}",)


def samples(card_values: Mapping[str, Any]) -> Array:
    """Times of the samples of a motion of length DURATION every DT.

    Raises
    ------
    RecordError
        R405 where DURATION is shorter than two steps, or has too many.
    """
    dt, duration = float(card_values["DT"]), float(card_values["DURATION"])
    n = round(duration / dt) + 1
    if n < 3:
        raise RecordError("R405", f"DURATION={duration:g} is shorter than two steps DT={dt:g}")
    if duration / dt > MOST_SAMPLES:
        raise RecordError("R405", f"DT={dt:g} makes more than {MOST_SAMPLES} samples", "give a longer DT")
    return dt * np.arange(n, dtype=np.float64)


def transfer(w: Array, wg: float, zg: float, wf: float, zf: float) -> Any:
    """Product of the filters Hg and Hf, complex, shape of `w`.

    Parameters
    ----------
    w : ndarray, [rad/T]
        Circular frequencies.
    wg, zg : float, [rad/T], [-]
        Frequency and damping of the soil filter.
    wf, zf : float, [rad/T], [-]
        Frequency and damping of the filter against slow motion.
    """
    soil = (wg**2 + 2j * zg * wg * w) / (wg**2 - w**2 + 2j * zg * wg * w)
    slow = w**2 / (wf**2 - w**2 + 2j * zf * wf * w)
    return soil * slow


def envelope(t: Array, rise: float, strong: float, decay: float) -> Array:
    """Envelope at times `t` [T], between 0 and 1.

    Parameters
    ----------
    t : ndarray, [T]
    rise, strong : float, [T]
        Lengths of the rise and of the strong part.
    decay : float, [1/T]
        Exponent of the fall.
    """
    up = np.minimum(t / rise, 1.0) ** 2 if rise > 0 else np.ones_like(t)
    down: Array = np.exp(-decay * np.maximum(t - rise - strong, 0.0))
    return up * down


#: items of all motions made from noise under an envelope
ENVELOPE: Final = (
    Field("SEED", Kind.INT, default=1, lo=0, doc="seed of the noise; the same seed gives the same motion"),
    Field("DT", Kind.REAL, "T", default=0.01, above=0, doc="sampling interval"),
    Field("DURATION", Kind.REAL, "T", default=20.0, above=0, doc="length of the motion"),
    Field("RISE", Kind.REAL, "T", default=2.0, lo=0, doc="rise time of the envelope"),
    Field("STRONG", Kind.REAL, "T", default=8.0, lo=0, doc="duration of its plateau"),
    Field("DECAY", Kind.REAL, "1/T", default=0.3, lo=0, doc="its decay exponent"),
)

SPEC: Final = Spec(
    "motion",
    "SYNTHETIC",
    "filtered white noise of Clough and Penzien",
    (
        Field("PGA", Kind.REAL, "L/T^2", above=0, doc="peak ground acceleration"),
        Field(
            "WG",
            Kind.REAL,
            "1/T",
            default=15.6,
            above=0,
            doc="circular frequency of the soil filter in radians",
        ),
        Field("ZG", Kind.REAL, "-", default=0.6, above=0, doc="damping ratio of the soil filter"),
        Field(
            "WF",
            Kind.REAL,
            "1/T",
            default=None,
            above=0,
            doc="frequency of the second filter; omitted: a tenth of WG",
        ),
        Field(
            "ZF",
            Kind.REAL,
            "-",
            default=None,
            above=0,
            doc="damping ratio of the second filter; omitted: ZG",
        ),
        *ENVELOPE,
        *COMMON,
    ),
    reference="Kanai 1957; Tajimi 1960; Clough & Penzien 1975; envelope: Jennings, Housner & Tsai 1968",
    impl=build,
)
