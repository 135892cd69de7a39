"""Curves over time that several pictures draw: ten at most, named beside the axes; contact forces with
their true peaks.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_solve.numerics.types import Array
from pound_solve.report.plot import style
from pound_solve.report.plot.schema import ALL, Choice
from pound_solve.results import Results

QUANTITY = {
    "ground": ("ground acceleration", "ground motions"),
    "drift": ("drift", "drifts"),
    "contact/force": ("contact force", "contacts"),
}  #: of a history: what its axis says, and what its curves are
DENSE = 6  #: stored instants from which on a collision is drawn by itself


def worst(values: Array, most: int = style.LINES) -> list[int]:
    """Indices of the `most` columns with the largest absolute values, in the order of the columns."""
    order = np.argsort(-np.abs(values).max(axis=0, initial=0.0), kind="stable")[:most]
    return sorted(order.tolist())


def panel(axes: Any, results: Results, name: str, choice: Choice = ALL, last: bool = True) -> None:
    """Draw the columns of a history over time, those of the largest values where there are too many."""
    t, values = results.course(name)
    rows, labels = choice.span(results, t), results.labels(name)
    t, values = t[rows], values[rows]
    unit = ", ".join(dict.fromkeys(results.history_units(name)))
    quantity, things = QUANTITY[name]
    style.grid(axes, f"time [{results.units.time}]" if last else "", f"{quantity}\n[{unit}]")
    chosen = worst(values)
    named = motions(results) if name == "ground" else labels
    for k, column in enumerate(chosen):
        if name == "contact/force":
            force_curve(axes, results, column, style.stroke(k), choice)
        else:
            axes.plot(t, values[:, column], **style.stroke(k), label=style.short(named[column]))
    if choice.between:
        axes.set_xlim(*choice.between)
    if len(chosen) < len(labels):
        axes.set_title(f"{len(chosen)} of {len(labels)} {things}, those with the largest values")
    style.legend(axes)


def shade(
    axes: Any, results: Results, name: str, column: int, look: Mapping[str, Any], choice: Choice
) -> None:
    """Shade the range of a quantity between its samples, where its extremes are stored as closely."""
    if name not in results.extremes:
        return
    bounds, low, high = results.extreme(name)
    samples = np.diff(results.time).max(initial=0.0)
    if np.diff(bounds).max(initial=0.0) > (1.0 + 1e-9) * samples:  # wider than samples, which show more
        return
    inside = choice.span(results, bounds[:-1])
    n = len(bounds) - 1
    sides = (np.append(x.reshape(n, -1)[inside, column], np.nan) for x in (low, high))
    t = np.append(bounds[:-1][inside], bounds[1:][inside][-1:])
    axes.fill_between(t, *sides, step="post", color=look["color"], alpha=0.25, linewidth=0)


def motions(results: Results) -> tuple[str, ...]:
    """Names of the ground motions with their directions, in the order of the history."""
    labels = results.labels("ground")
    table = results.table("motions") if "motions" in results.tables else ()
    if len(table) != len(labels):
        return labels
    return tuple(f"{str(row['motion']).split(' ', 1)[-1]} {str(row['direction'])[0]}" for row in table)


def of_contact(results: Results, name: str, choice: Choice = ALL) -> NDArray[Any]:
    """Rows of a contact's collisions, those that reach into `choice.between`, if given."""
    if "collisions" not in results.tables:
        return np.empty(0, dtype=[(c, float) for c in ("t_start", "t_end", "peak_force", "t_peak")])
    table = results.table("collisions")
    collisions = table[[str(c) == name for c in table["contact"]]]
    if choice.between is None:
        return collisions
    end = np.where(np.isnan(collisions["t_end"]), np.inf, collisions["t_end"])
    return collisions[(collisions["t_start"] <= choice.between[1]) & (end >= choice.between[0])]


def hardest(results: Results, name: str, choice: Choice = ALL) -> Any:
    """Row of a contact's collision with the largest peak force; None if no collision has a force."""
    collisions = of_contact(results, name, choice)
    with_force = collisions[np.isfinite(collisions["peak_force"])]
    return with_force[np.argmax(with_force["peak_force"])] if len(with_force) else None


def with_peaks(t: Array, force: Array, collisions: NDArray[Any]) -> tuple[Array, Array]:
    """Times and forces of a contact: stored samples, and start, true peak and end of every collision."""
    hard = collisions[np.isfinite(collisions["peak_force"])]
    ended, none = hard["t_end"][np.isfinite(hard["t_end"])], np.zeros(len(hard))
    at = np.concatenate([hard["t_start"], t, hard["t_peak"], ended])
    forces = np.concatenate([none, force, hard["peak_force"], none[: len(ended)]])
    order = np.argsort(at, kind="stable")
    return at[order], forces[order]


def force_curve(
    axes: Any, results: Results, column: int, look: Mapping[str, Any], choice: Choice = ALL
) -> None:
    """Draw the force of one contact over time: a ring for each true peak, a bar for an instant impact."""
    t, force = results.course("contact/force", jumps=True)
    rows = choice.span(results, t)
    name = results.labels("contact/force")[column]
    collisions = of_contact(results, name, choice)
    at, force = with_peaks(t[rows], force[rows, column], collisions)
    axes.plot(at, force, **look, label=style.short(name))
    peaks = collisions[np.isfinite(collisions["peak_force"])]
    axes.plot(
        peaks["t_peak"], peaks["peak_force"], "o", color=look["color"], fillstyle="none", markersize=4
    )
    impacts = collisions[np.isnan(collisions["peak_force"])]
    axes.plot(impacts["t_start"], np.zeros(len(impacts)), "|", color=look["color"], markersize=10)
