"""Picture `capacity`: the capacity curves of pushovers with their events, backbones and idealisations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from pound_solve.report.plot import labels, style
from pound_solve.report.plot.geometry import contact_name
from pound_solve.report.plot.overlay import curves
from pound_solve.report.plot.schema import Choice, Picture
from pound_solve.results import Results

MOST = 12  #: events with a name
TITLE = 90  #: characters of a line of a title
BACKBONE: Final = {"color": style.RED, "linestyle": "-", "marker": "o", "markersize": 3.5, "linewidth": 1.2}
IDEALISED: Final = {"color": "0.35", "linestyle": "--", "linewidth": 1.0}
POINT: Final = {"marker": "*", "linestyle": "", "markersize": 10, "zorder": 4}


def capacity(results: Results, choice: Choice) -> Any:
    """Draw the curves, one above the other."""
    pushes = pushovers(results)
    figure = style.figure(8.5, 1.0 + 4.0 * len(pushes), "Capacity curve" + "s" * (len(pushes) > 1))
    for axes, push in zip(figure.subplots(len(pushes), 1, squeeze=False).ravel(), pushes):
        curve(axes, results, push)
    return figure


def overlay(runs: Sequence[Results], choice: Choice) -> Any:
    """Draw the curves of several runs, without their events."""
    figure = style.figure(8.5, 5.0, "Capacity curves")
    axes, units = figure.add_subplot(), runs[0].units
    style.grid(axes, f"displacement of the control node [{units.length}]", f"base shear [{units.force}]")
    for run, look in curves(runs):
        for push in pushovers(run) if run.holds("capacity_curve") else ():
            table = of_push(run, "capacity_curve", push)
            axes.plot(table["displacement"], table["base_shear"], **look)
            look = {**look, "label": None}
    style.legend_below(figure, [axes])
    return figure


def pushovers(results: Results) -> list[int]:
    """Numbers of the pushovers of a run."""
    return sorted(set(results.table("capacity_curve")["push"].tolist()))


def of_push(results: Results, name: str, push: int) -> NDArray[Any]:
    """Rows of a table that belong to one pushover; none if the run lacks the table."""
    if not results.holds(name):
        return np.zeros(0)
    table = results.table(name)
    return np.asarray(table[table["push"] == push])


def curve(axes: Any, results: Results, push: int) -> None:
    """Draw base shear over displacement: one to a single target with its events and idealisation, one
    that turns with its backbone.
    """
    table, units = of_push(results, "capacity_curve", push), results.units
    style.grid(axes, f"displacement of the control node [{units.length}]", f"base shear [{units.force}]")
    x, y = table["displacement"], table["base_shear"]
    turns = table["leg"].max() > 1
    axes.plot(x, y, color=style.BLUE, linestyle="-", linewidth=0.8 if turns else 1.4)
    axes.margins(0.06, 0.08)
    if turns:
        outer = of_push(results, "backbone", push)
        axes.plot(outer["displacement"], outer["base_shear"], **BACKBONE, label="backbone")
    else:
        _events(axes, results, push)
        _idealised(axes, results, push)
    top = int(np.argmax(np.abs(y)))
    axes.plot(x[top], y[top], "D", color="0.1", fillstyle="none", label="largest base shear")
    labels.label(axes, (x[top], y[top]), f"{y[top]:.5g} {units.force}", far=True)
    style.legend(axes)
    said = {row["item"]: row["value"] for row in of_push(results, "pushover", push)}
    remarks = [said[item] for item in ("building", "pattern", "control", "end") if item in said]
    axes.set_title(style.wrapped(f"{push}: " * (len(pushovers(results)) > 1) + "; ".join(remarks), TITLE))


def _events(axes: Any, results: Results, push: int) -> None:
    """Draw the events; the first of each kind has its name."""
    events = of_push(results, "push_events", push)
    words = kinds(results, events)
    for n, kind in enumerate(dict.fromkeys(words)):
        of_kind = [word == kind for word in words]
        axes.plot(
            events["displacement"][of_kind], events["base_shear"][of_kind], "o", markersize=4, zorder=3,
            color=style.stroke(n + 1)["color"], label=f"{kind} ({sum(of_kind)} events)",
        )  # fmt: skip
    for k in first_ones(words)[:MOST]:
        event = events[k]
        text = f"{named(results, event)}: {words[k]}"
        labels.label(axes, (event["displacement"], event["base_shear"]), text, far=True)


def _idealised(axes: Any, results: Results, push: int) -> None:
    """Draw the elastic, perfectly plastic line and the performance points."""
    table = of_push(results, "capacity_curve", push)
    x0, y0 = table["displacement"][0], table["base_shear"][0]
    sense = np.sign(table["displacement"][-1] - x0)
    for line in of_push(results, "capacity_line", push):
        x = [0.0, line["yield_displacement"], line["displacement"]]
        y = [0.0, line["yield_shear"], line["yield_shear"]]
        axes.plot(x0 + sense * np.array(x), y0 + sense * np.array(y), **IDEALISED, label="idealised")
    points = of_push(results, "performance", push)
    for n, point in enumerate(points[np.isfinite(points["displacement"])] if len(points) else ()):
        look = {**POINT, "color": style.stroke(n)["color"], "label": f"N2: {style.short(point['motion'])}"}
        axes.plot(point["displacement"], point["base_shear"], **look)


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
    shows="base shear over displacement of pushovers, with yields, contacts that close, and backbones",
    needs=("capacity_curve", "pushover", "elements"),
    draw=capacity,
    overlay=overlay,
)
