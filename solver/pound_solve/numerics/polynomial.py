"""Polynomials with ascending coefficients along the first axis."""

from __future__ import annotations

from functools import cache
from math import comb, perm

import numpy as np

from pound_solve.numerics.types import Array


@cache
def _binomials(n: int) -> tuple[Array, Array]:
    """Return the binomials C(k, i) at [i, k], and the powers k - i (0 where the binomial is 0)."""
    table = np.array([[comb(k, i) for k in range(n)] for i in range(n)], float)
    return table, np.maximum(np.arange(n)[None, :] - np.arange(n)[:, None], 0)


@cache
def _falling(n: int, order: int) -> Array:
    """Return the factors k (k-1) ... (k-order+1) of each coefficient from `order` on after `order`
    derivatives.
    """
    return np.array([perm(k, order) for k in range(order, n)], float)


def shift(coefs: Array, t: float | Array) -> Array:
    """Return the coefficients of the same polynomials about an origin shifted by `t`.

    Parameters
    ----------
    coefs : ndarray, shape (degree + 1, ...)
    t : float, or ndarray that broadcasts with one coefficient

    Returns
    -------
    ndarray, shape of `coefs`
    """
    if not np.any(t):
        return coefs
    if np.ndim(t) == 0:
        table, power = _binomials(len(coefs))
        return np.asarray((table * float(t) ** power) @ coefs.reshape(len(coefs), -1)).reshape(coefs.shape)
    shifted = np.array(coefs)
    for k in range(len(shifted) - 1):  # Horner's divisions work in place
        for i in range(len(shifted) - 2, k - 1, -1):
            shifted[i] += t * shifted[i + 1]
    return shifted


def value(coefs: Array, t: float, order: int = 0) -> Array:
    """Return the value at `t` of polynomials, or of their `order`-th derivatives, shape
    ``coefs.shape[1:]``.
    """
    n = len(coefs)
    if order >= n:
        return np.zeros(coefs.shape[1:])
    factors = _falling(n, order).tolist()
    total = factors[-1] * coefs[-1]
    for factor, coef in zip(factors[-2::-1], coefs[-2::-1]):
        total = total * t + factor * coef
    return np.asarray(total)


def on(coefs: Array, t: Array, order: int = 0) -> Array:
    """Return the `value` of several sets of polynomials, each at separate times.

    Parameters
    ----------
    coefs : ndarray, shape (n_sets, degree + 1, n)
    t : ndarray, shape (n_sets, n_times)
    order : int

    Returns
    -------
    ndarray, shape (n, n_sets, n_times)
    """
    _, terms, n = coefs.shape
    if order >= terms:
        return np.zeros((n, *t.shape))
    by_power = coefs[:, order:].transpose(1, 2, 0)[..., None]  # power, polynomial, set
    factors = _falling(terms, order).tolist()
    sums = np.broadcast_to(factors[-1] * by_power[-1], (n, *t.shape))
    for factor, x in zip(factors[-2::-1], by_power[-2::-1]):
        sums = sums * t + factor * x
    return sums


def values(coefs: Array, t: Array, order: int = 0) -> Array:
    """Return the `value` of one set of polynomials at each time.

    Parameters
    ----------
    coefs : ndarray, shape (n_times, degree + 1, n)
    t : ndarray, shape (n_times,)
    order : int

    Returns
    -------
    ndarray, shape (n_times, n)
    """
    n = coefs.shape[1]
    if order >= n:
        return np.zeros((len(t), coefs.shape[2]))
    weights = _falling(n, order) * t[:, None] ** np.arange(n - order)
    values: Array = np.einsum("tk,tkn->tn", weights, coefs[:, order:])
    return values
