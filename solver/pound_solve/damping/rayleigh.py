r"""RAYLEIGH: :math:`C = \alpha M + \beta K_0`, on a group of nodes and property sets.

ALPHA and BETA are given, or follow from a ratio XI at two circular frequencies (OMEGA) or modes (MODES):

.. math:: \alpha = 2\xi\frac{\omega_1\omega_2}{\omega_1+\omega_2}, \qquad
          \beta = \frac{2\xi}{\omega_1+\omega_2}

The mass part acts on the masses of NODES, the stiffness part on the initial stiffness of the elements
of PROPS; contacts are never damped by it.

References
----------
Clough RW, Penzien J (1993), Dynamics of Structures, 2nd edn, section 12-5.
"""

from __future__ import annotations

from pound_deck.model import Card
from pound_deck.schema import Field, Kind, Spec
from pound_solve.damping.base import DampingError, Ground, Group


def build(card: Card, ground: Ground) -> Group:
    """Damping of one group."""
    alpha, beta = card["ALPHA"], card["BETA"]
    how = "ALPHA and BETA given"
    if card["XI"] is not None:
        if alpha is not None or beta is not None:
            raise DampingError("give ALPHA and BETA, or XI with OMEGA or MODES, not both", "XI")
        if (card["OMEGA"] is None) == (card["MODES"] is None):
            raise DampingError(
                "XI needs two circular frequencies OMEGA=w1,w2 or two modes MODES=m1,m2", "XI"
            )
        if card["OMEGA"] is not None:
            w1, w2 = card["OMEGA"]
        else:
            omega = ground.omega()
            if max(card["MODES"]) > len(omega):
                raise DampingError(f"the structure has {len(omega)} modes only", "MODES")
            w1, w2 = (omega[m - 1] for m in card["MODES"])
            if w1 == 0 or w2 == 0:
                raise DampingError("a mode of zero frequency cannot carry a damping ratio", "MODES")
        alpha, beta = 2 * card["XI"] * w1 * w2 / (w1 + w2), 2 * card["XI"] / (w1 + w2)
        how = f"XI {card['XI']:.6g} at omega {w1:.6g} and {w2:.6g}"
    elif card["OMEGA"] is not None or card["MODES"] is not None:
        raise DampingError("OMEGA and MODES go with XI", "OMEGA" if card["OMEGA"] is not None else "MODES")
    alpha, beta = alpha or 0.0, beta or 0.0
    by_mass = alpha * ground.mass(card["NODES"])
    by_stiffness = beta * ground.stiffness(card["PROPS"])
    return Group(by_mass, by_stiffness, f"alpha {alpha:.9g}, beta {beta:.9g} ({how})")


SPEC = Spec(
    "damping",
    "RAYLEIGH",
    "mass and initial-stiffness proportional",
    (
        Field("ALPHA", Kind.REAL, "1/T", default=None, lo=0, doc="factor of the mass"),
        Field("BETA", Kind.REAL, "T", default=None, lo=0, doc="factor of the initial stiffness"),
        Field("XI", Kind.REAL, "-", default=None, lo=0, doc="damping ratio at OMEGA or MODES"),
        Field(
            "OMEGA",
            Kind.REAL,
            "1/T",
            default=None,
            count=(2, 2),
            above=0,
            doc="circular frequencies that have XI",
        ),
        Field(
            "MODES",
            Kind.INT,
            default=None,
            count=(2, 2),
            lo=1,
            doc="modes of the whole structure that have XI",
        ),
        Field("NODES", Kind.NODES, default=None, doc="nodes of the mass part; left out: all"),
        Field(
            "PROPS",
            Kind.PROPS,
            default=None,
            doc="property sets of the stiffness part; left out: all but contacts",
        ),
    ),
    code=0,
    reference="Clough & Penzien 1993, section 12-5",
    impl=build,
)
