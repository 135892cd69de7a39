"""Picture `storeys`: drift ratio, shear and floor acceleration over the height of each building."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.plot import labels, style
from pound_solve.report.plot.geometry import DrawnStructure
from pound_solve.report.plot.overlay import curves
from pound_solve.report.plot.schema import Choice, Picture
from pound_solve.results import Results

#: quantity of a profile in the table, with its words, dimension and factor
PROFILES = {
    "drift ratio": ("drift ratio", "%", 100.0),
    "shear": ("storey shear", "F", 1.0),
    "floor acceleration": ("total floor acceleration", "L/T^2", 1.0),
}

GREY: Final = "0.35"  #: colour of limits, which no building and no run has
LIMIT: Final = {"color": GREY, "linewidth": 0.9, "linestyle": (0, (1, 1.5)), "zorder": 1}
FAR: Final = 2.5  #: limits beyond this multiple of the largest drift are not drawn
SIDES = "lines: to the right; dashes: to the left"


def storeys(results: Results, choice: Choice) -> Any:
    """Draw a row of three profiles for each building, to one scale."""
    names = buildings(results)
    figure = style.figure(9.5, 2.9 * len(names) + 0.5, results.title)
    for axes, name, quantity in _grid(figure, names):
        panel(axes, results, [name], quantity)
    figure.axes[2].set_title(SIDES, loc="right")
    return figure


def overlay(runs: Sequence[Results], choice: Choice) -> Any:
    """Draw the same rows with a colour for each run."""
    drawn = [(run, look, buildings(run)) for run, look in curves(runs) if run.holds("storey_envelope")]
    names = list(dict.fromkeys(name for _, _, there in drawn for name in there))
    figure = style.figure(9.5, 2.9 * len(names) + 0.9)
    for axes, name, quantity in _grid(figure, names):
        label_axes(axes, runs[0], quantity)
        limits(axes, runs, quantity)
        for run, look, there in drawn:
            if name in there:
                profile(axes, run, name, quantity, look)
    figure.axes[2].set_title(SIDES, loc="right")
    style.legend_below(figure, figure.axes)
    return figure


def buildings(results: Results) -> list[str]:
    """Names of the buildings that have storeys."""
    return list(dict.fromkeys(results.table("storey_envelope")["building"].tolist()))


def _grid(figure: Any, names: Sequence[str]) -> Iterator[tuple[Any, str, str]]:
    """Axes of each building and quantity, with one scale for each quantity."""
    first: dict[str, Any] = {}
    for row, name in enumerate(names):
        for n, quantity in enumerate(PROFILES):
            shared = {"sharex": first.get(quantity), "sharey": first.get("any")}
            axes = figure.add_subplot(len(names), len(PROFILES), len(PROFILES) * row + n + 1, **shared)
            first.setdefault(quantity, axes)
            first.setdefault("any", axes)
            yield axes, name, quantity
            if n == 0:
                axes.set_title(name, loc="left")


def panel(axes: Any, results: Results, names: list[str], quantity: str) -> None:
    """Draw one profile of some buildings: lines for the largest values, dashes for the smallest."""
    label_axes(axes, results, quantity)
    limits(axes, [results], quantity)
    for n, name in enumerate(names):
        look = {"color": style.stroke(n)["color"], "linewidth": 1.2, "label": style.short(name)}
        profile(axes, results, name, quantity, look)


def label_axes(axes: Any, results: Results, quantity: str) -> None:
    """Name the axes of one profile."""
    words, dimension, _ = PROFILES[quantity]
    unit = dimension if dimension == "%" else results.units.text(dimension)
    style.grid(axes, f"{words} [{unit}]", f"height [{results.units.length}]")
    axes.axvline(0.0, color="0.3", linewidth=0.8)
    axes.margins(x=0.06, y=0.03)
    axes.locator_params(axis="x", nbins=6)


def limits(axes: Any, runs: Sequence[Results], quantity: str) -> None:
    """Draw the drift limits as lines on both sides, named at their tops."""
    levels = [run.table("storey_envelope")["level"].max() for run in runs if run.holds("storey_envelope")]
    for name, allowed in drift_limits(runs) if quantity == "drift ratio" else ():
        for side in (-allowed, allowed):
            axes.axvline(side, **LIMIT)
        labels.label(axes, (allowed, max(levels)), style.short(name), rotation=90, fontsize=6.0, color=GREY)


def drift_limits(runs: Sequence[Results]) -> list[tuple[str, float]]:
    """Names of the drift limits that all runs share, with their values [%], but those far beyond the
    response.
    """
    if not all(run.holds("limits") for run in runs):
        return []
    tables = [run.table("limits") for run in runs]
    rows = [table[table["quantity"] == "storey drift"] for table in tables]
    shared = set.intersection(*({(row["limit"], float(row["allowed"])) for row in each} for each in rows))
    largest = max((float(each["largest"].max()) for each in rows if len(each)), default=0.0)
    near = [limit for limit in shared if limit[1] <= FAR * largest]
    return sorted(near, key=lambda limit: limit[1])


def profile(axes: Any, results: Results, name: str, quantity: str, look: Mapping[str, Any]) -> None:
    """Draw one profile of one building."""
    sides: tuple[dict[str, str | None], ...] = ({"linestyle": "-"}, {"linestyle": "--", "label": None})
    marker = "." if quantity == "floor acceleration" else ""
    for (values, heights), dashes in zip(profile_points(results, name, quantity), sides):
        axes.plot(values, heights, **{**look, **dashes, "marker": marker})


def profile_points(results: Results, name: str, quantity: str) -> Iterator[tuple[Array, Array]]:
    """Yield values and heights of a profile for the largest and the smallest values: of whole storeys, or
    for accelerations those of the base and the floors.
    """
    table, factor = results.table("storey_envelope"), PROFILES[quantity][2]
    rows = table[table["building"] == name]
    feet, floors = rows["level"] - rows["height"], rows["level"]
    for values, base in zip(extremes(results, name, quantity), base_acceleration(results, name)):
        if quantity == "floor acceleration":
            yield np.append(base, values), np.append(feet[0], floors)
        else:
            yield factor * np.repeat(values, 2), np.column_stack([feet, floors]).ravel()


def extremes(results: Results, name: str, quantity: str) -> tuple[Array, Array]:
    """Largest and smallest values of the storeys of a building from below, shape (n,) each."""
    table = results.table("storey_extremes")
    rows = table[(table["building"] == name) & (table["quantity"] == quantity)]
    return rows["max"], rows["min"]


def base_acceleration(results: Results, building: str) -> tuple[float, float]:
    """Largest and smallest acceleration of the supports at the base, NaN where none is recorded."""
    rows = {row["building"]: row for row in results.table("buildings")}
    entry, table = rows[building], results.table("node_envelope")
    feet = DrawnStructure(results).feet(int(entry["node"]), float(entry["base"]))
    motion = table[
        (table["quantity"] == "acceleration") & (table["direction"] == "X") & np.isin(table["node"], feet)
    ]
    return (float(motion["max"].max()), float(motion["min"].min())) if len(motion) else (np.nan, np.nan)


SPEC = Picture(
    name="storeys",
    place=70,
    shows="drift ratio, shear and floor acceleration over the height of each building, to both sides",
    needs=("storey_envelope", "storey_extremes", "buildings", "node_envelope", "nodes", "elements"),
    draw=storeys,
    overlay=overlay,
)  # fmt: skip
