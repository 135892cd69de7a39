"""Picture `capacity`: the capacity curve of a pushover with its events."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_solve.report.plot import labels, style
from pound_solve.report.plot.geometry import contact_name
from pound_solve.report.plot.overlay import curves
from pound_solve.report.plot.schema import Choice, Picture
from pound_solve.results import Results

MOST = 12  #: events with a name


def capacity(results: Results, choice: Choice) -> Any:
    """Draw the curve on a page of its own."""
    figure = style.figure(8.5, 5.0, "Capacity curve")
    curve(figure.add_subplot(), results)
    return figure


def overlay(runs: Sequence[Results], choice: Choice) -> Any:
    """Draw the curves of several pushovers, without their events."""
    figure = style.figure(8.5, 5.0, "Capacity curves")
    axes, units = figure.add_subplot(), runs[0].units
    style.grid(axes, f"displacement of the control node [{units.length}]", f"base shear [{units.force}]")
    for run, look in curves(runs):
        if run.holds("capacity_curve"):
            table = run.table("capacity_curve")
            axes.plot(table["displacement"], table["base_shear"], **look)
    style.legend_below(figure, [axes])
    return figure


def curve(axes: Any, results: Results) -> None:
    """Draw base shear over displacement; dots are the events, and the first of each kind has its name."""
    table, units = results.table("capacity_curve"), results.units
    said = dict(results.table("pushover").tolist())
    style.grid(axes, f"displacement of the control node [{units.length}]", f"base shear [{units.force}]")
    x, y = table["displacement"], table["base_shear"]
    axes.plot(x, y, color=style.BLUE, linestyle="-", linewidth=1.4)
    axes.margins(0.06, 0.08)
    events = results.table("push_events")
    words = kinds(results, events)
    for n, kind in enumerate(dict.fromkeys(words)):
        of_kind = [word == kind for word in words]
        axes.plot(
            events["displacement"][of_kind], events["base_shear"][of_kind], "o", markersize=4, zorder=3,
            color=style.stroke(n + 1)["color"], label=f"{kind} ({sum(of_kind)})",
        )  # fmt: skip
    top = int(np.argmax(np.abs(y)))
    axes.plot(x[top], y[top], "D", color="0.1", fillstyle="none", label="largest base shear")
    labels.label(axes, (x[top], y[top]), f"{y[top]:.5g} {units.force}", far=True)
    for k in first_ones(words)[:MOST]:
        event = events[k]
        text = f"{named(results, event)}: {words[k]}"
        labels.label(axes, (event["displacement"], event["base_shear"]), text, far=True)
    style.legend(axes, title="events (number)")
    remarks = [said[item] for item in ("pattern", "control", "end") if item in said]
    axes.set_title("; ".join(remarks))


def kinds(results: Results, events: NDArray[Any]) -> list[str]:
    """Word for each event: a contact closes or opens, others are named by the branch that they enter."""
    contacts = {int(e["element"]) for e in results.table("elements") if e["kind"] == "CONTACT"}
    words = []
    for row in events:
        if int(row["element"]) in contacts and "open" in (row["before"], row["after"]):
            words.append("opens" if row["after"] == "open" else "closes")
        else:
            words.append(str(row["after"]).rstrip("+- "))
    return words


def first_ones(words: list[str]) -> list[int]:
    """Indices of the events that get a label: the first of each kind, and every closing of a contact."""
    seen: dict[str, int] = {}
    for k, word in enumerate(words):
        seen.setdefault(word, k)
    closures = [k for k, word in enumerate(words) if word == "closes"]
    return sorted({*seen.values(), *closures})


def named(results: Results, row: Any) -> str:
    """Name of the spring, hinge or contact that an event belongs to."""
    (e,) = (e for e in results.table("elements") if e["element"] == row["element"])
    return contact_name(e) if e["kind"] == "CONTACT" else f"{row['element']} {row['component']}"


SPEC = Picture(
    name="capacity",
    place=50,
    shows="base shear over the displacement of a pushover, with first yields and contacts that close",
    needs=("capacity_curve", "pushover", "elements"),
    draw=capacity,
    overlay=overlay,
)
