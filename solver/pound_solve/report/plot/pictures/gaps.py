"""Picture `gaps`: the gap of every contact over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pound_solve.report.plot import style
from pound_solve.report.plot.members import chosen_contacts
from pound_solve.report.plot.overlay import TimePanel, over_time
from pound_solve.report.plot.schema import Choice, Picture
from pound_solve.results import Results

MOST = 8  #: panels


def gaps(results: Results, choice: Choice) -> Any:
    """Draw one panel for each contact, or for the chosen ones; of many, those that come nearest."""
    t, values = results.course("contact/gap", jumps=True)
    names, unit = results.labels("contact/gap"), results.units.length
    nearest = np.argsort(values.min(axis=0), kind="stable")[:MOST]
    columns = chosen_contacts(results, choice) or sorted(nearest.tolist())
    more = f": {len(columns)} of {len(names)}" if len(columns) < len(names) else ""
    figure = style.figure(9.0, 1.7 * len(columns) + 0.9, f"Gaps{more}; below zero the contact is pressed")
    span = choice.span(results, t)
    for axes, k in zip(style.stacked(figure, len(columns)), columns):
        last = k == columns[-1]
        style.grid(axes, f"time [{results.units.time}]" if last else "", f"gap [{unit}]")
        axes.plot(t[span], values[span, k], color=style.BLUE, linestyle="-", linewidth=1.0)
        axes.axhline(0.0, color=style.RED, linewidth=0.8)
        axes.set_title(f"{names[k]}: {_initial_and_smallest(results, names[k])}")
        axes.tick_params(labelbottom=last)
    if choice.between:
        figure.axes[-1].set_xlim(*choice.between)
    return figure


def _initial_and_smallest(results: Results, name: str) -> str:
    """Initial and smallest gap of a contact as text; the smallest one is that between samples too."""
    texts, unit = [], results.units.length
    for table, column, word in (
        ("contact_laws", "gap", "initial"),
        ("contact_summary", "min_gap", "smallest"),
    ):
        rows = results.table(table) if table in results.tables else ()
        texts += [f"{word} {float(row[column]):.4g} {unit}" for row in rows if str(row["contact"]) == name]
    return ", ".join(texts)


def overlay(runs: Sequence[Results], choice: Choice) -> Any:
    """Draw the gap of one contact in each panel, with a curve for each run; of many, the nearest in any."""
    nearest: dict[str, float] = {}
    for run in runs:
        if run.holds("contact/gap"):
            for name, gap in zip(run.labels("contact/gap"), run.history("contact/gap").min(axis=0)):
                nearest[name] = min(nearest.get(name, np.inf), float(gap))
    chosen = sorted(nearest, key=nearest.__getitem__)[:MOST]
    unit = runs[0].units.length
    panels = [TimePanel("contact/gap", name, "gap", unit) for name in nearest if name in chosen]
    return over_time(runs, panels, choice, "Gaps; below zero the contact is pressed")


SPEC = Picture(
    name="gaps",
    place=105,
    shows="the gap of each contact over time",
    needs=("contact/gap",),
    draw=gaps,
    options=("member", "between"),
    overlay=overlay,
)
