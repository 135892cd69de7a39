"""Deferred integration of work: the intervals of one decomposition are integrated together once the work is
needed.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pound_solve.integrate.closed_form.decomposition import JoinedPart
from pound_solve.integrate.closed_form.dense_output import DenseOutput
from pound_solve.integrate.energy import CONTACT, DAMPING, INPUT, EnergyAccumulator
from pound_solve.numerics.types import Array, Flags


class DeferredWork:
    """Energy input, energy lost in dashpots of structure and springs, and energy lost in those of contacts
    [F L].

    Parameters
    ----------
    accumulator : EnergyAccumulator
        Receives the works when they are evaluated.
    constant : ndarray, shape (n,)
        Constant loads on the unknowns.
    contact : ndarray of bool, shape (n_laws,)
        Which laws are contacts.

    Attributes
    ----------
    entries : int
        Number of entries since the last `restart`.
    """

    def __init__(self, accumulator: EnergyAccumulator, constant: Array, contact: Flags) -> None:
        self.accumulator, self.constant, self.contact = accumulator, constant, contact
        self.entries = 0
        self._known: list[tuple[int, Array]] = []
        self._deferred: dict[int, tuple[JoinedPart, list[tuple[Any, ...]]]] = {}

    def add(self, work: Array) -> None:
        """Add work that is already known, shape (3,)."""
        self._known.append((self.entries, work))
        self.entries += 1

    def add_intervals(self, dense: DenseOutput, first: int, last: int, lengths: Array) -> None:
        """Add some intervals of a window, or the first part of each, shape (last - first,)."""
        chosen, place = slice(first, last), self.entries + np.arange(last - first)
        for subsystem in dense.subsystems.present:
            loads = None if subsystem.loads is None else subsystem.loads[chosen]
            for part in subsystem.decomposition.parts:
                qs, gs = subsystem.states[part.q, chosen].T, subsystem.forcing[chosen, :, part.q]
                entry = qs, gs, lengths, dense.input_coefs[chosen], place, loads
                self._deferred.setdefault(id(part.work), (part, []))[1].append(entry)
        self.entries += last - first

    def evaluated(self) -> tuple[Array, dict[int, float]]:
        """Return the works before the first entry and after each entry, shape (entries + 1, 3), and the
        losses in the dashpots of the laws over all entries, by law.
        """
        new = np.zeros((self.entries + 1, 3))
        new[0] = self.accumulator.array()
        for entry, work in self._known:
            new[entry + 1] += work
        losses: dict[int, float] = {}
        for part, entries in self._deferred.values():
            *arrays, loads = zip(*entries)
            qs, gs, lengths, input_coefs, place = (np.concatenate(x) for x in arrays)
            forces = None if loads[0] is None else np.concatenate(loads)
            works = part.work.over_intervals(
                qs.T, gs, lengths, input_coefs, self.constant[part.unknowns], forces
            )
            new[place + 1, INPUT] += works.input
            new[place + 1, DAMPING] += works.damping
            for law, loss in works.laws:
                losses[law] = losses.get(law, 0.0) + float(loss.sum())
                new[place + 1, CONTACT if self.contact[law] else DAMPING] += loss
        return np.cumsum(new, axis=0), losses

    def restart(self, works: Array) -> None:
        """Start again from the last of the `evaluated` works."""
        self.accumulator.advance(works)
        self.entries = 0
        self._known.clear()
        self._deferred.clear()
