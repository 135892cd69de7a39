r"""HHT: a method of Newmark's family that damps high frequencies and keeps second-order accuracy.

With :math:`-\tfrac13 \le \alpha \le 0`: :math:`\beta = (1-\alpha)^2/4`, :math:`\gamma = \tfrac12 - \alpha`,
and all forces but inertia taken at :math:`(1+\alpha)` of the step.

References
----------
Hilber HM, Hughes TJR, Taylor RL (1977), Improved numerical dissipation for time integration algorithms in
structural dynamics, Earthquake Engng Struct. Dyn. 5: 283-292.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.integrate.kernels.state import Scheme
from pound_solve.integrate.protocol import Outcome, Problem, Recorder
from pound_solve.integrate.stepping.stepper import COMMON, Stepper


def integrate(problem: Problem[Recorder], options: Mapping[str, Any]) -> Outcome:
    """Integrate a reduced system step by step.

    Raises
    ------
    Stop
        See `stepping.Stepper.run`.
    """
    alpha = options["ALPHA"]
    scheme = Scheme(0.25 * (1.0 - alpha) ** 2, 0.5 - alpha, 0.0, -alpha)
    return Stepper(problem, options, scheme, f"HHT, alpha {alpha:g}").run()


SPEC = Spec(
    "method",
    "HHT",
    "implicit steps with damped high frequencies",
    (
        *COMMON,
        Field("ALPHA", Kind.REAL, "-", default=-0.1, lo=-1 / 3, hi=0.0, doc="a lower value damps more"),
    ),
    reference="Hilber, Hughes & Taylor 1977",
    impl=integrate,
)
