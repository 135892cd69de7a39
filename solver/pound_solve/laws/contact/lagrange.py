r"""Lagrange multiplier: bodies that touch stay together while the multiplier is compressive.

At touch the two nodes take a common velocity that conserves their momentum.  While they are together,
:math:`b^T u` stays at the gap, and the multiplier :math:`\lambda` of that constraint is the contact force.
They separate without a jump when the multiplier would become tensile.  The restitution of such a collision
comes from the bodies behind the nodes: if they are divided into elements, they emit waves whose return ends
the contact.

The idea is that of Papadrakakis M, Mouzakis H, Plevris N, Bitzarakis S (1991), Earthquake Engng Struct.
Dyn. 20: 981-998, whose details are not followed; the impact conditions of lumped nodes are those of Hughes
TJR, Taylor RL, Sackman JL, Curnier A, Kanoknukulchai W (1976), Comput. Methods Appl. Mech. Engng 8:
249-276.
The law is that of :mod:`.stereomechanics`, with a restitution of zero unless E is given.
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
