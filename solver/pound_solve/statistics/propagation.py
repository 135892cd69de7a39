"""What an analysis of uncertainty asks for, and the demands of its runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.statistics.curves import Asked
from pound_solve.statistics.distributions import Distribution

CONTACT: Final = Asked("closures")  #: 1 or more in a run with a collision
SPREAD: Final = (0.16, 0.84)  #: fractiles of a variable between which the tornado varies it


@dataclass(frozen=True)
class UncertaintyAim:
    """What an analysis of uncertainty asks for.

    Attributes
    ----------
    distributions : mapping of str to Distribution
        Of every variable, in the order of the study.
    correlation : ndarray, shape (n_variables, n_variables)
    quantities : tuple of Asked
        Empty for `DEFAULTS`.
    limits : tuple of (Asked, float)
    sampling : str
        One of `SAMPLINGS`.
    runs, seed : int
        Points of the sample, and the seed of its randomizations.
    level : float
        Of confidence.
    with_indices : bool
        Whether Sobol indices are asked for.
    """

    distributions: Mapping[str, Distribution]
    correlation: Array
    quantities: tuple[Asked, ...]
    limits: tuple[tuple[Asked, float], ...]
    sampling: str
    runs: int
    seed: int
    level: float
    with_indices: bool

    @property
    def is_dependent(self) -> bool:
        """Whether any variables are correlated."""
        return bool(np.any(self.correlation != np.eye(len(self.correlation))))


@dataclass(frozen=True)
class Propagated:
    """Demands of all runs of an analysis, in all arrays with the records along the last axis.

    Attributes
    ----------
    nominal : mapping of Asked to ndarray, shape (n_records,)
        At the values of the study.
    sample : mapping of Asked to ndarray, shape (n_replicates, n_points, n_records)
        With indices also at their second sample.
    mixtures : mapping of Asked to ndarray, shape (n_variables, n_replicates, n_points, n_records)
        At the mixed samples of the indices; without indices nothing.
    tornado : mapping of Asked to ndarray, shape (1 + 2*n_variables, n_records)
        At all medians, then with each variable at the ends of `SPREAD`.
    """

    nominal: Mapping[Asked, Array]
    sample: Mapping[Asked, Array]
    mixtures: Mapping[Asked, Array]
    tornado: Mapping[Asked, Array]
