r"""Kelvin-Voigt contact: spring and dashpot, :math:`f = k\delta + c\dot\delta` while pressed.

With TENSION=NO (default) the contact lets go where the force falls to zero, with some overlap left
(Shakya, Wijeyewickrema and Ohmachi 2008, 14th World Conf. Earthquake Engng, Beijing);
with TENSION=YES it holds until the overlap is gone and pulls before it does (Anagnostopoulos 1988,
Earthquake Engng Struct. Dyn. 16: 443-456).

The dashpot is given as C, as damping ratio XI, or as restitution E.
The relation of E to XI is the exact one of the form chosen, or by RELATION=PUBLISHED the published one,
:math:`\xi = -\ln e / \sqrt{\pi^2 + \ln^2 e}`, which is exact only with tension.

Energy: the dashpot's loss is the integral of :math:`c\dot\delta^2`; an overlap :math:`\delta_r` left at
release loses :math:`\tfrac12 k\delta_r^2` as the contact element relaxes alone.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from pound_deck.schema import Field, Kind, Spec
from pound_solve.contact import restitution
from pound_solve.laws import Law, Numbers, Rule, above, below, piece, remember

OPEN, PRESSED, RELEASED = 0, 1, 2


def start(p: Numbers) -> tuple[int, Numbers]:
    """Open, or pressed where the gap is negative (an overlap from the start)."""
    return (PRESSED if p[2] < 0.0 else OPEN), remember()


def branch(p: Numbers, at: int, m: Numbers) -> Numbers:
    """Deformation is the closure, overlap = closure - gap."""
    k, c, gap, tension = p[:4]
    if at == OPEN:
        return piece(0.0, 0.0, above(gap))
    if at == RELEASED:
        # overlap left, force zero: pressed again if k*overlap + c*rate turns positive
        return piece(0.0, 0.0, (k, c, -k * gap), below(gap))
    return piece(k, -k * gap, below(gap) if tension != 0.0 else (-k, -c, k * gap), c=c)


def leave(p: Numbers, at: int, m: Numbers, way: int, d: float, v: float) -> tuple[int, Numbers]:
    """Touch, let go, or part."""
    if at == OPEN or (at == RELEASED and way == 0):
        return PRESSED, m
    return (OPEN if at == RELEASED or p[3] != 0.0 or p[1] == 0.0 else RELEASED), m


def recoverable(p: Numbers, at: int, m: Numbers, d: float, f: float) -> float:
    """Energy of the contact spring."""
    return 0.5 * p[0] * (d - p[2]) ** 2 if at == PRESSED else 0.0


RULE = Rule(("open", "pressed", "released"), start, branch, leave, recoverable)


class Built(NamedTuple):
    """A contact law with what the report says of it."""

    law: Law
    k: float
    c: float
    xi: float
    e_asked: float
    e_given: float
    note: str


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Law from a card's values.

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
    given = [name for name in ("C", "XI", "E") if values[name] is not None]
    if len(given) != 1:
        raise ValueError(
            "give the dashpot once: as C, as XI or as E" + (", not " + " and ".join(given) if given else "")
        )
    k, tension = values["K"], values["TENSION"] == "YES"
    exact, ratio = (
        (restitution.sticky, restitution.sticky_ratio)
        if tension
        else (restitution.no_tension, restitution.no_tension_ratio)
    )
    e_asked, note = math.nan, "C given"
    root = 2.0 * math.sqrt(k * reduced_mass)
    if given[0] == "C":
        c = values["C"]
        xi = c / root if root else math.inf
    else:
        if root == 0.0:
            raise ValueError(f"{given[0]} needs colliding masses: give the nodes weight, or MASSES, or C")
        if given[0] == "XI":
            xi, note = values["XI"], "XI given"
        else:
            e_asked = values["E"]
            published = values["RELATION"] == "PUBLISHED"
            xi = restitution.sticky_ratio(e_asked) if published else ratio(e_asked)
            note = "published relation of E to XI" if published else "exact relation of E to XI"
        c = xi * root
    e_given = exact(xi) if math.isfinite(xi) else math.nan
    return Built(Law(RULE, (k, c, values["GAP"], float(tension))), k, c, xi, e_asked, e_given, note)


SPEC = Spec(
    "contact",
    "KELVIN_VOIGT",
    "spring and dashpot while pressed",
    (
        Field("K", Kind.REAL, "F/L", above=0, words=("ADJACENT",), doc="contact stiffness"),
        Field("C", Kind.REAL, "F*T/L", default=None, lo=0, doc="dashpot (one of C, XI, E)"),
        Field(
            "XI",
            Kind.REAL,
            "-",
            default=None,
            lo=0,
            doc="damping ratio on the colliding masses (one of C, XI, E)",
        ),
        Field(
            "E",
            Kind.REAL,
            "-",
            default=None,
            above=0,
            hi=1,
            doc="coefficient of restitution (one of C, XI, E)",
        ),
        Field(
            "RELATION",
            Kind.WORD,
            default="EXACT",
            words=("EXACT", "PUBLISHED"),
            doc="how E becomes XI: exact for the form chosen, or Anagnostopoulos 2004",
        ),
        Field(
            "TENSION",
            Kind.WORD,
            default="NO",
            words=("NO", "YES"),
            codes={"NO": 0, "YES": 1},
            doc="hold until the overlap is gone",
        ),
    ),
    code=1,
    reference="Anagnostopoulos 1988, 2004; no tension: Shakya, Wijeyewickrema & Ohmachi 2008",
    sample="E=0.5",
    impl=build,
)
