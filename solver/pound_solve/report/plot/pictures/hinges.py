"""Picture `hinges`: how far springs and hinges have yielded, and the damage that it stands for."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

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


class HingeMap(NamedTuple):
    """One map of springs and hinges.

    Attributes
    ----------
    title : str
    column : str
        Of the `rows`, which all have a value there.
    rows : ndarray, shape (n,)
        Of ``spring_envelope`` or ``damage``.
    classes : tuple of (float, str)
        Least value and word of each class, from the worst.
    """

    title: str
    column: str
    rows: NDArray[Any]
    classes: tuple[tuple[float, str], ...]


def hinges(results: Results, choice: Choice) -> Any:
    """Draw the structure with a disc at each spring and hinge, coloured by ductility and by damage."""
    s = DrawnStructure(results, apart())
    panels = maps(results)
    if not any(len(shown.rows) for shown in panels):
        raise Nothing("springs and hinges that can yield")
    width, height = s.shape()
    scale = min(1.0, 6.0 / width)
    figure = style.figure(
        (width * scale + 1.3) * len(panels), max(2.4, height * scale) + 0.5, "Springs and hinges"
    )
    for n, shown in enumerate(panels):
        axes = figure.add_subplot(1, len(panels), n + 1)
        panel(axes, s, shown)
        axes.set_title(shown.title)
    return figure


def maps(results: Results) -> list[HingeMap]:
    """The map of ductility, and that of damage if it is known."""
    tables = [
        ("ductility\n(largest deformation over yield)", "ductility", "spring_envelope", DUCTILITY),
        ("damage index\nof Park and Ang", "index", "damage", STATES),
    ]
    shown = []
    for title, column, name, classes in tables:
        if results.holds(name):
            rows = results.table(name)  # the damage of element 0 is that of the whole structure
            rows = rows[np.isfinite(rows[column]) & (rows["element"] > 0)]
            shown.append(HingeMap(title, column, rows, classes))
    return shown


def panel(axes: Any, s: DrawnStructure, shown: HingeMap) -> None:
    """Draw the discs of one map in the colours of its classes; where several coincide, the worst."""
    column, classes = shown.column, shown.classes
    s.frame(axes)
    s.draw(axes, color="0.6", linewidth=1.0)
    s.draw_supports(axes)
    worst: dict[tuple[float, float], float] = {}
    for row in shown.rows:
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
