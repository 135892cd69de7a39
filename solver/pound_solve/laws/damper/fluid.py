r"""Fluid viscous damper: a force that is a power of the rate.

.. math:: f = C\,\mathrm{sgn}(v)\,|v|^\alpha, \qquad |f| \le F, \qquad
          f = 0 \ \text{while}\ g^- < d < g^+

The force limit :math:`F` is that of a relief valve.  The play :math:`g` is the part of the stroke in which
a bypass is open; beyond it the damper resists motion in both directions.

The force has a kink where the motion reverses, where the relief valve opens and at the ends of the play;
the branch changes at each of them.  For :math:`\alpha < 1` the slope at :math:`v = 0` is infinite.  There
the force follows a straight line from the rate `CORE` in the direction of motion through zero to the rate
`CORE` in the other direction, at which the branch changes.  The force is therefore concave in the direction
of motion and straight in the other, and Newton's iteration converges from any start.

References
----------
Constantinou MC, Symans MD (1992), Experimental and analytical investigation of seismic response of
structures with supplemental fluid viscous dampers, Report NCEER-92-0032, State University of New York at
Buffalo; Soong TT, Constantinou MC (eds) (1994), Passive and Active Structural Vibration Control in Civil
Engineering, Springer (the energy of a cycle).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import (
    NEVER,
    BranchKind,
    Law,
    Numbers,
    PowerLawNumbers,
    Rule,
    above,
    below,
    linear,
)
from pound_solve.laws.mirror import inward, on_side, side

# parameters of a law, after a stiffness of zero: dashpot and exponent; for both directions the largest
# forces, the rates at which they are reached, and the ends of the play
C, ALPHA, MOST, MOST_MINUS, FAST, FAST_MINUS, FROM, FROM_MINUS = range(1, 9)
PLAY_SIDE = 0  #: internal variable: side of the play on which the damper is (1 or -1; 0: there is no play)
PLAY, MOVING, LIMITED = 0, 1, 3  #: branches of an extending damper; add one for a shortening damper
CORE = 1e-12  #: rate up to which the force is linear, as a fraction of the unit rate, at which it is C


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the initial state: in the play, or moving if there is no play."""
    return (PLAY if p[FROM] > p[FROM_MINUS] else MOVING), (0.0,)


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch; its events are a reversal, reaching or leaving the limit, and the ends of the
    play.
    """
    if at == PLAY:
        return linear(0.0, 0.0, above(p[FROM]), below(p[FROM_MINUS]))
    s = side(at)
    fast = p[FAST] if s > 0.0 else p[FAST_MINUS]
    play = NEVER
    if m[PLAY_SIDE] != 0.0:
        play = inward(m[PLAY_SIDE], p[FROM] if m[PLAY_SIDE] > 0.0 else -p[FROM_MINUS])
    if at >= LIMITED:
        return linear(0.0, s * (p[MOST] if s > 0.0 else p[MOST_MINUS]), (0.0, -s, fast), play)
    return linear(0.0, 0.0, (0.0, -s, -CORE), (0.0, s, -fast) if fast < math.inf else NEVER, play)


def engaged(p: Numbers, v: float) -> int:
    """Return the branch of a damper that moves at the rate `v`."""
    s = 1.0 if v >= 0.0 else -1.0
    return on_side(LIMITED if s * v > (p[FAST] if s > 0.0 else p[FAST_MINUS]) else MOVING, s)


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after an end of the play, a reversal, or reaching or leaving the limit."""
    if at == PLAY:
        return engaged(p, v), (1.0 if event == 0 else -1.0,)
    s = side(at)
    if event == (1 if at >= LIMITED else 2):
        return PLAY, m
    if at >= LIMITED:
        return on_side(MOVING, s), m
    return (on_side(MOVING, -s) if event == 0 else on_side(LIMITED, s)), m


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return zero: all the work is dissipated."""
    return 0.0


def curve(
    p: Numbers, at: int, m: Numbers, d0: float, d: float, v: float
) -> tuple[float, float, float, float]:
    """Return the force and its slope."""
    if at == PLAY:
        return 0.0, 0.0, 0.0, 0.0
    s = side(at)
    if at >= LIMITED:
        return s * (p[MOST] if s > 0.0 else p[MOST_MINUS]), 0.0, 0.0, 0.0
    c, alpha = p[C], p[ALPHA]
    if alpha < 1.0 and s * v < CORE:
        slope = c * CORE ** (alpha - 1.0)
        return slope * v, 0.0, slope, 0.0
    if v == 0.0:
        return 0.0, 0.0, (c if alpha == 1.0 else 0.0), 0.0
    secant = c * abs(v) ** (alpha - 1.0)
    return secant * v, 0.0, alpha * secant, 0.0


def dissipated_power(p: Numbers, at: int, m: Numbers, d: float, v: float) -> float:
    """Return the force times the rate: all the work is dissipated."""
    return curve(p, at, m, d, d, v)[0] * v


def power_law(p: Numbers, at: int, m: Numbers) -> PowerLawNumbers:
    """Return the force as a power of the rate, see `Rule`."""
    moving = at != PLAY and at < LIMITED
    return (side(at) * p[C] if moving else 0.0), p[ALPHA], 0.0, 0.0, 0.0, 0.0


RULE = Rule(
    (
        *BranchKind.OPEN.named("in the play"),
        *BranchKind.VISCOUS.named(
            "extending", "shortening", "extending at the limit", "shortening at the limit"
        ),
    ),
    start,
    branch,
    transition,
    recoverable,
    curve,
    dissipated_power,
    power_law,
    parameters=9,
    variables=1,
)


def damper(
    c: float, alpha: float, limit: tuple[float, float] | None = None, play: tuple[float, float] = (0.0, 0.0)
) -> Law:
    """Return the law of a damper.

    Parameters
    ----------
    c : float
        Force at the unit rate [F (T/L)^alpha].
    alpha : float
        Exponent, above 0.
    limit : tuple of float or None
        Largest forces, positive and negative [F].
    play : tuple of float
        Ends of the play, positive and negative [L].
    """
    if limit is None:
        limits = rates = (math.inf, math.inf)
    else:
        limits = (limit[0], -limit[1])
        rates = ((limits[0] / c) ** (1.0 / alpha), (limits[1] / c) ** (1.0 / alpha))
    return Law(RULE, (0.0, c, alpha, *limits, *rates, *play))


def build(
    values: Mapping[str, Any], c: float, limit: tuple[float, float] | None, play: tuple[float, float] | None
) -> Law | None:
    """Build the law of one component of a DASHPOT from its card's values; None for a linear dashpot.

    Parameters
    ----------
    values : mapping
        ALPHA.
    c, limit, play
        See `damper`; None if the card does not give it.
    """
    alpha = float(values["ALPHA"])
    if alpha == 1.0 and limit is None and play is None:
        return None
    return damper(c, alpha, limit, play or (0.0, 0.0))


SPEC = Spec(
    "damper",
    "FLUID",
    "power of the rate; with ALPHA=1 a linear dashpot",
    (Field("ALPHA", Kind.REAL, "-", default=1.0, above=0, doc="exponent of the rate in the force"),),
    reference="Constantinou & Symans 1992",
    sample="ALPHA=0.5",
    impl=build,
)
