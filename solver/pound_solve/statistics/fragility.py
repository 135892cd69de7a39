r"""Lognormal fragility from analyses: maximum likelihood estimates and their confidence intervals.

The probability that a limit is exceeded at an intensity x is

.. math:: P(x) = \Phi\Bigl(\frac{\ln x - \ln\theta}{\beta}\Bigr)

with the median :math:`\theta` and the dispersion :math:`\beta`.  Each kind of data has its likelihood:

* capacities, one per record: the intensity at which the limit is reached, or two intensities that bracket
  it.  The capacity of a record that never reached the limit lies above its largest intensity (a censored
  sample); that of a record whose first run reached it lies below its lowest;
* stripes: z of n runs at one intensity exceeded the limit (Baker 2015, Earthquake Spectra 31: 579-599);
* a cloud: the demand D of runs at any intensities follows :math:`\ln D = a + b\ln x + \sigma\varepsilon`
  (Cornell et al. 2002, J. Struct. Eng. 128: 526-533), so that :math:`\ln\theta = (\ln d - a)/b` for the
  limit d, and :math:`\beta = \sigma/b`.

The interval of a parameter follows from its profile likelihood: it contains the values at which the
log-likelihood, maximised over the other parameter, is below its maximum by less than :math:`c/2`,

.. math:: c = n\ln\Bigl(1 + \frac{t^2}{\nu}\Bigr),

with Student's quantile t of :math:`\nu` degrees of freedom in place of the usual quantile of
:math:`\chi_1^2`, to which c converges.  For the median of capacities that are all known, and for that of a
cloud, this is the exact interval (there Student's, here Fieller's).  For the dispersion of small samples it
has a coverage much closer to its level than with :math:`\chi_1^2`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq, minimize_scalar
from scipy.special import log_ndtr, ndtr, ndtri
from scipy.stats import t as student

from pound_solve.numerics.types import Array

MIN_DISPERSION: Final = 1e-4  #: smallest dispersion searched; no structure has less
MAX_DISPERSION: Final = 1e2  #: largest dispersion searched
#: distance of the median from the data up to which it is searched, in logarithms
MEDIAN_RANGE: Final = 30.0
PARAMETER_ACCURACY: Final = 1e-10  #: relative accuracy of a parameter


class FragilityError(Exception):
    """Raised if the data do not determine a fragility; the message states why."""


class Interval(NamedTuple):
    """Ends of a confidence interval; infinite, or zero, where the data give no bound."""

    low: float
    high: float


@dataclass(frozen=True)
class Fragility:
    """A lognormal fragility, its confidence intervals and the size of its sample.

    Attributes
    ----------
    median, dispersion : float
        Intensity at probability one half, standard deviation of the logarithm of the capacity.
    median_interval, dispersion_interval : Interval
    level : float
        Confidence level of both intervals, and of `interval`.
    count : int
        Number of runs or records fitted.
    """

    median: float
    dispersion: float
    median_interval: Interval
    dispersion_interval: Interval
    level: float
    count: int
    data: Likelihood

    def probability(self, intensity: ArrayLike) -> Array:
        """Probability of exceedance at intensities, in their shape."""
        x = np.log(np.asarray(intensity, dtype=np.float64))
        return np.asarray(ndtr((x - math.log(self.median)) / self.dispersion))

    def intensity(self, probability: float) -> float:
        """Intensity at which a probability is reached."""
        return self.median * math.exp(self.dispersion * float(ndtri(probability)))

    def interval(self, probability: float) -> Interval:
        """Confidence interval of the intensity at which a probability is reached."""
        return _of_quantile(self.data, float(ndtri(probability)), math.log(self.median), self.level)


@dataclass(frozen=True)
class Likelihood:
    """Log-likelihood of the data as a function of both parameters.

    Attributes
    ----------
    of : callable
        Of ln median and of the dispersion.
    count : int
        Independent observations.
    freedom : int
        Degrees of freedom left for the dispersion.
    low, high : float
        Logarithms of the intensities between which the data lie.
    """

    of: Callable[[float, float], float]
    count: int
    freedom: int
    low: float
    high: float


def from_capacities(
    reached: ArrayLike,
    never: ArrayLike = (),
    within: Sequence[tuple[float, float]] = (),
    level: float = 0.95,
) -> Fragility:
    """Fragility from one capacity per record.

    Parameters
    ----------
    reached : array_like, shape (n,)
        Intensities at which the limit was reached.
    never : array_like, shape (m,)
        Largest intensities of records that did not reach it.
    within : sequence of pairs
        Pairs of intensities that bracket the capacities of other records; the lower may be zero.
    level : float
        Of confidence.

    Raises
    ------
    FragilityError
        Fewer than two records reached the limit, one intensity may be the capacity of all, or an intensity
        is not above zero.
    """
    x, c = _logarithms(reached), _logarithms(never)
    low, high = np.array(within, np.float64).reshape(-1, 2).T
    b = _logarithms(high)
    a = np.full(len(b), -np.inf)
    a[low > 0.0] = _logarithms(low[low > 0.0])
    if len(x) + len(b) < 2 or (len(x) and not len(b) and np.ptp(x) == 0.0):
        counted = f"{len(x) + len(b)} of {len(x) + len(b) + len(c)} records reach the limit"
        raise FragilityError(f"{counted}, which needs two capacities that differ")
    if len(b) and np.concatenate([x, c, a]).max() <= np.concatenate([x, b]).min():
        raise FragilityError(
            "all capacities may be one level, which tells no dispersion: run levels between"
        )

    def of(mu: float, beta: float) -> float:
        z = (x - mu) / beta
        known = -len(x) * math.log(beta) - 0.5 * z @ z
        between = _log_between((a - mu) / beta, (b - mu) / beta)
        return float(known + log_ndtr((mu - c) / beta).sum() + between.sum())

    ends = np.concatenate([x, c, b, a[np.isfinite(a)]])
    count = len(x) + len(c) + len(b)
    return _fit(Likelihood(of, count, count - 1, ends.min(), ends.max()), level)


def _log_between(low: Array, high: Array) -> Array:
    """Logarithm of the probability that a normal variable lies between two values, the lower of which may
    be minus infinity.
    """
    flip = low > 0.0  # differences of numbers close to one lose all digits
    low, high = np.where(flip, -high, low), np.where(flip, -low, high)
    whole = log_ndtr(high)
    with np.errstate(divide="ignore"):
        return np.asarray(whole + np.log1p(-np.exp(log_ndtr(low) - whole)))


def from_stripes(
    intensity: ArrayLike, exceeded: ArrayLike, runs: ArrayLike, level: float = 0.95
) -> Fragility:
    """Fragility from counts at several intensities.

    Parameters
    ----------
    intensity : array_like, shape (n,)
    exceeded, runs : array_like of int, shape (n,)
        Runs that exceeded the limit, and all.
    level : float
        Of confidence.

    Raises
    ------
    FragilityError
        The counts determine no dispersion: no run exceeds the limit up to some intensity, all do beyond.
    """
    x, z = _logarithms(intensity), np.asarray(exceeded, dtype=np.float64)
    n = np.asarray(runs, dtype=np.float64)
    some, passed = x[z > 0], x[z < n]
    if not len(some) or not len(passed) or some.min() >= passed.max():
        raise FragilityError(
            "runs that exceed the limit and runs that do not lie apart: "
            "there must be an intensity with both, or one that exceeds it below one that does not"
        )
    if np.polynomial.polynomial.polyfit(x, z / n, 1, w=np.sqrt(n))[1] <= 0.0:
        raise FragilityError("the share of runs that exceed the limit does not rise with the intensity")

    def of(mu: float, beta: float) -> float:
        eta = (x - mu) / beta
        return float(z @ log_ndtr(eta) + (n - z) @ log_ndtr(-eta))

    count = int(n.sum())
    return _fit(Likelihood(of, count, count - 1, x.min(), x.max()), level)


def from_cloud(intensity: ArrayLike, demand: ArrayLike, limit: float, level: float = 0.95) -> Fragility:
    """Fragility from demands at any intensities.

    Parameters
    ----------
    intensity, demand : array_like, shape (n,)
    limit : float
        Of the demand.
    level : float
        Of confidence.

    Raises
    ------
    FragilityError
        There are fewer than three runs, or the demand does not rise with the intensity.
    """
    x, y = _logarithms(intensity), _logarithms(demand) - math.log(limit)
    if len(x) < 3 or np.ptp(x) == 0.0:
        raise FragilityError(f"a cloud needs three runs at different intensities, there are {len(x)}")
    if (x - x.mean()) @ y <= 0.0:
        raise FragilityError("the demand does not rise with the intensity")

    def of(mu: float, beta: float) -> float:
        # with q = 1/b the likelihood is q^n exp(-sum (q y - x + mu)^2 / (2 beta^2)), largest at a root in q
        yy, yx = y @ y, y @ (x - mu)
        q = (yx + math.sqrt(yx**2 + 4.0 * yy * len(x) * beta**2)) / (2.0 * yy)
        rest = q * y - (x - mu)
        return float(len(x) * (math.log(q) - math.log(beta)) - 0.5 * (rest @ rest) / beta**2)

    slope = (x - x.mean()) @ y / ((x - x.mean()) @ (x - x.mean()))
    middle = x.mean() - y.mean() / slope
    low, high = min(x.min(), middle), max(x.max(), middle)
    return _fit(Likelihood(of, len(x), len(x) - 2, low, high), level)


def _logarithms(values: ArrayLike) -> Array:
    """Logarithms of numbers that must be above zero."""
    x = np.asarray(values, dtype=np.float64)
    if x.size and not (x.min() > 0.0 and np.isfinite(x).all()):
        raise FragilityError("intensities and demands must be above zero and finite")
    return np.log(x)


def _fit(data: Likelihood, level: float) -> Fragility:
    """The most likely parameters and their intervals."""
    beta = _highest(
        lambda s: _given_dispersion(data, s), math.log(MIN_DISPERSION), math.log(MAX_DISPERSION)
    )
    mu = _best_median(data, math.exp(beta))
    middle = _of_quantile(data, 0.0, mu, level)
    ends = _ends(
        lambda s: _given_dispersion(data, s),
        beta,
        (math.log(MIN_DISPERSION), math.log(MAX_DISPERSION)),
        _drop(data, level),
    )
    return Fragility(math.exp(mu), math.exp(beta), middle, _exponentials(ends), level, data.count, data)


def _drop(data: Likelihood, level: float) -> float:
    """Drop of the log-likelihood from its maximum to the ends of a confidence interval."""
    t = student.ppf(0.5 + 0.5 * level, data.freedom)
    return float(0.5 * data.count * math.log1p(t**2 / data.freedom))


def _given_dispersion(data: Likelihood, s: float) -> float:
    """Largest log-likelihood over all medians, with `s` the logarithm of the dispersion."""
    beta = math.exp(s)
    return data.of(_best_median(data, beta), beta)


def _best_median(data: Likelihood, beta: float) -> float:
    """Most likely ln median for a dispersion."""
    return _highest(lambda mu: data.of(mu, beta), data.low - MEDIAN_RANGE, data.high + MEDIAN_RANGE)


def _of_quantile(data: Likelihood, z: float, mu: float, level: float) -> Interval:
    """Interval of the intensity `z` dispersions above the median, whose fitted logarithm is `mu`."""

    def at_quantile(q: float) -> float:
        def of(s: float) -> float:
            return data.of(q - z * math.exp(s), math.exp(s))

        return of(_highest(of, math.log(MIN_DISPERSION), math.log(MAX_DISPERSION)))

    low, high = data.low - MEDIAN_RANGE, data.high + MEDIAN_RANGE
    start = mu if z == 0.0 else _highest(at_quantile, low, high)
    return _exponentials(_ends(at_quantile, start, (low, high), _drop(data, level)))


def _exponentials(ends: tuple[float, float]) -> Interval:
    """Interval of a quantity from that of its logarithm."""
    return Interval(math.exp(ends[0]), math.exp(ends[1]))


def _highest(of: Callable[[float], float], low: float, high: float) -> float:
    """Location of the only maximum of a function between two limits: on a coarse grid, then refined."""
    places = np.linspace(low, high, 33)
    best = int(np.argmax([of(x) for x in places]))
    ends = places[max(best - 1, 0)], places[min(best + 1, len(places) - 1)]
    optimum = minimize_scalar(
        lambda x: -of(x), bounds=ends, method="bounded", options={"xatol": PARAMETER_ACCURACY}
    )
    return float(optimum.x)


def _ends(
    of: Callable[[float], float], at: float, limits: tuple[float, float], drop: float
) -> tuple[float, float]:
    """Points below and above the maximum at `at` where a function is lower by `drop`; else infinite."""
    least = of(at) - drop
    ends = []
    for limit in limits:
        if of(limit) >= least:
            ends.append(math.copysign(math.inf, limit - at))
        else:
            ends.append(float(brentq(lambda x: of(x) - least, at, limit, xtol=1e-9)))
    return ends[0], ends[1]
