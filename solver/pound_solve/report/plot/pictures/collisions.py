"""Picture `collisions`: the times of all collisions and their peak forces."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_solve.numerics.types import Array
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
    column, when, size = peaks(results)
    style.grid(top, "", size)
    style.grid(bottom, f"time [{results.units.time}]")
    end = results.last_time
    for n, name in enumerate(names):
        colour = style.stroke(n)["color"]
        closures = courses.of_contact(results, name, choice)
        start, last = times_closed(results, closures)
        if len(closures):
            top.vlines(closures[when], 0.0, closures[column], color=colour, linewidth=0.9)
            top.plot(closures[when], closures[column], "o", color=colour, label=style.short(name))
        # a collision is short: no bar is thinner than a line
        width = np.maximum(last - start, 0.002 * end)
        bottom.barh(np.full(len(closures), n), width, left=start, color=colour, height=0.6)
    top.set_xlim(*(choice.between or (results.time[0], end)))
    top.set_ylim(bottom=0.0)
    style.legend(top)
    bottom.set_yticks(range(len(names)), [style.short(name) for name in names])
    bottom.set_ylim(-0.6, len(names) - 0.4)
    bottom.set_title("times at which each contact was closed")
    return figure


def peaks(results: Results) -> tuple[str, str, str]:
    """Columns of the size of collisions and of its time, and the name of its axis."""
    if np.isnan(results.table("collisions")["peak_force"]).all():
        return "impulse", "t_start", f"impulse [{results.units.text('F*T')}]"
    return "peak_force", "t_peak", f"peak force [{results.units.force}]"


def times_closed(results: Results, collisions: NDArray[Any]) -> tuple[Array, Array]:
    """Start and end of some collisions; one that has not ended lasts until the end of the run."""
    end = np.where(np.isnan(collisions["t_end"]), results.last_time, collisions["t_end"])
    return collisions["t_start"], end


SPEC = Picture(
    name="collisions",
    place=110,
    shows="the peak force of each collision, and the times at which each contact was closed",
    needs=("collisions", "contact/force"),
    draw=collisions,
    options=("between",),
)
