"""Picture `frame`: the structure with its node numbers, supports, masses and contacts."""

from __future__ import annotations

from typing import Any

import numpy as np

from pound_solve.report.plot import geometry, labels, style
from pound_solve.report.plot.schema import Choice, Picture
from pound_solve.results import Results


def frame(results: Results, choice: Choice) -> Any:
    """Draw the structure as it stands."""
    s = geometry.DrawnStructure(results, geometry.apart())
    figure = style.figure(*s.shape(), title=results.title)
    axes = figure.add_subplot()
    panel(axes, s, 500.0, gaps=True)
    hinges = [
        s.component(int(row["element"]), str(row["component"]))
        for row in (results.table("springs") if "springs" in results.tables else ())
        if str(row["component"]).startswith("hinge")
    ]
    if hinges:
        look = {"markersize": 3.5, "markerfacecolor": "white", "markeredgewidth": 0.7, "zorder": 3}
        axes.plot(*np.transpose(hinges), "o", color=style.BLUE, **look)
    for node, xy in s.place.items():
        labels.label(axes, xy, str(node), fontsize=6)
    axes.set_title(f"triangles: supports; dots: masses;{' rings: hinges;' if hinges else ''} red: contacts")
    return figure


def panel(axes: Any, s: geometry.DrawnStructure, width: float, gaps: bool = False) -> None:
    """Draw members, supports, masses and contacts with their names, and their `gaps` if asked, about as
    wide as so many points.
    """
    s.frame(axes)
    s.draw(axes, color=style.BLUE, linewidth=1.4)
    s.draw_supports(axes)
    s.draw_masses(axes, width)
    s.draw_contacts(axes)
    for c in s.contacts:
        i = s.place[c.i]
        above = (i + s.place[c.j]) / 2 if c.j else i + geometry.WALL * s.size * np.array([c.along[0], 1.0])
        text = f"{c.name}\n{'gap' if c.gap >= 0 else 'overlap'} {abs(c.gap):.4g} {s.units.length}"
        labels.label(axes, above, text if gaps else c.name, far=True, color=style.RED, fontsize=7)


SPEC = Picture(
    name="frame",
    place=20,
    shows="the structure: nodes with numbers, supports, masses, members, contacts",
    needs=("nodes", "elements"),
    draw=frame,
)
