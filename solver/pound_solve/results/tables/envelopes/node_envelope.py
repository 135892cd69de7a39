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
    sample=(
        (100, "X", "displacement", "m", 0.0441895, 8.43, -0.0320122, 4.376),
        (100, "R", "displacement", "rad", 0.0222787, 7.222, -0.0438121, 4.566),
        (100, "X", "velocity", "m/s", 0.056897, 3.362, -0.633446, 1.954),
        (100, "R", "velocity", "rad/s", 0.0831932, 4.424, -0.855209, 6.884),
        (100, "X", "acceleration", "m/s^2", 7.81537, 8.806, -1.50711, 8.292),
        (100, "R", "acceleration", "rad/s^2", 14.6261, 5.894, -10.5087, 9.966),
        (101, "X", "displacement", "m", 0.0876692, 3.312, -0.0344282, 3.32),
        (101, "R", "displacement", "rad", 0.00957057, 7.282, -0.00169641, 4.386),
        (101, "X", "velocity", "m/s", 0.428748, 6.984, -0.62032, 6.278),
        (101, "R", "velocity", "rad/s", 0.914363, 7.538, -1.47974, 5.036),
        (101, "X", "acceleration", "m/s^2", 30.5748, 1.988, -15.0083, 3.554),
        (101, "R", "acceleration", "rad/s^2", 10.0887, 3.818, -4.17741, 9.746),
    ),
)
