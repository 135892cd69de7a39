"""The motion at some instants of a piece of a run, with the inputs and their derivatives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pound_solve.loading.excitation import Excitation
from pound_solve.numerics import polynomial
from pound_solve.numerics.types import Array, Index
from pound_solve.sensitivity.trajectory import SmoothPiece

ORDERS = 4  #: inputs, and their derivatives that are needed


class Instants(NamedTuple):
    """Motion and inputs at some instants.

    Attributes
    ----------
    u, v, a : ndarray, shape (n, n_times)
    s : ndarray, shape (4, n_inputs, n_times)
        The inputs and their first three derivatives in time.
    ds : ndarray, shape (4, n_params, n_inputs, n_times)
        Their derivatives by the parameters.
    """

    u: Array
    v: Array
    a: Array
    s: Array
    ds: Array

    def moved(self, by: Array) -> Instants:
        """Return one instant with the derivatives of the inputs along an instant that moves with the
        parameters, by its derivatives `by`, shape (n_params,).
        """
        along = self.ds.copy()
        along[:-1] += self.s[1:, None] * by[:, None, None]
        return self._replace(ds=along)

    def at(self, i: int) -> Instants:
        """Return one of the instants."""
        chosen = slice(i, i + 1)
        return Instants(*(x[..., chosen] for x in self))


class InputSlopes:
    """Derivatives of the inputs by the parameters.

    Parameters
    ----------
    excitation : Excitation
    slopes : ndarray, shape (n_params, n_pieces, degree + 1, n_inputs)
        Of its coefficients.
    """

    def __init__(self, excitation: Excitation, slopes: Array) -> None:
        self.n_params, _, _, self.n_inputs = slopes.shape
        side_by_side = np.concatenate(list(slopes), axis=2) if slopes.any() else None
        self._excitation = None if side_by_side is None else Excitation(excitation.breaks, side_by_side)

    def at(self, starts: Array, t: Array) -> Array:
        """Return the derivatives at times `t`, shape (n_intervals, n_times), after the starts of intervals;
        shape (4, n_params, n_inputs, n_intervals * n_times).
        """
        shape = ORDERS, self.n_params, self.n_inputs, t.size
        if self._excitation is None:
            return np.zeros(shape)
        coefs = self._excitation.about(starts)
        return np.stack([polynomial.on(coefs, t, order) for order in range(ORDERS)]).reshape(shape)


def instants(piece: SmoothPiece, chosen: Index, times: Array, input_slopes: InputSlopes) -> Instants:
    """Return the motion at the same `times` within each of some intervals of a piece, interval by
    interval.
    """
    dense = piece.dense
    t = np.tile(times, (len(chosen), 1))
    coefs = dense.input_coefs[chosen]
    s = np.stack([polynomial.on(coefs, t, order) for order in range(ORDERS)])
    ds = input_slopes.at(piece.begin + dense.edges[chosen], t)
    return Instants(*dense.motions_within(chosen, times), s.reshape(ORDERS, -1, t.size), ds)
