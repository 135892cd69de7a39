"""The present of a run by series, as its rigid contacts see and change it."""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.kernels import laws as law_kernels
from pound_solve.integrate.kernels.engine import KernelEngine
from pound_solve.integrate.kernels.present import KernelPresent
from pound_solve.integrate.protocol import MAX_CHANGES, MAX_CHANGES_PER_LAW
from pound_solve.integrate.series.forces import refresh_branch_series
from pound_solve.integrate.series.massless import first_violated
from pound_solve.integrate.series.state import Series
from pound_solve.laws.automaton import NORMAL_FORCE
from pound_solve.numerics.types import Array, Index


class Present(KernelPresent):
    """State of a run by series at one instant, for its rigid contacts (see `rigid.instants.RigidRun`).

    Parameters
    ----------
    engine : KernelEngine
        Its kernel has returned, and its transitions have been fetched.
    series : Series
    """

    def __init__(self, engine: KernelEngine, series: Series) -> None:
        super().__init__(engine)
        self.series = series
        self.largest = np.array([engine.laws.largest.deformation, engine.laws.largest.rate])

    def law_forces(self, d: Array, v: Array) -> Array:
        """Forces of all laws at deformations and rates (see `RigidRun`)."""
        laws, rules, forces = self.engine.laws, self.engine.rules, np.zeros(len(d))
        coupled = self.series.friction.laws.tolist()
        for i in [i for i in range(len(d)) if i not in coupled] + coupled:  # the forces that press first
            if i in coupled:
                laws.state.internal[i, NORMAL_FORCE] = max(forces[laws.friction.normal_law[i]], 0.0)
            if self.series.rigid.index_of[i] < 0:
                forces[i] = law_kernels.law_force(laws, rules, i, d[i], v[i])
        return forces

    def enter(self, law: int) -> None:
        """Copy the branch that a law has changed to into the arrays of power contacts and of friction."""
        refresh_branch_series(self.engine.laws, self.engine.rules, self.series, law)

    def add_impact_work(self, put_in: float, lost: Array) -> None:
        """Add the work that moving supports put in at an impact, and the loss of each law, (n_laws,)."""
        self.add_input_work(put_in)
        self.engine.accumulator.works.contact += float(lost.sum())
        self.engine.laws.state.dashpot_loss[:] += lost

    def turn_back(self, which: Index) -> None:
        """Change the branches of the given laws whose rates an impact has reversed."""
        now, laws = self.engine.laws.now, self.engine.laws
        for _ in range(MAX_CHANGES + MAX_CHANGES_PER_LAW * len(laws.definition.rule)):
            law, event = first_violated(laws, which)
            if law < 0:
                return
            self.transition(law, event, float(now.deformation[law]), float(now.rate[law]))

    def hand_back_impact(self, known: Index) -> None:
        """Let the run continue after an impact.  The rates of the laws `known` do not depend on unknowns
        without mass, which `branches.settle_state` treats.
        """
        laws = self.engine.laws
        self.hand_back()
        laws.largest.deformation[:], laws.largest.rate[:] = self.largest
        self.turn_back(known)
