"""Table ``mode_buildings``."""

from __future__ import annotations

from collections.abc import Sequence

from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table


def rows(run: RunRecord) -> Sequence[Row] | None:
    """One row for each mode and each building that moves in it; none where there is one building."""
    shares = run.modal.shares
    return shares if len({share.building for share in shares}) > 1 else None


TABLE = Table(
    name="mode_buildings",
    title="Buildings of the modes",
    place=15,
    stages=(Stage.MODAL,),
    columns=(
        Column("mode", fmt="int", doc="number of the mode"),
        Column("building", doc="name of a building that moves in it"),
        Column("kinetic", "kinetic\nenergy", "%", "percent", doc="its share of the mode's kinetic energy"),
    ),
    rows=rows,
    note="Shares below 0.1 % are left out. With open contacts buildings vibrate apart: only modes of equal "
    "periods are then shared.",
)
