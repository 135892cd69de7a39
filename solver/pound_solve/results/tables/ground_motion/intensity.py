"""Table ``intensity``."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table

if TYPE_CHECKING:
    from pound_solve.loading.motions.base import GroundMotion

TAKES_PART: Final = 1.0  #: percentage of the mass with which a mode moves with a direction [%]


def rows(run: RunRecord) -> Iterator[Row] | None:
    """One row for each motion in X or Y; no table without one."""
    motions = [(n, m) for n, m in enumerate(run.motions, 1) if m.direction != "R"]
    return _rows(run, motions) if motions else None


def _rows(run: RunRecord, motions: list[tuple[int, GroundMotion]]) -> Iterator[Row]:
    """Rows as of `rows`; equal motions, as a wave brings to several supports, are measured once."""
    from pound_solve.loading import intensity

    done: dict[tuple[float, ...], intensity.Intensity] = {}
    for n, m in motions:
        key = tuple(float(m.info[k]) for k in ("pga", "pgv", "pgd", "duration"))
        try:
            if key not in done:
                done[key] = intensity.intensity(m.acceleration, run.model.gravity)
            t1, sa = _first_mode(run, m)
        except ValueError:  # too long for a spectrum
            continue
        i = done[key]
        name = str(m.info.get("name") or m.info.get("kind") or "")
        yield (f"{n} {name}", m.direction, i.arias, i.d5_75, i.d5_95, i.cav, i.housner, t1, sa)


def _first_mode(run: RunRecord, motion: GroundMotion) -> tuple[float, float]:
    """Longest period of a mode with mass in the direction [T], pseudo-acceleration of 5 % damping there."""
    from pound_solve.loading.spectrum import pseudo_acceleration

    share = f"share_{motion.direction.lower()}"
    modal = getattr(run, "modal", None)  # only where the deck asks for it
    for mode in modal.modes if modal else ():
        if getattr(mode, share) >= TAKES_PART and 0.0 < mode.period < math.inf:
            return mode.period, float(pseudo_acceleration(motion.acceleration, mode.period)[0, 0])
    return math.nan, math.nan


TABLE = Table(
    name="intensity",
    title="Intensity of the ground motions",
    place=15,
    stages=(Stage.END,),
    columns=(
        Column("motion", doc="number and name of the ground motion"),
        Column("direction", "dir.", doc="direction of the motion"),
        Column("arias", "Arias", "L/T", "num", doc="Arias intensity"),
        Column("d5_75", "duration\n5-75 %", "T", "num", doc="time from 5 to 75 % of the Arias intensity"),
        Column("d5_95", "duration\n5-95 %", "T", "num", doc="time from 5 to 95 % of the Arias intensity"),
        Column("cav", "CAV", "L/T", "num", doc="cumulative absolute velocity"),
        Column("housner", "Housner", "L", "num", doc="spectrum intensity, 0.1 to 2.5 s, damping 5 %"),
        Column("t1", "T1", "T", "num", doc="period of the first mode with mass in the direction"),
        Column("sa_t1", "Sa(T1)", "L/T^2", "num", doc="pseudo-acceleration there, damping 5 %"),
    ),
    rows=rows,
    note=(
        "Measures of the whole motion, from start to end, scaled; its peaks stand in the table above. T1 "
        "is the period of the first mode of MODAL that has 1 % of the mass in the direction of the motion."
    ),
)
