r"""CENTRAL: explicit central differences, events located within the step.

Newmark's method with :math:`\beta = 0`, :math:`\gamma = \tfrac12` is the central difference method
with a different start.  It is stable for :math:`h < 2/\omega_{max}`.  The limit is computed
with every contact pressed and every other law on its steepest branch; a longer step is refused.

References
----------
Chopra AK (2012), Dynamics of Structures, 4th edn, section 5.3; Hughes TJR (1987),
The Finite Element Method, section 9.1 (the equivalence).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.check import Subject, at_most
from pound_solve.integrate.kernels.state import Scheme
from pound_solve.integrate.protocol import Outcome, Problem, Recorder, Stop, refuse_rigid
from pound_solve.integrate.stepping.stepper import Stepper
from pound_solve.numerics import modes
from pound_solve.numerics.matrices import weighted
from pound_solve.numerics.types import Array
from pound_solve.structure.reduction import ReducedSystem


def limit(system: ReducedSystem, u: Array) -> float:
    """Return the largest stable step [T]: 2 over the highest frequency with all contacts pressed, all other
    laws on their steepest branches, and the members' tangents at displacements `u`.  Curved contacts are
    left out, because their stiffness is not known before they are pressed.
    """
    laws = system.structure.laws
    stiffest = [0.0 if s.role.collides and s.law.curved else s.steepest for s in laws]
    k = system.stiffness + system.corotational.stiffness(u) + weighted(system.law_rows, stiffest)
    omega = modes.fastest(k, system.mass)
    return 2.0 / omega if omega > 0.0 else float("inf")


def integrate(problem: Problem[Recorder], options: Mapping[str, Any]) -> Outcome:
    """Integrate a reduced system step by step, explicitly.

    Raises
    ------
    Stop
        Step above the stability limit, massless DOFs that cannot be condensed,
        or an overflow of numbers.
    """
    system = problem.system
    refuse_rigid(problem, "CENTRAL")
    is_massless = modes.massless(system.mass)
    if is_massless.any():
        raise Stop(
            "A505",
            0.0,
            f"CENTRAL needs mass at {system.name(int(np.argmax(is_massless)))}: "
            "give it weight, or use NEWMARK",
        )
    longest = limit(system, problem.start.u)
    if options["DT"] > longest:
        raise Stop(
            "A502",
            0.0,
            f"the step {options['DT']:g} is above the stability limit {longest:.4g}; "
            "NEWMARK has no such limit",
        )
    stepper = Stepper(problem, options, Scheme(0.0, 0.5), "CENTRAL, central differences")
    outcome = stepper.run()
    about, unit = "time step, stable with contacts pressed", system.structure.model.units.time
    outcome.checks.append(at_most(Subject.STEPS, about, options["DT"], longest, "not stable", unit))
    return outcome


SPEC = Spec(
    "method",
    "CENTRAL",
    "explicit central differences",
    (Field("DT", Kind.REAL, "T", above=0, doc="time step, below the stability limit"),),
    reference="Chopra 2012, section 5.3",
    impl=integrate,
)
