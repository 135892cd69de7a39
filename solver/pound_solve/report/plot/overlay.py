"""Runs drawn over each other: what they are called, which columns they have in common, and their curves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.plot import style
from pound_solve.report.plot.schema import Choice, ChoiceError
from pound_solve.results import Results

MOST_PANELS = 6  #: of one history


class TimePanel(NamedTuple):
    """One column of a history, drawn over time: its history and label, what it is, and its unit."""

    history: str
    label: str
    quantity: str
    unit: str


def check_units(runs: Sequence[Results]) -> None:
    """Raise where runs cannot share axes.

    Raises
    ------
    ChoiceError
        Their units differ.
    """
    first = runs[0]
    for run in runs[1:]:
        if run.units != first.units:
            told = (
                f"{r.path} is in {r.units.force}, {r.units.length}, {r.units.time}" for r in (first, run)
            )
            raise ChoiceError(f"{', '.join(told)}: only runs in the same units are drawn over each other")


def run_names(paths: Sequence[Path]) -> list[str]:
    """Shortest ends of the paths, without the ending of the file, that tell the files apart."""
    parts = [path.with_suffix("").parts for path in paths]
    for length in range(1, max(map(len, parts)) + 1):
        shown = ["/".join(p[-length:]) for p in parts]
        if len(set(shown)) == len(shown):
            return shown
    return [f"{path.stem} ({n})" for n, path in enumerate(paths, 1)]


def curves(runs: Sequence[Results]) -> Iterator[tuple[Results, dict[str, Any]]]:
    """Every run with the look of its curves, one colour in all panels, and its name for the legend."""
    for n, (run, name) in enumerate(zip(runs, run_names([run.path for run in runs]))):
        look = {key: value for key, value in style.stroke(n).items() if key != "marker"}
        yield run, {**look, "linewidth": 1.1, "label": style.short(name)}


def units_of_largest(
    runs: Sequence[Results], history: str, most: int = MOST_PANELS, ending: str = ""
) -> dict[str, str]:
    """Labels with this ending of the columns of a history with the largest values in any run, at most so
    many, each with its unit; a run may lack some or all of them.
    """
    units: dict[str, str] = {}
    largest: dict[str, float] = {}
    for run in runs:
        if run.holds(history):
            units |= dict(zip(run.labels(history), run.history_units(history)))
            for label, top in zip(run.labels(history), np.abs(run.history(history)).max(axis=0)):
                largest[label] = max(largest.get(label, 0.0), float(top))
    known = [label for label in largest if label.endswith(ending)]
    chosen = sorted(known, key=lambda label: -largest[label])[:most]
    return {label: unit for label, unit in units.items() if label in chosen}


def over_time(runs: Sequence[Results], panels: Sequence[TimePanel], choice: Choice, title: str = "") -> Any:
    """Figure of histories over time below each other, with a curve for each run that has them."""
    figure = style.figure(9.5, 2.0 * len(panels) + 0.9, title)
    for axes, panel in zip(style.stacked(figure, len(panels)), panels):
        last = panel is panels[-1]
        time = f"time [{runs[0].units.time}]" if last else ""
        style.grid(axes, time, f"{panel.quantity}\n[{panel.unit}]")
        axes.set_title(panel.label, loc="left")
        for run, look in curves(runs):
            if (drawn := course(run, panel, choice)) is not None:
                axes.plot(*drawn, **look)
        axes.tick_params(labelbottom=last)
    if choice.between:
        figure.axes[-1].set_xlim(*choice.between)
    style.legend_below(figure, figure.axes)
    return figure


def course(run: Results, panel: TimePanel, choice: Choice) -> tuple[Array, Array] | None:
    """Times and values of one column of a history, close-ups included; None where the run lacks it."""
    if not run.holds(panel.history) or panel.label not in run.labels(panel.history):
        return None
    t, rows = run.course(panel.history, jumps=True)
    span = choice.span(run, t)
    return t[span], rows[span, run.labels(panel.history).index(panel.label)]
