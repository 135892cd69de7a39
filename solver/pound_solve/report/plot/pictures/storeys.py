"""Picture `storeys`: drift ratio, shear and floor acceleration over the height of each building."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_solve.numerics.types import Array
from pound_solve.report.plot import style
from pound_solve.report.plot.geometry import DrawnStructure
from pound_solve.report.plot.schema import Choice, Picture
from pound_solve.results import Results

#: quantity of a profile in the table, with its words, dimension and factor
PROFILES = {
    "drift ratio": ("drift ratio", "%", 100.0),
    "shear": ("storey shear", "F", 1.0),
    "floor acceleration": ("total floor acceleration", "L/T^2", 1.0),
}


def storeys(results: Results, choice: Choice) -> Any:
    """Draw a row of three profiles for each building, to one scale."""
    names = list(dict.fromkeys(results.table("storey_envelope")["building"].tolist()))
    figure = style.figure(9.5, 2.9 * len(names) + 0.5, results.title)
    first: dict[str, Any] = {}
    for row, name in enumerate(names):
        for n, quantity in enumerate(PROFILES):
            axes = figure.add_subplot(
                len(names), 3, 3 * row + n + 1, sharex=first.get(quantity), sharey=first.get("any")
            )
            first.setdefault(quantity, axes)
            first.setdefault("any", axes)
            panel(axes, results, [name], quantity)
            if n == 0:
                axes.set_title(name, loc="left")
    figure.axes[2].set_title("lines: to the right; dashes: to the left", loc="right")
    return figure


def panel(axes: Any, results: Results, names: list[str], quantity: str) -> None:
    """Draw one profile of some buildings: lines for the largest values, dashes for the smallest."""
    table = results.table("storey_envelope")
    words, dimension, factor = PROFILES[quantity]
    unit = dimension if dimension == "%" else results.units.text(dimension)
    style.grid(axes, f"{words} [{unit}]", f"height [{results.units.length}]")
    axes.axvline(0.0, color="0.3", linewidth=0.8)
    for n, name in enumerate(names):
        storeys = table[table["building"] == name]
        high, low = extremes(results, name, quantity)
        look = {"color": style.stroke(n)["color"], "linewidth": 1.2}
        for values, dashes in ((high, "-"), (low, "--")):
            label = style.short(name) if dashes == "-" else None
            if quantity == "floor acceleration":
                at = [_base(storeys), *storeys["level"]]
                base = base_acceleration(results, name)
                shown = [base[0] if dashes == "-" else base[1], *values]
                axes.plot(shown, at, dashes, marker=".", **look, label=label)
            else:
                steps = np.column_stack([storeys["level"] - storeys["height"], storeys["level"]]).ravel()
                axes.plot(factor * np.repeat(values, 2), steps, dashes, **look, label=label)
    axes.margins(x=0.06, y=0.03)
    axes.locator_params(axis="x", nbins=6)


def _base(rows: NDArray[Any]) -> float:
    return float(rows["level"][0] - rows["height"][0])


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
)  # fmt: skip
