r"""Equivalent contact of two rigid floors: Kelvin-Voigt with the restitution and the duration that two
diaphragms with distributed mass would have.

:mod:`pound_solve.theory.two_bars` gives both from the masses and from the axial stiffnesses DIAPHRAGMS.
With :math:`\omega t_r` the time of release that belongs to the damping ratio (`restitution`),

.. math:: k = m\Bigl(\frac{\omega t_r}{T}\Bigr)^2, \qquad c = 2\xi\sqrt{k m}

MODEL=PAPER is Eqs 14 to 17 and 22 of Cole et al. (2011): their restitution and duration, and the relation
of a contact with tension whatever TENSION says; the report shows the restitution that comes of it.
MODEL=EXACT takes the restitution and duration of the exact theory, and the relation that is exact for
TENSION.  R < 1 is the plasticity index of Eq 22; the duration is left at that of the elastic collision, as
there.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import Law
from pound_solve.laws.contact import restitution
from pound_solve.laws.contact.kelvin_voigt import RULE, TENSION, Built
from pound_solve.theory.two_bars import Diaphragm, Pair


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Law from a card's values.

    Parameters
    ----------
    values : mapping
        GAP, MODEL, R, TENSION; MASSES, both [F T^2/L], and DIAPHRAGMS [F/L].
    reduced_mass : float
        Of MASSES [F T^2/L].

    Raises
    ------
    ValueError
        No DIAPHRAGMS or no masses, or the paper's equations give no restitution.
    """
    if values["DIAPHRAGMS"] is None:
        raise ValueError("EQUIVALENT needs the axial stiffness of the diaphragms: DIAPHRAGMS=kD1,kD2")
    if reduced_mass == 0.0:
        raise ValueError("EQUIVALENT needs colliding masses: give the nodes weight, or MASSES")
    pair = Pair(*map(Diaphragm, values["MASSES"], (*values["DIAPHRAGMS"], math.inf)[:2]))
    paper, tension = values["MODEL"] == "PAPER", values["TENSION"] == "YES"
    e = values["R"] * (pair.e_paper if paper else pair.e)
    if not 0.0 < e <= 1.0:
        raise ValueError(
            f"Eq. 14 of Cole et al. gives a restitution of {e:.4g}, which no contact has: take MODEL=EXACT"
        )
    duration = min(d.period for d in (pair.first, pair.second)) if paper else pair.duration
    if paper or tension:
        xi = restitution.sticky_ratio(e)
        released = math.pi / math.sqrt(1.0 - xi * xi)
    else:
        xi = restitution.no_tension_ratio(e)
        released = restitution.no_tension_time(xi)
    k = reduced_mass * (released / duration) ** 2
    c = 2.0 * xi * math.sqrt(k * reduced_mass)
    e_given = (restitution.sticky if tension else restitution.no_tension)(xi)
    note = f"duration {duration:.5g}, " + ("Eqs 14-17 of Cole et al. 2011" if paper else "exact theory")
    return Built(Law(RULE, (k, c, values["GAP"], float(tension))), k, c, xi, e, e_given, note)


SPEC = Spec(
    "contact",
    "EQUIVALENT",
    "Kelvin-Voigt contact of rigid floors that stands for distributed diaphragms (DIAPHRAGMS)",
    (
        Field(
            "MODEL",
            Kind.WORD,
            default="EXACT",
            words=("EXACT", "PAPER"),
            doc="theory of the collision: exact, or Eqs 14-17 of Cole et al. 2011",
        ),
        Field(
            "R",
            Kind.REAL,
            "-",
            default=1.0,
            above=0,
            hi=1,
            doc="plasticity index of the collision: 1 elastic",
        ),
        TENSION,
    ),
    reference="Cole, Dhakal, Carr & Bull 2011; exact: manual/theory-pounding.md",
    sample="MODEL=EXACT",
    impl=build,
)
