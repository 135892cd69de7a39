"""Table ``base_envelope``."""

from __future__ import annotations

from collections.abc import Iterator

from pound_solve.results.columns import BUILDING, UNIT, extreme_columns
from pound_solve.results.histories.buildings import BASE
from pound_solve.results.record import RunRecord
from pound_solve.results.remarks import how_sampled
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """Up to three rows for each building: those of forces that are not zero throughout."""
    units, envelope = run.model.units, iter(run.history.recorder.envelopes.sums["base"].rows())
    for b in run.history.items.buildings:
        for (quantity, dimension), extremes in zip(BASE, envelope):
            if extremes[0] != 0.0 or extremes[2] != 0.0:
                yield b.name, quantity, units.text(dimension), *extremes


TABLE = Table(
    name="base_envelope",
    title="Base shears and overturning moments",
    place=40,
    stages=(Stage.SAMPLES,),
    columns=(
        BUILDING,
        Column("quantity", doc="`shear X`, `force Y` or `moment`, which tips towards +x"),
        UNIT,
        *extreme_columns(""),
    ),
    rows=rows,
    remark=how_sampled,
    note="Force of each building on the ground: at its supports, and below its elements that end at "
    "the ground. It equals the inertia of the building and the loads on it. Contacts with other "
    "buildings, and mass-proportional and modal damping, are loads here. Moments are about the middle of "
    "the feet, positive where they tip the building towards +x.",
    group="quantity",
)
