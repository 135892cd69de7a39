"""Table ``push_spectra``."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

import numpy as np

from pound_solve.results.columns import PUSH
from pound_solve.results.record import RunRecord
from pound_solve.results.schema import Column, Row, Stage, Table

#: periods over that of the equivalent oscillator
PERIODS: Final = tuple(2.0 ** (n / 16.0) for n in range(-48, 33))


def rows(run: RunRecord) -> Iterator[Row]:
    """One row for each period and each row of the table ``performance`` whose curve has a line."""
    from pound_solve.analyses.capacity_line import CapacityCurve, demands  # not needed to read a report

    for pushed in run.pushovers:
        curve = CapacityCurve(pushed.curve)
        if not (line := curve.line(curve.strongest)):
            continue
        for system, name, spectrum in demands(pushed, run.motions):
            periods = line.period(system) * np.array(PERIODS)
            for period, acceleration in zip(periods.tolist(), spectrum(periods).tolist()):
                displacement = acceleration * (period / (2.0 * math.pi)) ** 2
                yield pushed.number, name, period, displacement, acceleration


TABLE = Table(
    name="push_spectra",
    title="Spectra of the performance points",
    place=50,
    stages=(Stage.PUSHOVER,),
    columns=(
        PUSH,
        Column("motion", doc="number and name of the ground motion"),
        Column("period", "period", "T", "short", doc="of the elastic oscillator"),
        Column(
            "displacement",
            "spectral\ndispl.",
            "L",
            "num",
            doc="largest displacement, relative to the ground",
        ),
        Column("acceleration", "spectral\naccel.", "L/T^2", "num", doc="pseudo-acceleration"),
    ),
    rows=rows,
    group="push",
    note="From an eighth of the period T* of the equivalent oscillator to four times that.",
    limit=81,
)
