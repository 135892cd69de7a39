r"""Sobol indices: the shares of the variance of a quantity that come from each variable.

With the variance V of the quantity f, a variable i has the indices (Sobol 2001, Math. Comput. Simul. 55:
271-280)

.. math:: S_i = \frac{V\bigl(E(f \mid x_i)\bigr)}{V}, \qquad
          T_i = \frac{E\bigl(V(f \mid x_{\sim i})\bigr)}{V}

of first order, and in total with all interactions.  From two independent samples A and B, and
:math:`A_B^i`, which is A with the values of variable i from B, their estimators are (Saltelli et al. 2010,
Comput. Phys. Commun. 181: 259-270; Jansen 1999, Comput. Phys. Commun. 117: 35-43)

.. math:: S_i V \approx \overline{f_B\,(f_{A_B^i} - f_A)}, \qquad
          T_i V \approx \tfrac12\,\overline{(f_A - f_{A_B^i})^2}.

Runs under several records have the record as one more variable, whose values are equally probable.  Every
point is run under all of them, so that its conditional moments are plain means.  The intervals are those of
`replicates`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pound_solve.numerics.types import Array
from pound_solve.statistics.replicates import Estimate, jackknifed


class SobolIndices(NamedTuple):
    """Indices of first order and in total, shape (n_variables + 1,); the last is the record."""

    first: Estimate
    total: Estimate


def mixed(first: Array, second: Array) -> Array:
    """Samples that have one variable of another sample each.

    Parameters
    ----------
    first, second : ndarray, shape (..., n_variables)

    Returns
    -------
    ndarray, shape (n_variables, ..., n_variables)
        `first` with variable i of `second`.
    """
    out = np.repeat(first[None], first.shape[-1], axis=0)
    for i in range(first.shape[-1]):
        out[i, ..., i] = second[..., i]
    return out


def indices(first: Array, second: Array, mixtures: Array, level: float) -> SobolIndices:
    """Indices of all variables.

    Parameters
    ----------
    first, second : ndarray, shape (n_replicates, n_points, n_records)
        Values at both samples.
    mixtures : ndarray, shape (n_variables, n_replicates, n_points, n_records)
        Values at `mixed` samples.
    level : float
        Of confidence.
    """

    def both(some: NDArray[np.intp]) -> Array:
        a, b, ab = first[some], second[some], mixtures[:, some]
        every = np.concatenate([a, b], axis=1)
        centre, variance = every.mean(), every.var()
        mean_a, mean_b, mean_ab = a.mean(axis=-1), b.mean(axis=-1) - centre, ab.mean(axis=-1)
        of_first = (mean_b * (mean_ab - mean_a)).mean(axis=(1, 2))
        of_total = 0.5 * ((a - ab) ** 2).mean(axis=(1, 2, 3))
        record_first, record_total = every.mean(axis=(0, 1)).var(), every.var(axis=-1).mean()
        rows = np.append(of_first, record_first), np.append(of_total, record_total)
        return np.asarray(np.array(rows) / variance)

    with np.errstate(divide="ignore", invalid="ignore"):  # all values that differ are in one replicate
        estimate = jackknifed(both, level, len(first))
    return SobolIndices(*(Estimate(*(x[k] for x in estimate)) for k in range(2)))
