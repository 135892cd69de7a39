"""Table ``node_envelope``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Final

from pound_solve.results.columns import NODE, UNIT, extreme_columns
from pound_solve.results.record import RunRecord
from pound_solve.results.remarks import how_sampled
from pound_solve.results.schema import Column, Row, Stage, Table

#: word and dimension of each quantity
QUANTITIES: Final[Mapping[str, tuple[str, str]]] = MappingProxyType(
    {"u": ("displacement", "L"), "v": ("velocity", "L/T"), "a": ("acceleration", "L/T^2")}
)


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each quantity of each recorded node that is not zero throughout."""
    units, items = run.model.units, run.history.items
    envelopes = {q: e.rows() for q, e in run.history.recorder.envelopes.node.items()}
    for i, node in enumerate(items.nodes):
        for axis, direction in enumerate("XYR"):
            for q, (word, dimension) in QUANTITIES.items():
                extremes = envelopes[q][3 * i + axis]
                if extremes[0] != 0.0 or extremes[2] != 0.0:
                    unit = dimension.replace("L", "rad") if direction == "R" else dimension
                    yield node, direction, word, units.text(unit), *extremes


def remark(run: RunRecord) -> str:
    """Remark on the instants that the envelopes are taken from, and on what motions are relative to."""
    if run.history.system.total:
        return how_sampled(run) + "All are total."
    return how_sampled(run) + (
        "Displacements and velocities are relative to the ground, accelerations are total."
    )


TABLE = Table(
    name="node_envelope",
    title="Node envelopes",
    place=20,
    stages=(Stage.SAMPLES,),
    columns=(
        NODE,
        Column("direction", "dir.", doc="`X`, `Y` or `R`"),
        Column("quantity", doc="`displacement`, `velocity` or `acceleration`"),
        UNIT,
        *extreme_columns(""),
    ),
    rows=rows,
    remark=remark,
    group="quantity",
)
