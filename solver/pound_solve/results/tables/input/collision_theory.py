"""Table ``collision_theory``."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pound_solve.results.columns import CONTACT
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table
from pound_solve.results.words import contact_name


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each contact."""
    for i, m in run.diaphragm_collisions.items():
        name, p = contact_name(run.structure.model, run.structure.laws[i].element), m.pair
        if p is None:
            yield name, *[math.nan] * 5, m.note
        else:
            yield name, p.e_paper, p.e, p.duration, p.force, 100.0 * m.lumped_error, m.note


def remark(run: RunRecord) -> str | None:
    """Explain the lumped error where there is one."""
    if not any(x.pair for x in run.diaphragm_collisions.values()):
        return None
    return (
        "The lumped error is (1 + e) / (1 + e_eff exact) - 1 with the restitution e of the contact where "
        "DIAPHRAGMS stands on its card, else with e = 1."
    )


TABLE = Table(
    name="collision_theory",
    title="Collision theory of these diaphragms",
    place=110,
    stages=(Stage.INPUT,),
    columns=(
        CONTACT,
        Column(
            "e_paper", "e_eff\npaper", "-", "short", doc="effective restitution, Eq 14 of Cole et al. 2011"
        ),
        Column("e_exact", "e_eff\nexact", "-", "short", doc="effective restitution, exact"),
        Column("duration", "duration", "T", "short", doc="time for which the bars are in contact, exact"),
        Column(
            "force", "force per\nspeed", "F*T/L", "num", doc="contact force for an approach speed of one"
        ),
        Column(
            "lumped_error",
            "lumped\nerror",
            "%",
            "percent",
            doc=("error of the changes of velocity with lumped masses: (1 + e) / (1 + e_eff exact) - 1"),
        ),
        Column("note", doc=("whether the paper's equations hold, and whether lumped mass is good enough")),
    ),
    rows=rows,
    remark=remark,
    note="The theory is that of uniform elastic bars that meet end to end.",
)
