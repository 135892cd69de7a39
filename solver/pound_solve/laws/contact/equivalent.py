r"""Equivalent contact of two rigid floors: a Kelvin-Voigt contact after which their centres of mass move
like those of two diaphragms with distributed mass.

:mod:`pound_solve.laws.two_bars` gives the contact force of the diaphragms from the masses and from the
axial stiffnesses DIAPHRAGMS.  A contact has two constants.  MODEL=EXACT gives it the impulse
:math:`(1+e)m\Delta v` and the centroid :math:`\bar t` of that force, both continuous in all masses and
stiffnesses:

.. math:: \omega\bar t = \frac{e}{1+e}(\omega t_r + 2\xi), \qquad k = m\omega^2, \qquad c = 2\xi m\omega

with the damping ratio and the time of release :math:`t_r` that correspond to :math:`e` (`restitution`).
For a contact with tension, :math:`\bar t` is the centroid of the compressive part of its force.

MODEL=PAPER uses Eqs 14 to 17 and 22 of Cole et al. (2011): their restitution, the shorter collision period
as the duration, and the relation of a contact with tension regardless of TENSION.  The report shows the
resulting restitution.  R < 1 is the plasticity index of Eq 22; the centroid remains that of the elastic
collision, as the duration does in the paper.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pound_deck.schema import Field, Kind, Spec
from pound_solve.laws.automaton import Law
from pound_solve.laws.contact import restitution
from pound_solve.laws.contact.kelvin_voigt import RULE, TENSION, Built
from pound_solve.laws.refusal import ItemError
from pound_solve.laws.two_bars import Diaphragm, Pair


def build(values: Mapping[str, Any], reduced_mass: float) -> Built:
    """Build the law from a card's values.

    Parameters
    ----------
    values : mapping
        GAP, MODEL, R, TENSION; MASSES, both [F T^2/L], and DIAPHRAGMS [F/L].
    reduced_mass : float
        Of MASSES [F T^2/L].

    Raises
    ------
    ValueError
        There are no DIAPHRAGMS or no masses, or the paper's equations give no restitution.
    """
    if values["DIAPHRAGMS"] is None:
        raise ValueError("EQUIVALENT needs the axial stiffness of the diaphragms: DIAPHRAGMS=kD1,kD2")
    if reduced_mass == 0.0:
        raise ValueError("EQUIVALENT needs colliding masses: give the nodes weight, or MASSES")
    pair = Pair(*map(Diaphragm, values["MASSES"], (*values["DIAPHRAGMS"], math.inf)[:2]))
    paper, tension = values["MODEL"] == "PAPER", values["TENSION"] == "YES"
    e = values["R"] * (pair.e_paper if paper else pair.e)
    if not 0.0 < e <= 1.0:
        raise ItemError(
            f"Eq. 14 of Cole et al. gives a restitution of {e:.4g}, which no contact has: take MODEL=EXACT",
            "MODEL",
        )
    xi = restitution.with_tension_ratio(e) if paper or tension else restitution.no_tension_ratio(e)
    if paper:
        duration = min(d.period for d in (pair.first, pair.second))
        omega = math.pi / math.sqrt(1.0 - xi * xi) / duration
        note = f"duration {duration:.5g}, Eqs 14-17 of Cole et al. 2011"
    else:
        omega = restitution.push_centroid(xi) / pair.centroid
        note = f"centroid {pair.centroid:.5g}, exact theory"
    k = reduced_mass * omega * omega
    c = 2.0 * xi * reduced_mass * omega
    e_given = (restitution.with_tension if tension else restitution.no_tension)(xi)
    return Built(Law(RULE, (k, c, values["GAP"], float(tension))), k, c, xi, e, e_given, note)


SPEC = Spec(
    "contact",
    "EQUIVALENT",
    "Kelvin-Voigt contact of rigid floors, equivalent to distributed diaphragms (DIAPHRAGMS)",
    (
        Field(
            "MODEL",
            Kind.WORD,
            default="EXACT",
            words=("EXACT", "PAPER"),
            doc="theory of the collision: exact, or Eqs 14-17 of Cole et al. 2011",
        ),
        Field(
            "R", Kind.REAL, "-", default=1.0, above=0, hi=1, doc="plasticity index of collision; 1: elastic"
        ),
        TENSION,
    ),
    reference="Cole, Dhakal, Carr & Bull 2011; exact: manual/theory-pounding.md",
    sample="MODEL=EXACT",
    impl=build,
)
