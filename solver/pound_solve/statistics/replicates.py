r"""Estimates from replicates: samples of one plan with independent randomizations, whose scatter tells
their error.

The points of a Sobol sequence or of a Latin hypercube are not independent, and the error of a mean over
them is smaller than the standard deviation over the root of their number.  Independent randomizations of
the plan are independent, and each gives an unbiased mean.  Of R replicates

.. math:: \bar x \pm t_\nu\,s/\sqrt R

is the interval of the mean, with the standard deviation s of the means of the replicates and Student's
quantile t (L'Ecuyer et al. 2023, Confidence intervals for randomized quasi-Monte Carlo estimators, Winter
Simulation Conference).  Those means are not normal: a kurtosis :math:`\kappa` of theirs leaves the variance
:math:`s^2` the degrees of freedom (Satterthwaite 1946, Biometrics Bull. 2: 110-114)

.. math:: \frac{2}{\nu} = \frac{2}{R-1} + \frac{\kappa-3}{R}.

The kurtosis of Laplace's distribution, 6, is assumed, so that intervals of skewed functions keep their
level.  Other statistics take the pseudo-values of the jackknife, :math:`R\,T - (R-1)\,T_{-r}` with the
statistic :math:`T_{-r}` of all replicates but r, in place of the means (Tukey 1958; Efron and Stein 1981,
Ann. Stat. 9: 586-596), which also removes most of the bias.

A probability has the wider of this interval and that of Clopper and Pearson for independent points.  The
latter holds for stratified points too, whose number of hits scatters less (Hoeffding 1956, Ann. Math.
Stat. 27: 713-721), and it does not shrink to a point where nothing was hit.  The interval of a fractile
contains the values at which the probability of not exceeding them may be its share.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pound_solve.numerics.types import Array

REPLICATES: Final = 8
KURTOSIS: Final = 6.0  #: that is assumed for the means of replicates
SAMPLINGS: Final = ("sobol", "latin")
#: distance of a variate from 0 and 1, at which distributions without ends are infinite
MARGIN: Final = 2.0**-32
FEW: Final = 20  #: points beside a common value, as that of no contact, below which means have no interval
_Some = Callable[[NDArray[np.intp]], Array]


class Estimate(NamedTuple):
    """A statistic, and the ends of its confidence interval; arrays of one shape, or numbers."""

    value: Array
    low: Array
    high: Array


def uniform(sampling: str, count: int, variables: int, seed: int) -> Array:
    """Replicates of a plan on the unit cube.

    Parameters
    ----------
    sampling : str
        ``sobol``, a scrambled Sobol sequence, or ``latin``, a Latin hypercube.
    count : int
        Points of all replicates together; a multiple of `REPLICATES`, of a sequence a power of 2.
    variables : int
    seed : int

    Returns
    -------
    ndarray, shape (REPLICATES, count / REPLICATES, variables)
    """
    from scipy.stats import qmc

    plan = {"sobol": qmc.Sobol, "latin": qmc.LatinHypercube}[sampling]
    seeds = [np.random.default_rng([seed, r]) for r in range(REPLICATES)]
    u = np.array([plan(variables, seed=s).random(count // REPLICATES) for s in seeds])
    return np.asarray(np.clip(u, MARGIN, 1.0 - MARGIN))


def jackknifed(statistic: _Some, level: float, replicates: int = REPLICATES) -> Estimate:
    """Estimate a statistic of replicates.

    Parameters
    ----------
    statistic : callable
        Its values, of any shape, from some replicates, which it takes by their indices.
    level : float
        Of confidence.
    replicates : int
    """
    every = np.arange(replicates)
    without = np.array([statistic(np.delete(every, r)) for r in every])
    pseudo = replicates * np.asarray(statistic(every)) - (replicates - 1) * without
    value = pseudo.mean(axis=0)
    half = _half(pseudo, level)
    return Estimate(value, value - half, value + half)


def moments(values: Array, level: float) -> tuple[Estimate, Estimate]:
    """Mean and standard deviation; NaN where the values do not give them, or their intervals.

    Parameters
    ----------
    values : ndarray, shape (n_replicates, n_points, n_records)
        NaN for one that is not known; infinite values have no moments.
    level : float
    """
    none = np.full((), np.nan)
    if np.isinf(values).any():
        return Estimate(none, none, none), Estimate(none, none, none)
    if not _scatters(values):
        each = _moments(values)
        return Estimate(each[0], none, none), Estimate(each[1], none, none)
    mean = jackknifed(lambda some: _moments(values[some])[0], level, len(values))
    with np.errstate(divide="ignore", invalid="ignore"):  # all values that differ are in one replicate
        log_sd = jackknifed(lambda some: np.log(_moments(values[some])[1]), level, len(values))
    half = np.maximum(log_sd.high - log_sd.value, _half_of_log_sd(values, level))
    return mean, Estimate(*(np.exp(log_sd.value + x) for x in (0.0, -half, half)))


def _moments(values: Array) -> tuple[Array, Array]:
    """Mean and standard deviation of the known values; NaN without any."""
    count = np.count_nonzero(~np.isnan(values))
    with np.errstate(invalid="ignore"):
        mean = np.divide(np.nansum(values), count)
        return mean, np.sqrt(np.divide(np.nansum((values - mean) ** 2), count))


def _half_of_log_sd(values: Array, level: float) -> float:
    """Half of the interval of the logarithm of the standard deviation for independent points.

    It is wider than that of the replicates where few large values make up the variance, which replicates of
    some points each have or have not.
    """
    mean, sd = _moments(values)
    points = int((~np.isnan(values)).any(axis=-1).sum())
    kurtosis = float(_moments(((values - mean) / sd) ** 4)[0])
    return _student(level, points) * math.sqrt(max(kurtosis - 1.0, 0.0) / (4.0 * points))


def _scatters(values: Array) -> bool:
    """Whether so many points differ from the commonest value that the scatter of the replicates tells."""
    distinct, counts = np.unique(values[~np.isnan(values)], return_counts=True)
    if len(distinct) < 2:
        return False
    differ = ~np.isnan(values) & (values != distinct[np.argmax(counts)])
    return int(differ.any(axis=-1).sum()) >= FEW


def share(hits: Array, level: float) -> Estimate:
    """Probability of an event.

    Parameters
    ----------
    hits : ndarray, shape (n_replicates, n_points, n_records)
        1 for a run with the event, 0 for one without it, NaN for one that is not known: it counts as
        either, whichever makes the interval wider.
    level : float
    """
    least, most = (np.nan_to_num(hits, nan=unknown).mean(axis=(1, 2)) for unknown in (0.0, 1.0))
    low, _ = _bounds(least[:, None], hits.shape[1], level)
    _, high = _bounds(most[:, None], hits.shape[1], level)
    return Estimate(_moments(hits)[0], low[0], high[0])


def fractiles(values: Array, shares: Array, level: float) -> Estimate:
    """Values that are not exceeded with some probabilities, as order statistics.

    Parameters
    ----------
    values : ndarray, shape (n_replicates, n_points, n_records)
        Infinite ones are allowed; NaN counts as smallest or largest, whichever makes the interval wider.
    shares : ndarray, shape (n_shares,)
    level : float

    Returns
    -------
    Estimate, shape (n_shares,)
        Infinite ends where the sample gives none.
    """
    known = values[~np.isnan(values)]
    if not len(known):
        infinite = np.full(len(shares), np.inf)
        return Estimate(np.full(len(shares), np.nan), -infinite, infinite)
    at = np.unique(known)
    rows, points = values.reshape(len(values), -1), values.shape[1]

    def below(side: Literal["left", "right"], unknown: float) -> Array:
        """Shares of values below each of `at`, or up to it, in every replicate."""
        filled = np.sort(np.where(np.isnan(rows), unknown, rows), axis=1)
        return np.array([row.searchsorted(at, side) for row in filled]) / rows.shape[1]

    _, most = _bounds(below("right", -np.inf), points, level)
    least, _ = _bounds(below("left", np.inf), points, level)
    low = np.array([max(at[most < q], default=-np.inf) for q in shares])
    high = np.array([min(at[least >= q], default=np.inf) for q in shares])
    return Estimate(np.quantile(known, shares, method="inverted_cdf"), low, high)


def _bounds(shares: Array, points: int, level: float) -> tuple[Array, Array]:
    """Ends of the intervals of probabilities.

    Parameters
    ----------
    shares : ndarray, shape (n_replicates, n)
        Mean share of the points of each replicate, which may have a share of an event each.
    points : int
        Of a replicate.
    level : float
    """
    from scipy.special import betaincinv

    tail = 0.5 * (1.0 - level)
    half = _half(shares, level)
    mean, total = shares.mean(axis=0), len(shares) * points
    hits, misses = total * mean, total * (1.0 - mean)
    with np.errstate(invalid="ignore"):
        low = np.where(hits > 0.0, betaincinv(hits, misses + 1.0, tail), 0.0)
        high = np.where(misses > 0.0, betaincinv(hits + 1.0, misses, 1.0 - tail), 1.0)
    return np.minimum(low, np.maximum(mean - half, 0.0)), np.maximum(high, np.minimum(mean + half, 1.0))


def _student(level: float, freedom: float) -> float:
    """Student's two-sided quantile."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.5 * (1.0 + level)))


def _half(values: Array, level: float) -> Array:
    """Half of the interval of the mean of replicates, which are the first axis."""
    count = len(values)
    freedom = 2.0 / (2.0 / (count - 1) + (KURTOSIS - 3.0) / count)
    return np.asarray(_student(level, freedom) * values.std(axis=0, ddof=1) / np.sqrt(count))
