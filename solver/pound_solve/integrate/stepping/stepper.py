r"""Step-by-step integration with events located within the step: the common part of NEWMARK, HHT,
GENERALISED_ALPHA and CENTRAL.

It lays out the reduced system for the kernels (see `kernel`), runs them, and fetches their samples,
changes of branches and peaks.

Energies are integrated with velocities that are linear over a step.  The trapezoid rule of the method
itself would balance for any step, right or wrong.

References
----------
Newmark NM (1959), A method of computation for structural dynamics, J. Engng Mech. Div. ASCE 85(EM3): 67-94;
Chung J, Hulbert GM (1993), A time integration algorithm for structural dynamics with improved numerical
dissipation: the generalized-alpha method, J. Appl. Mech. 60(2): 371-375.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pound_deck.schema import Field, Kind
from pound_solve.check import Check, Subject, at_least, beyond, looked
from pound_solve.integrate.kernels.engine import KernelEngine
from pound_solve.integrate.kernels.present import KernelPresent
from pound_solve.integrate.kernels.state import LOST_FORCE, Goals, Scheme
from pound_solve.integrate.protocol import (
    Problem,
    Recorder,
    between_check,
    goals,
    refuse_rigid,
    rounding_check,
)
from pound_solve.integrate.release import release
from pound_solve.integrate.stepping import kernel
from pound_solve.integrate.stepping.factor import invalidate_factor
from pound_solve.integrate.tolerances import STEP_ROUNDING
from pound_solve.integrate.tracker import Peaks
from pound_solve.structure.elements.base import Role

COMMON = (
    Field("DT", Kind.REAL, "T", above=0, doc="longest time step"),
    Field(
        "EVENTS",
        Kind.WORD,
        default="LOCATED",
        words=("LOCATED", "STEPPED"),
        doc="cut the step where a law changes branch, or change branch at the end of the step",
    ),
)  #: fields of every implicit method

#: fewest steps in a period or a collision; the error of peaks is then a few per cent
STEPS_OF_PERIOD = 10
MOTION_ROUNDING = 1e-9  #: fraction of the energy below which a motion is rounding


def _resolved(about: str, count: float) -> Check:
    """Check a number of steps."""
    return at_least(Subject.STEPS, about, count, STEPS_OF_PERIOD, "by a shorter DT, or EXACT")


class Stepper(KernelEngine):
    """One run of a method; see the module docstring.

    Parameters
    ----------
    problem : Problem
    options : mapping
        DT, the longest step [T] (every interval between output times and record points is divided evenly),
        and EVENTS.
    scheme : Scheme
    name : str
        For the report.
    """

    def __init__(
        self, problem: Problem[Recorder], options: Mapping[str, Any], scheme: Scheme, name: str
    ) -> None:
        refuse_rigid(problem, name.partition(",")[0])
        located = scheme._replace(locate=options.get("EVENTS", "LOCATED") == "LOCATED")
        super().__init__(problem, located, options["DT"], name)

    def integrate(self) -> None:
        """Integrate in equal steps from one goal to the next."""
        turns = next((s for s in self.law_springs if s.role in (Role.FRICTION, Role.DAMPER)), None)
        if turns is not None and not self.scheme.locate:
            what = "friction" if turns.role is Role.FRICTION else f"the damper {turns.rule}"
            raise self.stop("A505", f"{what} (element {turns.element}) needs steps with EVENTS=LOCATED")
        self.begin(kernel.advance)
        ends, is_output = goals(self.system, self.times)
        lengths = np.diff(ends, prepend=float(self.times[0]))
        steps = np.maximum(1, np.ceil(lengths / self.dt * (1 - STEP_ROUNDING))).astype(np.int64)
        # twelve digits: steps of equal length share a factor, whatever the rounding of the times
        h = np.array([float(f"{x:.12e}") for x in lengths / steps])
        ex = self.system.excitation
        pieces = ex.pieces_after(ends - lengths)
        ahead = Goals(ends, is_output, pieces, np.ascontiguousarray(ex.coefs), ex.breaks)
        self.advance(kernel.advance, self.scheme, ahead, steps, h)

    def resume(self, why: int) -> None:
        """Move the massless joints that a lost force had held; stop for any other reason."""
        if why != LOST_FORCE:
            raise self.trouble(why)
        present = KernelPresent(self)
        release(present, int(self.sim.run.lost_force))
        present.hand_back()
        self.sim.run.lost_force = -1
        invalidate_factor(self.sim.run)

    def figures(self) -> dict[str, Any]:
        """Return the figures of the run for the report."""
        return {
            "method": self.name,
            "time step": f"{self.dt:.6g}",
            "steps": int(self.sim.run.steps),
            "events": int(self.sim.run.events),
        }

    def checks(self, peaks: Peaks) -> list[Check]:
        """Check whether the steps resolve the motion and the hardest collision of every contact.

        Newmark's energy balances in free vibration for any length of step, so the period is taken from the
        ratio of velocities to accelerations.
        """
        squared_velocity, squared_acceleration = self.motion_norms.tolist()
        energy = self.accumulator.initial + self.accumulator.works.gross_input
        moves = squared_velocity > MOTION_ROUNDING * energy
        checks = list[Check]()
        if moves and squared_acceleration > 0.0:
            count = 2.0 * np.pi * (squared_velocity / squared_acceleration) ** 0.5 / self.dt
            checks.append(_resolved("steps in a period of the motion, about", count))
        if softening := int(self.sim.run.softening):
            remedy = "a DT short enough to follow the softening, or EXACT"
            checks.append(
                beyond(Subject.STEPS, "steps too long for a softening branch", softening, 0, remedy)
            )
        checks += [between_check(peaks), *self._springs(peaks), *rounding_check(self.law_springs, peaks)]
        ended = [c for c in peaks.collisions if c.t_end > c.t_start]
        hardest = [
            max((c for c in ended if c.law == law), key=lambda c: c.peak) for law in {c.law for c in ended}
        ]
        if hardest:
            count = min(c.t_end - c.t_start for c in hardest) / self.dt
            checks.append(_resolved("steps in the hardest collision of a contact", count))
        return checks

    def _springs(self, peaks: Peaks) -> list[Check]:
        """Check whether the steps resolve the springs' forces."""
        tracker = self.tracker
        steepest = tracker.extremes.steepest[tracker.n_monitored + len(self.law_springs) :].tolist()
        rises = [
            max(abs(f.high), abs(f.low)) / (slope * self.dt)
            for s, f, slope in zip(self.law_springs, peaks.force, steepest)
            if not s.role.reports_damping and slope > 0.0
        ]
        about = "steps in which a spring's force rises to its largest"
        count = min(rises, default=np.inf)
        return looked([at_least(Subject.STEPS, about, count, 1.0, "by a shorter DT, or EXACT")])
