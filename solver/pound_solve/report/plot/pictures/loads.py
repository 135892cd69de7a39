"""Picture `loads`: the static loads on nodes and members, with their values."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.plot import geometry, labels, style
from pound_solve.report.plot.members import member_loads
from pound_solve.report.plot.schema import Choice, Nothing, Picture
from pound_solve.results import Results

LONG, SHORT = 0.07, 0.035  #: arrows of point loads and of line loads, as fractions of the structure's size
ARROWS = 7  #: of a line load on one member


def loads(results: Results, choice: Choice) -> Any:
    """Draw the structure with an arrow for each point load, a comb for each line load, and its value."""
    s = geometry.DrawnStructure(results, geometry.apart())
    figure = style.figure(*s.shape(), title=results.title)
    axes = figure.add_subplot()
    s.frame(axes, room=0.12)
    s.draw(axes, color="0.6", linewidth=1.2)
    s.draw_supports(axes)
    drawn = list(arrows_of_loads(results, s))
    if not drawn:
        raise Nothing("static loads")
    arrows = [arrow for tails, heads, _ in drawn for arrow in zip(tails, heads)]
    tails, heads = np.array(arrows).swapaxes(0, 1)
    axes.plot(*geometry.broken_line(zip(tails, heads)), color=style.RED, linestyle="-", linewidth=0.7)
    for tail, head in zip(tails, heads):
        look = {"arrowstyle": "-|>", "color": style.RED, "linewidth": 0.7, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", head, tail, arrowprops={**look, "mutation_scale": 6})
    for tails, _, text in drawn:
        if len(tails) > 1:
            axes.plot(*np.transpose(tails), color=style.RED, linestyle="-", linewidth=0.7)
        labels.label(axes, tails[len(tails) // 2], text, far=True, color=style.RED)
    axes.set_title("static loads; masses and the motion of the ground are not among them")
    return figure


def arrows_of_loads(results: Results, s: geometry.DrawnStructure) -> Iterator[tuple[Array, Array, str]]:
    """Tails and heads of the arrows of each load, shape (n, 2) [L], and its value as text."""
    units = results.units
    for row in results.table("loads") if "loads" in results.tables else ():
        force, head = np.array([row["fx"], row["fy"]]), s.place[int(row["node"])]
        moment = f"moment {row['mz']:.5g} {units.text('F*L')}" if row["mz"] else ""
        if force.any():
            way = LONG * s.size * force / np.hypot(*force)
            value = f"{np.hypot(*force):.5g} {units.force}"
            yield (head - way)[None], head[None], "\n".join(filter(None, [value, moment]))
        elif moment:
            yield head[None], head[None], moment
    ends = {int(e["element"]): (s.place[int(e["i"])], s.place[int(e["j"])]) for e in s.elements if e["j"]}
    for element, load in member_loads(results):
        i, j = ends[element]
        point, line = (np.array([load.get(f"{kind}X", 0.0), load.get(f"{kind}Y", 0.0)]) for kind in "PW")
        for x, force, unit, length in (
            (np.array([load.get("AT", 0.0)]), point, "F", LONG),
            (np.linspace(0.0, 1.0, ARROWS), line, "F/L", SHORT),
        ):
            size = float(np.hypot(*force))
            if size:
                heads = i + x[:, None] * (j - i)
                yield heads - length * s.size * force / size, heads, f"{size:.5g} {units.text(unit)}"


SPEC = Picture(
    name="loads",
    place=25,
    shows="the static loads on nodes and members with their values",
    needs=("nodes", "elements"),
    draw=loads,
)
