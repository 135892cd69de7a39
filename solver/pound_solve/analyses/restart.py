"""Save and resume a history, and join its parts.

A history with a SAVE time is integrated in two parts; the second depends only on the state at the end of
the first.  A resumed run therefore reproduces the whole run bit for bit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pound_solve.check import worst
from pound_solve.integrate.protocol import Outcome, Start
from pound_solve.integrate.tracker import Extreme, Peaks
from pound_solve.laws.automaton import State
from pound_solve.numerics.types import Array
from pound_solve.structure.reduction import ReducedSystem
from pound_solve.structure.structure import Structure


class RestartError(Exception):
    """The history ends before the saved state begins."""


@dataclass(frozen=True)
class Saved:
    """The state of a history at a time.

    Attributes
    ----------
    t : float
        [T]
    u, v : ndarray, shape (n_free,)
        Displacements and velocities of the structure's unknowns.
    states : tuple of State
    works : ndarray, shape (3,)
        See `analyses.recorder.HistoryRecorder`.
    first : ndarray, shape (6,)
        Energies at the start of the whole history.
    """

    t: float
    u: Array
    v: Array
    states: tuple[State, ...]
    works: Array
    first: Array

    def arrays(self) -> dict[str, Array]:
        """Return the state as arrays for a file."""
        longest = max((len(s[3]) for s in self.states), default=0)
        return {
            "time": np.array([self.t]),
            "u": self.u,
            "v": self.v,
            "works": self.works,
            "first": self.first,
            "branch": np.array([s[0] for s in self.states], float),
            "entry": np.array([s[1:3] for s in self.states], float).reshape(-1, 2),
            "memory": np.array(
                [(*s[3], *[0.0] * (longest - len(s[3]))) for s in self.states], float
            ).reshape(len(self.states), longest),
        }


def load(arrays: Mapping[str, Array], structure: Structure) -> Saved:
    """Restore the state written by `Saved.arrays` for the same structure."""
    states = tuple(
        (int(at), entry[0], entry[1], tuple(memory[: len(s.law.start()[3])]))
        for s, at, entry, memory in zip(
            structure.laws, arrays["branch"].tolist(), arrays["entry"].tolist(), arrays["memory"].tolist()
        )
    )
    return Saved(
        float(arrays["time"][0]), arrays["u"], arrays["v"], states, arrays["works"], arrays["first"]
    )


def resume(saved: Saved, system: ReducedSystem, times: Array) -> Start:
    """Return the start of a part: the saved state over the unknowns of the reduced system."""
    keep = system.columns
    return Start(saved.u[keep], saved.v[keep], saved.states, times, saved.works)


def join(parts: Sequence[Outcome]) -> Outcome:
    """Join the outcomes of consecutive parts."""
    whole = parts[-1]
    for before in reversed(parts[:-1]):
        figures = {
            key: value + before.figures.get(key, 0) if isinstance(value, int) else value
            for key, value in whole.figures.items()
        }
        checks = worst([*before.checks, *whole.checks])
        whole = replace(whole, peaks=_both(before.peaks, whole.peaks), figures=figures, checks=checks)
    return whole


def _both(a: Peaks, b: Peaks) -> Peaks:
    """Return the peaks of two consecutive parts; a collision that spans both counts as one."""
    running = {c.law: c for c in a.collisions if not np.isfinite(c.t_end)}
    later = []
    for c in b.collisions:
        first = running.pop(c.law, None)
        if first is None:
            later.append(c)
            continue
        first.t_end, first.separation = c.t_end, c.separation
        first.impulse += c.impulse
        if c.peak > first.peak:
            first.peak, first.t_peak = c.peak, c.t_peak
    return Peaks(
        [_wider(x, y) for x, y in zip(a.monitored, b.monitored)],
        [_wider(x, y) for x, y in zip(a.deformation, b.deformation)],
        [_wider(x, y) for x, y in zip(a.force, b.force)],
        [x + y for x, y in zip(a.yields, b.yields)],
        [x + y for x, y in zip(a.dashpot_losses, b.dashpot_losses)],
        [*a.collisions, *later],
        max(a.between, b.between),
    )


def _wider(a: Extreme, b: Extreme) -> Extreme:
    wider = Extreme(a.high, a.t_high, a.low, a.t_low)
    wider.take(b.high, b.t_high)
    wider.take(b.low, b.t_low)
    return wider
