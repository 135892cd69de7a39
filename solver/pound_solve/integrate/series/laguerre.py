"""LAGUERRE: event-driven integration by implicit series, for modes far faster than the motion.

Axial stiffness, small masses at joints and stiffness-proportional damping produce modes that do not show in
the motion but that the steps of TAYLOR must resolve.  A step of LAGUERRE instead solves a few times with
one matrix (see `single_pole`).  It is as long as the motion allows, and TOL bounds its error.  Within a
step the motion is a polynomial; events, peaks and works are found as in TAYLOR.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.integrate.protocol import Outcome, Problem, Recorder, Stop, reason_not_linear, refuse_rigid
from pound_solve.integrate.rigid.contacts import RigidContacts
from pound_solve.integrate.series.single_pole import LAST_TERM
from pound_solve.integrate.series.taylor import MAX_STEPS, Taylor


class Laguerre(Taylor):
    """One run; see the module docstring."""

    exact = False
    description = f"LAGUERRE, implicit series of {LAST_TERM} terms"
    limited_by = "TOL"

    def remedy(self) -> str:
        """Return advice on what requires fewer steps."""
        return ", a larger one for fewer"

    def figures(self) -> dict[str, Any]:
        """Return the figures of the run for the report."""
        control, shortest = self.control, float(self.control.shortest_length)
        return {
            "method": self.name,
            "steps": int(self.sim.run.steps - control.n_modal_intervals),
            **({"intervals in modes": in_modes} if (in_modes := int(control.n_modal_intervals)) else {}),
            **({"shortest step": f"{shortest:.4g}"} if np.isfinite(shortest) else {}),
            "steps taken again": int(control.n_rejected),
            "factorisations": int(control.n_factorisations),
            "events": int(self.sim.run.events),
        }


def integrate(problem: Problem[Recorder], options: Mapping[str, Any]) -> Outcome:
    """Integrate a reduced system by implicit series; see the module docstring.  `options` may hold STEPS,
    the largest number of steps.

    Raises
    ------
    Stop
        A reduced system that is not piecewise linear or has rigid contacts, massless DOFs that nothing
        holds, too many changes at one instant, too many steps, an overflow of numbers, or an interrupt.
    """
    refuse_rigid(problem, "LAGUERRE")
    if why := reason_not_linear(problem.system):
        why_not = f"LAGUERRE needs linear pieces, and {why}: AUTO takes another method"
        raise Stop("A505", problem.begin, why_not)
    contacts, most = RigidContacts(problem.system), min(options.get("STEPS", MAX_STEPS), MAX_STEPS)
    return Laguerre(problem, contacts, most, options["TOL"]).run()


SPEC = Spec(
    "method",
    "LAGUERRE",
    "event-driven, implicit series between events",
    (
        Field(
            "TOL",
            Kind.REAL,
            "-",
            default=1e-8,
            lo=1e-12,
            hi=0.1,
            doc="largest ratio of a step's last term to the motion, by energy",
        ),
    ),
    reference="Nørsett 1974; Hairer & Wanner 1996, IV.6",
    impl=integrate,
)
