"""The peaks that AUTO compares between runs: the extremes of every drift, the peak force of every contact,
and the extreme deformations and plastic work of every spring and hinge that can yield.

The change of a drift or force is relative to its peak, but at least to `MIN_SCALE` times the largest peak
of its kind, so that a contact with a small force does not determine the step.  The change of a deformation
is relative to its peak, but at least to the yield deformation; that of plastic work to the work itself, but
at least to the work of the yield force over the yield deformation.  Ductilities and damage indices thus
have the same relative errors.  In a structure without drifts, the deformations of all springs are compared
like drifts, and all displacements relative to the largest in the same direction.  The accelerations of
nodes and forces of members that OUTPUT names are also compared if they have a tolerance, relative to the
largest of their kind.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from pound_solve.integrate.convergence.replay import Replay, Witness
from pound_solve.integrate.tracker import Extreme, Peaks
from pound_solve.numerics.types import Array, Index
from pound_solve.structure.elements.base import LawSpring
from pound_solve.structure.reduction import ReducedSystem

MIN_SCALE = 0.05  #: smallest scale of a peak, as a fraction of the largest peak of its kind
MIN_RISE = 0.05  #: smallest value of twice the rise time of a force, as a fraction of its collision
RESPONSE, ALL = "RESPONSE", "ALL"  #: values of PEAKS: the peaks to which TOL applies
RESPONSES, ACCELERATIONS, FORCES = range(3)  #: kinds of peaks with separate tolerances
NAMES = ("drifts, contact forces and hinges", "accelerations", "member forces")


def tolerances(options: Mapping[str, Any]) -> dict[int, float]:
    """Return the tolerance of each kind of peaks that has one, from the items of AUTO."""
    tol, every = float(options["TOL"]), options.get("PEAKS", RESPONSE) == ALL
    others = {ACCELERATIONS: options.get("TOL_ACCELERATION"), FORCES: options.get("TOL_MEMBER")}
    asked = {kind: float(tol if x is None else x) for kind, x in others.items() if x is not None or every}
    return {RESPONSES: tol, **asked}


class ComparedPeaks(NamedTuple):
    """Values that are compared between runs, the scales of their differences, and the kind of each value,
    which selects its tolerance.
    """

    values: Array
    scales: Array
    kinds: Index


def measured(extremes: Sequence[Extreme], kinds: Sequence[str]) -> ComparedPeaks:
    """Return extremes as values to be compared.  The scale of each is its magnitude, but at least
    `MIN_SCALE` times the largest of its kind.
    """
    values = np.array([(e.high, e.low) for e in extremes]).reshape(-1, 2)
    size = np.abs(values).max(axis=1, initial=0.0)
    scales = np.repeat(_floored(size, np.array(kinds)), 2)
    return ComparedPeaks(values.ravel(), scales, _all(RESPONSES, len(scales)))


def _all(kind: int, count: int) -> Index:
    return np.full(count, kind)


def _floored(size: Array, kinds: Array, share: float = MIN_SCALE) -> Array:
    """Return sizes, raised to at least the fraction `share` of the largest of their kind."""
    floored = size.copy()
    for kind in np.unique(kinds):
        alike = kinds == kind
        floored[alike] = np.maximum(floored[alike], share * floored[alike].max())
    return floored


def hinges(laws: Sequence[LawSpring], peaks: Peaks, losses: Sequence[float]) -> ComparedPeaks:
    """Return the deformations and plastic work of the springs and hinges that can yield.

    Parameters
    ----------
    laws : sequence of LawSpring
    peaks : Peaks
        Of a run.
    losses : sequence of float
        Energy that each law has lost in hysteresis at the end [F L].
    """
    values, scales = list[float](), list[float]()
    for s, d, f, loss in zip(laws, peaks.deformation, peaks.force, losses):
        first = [(abs(y), abs(p)) for y, p in zip(s.yields or (), s.strengths or ()) if abs(y) > 0.0]
        if not first or s.role.collides:
            continue
        at_yield, strength = min(first)
        largest = s.whole(d.high, f.high), s.whole(d.low, f.low)
        size = max(at_yield, *map(abs, largest))
        values += [*largest, loss]
        scales += [size, size, max(loss, strength * at_yield)]
    return ComparedPeaks(np.array(values), np.array(scales), _all(RESPONSES, len(values)))


def figures(
    system: ReducedSystem, peaks: Peaks, witness: Witness, asked: Collection[int] = ()
) -> ComparedPeaks:
    """Return the peaks that are compared between runs: the responses, and the other kinds in `asked`."""
    laws = system.structure.laws
    lasting = [c for c in peaks.collisions if not math.isnan(c.peak)]  # not impacts, which have no force
    contacts = [i for i, s in enumerate(laws) if s.role.collides]
    force = np.array([max((c.peak for c in lasting if c.law == i), default=0.0) for i in contacts])
    parts = [measured(peaks.monitored, ["drift"] * len(peaks.monitored)), hinges(laws, peaks, witness.lost)]
    if not peaks.monitored:
        springs = [(e, s.unit) for e, s in zip(peaks.deformation, laws) if not s.role.collides]
        parts.append(measured([e for e, _ in springs], [unit for _, unit in springs]))
        direction = np.array([d for _, d in system.dofs])
        displacement = np.column_stack([np.ravel(witness.high), np.ravel(witness.low)])
        # hinges and uplift have separate directions
        largest = _floored(np.abs(displacement).max(axis=1), direction, 1.0)
        parts.append(
            ComparedPeaks(displacement.ravel(), np.repeat(largest, 2), _all(RESPONSES, displacement.size))
        )
    if ACCELERATIONS in asked or FORCES in asked:
        assert isinstance(witness, Replay)  # a stored run
        values, units = witness.seen(system)
        kinds = np.array([ACCELERATIONS if unit == "acceleration" else FORCES for unit in units], int)
        wanted = np.isin(kinds, list(asked))
        scales = _floored(np.abs(values), np.array(units), 1.0)
        parts.append(ComparedPeaks(values[wanted], scales[wanted], kinds[wanted]))
    parts.append(ComparedPeaks(force, _floored(force, np.zeros(len(force))), _all(RESPONSES, len(force))))
    return ComparedPeaks(*(np.concatenate(x) for x in zip(*parts)))


def hardest(peaks: Peaks) -> float:
    """Return the duration of the collision with the largest force [T], or twice the time to its peak if
    this is shorter; infinite without collisions.

    A long collision may reach its peak early, through a mode that is much faster than the collision, and
    steps have to resolve that mode.  A force that is largest at the touch jumps there because of a dashpot,
    which a located event resolves.
    """
    collision = max(peaks.collisions, key=lambda c: c.peak, default=None)
    if collision is None or not collision.t_end > collision.t_start:  # still closed
        return np.inf
    lasts, rises = collision.t_end - collision.t_start, collision.t_peak - collision.t_start
    return min(lasts, max(2.0 * rises, MIN_RISE * lasts)) if rises > 0.0 else lasts
