"""The present of a run of kernels, as its rigid contacts see and change it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pound_solve.integrate.kernels import laws as law_kernels
from pound_solve.integrate.kernels.engine import KernelEngine
from pound_solve.integrate.kernels.recording import log_transition
from pound_solve.integrate.protocol import STILL, Stop, light
from pound_solve.laws.automaton import Branch
from pound_solve.numerics.types import Array


class Present:
    """One instant of a run, see `rigid.instants.RigidRun`.

    Parameters
    ----------
    engine : KernelEngine
        Its kernel has returned, and its transitions are taken in.
    """

    def __init__(self, engine: KernelEngine) -> None:
        self.engine, self.system, self.tracker = engine, engine.system, engine.tracker
        now, laws, back = engine.step.now, engine.laws, np.argsort(engine.order)
        self.t = float(engine.state.time)
        self.u, self.v = now.displacement[back], now.velocity[back]
        self.largest = np.array([laws.largest_deformation, laws.largest_rate])
        self._branches = [s.branch(engine.law_state(i)) for i, s in enumerate(engine.springs)]

    @property
    def branches(self) -> Sequence[Branch]:
        """Present branches of all laws."""
        return self._branches

    def transition(self, law: int, event_index: int, d: float, v: float) -> None:
        """Let a law leave its branch at deformation `d` and rate `v`."""
        own, laws = self.engine, self.engine.laws
        before = int(laws.branch[law])
        laws.now.deformation[law], laws.now.rate[law] = d, v
        law_kernels.transition(laws, own.rules, law, event_index, d, v)
        log_transition(laws, own.buffers, own.state, law, before, self.t, 0.0)
        own.fetch_transitions()
        self._branches[law] = own.springs[law].branch(own.law_state(law))

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

    def turn_back(self) -> None:
        """Let laws leave their branches whose rates an impact has turned, those apart that hold unknowns
        without mass: their rates are not known yet (see `march.settle`).
        """
        laws, held = self.engine.laws, light(self.system)
        for _ in range(2 * len(laws.rule)):
            on_d, on_v, constant = laws.events.transpose(2, 0, 1)
            d, v = laws.now.deformation[:, None], laws.now.rate[:, None]
            size = np.abs(on_d) * self.largest[0][:, None] + np.abs(on_v) * self.largest[1][:, None]
            value = on_d * d + on_v * v + constant
            overdue = (on_v != 0.0) & ~held[:, None] & (value > STILL * (size + np.abs(constant)))
            if not overdue.any():
                return
            law, event = (int(x[0]) for x in np.nonzero(overdue))
            self.transition(law, event, float(d[law, 0]), float(v[law, 0]))

    def hand_back(self) -> None:
        """Let the run go on from here."""
        laws, now, order = self.engine.laws, self.engine.step.now, self.engine.order
        now.displacement[:], now.velocity[:] = self.u[order], self.v[order]
        laws.largest_deformation[:], laws.largest_rate[:] = self.largest
        inputs = self.system.excitation.value(self.t, 1)
        laws.now.rate[:] = self.system.law_rows @ self.v + self.system.law_inputs @ inputs
        self.turn_back()
        self.engine.state.stale = 1
