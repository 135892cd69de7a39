"""Picture `hinges`: how far springs and hinges have yielded, and the damage that it stands for."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_solve.report.plot import style
from pound_solve.report.plot.geometry import DrawnStructure, apart
from pound_solve.report.plot.schema import Choice, Nothing, Picture
from pound_solve.results import Results
from pound_solve.results.tables.summary.worst_hinges import STATES

#: colours from sound to failed
COLOURS = ("#ffffff", "#ffe08a", "#f5a742", "#d9541e", "#7a0f0f")
DUCTILITY = (
    (6.0, "above 6"),
    (4.0, "4 to 6"),
    (2.0, "2 to 4"),
    (1.0, "1 to 2"),
    (-math.inf, "not yielded"),
)


def hinges(results: Results, choice: Choice) -> Any:
    """Draw the structure with a disc at each spring and hinge, coloured by ductility and by damage."""
    s = DrawnStructure(results, apart())
    panels = [("ductility\n(largest deformation over yield)", "ductility", results.table("spring_envelope"),
               DUCTILITY)]  # fmt: skip
    if results.holds("damage"):
        damage = results.table("damage")
        panels.append(("damage index\nof Park and Ang", "index", damage[damage["element"] > 0], STATES))
    if not any(np.isfinite(rows[column]).any() for _, column, rows, _ in panels):
        raise Nothing("springs and hinges that can yield")
    width, height = s.shape()
    scale = min(1.0, 6.0 / width)
    figure = style.figure(
        (width * scale + 1.3) * len(panels), max(2.4, height * scale) + 0.5, "Springs and hinges"
    )
    for n, (title, column, rows, classes) in enumerate(panels):
        axes = figure.add_subplot(1, len(panels), n + 1)
        panel(axes, s, rows, column, classes)
        axes.set_title(title)
    return figure


def panel(
    axes: Any, s: DrawnStructure, rows: NDArray[Any], column: str, classes: tuple[tuple[float, str], ...]
) -> None:
    """Draw the discs of one column in the colours of its classes; where several coincide, the worst."""
    s.frame(axes)
    s.draw(axes, color="0.6", linewidth=1.0)
    s.draw_supports(axes)
    worst: dict[tuple[float, float], float] = {}
    for row in rows[np.isfinite(rows[column])]:
        at = s.component(int(row["element"]), str(row["component"]))
        key = (float(at[0]), float(at[1]))
        worst[key] = max(worst.get(key, -math.inf), float(row[column]))
    for n, (_, word) in enumerate(reversed(classes)):
        points = [at for at, value in worst.items() if state(value, classes) == word]
        if points:
            look = {"markersize": 6, "markeredgecolor": "0.2", "markeredgewidth": 0.6, "zorder": 3 + n}
            axes.plot(*np.transpose(points), "o", color=COLOURS[n], **look)
    named = [(COLOURS[n], word) for n, (_, word) in enumerate(reversed(classes))]
    style.legend(axes, style.patches(named))


def state(value: float, classes: tuple[tuple[float, str], ...]) -> str:
    """Word for a value: that of the highest limit that it reaches, or for ductility exceeds."""
    reached = (word for least, word in classes if value > least or (value == least and classes is STATES))
    return next(reached, classes[-1][1])


SPEC = Picture(
    name="hinges",
    place=140,
    shows="the map of springs and hinges, coloured by their ductility, and by their damage if it is known",
    needs=("spring_envelope", "nodes", "elements"),
    draw=hinges,
)
