"""Picture of response spectra: pseudo-acceleration and displacement over the period."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from pound_deck.model import Units
from pound_solve.report.plot import style
from pound_solve.report.spectrum import SpectrumCurve

STROKES: Final = ("-", "--", ":", "-.")  #: one for each damping


def spectra(curves: Sequence[SpectrumCurve], units: Units, path: Path) -> None:
    """Draw all curves into a file, whose ending names the format: a colour for each motion, a stroke for
    each damping.

    Raises
    ------
    ImportError
        matplotlib is not installed.
    OSError
        The file cannot be written.
    """
    with style.sheet():
        figure = style.figure(9.5, 4.2)
        for n, (quantity, unit) in enumerate((("PSA", "L/T^2"), ("SD", "L"))):
            axes = style.grid(
                figure.add_subplot(1, 2, n + 1),
                f"period [{units.time}]",
                f"{quantity} [{units.text(unit)}]",
            )
            _panel(axes, curves, quantity)
        named = axes.get_legend_handles_labels()
        figure.legend(*named, loc="outside lower left")
        style.save(figure, path)


def _panel(axes: Any, curves: Sequence[SpectrumCurve], quantity: str) -> None:
    """Draw one quantity of all curves; a single damping leaves the strokes to the motions."""
    several = any(len(curve.spectrum.damping) > 1 for curve in curves)
    for k, curve in enumerate(curves):
        spectrum = curve.spectrum
        for i, values in enumerate(getattr(spectrum, quantity.lower())):
            look = style.stroke(k)
            if several:
                look["linestyle"] = STROKES[i % len(STROKES)]
            name = f"{curve.name}, {100.0 * spectrum.damping[i]:g} %" if several else curve.name
            axes.semilogx(spectrum.periods, values, **look, label=name)
    axes.set_ylim(bottom=0.0)
