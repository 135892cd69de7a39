"""Motion between equally spaced samples by cubic Hermite interpolation."""

from __future__ import annotations

import numpy as np

from pound_solve.numerics.types import Array


def hermite(h: float, x: float | Array, f: Array, slope: Array) -> tuple[Array, Array]:
    """Return value and slope at `x` in (0, h) of the cubic through values and slopes at both ends."""
    y = x / h
    d = f[1] - f[0]
    a, b = h * slope[0] - d, d - h * slope[1]
    value = (1 - y) * f[0] + y * f[1] + y * (1 - y) * ((1 - y) * a + y * b)
    slope_in_y = d + (1 - 2 * y) * ((1 - y) * a + y * b) + y * (1 - y) * (b - a)
    return value, slope_in_y / h


class SampledMotion:
    """Displacement, velocity and acceleration at equally spaced samples.

    Parameters
    ----------
    h : float
        Interval between samples [T].
    u, v, a : ndarray, shape (n, n_samples)
    """

    def __init__(self, h: float, u: Array, v: Array, a: Array) -> None:
        self.h, self.u, self.v, self.a = h, u, v, a

    def at(self, tau: float) -> tuple[Array, Array]:
        """Return displacement and velocity at a local time, shape (n,) each."""
        i = min(int(tau / self.h), self.u.shape[1] - 2)
        x, pair = tau - i * self.h, slice(i, i + 2)
        u, v, a = (y[:, pair].T for y in (self.u, self.v, self.a))
        return hermite(self.h, x, u, v)[0], hermite(self.h, x, v, a)[0]

    def at_times(self, t: Array) -> tuple[Array, Array]:
        """Return displacements and velocities at several local times, shape (n, n_t) each."""
        i = np.minimum((t / self.h).astype(int), self.u.shape[1] - 2)
        x = t - i * self.h
        u, v, a = (np.stack([y[:, i], y[:, i + 1]]) for y in (self.u, self.v, self.a))
        return hermite(self.h, x, u, v)[0], hermite(self.h, x, v, a)[0]


class SampledRows:
    """Rows at equally spaced samples and the cubics between them; one segment for `events.functions`.

    Parameters
    ----------
    t : ndarray, shape (n_t,)
    value, rate, second : ndarray, shape (n_rows, n_t)
    """

    def __init__(self, t: Array, value: Array, rate: Array, second: Array) -> None:
        self.t = t[None]
        self.value, self.rate, self.second = (x[:, None] for x in (value, rate, second))

    def at(self, row: int, segment: int, cell: int, tau: float) -> tuple[float, float, float]:
        """Return value, rate and second rate of a row at a time in a cell."""
        h, x = float(self.t[0, cell + 1] - self.t[0, cell]), tau - float(self.t[0, cell])
        d, v, w = (y[row, segment, cell : cell + 2] for y in (self.value, self.rate, self.second))
        value = hermite(h, x, d, v)[0]
        rate, second = hermite(h, x, v, w)
        return float(value), float(rate), float(second)

    def all_at(self, h: float, tau: float) -> tuple[Array, Array, Array]:
        """Return value, rate and second rate of all rows at a local time; the samples are `h` apart."""
        i = min(int(tau / h), self.t.shape[1] - 2)
        d, v, w = (y[:, 0, i : i + 2].T for y in (self.value, self.rate, self.second))
        value = hermite(h, tau - i * h, d, v)[0]
        return value, *hermite(h, tau - i * h, v, w)

    def until(self, tau: float, ends: tuple[Array, Array, Array]) -> SampledRows:
        """Return the samples before `tau`, followed by the rows `ends` at `tau`."""
        cut = self.t[0] < tau
        known = (
            np.append(x[:, 0, cut], y[:, None], axis=1)
            for x, y in zip((self.value, self.rate, self.second), ends)
        )
        return SampledRows(np.append(self.t[0, cut], tau), *known)


def simpson(h: float, begin: float, end: float) -> tuple[Array, Array]:
    """Return the times and weights of Simpson's rule over the cells of a grid with step `h` from `begin` to
    `end`.
    """
    inner = h * np.arange(int(np.floor(begin / h)) + 1, int(np.ceil(end / h)))
    edges = np.concatenate([[begin], inner[(inner > begin) & (inner < end)], [end]])
    width = np.diff(edges)
    t = np.append(np.column_stack([edges[:-1], edges[:-1] + 0.5 * width]).ravel(), end)
    weight = np.zeros(len(t))
    weight[:-1:2] += width / 6
    weight[1::2] += 4 * width / 6
    weight[2::2] += width / 6
    return t, weight
