"""Picture `deformed`: the displaced structure, magnified."""

from __future__ import annotations

from typing import Any

import numpy as np

from pound_solve.report.plot import geometry, style
from pound_solve.report.plot.moments import moment
from pound_solve.report.plot.schema import Choice, Picture
from pound_solve.results import Results

TITLE_WIDTH = 12  #: characters in an inch of a picture's width


def deformed(results: Results, choice: Choice) -> Any:
    """Draw the displacements at an instant, by default that of the largest one."""
    displaced = geometry.displacements(results)
    s = displaced.structure
    if choice.at_instant:
        chosen = moment(results, "node/u", choice)
        opened = moment(results, geometry.HINGES, choice).row if displaced.hinges else np.zeros(0)
        when, moved = chosen.title, displaced.magnified(chosen.row, opened)
    else:
        when = f"when they are largest, at {results.time[displaced.row]:.4g} {s.units.time}"
        moved = displaced.shift(displaced.row)
    figure = style.figure(*s.shape(), title=f"Displacements {when}")
    axes = figure.add_subplot()
    s.frame(axes, 0.06 + geometry.SHARE)
    s.draw(axes, color="0.8", linewidth=0.8)
    s.draw(axes, moved, color=style.BLUE, linewidth=1.3)
    s.draw_contacts(axes, moved)
    s.draw_supports(axes)
    title = f"displacements and gaps {displaced.factor:.3g} times as large; grey: at rest; red: contacts"
    axes.set_title(style.wrapped(title, int(TITLE_WIDTH * s.shape()[0])))
    return figure


SPEC = Picture(
    name="deformed",
    place=40,
    shows="the displaced structure at an instant (the largest displacements), magnified",
    needs=("node/u", "nodes", "elements"),
    draw=deformed,
    options=("time", "at_peak"),
)
