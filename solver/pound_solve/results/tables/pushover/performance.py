"""Table ``performance``."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from pound_solve.results.columns import PUSH, base_shear, control_displacement
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table

if TYPE_CHECKING:
    from pound_solve.analyses.capacity_line import PerformancePoint
    from pound_solve.analyses.pushover import PushoverResult


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each pushover with TC and each ground motion along its direction."""
    for pushed in run.pushovers:
        for name, point in run.performance[pushed.number]:
            yield pushed.number, name, *_state(pushed, point)


def _state(pushed: PushoverResult, point: PerformancePoint | None) -> tuple[float, ...]:
    """Performance point and the state of the building there; NaN and no changes if the curve has none."""
    from pound_solve.analyses.capacity_line import CapacityCurve  # not needed to read a report

    if point is None:
        return *(math.nan,) * 6, 0
    curve, start = CapacityCurve(pushed.curve), pushed.curve[0]
    end, at_yield = point.line.end, point.line.yield_displacement
    shear = start.shear + curve.sense * float(np.interp(end, curve.d, curve.v))
    changes = sum(curve.sense * (p.displacement - start.displacement) <= end for p, _ in pushed.ladder)
    return (
        point.period,
        point.acceleration,
        point.reduction,
        end / at_yield,
        point.displacement,
        shear,
        changes,
    )


TABLE = Table(
    name="performance",
    title="Performance points by the N2 method",
    place=16,
    stages=(Stage.PUSHOVER,),
    columns=(
        PUSH,
        Column("motion", doc="number and name of the ground motion"),
        Column("period", "period\nT*", "T", "short", doc="of the equivalent oscillator"),
        Column(
            "acceleration",
            "spectral\naccel.",
            "L/T^2",
            "short",
            doc="of the elastic spectrum at that period",
        ),
        Column("reduction", "over\nyield", "-", "short", doc="spectral acceleration over that at yield"),
        Column("ductility", "ductility", "-", "short", doc="displacement over that at yield"),
        control_displacement("of the control node, including the static one"),
        base_shear("of the curve there, including the static one"),
        Column("changes", fmt="int", doc="changes of springs, hinges and contacts up to there"),
    ),
    rows=rows,
    note=(
        "The curve is idealised up to the performance point itself; the spectra are those of the motions, "
        "with the damping XI and the corner period TC of the card. A row without numbers means that "
        "the demand exceeds the curve, or that the curve stiffens: push further, or use HISTORY."
    ),
)
