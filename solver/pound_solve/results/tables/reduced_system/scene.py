"""Table ``scene``."""

from __future__ import annotations

from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> list[Row] | None:
    """One row for each decision of the reduction; without a history only one where MODAL finds no modes."""
    if run.recorded is None:
        if run.modal.modes:
            return None
        return [("free vibration", "no modes", "no degree of freedom that has mass has stiffness too")]
    system = run.recorded.system
    decisions = [(d.subject, d.decision, d.why) for d in system.decisions]
    if system.total and any(e.j is None for e in run.model.elements.values()):
        why = "SUPPORTS moves the listed nodes only"
        decisions.append(("elements with one node", "end at a fixed point", why))
    if system.total:
        decisions.append(("displacements", "total displacements", "supports move relative to each other"))
    else:
        decisions.append(("displacements", "relative to the ground", "one motion for the whole base"))
    return decisions


TABLE = Table(
    name="scene",
    title="What this analysis needs",
    place=10,
    stages=(Stage.MODAL, Stage.HISTORY),
    columns=(
        Column("subject", doc="part of the analysis"),
        Column("decision", doc="what is done or omitted"),
        Column("why", doc="reason"),
    ),
    rows=rows,
)
