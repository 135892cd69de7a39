"""Table ``diaphragms``."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pound_solve.results.columns import CONTACT
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table
from pound_solve.results.words import contact_name


def rows(run: RunRecord) -> Iterator[Row]:
    """Two rows for each contact, one a side."""
    nothing = (math.nan, math.nan)
    for i, m in run.diaphragm_collisions.items():
        name = contact_name(run.structure.model, run.structure.laws[i].element)
        alphas = (m.pair.alpha_lumped, m.pair.alpha_paper, m.pair.alpha) if m.pair else (nothing,) * 3
        for n, (side, d) in enumerate(zip("IJ", m.sides)):
            finite = [x if math.isfinite(x) else math.nan for x in (d.stiffness, d.impedance, d.period)]
            period = finite[2] or math.nan
            yield name, side, d.mass, finite[0], finite[1], period, *(a[n] for a in alphas)


def remark(run: RunRecord) -> str | None:
    """Explain the influence coefficients where there are any."""
    if not any(x.pair for x in run.diaphragm_collisions.values()):
        return None
    return "An elastic collision changes a diaphragm's velocity by 2 alpha times the approach velocity."


TABLE = Table(
    name="diaphragms",
    title="Colliding diaphragms",
    place=100,
    stages=(Stage.INPUT,),
    columns=(
        CONTACT,
        Column("side", doc="`I` or `J`: node of the contact that the diaphragm is behind"),
        Column("mass", "mass m", "F*T^2/L", "short", doc="total mass; infinite for a wall"),
        Column("stiffness", "stiffness\nkD", "F/L", "short", doc="axial stiffness; NaN for a rigid one"),
        Column("impedance", "impedance\nZ", "F*T/L", "short", doc="sqrt(kD m); NaN for a rigid one"),
        Column(
            "period",
            "collision\nperiod T",
            "T",
            "short",
            doc="2 sqrt(m / kD); NaN for a rigid one or a wall",
        ),
        Column(
            "alpha_lumped",
            "alpha\nlumped",
            "-",
            "short",
            doc=(
                "influence coefficient of lumped masses: the change of velocity over "
                "twice the approach velocity, of an elastic collision"
            ),
        ),
        Column(
            "alpha_paper",
            "alpha\npaper",
            "-",
            "short",
            doc="influence coefficient of distributed masses, Cole et al. 2011",
        ),
        Column(
            "alpha_exact",
            "alpha\nexact",
            "-",
            "short",
            doc="influence coefficient of distributed masses, exact",
        ),
    ),
    rows=rows,
    remark=remark,
    note="Found behind the nodes of the contact, or given by DIAPHRAGMS on its card.",
)
