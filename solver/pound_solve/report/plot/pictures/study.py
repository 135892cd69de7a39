"""Picture `study`: the largest error of every run against its time and its steps."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from pound_solve.numerics.types import Array
from pound_solve.report.plot import style
from pound_solve.report.plot.schema import Choice, Picture
from pound_solve.results import Results

MARKS = "os^Dvx"
ROOM = 0.05  #: left beside the curves, as a fraction of a decade


def study(results: Results, choice: Choice) -> Any:
    """Error against CPU time to solve and against the number of steps, one curve a method."""
    over = costs(results)
    figure = style.figure(4.5 * len(over), 4.2, results.title)
    for n, (column, name) in enumerate(over.items()):
        axes = figure.add_subplot(1, len(over), n + 1)
        style.grid(axes, name, "" if n else "largest error")
        for k, (method, cost, error) in enumerate(errors(results, column)):
            if len(cost):
                axes.loglog(
                    cost, error,
                    **{**style.stroke(k), "marker": MARKS[k % len(MARKS)]},
                    markersize=4, linewidth=0.9, label=method,
                )  # fmt: skip
        for target in results.table("study_advice")["target"]:
            axes.axhline(target, color="0.5", linewidth=0.6, linestyle="--")
        _decades(axes)
    style.legend(figure.axes[-1])
    return figure


def costs(results: Results) -> dict[str, str]:
    """Columns of what a run costs, with the names of their axes."""
    steps = {"steps": "steps"} if results.table("study")["steps"].any() else {}
    return {"seconds": "CPU time to solve [s]"} | steps


def errors(results: Results, cost: str) -> Iterator[tuple[str, Array, Array]]:
    """Yield each method with the costs and the largest errors of its runs; one without error is drawn at
    the rounding of numbers.
    """
    table = results.table("study")
    table = table[np.isfinite(table["seconds"])]
    worst = np.fmax(np.fmax(np.fmax(table["drift"], table["member"]), table["contact"]), 1e-16)
    for method in dict.fromkeys(table["method"].tolist()):
        runs = (table["method"] == method) & (table[cost] > 0)
        yield method, table[cost][runs], worst[runs]


def _decades(axes: Any) -> None:
    """Set logarithmic axes over whole decades with numbers at decades only, so that they do not touch."""
    for axis, limit in ((axes.xaxis, axes.set_xlim), (axes.yaxis, axes.set_ylim)):
        low, high = np.log10(axis.get_data_interval())
        limit(10.0 ** np.floor(low - ROOM), 10.0 ** np.ceil(high + ROOM))
    axes.tick_params(which="minor", labelbottom=False, labelleft=False)


SPEC = Picture(
    name="study",
    place=190,
    shows="error over time and over steps of every method, of a results file of `study`",
    needs=("study", "study_advice"),
    draw=study,
)
