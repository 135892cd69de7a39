"""The present of a run of kernels, as its rigid contacts see and change it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pound_solve.integrate.kernels import laws as law_kernels
from pound_solve.integrate.kernels.engine import KernelEngine
from pound_solve.integrate.kernels.recording import log_transition
from pound_solve.integrate.protocol import CHANGES, CHANGES_PER_LAW, Stop
from pound_solve.integrate.series.forces import take_over
from pound_solve.integrate.series.massless import violated
from pound_solve.integrate.series.state import Series
from pound_solve.laws.automaton import PUSH, Branch
from pound_solve.numerics.types import Array, Index


class Present:
    """One instant of a run, see `rigid.instants.RigidRun`.

    Parameters
    ----------
    engine : KernelEngine
        Its kernel has returned, and its transitions are taken in.
    series : Series
    """

    def __init__(self, engine: KernelEngine, series: Series) -> None:
        self.engine, self.series = engine, series
        self.system, self.tracker = engine.system, engine.tracker
        now, laws, back = engine.step.now, engine.laws, np.argsort(engine.order)
        self.t = float(engine.state.time)
        self.u, self.v = now.displacement[back], now.velocity[back]
        self.largest = np.array([laws.largest_deformation, laws.largest_rate])
        self._branches = [s.branch(engine.law_state(i)) for i, s in enumerate(engine.springs)]

    @property
    def branches(self) -> Sequence[Branch]:
        """Present branches of all laws."""
        return self._branches

    def law_forces(self, d: Array, v: Array) -> Array:
        """Forces of all laws at deformations and rates (see `RigidRun`)."""
        laws, rules, out = self.engine.laws, self.engine.rules, np.zeros(len(d))
        coupled = self.series.friction.laws.tolist()
        for i in [i for i in range(len(d)) if i not in coupled] + coupled:  # the forces that press first
            if i in coupled:
                laws.internal[i, PUSH] = max(out[laws.normal[i]], 0.0)
            if self.series.rigid.number[i] < 0:
                out[i] = law_kernels.law_force(laws, rules, i, d[i], v[i])
        return out

    def transition(self, law: int, event_index: int, d: float, v: float) -> None:
        """Let a law leave its branch at deformation `d` and rate `v`."""
        own, laws = self.engine, self.engine.laws
        before = int(laws.branch[law])
        laws.now.deformation[law], laws.now.rate[law] = d, v
        law_kernels.transition(laws, own.rules, law, event_index, d, v)
        take_over(laws, own.rules, self.series, law)
        log_transition(laws, own.buffers, own.state, law, before, self.t, 0.0)
        own.fetch_transitions()
        self._branches[law] = own.springs[law].branch(own.law_state(law))

    def force(self, law: int, d: float) -> tuple[float, float]:
        """Force of a law at rest at deformation `d`, and its tangent."""
        return self.engine.springs[law].law.force(self.engine.law_state(law), d)[:2]

    def take_release(self, law: int, lost: float) -> None:
        """Count the work that a falling force has done into that on its law."""
        self.engine.laws.entry_work[law] += lost

    def take_impact(self, put_in: float, lost: Array) -> None:
        """Count the work that moving supports put in at an impact, and what each law lost, (n_laws,)."""
        works = self.engine.accumulator.works
        works.input += put_in
        works.gross_input += abs(put_in)
        works.contact += float(lost.sum())
        self.engine.laws.dashpot_loss[:] += lost

    def stop(self, code: str, why: str) -> Stop:
        """Return the exception that ends the run here."""
        return self.engine.stop(code, why)

    def turn_back(self, which: Index) -> None:
        """Let those of some laws leave their branches whose rates an impact has turned."""
        now, laws = self.engine.laws.now, self.engine.laws
        for _ in range(CHANGES + CHANGES_PER_LAW * len(laws.rule)):
            law, event = violated(laws, which)
            if law < 0:
                return
            self.transition(law, event, float(now.deformation[law]), float(now.rate[law]))

    def hand_back(self, known: Index) -> None:
        """Let the run go on from here; the rates of the laws `known` do not depend on unknowns without
        mass, which `march.settle` looks after.
        """
        laws, now, order = self.engine.laws, self.engine.step.now, self.engine.order
        now.displacement[:], now.velocity[:] = self.u[order], self.v[order]
        laws.largest_deformation[:], laws.largest_rate[:] = self.largest
        inputs = [self.system.excitation.value(self.t, derivative) for derivative in (0, 1)]
        laws.now.deformation[:] = self.system.law_rows @ self.u + self.system.law_inputs @ inputs[0]
        laws.now.rate[:] = self.system.law_rows @ self.v + self.system.law_inputs @ inputs[1]
        self.turn_back(known)
        self.engine.state.stale = 1
