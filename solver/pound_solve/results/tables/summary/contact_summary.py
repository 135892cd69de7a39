"""Table ``contact_summary``."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pound_solve.results.columns import CONTACT, time_column
from pound_solve.results.record import RunRecord
from pound_solve.results.remarks import how_found
from pound_solve.results.schema import Column, Row, Stage, Table
from pound_solve.results.words import contact_name

ROUNDING = 1e-9  #: fraction of the displacements that the overlap of rigid bodies may be, which have none


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each contact."""
    structure, recorder = run.structure, run.history.recorder
    peaks = run.history.returned.peaks
    moved = recorder.envelopes.node["u"].largest()  # along x and y, and a rotation, of each node
    farthest = max((u for i, (u, _) in enumerate(moved) if i % 3 < 2), default=0.0)
    for i in run.history.items.contacts:
        law, closure = structure.laws[i], peaks.deformation[i]
        closest = law.gap - closure.high
        if law.law.rigid and abs(closest) <= ROUNDING * (law.gap + farthest):
            closest = 0.0
        collisions = [c for c in peaks.collisions if c.law == i]
        best = max(collisions, key=lambda c: (c.peak == c.peak, c.peak), default=None)  # NaN: an impact
        ends = [c.t_end if math.isfinite(c.t_end) else recorder.reached for c in collisions]
        yield (
            contact_name(run.model, law.element),
            len(collisions),
            best.peak if best else 0.0,
            best.t_peak if best else math.nan,
            max(-closest, 0.0),
            sum(c.impulse for c in collisions),
            recorder.losses[i] + peaks.dashpot_losses[i],
            closest,
            sum(end - c.t_start for c, end in zip(collisions, ends)),
        )


def remark(run: RunRecord) -> str:
    """Remark on whether peaks are exact."""
    return how_found(run) + " A closure that has not ended counts."


TABLE = Table(
    name="contact_summary",
    title="Contact summary",
    place=30,
    stages=(Stage.PEAKS,),
    columns=(
        CONTACT,
        Column("closures", fmt="int", doc="number of collisions"),
        Column("peak_force", "peak\nforce", "F", "num", doc="largest compression"),
        time_column("t_peak", "at time", "time of the largest compression"),
        Column("peak_penetration", "peak\npenetration", "L", "short", doc="largest overlap"),
        Column("impulse", "impulse", "F*T", "short", doc="integral of the force over time"),
        Column("energy_lost", "energy\nlost", "F*L", "short", doc="energy dissipated in the contact"),
        Column("min_gap", "smallest\ngap", "L", "short", doc="smallest gap, negative while in contact"),
        Column("time_closed", "time\nclosed", "T", "short", doc="sum of the durations of all collisions"),
    ),
    rows=rows,
    remark=remark,
    note="Compression is positive.",
)
