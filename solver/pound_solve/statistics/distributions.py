r"""Distributions of uncertain variables, and their dependence.

A distribution is given by its moments or by its ends, and may be truncated: its quantile function then is

.. math:: x(u) = F^{-1}\bigl(F(a) + u\,(F(b) - F(a))\bigr)

between the ends a and b.  Mean and standard deviation are those before the truncation.

Dependent variables follow a Gaussian copula (Nataf 1962, C. R. Acad. Sci. 225: 42-43; Liu and Der
Kiureghian 1986, Probab. Eng. Mech. 1: 105-112): standard normals of the given correlations, each mapped to
its variable. The correlations are those of the normals; of the variables themselves they differ a little.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final, NamedTuple

import numpy as np

from pound_solve.numerics.types import Array

SMALLEST_MASS: Final = 1e-6  #: probability between the ends of a truncated distribution
COVS: Final = (1e-3, 10.0)  #: coefficients of variation of a Weibull distribution


class DistributionError(ValueError):
    """Raised if the parameters give no distribution; the message states why."""


@dataclass(frozen=True)
class Parameters:
    """Parameters of a distribution; NaN for those that are not given.

    Attributes
    ----------
    mean, sd : float
        Before a truncation.
    mode : float
        Most probable value.
    low, high : float
        Ends; infinite without one.
    """

    mean: float = math.nan
    sd: float = math.nan
    mode: float = math.nan
    low: float = -math.inf
    high: float = math.inf

    @property
    def cov(self) -> float:
        """Coefficient of variation, of a positive mean."""
        if not self.mean > 0.0:
            raise DistributionError(f"its mean is above zero, not {self.mean:g}")
        return self.sd / self.mean


class Family(NamedTuple):
    """A family of distributions: the parameters it takes, and its distribution as scipy has it.

    Attributes
    ----------
    takes : tuple of str
        Fields of `Parameters`.
    made : callable
    """

    takes: tuple[str, ...]
    made: Callable[[Parameters], Any]

    @property
    def is_truncated(self) -> bool:
        """Whether low and high truncate it, instead of being parameters of it."""
        return "low" not in self.takes


def _normal(p: Parameters) -> Any:
    from scipy.stats import norm

    return norm(p.mean, p.sd)


def _lognormal(p: Parameters) -> Any:
    from scipy.stats import lognorm

    s2 = math.log1p(p.cov**2)
    return lognorm(math.sqrt(s2), scale=p.mean * math.exp(-0.5 * s2))


def _gumbel(p: Parameters) -> Any:
    from scipy.stats import gumbel_r

    scale = p.sd * math.sqrt(6.0) / math.pi
    return gumbel_r(p.mean - float(np.euler_gamma) * scale, scale)


def _weibull(p: Parameters) -> Any:
    from scipy.optimize import brentq
    from scipy.special import gammaln
    from scipy.stats import weibull_min

    if not COVS[0] <= p.cov <= COVS[1]:
        raise DistributionError(
            f"its coefficient of variation is {COVS[0]:g} to {COVS[1]:g}, not {p.cov:g}"
        )

    def excess(k: float) -> float:
        return float(gammaln(1.0 + 2.0 / k) - 2.0 * gammaln(1.0 + 1.0 / k)) - math.log1p(p.cov**2)

    shape = float(brentq(excess, 0.1, 1e4, xtol=1e-13, rtol=1e-14))
    return weibull_min(shape, scale=p.mean / math.exp(float(gammaln(1.0 + 1.0 / shape))))


def _gamma(p: Parameters) -> Any:
    from scipy.stats import gamma

    return gamma(p.cov**-2, scale=p.mean * p.cov**2)


def _uniform(p: Parameters) -> Any:
    from scipy.stats import uniform

    return uniform(p.low, p.high - p.low)


def _triangular(p: Parameters) -> Any:
    from scipy.stats import triang

    if not p.low <= p.mode <= p.high:
        raise DistributionError(f"its mode is {p.low:g} to {p.high:g}, not {p.mode:g}")
    width = p.high - p.low
    return triang((p.mode - p.low) / width, p.low, width)


def _beta(p: Parameters) -> Any:
    from scipy.stats import beta

    width = p.high - p.low
    share = (p.mean - p.low) / width
    largest = width * math.sqrt(max(share * (1.0 - share), 0.0))
    if not 0.0 < share < 1.0:
        raise DistributionError(f"its mean is between {p.low:g} and {p.high:g}, not {p.mean:g}")
    if not p.sd < largest:
        raise DistributionError(f"its standard deviation is below {largest:g}, not {p.sd:g}")
    both = (largest / p.sd) ** 2 - 1.0
    return beta(share * both, (1.0 - share) * both, p.low, width)


_MOMENTS: Final = ("mean", "sd")
FAMILIES: Final[Mapping[str, Family]] = MappingProxyType(
    {
        "normal": Family(_MOMENTS, _normal),
        "lognormal": Family(_MOMENTS, _lognormal),
        "gumbel": Family(_MOMENTS, _gumbel),
        "weibull": Family(_MOMENTS, _weibull),
        "gamma": Family(_MOMENTS, _gamma),
        "uniform": Family(("low", "high"), _uniform),
        "triangular": Family(("low", "mode", "high"), _triangular),
        "beta": Family(("low", "high", *_MOMENTS), _beta),
    }
)


class Distribution:
    """A distribution of one variable.

    Parameters
    ----------
    family : str
        One of `FAMILIES`.
    parameters : Parameters

    Raises
    ------
    DistributionError
        The parameters give no such distribution, or almost none of it is between its ends.
    """

    def __init__(self, family: str, parameters: Parameters) -> None:
        self.family, self.parameters = family, parameters
        self._whole = FAMILIES[family].made(parameters)
        low, high = parameters.low, parameters.high
        self._below, self._to = float(self._whole.cdf(low)), float(self._whole.cdf(high))
        if self._to - self._below < SMALLEST_MASS:
            raise DistributionError(
                f"only {self._to - self._below:.1e} of its probability is between {low:g} and {high:g}"
            )

    def quantile(self, u: Array | float) -> Array:
        """Values that are not exceeded with probabilities u between 0 and 1, in their shape."""
        inside = self._whole.ppf(self._below + np.asarray(u) * (self._to - self._below))
        return np.clip(np.asarray(inside, np.float64), self.parameters.low, self.parameters.high)


def dependent(u: Array, correlation: Array) -> Array:
    """Uniform variates of a Gaussian copula from independent ones.

    Parameters
    ----------
    u : ndarray, shape (..., n_variables)
        Between 0 and 1.
    correlation : ndarray, shape (n_variables, n_variables)
        Of the standard normals; positive definite.
    """
    from scipy.special import ndtr, ndtri

    factor = np.linalg.cholesky(correlation)
    return np.asarray(ndtr(ndtri(u) @ factor.T))
