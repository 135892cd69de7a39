"""Functions of the motion that a run monitors: event functions of the laws, and quantities with peaks."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple, Protocol

import numpy as np

from pound_solve.integrate.events import grid
from pound_solve.integrate.events.protocol import CONTACT_SAMPLES, LocatedEvent
from pound_solve.integrate.tracker import Peak, ResponseTracker
from pound_solve.laws.automaton import Branch
from pound_solve.numerics.types import Array, Flags


class RowSet(NamedTuple):
    """Linear functionals of the unknowns that a run monitors, ``rows u + inputs s + constants``.  The laws'
    deformations come first.

    Attributes
    ----------
    rows : ndarray, shape (n_rows, n)
    inputs : ndarray, shape (n_rows, n_inputs)
    constants : ndarray, shape (n_rows,)
    """

    rows: Array
    inputs: Array
    constants: Array


class Sampled(Protocol):
    """Values of rows at the sample points of time segments, and between these points.

    Attributes
    ----------
    t : ndarray, shape (n_segments, n_points)
    value, rate, second : ndarray, shape (n_rows, n_segments, n_points)
    """

    t: Array
    value: Array
    rate: Array
    second: Array

    def at(self, row: int, segment: int, cell: int, tau: float) -> tuple[float, float, float]:
        """Return value, rate and second rate of a row at the time `tau` in a cell of a segment."""


class RowFunctions:
    """Linear functions of a row's value and rate: ``a value + b rate + c``.

    Parameters
    ----------
    row : sequence of int
    factors : sequence of (a, b, c)

    Attributes
    ----------
    by_rate : bool
        Whether any function depends on a rate.
    """

    def __init__(self, row: Sequence[int], factors: Sequence[Sequence[float]]) -> None:
        self.row, self.factors = np.array(row, np.intp), np.array(factors).reshape(-1, 3).T
        self.by_rate = bool(self.factors[1].any())

    def sampled(self, samples: Sampled) -> tuple[Array, Array]:
        """Values and slopes at the points, shape (n, n_segments, n_points)."""
        a, b, c = self.factors[:, :, None, None]
        rate = samples.rate[self.row]
        value, slope = a * samples.value[self.row] + c, a * rate
        if self.by_rate:
            value += b * rate
            slope += b * samples.second[self.row]
        return value, slope

    def curvature_bounds(self, bounds: Array) -> Array:
        """Return bounds of the second derivatives of the functions, shape (n, n_segments).  `bounds` are
        those of the rows' values and rates, shape (2, n_rows, n_segments); they may be infinite.
        """
        a, b, _ = np.abs(self.factors)[:, :, None]
        curvatures = np.asarray(a * np.where(a != 0.0, bounds[0, self.row], 0.0))
        if self.by_rate:
            curvatures += b * np.where(b != 0.0, bounds[1, self.row], 0.0)
        return curvatures

    def scale(self, largest: Array) -> Array:
        """Return the largest magnitude of the terms of each function, shape (n,), from that of rows and
        rates (2, n_rows).
        """
        a, b, c = np.abs(self.factors)
        return np.asarray(a * largest[0, self.row] + b * largest[1, self.row] + c)

    def evaluator(self, samples: Sampled) -> grid.Evaluate:
        """Return a function that computes value and slope of one of these functions within a cell."""
        a, b, c = self.factors.tolist()
        row = self.row.tolist()

        def evaluate(n: int, segment: int, cell: int, tau: float) -> tuple[float, float]:
            d, v, w = samples.at(row[n], segment, cell, tau)
            return a[n] * d + b[n] * v + c[n], a[n] * v + b[n] * w

        return evaluate


class GridEvent(NamedTuple):
    """An event located on a grid, and the cell that contains it."""

    event: LocatedEvent
    segment: int
    cell: int


class EventFunctions(RowFunctions):
    """Event functions of all laws on their present branches.

    The event function of a closed rigid contact depends on its force, which has a separate row.

    Parameters
    ----------
    branches : sequence of Branch
    reaction_row : mapping of int to int
        Row of the force of every rigid contact, by law.

    Attributes
    ----------
    keys : list of (law, event_index)
    """

    def __init__(self, branches: Sequence[Branch], reaction_row: Mapping[int, int]) -> None:
        self.keys = [(i, e) for i, b in enumerate(branches) for e in range(len(b.events))]
        rows = [reaction_row[i] if branches[i].constrains else i for i, _ in self.keys]
        super().__init__(rows, [branches[i].events[e] for i, e in self.keys])

    def violated(
        self, samples: Sampled, largest: Array, tolerance: float, laws: Flags
    ) -> LocatedEvent | None:
        """Return the first event, by number, that a jump of a law's rate has made overdue, or None.  It is
        overdue if its function depends on the rate and is above zero at the first sample.

        Parameters
        ----------
        samples, largest, tolerance
            As in `first_event`.
        laws : ndarray of bool, shape (n_laws,)
            Laws whose rates may jump.
        """
        if not self.by_rate or not laws.any() or not samples.t.size:
            return None
        g = self.sampled(samples)[0][:, 0, 0]
        overdue = (g > tolerance * self.scale(largest)) & (self.factors[1] != 0.0)
        for n in np.flatnonzero(overdue).tolist():
            if laws[self.keys[n][0]]:
                return LocatedEvent(*self.keys[n], 0.0)
        return None

    def first_event(
        self, samples: Sampled, largest: Array, tolerance: float, late: Collection[int] = ()
    ) -> GridEvent | None:
        """Return the earliest event within the samples, or None.

        An event of the laws `late`, which are contacts, counts only if it clearly precedes that of any
        other law.  Otherwise bodies that move alike would seem to meet while a hinge of one has yielded and
        that of the other has not.

        Parameters
        ----------
        samples : Sampled
        largest : ndarray, shape (2, n_rows)
            Largest magnitudes of rows and rates so far.
        tolerance : float
            Fraction of the magnitude of its terms up to which a function counts as not above zero.
        late : collection of int
        """
        if not self.keys or not samples.t.size:
            return None
        g, slope = self.sampled(samples)
        scale = np.maximum(self.scale(largest), np.abs(g[:, 0, :2]).max(axis=1, initial=0.0))
        tol = tolerance * scale[:, None, None]
        evaluate = self.evaluator(samples)
        rise = grid.first_rise(samples.t, g, slope, tol, evaluate)
        if rise is None:
            return None
        if self.keys[rise.function][0] in late:
            there = tol[rise.function, 0, 0]
            others = np.where([[[law in late]] for law, _ in self.keys], np.inf, tol)
            other = grid.first_rise(samples.t, g, slope, others, evaluate)
            if other is not None and (other.segment, other.cell) == (rise.segment, rise.cell):
                times = np.linspace(rise.time, other.time, CONTACT_SAMPLES).tolist()
                values = [evaluate(rise.function, rise.segment, rise.cell, t)[0] for t in times]
                rise = rise if max(values) > there else other
        law, event_index = self.keys[rise.function]
        return GridEvent(LocatedEvent(law, event_index, rise.time), rise.segment, rise.cell)


def monitored_functions(
    tracker: ResponseTracker, branches: Sequence[Branch], reaction_row: Mapping[int, int]
) -> tuple[RowFunctions, list[Peak]]:
    """Return functions for deformations, drifts, and the forces of springs and of closed contacts, and
    their peaks.  Forces of contacts belong to the present collision.
    """
    rows = list(range(len(branches) + tracker.n_monitored))
    factors = [(1.0, 0.0, 0.0)] * len(rows)
    kept: list[Peak] = [tracker.deformation(i) for i in range(len(branches))]
    kept += [tracker.monitored(i) for i in range(tracker.n_monitored)]
    for i, (spring, b) in enumerate(zip(tracker.laws, branches)):
        if spring.role.collides and i not in tracker.open:
            continue
        rows.append(reaction_row[i] if b.constrains else i)
        # a spring's force excludes damping
        damping = b.damping * spring.role.reports_damping
        factors.append((1.0 if b.constrains else b.stiffness, damping, b.force0))
        kept.append(tracker.collision_force(i) if i in tracker.open else tracker.force(i))
    return RowFunctions(rows, factors), kept
