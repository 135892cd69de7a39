"""Picture `collisions`: the times of all collisions and their peak forces."""

from __future__ import annotations

from typing import Any

import numpy as np

from pound_solve.report.plot import courses, style
from pound_solve.report.plot.schema import Choice, Picture
from pound_solve.results import Results


def collisions(results: Results, choice: Choice) -> Any:
    """Draw a line for the peak of each collision, and below a bar for its time.

    Instantaneous impacts have no force: if all are instantaneous, the lines are their impulses.
    """
    names = list(results.labels("contact/force"))
    figure = style.figure(9.5, 0.3 * len(names) + 3.4, "Collisions")
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(3.0, 0.3 * len(names) + 0.5))
    table = results.table("collisions")
    impacts = bool(np.isnan(table["peak_force"]).all())
    column, when = ("impulse", "t_start") if impacts else ("peak_force", "t_peak")
    unit = results.units.text("F*T") if impacts else results.units.force
    style.grid(top, "", f"{'impulse' if impacts else 'peak force'} [{unit}]")
    style.grid(bottom, f"time [{results.units.time}]")
    end = results.last_time
    for n, name in enumerate(names):
        colour = style.stroke(n)["color"]
        closures = courses.of_contact(results, name, choice)
        last = np.where(np.isnan(closures["t_end"]), end, closures["t_end"])
        if len(closures):
            top.vlines(closures[when], 0.0, closures[column], color=colour, linewidth=0.9)
            top.plot(closures[when], closures[column], "o", color=colour, label=style.short(name))
        # a collision is short: no bar is thinner than a line
        width = np.maximum(last - closures["t_start"], 0.002 * end)
        bottom.barh(np.full(len(closures), n), width, left=closures["t_start"], color=colour, height=0.6)
    top.set_xlim(*(choice.between or (results.time[0], end)))
    top.set_ylim(bottom=0.0)
    style.legend(top)
    bottom.set_yticks(range(len(names)), [style.short(name) for name in names])
    bottom.set_ylim(-0.6, len(names) - 0.4)
    bottom.set_title("times at which each contact was closed")
    return figure


SPEC = Picture(
    name="collisions",
    place=110,
    shows="the peak force of each collision, and the times at which each contact was closed",
    needs=("collisions", "contact/force"),
    draw=collisions,
    options=("between",),
)
