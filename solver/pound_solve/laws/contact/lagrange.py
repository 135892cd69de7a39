r"""Lagrange multiplier: bodies that touch stay together for as long as the multiplier presses.

At touch the two nodes take up one velocity, with the momentum that they had; while they are together
:math:`b^T u` stays at the gap, and the multiplier :math:`\lambda` of that condition is the contact force;
they part, without a jump, when it would pull.  The restitution of such a collision comes from the bodies
behind the nodes: divided into elements they emit waves, whose return ends the contact.

This is the idea of Papadrakakis M, Mouzakis H, Plevris N, Bitzarakis S (1991), Earthquake Engng Struct.
Dyn. 20: 981-998, whose details are not followed; the impact conditions of lumped nodes are those of Hughes
TJR, Taylor RL, Sackman JL, Curnier A, Kanoknukulchai W (1976), Comput. Methods Appl. Mech. Engng 8:
249-276.
It is the rule of :mod:`.stereomechanics` with a restitution of zero unless E says more.
"""

from __future__ import annotations

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.contact.stereomechanics import build

SPEC = Spec(
    "contact",
    "LAGRANGE",
    "rigid: closed while the multiplier presses",
    (
        Field(
            "E",
            Kind.REAL,
            "-",
            default=0.0,
            lo=0,
            hi=1,
            doc="restitution of the two nodes alone; 0: they move on together",
        ),
    ),
    reference="after Papadrakakis et al. 1991",
    impl=build,
)
