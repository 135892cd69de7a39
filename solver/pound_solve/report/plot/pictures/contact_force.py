"""Picture `contact_force`: the force of every contact over time, with every true peak."""

from __future__ import annotations

from typing import Any

import numpy as np

from pound_solve.report.plot import courses, style
from pound_solve.report.plot.members import chosen_contacts
from pound_solve.report.plot.schema import Choice, Picture
from pound_solve.results import Results


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
    figure = style.figure(9.0, 1.7 * len(shown) + 0.9, title)
    first = None
    for n, k in enumerate(shown):
        axes = figure.add_subplot(len(shown), 1, n + 1, sharex=first)
        first = first or axes
        last = n == len(shown) - 1
        style.grid(axes, f"time [{results.units.time}]" if last else "", f"force [{results.units.force}]")
        look = {"color": style.stroke(n)["color"], "linestyle": "-"}
        courses.force_curve(axes, results, k, look, choice)
        axes.set_title(_caption(results, names[k], choice))
        if choice.between:
            axes.set_xlim(*choice.between)
        axes.tick_params(labelbottom=last)
    return figure


def _caption(results: Results, name: str, choice: Choice) -> str:
    """Text on a contact's number of collisions and its largest force."""
    collisions, units = courses.of_contact(results, name, choice), results.units
    times = {0: "not closed", 1: "closed once"}.get(len(collisions), f"closed {len(collisions)} times")
    peaks = collisions[np.isfinite(collisions["peak_force"])]
    if not len(peaks):
        return f"{name}: {times}" + (", instantaneous impacts (bars)" if len(collisions) else "")
    top = peaks[np.argmax(peaks["peak_force"])]
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
    options=("member", "between"),
)
