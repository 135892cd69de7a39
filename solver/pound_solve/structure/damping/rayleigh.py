r"""RAYLEIGH: :math:`C = \alpha M + \beta K`, on a group of nodes and property sets.

ALPHA and BETA are given, or follow from the ratios XI at two circular frequencies (OMEGA) or modes (MODES)
by :math:`2\xi_i\omega_i = \alpha + \beta\omega_i^2`:

.. math:: \alpha = 2\omega_1\omega_2\frac{\xi_1\omega_2 - \xi_2\omega_1}{\omega_2^2-\omega_1^2}, \qquad
          \beta = 2\frac{\xi_2\omega_2 - \xi_1\omega_1}{\omega_2^2-\omega_1^2}

The mass part acts on the masses of NODES, the stiffness part on the elements of PROPS; it never damps
contacts. With BUILDING, both act on this building alone, and MODES counts its own modes. STIFFNESS selects
K. INITIAL takes the structure at rest.  With TANGENT or SECANT every hysteretic law has a parallel dashpot
with :math:`\beta` times its present stiffness: the tangent (none while it is negative), or the secant to
the farthest reversal so far (see `secant`).  ELASTIC leaves out the laws, so that no dashpot restrains a
yielding hinge.

References
----------
Clough RW, Penzien J (1993), Dynamics of Structures, 2nd edn, section 12-5.
"""

from __future__ import annotations

from pound_deck.model import Card
from pound_deck.schema import Field, Kind, Spec
from pound_solve.structure.damping.base import (
    AFTER,
    BUILDING,
    CardDamping,
    DampingContext,
    DampingError,
    Dashpots,
    frequencies,
    ratios,
    values,
)
from pound_solve.structure.proportional import Chosen, Proportional


def coefficients(xi: tuple[float, float], w: tuple[float, float]) -> tuple[float, float]:
    """Return alpha [1/T] and beta [T] that give ratios `xi` at circular frequencies `w`.

    Raises
    ------
    DampingError
        One of them would be negative, or one frequency has two ratios.
    """
    (w1, w2), (x1, x2) = w, xi
    if x1 == x2:
        return 2 * x1 * w1 * w2 / (w1 + w2), 2 * x1 / (w1 + w2)
    low, high = sorted((x1 * w1 / w2, x1 * w2 / w1))
    if w1 == w2 or not low * (1 - 1e-12) <= x2 <= high * (1 + 1e-12):
        raise DampingError(
            f"alpha or beta would be negative: beside XI {x1:.6g} at omega {w1:.6g} that at {w2:.6g} "
            f"lies between {low:.4g} and {high:.4g}",
            "XI",
        )
    spread = (w2 - w1) * (w2 + w1)
    alpha = 2 * w1 * w2 * (x1 * w2 - x2 * w1) / spread
    return max(alpha, 0.0), max(2 * (x2 * w2 - x1 * w1) / spread, 0.0)


def factors(card: Card, context: DampingContext) -> tuple[float, float, str]:
    """Return alpha [1/T] and beta [T] of a card, and their source in words.

    Raises
    ------
    DampingError
        Items contradict each other, or a factor would be negative.
    """
    alpha, beta = card["ALPHA"], card["BETA"]
    building = context.nodes(card) if card["BUILDING"] else None
    if card["AFTER"] == "STATIC" and card["MODES"] is None:
        raise DampingError("AFTER says whose MODES are meant", "AFTER")
    how = "ALPHA and BETA given"
    if card["XI"] is not None:
        if alpha is not None or beta is not None:
            raise DampingError("give ALPHA and BETA, or XI with OMEGA or MODES, not both", "XI")
        w1, w2 = frequencies(card, lambda: context.modes(building, max(card["MODES"])).omega, context)
        x1, x2 = ratios(card, 2)
        alpha, beta = coefficients((x1, x2), (w1, w2))
        how = f"XI {values(card['XI'])} at omega {w1:.6g} and {w2:.6g}"
    elif card["OMEGA"] is not None or card["MODES"] is not None:
        raise DampingError("OMEGA and MODES go with XI", "OMEGA" if card["OMEGA"] is not None else "MODES")
    return alpha or 0.0, beta or 0.0, how


def build(card: Card, context: DampingContext) -> CardDamping:
    """Damping of one group."""
    nodes = context.nodes(card)
    alpha, beta, how = factors(card, context)
    chosen = Chosen(card["PROPS"], nodes if card["BUILDING"] else None)
    follows = card["STIFFNESS"] in ("TANGENT", "SECANT")
    return CardDamping(
        alpha * context.mass(nodes),
        Proportional(chosen, beta, card["STIFFNESS"] == "INITIAL"),
        f"alpha {alpha:.9g}, beta {beta:.9g} of the {card['STIFFNESS'].lower()} stiffness ({how})",
        Dashpots(chosen, beta, card["STIFFNESS"] == "SECANT") if follows else None,
    )


SPEC = Spec(
    "damping",
    "RAYLEIGH",
    "mass and stiffness proportional",
    (
        Field("ALPHA", Kind.REAL, "1/T", default=None, lo=0, doc="factor on the mass"),
        Field("BETA", Kind.REAL, "T", default=None, lo=0, doc="factor on the stiffness"),
        Field(
            "XI",
            Kind.REAL,
            "-",
            default=None,
            count=(1, 2),
            lo=0,
            doc="damping ratio at OMEGA or MODES; one value: at both",
        ),
        Field(
            "OMEGA", Kind.REAL, "1/T", default=None, count=(2, 2), above=0, doc="circular frequencies of XI"
        ),
        Field(
            "MODES",
            Kind.INT,
            default=None,
            count=(2, 2),
            lo=1,
            doc="modes of the structure, or of the BUILDING, with XI",
        ),
        Field(
            "STIFFNESS",
            Kind.WORD,
            default="INITIAL",
            words=("INITIAL", "TANGENT", "SECANT", "ELASTIC"),
            codes={"INITIAL": 0, "TANGENT": 1, "SECANT": 6},
            doc="stiffness of hysteretic laws that BETA multiplies: initial, tangent, secant or none",
        ),
        BUILDING,
        Field("NODES", Kind.NODES, default=None, doc="nodes of the mass term; omitted: all"),
        Field(
            "PROPS",
            Kind.PROPS,
            default=None,
            doc="property sets of the stiffness term; omitted: all but contacts",
        ),
        AFTER,
    ),
    code=0,
    reference="Clough & Penzien 1993, section 12-5",
    impl=build,
)
