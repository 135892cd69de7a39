r"""Fit of parameters by least squares, and intervals of the parameters from the curvature at the fit.

With weighted residuals :math:`r` of n values and their derivatives :math:`J` by p parameters, the
covariance of the parameters is (Seber and Wild 1989, Nonlinear Regression, chapters 2 and 6)

.. math:: V = (J^T J)^{-1} \Big(\sum_b \tau_b\, J_b^T J_b\Big) (J^T J)^{-1} s^2,
          \qquad s^2 = \frac{r^T r}{n - p}

The sum runs over the blocks b of values that were measured one after another.  The residuals of a block are
correlated where the model lacks something, so that n values tell less than n independent ones; the factor
:math:`\tau_b \ge 1` is their integrated autocorrelation time (Geyer 1992, Statistical Science 7: 473-483).
If the standard deviations of the values are known, :math:`s^2` is at least 1.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

import numpy as np

from pound_solve.numerics.types import Array, Index

PRECISE: Final = 1e-9  #: relative change of the sum of squares, and of the parameters, at which a fit ends
AT_BOUND: Final = 1e-6  #: distance to a bound, as a fraction of the range, up to which a parameter is at it


class Fit(NamedTuple):
    """Result of a fit in parameters scaled to ranges from 0 to 1.

    Attributes
    ----------
    x : ndarray, shape (p,)
    residuals : ndarray, shape (n,)
        Weighted, at x.
    jacobian : ndarray, shape (n, p)
    half : ndarray, shape (p,)
        Half width of the interval of each parameter; infinite where the values say nothing of it, NaN at a
        bound.
    correlation : ndarray, shape (p, p)
        Of the parameters; NaN where one of them has no interval.
    scatter : float
        The standard deviation s of the weighted residuals.
    """

    x: Array
    residuals: Array
    jacobian: Array
    half: Array
    correlation: Array
    scatter: float

    @property
    def cost(self) -> float:
        """Sum of the squares of the weighted residuals."""
        return float(self.residuals @ self.residuals)


def fit(
    residuals: Callable[[Array], Array],
    jacobian: Callable[[Array], Array],
    start: Array,
    blocks: Index,
    known: bool,
    confidence: float,
) -> Fit:
    """Fit parameters by the trust-region method of scipy (Branch, Coleman and Li 1999).

    Parameters
    ----------
    residuals, jacobian : callable
        Weighted residuals, shape (n,), and their derivatives, shape (n, p), at parameters from 0 to 1.
    start : ndarray, shape (p,)
    blocks : ndarray of int, shape (n,)
        Block of every value.
    known : bool
        Whether the weights are the inverse standard deviations of the values.
    confidence : float
        Of the intervals.
    """
    from scipy.optimize import least_squares

    inside = np.clip(start, 1e-3, 1.0 - 1e-3)
    result = least_squares(
        residuals,
        inside,
        jacobian,
        bounds=(0.0, 1.0),
        x_scale="jac",
        ftol=PRECISE,
        xtol=PRECISE,
        gtol=1e-15,
        max_nfev=100,
    )
    x, r = result.x, np.asarray(result.fun)
    j = jacobian(x)
    return Fit(x, r, j, *_intervals(x, r, j, blocks, known, confidence))


def _intervals(
    x: Array, r: Array, j: Array, blocks: Index, known: bool, confidence: float
) -> tuple[Array, Array, float]:
    """Half widths of the intervals, correlation, and scatter, see `Fit`."""
    from scipy.stats import norm, t

    free = np.flatnonzero((x > AT_BOUND) & (x < 1.0 - AT_BOUND))
    half, correlation = np.full(len(x), np.nan), np.full((len(x), len(x)), np.nan)
    freedom = len(r) - len(free)
    if freedom < 1 and not known:
        half[free] = np.inf  # as many parameters as values: the scatter is unknown
        return half, correlation, np.nan
    scatter = float(r @ r) / freedom if freedom > 0 else 1.0
    scale = max(scatter, 1.0) if known else scatter
    covariance = scale * _sandwich(r, j[:, free], blocks)
    sd = np.sqrt(np.diagonal(covariance))
    upper = 0.5 + 0.5 * confidence
    half[free] = sd * float(norm.ppf(upper) if known else t.ppf(upper, freedom))
    with np.errstate(invalid="ignore"):
        correlation[np.ix_(free, free)] = covariance / np.outer(sd, sd)
    return half, correlation, float(np.sqrt(scatter))


def _sandwich(r: Array, j: Array, blocks: Index) -> Array:
    """Covariance of the free parameters for residuals of standard deviation 1; infinite variances where the
    values do not depend on a parameter or a combination of them.
    """
    _, singular, v = np.linalg.svd(j, full_matrices=False)
    if not len(singular) or singular[-1] <= 1e-10 * singular[0]:
        return np.diag(np.full(j.shape[1], np.inf))
    inverse = (v.T / singular**2) @ v
    middle = np.zeros_like(inverse)
    for block in np.unique(blocks):
        rows = blocks == block
        middle += autocorrelation_time(r[rows]) * j[rows].T @ j[rows]
    return np.asarray(inverse @ middle @ inverse)


def autocorrelation_time(r: Array) -> float:
    """Integrated autocorrelation time of residuals, at least 1: n values tell as much as n over this number
    of independent ones.

    The sum over the lags ends where two successive autocorrelations together are not positive (Geyer 1992).
    """
    n = len(r)
    power = float(r @ r)
    if n < 4 or power == 0.0:
        return 1.0
    rho = [float(r[: n - k] @ r[k:]) / power for k in range(n // 2)]
    total = 0.0
    for k in range(0, len(rho) - 1, 2):
        pair = rho[k] + rho[k + 1]
        if pair <= 0.0:
            break
        total += pair
    return max(2.0 * total - 1.0, 1.0)


def correlated(fit: Fit, names: Sequence[str], above: float) -> list[tuple[str, str, float]]:
    """Pairs of parameters whose errors are correlated by more than a limit."""
    return [
        (names[i], names[j], float(fit.correlation[i, j]))
        for i in range(len(names))
        for j in range(i)
        if abs(fit.correlation[i, j]) > above
    ]
