"""The present state of a kernel run, as impacts and releases (which take no time) see and change it."""

from __future__ import annotations

from collections.abc import Sequence

from pound_solve.integrate.kernels import laws as law_kernels
from pound_solve.integrate.kernels.engine import KernelEngine
from pound_solve.integrate.kernels.recording import log_transition
from pound_solve.integrate.protocol import Stop
from pound_solve.laws.automaton import Branch


class KernelPresent:
    """State of a kernel run at one instant, for the release of joints (see `release.JumpingRun`).

    Parameters
    ----------
    engine : KernelEngine
        Its kernel has returned, and its transitions have been fetched.
    """

    def __init__(self, engine: KernelEngine) -> None:
        self.engine, self.system, self.tracker = engine, engine.system, engine.tracker
        self.t = float(engine.sim.run.time)
        back, now = engine.inverse_order, engine.step.now
        self.u, self.v = now.displacement[back], now.velocity[back]
        self._branches = [s.branch(engine.law_state(i)) for i, s in enumerate(engine.law_springs)]

    @property
    def branches(self) -> Sequence[Branch]:
        """Present branches of all laws."""
        return self._branches

    def transition(self, law: int, event_index: int, d: float, v: float) -> None:
        """Let a law leave its branch at deformation `d` and rate `v`."""
        engine, laws = self.engine, self.engine.laws
        before = int(laws.state.branch[law])
        laws.now.deformation[law], laws.now.rate[law] = d, v
        law_kernels.leave_branch(laws, engine.rules, law, event_index, d, v)
        self.enter(law)
        log_transition(engine.sim, law, before, self.t, 0.0)
        engine.fetch_transitions()
        self._branches[law] = engine.law_springs[law].branch(engine.law_state(law))

    def enter(self, law: int) -> None:
        """Linearise the branch that a law has changed to, if the law is curved."""
        laws = self.engine.laws
        if laws.definition.curved[law]:
            d, v = float(laws.now.deformation[law]), float(laws.now.rate[law])
            law_kernels.linearise_law(laws, self.engine.rules, law, d, v)

    def force(self, law: int, d: float) -> tuple[float, float]:
        """Return the force of a law at rest at deformation `d`, and its tangent."""
        return self.engine.law_springs[law].law.force(self.engine.law_state(law), d)[:2]

    def add_release_work(self, law: int, lost: float, put_in: float) -> None:
        """Add the work `lost` by a dropping force to the work done on its law, and `put_in` by the loads to
        the input.
        """
        self.engine.laws.state.entry_work[law] += lost
        self.add_input_work(put_in)

    def add_input_work(self, put_in: float) -> None:
        """Add work that is put in at one instant."""
        works = self.engine.accumulator.works
        works.input += put_in
        works.gross_input += abs(put_in)

    def stop(self, code: str, why: str) -> Stop:
        """Return the exception that ends the run here."""
        return self.engine.stop(code, why)

    def hand_back(self) -> None:
        """Let the run continue from the displacements and velocities that were reached."""
        laws, now, order = self.engine.laws, self.engine.step.now, self.engine.order
        now.displacement[:], now.velocity[:] = self.u[order], self.v[order]
        inputs = [self.system.excitation.value(self.t, derivative) for derivative in (0, 1)]
        laws.now.deformation[:] = self.system.law_rows @ self.u + self.system.law_inputs @ inputs[0]
        laws.now.rate[:] = self.system.law_rows @ self.v + self.system.law_inputs @ inputs[1]
        self.engine.sim.run.branches_changed = self.engine.sim.run.massless_factor_stale = 1
