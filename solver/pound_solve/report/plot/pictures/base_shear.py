"""Picture `base_shear`: shear and overturning moment at the base of every building."""

from __future__ import annotations

from typing import Any

import numpy as np

from pound_solve.report.plot import style
from pound_solve.report.plot.schema import ALL, Choice, Picture
from pound_solve.results import Results

SHOWN = ("shear X", "moment")
TITLES = {"shear X": "base shear", "moment": "overturning moment", "force Y": "vertical force"}


def base_shear(results: Results, choice: Choice) -> Any:
    """Draw the shears of all buildings, and below the moments if there are any."""
    found = set(results.table("base_envelope")["quantity"])
    shown = [quantity for quantity in SHOWN if quantity in found] or list(SHOWN[:1])
    figure = style.figure(9.5, 2.4 * len(shown) + 0.4, results.title)
    first = None
    for n, quantity in enumerate(shown):
        axes = figure.add_subplot(len(shown), 1, n + 1, sharex=first)
        first = first or axes
        panel(axes, results, quantity, choice, n == len(shown) - 1)
    return figure


def panel(
    axes: Any, results: Results, quantity: str = "shear X", choice: Choice = ALL, last: bool = True
) -> None:
    """Draw one quantity of every building over time; dots are the largest values to both sides."""
    rows = choice.span(results)
    t, values = results.time[rows], results.history("building/base")[rows]
    all_labels, units = results.labels("building/base"), results.history_units("building/base")
    own = [k for k, label in enumerate(all_labels) if label.endswith(f" {quantity}")]
    unit = ", ".join(dict.fromkeys(units[k] for k in own))
    style.grid(axes, f"time [{results.units.time}]" if last else "", f"{TITLES[quantity]}\n[{unit}]")
    for n, k in enumerate(own):
        name, look = all_labels[k].removesuffix(f" {quantity}"), style.stroke(n)
        axes.plot(t, values[:, k], **look, label=style.short(name))
        peaks = _peaks(results, name, quantity, choice)
        axes.plot(*peaks, "o", color=look["color"], fillstyle="none", markersize=4)
    style.legend(axes)


def _peaks(results: Results, name: str, quantity: str, choice: Choice) -> Any:
    """Times and values of the envelope, shape (2, n)."""
    table = results.table("base_envelope")
    own = table[(table["building"] == name) & (table["quantity"] == quantity)]
    times, values = np.concatenate([own["t_max"], own["t_min"]]), np.concatenate([own["max"], own["min"]])
    low, high = choice.between or (-np.inf, np.inf)
    within = (times >= low) & (times <= high)
    return np.array([times[within], values[within]])


SPEC = Picture(
    name="base_shear",
    place=90,
    shows="base shear and overturning moment of every building over time, their largest values marked",
    needs=("building/base", "base_envelope"),
    draw=base_shear,
    options=("between",),
)
