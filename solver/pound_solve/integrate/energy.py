"""The accumulator of energy: works and losses of a run, the same for every method, and the balance of
energies.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from pound_solve.integrate.protocol import LawValues, Start
from pound_solve.laws.automaton import LOSS_ROUNDING, K, State
from pound_solve.numerics.record import record
from pound_solve.numerics.types import Array
from pound_solve.structure.elements.base import Role
from pound_solve.structure.reduction import ReducedSystem

ENERGIES = ("input", "kinetic", "strain", "damping", "hysteretic", "contact")
#: places in the works of a sample: the input, and the losses in dashpots of the structure (with those of
#: springs and dampers) and of contacts
INPUT, DAMPING, CONTACT = range(3)
GROWTH = 10.0  #: kinetic energy over the total energy put in, above which the motion grows without bound


class Works(Protocol):
    r"""Works since the start [F L]: a numpy record, which kernels change in place."""

    input: float
    damping: float  #: lost in the dashpots of the structure, of springs and of dampers
    contact: float  #: lost in the dashpots of contacts
    gross_input: float  #: sum of all \|input\|


def runs_away(kinetic: float, initial: float, gross_input: float) -> bool:
    """Return whether the kinetic energy is far above the initial energy and the energy put in since."""
    return not kinetic <= GROWTH * (initial + gross_input) + 1e-300


class EnergyAccumulator:
    """Works of a run, and the losses in the dashpots of its laws.

    Parameters
    ----------
    system : ReducedSystem
    start : Start

    Attributes
    ----------
    works : Works
    initial : float
        Kinetic and recoverable energy at the start [F L].
    dashpot_losses : ndarray, shape (n_laws,)
    """

    def __init__(self, system: ReducedSystem, start: Start) -> None:
        self.works: Works = record(Works)
        self.works.input, self.works.damping, self.works.contact = start.works.tolist()
        self.initial = energy_at_start(system, start)
        self.dashpot_losses = np.zeros(len(system.structure.laws))

    def array(self) -> Array:
        """Input, loss in the structure's and in the contacts' dashpots so far, shape (3,) [F L]."""
        return np.array([self.works.input, self.works.damping, self.works.contact])

    def advance(self, works: Array) -> None:
        """Advance to later works, shape (n_times, 3); the first row equals the present ones."""
        self.works.gross_input += float(np.abs(np.diff(works[:, INPUT])).sum())
        self.works.input, self.works.damping, self.works.contact = works[-1].tolist()

    def runs_away(self, kinetic: float) -> bool:
        """Return whether the motion grows without bound."""
        return runs_away(kinetic, self.initial, self.works.gross_input)


def law_values(system: ReducedSystem, t: Array, u: Array, v: Array, states: Sequence[State]) -> LawValues:
    """Return forces and energies of all laws from their states, at times (n_times,) and motions
    (n, n_times) between two changes of branch; forces of dashpots are those of laws that are linear there.
    """
    laws = [s.law for s in system.structure.laws]
    if not laws:
        return LawValues(*np.zeros((4, 0, len(t))))
    d = system.law_rows @ u + system.law_inputs @ system.excitation.values(t).T
    rate = system.law_rows @ v + system.law_inputs @ system.excitation.values(t, 1).T
    # `Law.work` and `Law.dissipated` for all laws and times at once, because a sample is small
    k, c, f0 = np.array([x.rule.branch(x.p, s[0], s[3])[:3] for x, s in zip(laws, states)]).T[:, :, None]
    begin, before = np.array([s[1:3] for s in states]).T[:, :, None]
    still = k * d + f0
    done = before + (0.5 * k * (d + begin) + f0) * (d - begin)
    force = still + c * rate * np.array([[s.role.reports_damping] for s in system.structure.laws])
    for i, s in enumerate(system.structure.laws):
        if s.law.curved:
            deformations = d[i].tolist()
            still[i] = [s.law.force(states[i], x)[0] for x in deformations]
            done[i] = [s.law.work(states[i], x) for x in deformations]
            force[i] = [s.force(states[i], x, y) for x, y in zip(deformations, rate[i].tolist())]
    stored = np.array(
        [
            [x.rule.recoverable(x.p, s[0], s[3], y, f) for y, f in zip(*pair)]
            for x, s, *pair in zip(laws, states, d.tolist(), still.tolist())
        ]
    )
    size = np.array([[x.p[K]] for x in laws]) * np.maximum(np.abs(d), np.abs(begin)) ** 2
    lost = done - stored
    beside = [s.branch(x).damping - s.law.branch(x).damping for s, x in zip(system.structure.laws, states)]
    drag = np.array(beside)[:, None] * rate
    return LawValues(force, stored, np.where(np.abs(lost) > LOSS_ROUNDING * size, lost, 0.0), drag)


def energies(
    system: ReducedSystem, t: Array, u: Array, v: Array, stored: Array, lost: Array, works: Array
) -> Array:
    """Return all energies at the given times.

    Parameters
    ----------
    system : ReducedSystem
    t : ndarray, shape (n_times,)
    u, v : ndarray, shape (n_times, n)
    stored, lost : ndarray, shape (n_times, n_laws)
        Energies that the laws store and have lost.
    works : ndarray, shape (n_times, 3)

    Returns
    -------
    ndarray, shape (n_times, 6)
        In the order of `ENERGIES` [F L].
    """
    mass, stiffness, turning = system.mass, system.stiffness, np.zeros(len(t))
    if system.corotational:
        turning = system.corotational.actions(system.quantities(u, system.excitation.values(t)))[
            :, :, 0
        ].sum(axis=1)
    if system.total:  # moved supports have mass and stretch elements too
        mass, stiffness = system.structure.mass, system.structure.stiffness
        u = system.expanded(u.T, system.excitation.values(t).T).T
        v = system.expanded(v.T, system.excitation.values(t, 1).T, 1).T
    contact = np.array([s.role.collides for s in system.structure.laws], bool)
    damper = np.array([s.role is Role.DAMPER for s in system.structure.laws], bool)
    table = np.zeros((len(t), len(ENERGIES)))
    table[:, 0], table[:, 3], table[:, 5] = works.T
    table[:, 1] = 0.5 * (v * (v @ mass)).sum(axis=1)
    table[:, 2] = 0.5 * (u * (u @ stiffness)).sum(axis=1) + stored.sum(axis=1) + turning
    table[:, 3] += lost[:, damper].sum(axis=1)
    table[:, 4] = lost[:, ~(contact | damper)].sum(axis=1)
    table[:, 5] += lost[:, contact].sum(axis=1)
    return table


def energy_at_start(system: ReducedSystem, start: Start) -> float:
    """Return the kinetic and recoverable energy [F L]; plus the work put in since, it bounds the motion."""
    t, u, v = start.times[:1], start.u, start.v
    laws = law_values(system, t, u[:, None], v[:, None], start.states)
    whole = energies(system, t, u[None], v[None], laws.stored.T, laws.lost.T, np.zeros((1, 3)))
    return float(whole[0, 1] + whole[0, 2])
