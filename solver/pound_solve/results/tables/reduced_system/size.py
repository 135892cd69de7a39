"""Table ``size``."""

from __future__ import annotations

from pound_solve.results.columns import ITEM, VALUE
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Row, Stage, Table


def rows(run: RunRecord) -> list[Row]:
    """Counts; those of the degrees of freedom add up to the unknowns."""
    from pound_solve.structure.elements.base import Role  # not needed to read a report

    structure = run.structure
    nodes, moved = structure.model.nodes.values(), len(structure.dofs.moved)
    fixed = sum(len(n.fixed) for n in nodes) - moved
    slaved = sum(len(set(n.slaved) - set(n.fixed)) for n in nodes)
    internal = sum(d >= 3 for _, d in structure.dofs.free)
    contacts = sum(x.role.collides for x in structure.laws)
    dampers = sum(x.role is Role.DAMPER for x in structure.laws)
    counts = {
        "nodes": len(nodes),
        "elements": len(structure.model.elements),
        "degrees of freedom of nodes": 3 * len(nodes),
        "less fixed": fixed,
        "less prescribed at moved supports": moved,
        "less slaved": slaved,
        "plus internal of elements (hinges)": internal,
        "unknowns before reduction": structure.n_free,
        "hysteretic components": len(structure.laws) - contacts - dampers,
        **({"dampers with a law": dampers} if dampers else {}),
        "contacts": contacts,
    }
    return [(item, str(count)) for item, count in counts.items()]


TABLE = Table(
    name="size", title="Problem size", place=20, stages=(Stage.INPUT,), columns=(ITEM, VALUE), rows=rows
)
