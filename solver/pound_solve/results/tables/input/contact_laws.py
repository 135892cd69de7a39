"""Table ``contact_laws``."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pound_solve.results.columns import CONTACT
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table
from pound_solve.results.words import contact_name


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each contact: what it was given, and the restitution that it really has."""
    model = run.structure.model
    for s in run.structure.laws:
        if s.role.collides:
            f = s.facts
            yield (
                contact_name(model, s.element),
                s.rule,
                f"{f['k']:.7g} {model.units.text(f['k_unit'])}",
                f["c"],
                f["xi"] if math.isfinite(f["xi"]) else math.nan,
                f["e_asked"],
                f["e_given"],
                f["reduced_mass"] or math.nan,
                f["angle"],
                s.gap,
                f["note"],
            )


TABLE = Table(
    name="contact_laws",
    title="Contacts",
    place=90,
    stages=(Stage.INPUT,),
    columns=(
        CONTACT,
        Column("law", doc="contact law"),
        Column("k", "stiffness", doc="stiffness with its unit (which depends on the law)"),
        Column("c", "c", "F*T/L", "short", doc="damping coefficient"),
        Column("xi", "damping\nratio", "-", "short", doc="damping ratio or the law's damping constant"),
        Column(
            "e_asked",
            "e asked",
            "-",
            "short",
            doc="restitution that the deck specifies; NaN where it specifies none",
        ),
        Column(
            "e_given", "e given", "-", "short", doc="restitution that the law gives with these constants"
        ),
        Column(
            "mass", "reduced\nmass", "F*T^2/L", "short", doc="mass of the colliding pair, m1 m2 / (m1 + m2)"
        ),
        Column("angle", "angle", "deg", "given", doc="direction in which node I meets J, from global x"),
        Column("gap", "gap", "L", "given", doc="initial gap"),
        Column("note", doc="remarks on the law's constants"),
    ),
    rows=rows,
    note="e is the coefficient of restitution.",
)
