r"""One step of the generalised-alpha family (Chung & Hulbert 1993): factorise A (`factor`), predict
(`prediction`), solve for the acceleration (`newton`), correct (here), accept (`acceptance`).

For a step of length h,

.. math::
    u_1 = \tilde u + \beta h^2 a_1, \qquad \tilde u = u_0 + h v_0 + h^2(\tfrac12-\beta) a_0 \\
    v_1 = \tilde v + \gamma h a_1, \qquad \tilde v = v_0 + (1-\gamma) h a_0 \\
    \Bigl[\tfrac{1-\alpha_m}{1-\alpha_f} M + \gamma h C + \beta h^2 K\Bigr] a_1
      = p_1 - C\tilde v - K\tilde u - f(\tilde u, \tilde v)
      + \frac{\alpha_f r_0 - \alpha_m M a_0}{1-\alpha_f}

with the residual :math:`r = p - C v - K u - f` at the start of the step.  Between events the laws are
linear, so a step needs one solution.  Curved laws need Newton iterations with rank-one updates of the
factor.
"""

from __future__ import annotations

from pound_solve.integrate.kernels.consistency import correct_massless_rates
from pound_solve.integrate.kernels.corotational import compute_tangents
from pound_solve.integrate.kernels.laws import linearise_laws, update_friction_limits
from pound_solve.integrate.kernels.products import row_magnitude, row_product
from pound_solve.integrate.kernels.state import Scheme, Simulation
from pound_solve.integrate.stepping.newton import iterate_newton
from pound_solve.integrate.stepping.prediction import predict_step
from pound_solve.laws.functions import RuleFunctions
from pound_solve.numerics.types import Array


def try_step(
    sim: Simulation, rules: RuleFunctions, scheme: Scheme, coefs: Array, end: float, h: float, factor: int
) -> bool:
    """Try a step of length `h` that ends at the local time `end`, with a `factor`; return False if Newton's
    method does not converge (see `iterate_newton`).
    """
    linear, laws = sim.linear, sim.laws
    definition, rows = laws.definition, laws.definition.rows
    predict_step(sim, scheme, coefs, end, h)
    if not iterate_newton(sim, rules, scheme, h, factor):
        return False
    trial, beta_h2, gamma_h = sim.step.trial, scheme.beta * h * h, scheme.gamma * h
    for i in range(len(trial.acceleration)):
        trial.displacement[i] += beta_h2 * trial.acceleration[i]
    for i in range(len(trial.acceleration)):
        trial.velocity[i] += gamma_h * trial.acceleration[i]
    for i in range(len(definition.rule)):
        a = row_product(rows, i, trial.acceleration)
        laws.trial.deformation[i] += beta_h2 * a
        laws.trial.rate[i] += gamma_h * a
        if definition.contact[i]:  # the deformation between bodies that move alike is rounding
            far = row_magnitude(rows, i, trial.displacement)
            laws.largest.deformation[i] = max(laws.largest.deformation[i], far)
    if len(laws.friction.coupled) > 0:
        update_friction_limits(laws, rules, trial.acceleration)
    if linear.has_stiffness and not linear.all_mass:
        correct_massless_rates(sim, linear.massless_vary or sim.run.massless_factor_stale != 0, h)
        sim.run.massless_factor_stale = 0
    return True


def restore_start_tangents(sim: Simulation, rules: RuleFunctions) -> None:
    """Linearise the curved laws and the members at the start of the step."""
    linearise_laws(sim.laws, rules)
    compute_tangents(sim.members, sim.members.now.quantities)
