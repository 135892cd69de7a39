r"""MATCHED: an artificial motion that matches a given response spectrum.

It starts as noise whose Fourier amplitudes follow the target, under the envelope of `synthetic`.  Then it
is corrected in the time domain.  The response of oscillator i at its peak time :math:`t_i` is linear in the
samples, :math:`u_i = h_i \cdot a`.  The correction of least weighted size that moves all peaks to their
targets, and the end velocity and displacement to zero, is

.. math:: \delta a = W H^T (H W H^T)^{-1}\,r, \qquad W = \operatorname{diag}(e^2)

with the envelope e (the wavelets are reversed impulse responses, as in Lilhanand and Tseng 1988, 9th WCEE;
least squares choose their amplitudes).  Samples near or above the spectrum's first ordinate are drawn below
it likewise, since no spectrum is below the peak of its motion.  Peak times change, so the step is repeated.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final, NamedTuple

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.loading.motions.base import COMMON, GroundMotion, LoadingContext, Piecewise, RecordError
from pound_solve.loading.motions.synthetic import ENVELOPE, envelope, of_samples, samples
from pound_solve.loading.spectrum import pseudo_acceleration
from pound_solve.numerics.types import Array

CLOSE: Final = 0.6  #: distance of the periods that are matched, in half band widths
MOST_STEPS: Final = 40
EARLY, HOPELESS = 8, 1.0  #: iterations after which a smallest misfit above this ends the search
LOOSE: Final = 1.05  #: of the diagonal of H W H^T: close peaks need not be met to the last digit
NEAR: Final = 0.95  #: fraction of the first ordinate above which samples are reduced to `PEAK` of it
PEAK: Final = 0.9
LEAST_DAMPING: Final = 0.01
MOST_DAMPING: Final = 0.5
MIN_SAMPLES_PER_PERIOD: Final = 8.0  #: samples in the shortest period


class Target(NamedTuple):
    """Target spectrum.

    Attributes
    ----------
    periods : ndarray, shape (n,), [T]
    psa : ndarray, shape (n,), [L/T^2]
        Pseudo-accelerations.
    xi : float
        Ratio to critical damping.
    """

    periods: Array
    psa: Array
    xi: float


def build(card_values: Mapping[str, Any], context: LoadingContext) -> GroundMotion:
    """Motion of a MATCHED card; the same SEED gives the same motion.

    Parameters
    ----------
    card_values : mapping
        Bound values of the card's fields.
    context : LoadingContext

    Raises
    ------
    RecordError
        R405 where SPECTRUM is no spectrum, DT is too long for it, or no motion within TOL is found.
    """
    target = spectrum(card_values["SPECTRUM"], float(card_values["XI"]))
    dt, tol = float(card_values["DT"]), float(card_values["TOL"])
    if dt * MIN_SAMPLES_PER_PERIOD > target.periods[0] * (1.0 + 1e-9):
        shortest = f"DT={dt:g} is too long for the period {target.periods[0]:g}"
        raise RecordError(
            "R405", shortest, f"give DT={target.periods[0] / MIN_SAMPLES_PER_PERIOD:.3g} or less", "DT"
        )
    t = samples(card_values)
    e = envelope(t, *(float(card_values[name]) for name in ("RISE", "STRONG", "DECAY")))
    seed = int(card_values["SEED"])
    a, misfit = matched(target, t, e, seed, tol)
    if misfit > tol:
        raise RecordError(
            "R405",
            f"the spectrum is met to {100 * misfit:.2g} % only, TOL={tol:g} requires {100 * tol:g} %",
            "give another SEED, a longer STRONG, a smoother SPECTRUM or a larger TOL",
            "TOL",
        )
    return of_samples(SPEC, card_values, context, t, a, {"seed": seed, "misfit": misfit})


def spectrum(points: Sequence[float], xi: float) -> Target:
    """Target at close periods, from points T1, Sa1, T2, Sa2, ...; straight lines in logarithms.

    Raises
    ------
    RecordError
        R405 for half a pair, or periods that do not rise.
    """
    t, sa = np.array(points[::2]), np.array(points[1::2])
    hint = "SPECTRUM are pairs of period and pseudo-acceleration: SPECTRUM=0.05,4,0.15,10,0.5,10,2,2.5"
    if len(t) != len(sa):
        raise RecordError("R405", f"{len(points)} numbers are no whole pairs", hint, "SPECTRUM")
    if not (np.diff(t) > 0.0).all():
        raise RecordError("R405", "the periods do not rise", hint, "SPECTRUM")
    periods = np.geomspace(t[0], t[-1], 1 + math.ceil(math.log(t[-1] / t[0]) / (CLOSE * xi)))
    return Target(periods, np.exp(np.interp(np.log(periods), np.log(t), np.log(sa))), xi)


def matched(target: Target, t: Array, e: Array, seed: int, tol: float) -> tuple[Array, float]:
    """Accelerations whose spectrum is the target, and its largest relative misfit.

    Parameters
    ----------
    target : Target
    t : ndarray, shape (n,), [T]
        Times of the samples, equally spaced.
    e : ndarray, shape (n,)
        Envelope at these times.
    seed : int
    tol : float
        Misfit at which the iteration ends.
    """
    a, best, least = _noise(target, t, e, seed), np.zeros_like(t), math.inf
    responses = _impulse_responses(target, t)
    for step in range(MOST_STEPS):
        psa = pseudo_acceleration(Piecewise.from_samples(t, a), target.periods, target.xi)[0]
        misfit = float(np.abs(psa / target.psa - 1.0).max())
        if misfit < least:
            best, least = a, misfit
        if misfit <= tol or (step == EARLY and least > HOPELESS):
            break
        a = a + _correction(target, t, e, a, psa, responses)
    return best, least


def _noise(target: Target, t: Array, e: Array, seed: int) -> Array:
    """Noise with Fourier amplitudes proportional to the target's velocities, of its mean size."""
    dt = t[1] - t[0]
    w = 2.0 * np.pi * np.fft.rfftfreq(len(t), dt)
    ends = 2.0 * np.pi / target.periods[::-1]
    size = np.interp(w, ends, (target.psa * target.periods)[::-1])
    size[w < 0.7 * ends[0]] = 0.0  # slower than the slowest oscillator, noise would drift
    noise = np.fft.rfft(np.random.default_rng(seed).standard_normal(len(t)))
    a = np.fft.irfft(noise * size, len(t)) * e
    psa = pseudo_acceleration(Piecewise.from_samples(t, a), target.periods, target.xi)[0]
    return np.asarray(a / math.exp(np.log(psa / target.psa).mean()))


def _impulse_responses(target: Target, t: Array) -> Array:
    """Pseudo-accelerations after a sample of one, shape (n_periods, n_times)."""
    w = 2.0 * np.pi / target.periods[:, None]
    wd = w * math.sqrt(1.0 - target.xi**2)
    return np.asarray(-(t[1] - t[0]) * w**2 / wd * np.exp(-target.xi * w * t) * np.sin(wd * t))


def _correction(target: Target, t: Array, e: Array, a: Array, psa: Array, responses: Array) -> Array:
    """Change of the accelerations that moves all peaks to their targets, to first order."""
    n, count = len(t), len(target.periods)
    length = 2 * n
    u = np.fft.irfft(np.fft.rfft(responses, length) * np.fft.rfft(a, length), length)[:, :n]
    high = np.flatnonzero(np.abs(a) > NEAR * target.psa[0])
    rows = np.zeros((count + 2 + len(high), n))
    for i, k in enumerate(np.abs(u).argmax(axis=1)):
        rows[i, : k + 1] = math.copysign(1.0, u[i, k]) * responses[i, k::-1] / target.psa[i]
    # the end velocity and displacement of straight lines between samples
    dt = t[1] - t[0]
    rows[count] = dt
    rows[count, [0, -1]] *= 0.5
    rows[count + 1] = dt * (t[-1] - t)
    rows[count + 1, 0] *= 0.5
    rows[count + 1, [0, -1]] += dt**2 / 6.0 * np.array([-1.0, 1.0])
    rows[count + 2 + np.arange(len(high)), high] = 1.0 / target.psa[0]
    wanted = np.concatenate(
        [
            1.0 - psa / target.psa,
            -rows[count : count + 2] @ a,
            np.sign(a[high]) * PEAK - a[high] / target.psa[0],
        ]
    )
    gram = (rows * e**2) @ rows.T
    loose = np.full(len(rows), LOOSE)
    loose[count : count + 2] = 1.0
    gram[np.diag_indices_from(gram)] *= loose
    return np.asarray(e**2 * (rows.T @ np.linalg.solve(gram, wanted)))


SPEC: Final = Spec(
    "motion",
    "MATCHED",
    "motion with a given response spectrum",
    (
        Field(
            "SPECTRUM",
            Kind.REAL,
            above=0,
            count=(4, 400),
            doc="period, pseudo-acceleration, period, ... in deck units; log-log interpolation",
        ),
        Field(
            "XI",
            Kind.REAL,
            "-",
            default=0.05,
            lo=LEAST_DAMPING,
            hi=MOST_DAMPING,
            doc="damping ratio of SPECTRUM",
        ),
        Field("TOL", Kind.REAL, "-", default=0.05, lo=0.01, hi=1, doc="allowed relative misfit"),
        *ENVELOPE,
        *COMMON,
    ),
    reference="Lilhanand & Tseng 1988; envelope: Jennings, Housner & Tsai 1968",
    impl=build,
    sample="SPECTRUM=0.1,4,0.5,4,2,1",
)
