r"""Coulomb friction across a contact: stick on a tangential spring, slip at a fraction of the normal force.

.. math:: f = k_t (x - x_s) \ \text{while}\ |f| \le \mu_s N, \qquad f = \pm\mu_d N \ \text{while it slips}

:math:`x` is the tangential displacement of I relative to J, and :math:`N` is the present contact force.
The spring represents the material between the nodes and the surface, so the slider itself moves at the rate
:math:`\dot x - \dot f / k_t`.  When this rate reverses, the slider sticks again:

.. math:: \pm\dot x < \mu_d \dot N / k_t

At touch the spring starts without force.  Bodies that slide faster than the limit grows,
:math:`k_t |\dot x| > \mu_s \dot N`, slip at once.  At release the internal variables are reset.

The law has normal-force coupling: before each evaluation, the internal variables `NORMAL_FORCE` and
`NORMAL_FORCE_RATE` are set to :math:`N` and :math:`\dot N`.  While the law slips, its work is not a
function of x alone; the integrator accumulates it.

References
----------
Coulomb's law with a tangential spring as a regularisation: Cundall PA, Strack ODL (1979), A discrete
numerical model for granular assemblies, Geotechnique 29(1): 47-65; two coefficients as in any text on
dry friction.
"""

from __future__ import annotations

from pound_solve.laws.automaton import (
    CONTACT_OPENS,
    NORMAL_FORCE,
    NORMAL_FORCE_RATE,
    UNCOUPLED,
    BranchKind,
    Law,
    Numbers,
    Rule,
    linear,
    rate_independent,
)
from pound_solve.laws.mirror import side
from pound_solve.laws.refusal import ItemError

OPEN, PLUS, MINUS, STICKING = UNCOUPLED, 1, 2, 3
ANCHOR = 2  #: internal variable: displacement at which the spring has no force


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the open state; the integrator changes it to closed when the contact closes."""
    return OPEN, (0.0, 0.0, 0.0)


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch.  The internal variables are the normal force, its rate, and the displacement at
    which the spring has no force.
    """
    kt, mu, mud = p[:3]
    if at == OPEN:
        return linear(0.0, 0.0)
    if at == STICKING:
        pull, stick_limit = kt * m[ANCHOR], mu * m[NORMAL_FORCE]
        return linear(kt, -pull, (kt, 0.0, -pull - stick_limit), (-kt, 0.0, pull - stick_limit))
    return linear(0.0, side(at) * mud * m[NORMAL_FORCE], (0.0, -side(at), mud * m[NORMAL_FORCE_RATE] / kt))


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a touch, the onset of slip or stick, or a release."""
    kt, mu, mud = p[:3]
    if at != OPEN and event == CONTACT_OPENS:
        return OPEN, (0.0, 0.0, 0.0)
    if at == STICKING:
        return (PLUS if event == 0 else MINUS), m
    after, anchor = STICKING, d
    if at != OPEN:
        anchor = d - side(at) * mud * m[NORMAL_FORCE] / kt
    elif m[NORMAL_FORCE] == 0.0 and kt * abs(v) > mu * m[NORMAL_FORCE_RATE]:
        after = PLUS if v > 0.0 else MINUS
    return after, (m[NORMAL_FORCE], m[NORMAL_FORCE_RATE], anchor)


def curve(
    p: Numbers, at: int, m: Numbers, d0: float, d: float, v: float
) -> tuple[float, float, float, float]:
    """Return the force, its derivatives, and the work since `d0` under the present contact force."""
    k, _, f0 = branch(p, at, m)[:3]
    return k * d + f0, k, 0.0, (0.5 * k * (d + d0) + f0) * (d - d0)


RULE = Rule(
    (
        *BranchKind.OPEN.named("open"),
        *BranchKind.SLIPPING.named("slipping +", "slipping -"),
        *BranchKind.ELASTIC.named("sticking"),
    ),
    start,
    branch,
    transition,
    curve=curve,
    dissipated_power=rate_independent,
    parameters=3,
    variables=3,
)


def build(kt: float, mu: float, mud: float) -> Law:
    """Return the law with the tangential stiffness [F/L] and the static and dynamic coefficients [-].

    Raises
    ------
    ValueError
        The dynamic coefficient is above the static one.
    """
    if mud > mu:
        raise ItemError(
            f"MUD {mud:g} is above MU {mu:g}: what slips holds no better than what sticks", "MUD"
        )
    return Law(RULE, (kt, mu, mud))
