"""One value from those of all records: each by itself, their mean, or a fractile."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from pound_solve.numerics.types import Array

EACH: Final = "each"
MEAN: Final = "mean"


@dataclass(frozen=True)
class OverRecords:
    """How values of all records become one.

    Attributes
    ----------
    how : str or float
        `EACH`, `MEAN`, or the share of the records that do not exceed the value.
    """

    how: str | float

    def weights(self, values: Array) -> Array:
        """Weights of the records, by which a sum over them gives the values asked for.

        A fractile is the value of one record (an order statistic), so its derivatives are those of this
        record.

        Parameters
        ----------
        values : ndarray, shape (n_records,)

        Returns
        -------
        ndarray, shape (n_values, n_records)
        """
        count = len(values)
        if self.how == EACH:
            return np.eye(count)
        if self.how == MEAN:
            return np.full((1, count), 1.0 / count)
        order = np.argsort(values, kind="stable")
        weights = np.zeros((1, count))
        weights[0, order[max(int(np.ceil(float(self.how) * count - 1e-9)), 1) - 1]] = 1.0
        return weights

    def of(self, values: Array) -> Array:
        """Values asked for, shape (n_values,), of values of the records, shape (n_records,); NaN where a
        record that counts has none.
        """
        weights = self.weights(values)
        with np.errstate(invalid="ignore"):  # infinite demands of runs that stopped
            return np.asarray(np.where(weights > 0.0, weights * values, 0.0).sum(axis=1))

    @property
    def text(self) -> str:
        """In words."""
        if self.how == EACH:
            return "each record"
        return "mean of the records" if self.how == MEAN else f"{100.0 * float(self.how):g} % fractile"
