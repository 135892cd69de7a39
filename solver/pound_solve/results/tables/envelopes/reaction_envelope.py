"""Table ``reaction_envelope``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.columns import NODE, UNIT, extreme_columns
from pound_solve.results.record import RunRecord
from pound_solve.results.remarks import how_sampled
from pound_solve.results.schema import Column, Row, Stage, Table

QUANTITIES = (("force X", "F"), ("force Y", "F"), ("moment", "F*L"))  #: of a support, and their dimensions


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each direction in which a recorded support has a force."""
    units, envelope = run.model.units, run.history.recorder.envelopes.sums["reaction"].rows()
    for i, node in enumerate(run.history.items.supports):
        for d, (quantity, dimension) in enumerate(QUANTITIES):
            extremes = envelope[3 * i + d]
            if extremes[0] != 0.0 or extremes[2] != 0.0:
                yield node, quantity, units.text(dimension), *extremes


TABLE = Table(
    name="reaction_envelope",
    title="Reaction envelopes",
    place=30,
    stages=(Stage.SAMPLES,),
    columns=(NODE, Column("quantity", doc="`force X`, `force Y` or `moment`"), UNIT, *extreme_columns("")),
    rows=rows,
    remark=how_sampled,
    note="Forces of the supports on the structure. Damping in proportion to stiffness and the inertia of a "
    "support's own mass are part of them; mass-proportional and modal damping act between the masses and "
    "the ground and pass by the supports.",
    group="quantity",
)
