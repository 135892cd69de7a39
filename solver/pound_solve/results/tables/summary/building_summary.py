"""Table ``building_summary``."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pound_solve.results.columns import BUILDING, time_column
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table

NONE = (math.nan, math.nan)
MOST_OF_IT = 50.0  #: least share of a building in the kinetic energy of a mode of its own [%]


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each building."""
    from pound_solve.structure.buildings import buildings  # not needed to read a report

    shears, drifts = _shears(run), _drifts(run)
    for b in buildings(run.structure):
        weight = b.mass * run.model.gravity
        shear, t_shear = shears.get(b.name, NONE)
        ratio = shear / weight if weight else math.nan
        drift = drifts.get(b.name, (math.nan, 0, math.nan))
        yield b.name, len(b.floors), *_mode(run, b.name, b.mass), weight, shear, t_shear, ratio, *drift


def _mode(run: RunRecord, building: str, mass: float) -> tuple[float, float]:
    """Period of the lowest mode in which mostly this building moves, and its effective mass along x as a
    percentage of the building's; NaN without a modal analysis.
    """
    if not hasattr(run, "modal"):
        return NONE
    modes = [s.mode for s in run.modal.shares if s.building == building and s.kinetic > MOST_OF_IT]
    mode = next((m for m in run.modal.modes if m.number == min(modes, default=0)), None)
    return (mode.period, 100.0 * mode.mass_x / mass) if mode and math.isfinite(mode.period) else NONE


def _shears(run: RunRecord) -> dict[str, tuple[float, float]]:
    """Largest absolute base shear of each building and its time; empty before the history."""
    if not run.responded:
        return {}
    largest = run.history.recorder.envelopes.sums["base"].largest()
    return {b.name: largest[3 * n] for n, b in enumerate(run.history.items.buildings)}


def _drifts(run: RunRecord) -> dict[str, tuple[float, int, float]]:
    """Largest drift ratio of each building as a percentage, its storey, and its time."""
    drifts = sorted(run.history.storey_drifts(), key=lambda d: d.ratio) if run.responded else []
    return {d.building: (100.0 * d.ratio, d.storey, d.t) for d in drifts}


TABLE = Table(
    name="building_summary",
    title="Buildings: periods, base shears, drifts",
    place=20,
    stages=(Stage.INPUT, Stage.MODAL, Stage.PEAKS),
    columns=(
        BUILDING,
        Column("storeys", fmt="int", doc="number of storeys"),
        Column(
            "period",
            "first\nperiod",
            "T",
            "short",
            doc="of the lowest mode of this building, NaN without MODAL",
        ),
        Column(
            "modal_mass",
            "effective\nmass",
            "%",
            "short",
            doc="effective mass of that mode along x over the building's mass",
        ),
        Column("weight", "weight", "F", "num", doc="mass times gravity"),
        Column("shear", "base\nshear", "F", "num", doc="largest absolute shear at the base"),
        time_column("t_shear", "at time", "time of the largest base shear"),
        Column("shear_ratio", "over\nweight", "-", "short", doc="largest base shear over the weight"),
        Column("drift", "storey\ndrift", "%", "short", doc="largest absolute drift ratio of its storeys"),
        Column(
            "drift_storey",
            "in\nstorey",
            fmt="int",
            doc="storey of the largest drift ratio, 0 for none",
            zero="-",
        ),
        time_column("t_drift", "at time", "time of the largest drift ratio"),
    ),
    rows=rows,
    note="The mode is the lowest in which the building has more than half of the kinetic energy.",
)
