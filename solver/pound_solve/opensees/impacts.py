"""Contact laws that OpenSees has as well, each as the material that equals it.

Adding a law is one entry of `LAWS`.  A law without an entry is refused by its name.  The materials of
OpenSees work in compression: strains and gaps are negative.

The materials Hertzdamp and JankowskiImpact of version 3.7.1 return a tangent of the wrong sign, so that
Newton's method takes many iterations, and end the program for a gap of zero.  Hertzdamp damps with the
approach speed of the touch only; where a motion presses the bodies further than a free impact would, our
laws damp more (see `contact.hunt_crossley`), and where they are pulled apart fast, ours do not pull.

References
----------
OpenSees documentation, uniaxialMaterial ElasticPPGap, ViscoelasticGap, ImpactMaterial, Hertzdamp,
JankowskiImpact.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from types import MappingProxyType
from typing import Final

from pound_solve.laws.automaton import GAP, K, Numbers
from pound_solve.laws.contact import bilinear_impact, kelvin_voigt
from pound_solve.laws.contact.power import EXPONENT
from pound_solve.laws.refusal import ItemError
from pound_solve.opensees.script import Material

NEVER = -1e12  #: yield force of a gap that does not yield [F]
HERTZ = 1.5  #: exponent of JankowskiImpact with its damping
#: laws with the force of Hunt and Crossley, which differ in their exponents and in what E means
HUNT_CROSSLEY = ("HUNT_CROSSLEY", "HERTZ", "HERTZDAMP", "YE_2009", "GONTHIER", "MODIFIED_KELVIN")
DAMPING, MASS = 3, 4  #: parameters of the power laws
Translation = Callable[[Numbers], Material]  #: makes a material from the parameters of a law


def remark(laws: Collection[str]) -> str:
    """Return what to know of the laws of a deck: where the models differ."""
    damped = sorted(set(laws) & set(HUNT_CROSSLEY) - {"HERTZ"})
    if not damped:
        return ""
    return (
        f"Hertzdamp of OpenSees damps {', '.join(damped)} by the speed of the touch only. Where the motion "
        "presses the bodies further than a free impact would, our law damps more: peaks differ by up to "
        "some 1e-3, at any step."
    )


def linear(p: Numbers) -> Material:
    """Return a gap that yields never."""
    if p[GAP] < 0.0:
        raise ItemError("an overlap from the start", "GAP")
    return Material("ElasticPPGap", (p[K], NEVER, -p[GAP]))


def viscoelastic(p: Numbers) -> Material:
    """Return ViscoelasticGap, which pulls as TENSION=YES does."""
    if p[kelvin_voigt.C] == 0.0:
        return linear(p)
    if p[kelvin_voigt.PULLS] == 0.0:
        what = "KELVIN_VOIGT without tension; TENSION=YES or LAW=LINEAR can be compared"
        raise ItemError(what, "LAW")
    _open(p)
    return Material("ViscoelasticGap", (p[K], p[kelvin_voigt.C], -p[GAP]))


def bilinear(p: Numbers) -> Material:
    """Return ImpactMaterial."""
    _open(p)
    return Material("ImpactMaterial", (p[0], p[1], -p[bilinear_impact.DY], -p[GAP]))


def hertzdamp(p: Numbers) -> Material:
    """Return Hertzdamp, whose damping constant is divided by the approach speed, too."""
    _open(p)
    return Material("Hertzdamp", (p[K], p[DAMPING], -p[GAP], p[EXPONENT]))


def jankowski(p: Numbers) -> Material:
    """Return JankowskiImpact with the mass of the colliding nodes."""
    if p[EXPONENT] != HERTZ:
        raise ItemError(f"this law with the exponent {p[EXPONENT]:g}, not 1.5", "N")
    _open(p)
    mass = p[MASS]
    return Material(
        "JankowskiImpact", (p[K], p[DAMPING] / (2.0 * math.sqrt(p[K] * mass)), mass, -p[GAP], HERTZ)
    )


def _open(p: Numbers) -> None:
    """Raise ItemError unless there is a gap."""
    if p[GAP] <= 0.0:
        raise ItemError("this material of OpenSees needs a gap above 0", "GAP")


LAWS: Final[Mapping[str, Translation]] = MappingProxyType(
    {
        "LINEAR": linear,
        "KELVIN_VOIGT": viscoelastic,
        "BILINEAR_IMPACT": bilinear,
        **dict.fromkeys(HUNT_CROSSLEY, hertzdamp),
        "JANKOWSKI": jankowski,
    }
)
