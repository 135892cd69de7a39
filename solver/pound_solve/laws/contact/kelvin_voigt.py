r"""Kelvin-Voigt contact: spring and dashpot, :math:`f = k\delta + c\dot\delta` while pressed.

With TENSION=NO (default) the contact releases where the force falls to zero, with some overlap left
(Shakya, Wijeyewickrema and Ohmachi 2008, 14th World Conf. Earthquake Engng, Beijing);
with TENSION=YES it lasts until the overlap is gone, and pulls shortly before that (Anagnostopoulos 1988,
Earthquake Engng Struct. Dyn. 16: 443-456).

The dashpot is given as C, as damping ratio XI, or as restitution E.
The relation of E to XI is the exact one for the chosen form or, with RELATION=PUBLISHED, the published one,
:math:`\xi = -\ln e / \sqrt{\pi^2 + \ln^2 e}`, which is exact only with tension.

Energy: the loss in the dashpot is the integral of :math:`c\dot\delta^2`.  If an overlap :math:`\delta_r`
remains at release, the contact element loses :math:`\tfrac12 k(\delta_r^2 - \delta^2)` while it relaxes
without force to :math:`\delta`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import GAP, BranchKind, K, Law, Numbers, Rule, above, below, linear
from pound_solve.laws.contact import restitution
from pound_solve.laws.contact.constants import dashpot, linear_fields

OPEN, PRESSED, RELEASED = 0, 1, 2
C, PULLS = 1, 3  #: parameters of a law besides K and GAP: dashpot; whether it may pull


def start(p: Numbers) -> tuple[int, Numbers]:
    """Return the initial state: open, or pressed if the gap is negative (an initial overlap)."""
    return (PRESSED if p[GAP] < 0.0 else OPEN), ()


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Return the branch; the deformation is the closure, and overlap = closure - gap."""
    k, c, gap, tension = p[:4]
    if at == OPEN:
        return linear(0.0, 0.0, above(gap))
    if at == RELEASED:
        # some overlap remains, without force: pressed again if k*overlap + c*rate becomes positive
        return linear(0.0, 0.0, (k, c, -k * gap), below(gap))
    return linear(k, -k * gap, below(gap) if tension != 0.0 else (-k, -c, k * gap), c=c)


def transition(p: Numbers, at: int, m: Numbers, event: int, d: float, v: float) -> tuple[int, Numbers]:
    """Return the state after a touch, a release or a separation."""
    if at == OPEN or (at == RELEASED and event == 0):
        return PRESSED, m
    return (OPEN if at == RELEASED or p[PULLS] != 0.0 or p[C] == 0.0 else RELEASED), m


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Return the energy of the contact spring; after a release it is lost within the contact as the overlap
    vanishes.
    """
    return 0.0 if at == OPEN else 0.5 * p[K] * (d - p[GAP]) ** 2


RULE = Rule(
    (
        *BranchKind.OPEN.named("open"),
        *BranchKind.PRESSED.named("pressed"),
        *BranchKind.RELEASED.named("released"),
    ),
    start,
    branch,
    transition,
    recoverable,
    parameters=4,
    variables=0,
)


class Built(NamedTuple):
    """A contact law with its values for the report; values that depend on the speed are NaN.

    Attributes
    ----------
    law : Law
    k : float
        Stiffness, in `unit`.
    c : float
        Dashpot [F T/L].
    xi : float
        Damping ratio of the closed contact with the reduced mass.
    e_asked, e_given : float
        Restitution that the card requires, and restitution that the law gives.
    note : str
        For the report.
    unit : str
    limit : float
        Largest overlap for which the law is intended [L].
    """

    law: Law
    k: float
    c: float
    xi: float
    e_asked: float
    e_given: float
    note: str
    unit: str = "F/L"
    limit: float = math.inf


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Build the law from a card's values.

    Parameters
    ----------
    values : mapping
        GAP, K and one of C, XI, E; RELATION, TENSION.
    reduced_mass : float
        m1 m2 / (m1 + m2) of the colliding masses along the contact [F T^2/L]; may be zero (massless node).

    Raises
    ------
    ValueError
        None or several of C, XI, E; or XI or E where there is no mass.
    """
    tension = values["TENSION"] == "YES"
    restitution_of, exact = (
        (restitution.with_tension, restitution.with_tension_ratio)
        if tension
        else (restitution.no_tension, restitution.no_tension_ratio)
    )
    damper = dashpot(values, reduced_mass, restitution_of, exact, restitution.with_tension_ratio)
    p = (values["K"], damper.c, values["GAP"], float(tension))
    return Built(Law(RULE, p), values["K"], *damper)


TENSION = Field(
    "TENSION",
    Kind.WORD,
    default="NO",
    words=("NO", "YES"),
    codes={"NO": 0, "YES": 1},
    doc="tension until the overlap ends",
)

SPEC = Spec(
    "contact",
    "KELVIN_VOIGT",
    "spring and dashpot while closed",
    (*linear_fields("Anagnostopoulos 2004"), TENSION),
    code=1,
    reference="Anagnostopoulos 1988, 2004; no tension: Shakya, Wijeyewickrema & Ohmachi 2008",
    sample="E=0.5",
    impl=build,
)
