"""Table ``modes``."""

from __future__ import annotations

from collections.abc import Sequence

from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Sequence[Row]:
    """One row for each mode."""
    return run.modal.modes


def remark(run: RunRecord) -> str:
    """State what springs and contacts do in the vibration."""
    if run.modal.loaded:
        return "Springs and contacts are as the static state leaves them."
    return "Contacts are open in the free vibration."


TABLE = Table(
    name="modes",
    title="Natural modes",
    place=10,
    stages=(Stage.MODAL,),
    columns=(
        Column("mode", fmt="int", doc="number, lowest frequency first"),
        Column("omega", "circular\nfrequency", "rad/T", "num", doc="circular frequency"),
        Column("frequency", "frequency", "1/T", "num", doc="cycles per unit of time"),
        Column("period", "period", "T", "num", doc="period"),
        Column("damping", "damping", "%", "percent", doc="fraction of critical damping"),
        Column("gamma_x", "particip.\nX", fmt="num", doc="participation factor, ground motion in X"),
        Column("mass_x", "eff. mass\nX", "F*T^2/L", "num", doc="effective mass in X"),
        Column("share_x", "share\nX", "%", "percent", doc="effective mass over the moving mass in X"),
        Column("gamma_y", "particip.\nY", fmt="num", doc="participation factor, ground motion in Y"),
        Column("mass_y", "eff. mass\nY", "F*T^2/L", "num", doc="effective mass in Y"),
        Column("share_y", "share\nY", "%", "percent", doc="effective mass over the moving mass in Y"),
    ),
    rows=rows,
    remark=remark,
    note=(
        "Participation factors belong to modes of unit modal mass: their squares are the effective masses."
    ),
)
