"""Works of a run, put off: intervals that one regime governs are measured together, when somebody asks."""

from __future__ import annotations

from typing import Any

import numpy as np

from pound_solve.integrate.closed_form.dense_output import DenseOutput
from pound_solve.integrate.closed_form.subsystems import Part
from pound_solve.numerics.types import Array, Flags


class DeferredWork:
    """Work put in, lost in dashpots of structure and springs, and lost in those of contacts [F L].

    Parameters
    ----------
    works : ndarray, shape (3,)
        At the start.
    constant : ndarray, shape (n,)
        Loads on the unknowns.
    contact : ndarray of bool, shape (n_laws,)
        Which laws are contacts.

    Attributes
    ----------
    rows : int
        Entries since it was closed last.
    put_in : float
        Sum of all \\|input\\| up to there.
    """

    def __init__(self, works: Array, constant: Array, contact: Flags) -> None:
        self.works, self.constant, self.contact, self.rows, self.put_in = works, constant, contact, 0, 0.0
        self._known: list[tuple[int, Array]] = []
        self._open: dict[int, tuple[Part, list[tuple[Any, ...]]]] = {}

    def put(self, work: Array) -> None:
        """Enter what is known already, shape (3,)."""
        self._known.append((self.rows, work))
        self.rows += 1

    def note(self, window: DenseOutput, first: int, last: int, lengths: Array) -> None:
        """Enter some intervals of a window, or the first part of each."""
        chosen, place = slice(first, last), self.rows + np.arange(last - first)
        for subsystem in window.subsystems.active:
            ps = None if subsystem.ps is None else subsystem.ps[chosen]
            for part in subsystem.decomposition.parts:
                qs, gs = subsystem.qs[part.q, chosen].T, subsystem.gs[chosen, :, part.q]
                own = qs, gs, lengths, window.coefs[chosen], place, ps
                self._open.setdefault(id(part.work), (part, []))[1].append(own)
        self.rows += last - first

    def measured(self) -> tuple[Array, dict[int, float]]:
        """Works before the first entry and after each, shape (rows + 1, 3), and what the dashpots of laws
        have lost over all entries, by law.
        """
        new = np.zeros((self.rows + 1, 3))
        new[0] = self.works
        for row, work in self._known:
            new[row + 1] += work
        losses: dict[int, float] = {}
        for part, entries in self._open.values():
            *noted, ps = zip(*entries)
            qs, gs, lengths, coefs, place = (np.concatenate(x) for x in noted)
            forces = None if ps[0] is None else np.concatenate(ps)
            found = part.work.measures(qs.T, gs, lengths, coefs, self.constant[part.unknowns], forces)
            new[place + 1, 0] += found.input
            new[place + 1, 1] += found.damping
            for law, loss in found.laws:
                losses[law] = losses.get(law, 0.0) + float(loss.sum())
                new[place + 1, 2 if self.contact[law] else 1] += loss
        return np.cumsum(new, axis=0), losses

    def close(self, works: Array) -> None:
        """Begin anew after the last of the works that `measured` told."""
        self.put_in += float(np.abs(np.diff(works[:, 0])).sum())
        self.works, self.rows = works[-1], 0
        self._known.clear()
        self._open.clear()
