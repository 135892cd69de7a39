"""Picture `energy`: the parts of the energy over time."""

from __future__ import annotations

from typing import Any

from pound_solve.report.plot import style
from pound_solve.report.plot.schema import Choice, Picture
from pound_solve.results import Results
from pound_solve.results.histories.energy import ENERGIES

COLOURS = {
    "kinetic": "#9dc3e6", "strain": "#c9b3e0", "damping": "#f2c48d", "hysteretic": "#e39a8b",
    "contact": "#a9cf9f",
}  # fmt: skip


def energy(results: Results, choice: Choice) -> Any:
    """Draw the energies stacked over time, with the total of initial energy and work put in."""
    rows = choice.span(results)
    values = results.history("energy")
    by_name = dict(zip(ENERGIES, values.T))
    figure = style.figure(8.5, 4.2, "Energy")
    axes = style.grid(
        figure.add_subplot(), f"time [{results.units.time}]", f"energy [{results.units.text('F*L')}]"
    )
    parts = [by_name[p][rows] for p in COLOURS]
    axes.stackplot(results.time[rows], *parts, labels=list(COLOURS), colors=list(COLOURS.values()))
    there = sum(by_name[p][0] for p in COLOURS)  # strain under gravity, motion of INITIAL
    label = "input" if there == 0.0 else "at the start, plus input"
    axes.plot(
        results.time[rows], (there + by_name["input"])[rows], "-", color="0.1", linewidth=1.2, label=label
    )
    style.legend(axes)
    return figure


SPEC = Picture(
    name="energy",
    place=130,
    shows="the parts of the energy over time, piled up, and the energy put in",
    needs=("energy",),
    draw=energy,
    options=("between",),
)
