"""Response spectra as a table for the terminal and as CSV."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from pound_deck.model import Units
from pound_solve.loading.piecewise import Piecewise
from pound_solve.loading.spectrum import Spectrum
from pound_solve.report.export import export_rows
from pound_solve.report.text import block
from pound_solve.results.schema import Column, Row, Sheet


class SpectrumCurve(NamedTuple):
    """The spectrum of one motion.

    Attributes
    ----------
    name : str
    acceleration : Piecewise, [L/T^2]
    spectrum : Spectrum
    """

    name: str
    acceleration: Piecewise
    spectrum: Spectrum


def rows(curves: Sequence[SpectrumCurve]) -> Iterator[Row]:
    """One row for each period, damping after damping, motion after motion."""
    for curve in curves:
        s = curve.spectrum
        for i, xi in enumerate(s.damping):
            every = (x[i].tolist() for x in (s.sd, s.sv, s.psv, s.psa, s.sa))
            for values in zip(s.periods.tolist(), *every):
                yield curve.name, 100.0 * float(xi), *values


def text(units: Units, curves: Sequence[SpectrumCurve]) -> str:
    """Tables of all curves, each headed by the name, the peak acceleration and the damping."""
    lines = []
    for curve in curves:
        spectrum = np.array(list(rows([curve])), dtype=TABLE.kinds)
        t, peak = curve.acceleration.peak()
        head = (
            f"{curve.name}: peak acceleration {abs(peak):.4g} {units.text('L/T^2')} at {t:.6g} {units.time}"
        )
        for one in np.split(spectrum, len(curve.spectrum.damping)):
            columns = one[[c.name for c in TABLE.columns[2:]]]
            lines += [f"{head}; damping {one['damping'][0]:g} %", "", *block(units, TABLE, columns), "", ""]
    return "\n".join(line.rstrip() for line in lines).rstrip()


def write_csv(path: Path, units: Units, curves: Sequence[SpectrumCurve]) -> None:
    """Write all curves with all digits into one file, in the rows of `rows`.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    export_rows(path, units, TABLE, rows(curves))


TABLE = Sheet(
    columns=(
        Column("motion", doc="what moves the oscillators"),
        Column("damping", "damping", "%", "percent", doc="ratio to critical damping"),
        Column("period", "period", "T", "num", doc="undamped period of the oscillator"),
        Column("sd", "SD", "L", "num", doc="largest relative displacement"),
        Column("sv", "SV", "L/T", "num", doc="largest relative velocity"),
        Column("psv", "PSV", "L/T", "num", doc="pseudo-velocity: SD times the circular frequency"),
        Column("psa", "PSA", "L/T^2", "num", doc="pseudo-acceleration: PSV times the circular frequency"),
        Column("sa", "SA", "L/T^2", "num", doc="largest absolute acceleration"),
    )
)
