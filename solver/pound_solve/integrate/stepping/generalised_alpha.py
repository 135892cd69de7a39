r"""GENERALISED_ALPHA: damps the high frequencies as requested and the low ones as little as possible.

With the spectral radius :math:`\rho` at infinite frequency, 0 to 1:
:math:`\alpha_m = \frac{2\rho-1}{\rho+1}`, :math:`\alpha_f = \frac{\rho}{\rho+1}`,
:math:`\gamma = \tfrac12 - \alpha_m + \alpha_f`, :math:`\beta = \tfrac14 (1 - \alpha_m + \alpha_f)^2`.

References
----------
Chung J, Hulbert GM (1993), A time integration algorithm for structural dynamics with improved numerical
dissipation: the generalized-alpha method, J. Appl. Mech. 60(2): 371-375.
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
    rho = options["RHO"]
    am, af = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
    scheme = Scheme(0.25 * (1.0 - am + af) ** 2, 0.5 - am + af, am, af)
    return Stepper(problem, options, scheme, f"GENERALISED_ALPHA, rho {rho:g}").run()


SPEC = Spec(
    "method",
    "GENERALISED_ALPHA",
    "implicit steps, tunable high-frequency damping",
    (
        *COMMON,
        Field(
            "RHO", Kind.REAL, "-", default=0.9, lo=0.0, hi=1.0, doc="spectral radius at infinite frequency"
        ),
    ),
    reference="Chung & Hulbert 1993",
    impl=integrate,
)
