"""Table ``collisions``."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pound_solve.results.columns import CONTACT, time_column
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table
from pound_solve.results.words import contact_name


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each closure of a contact, by time."""
    for c in sorted(run.history.returned.peaks.collisions, key=lambda c: (c.t_start, c.law)):
        theory, duration = run.diaphragm_collisions[c.law], c.t_end - c.t_start
        predicted = theory.predicted(c.approach, c.impulse, c.peak)
        yield (
            contact_name(run.model, run.structure.laws[c.law].element),
            c.t_start,
            c.t_end,
            c.approach,
            c.separation,
            c.separation / c.approach if c.approach > 0 else math.nan,
            c.peak,
            c.t_peak,
            c.impulse,
            theory.plateau(c.impulse, c.peak, duration),
            predicted,
            100.0 * (predicted / c.peak - 1.0) if c.peak > 0.0 else math.nan,
        )


def remark(run: RunRecord) -> str | None:
    """Explain the predicted force where there is one."""
    if not any(x.pair for x in run.diaphragm_collisions.values()):
        return None
    return (
        "The prediction considers the diaphragms only (see the input), no other forces and no ringing: the "
        "peak of a mesh of lumped masses exceeds a constant force by 14 % or more. It assumes a contact "
        "much stiffer than the diaphragms: softer contacts stay below it. It is omitted where they push on "
        "after the waves, that is where the impulse over the peak is more than twice that of the "
        "prediction. The plateau is the impulse over the time of contact, or over the shorter time that "
        "the predicted force would need for it, and at most the peak."
    )


TABLE = Table(
    name="collisions",
    title="Collisions",
    place=20,
    stages=(Stage.PEAKS,),
    columns=(
        CONTACT,
        time_column("t_start", "closes", "time of closing"),
        time_column("t_end", "opens", "time of opening; NaN if still closed at the end"),
        Column(
            "approach_velocity", "approach\nvelocity", "L/T", "short", doc="relative velocity at closing"
        ),
        Column(
            "separation_velocity",
            "separation\nvelocity",
            "L/T",
            "short",
            doc="relative velocity at opening",
        ),
        Column("restitution", "restitution", "-", "short", doc="separation over approach velocity"),
        Column("peak_force", "peak\nforce", "F", "num", doc="largest compression"),
        time_column("t_peak", "at time", "time of the largest compression"),
        Column("impulse", "impulse", "F*T", "short", doc="integral of the force over time"),
        Column(
            "plateau_force",
            "plateau\nforce",
            "F",
            "short",
            doc=(
                "impulse over the duration, or over the shorter time that the predicted "
                "force would take for the predicted impulse (unless the floors push on "
                "after the waves), and at most the peak; NaN if still closed at the end"
            ),
        ),
        Column(
            "predicted_force",
            "predicted\nforce",
            "F",
            "short",
            doc=(
                "first force of the diaphragms at this approach velocity, Eq 11 of Cole "
                "et al. 2011; NaN where the impulse over the peak force is more than "
                "twice the predicted one"
            ),
        ),
        Column("force_error", "error", "%", "percent", doc="predicted over peak force, less one"),
    ),
    rows=rows,
    remark=remark,
    note=(
        "Both velocities are positive if the bodies approach before and separate after the "
        "collision. The restitution is that of the law only if nothing else acts on the "
        "bodies during the collision."
    ),
    limit=100,
)
