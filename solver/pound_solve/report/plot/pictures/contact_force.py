"""Picture `contact_force`: the force of every contact over time, with every true peak."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pound_solve.report.plot import courses, style
from pound_solve.report.plot.members import chosen_contacts
from pound_solve.report.plot.overlay import TimePanel, over_time, units_of_largest
from pound_solve.report.plot.schema import Choice, Picture
from pound_solve.results import Results

MARGIN = 0.15  #: time before and after an enlarged collision, as a fraction of its duration


def contact_force(results: Results, choice: Choice) -> Any:
    """Draw one panel for each contact that closed, or for the chosen ones."""
    names = results.labels("contact/force")
    columns = chosen_contacts(results, choice) or [
        k for k, name in enumerate(names) if len(courses.of_contact(results, name))
    ]
    if not columns:
        columns = list(range(len(names)))
    shown = columns[: style.LINES]
    more = f": {len(shown)} of {len(columns)}" if len(shown) < len(columns) else ""
    title = f"Contact forces{more}; rings: peak of each collision"
    enlarged = {} if choice.between else {k: times for k in shown if (times := _largest(results, names[k]))}
    figure = style.figure(11.0 if enlarged else 9.0, 1.7 * len(shown) + 0.9, title)
    widths = (3.0, 1.0) if enlarged else (1.0,)
    grid = figure.add_gridspec(len(shown), len(widths), width_ratios=widths)
    first = None
    for n, k in enumerate(shown):
        axes = figure.add_subplot(grid[n, 0], sharex=first)
        first = first or axes
        last = n == len(shown) - 1
        labels = f"time [{results.units.time}]", f"force [{results.units.force}]"
        style.grid(axes, labels[0] if last else "", labels[1])
        look = {"color": style.stroke(n)["color"], "linestyle": "-"}
        courses.force_curve(axes, results, k, look, choice)
        axes.set_title(_caption(results, names[k], choice))
        if choice.between:
            axes.set_xlim(*choice.between)
        axes.tick_params(labelbottom=last)
        if k in enlarged:
            _enlarge(style.grid(figure.add_subplot(grid[n, 1]), *labels), results, k, look, enlarged[k])
    return figure


def overlay(runs: Sequence[Results], choice: Choice) -> Any:
    """Draw the force of one contact in each panel, with a curve for each run."""
    units = units_of_largest(runs, "contact/force")
    panels = [TimePanel("contact/force", label, "force", unit) for label, unit in units.items()]
    return over_time(runs, panels, choice, "Contact forces")


def _largest(results: Results, name: str) -> tuple[float, float] | None:
    """Start and end of the collision with the largest force of a contact; None if there is none, or it has
    not ended, or too few instants of it are stored.
    """
    row = courses.hardest(results, name)
    if row is None or np.isnan(row["t_end"]):
        return None
    t, start, end = results.course("contact/force")[0], float(row["t_start"]), float(row["t_end"])
    return (start, end) if ((t >= start) & (t <= end)).sum() >= courses.DENSE else None


def _enlarge(
    axes: Any, results: Results, k: int, look: dict[str, str], collision: tuple[float, float]
) -> None:
    """Draw one collision of a contact over its own time, with a margin on both sides."""
    margin = MARGIN * (collision[1] - collision[0])
    interval = collision[0] - margin, collision[1] + margin
    courses.force_curve(axes, results, k, look, Choice(between=interval))
    axes.set_xlim(*interval)
    axes.locator_params(axis="x", nbins=3)
    axes.ticklabel_format(axis="x", useOffset=False)
    axes.set_title("the largest, enlarged")


def _caption(results: Results, name: str, choice: Choice) -> str:
    """Text on a contact's number of collisions and its largest force."""
    collisions, units = courses.of_contact(results, name, choice), results.units
    times = {0: "not closed", 1: "closed once"}.get(len(collisions), f"closed {len(collisions)} times")
    top = courses.hardest(results, name, choice)
    if top is None:
        return f"{name}: {times}" + (", instantaneous impacts (bars)" if len(collisions) else "")
    return (
        f"{name}: {times}, largest force {top['peak_force']:.5g} {units.force} at {top['t_peak']:.6g} "
        f"{units.time}"
    )


SPEC = Picture(
    name="contact_force",
    place=100,
    shows="the force of each contact over time, with the true peak of each collision",
    needs=("contact/force",),
    draw=contact_force,
    overlay=overlay,
    options=("member", "between"),
)
