"""What a run by linear pieces watches: exits of the laws, and the quantities whose peaks it keeps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np

from pound_solve.integrate.events import grid
from pound_solve.integrate.protocol import Peak, ResponseTracker
from pound_solve.laws.automaton import Branch
from pound_solve.numerics.types import Array


class Sampled(Protocol):
    """Rows seen at some points of some arcs, and between them.

    Attributes
    ----------
    t : ndarray, shape (n_arcs, n_points)
    value, rate, second : ndarray, shape (n_rows, n_arcs, n_points)
    """

    t: Array
    value: Array
    rate: Array
    second: Array

    def at(self, row: int, arc: int, cell: int, tau: float) -> tuple[float, float, float]:
        """Value, rate and second rate of a row at a time in the cell after a point of an arc."""
        ...


class Functionals:
    """Linear functions of a row's value and rate: ``a value + b rate + c``.

    Parameters
    ----------
    row : sequence of int
    factors : sequence of (a, b, c)

    Attributes
    ----------
    by_rate : bool
        Whether any has a part by the rate.
    """

    def __init__(self, row: Sequence[int], factors: Sequence[Sequence[float]]) -> None:
        self.row, self.factors = np.array(row, np.intp), np.array(factors).reshape(-1, 3).T
        self.by_rate = bool(self.factors[1].any())

    def of(self, seen: Sampled) -> tuple[Array, Array]:
        """Values and slopes at the points, shape (n, n_arcs, n_points)."""
        a, b, c = self.factors[:, :, None, None]
        rate = seen.rate[self.row]
        value, slope = a * seen.value[self.row] + c, a * rate
        if self.by_rate:
            value += b * rate
            slope += b * seen.second[self.row]
        return value, slope

    def bends(self, bends: Array) -> Array:
        """Bounds of their second derivatives, shape (n, n_arcs), from those of the rows' values and rates,
        shape (2, n_rows, n_arcs), which may be infinite.
        """
        a, b, _ = np.abs(self.factors)[:, :, None]
        out = np.asarray(a * np.where(a != 0.0, bends[0, self.row], 0.0))
        if self.by_rate:
            out += b * np.where(b != 0.0, bends[1, self.row], 0.0)
        return out

    def scale(self, largest: Array) -> Array:
        """Largest magnitude of what makes them up, shape (n,), from that of rows and rates (2, n_rows)."""
        a, b, c = np.abs(self.factors)
        return np.asarray(a * largest[0, self.row] + b * largest[1, self.row] + c)

    def first_rise(self, seen: Sampled, largest: Array, still: float) -> tuple[float, int, int, int] | None:
        """When, which of them and where first rises through zero (see `search.first_rise`), by more than a
        share `still` of what makes it up.
        """
        g, slope = self.of(seen)
        scale = np.maximum(self.scale(largest), np.abs(g[:, 0, :2]).max(axis=1, initial=0.0))
        return grid.first_rise(seen.t, g, slope, still * scale[:, None, None], self.at(seen))

    def at(self, seen: Sampled) -> grid.Exact:
        """What evaluates one of them, its value and its slope, within a cell."""
        a, b, c = self.factors.tolist()
        row = self.row.tolist()

        def exact(n: int, arc: int, cell: int, tau: float) -> tuple[float, float]:
            d, v, w = seen.at(row[n], arc, cell, tau)
            return a[n] * d + b[n] * v + c[n], a[n] * v + b[n] * w

        return exact


def exits(
    branches: Sequence[Branch], force_row: Mapping[int, int]
) -> tuple[Functionals, list[tuple[int, int]]]:
    """Exits of all laws, and the law and number of each.

    What a closed rigid contact may leave by is its force, a row of its own.
    """
    pairs = [(i, e) for i, b in enumerate(branches) for e in range(len(b.exits))]
    rows = [force_row[i] if branches[i].held else i for i, _ in pairs]
    return Functionals(rows, [branches[i].exits[e] for i, e in pairs]), pairs


def followed(
    tracker: ResponseTracker, branches: Sequence[Branch], force_row: Mapping[int, int]
) -> tuple[Functionals, list[Peak]]:
    """Deformations, drifts, and the forces of springs and of contacts that are pressed, with what keeps
    their peaks: forces of contacts go to the collision that runs.
    """
    peaks, running = tracker.peaks, tracker.open
    rows = list(range(len(branches) + len(peaks.monitored)))
    factors = [(1.0, 0.0, 0.0)] * len(rows)
    kept: list[Peak] = [*peaks.deformation, *peaks.monitored]
    for i, (spring, b) in enumerate(zip(tracker.laws, branches)):
        if spring.role.collides and i not in running:
            continue
        rows.append(force_row[i] if b.held else i)
        factors.append((1.0 if b.held else b.stiffness, b.damping * spring.role.viscous, b.force0))
        kept.append(tracker.running(i) if i in running else peaks.force[i])
    return Functionals(rows, factors), kept
