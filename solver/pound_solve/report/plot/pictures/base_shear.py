"""Picture `base_shear`: shear and overturning moment at the base of every building."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pound_solve.report.plot import courses, style
from pound_solve.report.plot.overlay import TimePanel, over_time, units_of_largest
from pound_solve.report.plot.schema import ALL, Choice, Nothing, Picture
from pound_solve.results import Results

SHOWN = ("shear X", "moment")
ROUNDING = 1e-12  #: of the largest forces
TITLES = {"shear X": "base shear", "moment": "overturning moment", "force Y": "vertical force"}


def base_shear(results: Results, choice: Choice) -> Any:
    """Draw the shears of all buildings, and below the moments if there are any."""
    shown = [quantity for quantity in SHOWN if moves(results, quantity)]
    if not shown:
        raise Nothing("forces on the ground")
    figure = style.figure(9.5, 2.4 * len(shown) + 0.4, results.title)
    for axes, quantity in zip(style.stacked(figure, len(shown)), shown):
        panel(axes, results, quantity, choice, quantity == shown[-1])
    return figure


def overlay(runs: Sequence[Results], choice: Choice) -> Any:
    """Draw the shear of one building in each panel, with a curve for each run."""
    units = units_of_largest(runs, "building/base", ending=" shear X")
    panels = [TimePanel("building/base", label, "base shear", unit) for label, unit in units.items()]
    return over_time(runs, panels, choice)


def moves(results: Results, quantity: str = "shear X") -> bool:
    """Whether the largest value of a quantity at the base of buildings is more than rounding, compared with
    the largest forces at bases, contacts and supports.
    """
    table = results.table("base_envelope")
    largest = {
        q: float(np.abs(np.append(envelope["max"], envelope["min"])).max(initial=0.0))
        for q in set(table["quantity"])
        for envelope in [table[table["quantity"] == q]]
    }
    forces = [largest.get(q, 0.0) for q in ("shear X", "force Y")]
    for name in ("contact_summary", "reaction_envelope"):
        if name in results.tables:
            columns = ("peak_force",) if name == "contact_summary" else ("max", "min")
            forces += [float(np.nanmax(np.abs(results.table(name)[c]), initial=0.0)) for c in columns]
    return largest.get(quantity, 0.0) > ROUNDING * max(forces)


def panel(
    axes: Any, results: Results, quantity: str = "shear X", choice: Choice = ALL, last: bool = True
) -> None:
    """Draw one quantity of every building over time; rings mark the largest values to both sides.

    Shades tell what happens between samples that are far apart.
    """
    rows = choice.span(results)
    t, values = results.time[rows], results.history("building/base")[rows]
    all_labels, units = results.labels("building/base"), results.history_units("building/base")
    columns = [k for k, label in enumerate(all_labels) if label.endswith(f" {quantity}")]
    unit = ", ".join(dict.fromkeys(units[k] for k in columns))
    style.grid(axes, f"time [{results.units.time}]" if last else "", f"{TITLES[quantity]}\n[{unit}]")
    for n, k in enumerate(columns):
        name, look = all_labels[k].removesuffix(f" {quantity}"), style.stroke(n)
        courses.shade(axes, results, "building/base", k, look, choice)
        axes.plot(t, values[:, k], **look, label=style.short(name))
        peaks = _peaks(results, name, quantity, choice)
        axes.plot(*peaks, "o", color=look["color"], fillstyle="none", markersize=4)
    style.legend(axes)


def _peaks(results: Results, name: str, quantity: str, choice: Choice) -> Any:
    """Times and values of the peaks in the envelope, shape (2, n)."""
    table = results.table("base_envelope")
    envelope = table[(table["building"] == name) & (table["quantity"] == quantity)]
    times, values = (
        np.concatenate([envelope["t_max"], envelope["t_min"]]),
        np.concatenate([envelope["max"], envelope["min"]]),
    )
    low, high = choice.between or (-np.inf, np.inf)
    within = (times >= low) & (times <= high)
    return np.array([times[within], values[within]])


SPEC = Picture(
    name="base_shear",
    place=90,
    shows="base shear and overturning moment of every building over time, their largest values marked",
    needs=("building/base", "base_envelope"),
    draw=base_shear,
    overlay=overlay,
    options=("between",),
)
