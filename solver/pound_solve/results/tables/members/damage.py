"""Table ``damage``."""

from __future__ import annotations

import math

from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> list[Row] | None:
    """One row for each component with an ultimate ductility, and the structure, if there are any."""
    damaged = [(r.spring, r.damage, r.loss) for r in run.history.springs if r.damage is not None]
    if not damaged:
        return None
    losses = [loss for *_, loss in damaged]
    total = sum(losses) or math.nan
    components: list[Row] = [
        (spring.element, spring.component, *index, index.total, loss / total)
        for spring, index, loss in damaged
    ]
    return [*components, (0, "", *[math.nan] * 4, run.history.overall_damage, sum(losses) / total)]


TABLE = Table(
    name="damage",
    title="Damage index of Park and Ang",
    place=40,
    stages=(Stage.PEAKS,),
    columns=(
        Column("element", fmt="int", doc="element number, 0 for the whole structure", zero="all"),
        Column("component", "comp.", doc="as in the spring envelopes"),
        Column(
            "ultimate", "ultimate\nductility", "-", "short", doc="ultimate ductility on the governing side"
        ),
        Column("ductility", "ductility", "-", "short", doc="largest deformation over yield on that side"),
        Column("by_deformation", "by\ndeform.", "-", "short", doc="largest over ultimate deformation"),
        Column(
            "by_energy",
            "by\nenergy",
            "-",
            "short",
            doc="beta times plastic work, over yield force times ultimate deformation",
        ),
        Column("index", "index", "-", "short", doc="sum of both terms"),
        Column("weight", "weight", "-", "short", doc="share of the plastic work of all rows"),
    ),
    rows=rows,
    note=(
        "An index of 1 is failure; above about 0.4 a member is beyond economic repair. The "
        "row 'all' is the mean weighted by plastic work."
    ),
)
