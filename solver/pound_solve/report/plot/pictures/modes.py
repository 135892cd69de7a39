"""Picture `modes`: mode shapes beside each other."""

from __future__ import annotations

from typing import Any

from pound_solve.report.plot import geometry, style
from pound_solve.report.plot.schema import Choice, Picture
from pound_solve.results import Results

MOST = 8  #: modes


def modes(results: Results, choice: Choice) -> Any:
    """Draw the first mode shapes with their periods."""
    s = geometry.DrawnStructure(results, geometry.apart(2.0 * geometry.SHARE))
    shapes = results.table("mode_shapes")
    periods = {int(m["mode"]): float(m["period"]) for m in results.table("modes")}
    numbers = list(dict.fromkeys(int(n) for n in shapes["mode"]))[:MOST]
    width, height = s.shape()
    figure, all_axes = style.panels(
        len(numbers), "Mode shapes", (max(2.5, 0.45 * width), max(2.0, 0.45 * height))
    )
    for axes, number in zip(all_axes, numbers):
        shape = shapes[shapes["mode"] == number]
        s.frame(axes, 0.06 + geometry.SHARE)
        s.draw(axes, color="0.8", linewidth=0.8)
        s.draw(axes, geometry.mode_shift(shape, s.size), color=style.BLUE, linewidth=1.2)
        s.draw_supports(axes)
        axes.set_title(f"mode {number}, period {periods[number]:.4g} {s.units.time}")
        axes.locator_params(nbins=4)
    return figure


SPEC = Picture(
    name="modes",
    place=30,
    shows="mode shapes with their periods, drawn to one size",
    needs=("modes", "mode_shapes", "nodes", "elements"),
    draw=modes,
)
