"""Picture `histories`: ground motions, drifts and contact forces over time."""

from __future__ import annotations

from typing import Any

from pound_solve.report.plot import courses, style
from pound_solve.report.plot.schema import Choice, Nothing, Picture
from pound_solve.results import Results


def histories(results: Results, choice: Choice) -> Any:
    """Draw those of the three that the file has, below each other."""
    wanted = [h for h in courses.QUANTITY if h in results.histories]
    if not wanted:
        raise Nothing("ground motions, no drifts, no contacts")
    figure = style.figure(9.5, 2.4 * len(wanted) + 0.5, results.title)
    first = None
    for n, name in enumerate(wanted):
        axes = figure.add_subplot(len(wanted), 1, n + 1, sharex=first)
        first = first or axes
        courses.panel(axes, results, name, choice, n == len(wanted) - 1)
    return figure


SPEC = Picture(
    name="histories",
    place=80,
    shows="ground accelerations, drifts and contact forces over time",
    needs=("time",),
    draw=histories,
    options=("between",),
)
