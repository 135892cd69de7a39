"""Table ``arrays``."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table

if TYPE_CHECKING:
    from pound_solve.numerics.matrices import Matrix


def rows(run: RunRecord) -> Iterator[Row]:
    """Arrays that outlive an analysis: part, what it holds, numbers and bytes."""
    s = run.structure
    contact = [i for i, x in enumerate(s.laws) if x.role.collides]
    spring = [i for i, x in enumerate(s.laws) if not x.role.collides]
    yield "structure", "stiffness, mass, damping", *stored(s.stiffness, s.mass, s.damping)
    yield "springs and hinges", f"deformations of {len(spring)}", *stored(s.law_rows[spring])
    yield "contacts", f"closures of {len(contact)}", *stored(s.law_rows[contact])
    members = stored(s.corotational.p, s.corotational.rows)
    yield "geometric nonlinearity", f"chords of {len(s.corotational)}", *members
    if run.recorded is None:
        return
    x = run.recorded.system
    yield (
        "history",
        f"mass, damping, stiffness of {x.size} unknowns",
        *stored(x.mass, x.damping, x.stiffness),
    )
    inputs = stored(x.inputs, x.law_inputs, x.law_rows)
    yield "history", "forces and deformations by the inputs", *inputs
    back = stored(x.expand, x.expand_constant, x.expand_inputs)
    yield "history", f"expansion to {s.n_free} degrees of freedom", *back
    motion = stored(x.excitation.breaks, x.excitation.coefs)
    yield "ground motion", "polynomials in time", *motion
    for name, (shape, _) in run.layout.items():
        if count := math.prod(shape):
            yield "stored at an instant", name, count, 8 * count


def remark(run: RunRecord) -> str:
    """Name the kind of problem, by the analyses and the laws of springs and contacts."""
    laws = run.structure.laws
    curved = bool(run.structure.corotational) or any(s.law.curved for s in laws)
    shape = "general" if curved else "piecewise linear" if laws else "linear"
    analyses = [card.spec.name for card in run.model.analyses]
    kind = "modal" if "MODAL" in analyses else "no analysis"
    for name in ("STATIC", "PUSHOVER", "HISTORY"):  # the last counts
        if name in analyses:
            kind = f"{shape} {name.lower()}"
    return f"Kind of problem: {kind}."


def stored(*matrices: Matrix) -> tuple[int, int]:
    """Numbers stored in some plain or sparse matrices, and bytes with the indices."""
    numbers = held = 0
    for a in matrices:
        parts = [a.data, a.indices, a.indptr] if hasattr(a, "indptr") else [a]
        numbers += int(parts[0].size)
        held += sum(int(p.nbytes) for p in parts)
    return numbers, held


TABLE = Table(
    name="arrays",
    title="Arrays in memory",
    place=30,
    stages=(Stage.EXPLAIN,),
    columns=(
        Column("part", doc="what the arrays belong to"),
        Column("what", doc="what they hold"),
        Column("numbers", fmt="int", doc="numbers in the arrays; for sparse matrices, stored numbers"),
        Column("bytes", fmt="int", doc="memory, including indices of sparse matrices"),
    ),
    rows=rows,
    remark=remark,
    note="Work arrays of a method, which are of the same order, are not counted.",
)
