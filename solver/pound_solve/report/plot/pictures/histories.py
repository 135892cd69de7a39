"""Picture `histories`: ground motions, drifts and contact forces over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pound_solve.report.plot import courses, style
from pound_solve.report.plot.overlay import TimePanel, over_time, units_of_largest
from pound_solve.report.plot.schema import Choice, Nothing, Picture
from pound_solve.results import Results

#: panels of each history where runs are drawn over each other
MOST_OVERLAID = {"ground": 1, "drift": 3, "contact/force": 2}


def histories(results: Results, choice: Choice) -> Any:
    """Draw those of the three that the file has, below each other."""
    wanted = [h for h in courses.QUANTITY if h in results.histories]
    if not wanted:
        raise Nothing("ground motions, no drifts, no contacts")
    figure = style.figure(9.5, 2.4 * len(wanted) + 0.5, results.title)
    for axes, name in zip(style.stacked(figure, len(wanted)), wanted):
        courses.panel(axes, results, name, choice, name == wanted[-1])
    return figure


def overlay(runs: Sequence[Results], choice: Choice) -> Any:
    """Draw the largest ground motion, drifts and contact forces of any run, a panel each, with a curve for
    each run.
    """
    panels = [
        TimePanel(history, label, courses.QUANTITY[history][0], unit)
        for history, most in MOST_OVERLAID.items()
        for label, unit in units_of_largest(runs, history, most).items()
    ]
    if not panels:
        raise Nothing("ground motions, no drifts, no contacts")
    return over_time(runs, panels, choice)


SPEC = Picture(
    name="histories",
    place=80,
    shows="ground accelerations, drifts and contact forces over time",
    needs=("time",),
    draw=histories,
    overlay=overlay,
    options=("between",),
)
