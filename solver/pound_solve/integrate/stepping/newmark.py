"""NEWMARK: average acceleration by default (beta 1/4, gamma 1/2), events located within the step."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.integrate.kernels.state import Scheme
from pound_solve.integrate.protocol import Outcome, Problem, Recorder, Stop
from pound_solve.integrate.stepping.stepper import COMMON, Stepper


def integrate(problem: Problem[Recorder], options: Mapping[str, Any]) -> Outcome:
    """Integrate a reduced system step by step.

    Raises
    ------
    Stop
        The parameters are not stable, a step has too many changes, or numbers overflow.
    """
    beta, gamma = options.get("BETA", 0.25), options.get("GAMMA", 0.5)
    if not 2 * beta >= gamma >= 0.5:
        raise Stop(
            "A505",
            0.0,
            f"NEWMARK is stable for any step only with 2 BETA >= GAMMA >= 0.5, "
            f"not {beta:g} and {gamma:g}; CENTRAL is the explicit method",
        )
    name = (
        "NEWMARK, average acceleration"
        if (beta, gamma) == (0.25, 0.5)
        else f"NEWMARK, beta {beta:g}, gamma {gamma:g}"
    )
    return Stepper(problem, options, Scheme(beta, gamma), name).run()


SPEC = Spec(
    "method",
    "NEWMARK",
    "implicit steps, average acceleration",
    (
        *COMMON,
        Field("BETA", Kind.REAL, "-", default=0.25, above=0, doc="Newmark's beta"),
        Field("GAMMA", Kind.REAL, "-", default=0.5, lo=0, doc="Newmark's gamma"),
    ),
    reference="Newmark 1959",
    impl=integrate,
)
