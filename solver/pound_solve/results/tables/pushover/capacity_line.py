"""Table ``capacity_line``."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pound_solve.results.columns import PUSH
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each pushover to one target whose curve such a line idealises."""
    from pound_solve.analyses.capacity_line import CapacityCurve  # not needed to read a report

    for pushed in run.pushovers:
        curve, system = CapacityCurve(pushed.curve), pushed.equivalent
        if pushed.turns or not (line := curve.line(curve.strongest)):
            continue
        ratio, oscillator = math.nan, (math.nan,) * 3
        if system:
            ratio = line.yield_shear / (run.model.gravity * system.whole_mass)
            oscillator = system.mass, system.factor, line.period(system)
        at_yield = line.yield_displacement, line.yield_shear
        ductility = curve.ultimate / line.yield_displacement
        yield pushed.number, *at_yield, ratio, line.stiffness, curve.ultimate, ductility, *oscillator


TABLE = Table(
    name="capacity_line",
    title="Idealised capacity",
    place=14,
    stages=(Stage.PUSHOVER,),
    columns=(
        PUSH,
        Column(
            "yield_displacement",
            "yield\ndispl.",
            "L",
            "num",
            doc="of the control node at yield, from the static state",
        ),
        Column(
            "yield_shear",
            "yield\nshear",
            "F",
            "num",
            doc="largest base shear, without that of the static state",
        ),
        Column(
            "shear_ratio", "over\nweight", "-", "short", doc="yield shear over the weight of the building"
        ),
        Column("stiffness", "stiff-\nness", "F/L", "short", doc="yield shear over yield displacement"),
        Column(
            "displacement",
            "ultimate\ndispl.",
            "L",
            "num",
            doc="where 80 % of the yield shear is left, or the end of the curve, from the static state",
        ),
        Column("ductility", "ductility", "-", "short", doc="ultimate displacement over yield displacement"),
        Column("mass", "mass\nm*", "F*T^2/L", "num", doc="mass of the equivalent oscillator"),
        Column(
            "participation",
            "factor",
            "-",
            "short",
            doc="displacement of the control node over that of the oscillator",
        ),
        Column("period", "period\nT*", "T", "short", doc="period of the oscillator"),
    ),
    rows=rows,
    note=(
        "Elastic, perfectly plastic line of the same area as the curve up to its largest base shear "
        "(EN 1998-1:2004, B.3), and the oscillator of the N2 method that it stands for. The ultimate "
        "displacement is where the shear has fallen to 80 % of the largest, or the end of the curve. "
        "Displacements and shear count from the static state."
    ),
)
